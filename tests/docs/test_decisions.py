"""Decisions that a test can hold."""

from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_no_kernel_is_compiled_as_parallel():
    """docs/decisions/kernels.md: threads run over frames."""
    for path in (ROOT / "erlif").rglob("*.py"):
        assert "parallel=True" not in path.read_text(encoding="utf-8"), path.name
