"""Local windows: displacements of known sums, outliers, interpolation, noise of the passes."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import texture_sums
from scipy import ndimage

from erlif.registration.local import (
    replace_outliers,
    response,
    solve_windows,
    still_off,
    to_pixels,
    window_std,
)
from erlif.registration.matching import BX, BY, GXX, GYY, SUMS, move_sums

SHAPE = (30, 40)


def level_sums(information, dx, dy, shape=SHAPE):
    """Texture without a preferred direction."""
    sums = np.zeros((*shape, SUMS))
    sums[..., GXX] = sums[..., GYY] = information
    sums[..., BX], sums[..., BY] = information * dx, information * dy
    return sums


def test_window_with_a_fiftieth_of_the_texture_is_too_faint():
    """The median is that of the rest of the field."""
    sums = level_sums(10.0, 0.5, -0.5)
    sums[:, :8] *= 0.018
    sums[:, 8:16] *= 0.022
    vector, _, sound = solve_windows(sums, 0.7)
    inner = slice(3, -3)
    assert not sound[inner, :5].any()
    assert sound[inner, 11:-3].all()
    # the ridge is a thousandth of the median of both components together
    npt.assert_allclose(vector[0, inner, 11:13], 0.5 * 0.022 / (0.022 + 0.002), rtol=0.005)
    npt.assert_allclose(vector[1, inner, 20:-3], -0.5 / 1.002, rtol=1e-3)
    blank = solve_windows(0 * sums, 0.7)
    assert not blank.sound.any()
    npt.assert_array_equal(blank.vector, 0)


def slope(shape=SHAPE):
    y, x = np.indices(shape)
    return np.stack([0.02 * x - 0.01 * y, 0.03 * y + 0.01 * x])


def test_outlier_is_replaced_by_the_median_of_its_neighbours():
    field = slope()
    wild = field.copy()
    wild[:, 12, 17] += (2.0, -1.0)
    wild[1, 20, 30] -= 5.0
    found = replace_outliers(wild, np.ones(SHAPE, bool))
    npt.assert_allclose(found, field, atol=1e-12)  # the median of a plane is its middle


def test_vector_that_is_not_sound_is_replaced_and_not_used():
    field = slope()
    sound = np.ones(SHAPE, bool)
    sound[10, 10] = sound[10, 12] = False
    wild = field.copy()
    wild[:, ~sound] = 99.0
    found = replace_outliers(wild, sound)
    npt.assert_allclose(found, field, atol=0.05)
    npt.assert_array_equal(found[:, sound], field[:, sound])


def test_interpolation_reproduces_quadratics():
    """Catmull-Rom splines do, away from the outer elements."""
    rows, columns = (3.5 + 8 * np.arange(count) for count in (8, 10))

    def quadratic(y, x):
        return 0.3 + 0.01 * x - 0.02 * y + 1e-4 * x**2 - 2e-4 * y**2 + 3e-4 * x * y

    found = to_pixels(quadratic(rows[:, None], columns), rows, columns, (64, 80))
    y, x = np.indices((64, 80), dtype=float)
    inner = (slice(12, 52), slice(12, 68))
    npt.assert_allclose(found[inner], quadratic(y, x)[inner], atol=2e-6)


@pytest.mark.parametrize(("sigma", "passes"), [(2.26, 1), (2.26, 3), (4.5, 3), (1.2, 2)])
def test_response_is_that_of_the_passes_on_white_noise(sigma, passes):
    """The passes themselves: each adds what its window sees of the rest, smoothing in between."""
    rng = np.random.default_rng(4)
    noise = rng.normal(size=(512, 512))

    def window(field):
        return ndimage.gaussian_filter(field, sigma, mode="wrap", truncate=8)

    field = np.zeros_like(noise)
    for number in range(passes):
        field = field + window(noise - field)
        if number < passes - 1:
            for axis in (0, 1):
                field = ndimage.convolve1d(field, [0.25, 0.5, 0.25], axis=axis, mode="wrap")
    gain, kept = response(sigma, passes)
    npt.assert_allclose(gain, field.var() / window(noise).var(), rtol=0.05)
    left, whole = (ndimage.uniform_filter(each, 3, mode="wrap") for each in (noise - field, noise))
    npt.assert_allclose(kept, left.var() / whole.var(), rtol=0.03)


@pytest.mark.parametrize("sigma", [1.5, 2.26])
def test_standard_deviation_of_windows_is_the_scatter_of_their_vectors(sigma):
    """One pass over scores of independent noise, three times larger in y."""
    rng = np.random.default_rng(5)
    shape = (60, 80)
    sums = texture_sums(shape, rng)
    squares, variances = [], []
    for _ in range(6):
        sums[..., BX], sums[..., BY] = rng.normal(size=shape), 3 * rng.normal(size=shape)
        vector, *_ = solve_windows(sums, sigma)
        squares.append(0.5 * (vector**2).sum(0))
        rest = move_sums(sums, vector[0], vector[1])
        variances.append(window_std(rest, sigma, 1) ** 2)
    inner = (slice(None), slice(10, -10), slice(10, -10))
    ratio = np.mean(np.array(variances)[inner]) / np.mean(np.array(squares)[inner])
    # 6 fields of 2400 cells, some 4 pi sigma^2 of which share a window: 7 % in the variance
    assert ratio == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0), (-0.6, 0.8)])
def test_displacement_beyond_the_tolerance_is_off(direction):
    for length, off in ((0.3, True), (0.15, False)):
        sums = level_sums(1e6, *(length * np.array(direction)))
        assert still_off(sums, 8, tolerance=0.2).all() == off
        assert still_off(sums, 8, tolerance=0.2).any() == off


@pytest.mark.parametrize("step", [8, 16])
def test_displacement_is_off_only_if_it_is_clear(step):
    """A window of 64 px has n = (64/step)^2 cells; of four times their noise, 5 sigma are needed.

    The variance of a component is 4 / (n information), so the limit is information = 100 / (n d^2).
    """
    d = 0.5
    cells = (64 / step) ** 2
    limit = 5**2 * 4 / (cells * d**2)
    for factor, off in ((1.15, True), (0.85, False)):
        found = still_off(level_sums(factor * limit, d, 0.0), step, tolerance=0.1)
        assert found[10:-10, 10:-10].all() == off
        assert found[10:-10, 10:-10].any() == off
