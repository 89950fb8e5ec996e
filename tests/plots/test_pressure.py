"""Figures of a pressure: values, bands and loads are where the dataset has them."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif import plots
from erlif.core.errors import ConfigError, ErlifError
from erlif.plots.pressure import best_trigger


@pytest.fixture
def found():
    return plots.example_pressure()


def test_the_map_lies_in_the_millimetres_of_the_image(found):
    image = plots.pressure_map(found, trigger=2)
    npt.assert_array_equal(image.get_array(), found.pressure.values[2])
    npt.assert_allclose(image.get_extent()[:2], [0.125 - 0.168, 15.875 + 0.168], atol=1e-3)


def test_the_band_covers_95_per_cent_about_the_profile(found):
    band, line, peak = plots.pressure_profile(found, trigger=1)
    npt.assert_array_equal(line.get_ydata(), found.pressure_profile.values[1])
    top = band.get_paths()[0].vertices[:, 1].max()
    assert top == pytest.approx(found.pressure_profile.values[1].max() * (1 + 1.96 * 0.05))
    assert peak.lines[0].get_xdata() == 8.0


def test_the_load_has_its_error_and_the_logged_one(found):
    *points, logged = plots.load_balance(found)
    drawn = np.concatenate([one.lines[0].get_ydata() for one in points])
    npt.assert_allclose(np.sort(drawn), np.sort(found.load_from_pressure.values))
    npt.assert_allclose(logged.get_ydata(), found["load"].values)


def test_the_figure_shows_the_trigger_that_is_known_best(found):
    assert best_trigger(found) == 1
    assert plots.pressure_figure(found).axes[0].get_title() == "trigger 1"
    assert plots.pressure_figure(found, trigger=2).axes[0].get_title() == "trigger 2"


def test_a_pressure_that_is_not_known_is_not_drawn(found):
    with pytest.raises(ConfigError, match=r"known at no trigger\. made by formula"):
        plots.pressure_figure(found.assign(peak_pressure=np.nan * found.peak_pressure))
    with pytest.raises(ErlifError, match="Expected a trigger from 0 to 2"):
        plots.pressure_map(found, trigger=3)
