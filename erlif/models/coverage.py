"""What of the four sources erlif holds: the text of docs/coverage.md.

Every numbered equation, table, figure with a result, and procedure is a row of sources_coverage.csv
beside this file: the functions that hold it, what they are checked against and by which tests, or
why there is none.
"""

import csv
from dataclasses import dataclass
from importlib.resources import files

from erlif.models.sources import TITLES


@dataclass(frozen=True)
class CoverageRow:
    """An equation, table, figure or procedure of a source.

    Attributes
    ----------
    source : str
        Key of the source in `erlif.models.sources.TITLES`.
    item : str
        Number in the source.
    content : str
        What it states.
    models : tuple[str, ...]
        Functions, classes or modules that hold it, from `erlif` on; none where there is no model.
    against : str
        What the tests compare it with; empty where there is no model.
    tests : tuple[str, ...]
        Files below tests/ that check it.
    note : str
        What is missing, or why.
    """

    source: str
    item: str
    content: str
    models: tuple[str, ...]
    against: str
    tests: tuple[str, ...]
    note: str


def coverage_rows() -> list[CoverageRow]:
    """Rows of the table, source by source.

    Returns
    -------
    list of CoverageRow
        In the order of the sources.

    Examples
    --------
    >>> row = coverage_rows()[2]
    >>> print(row.item, row.content, row.models, sep=", ")
    2.1, adhesive wear, ('models.wear.adhesive_wear',)
    """
    text = files("erlif.models").joinpath("sources_coverage.csv").read_text(encoding="utf-8")
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


_HEADER = "| item | content | erlif | checked against | tests | note |"


def render_coverage() -> str:
    """Write the text of docs/coverage.md.

    Returns
    -------
    str
        Markdown, one table for each source.

    Examples
    --------
    >>> render_coverage().splitlines()[0]
    '# Equations, tables and figures of the sources'
    """
    rows = coverage_rows()
    held = sum(bool(row.models) for row in rows)
    lines = [
        "# Equations, tables and figures of the sources",
        "",
        "Made by `erlif.models.coverage.render_coverage`; a test keeps this file equal to its "
        "result, and every function and test named here exists. [Published numbers](sources.md) "
        "compares the numbers and lists the misprints.",
        "",
        f"{len(rows)} rows: {held} are held by erlif, {len(rows) - held} are not, with the reason.",
        "",
    ]
    for source, title in TITLES.items():
        lines += [f"## {title}", "", _HEADER, "|" + "---|" * 6]
        lines += [_line(row) for row in rows if row.source == source]
        lines.append("")
    return "\n".join(lines)


def _line(row: CoverageRow) -> str:
    models = ", ".join(f"`{name}`" for name in row.models)
    tests = ", ".join(row.tests)
    return f"| {row.item} | {row.content} | {models} | {row.against} | {tests} | {row.note} |"
