"""Renew the lines of each folder in docs/architecture.md: ``python docs/make_architecture.py``.

A line counts where a maintainer reads it: Python without docstrings, comments and blank lines, and
the lines of tables, stubs and pages.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

PAGE = Path(__file__).with_name("architecture.md")
PACKAGE = Path(__file__).parents[1] / "erlif"

OTHER = (".toml", ".pyi", ".js", ".html", ".css")
"""Kinds of files beside Python whose lines count."""

ROW = re.compile(r"^\| `(\w+)` \| ([\d,]+) \|", re.MULTILINE)
TOTAL = re.compile(r"(?<=all together )[\d,]+")


def count_folders() -> dict[str, int]:
    """Lines of each folder of erlif."""
    return {
        folder.name: sum(map(count_lines, folder.rglob("*.*")))
        for folder in sorted(PACKAGE.iterdir())
        if (folder / "__init__.py").exists()
    }


def count_lines(path: Path) -> int:
    """Lines of one file; none of a file that nobody reads."""
    if path.suffix not in (".py", *OTHER):
        return 0
    text = path.read_text(encoding="utf-8")
    lines = {
        number
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith(("#", "//"))
    }
    if path.suffix == ".py":
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, documented) and ast.get_docstring(node) is not None:
                lines -= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    return len(lines)


def render(text: str) -> str:
    """The page with the lines of today."""
    counts = count_folders()
    text = ROW.sub(lambda row: f"| `{row[1]}` | {counts[row[1]]:,} |", text)
    return TOTAL.sub(f"{sum(counts.values()):,}", text)


if __name__ == "__main__":
    PAGE.write_text(render(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
