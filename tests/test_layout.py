"""The order of the stages: imports go one way, within erlif and within each stage."""

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
    "commands",
    "joint",
)
"""The stages in the order of docs/architecture.md: each may import those before it."""

NAMING = {"erlif.commands.main", "erlif.models.arguments"}
"""What names the joint: the door, which loads its commands, and the place at which models warn."""

JOINT_USES = {
    "erlif.commands.lines",
    "erlif.commands.options",
    "erlif.show.plots.mechanism",
    "erlif.show.plots.movie",
    "erlif.show.plots.style",
    "erlif.show.report.captions",
    "erlif.show.report.layout",
}
"""What the joint draws, writes and reads options with, beside core, io and models."""


def modules() -> dict[str, Path]:
    """Every module of erlif by its dotted name."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


@functools.cache
def nodes(name: str) -> list[ast.AST]:
    """All imports and constants of a module."""
    tree = ast.parse(MODULES[name].read_text(encoding="utf-8"))
    kinds = ast.Import | ast.ImportFrom | ast.Constant
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


@functools.cache
def imports(name: str) -> frozenset[str]:
    """Modules of erlif that a module imports, for types only and inside functions included."""
    found = set()
    for node in nodes(name):
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


STAGED = [name for name in MODULES if name not in ("erlif", "erlif.__main__")]


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


def test_nothing_of_the_film_knows_the_joint():
    others = [
        f"{name} imports {other}"
        for name in MODULES
        for other in imports(name)
        if f"{other}.".startswith("erlif.joint.") and not f"{name}.".startswith("erlif.joint.")
    ]
    assert not others


def test_one_door_names_the_joint():
    naming = {
        name
        for name in MODULES
        if not name.startswith("erlif.joint")
        for node in nodes(name)
        if isinstance(node, ast.Constant) and str(node.value).startswith("erlif.joint")
    }
    assert naming == NAMING


def test_the_joint_knows_little_of_the_film():
    used = {
        other
        for name in MODULES
        for other in imports(name)
        if name.startswith("erlif.joint") and stage(other) not in ("joint", "core", "io", "models")
    }
    assert used == JOINT_USES


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
