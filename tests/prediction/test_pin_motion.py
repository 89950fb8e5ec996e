"""The rate of the pin against that of the virtual rig."""

import numpy as np
import numpy.testing as npt

from erlif.prediction.pin_motion import find_pin_motion

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
