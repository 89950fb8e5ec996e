"""Figures of a pressure: values, bands and loads are where the dataset has them."""

import numpy.testing as npt
import pytest
from scenes.pictures import picture, without_texts

from erlif.show import plots
from erlif.show.plots.pressure import best_trigger


@pytest.fixture
def found():
    return plots.example_pressure()


def test_the_map_lies_in_the_millimetres_of_the_image(found):
    image = plots.pressure_map(found, trigger=2)
    npt.assert_array_equal(image.get_array(), found.pressure.values[2])
    npt.assert_allclose(image.get_extent()[:2], [0.125 - 0.168, 15.875 + 0.168], atol=1e-3)

    # nothing is drawn beyond the first and last pixels of the image
    npt.assert_allclose(image.axes.get_xlim(), [0.125, 15.875])
    npt.assert_allclose(image.axes.get_ylim(), [5.875, 0.125])


def test_the_band_is_one_standard_deviation_about_the_profile(found):
    band, line, peak = plots.pressure_profile(found, trigger=1)
    npt.assert_array_equal(line.get_ydata(), found.pressure_profile.values[1])
    top = band.get_paths()[0].vertices[:, 1].max()
    assert top == pytest.approx(found.pressure_profile.values[1].max() * (1 + 0.05))
    assert peak.lines[0].get_xdata() == 8.0


def test_every_load_is_within_the_axis_and_below_the_legend(found):
    """Also a negative one, with its bar."""
    found["load_from_pressure"] = ("trigger", [-230.0, 220.0, 400.0])
    found["load_from_pressure_std"] = ("trigger", [10.0, 8.0, 70.0])
    figure = plots.pressure_figure(found)
    ax = figure.axes[2]
    low, high = ax.get_ylim()
    assert low < -240
    assert high > 470
    figure.draw_without_rendering()
    legend = ax.get_legend()
    assert legend.get_title().get_text() == "bars: one standard deviation"
    assert legend.get_window_extent().y0 >= ax.bbox.y1
    assert {text.get_text() for text in legend.get_texts()} == {"outward", "logged"}


def test_the_figure_shows_the_trigger_that_is_known_best(found):
    assert best_trigger(found) == 1
    for given, shown in ((None, 1), (2, 2)):
        drawn = plots.pressure_figure(found, trigger=given).axes[0]
        assert drawn.get_title(loc="left").endswith(f"trigger {shown}")


@picture
def test_pressure():
    return without_texts(plots.pressure_figure(plots.example_pressure()))
