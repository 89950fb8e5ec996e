"""docs/limits.md states the errors of a laboratory that states nothing."""

import re
from pathlib import Path

from scenes.scripts import load_script

DOCS = Path(__file__).parents[2] / "docs"


def test_the_table_of_limits_is_the_computed_one():
    text = (DOCS / "limits.md").read_text(encoding="utf-8")
    stated = re.search(r"<!-- limits -->\n(.*?)<!-- end of limits -->", text, re.DOTALL)[1]
    assert stated == load_script(DOCS / "make_budget.py").limits(), "python docs/make_budget.py"
