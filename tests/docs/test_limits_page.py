"""docs/limits.md states the errors of a laboratory that states nothing."""

import re
from pathlib import Path

import pytest
from scenes.scripts import load_script

DOCS = Path(__file__).parents[2] / "docs"


def stated(name):
    """The table between the marks of the page."""
    text = (DOCS / "limits.md").read_text(encoding="utf-8")
    return re.search(rf"<!-- {name} -->\n(.*?)<!-- end of {name} -->", text, re.DOTALL)[1]


def test_the_table_of_limits_is_the_computed_one():
    expected = load_script(DOCS / "make_budget.py").limits()
    assert stated("limits") == expected, "python docs/make_budget.py"


def test_the_remedies_are_those_of_their_table():
    assert stated("list of remedies") == load_script(DOCS / "make_budget.py").remedies()


@pytest.mark.slow
def test_the_list_of_remedies_is_that_of_a_virtual_rig():
    assert stated("remedies") == load_script(DOCS / "make_budget.py").list_of_means()
