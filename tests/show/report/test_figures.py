"""Figures of the page carry their image, a caption and a text for readers who do not see them."""

from __future__ import annotations

import base64

from erlif.show.plots.files import find_source
from erlif.show.report import figures
from erlif.show.report.figures import figures_section


def test_images_are_embedded_in_their_kind(page):
    sources = [attrs["src"] for attrs in page.all("img")]
    kinds = [source.split(";")[0] for source in sources]
    assert kinds == ["data:image/svg+xml", "data:image/png"]
    drawn = [base64.b64decode(source.split(",")[1]) for source in sources]
    assert drawn[0].startswith(b"<?xml")
    assert drawn[1].startswith(b"\x89PNG")


def test_pictures_have_a_text_in_their_place(page):
    assert all(len(attrs["alt"]) > 40 for attrs in page.all("img"))
    assert all(attrs.get("aria-label") for attrs in page.all("canvas"))


def test_figures_of_one_trigger_name_it(page):
    by_name = dict(
        zip((a["id"] for a in page.all("figure")), (a["alt"] for a in page.all("img")), strict=True)
    )
    assert "Trigger 1, " in by_name["figure-thickness_map"]
    assert "Trigger" not in by_name["figure-speed_against_angle"]


def test_figures_are_as_wide_as_their_columns(page):
    classes = {attrs["id"]: attrs["class"] for attrs in page.all("figure")}
    assert classes == {"figure-speed_against_angle": "one lone", "figure-thickness_map": "two"}


def test_figure_that_is_left_out_has_a_reason(page):
    assert "Profile of the calibration fixture: it needs the CMM profile" in page.texts["figures"]


def test_without_figures_the_section_is_empty(film_path, film, monkeypatch):
    monkeypatch.setattr(figures, "DRAWN", {})
    section = figures_section(find_source(film_path, film, None, None, None))
    assert "<figure" not in section
    assert "Left out" not in section
