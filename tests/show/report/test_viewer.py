"""The viewer of a report is the page of `erlif view`, with the grid and the colours of the film."""

import html
import json
import re

import numpy as np
import numpy.testing as npt
import pytest
from markupsafe import Markup
from scenes import film as scene

from erlif.show.plots.maps import common_limits
from erlif.show.report.maps import KeptMaps, MapCoding
from erlif.show.report.viewer import viewer_data, viewer_page, viewer_section

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
