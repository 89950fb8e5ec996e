"""The version stands in one place."""

import re
from pathlib import Path

from erlif.core.version import __version__


def test_the_citation_names_this_version():
    text = (Path(__file__).parents[2] / "CITATION.cff").read_text(encoding="utf-8")
    cited = re.search(r'^version:\s*"?([^"\s]+)', text, re.MULTILINE)
    assert cited is not None
    assert cited[1] == __version__
