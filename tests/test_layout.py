"""The order of the stages: imports go one way, within erlif and within each stage."""

from __future__ import annotations

import ast
import functools
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "erlif"

ORDER = (
    "core",
    "models",
    "rig",
    "io",
    "correction",
    "registration",
    "ratio",
    "calibration",
    "thickness",
    "kinematics",
    "trend",
    "prediction",
    "planning",
    "pipeline",
    "review",
    "show",
    "joint",
    "commands",
)
"""The stages in the order of docs/architecture.md: each may import those before it."""


def modules() -> dict[str, Path]:
    """Every module of erlif by its dotted name."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


@functools.cache
def imports(name: str) -> frozenset[str]:
    """Modules of erlif that a module imports, for types only and inside functions included."""
    found = set()
    for node in ast.walk(ast.parse(MODULES[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name} has a relative import"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if inner in MODULES else str(node.module))
    return frozenset(module for module in found if module in MODULES and module != name)


def stage(module: str) -> str:
    """The stage of a module: the second part of its name."""
    return module.split(".")[1]


STAGED = [
    name
    for name in MODULES
    if name not in ("erlif", "erlif.__main__", "erlif.plots", "erlif.readers")
]


def test_every_stage_has_a_place_in_the_order():
    assert {stage(name) for name in STAGED} == set(ORDER)


def test_imports_go_to_earlier_stages_only():
    late = [
        f"{name} imports {other}"
        for name in STAGED
        for other in imports(name)
        if other == "erlif" or ORDER.index(stage(other)) > ORDER.index(stage(name))
    ]
    assert not late


def test_only_commands_know_the_joint_on_a_desk():
    others = [
        f"{name} imports {other}"
        for name in STAGED
        for other in imports(name)
        if stage(other) == "joint" and stage(name) not in ("joint", "commands")
    ]
    assert not others


def test_a_module_imports_another_stage_by_its_public_names():
    private = [
        f"{name} imports {other}"
        for name in STAGED
        for other in imports(name)
        if stage(other) != stage(name) and other.rpartition(".")[2].startswith("_")
    ]
    assert not private


def test_no_module_imports_itself_by_way_of_others():
    graph = {name: imports(name) for name in MODULES if name != "erlif"}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(f"circle of imports: {' -> '.join(error.args[1])}")
