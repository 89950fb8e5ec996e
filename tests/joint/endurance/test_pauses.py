"""Time with and without the pauses of a log."""

import numpy as np
import numpy.testing as npt

from erlif.joint.endurance.pauses import LogClock, find_pauses

TIME = np.concatenate([np.arange(0.0, 100.0), np.arange(400.0, 450.0), np.arange(460.0, 500.0)])


def test_a_pause_is_long_and_spans_several_samples():
    assert find_pauses(TIME).tolist() == [100]
    assert find_pauses(np.arange(0.0, 1000.0, 60.0)).tolist() == []
    assert find_pauses(np.array([3.0])).tolist() == []


def test_time_in_the_log_goes_by_one_interval_in_a_gap_and_back():
    clock = LogClock.of(TIME)
    npt.assert_allclose(clock.logged(TIME), np.arange(TIME.size))
    npt.assert_allclose(clock.real(np.arange(float(TIME.size))), TIME)
    assert clock.real(np.array([99.5])) == 399.5


def test_an_interval_holds_a_gap_whole_or_not_at_all():
    clock = LogClock.of(TIME)
    assert clock.hold_gaps(90.0, 399.5, 405.0) == (90.0, 249.5, 405.0, (99.0, 400.0))
    assert clock.hold_gaps(399.4, 399.6, 399.8) == (99.0, 249.5, 400.0, (99.0, 400.0))
    assert clock.hold_gaps(420.0, 421.0, 422.0) == (420.0, 421.0, 422.0, None)
