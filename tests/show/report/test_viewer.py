"""The viewer has the axes, colours and flags of the film."""

import json
import re
from importlib import resources

import numpy as np
import numpy.testing as npt
import pytest
from scenes import film as scene

from erlif.show.plots.maps import common_limits
from erlif.show.report.maps import MapCoding
from erlif.show.report.viewer import viewer_data, viewer_section

EVERY = MapCoding(1, 1e-3)


@pytest.fixture
def data(film):
    return json.loads(viewer_data(film, EVERY))


def test_axes_and_scales_are_those_of_the_film(data, film):
    assert (data["width"], data["height"]) == (scene.COLUMNS, scene.ROWS)
    assert data["x"] == [0.0, scene.PITCH]
    assert data["y"] == [0.0, scene.PITCH]
    assert data["pixelAspect"] == 1.0
    assert data["region"] == [3, 13, 1, 11]
    assert (data["xLabel"], data["yLabel"]) == ("x (sliding) [mm]", "y (axial) [mm]")
    npt.assert_allclose(data["limits"]["thickness"], common_limits(film), atol=6e-4)
    assert data["limits"]["std_shared"] == [0.0, 0.02]
    assert data["limits"]["std"][0] == 0.0
    assert "<" not in viewer_data(film, EVERY)


def test_the_pointer_begins_at_the_minimum_film(film):
    """Columns and rows of the kept pixels; a trigger without a minimum begins in the middle."""
    column = np.r_[np.nan, 30.4 + np.arange(scene.TRIGGERS - 1)]
    row = np.full(scene.TRIGGERS, 200.0)  # beyond the last row
    marked = film.assign(film_min_x=("trigger", column), film_min_y=("trigger", row))
    first, second, third, *_ = json.loads(viewer_data(marked, MapCoding(2, 1e-3)))["minima"]
    last = scene.ROWS // 2 - 1
    assert (first, second, third) == (None, [15, last], [16, last])
    assert set(json.loads(viewer_data(film, EVERY))["minima"]) == {None}


def test_viewer_opens_at_the_trigger_of_the_figures(page, film):
    """The fastest of the outward stroke: crank angles of the scene, speed by differences."""
    speed = np.where(scene.rocker_speed(scene.CRANK) > 0, scene.rocker_speed(scene.CRANK), 0)
    (slider,) = page.all("input")
    assert int(slider["value"]) == int(np.argmax(speed)) > 0
    assert f"Trigger {slider['value']}, " in page.texts["figures"]


def test_maps_of_the_prediction_are_offered_where_the_film_has_one(film, read_page):
    def offered(film):
        return [each["value"] for each in read_page(viewer_section(film, EVERY)).all("option")]

    assert offered(film) == ["thickness", "std", "std_shared", "predicted", "difference"]
    assert offered(film.drop_vars("film_predicted_min")) == ["thickness", "std", "std_shared"]


def test_a_thinned_map_is_named_and_has_its_pitch(film):
    assert "every 3rd pixel" in viewer_section(film, MapCoding(3, 1e-3))
    data = json.loads(viewer_data(film, MapCoding(3, 1e-3)))
    npt.assert_allclose(data["x"], [0.0, 3 * scene.PITCH])
    assert (data["width"], data["height"]) == (27, 22)


def test_script_finds_its_elements_on_the_page(page):
    """Names that viewer.js looks up exist, apart from the maps, whose names it composes."""
    script = resources.files("erlif.show.report").joinpath("viewer.js").read_text(encoding="utf-8")
    wanted = set(re.findall(r'getElementById\("([^"]+)"\)', script))
    assert len(wanted) >= 7
    assert wanted <= {attrs["id"] for _, attrs in page.elements if "id" in attrs}
