"""The page of an audit: findings, pairs, pictures."""

import re

import pytest

from erlif.core.notes import Level, Note
from erlif.review.check import Examination, examine
from erlif.show.report import write_check_page


@pytest.fixture(scope="module")
def text(small_rig, tmp_path_factory):
    path = tmp_path_factory.mktemp("check") / "check.html"
    return write_check_page(examine(small_rig.run), path).read_text(encoding="utf-8")


def test_the_page_is_well_formed_and_loads_nothing(text, read_page):
    page = read_page(text)
    assert page.open == []
    assert page.texts["h1"] == "virtual straight bushing"
    assert not re.search(r"https?://", re.sub(r"data:[^\"]*", "", text))
    assert page.all("script") == page.all("link") == []
    names = [attrs["id"] for attrs in page.all("figure")]
    assert names == [f"figure-{n}" for n in ("pair", "difference", "counts", "light", "steps")]

    assert "0 errors, 0 warnings." in page.texts["findings"]
    assert "correlation of the textures" in page.texts["findings"]
    assert "frame_0005.tif" in page.texts["pairs"]
    assert "pair 0: frame_0000.tif" not in page.texts["findings"]


def test_errors_stand_first_and_are_escaped(tmp_path, read_page):
    found = Examination(tmp_path / "run")
    found.notes = [Note(Level.NOTE, "frames", "six"), Note(Level.ERROR, "log", "<no> & file")]
    text = write_check_page(found, tmp_path / "check.html").read_text(encoding="utf-8")
    page = read_page(text)
    assert page.texts["h1"] == "run"
    findings = page.texts["findings"]
    assert "1 error, 0 warnings." in findings
    assert findings.index("<no> & file") < findings.index("six")
    assert page.all("figure") == []
