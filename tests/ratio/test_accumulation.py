"""Frames of one trigger, combined: weights, variances, flags."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.flags import Flag
from erlif.core.products import RatioImages
from erlif.ratio import PairRatio, RatioSum, combine_frames


def ratio_images(values, variances, flags=None, fixed=0.0):
    dims = ("frame", "y", "x")
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (dims, values),
                "log_ratio_var": (dims, variances),
                "log_ratio_var_fixed": (dims, np.full(values.shape, fixed)),
                "log_ratio_var_shared": (dims, np.full(values.shape, 1e-6)),
                "flags": (dims, np.zeros(values.shape, np.uint8) if flags is None else flags),
            }
        )
    )


def test_frames_are_combined_with_inverse_variance_weights():
    rng = np.random.default_rng(5)
    values = rng.normal(size=(4, 8, 9))
    variances = np.broadcast_to(rng.uniform(1, 3, (4, 1, 1)), values.shape)
    combined = combine_frames(ratio_images(values, variances))
    weights = 1 / variances
    npt.assert_allclose(combined.log_ratio, (weights * values).sum(0) / weights.sum(0), rtol=1e-5)
    npt.assert_allclose(combined.log_ratio_var, 1 / weights.sum(0), rtol=1e-5)
    # the registration error is the same in every frame
    npt.assert_allclose(combined.log_ratio_var_shared, 1e-6, rtol=1e-5)


def test_weights_are_not_correlated_with_the_noise():
    """Light of 300 and 200 electrons, the variance of each pixel estimated from its own light."""
    rng = np.random.default_rng(8)
    one, two = (rng.poisson(mean, (30, 60, 80)).astype(float) for mean in (300, 200))
    values = np.log(two / one) + 0.5 * (1 / two - 1 / one)
    own = 1 / one + 1 / two
    weighted = ((values / own).sum(0) / (1 / own).sum(0)).mean() - np.log(2 / 3)
    combined = combine_frames(ratio_images(values, own))
    left = float(combined.log_ratio.mean()) - np.log(2 / 3)
    scatter = np.sqrt((1 / 300 + 1 / 200) / values.size)
    assert weighted > 5 * scatter  # the bias of weights by the pixels' own variance
    assert abs(left) < 3 * scatter
    npt.assert_allclose(combined.log_ratio_var.mean(), (1 / 300 + 1 / 200) / 30, rtol=0.02)


def test_noise_of_dark_and_flat_does_not_average_out():
    """A hundred frames with one flat: its variance stays, a hundredth of the rest is left."""
    rng = np.random.default_rng(6)
    shape = (100, 100, 120)
    values = rng.normal(0, 0.02, shape) + rng.normal(0, 0.005, shape[1:])
    combined = combine_frames(
        ratio_images(values, np.full(shape, 0.02**2 + 0.005**2), fixed=0.005**2)
    )
    npt.assert_allclose(combined.log_ratio_var, 0.02**2 / 100 + 0.005**2, rtol=1e-4)
    npt.assert_allclose(combined.log_ratio.values.var(), combined.log_ratio_var.mean(), rtol=0.04)


def test_a_pixel_is_valid_by_any_frame_and_keeps_all_flags_otherwise():
    values = np.stack([np.full((2, 2), 1.0), np.full((2, 2), 3.0)])
    flags = np.zeros((2, 2, 2), np.uint8)
    flags[0, 0, 0] = Flag.NO_FILM
    flags[:, 1, 1] = Flag.DIM, Flag.SATURATED
    total = RatioSum((2, 2))
    for n in range(2):
        total.add(PairRatio.of(ratio_images(values, np.ones((2, 2, 2)), flags), n))
    mean = RatioImages(total.mean().to_images().isel(frame=0))
    npt.assert_allclose(mean.log_ratio.values[0], [3.0, 2.0])
    npt.assert_array_equal(mean.flags, [[0, 0], [0, Flag.DIM | Flag.SATURATED]])
    assert np.isnan(mean.log_ratio.values[1, 1])


@pytest.fixture
def frames():
    rng = np.random.default_rng(9)
    return ratio_images(rng.normal(size=(3, 12, 15)), rng.uniform(1, 2, (3, 12, 15)), fixed=0.2)


def test_a_weight_is_one_over_the_mean_variance_of_the_surroundings(frames):
    """A square of 9 x 9 pixels, without the variance that repeats from frame to frame."""
    expected = 1 / (frames.log_ratio_var.values[0, 2:11, 3:12] - 0.2).mean()
    weight = RatioSum((12, 15)).add(PairRatio.of(frames, 0))
    npt.assert_allclose(weight[6, 7], expected, rtol=1e-5)
