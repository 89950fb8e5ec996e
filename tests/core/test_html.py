"""Pieces of HTML: text is escaped, pictures are themselves."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from erlif.core.html import (
    captioned,
    card,
    colour_picture,
    curve_picture,
    findings_list,
    picture_tag,
    rows_table,
)
from erlif.core.notes import Level

EVIL = '<script>alert("x")</script>'


@pytest.mark.parametrize(
    "text",
    [
        card(EVIL, EVIL),
        rows_table([(EVIL, EVIL)]),
        findings_list([(Level.WARNING, EVIL)]),
        captioned([("", EVIL)]),
        picture_tag(np.zeros((4, 4, 3), np.uint8), alt=EVIL),
        curve_picture((np.arange(2.0),) * 2, (np.arange(2.0),) * 2, labels=(EVIL, EVIL)),
    ],
)
def test_text_stays_text(text):
    assert "<script" not in text
    assert "&lt;script&gt;" in text


def test_warnings_are_written_out_and_notes_counted():
    found = [(Level.NOTE, "gain"), (Level.WARNING, "no flat"), (Level.NOTE, "noise")]
    text = findings_list(found)
    assert "no flat" in text
    assert "gain" not in text
    assert "2 notes" in text
    assert "3 more warnings" in findings_list([(Level.WARNING, "w")] * 8)


def test_a_picture_is_a_png_of_its_pixels():
    values = np.array([[0.0, 1.0], [np.nan, 0.5]])
    tag = picture_tag(colour_picture(values, (0.0, 1.0)), alt="film")
    content = base64.b64decode(tag.partition("base64,")[2].partition('"')[0])
    pixels = np.asarray(Image.open(io.BytesIO(content)).convert("RGB"))
    assert pixels.shape == (2, 2, 3)
    assert pixels[1, 0].tolist() == [217, 217, 217]
    assert len({tuple(pixel) for pixel in pixels.reshape(-1, 3)}) == 4


def test_a_curve_through_even_values_is_drawn():
    flat = np.ones(3)
    assert "nan" not in curve_picture((flat, flat), (flat, flat), labels=("x", "y"))
