"""The tables of a calibration in single precision."""

import numpy as np
import pytest

from erlif.show.plots import example_calibration
from erlif.thickness import FilmTables


@pytest.fixture(scope="module")
def calibration():
    return example_calibration()


def test_tables_hold_exactly_the_log_ratios_between_their_ends(calibration):
    """The numbers in single precision next to the limits, in double precision."""
    table, limits = calibration.inverse, FilmTables.of(calibration).limits
    last = table.start + table.step * (table.thickness.size - 1)
    below, above = np.float32(-np.inf), np.float32(np.inf)
    assert float(np.nextafter(limits[4], below)) < table.start <= float(limits[4])
    assert float(limits[5]) <= last + 1e-15
    assert float(np.nextafter(limits[5], above)) > last


def test_tables_give_the_film_that_made_the_ratio(calibration):
    (start, per_step, _), (thickness, slopes), _ = FilmTables.of(calibration)
    film = np.linspace(1.0, 10.0, 50)
    place = (calibration.predict_log(film) - start) * per_step
    entries = np.arange(thickness.size)
    found = np.interp(place, entries, thickness)
    assert np.abs(found - film).max() < 1e-3

    # the rate is the slope of the film over the log ratio, by differences
    around = np.gradient(film, calibration.predict_log(film))
    rate = np.interp(place, entries, slopes.view(np.float32)[::2])
    np.testing.assert_allclose(rate[1:-1], around[1:-1], rtol=0.02)
