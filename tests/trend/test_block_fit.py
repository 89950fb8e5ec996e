"""Shapes fitted to blocks, and sums whose terms are correlated within strips."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import WHOLE, X, Y, exact_ratios, known_calibration, true_log_ratio

from erlif.trend.block_fit import average_blocks, fit_blocks, sum_by_strips
from erlif.trend.blocks import sum_blocks
from erlif.trend.curve import FilmCurve


def exact_blocks(film):
    """Blocks of a film without noise."""
    return average_blocks(sum_blocks(exact_ratios(film), WHOLE), sliding_along_x=True)


@pytest.fixture(scope="module")
def curve():
    return FilmCurve.of(known_calibration())


def test_positions_of_blocks_are_means_of_those_of_their_pixels():
    """25 blocks along x, 20 along y; 7.5/199 is the first mean of eight pixels on a scale of 2."""
    blocks = exact_blocks(np.full((Y.size, X.size), 3.0))
    scale = np.linspace(-1, 1, X.size).reshape(-1, 8)
    npt.assert_allclose(blocks.along[:25], scale.mean(axis=1), atol=1e-12)
    npt.assert_allclose(blocks.along_squared[:25], (scale**2).mean(axis=1), atol=1e-12)
    npt.assert_array_equal(blocks.strip_along, np.repeat(np.arange(20), 25))
    npt.assert_array_equal(blocks.strip_across, np.tile(np.arange(25), 20))


@pytest.mark.parametrize("base", [0.0, 230.0])
def test_amplitudes_of_shapes_are_found_from_any_base(curve, base):
    """A film of 3 um with a tilt of 0.4 um; the mean of a curved ratio over a block is 1e-5 off."""
    blocks = exact_blocks(3 + 0.4 * np.linspace(-1, 1, X.size)[None, :] + 0 * Y[:, None])
    fit = fit_blocks(blocks, curve, np.stack([0 * blocks.along + 1, blocks.along]), base=base)
    npt.assert_allclose(fit.amplitudes, [3 - base, 0.4], atol=1e-4)
    npt.assert_allclose(fit.film, 3 + 0.4 * blocks.along, atol=1e-4)


def test_shapes_that_the_blocks_do_not_separate_are_not_fitted(curve):
    blocks = exact_blocks(np.full((Y.size, X.size), 3.0))
    zero = np.zeros_like(blocks.along)
    assert fit_blocks(blocks, curve, np.stack([zero + 1, zero])) is None


def test_curvature_is_that_of_the_weighted_squares(curve):
    """Without outliers: the inverse is the covariance of least squares with known weights."""
    blocks = exact_blocks(np.full((Y.size, X.size), 3.0))
    blocks = replace(blocks, variance=np.full(500, 1e-6))
    fit = fit_blocks(blocks, curve, np.ones((1, 500)))
    slope = (true_log_ratio(np.array(3.001)) - true_log_ratio(np.array(2.999))) / 0.002
    npt.assert_allclose(fit.curvature, [[500 * slope**2 / 1e-6]], rtol=1e-3)


def test_sums_of_independent_terms_have_the_variance_of_their_terms():
    """400 draws of 24 strips of 5 blocks: variances and their ratio to 10 %."""
    rng = np.random.default_rng(1)
    strip = np.repeat(np.arange(24), 5)
    scale = np.array([1.0, 3.0])[:, None]
    found = np.mean(
        [sum_by_strips(scale * rng.standard_normal((1, 120)), strip) for _ in range(400)], axis=0
    )
    expected = 120 * scale @ scale.T * 24 / 23  # the correction for the number of strips
    npt.assert_allclose(found, expected, rtol=0.1)


def test_terms_that_a_strip_shares_raise_the_variance():
    """Five equal terms of variance 1 sum up to 25 in each strip, not to 5."""
    rng = np.random.default_rng(2)
    strip = np.repeat(np.arange(24), 5)
    draws = [sum_by_strips(rng.standard_normal((1, 24))[:, strip], strip) for _ in range(400)]
    npt.assert_allclose(np.mean(draws), 24 * 25 * 24 / 23, rtol=0.1)
