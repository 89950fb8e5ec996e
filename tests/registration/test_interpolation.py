"""Warping by cubic B-splines: against scipy's, against polynomials, and its effect on noise."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy import ndimage
from scipy.interpolate import make_interp_spline

from erlif.core.errors import RegistrationError
from erlif.registration import interpolation_variance_factor, warp
from erlif.registration.interpolation import laid_over, spline_coefficients


def grid(shape):
    y, x = np.mgrid[: shape[0], : shape[1]].astype(float)
    return x, y


@pytest.mark.parametrize("shape", [(40, 57), (17, 33), (3, 5), (5, 3), (3, 3)])
def test_coefficients_are_those_of_scipy_with_mirrored_margins(shape):
    image = np.random.default_rng(7).normal(size=shape)
    found = spline_coefficients(image)
    truth = ndimage.spline_filter(image, 3, mode="mirror")
    assert found.dtype == np.float32
    npt.assert_allclose(found[2:-2, 2:-2], truth, atol=2e-5)
    npt.assert_array_equal(found, np.pad(found[2:-2, 2:-2], 2, mode="reflect"))


@pytest.mark.parametrize("shape", [(61, 83), (16, 200), (5, 4), (3, 3)])
def test_warp_is_the_cubic_spline_of_scipy(shape):
    image = np.random.default_rng(1).normal(size=shape)
    x, y = grid(shape)
    dx, dy = 0.31 + 0.02 * x - 0.01 * y, -0.74 + 0.03 * y
    truth = ndimage.map_coordinates(image, [y + dy, x + dx], order=3, mode="mirror")
    inside = (x + dx >= 0) & (x + dx <= shape[1] - 1) & (y + dy >= 0) & (y + dy <= shape[0] - 1)
    found = warp(image, dx, dy)
    assert found.dtype == np.float32
    npt.assert_array_equal(np.isfinite(found), inside)
    npt.assert_allclose(found[inside], truth[inside], atol=5e-6)


def test_outermost_pixel_is_the_last_point_of_the_image():
    image = np.random.default_rng(10).normal(size=(12, 15))
    flat = np.zeros(image.shape)
    for step, column in ((1e-3, -1), (-1e-3, 0)):
        inner = np.delete(np.arange(15), column)
        found = warp(image, flat + step, flat)
        assert np.isnan(found[:, column]).all()
        assert np.isfinite(found[:, inner]).all()
        found = warp(image.T, flat.T, flat.T + step)
        assert np.isnan(found[column]).all()
        assert np.isfinite(found[inner]).all()


def test_point_beside_a_marked_pixel_is_nan():
    """The four pixels around the point count, also in the last row and column."""
    image = np.random.default_rng(13).normal(size=(12, 14))
    coefficients = spline_coefficients(image)
    for row, column in ((5, 6), (11, 13), (0, 0)):
        bad = np.zeros(image.shape, bool)
        bad[row, column] = True
        half = np.full(image.shape, 0.5, np.float32)
        out = laid_over((coefficients, bad), half, half, (0.0, 0.0), 1)
        x, y = grid(image.shape)
        inside = (x + 0.5 <= 13) & (y + 0.5 <= 11)
        near = (np.abs(x + 0.5 - column) < 1) & (np.abs(y + 0.5 - row) < 1)
        npt.assert_array_equal(np.isnan(out), ~inside | near)


def test_result_does_not_depend_on_integers_or_threads():
    counts = np.random.default_rng(3).integers(0, 4096, (90, 110)).astype(np.uint16)
    x, y = grid(counts.shape)
    dx, dy = 0.01 * x, -0.013 * y
    alone = warp(counts, dx, dy, threads=1)
    npt.assert_array_equal(alone, warp(counts, dx, dy, threads=3))
    npt.assert_array_equal(alone, warp(counts.astype(float), dx, dy))
    npt.assert_array_equal(spline_coefficients(counts), spline_coefficients(counts, threads=3))


def test_a_hole_spreads_to_its_sixteen_taps_only():
    image = np.random.default_rng(4).normal(size=(40, 40))
    holed = image.copy()
    holed[20, 15] = np.nan
    shift = np.full(image.shape, 0.5)
    whole, found = warp(image, shift, shift), warp(holed, shift, shift)
    lost = np.isnan(found) & np.isfinite(whole)
    rows, cols = np.nonzero(lost)
    assert (rows.min(), rows.max(), cols.min(), cols.max()) == (18, 21, 13, 16)
    sound = np.isfinite(found)
    # the prefilter reaches further, but the hole was filled from its neighbours
    assert np.abs(found - whole)[sound].max() < 0.5 * np.nanstd(image)


def test_images_and_displacements_must_be_usable():
    with pytest.raises(RegistrationError, match="one shape"):
        warp(np.ones((9, 9)), np.zeros((9, 9)), np.zeros((9, 8)))
    with pytest.raises(RegistrationError, match="at least 3 by 3"):
        warp(np.ones((2, 9)), np.zeros((9, 9)), np.zeros((9, 9)))


@pytest.mark.parametrize("fraction", [0.0, 0.1, 0.37, 0.5, 0.82])
def test_variance_factor_is_the_sum_of_squared_cardinal_splines(fraction):
    nodes = np.arange(81)
    weights = [make_interp_spline(nodes, np.eye(81)[k], k=3)(40 + fraction) for k in range(81)]
    one = np.sum(np.square(weights))
    x = np.full((4, 5), fraction)
    npt.assert_allclose(interpolation_variance_factor(x, 0 * x), one, rtol=1e-5)
    npt.assert_allclose(interpolation_variance_factor(x - 7, x + 3), one**2, rtol=1e-5)


@pytest.mark.parametrize("unknown", [np.nan, np.inf, 1e12, 1e7, -1e7])
def test_value_and_factor_are_not_known_where_the_displacement_is_not(unknown):
    flat = np.zeros((20, 20))
    for place in ((flat + unknown, flat), (flat, flat + unknown)):
        assert np.isnan(warp(np.ones((20, 20)), *place)).all()
        assert np.isnan(interpolation_variance_factor(*place)).all()
