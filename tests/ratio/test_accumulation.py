"""Frames of one trigger, combined: weights, variances, flags."""

import numpy as np
import numpy.testing as npt
from scenes.pair import ratio_images

from erlif.core.flags import Flag
from erlif.ratio import PairRatio, RatioSum


def combine(values, variances, **images):
    """The mean over frames, and their number."""
    given = ratio_images(values, variances, shared=1e-6, **images)
    total = RatioSum(values.shape[1:])
    for n in range(len(values)):
        total.add(PairRatio.of(given, n))
    assert total.frames == len(values)
    return total.mean()


def test_frames_are_combined_with_inverse_variance_weights():
    rng = np.random.default_rng(5)
    values = rng.normal(size=(4, 8, 9))
    variances = np.broadcast_to(rng.uniform(1, 3, (4, 1, 1)), values.shape)
    combined = combine(values, variances)
    weights = 1 / variances
    mean = (weights * values).sum(0) / weights.sum(0)
    npt.assert_allclose(combined.log_ratio, mean, rtol=1e-5, atol=1e-7)
    npt.assert_allclose(combined.variance, 1 / weights.sum(0), rtol=1e-5)
    # the registration error is the same in every frame
    npt.assert_allclose(combined.variance_shared, 1e-6, rtol=1e-5)


def test_weights_are_not_correlated_with_the_noise():
    """Light of 300 and 200 electrons, the variance of each pixel estimated from its own light."""
    rng = np.random.default_rng(8)
    one, two = (rng.poisson(mean, (30, 60, 80)).astype(float) for mean in (300, 200))
    values = np.log(two / one) + 0.5 * (1 / two - 1 / one)
    own = 1 / one + 1 / two
    weighted = ((values / own).sum(0) / (1 / own).sum(0)).mean() - np.log(2 / 3)
    combined = combine(values, own)
    left = float(combined.log_ratio.mean()) - np.log(2 / 3)
    scatter = np.sqrt((1 / 300 + 1 / 200) / values.size)
    assert weighted > 5 * scatter  # the bias of weights by the pixels' own variance
    assert abs(left) < 3 * scatter
    npt.assert_allclose(combined.variance.mean(), (1 / 300 + 1 / 200) / 30, rtol=0.02)


def test_noise_of_dark_and_flat_does_not_average_out():
    """A hundred frames with one flat: its variance stays, a hundredth of the rest is left."""
    rng = np.random.default_rng(6)
    shape = (100, 100, 120)
    values = rng.normal(0, 0.02, shape) + rng.normal(0, 0.005, shape[1:])
    combined = combine(values, 0.02**2 + 0.005**2, fixed=0.005**2)
    npt.assert_allclose(combined.variance, 0.02**2 / 100 + 0.005**2, rtol=1e-4)
    npt.assert_allclose(combined.log_ratio.var(), combined.variance.mean(), rtol=0.04)


def test_a_pixel_is_valid_by_any_frame_and_keeps_all_flags_otherwise():
    values = np.stack([np.full((2, 2), 1.0), np.full((2, 2), 3.0)])
    flags = np.zeros((2, 2, 2), np.uint16)
    flags[0, 0, 0] = Flag.NO_FILM
    flags[:, 1, 1] = Flag.DIM, Flag.SATURATED
    mean = combine(values, 1.0, flags=flags)
    npt.assert_allclose(mean.log_ratio[0], [3.0, 2.0])
    npt.assert_array_equal(mean.flags, [[0, 0], [0, Flag.DIM | Flag.SATURATED]])
    assert np.isnan(mean.log_ratio[1, 1])


def test_a_weight_is_one_over_the_mean_variance_of_the_surroundings():
    """A square of 9 x 9 pixels, without the variance that repeats from frame to frame."""
    variance = np.random.default_rng(9).uniform(1, 2, (1, 12, 15))
    expected = 1 / (variance[0, 2:11, 3:12] - 0.2).mean()
    images = ratio_images(np.zeros((1, 12, 15)), variance, fixed=0.2)
    weight = RatioSum((12, 15)).add(PairRatio.of(images))
    npt.assert_allclose(weight[6, 7], expected, rtol=1e-5)
