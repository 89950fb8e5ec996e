"""PCO B16."""

from __future__ import annotations

import struct

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames, write_b16

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.pco import open_pco


@pytest.mark.parametrize("start", [28, 512, 4096])
def test_known_counts(tmp_path, start):
    frame = random_frames(np.random.default_rng(start), bits=16)[0]
    file = open_frames(write_b16(tmp_path / "a.b16", frame, start=start))
    npt.assert_array_equal(file.read(0), frame)
    assert list(map(str, file.kinds)) == ["8 x 6 uint16"]
    assert file.bits is None
    file.close()


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        (0, 0, "does not begin as a B16 file"),
        (8, 3, "ends at byte 3"),
        (8, -5, "ends at byte -5"),
        (8, 2**31 - 1, "header names 1 frames"),
        (12, 0, "holds no image"),
        (12, 2**31 - 1, "cannot hold"),
        (16, -1, "holds no image"),
        (24, 1, "colour camera"),
    ],
)
def test_a_lying_header_is_refused(tmp_path, place, value, words):
    path = write_b16(tmp_path / "a.b16", random_frames(np.random.default_rng(1))[0])
    data = bytearray(path.read_bytes())
    struct.pack_into("<i", data, place, value)
    path.write_bytes(data)
    with pytest.raises(FrameError, match=words):
        open_pco(path)


def test_a_cut_file_is_refused(tmp_path):
    path = write_b16(tmp_path / "a.b16", random_frames(np.random.default_rng(1))[0])
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(FrameError, match="hold 0 of them"):
        open_pco(path)
