"""Decisions that a test can hold."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_virtual_rig_imports_nothing_of_the_stages():
    """docs/decisions/simulator.md: truth comes from code that the measurement does not use."""
    found = set()
    for path in (ROOT / "erlif" / "rig").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and str(node.module).startswith("erlif"):
                found.add(".".join(str(node.module).split(".")[:2]))
    assert found <= {"erlif.core", "erlif.rig"}


def test_no_kernel_is_compiled_as_parallel():
    """docs/decisions/kernels.md: threads run over frames."""
    for path in (ROOT / "erlif").rglob("*.py"):
        assert "parallel=True" not in path.read_text(encoding="utf-8"), path.name
