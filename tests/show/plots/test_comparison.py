"""Figures of runs compared."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest

import erlif
from erlif.review.comparison import control_chart
from erlif.show.plots import (
    comparison_figure,
    control_chart_of,
    difference_map_of_runs,
    example_calibration,
    example_film,
    film_against_duty,
)


@pytest.fixture(scope="module")
def found():
    film = example_film()
    thicker = film.assign(film_min=film.film_min + 0.5, thickness=film.thickness + np.float32(0.5))
    return erlif.compare([film, thicker])


def test_points_are_film_and_duty_parameter(found):
    first, *_ = film_against_duty(found)
    x, y = first.lines[0].get_data()
    npt.assert_allclose(y, found.film_min.values[0])
    npt.assert_allclose(x, 1e3 * found.duty.values[0])  # mPa s
    axes = first.lines[0].axes
    assert axes.get_xlabel() == "viscosity times speed over load [mPa s rad s⁻¹ N⁻¹]"
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_a_map_shows_the_difference_on_a_symmetric_scale(found):
    image = difference_map_of_runs(found)
    low, high = image.get_clim()
    assert low == -high
    npt.assert_array_equal(image.get_array().filled(np.nan), found.map_difference.values)
    # all valid cells differ: the outline is that of the valid cells
    x = image.axes.lines[0].get_xdata()
    assert np.nanmin(x) >= found.map_x.values[0] - 1.001


def test_a_chart_marks_what_is_beyond_its_limits():
    one = replace(example_calibration(), date="2026-01-01")
    later = replace(one, ratio_at_zero=0.8, date="2026-04-01")
    points, marked = control_chart_of(control_chart([], [one, later]), "calibration")
    assert len(marked.get_xdata()) == 2
    labels = [text.get_text() for text in marked.axes.get_xticklabels()]
    assert labels == ["2026-01-01", "2026-04-01"]
    assert points.lines[0].axes is marked.axes


def test_without_a_duty_parameter_the_figure_has_one_panel(found):
    assert len(comparison_figure(found.drop_vars("duty")).axes) == 1


def test_a_single_pair_takes_less_width_than_the_films(found):
    films, differences = comparison_figure(found).axes
    assert differences.get_position().width < 0.4 * films.get_position().width
    assert [tick.get_text() for tick in differences.get_xticklabels()] == ["2\nless 1"]
