"""Profiles of maps that are formulas, statistics against numpy, differences with known noise."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ErlifError
from erlif.show.view.measures import (
    line_profile,
    region_statistics,
    select_region,
    significance,
    subtract_maps,
)

GRID = {"x": (1.0, 0.1), "y": (2.0, 0.1)}
ROWS, COLUMNS = np.indices((60, 80)).astype(np.float32)
PLANE = (2 * (1.0 + 0.1 * COLUMNS) - 3 * (2.0 + 0.1 * ROWS)).astype(np.float32)
STD = np.full(PLANE.shape, 0.5, np.float32)
POSITION = 0.06 * np.arange(300)


def test_a_plane_is_read_in_any_direction():
    """The nearest pixel is at most half a pixel off in x and in y."""
    for line in ((1.0, 2.0, 8.9, 7.9), (3.0, 7.0, 3.0, 3.0), (8, 4, 2, 4)):
        x0, y0, x1, y1 = line
        found = line_profile(PLANE, STD, line, **GRID)
        share = found["position"] / np.hypot(x1 - x0, y1 - y0)
        truth = 2 * (x0 + share * (x1 - x0)) - 3 * (y0 + share * (y1 - y0))
        assert abs(found["value"] - truth).max() <= 0.05 * (2 + 3) + 1e-5
        npt.assert_allclose(found["position"][[0, -1]], [0, np.hypot(x1 - x0, y1 - y0)])
        npt.assert_allclose(found["std"], 0.5)


def test_flagged_pixels_interrupt_a_thin_line_and_are_left_out_of_a_wide_one():
    values = PLANE.copy()
    values[30, 20:25] = np.nan
    thin = line_profile(values, STD, (1.0, 5.0, 8.9, 5.0), **GRID)
    assert np.flatnonzero(np.isnan(thin["value"])).tolist() == [20, 21, 22, 23, 24]
    assert np.isnan(thin["std"][20:25]).all()
    wide = line_profile(values, STD, (1.0, 5.0, 8.9, 5.0), **GRID, width=3)
    npt.assert_allclose(wide["value"], 2 * (1 + 0.1 * np.arange(80)) - 15, atol=1e-5)
    npt.assert_allclose(wide["std"][[0, 22]], [0.5 / 3**0.5, 0.5 / 2**0.5])
    outside = line_profile(PLANE, STD, (20.0, 20.0, 25.0, 20.0), **GRID)
    assert np.isnan(outside["value"]).all()


def test_an_endless_line_and_a_region_without_pixels_are_refused():
    with pytest.raises(ErlifError, match=r"at most 100000 px.*Draw a shorter one"):
        line_profile(PLANE, STD, (0, 0, 1e9, 0), **GRID)
    for region in ((50, 60, 0, 1), (1.001, 1.002, 0, 1), (2, 1, 0, 1)):
        with pytest.raises(ErlifError, match="Draw another one"):
            select_region(POSITION, POSITION, region)


def test_a_region_holds_the_pixels_whose_centres_lie_in_it():
    rows, columns = select_region(POSITION, POSITION[:100], (0.59, 1.21, 0.0, 0.6))
    inside = (POSITION >= 0.59) & (POSITION <= 1.21)
    npt.assert_array_equal(np.arange(300)[columns], np.flatnonzero(inside))
    assert rows == slice(0, 11)  # 0.6 mm is the centre of row 10


def test_statistics_are_those_of_the_valid_pixels():
    rng = np.random.default_rng(3)
    values = rng.normal(5, 0.4, (40, 50)).astype(np.float32)
    std = rng.uniform(0.2, 0.6, values.shape).astype(np.float32)
    flags = (rng.random(values.shape) < 0.2).astype(np.uint16) * 16
    values[0, 0], flags[0, 0] = np.nan, 0
    good = (flags == 0) & np.isfinite(values)
    inside = values[good].astype(float)
    found = region_statistics(values, flags, std, 0.1 * std)
    expected = {
        "count": 2000,
        "valid": np.count_nonzero(good),
        "mean": inside.mean(),
        "std": inside.std(),
        "min": inside.min(),
        "max": inside.max(),
        "mean_std": np.sqrt(np.sum(std[good] ** 2.0)) / inside.size,
        "mean_std_shared": 0.1 * std[good].mean(),
    }
    for name, value in expected.items():
        npt.assert_allclose(found[name], value, rtol=1e-5)

    nothing = region_statistics(values, np.full_like(flags, 8), std, std)
    assert nothing["valid"] == 0
    assert np.isnan([nothing[name] for name in ("mean", "std", "min", "max", "mean_std")]).all()


def noisy(mean, std, seed):
    values = np.random.default_rng(seed).normal(mean, std, (80, 100)).astype(np.float32)
    return values, np.full(values.shape, std, np.float32), np.zeros(values.shape, np.uint16)


def test_a_difference_is_valid_where_both_maps_are_and_scatters_as_its_standard_deviation():
    difference, std, _ = subtract_maps(noisy(5, 0.3, 1), noisy(5, 0.4, 2))
    npt.assert_allclose(std, 0.5, rtol=1e-6)
    pull = significance(difference, std)
    assert abs(float(pull.mean())) < 4 / 8000**0.5
    assert 0.97 < float(pull.std()) < 1.03
    one, other = noisy(5, 0.3, 1), noisy(4, 0.3, 2)
    one[2][0, 0], other[2][0, 1] = 16, 128
    difference, std, flags = subtract_maps(one, other)
    assert flags[0, :3].tolist() == [16, 128, 0]
    assert np.isnan(difference[0, :2]).all()
    assert np.isnan(std[0, :2]).all()
    npt.assert_allclose(difference[0, 2], other[0][0, 2] - one[0][0, 2])
    assert np.isnan(significance(np.ones((1, 1), np.float32), np.zeros((1, 1), np.float32)))
