"""Triggers per cycle and number of cycles, from the angles of an encoder log alone."""

import numpy as np
import pytest

from erlif.pipeline.recording.log_cycle import Cycle, find_cycle


@pytest.mark.parametrize(
    ("angle", "expected"),
    [
        (np.arange(10) * 36.0, Cycle(True, 10, 1.0)),
        (np.arange(25) * 36.0, Cycle(True, 10, 2.5)),
        (-7.0 + np.arange(30) * 36.0 % 360, Cycle(True, 10, 3.0)),
        (np.arange(5) * 5.0, Cycle(False, None, 1.0)),
        (30 * np.cos(np.radians(7.2 * np.arange(50))), Cycle(False, 50, 1.0)),
        (30 * np.cos(np.radians(7.2 * np.arange(150))), Cycle(False, 50, 3.0)),
        (np.array([12.0]), Cycle(False, None, 1.0)),
    ],
)
def test_a_cycle_is_recognised_by_its_angles(angle, expected):
    assert find_cycle(angle) == expected


def test_noise_of_the_encoder_does_not_hide_the_cycle():
    angle = 30 * np.cos(np.radians(7.2 * np.arange(150)))
    noisy = angle + np.random.default_rng(3).normal(0, 0.02, angle.size)
    assert find_cycle(noisy).triggers == 50
