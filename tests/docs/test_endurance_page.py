"""The figures of the page of endurance tests are those of its text."""

import re
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parents[2] / "docs"


def test_the_figure_of_the_failure_has_the_onset_of_the_text():
    text = (DOCS / "endurance.md").read_text(encoding="utf-8")
    (onset,) = re.findall(r"^uncut_1 +stage 6 +([\d.]+ s)", text, re.M)
    with Image.open(DOCS / "images" / "endurance_failure.png") as picture:
        assert picture.info["Title"] == f"uncut_1: galling at {onset}"
