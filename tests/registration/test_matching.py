"""Gauss-Newton sums against closed forms: ramps, sinusoids, and sums written out in numpy."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.matching import (
    AA,
    AB,
    BB,
    BX,
    BY,
    CROSS,
    EE,
    GXX,
    GXY,
    GYY,
    SUMS,
    WEIGHT,
    cell_sums,
    move_sums,
    solve_shift,
    without_noise,
)

SHAPE = (48, 64)
Y, X = np.indices(SHAPE, dtype=np.float64)
ONES = np.ones(SHAPE, np.float32)
INSIDE = (slice(2, -2), slice(2, -2))  # what a five-point derivative reaches


def waves(dx=0.0, dy=0.0, seed=3):
    """A smooth texture whose features lie (dx, dy) further right and down."""
    rng = np.random.default_rng(seed)
    total = np.zeros(SHAPE)
    for _ in range(12):
        kx, ky = rng.uniform(-0.5, 0.5, 2)
        total += np.cos(kx * (X - dx) + ky * (Y - dy) + rng.uniform(0, 6))
    return total.astype(np.float32)


def test_gradients_are_those_of_the_mean_image_and_products_are_summed_over_the_inner_pixels():
    a, b = waves(seed=1), waves(seed=2)

    def gradient(f, axis):
        f = np.asarray(f, float)
        shifted = [np.roll(f, -n, axis) for n in (-2, -1, 1, 2)]
        return ((shifted[0] - shifted[3]) + 8 * (shifted[2] - shifted[1]))[INSIDE] / 12

    total = cell_sums(a, ONES, b, 8).sum((0, 1))
    gx, gy = (0.5 * (gradient(a, axis) + gradient(b, axis)) for axis in (1, 0))
    p, q = a[INSIDE].astype(float), b[INSIDE].astype(float)
    e = p - q
    cross = gradient(a, 1) * gradient(b, 1) + gradient(a, 0) * gradient(b, 0)
    products = {GXX: gx * gx, GXY: gx * gy, GYY: gy * gy, BX: gx * e, BY: gy * e, CROSS: cross}
    for k, product in products.items():
        npt.assert_allclose(total[k], product.sum(), rtol=1e-4, atol=0.05)
    for k, product in {AA: p * p, BB: q * q, EE: e * e, AB: p * q}.items():
        npt.assert_allclose(total[k], product.sum(), rtol=1e-4 if k == AB else 1e-5)


def test_left_over_pixels_belong_to_the_last_cells():
    shape = (35, 50)
    a = np.ones(shape, np.float32)
    weight = cell_sums(a, a, a, 8)[..., WEIGHT]
    assert weight.shape == (4, 6)
    assert weight.sum() == 31 * 46
    assert weight[-1, 2] == (35 - 24 - 2) * 8
    assert weight[1, -1] == 8 * (50 - 40 - 2)


@pytest.mark.parametrize("difference", [2.0, 4.0, 8.0])
def test_a_large_difference_loses_weight(difference):
    """w = 1/(1 + t) with t = (e / 4 rms)^2; the slope of w e is (1 - t) w^2, never negative."""
    ramp = X.astype(np.float32)
    sums = cell_sums(ramp, ONES, ramp - np.float32(difference), 8, scale=np.ones((6, 8)))[2, 3]
    t = (difference / 4) ** 2
    w = 1 / (1 + t)
    npt.assert_allclose(sums[WEIGHT], 64 * w, rtol=1e-5)
    npt.assert_allclose(sums[BX], 64 * w * difference, rtol=1e-5)
    npt.assert_allclose(sums[EE], 64 * w * difference**2, rtol=1e-5)
    npt.assert_allclose(sums[GXX], 64 * max(1 - t, 0) * w**2, rtol=1e-5)
    npt.assert_allclose(sums[CROSS], 64 * max(1 - t, 0) * w**2, rtol=1e-5)


def test_a_shift_solves_the_two_equations():
    sums = np.zeros((1, 2, SUMS))
    sums[0, 0, [GXX, GXY, GYY]] = 4, 1, 3
    sums[0, 1, [GXX, GXY, GYY]] = 2, -3, 5
    d = np.array([0.5, -0.25])
    sums[0, 1, [BX, BY]] = np.array([[6, -2], [-2, 8]]) @ d
    npt.assert_allclose(solve_shift(sums), d)


def test_texture_of_one_direction_determines_no_shift():
    ramp = X.astype(np.float32)
    assert solve_shift(cell_sums(ramp, ONES, ramp - 1, 8)) == (0.0, 0.0)
    assert solve_shift(np.zeros((2, 2, SUMS))) == (0.0, 0.0)


def test_moved_sums_are_those_of_the_moved_difference():
    """To first order e becomes e - g d; sums of random gradients and differences, written out."""
    rng = np.random.default_rng(4)
    gx, gy, e = rng.normal(size=(3, 2, 3, 50))
    dx, dy = rng.normal(size=(2, 2, 3))

    def sums_of(e):
        sums = np.zeros((2, 3, SUMS))
        products = {GXX: gx * gx, GXY: gx * gy, GYY: gy * gy, BX: gx * e, BY: gy * e, EE: e * e}
        for k, product in products.items():
            sums[..., k] = product.sum(-1)
        return sums

    before = sums_of(e)
    kept = before.copy()
    expected = sums_of(e - gx * dx[..., None] - gy * dy[..., None])
    npt.assert_allclose(move_sums(before, dx, dy), expected, atol=1e-12)
    npt.assert_array_equal(before, kept)


def test_noise_of_the_cameras_is_taken_out_of_the_gradient_products():
    """Half the noise of each camera is in the mean image; only the texture is in their product."""
    rng = np.random.default_rng(6)
    texture = np.tile(waves(), (8, 8))
    a, b = (texture + rng.normal(0, 0.5, texture.shape).astype(np.float32) for _ in range(2))
    weight = np.ones_like(texture)
    clean = cell_sums(texture, weight, texture, 8)[2:-2, 2:-2, GXX : GYY + 1].sum((0, 1))
    noisy = cell_sums(a, weight, b, 8)
    found = without_noise(noisy)[2:-2, 2:-2, GXX : GYY + 1].sum((0, 1))
    npt.assert_allclose(found[[0, 2]], clean[[0, 2]], rtol=0.02)

    # the squares of the five coefficients add up to 130/144
    excess = noisy[2:-2, 2:-2, GXX].sum() - clean[0]
    npt.assert_allclose(excess, 130 / 144 * 0.5**2 / 2 * 64 * 44 * 60, rtol=0.05)
    assert excess > 0.1 * clean[0]
