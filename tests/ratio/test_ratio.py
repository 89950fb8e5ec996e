"""The ratio: what it must not depend on, its noise, its sums, and the bubbles it leaves out."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.products import AlignedFrames, RatioImages
from erlif.ratio import RatioSum, combine_frames, compute_ratio, find_bubbles, log_gradient
from erlif.registration import is_steep

GAIN = 4.4


def aligned(one, two, one_var=None, two_var=None, displacement_std=0.0):
    """Aligned frames (frame, y, x) of two cameras."""
    signal = np.stack([one, two]).astype(np.float32)
    variance = np.stack(
        [one / GAIN if one_var is None else one_var, two / GAIN if two_var is None else two_var]
    )
    dims = ("camera", "frame", "y", "x")
    return AlignedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal),
                "signal_var": (dims, variance.astype(np.float32)),
                "signal_var_fixed": (dims, np.zeros(signal.shape, np.float32)),
                "flags": (dims, np.zeros(signal.shape, np.uint8)),
                "displacement_std": (
                    ("y", "x"),
                    np.full(signal.shape[-2:], displacement_std, np.float32),
                ),
            },
            {"camera": [1, 2]},
        )
    )


@pytest.fixture
def light():
    rng = np.random.default_rng(3)
    return rng.uniform(800, 2500, (2, 3, 64, 72))


def test_ratio_ignores_laser_power(light):
    before = compute_ratio(aligned(*light))
    after = compute_ratio(aligned(*(3 * light), *(9 * light / GAIN)))
    npt.assert_allclose(after.log_ratio, before.log_ratio, atol=1e-6)
    npt.assert_allclose(after.log_ratio_var, before.log_ratio_var, rtol=1e-5)


def test_exchanged_cameras_change_the_sign(light):
    npt.assert_allclose(
        compute_ratio(aligned(*light)).log_ratio,
        -compute_ratio(aligned(*light[::-1])).log_ratio,
        atol=1e-6,
    )


@pytest.mark.parametrize("electrons", [(1100, 700), (11000, 8000)])
def test_log_ratio_is_unbiased_and_its_variance_true(electrons):
    """Against 400,000 draws of Poisson light with read noise, dim light included."""
    rng = np.random.default_rng(4)
    shape = (10, 200, 200)
    one, two = ((rng.poisson(n, shape) + rng.normal(0, 9, shape)) / GAIN for n in electrons)
    variances = [np.maximum(s, 0) / GAIN + (9 / GAIN) ** 2 for s in (one, two)]
    ratios = compute_ratio(aligned(one, two, *variances))
    error = ratios.log_ratio.values - np.log(electrons[1] / electrons[0])
    assert abs(error.mean()) < 4 * error.std() / np.sqrt(error.size)
    npt.assert_allclose(error.var(), ratios.log_ratio_var.values.mean(), rtol=0.015)


def test_registration_error_enters_by_the_gradient_of_the_light():
    ramp = np.broadcast_to(1000 * np.exp(0.05 * np.arange(72)), (1, 64, 72))
    ratios = compute_ratio(aligned(ramp, ramp, displacement_std=0.2))
    npt.assert_allclose(
        ratios.log_ratio_var_shared.values[0, 5:-5, 5:-5], (0.2 * 0.05) ** 2, rtol=1e-3
    )


def test_log_gradient_of_an_exponential_ramp():
    y, x = np.indices((40, 50))
    npt.assert_allclose(
        log_gradient(np.exp(0.03 * x + 0.04 * y).astype(np.float32))[2:-2, 2:-2], 0.05, rtol=1e-3
    )


def test_dark_pixels_have_no_ratio(light):
    light[1, 0, 5, 5] = -3.0
    ratios = compute_ratio(aligned(*light, *np.abs(light) / GAIN))
    assert ratios.flags.values[0, 5, 5] & Flag.DIM
    assert np.isnan(ratios.log_ratio.values[0, 5, 5])


def test_bubbles_are_found_with_their_rim_and_a_dim_corner_is_not():
    y, x = np.indices((120, 160))
    beam = 2000 * np.exp(-((x - 80) ** 2 + (y - 60) ** 2) / (2 * 60**2))
    for centre, radius in (((30, 40), 4), ((90, 120), 9)):
        beam[np.hypot(y - centre[0], x - centre[1]) <= radius] *= 0.05
    dark = find_bubbles(beam.astype(np.float32), beam.astype(np.float32), share=0.25)
    for centre, radius in (((30, 40), 4), ((90, 120), 9)):
        assert dark[np.hypot(y - centre[0], x - centre[1]) <= radius + 2].all()
    near = np.minimum(np.hypot(y - 30, x - 40) - 4, np.hypot(y - 90, x - 120) - 9)
    assert not dark[near > 5].any()


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
    npt.assert_allclose(
        combined.log_ratio_var_shared, 1e-6, rtol=1e-5
    )  # the same error in every frame


def test_weights_do_not_go_with_the_noise():
    """Frames of 300 and 200 electrons, each pixel with the variance that its own noise suggests: the mean shows no bias of it."""
    rng = np.random.default_rng(8)
    one, two = (rng.poisson(mean, (30, 60, 80)).astype(float) for mean in (300, 200))
    values = np.log(two / one) + 0.5 * (1 / two - 1 / one)
    own = 1 / one + 1 / two
    weighted = ((values / own).sum(0) / (1 / own).sum(0)).mean() - np.log(2 / 3)
    combined = combine_frames(ratio_images(values, own))
    left = float(combined.log_ratio.mean()) - np.log(2 / 3)
    scatter = np.sqrt((1 / 300 + 1 / 200) / values.size)
    assert weighted > 5 * scatter  # what weights by the pixels' own variance would do
    assert abs(left) < 3 * scatter
    npt.assert_allclose(combined.log_ratio_var.mean(), (1 / 300 + 1 / 200) / 30, rtol=0.02)


def test_noise_of_dark_and_flat_does_not_average_out():
    """A hundred frames that share the noise of their flat: what is left is that noise and a hundredth of the rest."""
    rng = np.random.default_rng(6)
    shape = (100, 100, 120)
    values = rng.normal(0, 0.02, shape) + rng.normal(0, 0.005, shape[1:])
    combined = combine_frames(
        ratio_images(values, np.full(shape, 0.02**2 + 0.005**2), fixed=0.005**2)
    )
    npt.assert_allclose(combined.log_ratio_var, 0.02**2 / 100 + 0.005**2, rtol=1e-4)
    npt.assert_allclose(combined.log_ratio.values.var(), combined.log_ratio_var.mean(), rtol=0.04)


def test_pixel_is_answered_by_the_frames_that_can_and_keeps_all_reasons_otherwise():
    values = np.stack([np.full((2, 2), 1.0), np.full((2, 2), 3.0)])
    flags = np.zeros((2, 2, 2), np.uint8)
    flags[0, 0, 0] = Flag.NO_FILM
    flags[:, 1, 1] = Flag.DIM, Flag.SATURATED
    total = RatioSum((2, 2))
    for n in range(2):
        total.add(RatioImages(ratio_images(values, np.ones((2, 2, 2)), flags).isel(frame=[n])))
    mean = total.mean()
    npt.assert_allclose(mean.log_ratio.values[0], [3.0, 2.0])
    npt.assert_array_equal(mean.flags, [[0, 0], [0, Flag.DIM | Flag.SATURATED]])
    assert np.isnan(mean.log_ratio.values[1, 1])


def test_a_skipped_stage_is_named(light):
    with pytest.raises(ErlifError, match="displacement_std is missing"):
        compute_ratio(aligned(*light).drop_vars("displacement_std"))


def test_steep_light_is_found_and_texture_is_not():
    """A film rising from nothing at the left edge: its light is steep there, its speckle nowhere."""
    rng = np.random.default_rng(7)
    film = 0.05 + 0.06 * np.arange(160)
    light = 10000 * (1 - np.exp(-0.4 * film)) * (1 + 0.1 * rng.standard_normal((120, 160)))
    steep = is_steep(light.astype(np.float32))
    slope = 0.4 * 0.06 / np.expm1(0.4 * film)  # of the logarithm of 1 - exp(-0.4 film)
    assert steep[:, slope > 0.08].all()
    assert not steep[:, slope < 0.02].any()
