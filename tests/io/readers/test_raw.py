"""Frames at known places of a file."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import counts_of_bits, pack_counts, random_frames

from erlif.io.readers.base import FrameKind
from erlif.io.readers.raw import FrameLayout, Packing, RawFrames, frame_interval, unpack


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


# 5e-324 was found by damaging files at random: its reciprocal overflows
@pytest.mark.parametrize("rate", [0.0, -1.0, 5e-324, 10**400, float("inf"), float("nan")])
def test_a_rate_that_no_camera_has_gives_no_times(rate):
    assert frame_interval(rate) is None


@pytest.mark.parametrize("packing", Packing)
def test_random_bytes_give_the_counts_of_a_bitwise_decoder(packing):
    packed = np.random.default_rng(1).integers(0, 256, 15_000, dtype=np.uint8)
    expected = counts_of_bits(packed, packing.name)
    npt.assert_array_equal(unpack(packed, expected.size, packing), expected)


@pytest.mark.parametrize("packing", Packing)
@pytest.mark.parametrize("pixels", [1, 2, 3, 4, 5, 6, 7, 8, 9, 63])
def test_incomplete_groups_at_the_end_are_decoded(packing, pixels):
    depth = int(packing.name[-2:])
    counts = np.random.default_rng(pixels).integers(0, 1 << depth, pixels).astype(np.uint16)
    packed = np.frombuffer(pack_counts(counts, packing.name), np.uint8)
    assert packing.size(pixels) <= packed.size
    npt.assert_array_equal(unpack(packed[: packing.size(pixels)], pixels, packing), counts)


@pytest.mark.parametrize(
    ("packing", "packed", "counts"),
    [
        # Basler racer GigE manual AW00118302000, 9.2.3
        (Packing.SPLIT_12, [0xAB, 0x3C, 0x12], [0xABC, 0x123]),
        # GenICam PFNC 2.4, Mono12p and Mono10p; all bits of the first pixel, none of the second
        (Packing.LOW_12, [0xBC, 0x3A, 0x12], [0xABC, 0x123]),
        (Packing.LOW_10, [0xFF, 0x03, 0xF0, 0x3F, 0], [1023, 0, 1023, 0]),
    ],
)
def test_tables_of_the_manuals(packing, packed, counts):
    assert unpack(np.array(packed, np.uint8), len(counts), packing).tolist() == counts
