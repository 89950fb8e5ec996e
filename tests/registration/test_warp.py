"""Warping by cubic B-splines: against scipy's, against straight lines, and what it does to noise."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from scipy.interpolate import make_interp_spline

from erlif.core.errors import RegistrationError
from erlif.registration import interpolation_variance_factor, spline_coefficients, warp


def grid(shape):
    y, x = np.mgrid[: shape[0], : shape[1]].astype(float)
    return x, y


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


@settings(max_examples=30, deadline=None)
@given(st.floats(-9, 9), st.floats(-9, 9))
def test_a_ramp_is_moved_exactly(dx, dy):
    shape = (48, 64)
    x, y = grid(shape)
    found = warp(3 * x - 2 * y, np.full(shape, dx), np.full(shape, dy))
    inner = np.isfinite(found)
    inner[:14] = inner[-14:] = (
        False  # the mirrored edge bends a ramp; the bend dies out by 0.27 a pixel
    )
    inner[:, :14] = inner[:, -14:] = False
    npt.assert_allclose(found[inner], (3 * (x + dx) - 2 * (y + dy))[inner], atol=1e-3)


def test_drift_is_added_to_the_displacement():
    image = np.random.default_rng(2).normal(size=(40, 50))
    zero = np.zeros(image.shape)
    npt.assert_allclose(
        warp(image, zero, zero, (1.25, -0.5)), warp(image, zero + 1.25, zero - 0.5), atol=1e-6
    )


def test_displacement_points_from_camera_1_to_camera_2():
    image = np.zeros((20, 30))
    image[7, 12] = 1.0  # a point that camera 2 sees at x = 12, y = 7
    found = warp(image, np.full(image.shape, 3.0), np.full(image.shape, -2.0))
    assert np.unravel_index(np.nanargmax(found), found.shape) == (9, 9)


def test_integers_and_threads_change_nothing():
    counts = np.random.default_rng(3).integers(0, 4096, (90, 110)).astype(np.uint16)
    x, y = grid(counts.shape)
    dx, dy = 0.01 * x, -0.013 * y
    alone = warp(counts, dx, dy, threads=1)
    npt.assert_array_equal(alone, warp(counts, dx, dy, threads=3))
    npt.assert_array_equal(alone, warp(counts.astype(float), dx, dy))
    npt.assert_array_equal(spline_coefficients(counts), spline_coefficients(counts, threads=3))


def test_a_hole_spreads_to_its_taps_and_no_further():
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


def test_nothing_is_answered_outside_camera_2():
    image = np.ones((20, 20))
    far = np.full(image.shape, 1e12)
    assert np.isnan(warp(image, far, far)).all()
    assert np.isnan(warp(image, np.full(image.shape, np.nan), 0 * far)).all()


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
    npt.assert_allclose(
        interpolation_variance_factor(0 * x, 0 * x, (fraction, fraction)), one**2, rtol=1e-5
    )


@pytest.mark.parametrize(("dx", "dy"), [(0.5, 0.5), (0.25, 0.0), (-3.3, 8.7)])
def test_noise_of_a_warped_image_has_the_announced_variance(dx, dy):
    noise = np.random.default_rng(5).normal(size=(700, 700))
    shift_x, shift_y = np.full(noise.shape, dx), np.full(noise.shape, dy)
    found = warp(noise, shift_x, shift_y)[20:-20, 20:-20]
    ratio = np.nanvar(found) / interpolation_variance_factor(shift_x, shift_y)[0, 0]
    assert abs(ratio - 1) < 4 * np.sqrt(
        2 / (found.size / 3)
    )  # warped pixels are correlated with few neighbours


def test_variance_factor_is_not_known_where_the_displacement_is_not():
    assert np.isnan(interpolation_variance_factor(np.full((2, 2), np.nan), np.zeros((2, 2)))).all()
