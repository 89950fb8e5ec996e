"""Statistics against numpy."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ErlifError
from erlif.show.view.regions import region_statistics, select_region

POSITION = 0.06 * np.arange(300)


def test_a_region_holds_the_pixels_whose_centres_lie_in_it():
    rows, columns = select_region(POSITION, POSITION[:100], (0.59, 1.21, 0.0, 0.6))
    inside = (POSITION >= 0.59) & (POSITION <= 1.21)
    npt.assert_array_equal(np.arange(300)[columns], np.flatnonzero(inside))
    assert rows == slice(0, 11)  # 0.6 mm is the centre of row 10


@pytest.mark.parametrize("region", [(50, 60, 0, 1), (1.001, 1.002, 0, 1), (2, 1, 0, 1)])
def test_a_region_without_pixels_is_refused(region):
    with pytest.raises(ErlifError, match="Draw another one"):
        select_region(POSITION, POSITION, region)


def test_statistics_are_those_of_the_valid_pixels():
    rng = np.random.default_rng(3)
    values = rng.normal(5, 0.4, (40, 50)).astype(np.float32)
    std = rng.uniform(0.2, 0.6, values.shape).astype(np.float32)
    flags = (rng.random(values.shape) < 0.2).astype(np.uint8) * 16
    values[0, 0], flags[0, 0] = np.nan, 0
    good = (flags == 0) & np.isfinite(values)
    found = region_statistics(values, flags, std, 0.1 * std)
    inside = values[good].astype(float)
    assert (found["count"], found["valid"]) == (2000, np.count_nonzero(good))
    npt.assert_allclose(
        [found["mean"], found["std"], found["min"], found["max"]],
        [inside.mean(), inside.std(), inside.min(), inside.max()],
    )
    npt.assert_allclose(
        found["mean_std"], np.sqrt(np.sum(std[good] ** 2.0)) / inside.size, rtol=1e-5
    )
    npt.assert_allclose(found["mean_std_shared"], 0.1 * std[good].mean(), rtol=1e-5)


def test_a_region_without_valid_pixels_has_no_mean():
    nothing = np.full((2, 2), np.nan, np.float32)
    found = region_statistics(nothing, np.full((2, 2), 8, np.uint8), nothing, nothing)
    assert (found["count"], found["valid"]) == (4, 0)
    assert np.isnan(
        [found["mean"], found["std"], found["min"], found["max"], found["mean_std"]]
    ).all()
