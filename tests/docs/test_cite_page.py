"""docs/cite.md holds what CITATION.cff states."""

import re
from pathlib import Path

from erlif.core.version import __version__

ROOT = Path(__file__).parents[2]


def test_every_value_of_the_citation_file_is_on_the_page():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    names = "title|name|license|version|family-names|given-names|journal|volume|start|end|year"
    values = re.findall(rf"^ *(?:- )?(?:{names}): \"?(.*?)\"?$", text, re.MULTILINE)
    assert len(values) == 14
    page = re.sub("[{}]", "", (ROOT / "docs" / "cite.md").read_text(encoding="utf-8"))
    assert not [value for value in values if value not in page]
    assert f"version = {__version__}" in page
