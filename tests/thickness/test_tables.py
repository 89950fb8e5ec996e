"""The tables of a calibration in single precision."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.fixture import with_systematics

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


@pytest.mark.parametrize("correlation", [0.0, 1.0, -0.8])
def test_errors_that_grow_are_those_of_their_share_of_the_run(calibration, correlation):
    """Between first and last frame as by the covariance itself, whatever grows with what stays."""
    whole = with_systematics(calibration, temperature=0.0, wall=0.01)
    covariance = 0.01**2 * np.array([[1.0, correlation], [correlation, 1.0]])
    whole = replace(whole, systematics=whole.systematics.adding("temperature", covariance))
    assert whole.systematics.grows_apart == (correlation == 0)

    first, middle, last = (FilmTables.of(whole.at(share)) for share in (0.0, 0.5, 1.0))
    for share in (0.25, 0.5, 0.8):
        found, expected = (
            tables.films[1].view(np.float32)
            for tables in (
                first.growing_to(last, share, middle if correlation else None),
                FilmTables.of(whole.at(share)),
            )
        )
        npt.assert_allclose(found, expected, rtol=1e-5)
