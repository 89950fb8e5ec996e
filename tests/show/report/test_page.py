"""The page is well formed, loads nothing, and is the same for the same film."""

import html
import json
import re
import shutil

import numpy as np
import numpy.testing as npt
import pytest
from markupsafe import Markup
from scenes import film as scene

from erlif.core.errors import OutputError
from erlif.io.files import flag_shares, open_film
from erlif.show.plots import files as plot_files
from erlif.show.plots.files import find_source
from erlif.show.plots.maps import common_limits
from erlif.show.report import page as pages
from erlif.show.report import write_report
from erlif.show.report.maps import KeptMaps, MapCoding
from erlif.show.report.page import viewer_data, viewer_page, viewer_section


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


ALL = tuple(range(scene.TRIGGERS))


def kept(stride=1, triggers=ALL):
    return KeptMaps(triggers, MapCoding(stride, 1e-3))


@pytest.fixture
def data(film):
    return json.loads(viewer_data(film, kept()))


def test_axes_and_scales_are_those_of_the_film(data, film):
    (one,) = data["films"]
    assert (one["width"], one["height"]) == (scene.COLUMNS, scene.ROWS)
    npt.assert_allclose(one["x"], [0.0, scene.PITCH])
    npt.assert_allclose(one["y"], [0.0, scene.PITCH])
    assert one["region"] == [3, 13, 1, 11]
    assert one["labels"] == ["x (sliding) [mm]", "y (axial) [mm]"]
    npt.assert_allclose(data["limits"]["thickness"], common_limits(film), atol=6e-4)
    assert data["limits"]["thickness_std_shared"] == [0.0, 0.02]
    assert data["limits"]["thickness_std"][0] == 0.0
    assert data["limits"]["residual"][0] == -data["limits"]["residual"][1]
    assert "<" not in viewer_data(film, kept())


def test_triggers_that_are_kept_have_their_own_numbers(film):
    data = json.loads(viewer_data(film, kept(triggers=(1, 4))))
    assert data["films"][0]["numbers"] == data["cycle"]["columns"]["trigger"] == [1, 4]
    assert [text.split(",")[0] for text in data["texts"]] == ["trigger 1", "trigger 4"]
    npt.assert_allclose(data["cycle"]["columns"]["film_min"], film.film_min[[1, 4]], rtol=1e-5)


def test_the_first_profile_passes_the_minimum_film(film):
    """Rows of the film are counted in all its pixels, whatever the page keeps."""
    marked = film.assign(film_min_y=("trigger", np.full(scene.TRIGGERS, 6.0)))
    for stride in (1, 3):
        (one,) = json.loads(viewer_data(marked, kept(stride)))["films"]
        npt.assert_allclose([one["line"][1], one["line"][3]], 6 * scene.PITCH)


def test_viewer_opens_at_the_trigger_of_the_figures(page):
    """The fastest of the outward stroke: crank angles of the scene, speed by differences."""
    speed = np.where(scene.rocker_speed(scene.CRANK) > 0, scene.rocker_speed(scene.CRANK), 0)
    (one,) = json.loads(page.texts["film-data"])["films"]
    assert one["first"] == int(np.argmax(speed)) > 0
    assert f"Trigger {one['first']}, " in page.texts["figures"]


def test_maps_of_the_prediction_are_offered_where_the_film_has_one(film):
    def offered(film):
        return json.loads(viewer_data(film, kept()))["films"][0]["layers"]

    measured = ["thickness", "thickness_std", "thickness_std_shared"]
    assert offered(film) == [*measured, "predicted", "residual"]
    assert offered(film.drop_vars("film_predicted_min")) == measured


def test_a_thinned_map_is_named_and_has_its_pitch(film):
    assert "every 3rd pixel" in viewer_section(film, kept(3), Markup())
    (one,) = json.loads(viewer_data(film, kept(3)))["films"]
    npt.assert_allclose(one["x"], [0.0, 3 * scene.PITCH])
    assert (one["width"], one["height"]) == (27, 22)


def test_the_page_within_the_page_needs_no_other_file(read_page):
    page = read_page(html.unescape(viewer_page()))
    assert page.open == []
    assert all("src" not in attrs for attrs in page.all("script"))
    assert [attrs["href"] for attrs in page.all("link")] == ["data:,"]
    script = page.source.split('<script type="module">')[1]
    assert not re.search(r"^(import|export) ", script, re.MULTILINE)

    # elements that the script looks up
    wanted = set(re.findall(r'\b(?:byId|on)\("([^"]+)"', script))
    assert len(wanted) > 40
    assert wanted <= {attrs["id"] for _, attrs in page.elements if "id" in attrs}
