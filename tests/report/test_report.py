"""The report: one page that asks for nothing, and whose maps read back as the film."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.core.errors import OutputError
from erlif.files import open_film
from erlif.report import decode_map, write_report
from erlif.report import maps as report_maps
from erlif.report import page as report_page
from erlif.report.maps import MapCoding, choose_coding
from erlif.report.page import with_error

VOID = {"meta", "img", "input", "br"}


class Page(HTMLParser):
    """Elements, their text, and whether every one is closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.texts = [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append((tag, dict(attrs).get("id")))

    def handle_endtag(self, tag):
        assert self.open[-1][0] == tag, f"{tag} closes {self.open[-1]}"
        self.open.pop()

    def handle_data(self, data):
        for tag, name in self.open:
            for key in (tag, name):
                if key is not None:
                    self.texts[key] = self.texts.get(key, "") + data

    def all(self, tag):
        return [attrs for name, attrs in self.elements if name == tag]


@pytest.fixture(scope="module")
def film_path(tmp_path_factory):
    return scene.make_film(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def text(film_path):
    # one figure of each kind, and one that is left out: drawing all takes long and is tested with the figures
    few = {
        name: report_page.DRAWN[name]
        for name in ("speed_against_angle", "fixture_profile", "thickness_map")
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_page, "DRAWN", few)
        return write_report(film_path, film_path.with_name("report.html")).read_text(
            encoding="utf-8"
        )


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def coding_of(page):
    data = json.loads(page.texts["film-data"])
    return data, MapCoding(data["coding"]["stride"], data["coding"]["step"])


def test_page_is_well_formed(page):
    assert page.open == []
    assert [tag for tag, _ in page.elements if tag == "h1"] == ["h1"]
    names = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(names) == len(set(names))
    assert page.all("html")[0]["lang"] == "en"
    for link in page.all("a"):
        assert link["href"].removeprefix("#") in names
    labelled = {label["for"] for label in page.all("label")}
    assert all(control["id"] in labelled for control in page.all("input"))


def test_page_asks_for_nothing(text, page):
    assert not re.search(
        r"https?://|//[a-z]+\.[a-z]", re.sub(r"data:[^\"]*|<script type=\"text/plain\".*", "", text)
    )
    assert page.all("link") == []
    assert all("src" not in attrs for attrs in page.all("script"))
    assert all(attrs["src"].startswith("data:image/") for attrs in page.all("img"))
    assert not re.search(r"fetch\(|XMLHttpRequest|import\(|url\(|@import", text)


def test_pictures_have_words(page):
    pictures = page.all("img")
    assert [attrs["src"].split(";")[0] for attrs in pictures] == [
        "data:image/svg+xml",
        "data:image/png",
    ]
    assert all(len(attrs["alt"]) > 40 for attrs in pictures)
    assert all(attrs.get("aria-label") for attrs in page.all("canvas"))
    assert "Profile of the calibration fixture: it needs the CMM profile" in page.texts["figures"]
    assert set(report_page._CAPTIONS) == set(report_page.DRAWN)


def test_summary_says_what_was_found(page):
    summary = page.texts["summary"]
    assert page.texts["h1"] == "a film <known> & small"
    assert "0.600 ± 0.010" in summary
    assert "the largest governs" in summary
    assert "0.6600 ± 0.0010" in summary  # K
    assert "0.3900 ± 0.0020 µm⁻¹" in summary  # p
    assert "0.970" in summary  # registration
    assert "gain < measured" in summary
    assert "3.75 %" in summary  # 3 of 80 columns outside the overlap
    assert "0.20 to 16.00 µm" in summary


def test_every_trigger_has_a_row_and_a_map(page):
    rows = re.findall(r"(outward|return)", page.texts["triggers"])
    assert len(rows) == scene.TRIGGERS
    embedded = [attrs["id"] for attrs in page.all("script") if attrs.get("type") == "text/plain"]
    assert embedded == [f"map-{k}" for k in range(scene.TRIGGERS)]
    assert "[mechanism]" in page.texts["provenance"]
    assert "ab" * 32 in page.texts["provenance"]


def test_embedded_maps_read_back_as_the_film(page, film_path):
    data, coding = coding_of(page)
    assert coding == MapCoding(1, 1e-3)
    with open_film(film_path) as film:
        for k in range(scene.TRIGGERS):
            decoded = decode_map(
                page.texts[f"map-{k}"], shape=(data["height"], data["width"]), coding=coding
            )
            npt.assert_array_equal(decoded.flags, film.flags.values[k])
            npt.assert_allclose(decoded.thickness, film.thickness.values[k], atol=0.5001e-3)
            block = film.thickness_std.values[k][8:12, 20:24]
            assert 0.97 * block.min() <= decoded.std[2, 5] <= 1.03 * block.max()
            npt.assert_allclose(decoded.std_shared[2, 5], 0.02, rtol=0.03)


def test_flagged_blocks_have_no_error_bar(page):
    data, coding = coding_of(page)
    decoded = decode_map(page.texts["map-1"], shape=(data["height"], data["width"]), coding=coding)
    assert np.isnan(decoded.thickness[20:24, 30:34]).all()
    assert np.isfinite(decoded.std[5]).sum() >= 14


def test_axes_of_the_viewer_are_those_of_the_film(page):
    data, _ = coding_of(page)
    assert (data["width"], data["height"]) == (scene.COLUMNS, scene.ROWS)
    assert data["x"] == [0.0, scene.PITCH]
    assert data["region"] == [3, 13, 1, 11]
    assert data["triggers"][1].startswith("Trigger 1, ")
    assert len(data["palette"]) == 6 * 256


def test_a_large_film_is_thinned_and_the_page_says_so(film_path, tmp_path, monkeypatch):
    monkeypatch.setattr(report_maps, "_BUDGET", 20_000)
    monkeypatch.setattr(report_page, "DRAWN", {})
    page = Page(write_report(film_path, tmp_path / "thin.html").read_text(encoding="utf-8"))
    data, coding = coding_of(page)
    assert coding.stride == 2
    assert "every 2th" not in page.texts["viewer"]
    assert "every 2nd pixel" in page.texts["viewer"]
    with open_film(film_path) as film:
        decoded = decode_map(
            page.texts["map-4"], shape=(data["height"], data["width"]), coding=coding
        )
        npt.assert_allclose(decoded.thickness, film.thickness.values[4, ::2, ::2], atol=0.5001e-3)
    assert data["x"] == [0.0, 2 * scene.PITCH]


def test_a_film_without_answers_is_reported_as_such(film_path, tmp_path, monkeypatch):
    monkeypatch.setattr(report_page, "DRAWN", {})
    target = tmp_path / "film.nc"
    with open_film(film_path) as film:
        scene.without_valid_pixels(film).to_netcdf(target, engine="h5netcdf")
    for group in ("frames", "registration"):
        with open_film(film_path, group=group) as part:
            part.to_netcdf(target, engine="h5netcdf", mode="a", group=group)
    page = Page(write_report(target, tmp_path / "report.html").read_text(encoding="utf-8"))
    assert "not known" in page.texts["summary"]
    assert "100.00 %" in page.texts["summary"]
    assert "nan" not in page.texts["summary"] + page.texts["triggers"]


def test_steps_grow_where_sixteen_bits_would_not_reach(film_path):
    with open_film(film_path) as film:
        coding = choose_coding(film, thickest=400.0)
    assert 65535 * coding.step > 400.0


def test_same_film_gives_the_same_page(film_path, tmp_path, monkeypatch):
    # that every figure is the same twice is tested with the figures
    monkeypatch.setattr(report_page, "DRAWN", {})
    one, two = (write_report(film_path, tmp_path / f"{name}.html") for name in "ab")
    assert one.read_bytes() == two.read_bytes()


def test_existing_page_is_kept_unless_told_otherwise(film_path, tmp_path):
    target = tmp_path / "report.html"
    target.write_text("mine")
    with pytest.raises(OutputError, match="--overwrite"):
        write_report(film_path, target)
    assert target.read_text() == "mine"


@pytest.mark.parametrize(
    ("value", "std", "words"),
    [
        (5.1234, 0.0149, "5.123 ± 0.015"),
        (0.39320, 0.0021, "0.3932 ± 0.0021"),
        (-2.0, 0.5, "−2.00 ± 0.50"),
        (120.4, 12.0, "120 ± 12"),
        (float("nan"), 0.1, "not known"),
    ],
)
def test_values_are_given_to_two_digits_of_their_error(value, std, words):
    assert with_error(value, std) == words
