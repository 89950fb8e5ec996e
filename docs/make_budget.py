"""Renew the budget of the sample run in docs/uncertainty.md: ``python docs/make_budget.py``.

A test holds the table to what `erlif budget data_samples/straight_bushing` prints.
"""

from __future__ import annotations

from pathlib import Path

import erlif
from erlif.show.report import render_budget

ROOT = Path(__file__).parents[1]
BEGIN, END = "<!-- budget -->\n", "<!-- end of budget -->"


def main() -> None:
    """Replace the table between the marks."""
    page = ROOT / "docs" / "uncertainty.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    _, after = rest.split(END)
    table = render_budget(erlif.budget(ROOT / "data_samples" / "straight_bushing"))
    page.write_text(before + BEGIN + table + END + after, encoding="utf-8")


if __name__ == "__main__":
    main()
