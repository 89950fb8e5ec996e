"""Write docs/coverage.md, what of the four sources erlif holds: ``python docs/make_coverage.py``.

Every numbered equation, table, figure with a result, and procedure is a row of coverage.csv beside
this file: the functions that hold it, what they are checked against and by which tests, or why
there is none.
"""

import csv
import tomllib
from dataclasses import dataclass
from pathlib import Path

DOCS = Path(__file__).parent

SOURCES = tomllib.loads((DOCS / "sources" / "sources.toml").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class CoverageRow:
    """An equation, table, figure or procedure of a source."""

    source: str
    """Key of the source in `SOURCES`."""
    item: str
    """Number in the source."""
    content: str
    """What it states."""
    models: tuple[str, ...]
    """Functions, classes or modules that hold it, from `erlif` on; none without a model."""
    against: str
    """What the tests compare it with; empty where there is no model."""
    tests: tuple[str, ...]
    """Files below tests/ that check it."""
    note: str
    """What is missing, or why."""


def coverage_rows() -> list[CoverageRow]:
    """Rows of the table, source by source."""
    text = (DOCS / "coverage.csv").read_text(encoding="utf-8")
    return [
        CoverageRow(
            row["source"],
            row["item"],
            row["content"],
            tuple(row["models"].split()),
            row["against"],
            tuple(row["tests"].split()),
            row["note"],
        )
        for row in csv.DictReader(text.splitlines())
    ]


def render_coverage() -> str:
    """Text of docs/coverage.md: one table for each source."""
    rows = coverage_rows()
    held = sum(bool(row.models) for row in rows)
    lines = [
        "# Equations, tables and figures of the sources",
        "",
        "Made by docs/make_coverage.py; a test keeps this file equal to its result, and every "
        "function and test named here exists. [Published numbers](sources.md) compares the "
        "numbers and lists the misprints.",
        "",
        f"{len(rows)} rows: {held} are held by erlif, {len(rows) - held} are not, with the reason.",
        "",
    ]
    for source, about in SOURCES.items():
        lines += [
            f"## {about['title']}",
            "",
            "| item | content | erlif | checked against | tests | note |",
            "|" + "---|" * 6,
        ]
        lines += [_line(row) for row in rows if row.source == source]
        lines.append("")
    return "\n".join(lines)


def _line(row: CoverageRow) -> str:
    models = ", ".join(f"`{name}`" for name in row.models)
    tests = ", ".join(row.tests)
    return f"| {row.item} | {row.content} | {models} | {row.against} | {tests} | {row.note} |"


if __name__ == "__main__":
    (DOCS / "coverage.md").write_text(render_coverage(), encoding="utf-8")
