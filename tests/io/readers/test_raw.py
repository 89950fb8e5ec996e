"""Frames at known places of a file."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import random_frames

from erlif.core.errors import FrameError
from erlif.io.readers.base import TRUNCATED, FrameKind
from erlif.io.readers.raw import FrameLayout, RawFrames, frame_interval


@pytest.fixture
def frames():
    return random_frames(np.random.default_rng(3), frames=5, rows=7, columns=9)


@pytest.fixture
def opened(request, tmp_path):
    """Opens frames of a file of those bytes, and closes them after the test."""

    def open_bytes(data, layout, offsets, **entries):
        path = tmp_path / "frames.raw"
        path.write_bytes(data)
        file = RawFrames(path, layout, offsets, **entries)
        request.addfinalizer(file.close)
        return file

    return open_bytes


def test_each_frame_is_read_alone_and_in_any_order(opened, frames):
    file = opened(bytes(11) + frames.tobytes(), FrameLayout((7, 9), "<u2"), range(11, 641, 126))
    assert list(file.kinds) == [FrameKind((7, 9), "uint16")] * 5
    for index in (4, 0, 3, 3, 1):
        npt.assert_array_equal(file.read(index), frames[index])
    with ThreadPoolExecutor(4) as pool:
        npt.assert_array_equal(list(pool.map(file.read, range(5))), frames)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("code", ["u1", "u2", "i2", "u4", "i4", "f4", "f8"])
def test_types_and_byte_orders(opened, order, code):
    counts = np.arange(-6, 6).astype(code).reshape(3, 4)
    file = opened(counts.astype(order + code).tobytes(), FrameLayout((3, 4), order + code), [0])
    npt.assert_array_equal(file.read(0), counts)
    assert file.read(0).dtype.name == file.kinds[0].dtype == counts.dtype.name
    assert file.read(0).dtype.isnative
    assert file.read(0).flags.writeable
    assert file.read(0).flags.c_contiguous


def test_rows_with_gaps_and_from_the_bottom(opened, frames):
    padded = np.zeros((5, 7, 10), np.uint16)
    padded[..., :9] = frames[:, ::-1]
    layout = FrameLayout((7, 9), "<u2", row_bytes=20, bottom_up=True)
    file = opened(padded.tobytes(), layout, range(0, 700, 140))
    npt.assert_array_equal(file.read(2), frames[2])
    assert file.read(2).flags.c_contiguous


def test_frames_behind_the_end_are_truncated_and_the_others_read(opened, frames):
    layout = FrameLayout((7, 9), "<u2")
    file = opened(frames.tobytes()[:-1], layout, range(0, 630, 126))
    assert list(file.kinds) == [layout.kind] * 4 + [TRUNCATED]
    npt.assert_array_equal(file.read(3), frames[3])
    with pytest.raises(FrameError, match="truncated"):
        file.read(4)


@pytest.mark.parametrize(
    ("shape", "count", "words"),
    [
        ((7, 9), 10**9, "its header names 1000000000 frames"),
        ((7, 9), 60, "names 60 frames of 9 x 7 uint16, and its 630 bytes hold 5 of them"),
        ((7, 9), 0, "names 0 frames"),
        ((0, 9), 1, "holds no image"),
        ((7, -9), 1, "holds no image"),
        ((10**6, 10**6), 1, "cannot hold"),
    ],
)
def test_a_lying_header_is_refused_without_memory(opened, frames, shape, count, words):
    with pytest.raises(FrameError, match=words):
        opened(frames.tobytes(), FrameLayout(shape, "<u2"), range(0, 126 * count, 126))


@pytest.mark.parametrize("rate", [0.0, -1.0, 1e-320, 10**400, float("inf"), float("nan")])
def test_a_rate_that_no_camera_has_gives_no_times(rate):
    assert frame_interval(rate) is None
