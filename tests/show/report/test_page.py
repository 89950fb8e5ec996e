"""The page is well formed, loads nothing, and is the same for the same film."""

import json
import re
import shutil

import pytest
from scenes import film as scene

from erlif.core.errors import OutputError
from erlif.io.files import flag_shares, open_film
from erlif.show.plots import files as plot_files
from erlif.show.plots.files import find_source
from erlif.show.report import page as pages
from erlif.show.report import write_report


def test_page_is_well_formed(page):
    assert page.open == []
    assert [tag for tag, _ in page.elements if tag == "h1"] == ["h1"]
    names = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(names) == len(set(names))
    assert page.all("html")[0]["lang"] == "en"
    assert page.texts["h1"] == "a film <known> & small"
    assert "<known>" not in page.source.split("<script")[0]

    # links lead to sections of the page
    sections = {attrs["id"] for attrs in page.all("section")}
    links = [link["href"] for link in page.all("a") if "download" not in link]
    assert {link.removeprefix("#") for link in links} == sections
    headings = {attrs["id"] for attrs in page.all("h2")}
    assert {attrs["aria-labelledby"] for attrs in page.all("section")} == headings


def test_page_loads_nothing(text, page):
    own = re.sub(r"data:[^\"]*|<script type=\"text/plain\".*|/\*! https\S* \(v", "", text)
    assert not re.search(r"https?://|//[a-z]+\.[a-z]", own)
    assert page.all("link") == []
    assert all("src" not in attrs for attrs in page.all("script"))
    assert all(attrs["src"].startswith("data:image/") for attrs in page.all("img"))
    assert not re.search(r"fetch\(|XMLHttpRequest|import\(|url\(|@import", text)


def test_name_cannot_end_the_script_that_holds_the_data(film_path, tmp_path, read_page, film):
    """Settings in the page are escaped even where they look like the end of an element."""
    empty = scene.without_valid_pixels(film)
    hostile = empty.assign_attrs(history="</script><script>alert(1)</script>")
    target = copy_with(film_path, hostile, tmp_path)
    page = read_page(write_report(target, tmp_path / "page.html").read_text(encoding="utf-8"))
    assert page.open == []
    assert "alert(1)" in page.texts["provenance"]
    plain = [attrs for attrs in page.all("script") if attrs.get("type") == "module"]
    assert plain == []
    assert len(page.all("iframe")) == 1  # the viewer

    # this film has no valid pixel
    assert "none: no trigger has enough valid pixels" in page.texts["summary"]
    assert "not known" in page.texts["numbers"]
    assert "100.00 %" in page.texts["numbers"]
    assert "nan" not in page.texts["summary"] + page.texts["numbers"] + page.texts["triggers"]


def test_figures_of_the_result_come_before_those_of_the_method():
    names = sorted(plot_files.DRAWN, key=[*pages._FIRST, *plot_files.DRAWN].index)
    assert names[0] == "film_over_cycle"
    method = ["speed_against_angle", "fixture_profile", "processed_images", "ratio_image"]
    assert names[-6:] == [*method, "calibration", "registration"]


@pytest.fixture(autouse=True)
def quick(without_figures):
    """The figures have tests of their own."""


def copy_with(film_path, film, directory):
    """Write a changed film with the groups of the original."""
    target = directory / "film.nc"
    film.load().to_netcdf(target, engine="h5netcdf")
    for name in ("frames", "registration"):
        with open_film(film_path, group=name) as group:
            group.load().to_netcdf(target, engine="h5netcdf", mode="a", group=name)
    return target


def test_page_begins_with_the_film_and_ends_with_its_numbers(page):
    assert "minimum n = 0.600 ± 0.010" in page.texts["summary"]
    assert "gain < measured" in page.texts["summary"] + page.texts["numbers"]
    summary = page.texts["numbers"]
    # power of the minimum, K, registration, and 3 of 80 columns outside the overlap
    for text in ("0.600 ± 0.010", "0.6600 ± 0.0010", "0.970", "3.75 %"):
        assert text in summary
    assert "Profile of the calibration fixture: it needs the CMM profile" in page.texts["figures"]
    by_name = dict(zip((a["id"] for a in page.all("figure")), page.all("img"), strict=True))
    assert "Trigger 1, " in by_name["figure-thickness_map"]["alt"]
    assert "Trigger" not in by_name["figure-speed_against_angle"]["alt"]


def test_page_is_replaced_on_request_alone_and_the_same_wherever_the_film_lies(film_path, tmp_path):
    target = tmp_path / "report.html"
    earlier = '<!DOCTYPE html><meta name="generator" content="erlif">mine'
    target.write_text(earlier)
    for film, message in ((film_path, "--overwrite"), (tmp_path / "none.nc", "--overwrite")):
        with pytest.raises(OutputError, match=message):
            write_report(film, target)
    with pytest.raises(OutputError, match="does not exist"):
        write_report(tmp_path / "none.nc", tmp_path / "other.html")
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert target.read_text() == earlier

    shutil.copytree(film_path.parent, tmp_path / "elsewhere")
    once, twice = (
        write_report(path, target, overwrite=True).read_bytes()
        for path in (film_path, tmp_path / "elsewhere" / "film.nc")
    )
    assert once == twice


def test_inputs_of_the_calibration_are_listed_apart(film):
    kept = json.loads(film.attrs["calibration"]) | {"input_hashes": {"profile.csv": "cd" * 32}}
    section = pages.provenance_section(film.assign_attrs(calibration=json.dumps(kept)))
    run, calibration = section.split("Inputs of the calibration")
    assert "ab" * 32 in run
    assert "cd" * 32 in calibration
    assert "Inputs of the calibration" not in pages.provenance_section(film)


def test_notes_are_listed_once_and_escaped(film_path, film):
    def notes_of(text):
        source = find_source(film_path, film.assign_attrs(notes=text), None, None, None)
        shares = flag_shares(film)
        numbers = pages._numbers_section(source, shares).partition("<h3>Notes</h3>")[2]
        return pages._summary_section(source.film, shares) + numbers

    assert notes_of("gain < measured").count("<li>gain &lt; measured</li>") == 1
    assert notes_of("one\ntwo\none").count("<li>") == 2
    assert "<li>" not in notes_of("")
    text = notes_of("warning: camera2: no <flat>\ncamera1: dark")
    assert "<li><strong>Warning: </strong>camera2: no &lt;flat&gt;</li>" in text
    assert "<li>camera1: dark</li>" in text
