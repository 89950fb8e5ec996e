"""Stages as blocks of samples, and time with and without the pauses of a log."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.joint.endurance.blocks import (
    MOST_BLOCKS,
    BlockRecord,
    LogClock,
    StageFriction,
    find_pauses,
)

TIME = np.concatenate([np.arange(0.0, 100.0), np.arange(400.0, 450.0), np.arange(460.0, 500.0)])


@pytest.mark.parametrize("size", [50, 1000, 50_000])
def test_blocks_average_the_samples_and_are_not_too_many(size):
    time = np.arange(float(size))
    record = BlockRecord.of(StageFriction(time, 0.1 + 1e-6 * time), size)
    assert record.time.size <= MOST_BLOCKS
    npt.assert_allclose(record.friction, 0.1 + 1e-6 * record.time)


def test_no_block_lies_across_a_pause_and_running_in_begins_again():
    time = np.concatenate([np.arange(0.0, 401.0), np.arange(5000.0, 5500.0)])
    record = BlockRecord.of(StageFriction(time, np.where(time < 1000, 0.1, 0.2)), 900.0)
    assert set(np.round(record.friction, 12)) == {0.1, 0.2}
    assert record.background.shape[1] == record.usual.size + 1 == 7
    step, fast = record.background[:, 4], record.background[:, 5]
    npt.assert_array_equal(step, record.time > 1000)
    assert fast[record.time < 1000].max() == 0
    assert fast[np.flatnonzero(record.time > 1000)[0]] > 0.9
    assert record.background[-1, 1] < 1  # the drift does not count the pause


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
