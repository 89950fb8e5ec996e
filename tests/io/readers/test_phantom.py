"""Phantom CINE."""

import struct
from contextlib import closing

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_cine
from scenes.reading import read, times_of

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.base import TRUNCATED
from erlif.io.readers.phantom import phantom_table

START = 1_700_000_000.0
"""A second of 2023, in which double precision resolves 0.2 us."""


def test_ten_bits_are_expanded_to_twelve_by_the_table_of_the_camera(tmp_path):
    values = np.arange(1024).reshape(1, 32, 32)
    path = write_cine(tmp_path / "a.cine", values, stored="packed 10")
    npt.assert_array_equal(read(path)[0].reshape(-1), phantom_table())
    with closing(open_frames(path)) as file:
        assert file.bits == 12


def test_the_table_follows_the_transfer_curve_of_television():
    """ITU-R BT.709 from black at 64 of both depths to white at 1014 and 4064; full scale above."""
    value = np.arange(1, 1015)
    signal = (value - 64) / (1014 - 64)
    light = np.where(
        signal < 0.081, signal / 4.5, np.maximum((signal + 0.099) / 1.099, 0) ** (1 / 0.45)
    )
    npt.assert_allclose(phantom_table()[1:1015], 64 + (4064 - 64) * light, atol=2.5)
    assert (np.diff(phantom_table().astype(int)) >= 0).all()
    assert (phantom_table()[1015:] == 4095).all()


def test_time_stamps_of_the_camera_go_before_the_rate(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    times = START + np.array([0.9, 0.9 + 1e-4, 1.9])
    found = times_of(write_cine(tmp_path / "a.cine", frames, times=times))
    npt.assert_allclose(found, [0, 1e-4, 1], atol=1e-6)

    found = times_of(write_cine(tmp_path / "b.cine", frames, rate=90_000, decimation=10))
    npt.assert_allclose(found, np.arange(3) / 9000)
    stopped = np.full(3, START)
    found = times_of(write_cine(tmp_path / "c.cine", frames, times=stopped, rate=500))
    npt.assert_allclose(found, [0, 0.002, 0.004])


def test_the_serial_number_of_the_camera_is_read(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    for number, text in ((13_021, "13021"), (0, "")):
        with closing(open_frames(write_cine(tmp_path / "a.cine", frames, serial=number))) as file:
            assert file.serial == text


def test_frames_beyond_four_gigabytes(tmp_path):
    frames = random_frames(np.random.default_rng(1))
    path = write_cine(tmp_path / "a.cine", frames, gap=5 * 2**30)  # a hole, which takes no disk
    if path.stat().st_blocks * 512 > 2**20:
        path.unlink()
        pytest.skip("this file system has no holes")
    npt.assert_array_equal(read(path), frames)


def test_a_wrong_place_or_size_of_one_frame_leaves_the_others(tmp_path):
    frames = random_frames(np.random.default_rng(1), frames=4)
    path = write_cine(tmp_path / "a.cine", frames)
    data = bytearray(path.read_bytes())
    (table,) = struct.unpack_from("<I", data, 32)
    places = struct.unpack_from("<4Q", data, table)
    struct.pack_into("<Q", data, table, 2**63 + 5)  # behind every file
    struct.pack_into("<I", data, places[1], 3)  # a note shorter than itself
    struct.pack_into("<I", data, places[2] + 4, 95)  # a byte too few
    path.write_bytes(data)

    file = open_frames(path)
    assert [kind == TRUNCATED for kind in file.kinds] == [True, False, False, False]
    with pytest.raises(FrameError, match="header of the frame is damaged"):
        file.read(1)
    with pytest.raises(FrameError, match="95 bytes, expected 96"):
        file.read(2)
    npt.assert_array_equal(file.read(3), frames[3])
    file.close()
