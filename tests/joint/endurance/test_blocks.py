"""Stages as blocks of samples."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.joint.endurance.blocks import MOST_BLOCKS, Record, StageFriction


@pytest.mark.parametrize("size", [50, 1000, 50_000])
def test_blocks_average_the_samples_and_are_not_too_many(size):
    time = np.arange(float(size))
    record = Record.of(StageFriction(time, 0.1 + 1e-6 * time), size)
    assert record.time.size <= MOST_BLOCKS
    npt.assert_allclose(record.friction, 0.1 + 1e-6 * record.time)


def test_no_block_lies_across_a_pause_and_running_in_begins_again():
    time = np.concatenate([np.arange(0.0, 401.0), np.arange(5000.0, 5500.0)])
    record = Record.of(StageFriction(time, np.where(time < 1000, 0.1, 0.2)), 900.0)
    assert set(np.round(record.friction, 12)) == {0.1, 0.2}
    assert record.background.shape[1] == record.usual.size + 1 == 7
    step, fast = record.background[:, 4], record.background[:, 5]
    npt.assert_array_equal(step, record.time > 1000)
    assert fast[record.time < 1000].max() == 0
    assert fast[np.flatnonzero(record.time > 1000)[0]] > 0.9
    assert record.background[-1, 1] < 1  # the drift does not count the pause
