"""Stretches of one direction."""

import numpy as np
import pytest

from erlif.joint.friction.stretches import find_stretches

TIME = np.arange(0.0, 200.0, 0.1)
SENSE = np.where(TIME % 20 < 10, 1.0, -1.0)


def test_stretches_lie_between_the_reversals_and_alternate():
    found = find_stretches(SENSE)
    assert [one.forward for one in found] == [True, False] * 10
    assert [(one.first, one.last) for one in found[:2]] == [(10, 89), (110, 189)]


@pytest.mark.parametrize("noise", [0.2, 0.45])
def test_noise_makes_no_reversals(noise):
    torque = SENSE + noise * np.random.default_rng(2).standard_normal(TIME.size)
    found = find_stretches(torque)
    assert len(found) == 20
    assert all(one.dwell == (0, 0) for one in found)


def test_dwell_before_and_after_the_sliding_is_counted():
    rests = (TIME % 10 < 2) | (TIME % 10 >= 9)
    first, *others = find_stretches(SENSE * np.where(rests, 0.4, 1.0))
    assert {one.dwell for one in others} == {(20, 0)}  # a second is cut off with the speeding up
    assert first.samples.start >= 20
