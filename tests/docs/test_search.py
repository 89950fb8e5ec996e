"""What users look for is a title or a main entry of the index, which the search lists first."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize(
    ("words", "page"),
    [
        ("subtract the background", "your_data.md"),
        ("variables of film.nc", "film_nc.md"),
        ("commands and options", "commands.md"),
        ("how to cite", "cite.md"),
    ],
)
def test_words_lead_to_their_page(words, page):
    named = {
        path.name: re.findall(r"^#+ (.*)$|^```{index} ! (.*)$", path.read_text("utf-8"), re.M)
        for path in DOCS.glob("*.md")
    }
    found = {
        name
        for name, texts in named.items()
        if words in {text.lower() for each in texts for text in each}
    }
    assert found == {page}
