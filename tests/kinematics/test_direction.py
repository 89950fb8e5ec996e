"""The sense of an encoder from the second harmonic of its readings."""

import numpy as np
import pytest

from erlif.kinematics.direction import FEWEST_FRAMES, find_direction


def wave(crank):
    return 10 * np.cos(crank) + np.cos(2 * crank + 0.4)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("phase", [0.0, 1.7, 4.0])
@pytest.mark.parametrize("speed", [8.0, 8.3, 7.7])
def test_the_sign_is_found_at_any_phase_and_nearly_any_speed(sign, phase, speed):
    time = np.linspace(0, 3, 200)
    reading = 5 + sign * wave(speed * time + phase)
    found = find_direction(time, reading, wave, crank_speed=8.0)
    assert found.sign == sign
    assert found.noise < 0.1


def test_noise_leaves_the_sign_open_and_is_measured():
    rng = np.random.default_rng(1)
    time = np.linspace(0, 3, 200)
    reading = 10 * np.cos(8 * time) + 0.5 * rng.standard_normal(200)
    found = find_direction(time, reading, wave, crank_speed=8.0)
    assert found.sign == 0
    assert found.noise == pytest.approx(0.5, rel=0.15)


@pytest.mark.parametrize(("frames", "duration"), [(FEWEST_FRAMES - 1, 3.0), (200, 0.5)])
def test_a_short_log_leaves_the_sign_open(frames, duration):
    time = np.linspace(0, duration, frames)
    assert find_direction(time, wave(8 * time), wave, crank_speed=8.0).sign == 0
