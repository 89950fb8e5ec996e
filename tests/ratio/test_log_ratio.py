"""The log ratio: what it does not depend on, its noise, its registration error."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import aligned_frames

from erlif.ratio import compute_ratio

GAIN = 4.4  # [electron/DN]


def aligned(one, two, *variance, displacement_std=0.0):
    """Aligned frames (frame, y, x) of two cameras; shot noise alone if no variance is given."""
    light = np.stack([one, two])
    return aligned_frames(light, np.stack(variance or light / GAIN), displacement_std)


@pytest.fixture
def light():
    rng = np.random.default_rng(3)
    return rng.uniform(800, 2500, (2, 3, 64, 72))


def test_ratio_ignores_laser_power(light):
    before = compute_ratio(aligned(*light))
    after = compute_ratio(aligned(*(3 * light), *(9 * light / GAIN)))
    npt.assert_allclose(after.log_ratio, before.log_ratio, atol=1e-6)
    npt.assert_allclose(after.log_ratio_var, before.log_ratio_var, rtol=1e-5)


@pytest.mark.parametrize("electrons", [(1100, 700), (11000, 8000)])
def test_log_ratio_is_unbiased_and_its_variance_true(electrons):
    """400,000 draws of Poisson light with read noise, dim light included."""
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


def test_noise_of_dark_and_flat_is_part_of_the_variance_and_stands_beside_it(light):
    """Relative errors add in quadrature: the ratio of two lights of 1 % and 2 % has 2.24 %."""
    frames = aligned(*light, 0 * light[0], 0 * light[1])
    frames.signal_var_fixed.values[0] = (0.01 * frames.signal.values[0]) ** 2
    frames.signal_var_fixed.values[1] = (0.02 * frames.signal.values[1]) ** 2
    ratios = compute_ratio(frames)
    npt.assert_allclose(ratios.log_ratio_var_fixed, 5e-4, rtol=1e-5)
    npt.assert_allclose(ratios.log_ratio_var, ratios.log_ratio_var_fixed, rtol=1e-5)
