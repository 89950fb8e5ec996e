"""The rate of the pin against that of the virtual rig."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.prediction.pin_motion import find_pin_motion, smooth_path

NOISE = np.diag([4e-9, 4e-8, 3e-7, 3e-6]) ** 2


def find(pin, position, *, noise=NOISE, **kinds):
    cov = np.broadcast_to(noise, (pin.time.size, 4, 4))
    return find_pin_motion(pin.time, pin.angle, pin.turning, position, random_cov=cov, **kinds)


def test_the_rate_of_a_free_pin_is_that_of_its_orbit(free_pin):
    """It swings by 24 um sideways, at up to 280 um/s, and sinks at 0.9 um/s."""
    found = find(free_pin, free_pin.position, noise=1e-4 * NOISE)
    npt.assert_allclose(found.position, free_pin.position, atol=5e-9)
    npt.assert_allclose(found.rate, free_pin.rate, atol=0.1e-6)


def test_the_rate_of_a_guided_pin_is_its_own(free_pin):
    """It rises and falls, and the turning of the bushing has no part in it."""
    phase = 4 * np.pi * free_pin.time / 0.5263
    position = np.zeros((12, 4))
    position[:, 0] = 2e-4 + 1e-6 * np.sin(phase)
    found = find(free_pin, position)
    npt.assert_allclose(
        found.rate[2:-2, 0], (1e-6 * 4 * np.pi / 0.5263 * np.cos(phase))[2:-2], atol=2e-6
    )
    npt.assert_allclose(found.rate[:, 1:], 0.0, atol=1e-12)


def test_positions_and_rates_lie_within_their_errors(free_pin):
    pulls = []
    for seed in range(40):
        noise = np.random.default_rng(seed).multivariate_normal(np.zeros(4), NOISE, 12)
        found = find(free_pin, free_pin.position + noise)
        std = np.sqrt(np.diagonal(found.random_cov, axis1=1, axis2=2))
        error = np.concatenate(
            [found.position - free_pin.position, found.rate - free_pin.rate], axis=1
        )
        pulls.append(error / std)
    pulls = np.abs(pulls)
    assert 0.60 < (pulls < 1).mean() < 0.80
    assert 0.92 < (pulls < 1.96).mean() < 0.99


def test_marks_cancel_in_the_rate_and_an_error_of_scale_does_not(free_pin):
    """A calibration by which the sideways displacement is 1 % too large makes its rate so too."""
    marks = np.broadcast_to(np.diag([1e-8, 1e-7, 0, 0]) ** 2, (12, 4, 4))
    scale = np.zeros((12, 4, 1))
    scale[:, :2, 0] = free_pin.position[:, :2]
    by_marks = find(free_pin, free_pin.position, surface_cov=marks).shared_cov
    npt.assert_allclose(np.sqrt(by_marks[:, 1, 1]), 1e-7)
    npt.assert_array_equal(by_marks[:, 4:], 0.0)
    by_scale = find(
        free_pin, free_pin.position, gradient=scale, calibration_cov=np.array([[0.01**2]])
    ).shared_cov
    npt.assert_allclose(
        np.sqrt(by_scale[:, 5, 5]), np.abs(0.01 * free_pin.rate[:, 1]), atol=0.02e-6
    )


TIME = np.linspace(0.02, 0.52, 24)
STD = np.array([5e-3, 5e-2])
COV = np.array([[1, 0.4], [0.4, 1]]) * np.outer(STD, STD)

CUBIC = 0.5


def noisy(curve, seed, scale=1.0):
    noise = np.random.default_rng(seed).multivariate_normal(np.zeros(2), COV, TIME.size)
    return np.stack([curve, curve], axis=1) + scale * noise


def test_a_parabola_is_its_own_path():
    curve = 3 - 0.6 * TIME + 2 * TIME**2
    path = smooth_path(TIME, noisy(curve, 0, scale=0.0), np.broadcast_to(COV, (24, 2, 2)))
    npt.assert_allclose(path.value[:, 0], curve, rtol=1e-7)
    npt.assert_allclose(path.rate[:, 1], -0.6 + 4 * TIME, atol=1e-6)


@pytest.mark.parametrize(
    ("curve", "rate"),
    [
        (5 - 0.6 * TIME, np.full(24, -0.6)),
        (5 + np.sin(4 * np.pi * TIME), 4 * np.pi * np.cos(4 * np.pi * TIME)),
    ],
)
def test_values_and_rates_lie_within_their_errors(curve, rate):
    """Both shares may be larger than nominal: the film between the triggers is not known."""
    pulls = []
    for seed in range(40):
        path = smooth_path(TIME, noisy(curve, seed), np.broadcast_to(COV, (24, 2, 2)))
        std = np.sqrt(np.diagonal(path.covariance, axis1=1, axis2=2))
        pulls.append([(path.value.T - curve) / std.T[:2], (path.rate.T - rate) / std.T[2:]])
    pulls = np.abs(pulls)
    assert 0.60 < (pulls < 1).mean() < 0.85
    assert (pulls < 1.96).mean() > 0.93
    assert pulls.mean() > 0.5  # 0.80 of a normal distribution: errors are not stated far too large


def middle_rate_std(noise, seed):
    """Of a line, over that of a parabola fit, 12 s^2/(n T^2) as for a line."""
    path = smooth_path(TIME, noisy(5 - 0.6 * TIME, seed, noise), np.broadcast_to(COV, (24, 2, 2)))
    line = STD[0] / np.sqrt(((TIME - TIME.mean()) ** 2).sum())
    return np.sqrt(path.covariance[12, 2, 2]) / line


def test_the_rate_of_a_line_holds_half_a_cubic():
    """Positions do not prove that a path is a parabola: the error is larger than that of one.

    Where the data have no share in any order above two, the density is largest where the sum of
    their freedoms is twice the power of its prior, 0.5. Of Legendre orders 1, 3 and 5 the rate in
    the middle has the variances 3, 7 (3/2)^2 and 11 (15/8)^2.
    """
    cubic, fifth = 7 * 1.5**2 / 3, 11 * (15 / 8) ** 2 / 3
    assert middle_rate_std(0.0, 0) == pytest.approx(np.sqrt(1 + 0.5 * cubic), rel=0.1)
    noisy_ones = np.array([middle_rate_std(1.0, seed) for seed in range(20)])
    assert (noisy_ones < np.sqrt(1 + cubic + fifth)).mean() >= 0.95


def test_the_rate_at_the_ends_of_a_path_that_the_noise_takes_for_a_parabola():
    """A cubic of half the noise; with the penalty of the largest likelihood, 1.5 and 80 %."""
    u = (TIME - TIME.mean()) / (0.5 * np.ptp(TIME))
    curve = CUBIC * STD[0] * (5 * u**3 - 3 * u) / 2
    rate = CUBIC * STD[0] * (15 * u**2 - 3) / np.ptp(TIME)
    pulls = []
    for seed in range(60):
        path = smooth_path(TIME, noisy(curve, seed)[:, :1], np.full((24, 1, 1), COV[0, 0]))
        pulls.append(((path.rate[:, 0] - rate) / np.sqrt(path.covariance[:, 1, 1]))[[0, 1, -2, -1]])
    assert np.sqrt(np.mean(np.square(pulls))) < 1.1
    assert (np.abs(pulls) < 1.96).mean() > 0.93


def test_an_error_that_all_positions_share_is_none_of_the_rate():
    path = smooth_path(TIME, noisy(np.sin(TIME), 0), np.broadcast_to(COV, (24, 2, 2)))
    change = path.carry(np.ones((24, 2, 1)))[..., 0]
    npt.assert_allclose(change[:, :2], 1.0, atol=1e-6)
    npt.assert_allclose(change[:, 2:], 0.0, atol=1e-5)


def test_a_scatter_four_times_the_stated_one_is_found():
    cov = np.broadcast_to(COV, (24, 2, 2))
    assert smooth_path(TIME, noisy(5 - 0.6 * TIME, 1), cov).noise_scale.tolist() == [1.0, 1.0]
    path = smooth_path(TIME, noisy(5 - 0.6 * TIME, 1, scale=4.0), cov)
    npt.assert_allclose(path.noise_scale, 4.0, rtol=0.5)


@pytest.mark.parametrize(
    ("time", "value", "cov", "message"),
    [(TIME[::-1], 0.0, 1.0, "rising times"), (TIME, 0.0, -1.0, "positive definite")],
)
def test_what_has_no_path_is_refused(time, value, cov, message):
    with pytest.raises(ModelError, match=message):
        smooth_path(time, np.full((time.size, 1), value), np.full((time.size, 1, 1), cov))
