"""What the surroundings decide, row by row, against the plain means of `find_range`."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.plain import find_range

from erlif.core.flags import Flag
from erlif.show.plots import example_calibration
from erlif.thickness import FilmTables
from erlif.thickness.surroundings import PAD, Surroundings, decide, enter_row

EPS = float(np.finfo(np.float32).eps)


@pytest.mark.parametrize("shape", [(40, 33), (5, 20), (60, 6)])
@pytest.mark.parametrize("flagged", [0.0, 0.2])
def test_flags_and_slopes_are_those_of_the_plain_means(shape, flagged):
    """A film from below to above the range, and noise that is larger in some places."""
    rng = np.random.default_rng(8)
    calibration = example_calibration()
    lowest, highest = calibration.predict_log(calibration.covered_range)
    log_ratio = np.linspace(lowest - 0.1, highest + 0.1, shape[1]) * np.ones(shape)
    log_ratio = (log_ratio + 0.01 * rng.normal(size=shape)).astype(np.float32)
    variance = rng.uniform(1e-5, 1e-3, shape).astype(np.float32)
    flags = np.where(rng.random(shape) < flagged, Flag.DIM, 0).astype(np.uint16)
    near, beyond = find_range(log_ratio, variance, flags, calibration)

    images = log_ratio, variance, np.zeros(shape, np.float32), flags
    rows = tuple(Surroundings.of(shape[1], offset=0.1, variance=3e-4))
    limits = FilmTables.of(calibration).limits
    around, half_way = np.empty(shape, np.uint8), np.empty(shape, np.float32)
    found = np.empty(shape, np.uint8)
    for u in range(shape[0] + PAD):
        enter_row(images, u, rows)
        if u >= PAD:
            i = u - PAD
            decide(log_ratio, i, limits, rows, around[i], half_way[i], found)

    npt.assert_array_equal(around, np.where(flags == 0, beyond, flags))
    sound = flags == 0
    npt.assert_allclose(half_way[sound], 0.5 * (log_ratio + near)[sound], atol=8 * EPS)
    own = np.where(log_ratio < limits[4], Flag.BELOW_RANGE, 0)
    own = np.where(log_ratio > limits[5], Flag.ABOVE_RANGE, own)
    npt.assert_array_equal(found, np.where(around == 0, own, around))
