"""The table of folders in docs/architecture.md, held to the tree."""

from pathlib import Path

import pytest
from scenes.scripts import load_script

DOCS = Path(__file__).parents[2] / "docs"
CLOSE = 0.05  # change of a folder below which the page stays as it is


def test_the_table_of_the_tree_has_all_folders_with_their_lines():
    page = load_script(DOCS / "make_architecture.py")
    text = page.PAGE.read_text(encoding="utf-8")
    stated = {row[1]: int(row[2].replace(",", "")) for row in page.ROW.finditer(text)}
    total = int(page.TOTAL.search(text)[0].replace(",", ""))

    assert total == sum(stated.values())
    assert stated == pytest.approx(page.count_folders(), rel=CLOSE), (
        "python docs/make_architecture.py"
    )
