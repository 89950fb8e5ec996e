"""NorPix SEQ."""

from contextlib import closing

import numpy as np
import numpy.testing as npt
from scenes.camera_files import random_frames, write_seq
from scenes.reading import read, times_of

from erlif.io.readers import open_frames
from erlif.io.readers.base import TRUNCATED


def test_time_stamps_to_the_microsecond(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    times = 1_435_776_080 + np.array([0.999_5, 1.000_123, 2.5])
    found = times_of(write_seq(tmp_path / "a.seq", frames, times=times))
    npt.assert_allclose(found, [0, 0.000_623, 1.500_5], atol=1e-9)
    # older versions have milliseconds, and anything behind them
    found = times_of(write_seq(tmp_path / "b.seq", frames, times=times, version=4))
    npt.assert_allclose(found, [0, 0.001, 1.501], atol=1e-9)


def test_stamps_that_were_not_set_give_way_to_the_rate(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = tmp_path / "a.seq"
    npt.assert_allclose(times_of(write_seq(path, frames, rate=250.0)), [0, 0.004, 0.008])
    assert times_of(write_seq(path, frames, rate=0.0)) is None


def test_a_recording_in_a_loop_begins_with_its_oldest_frame(tmp_path):
    frames = random_frames(np.random.default_rng(1), frames=5)
    times = 1_700_000_000 + np.array([0.3, 0.4, 0.0, 0.1, 0.2])
    path = write_seq(tmp_path / "a.seq", frames, times=times, oldest=2)
    npt.assert_array_equal(read(path), frames[[2, 3, 4, 0, 1]])
    npt.assert_allclose(times_of(path), [0, 0.1, 0.2, 0.3, 0.4], atol=1e-6)


def test_a_recording_that_was_not_closed_has_the_frames_of_its_size(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_seq(tmp_path / "a.seq", frames, claimed=0, times=np.arange(3.0))
    assert len(read(path)) == 3
    path.write_bytes(path.read_bytes()[: 8192 + 2 * 512 + 50])
    with closing(open_frames(path)) as file:
        assert [kind == TRUNCATED for kind in file.kinds] == [False, False, True]
        npt.assert_allclose(file.times, [0, 1, np.nan])
