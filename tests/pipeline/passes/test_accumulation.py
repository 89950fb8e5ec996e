"""Sums of frame pairs, held to the plain sum."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.flags import Flag
from erlif.pipeline.passes import PairRatio, PairSum
from erlif.ratio import RatioSum

SHAPE = (43, 58)
EPS = float(np.finfo(np.float32).eps)


def pairs_of(count, shape=SHAPE, seed=3):
    """Frames of different light with flagged pixels, some of them in all frames."""
    rng = np.random.default_rng(seed)
    pairs = []
    for _ in range(count):
        variance = rng.uniform(1e-4, 4e-4) * rng.uniform(0.7, 1.3, shape)
        log_ratio = -0.2 + np.sqrt(variance) * rng.standard_normal(shape)
        flags = np.where(rng.random(shape) < 0.05, Flag.NO_FILM, 0).astype(np.uint8)
        flags[:, :4] |= np.uint8(Flag.OUTSIDE_OVERLAP)
        log_ratio[flags != 0] = np.nan
        images = (log_ratio, variance, 0.2 * variance, 1e-6 * rng.random(shape))
        pairs.append(
            PairRatio(
                *(image.astype(np.float32) for image in images),
                flags,
                np.ones(shape, np.float32),
                float(rng.uniform(1, 1.3)),
            )
        )
    return pairs


@pytest.mark.parametrize("count", [1, 2, 7])
@pytest.mark.parametrize("shape", [SHAPE, (6, 5), (1, 30)])
def test_mean_is_that_of_the_plain_sum(count, shape):
    total, plain = PairSum(shape), RatioSum(shape)
    for pair in pairs_of(count, shape):
        total.add(pair)
        plain.add(pair.to_images())
    found, expected = total.mean(), plain.mean()
    npt.assert_array_equal(found.flags, expected["flags"].values)
    npt.assert_allclose(found.noise_correlation, expected.noise_correlation)

    # a weight is the ratio of two sums of 81 values; each frame adds a rounding to the sums
    rtol = (10 + 4 * count) * EPS
    npt.assert_allclose(found.log_ratio, expected.log_ratio, atol=2 * EPS)
    npt.assert_allclose(found.variance, expected.log_ratio_var, rtol=rtol)
    npt.assert_allclose(found.variance_fixed, expected.log_ratio_var_fixed, rtol=rtol)
    npt.assert_allclose(found.variance_shared, expected.log_ratio_var_shared, rtol=rtol)


def test_hundreds_of_frames_keep_the_digits():
    total, plain = PairSum((12, 14)), RatioSum((12, 14))
    for pair in pairs_of(300, (12, 14)):
        total.add(pair)
        plain.add(pair.to_images())
    std = np.sqrt(plain.mean().log_ratio_var.values)
    off = np.abs(total.mean().log_ratio - plain.mean().log_ratio.values)
    assert np.nanmax(off / std) < 1e-3


def test_a_second_trigger_begins_with_zero():
    one, two = pairs_of(2)
    first = PairSum(SHAPE)
    first.add(one)
    del first
    total, alone = PairSum(SHAPE), RatioSum(SHAPE)
    total.add(two)
    alone.add(two.to_images())
    npt.assert_allclose(total.mean().log_ratio, alone.mean().log_ratio, atol=2 * EPS)


def test_without_frames_no_pixel_has_a_ratio():
    mean = PairSum(SHAPE).mean()
    assert np.isnan(mean.log_ratio).all()
    assert (mean.flags == 0).all()
    assert mean.to_images().log_ratio.shape == (1, *SHAPE)
