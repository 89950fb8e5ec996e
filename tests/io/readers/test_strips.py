"""Strips and tiles against the image that tifffile or libtiff has stored in them."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile
from scenes.camera_files import pack_counts

from erlif.core.errors import FrameError
from erlif.io.readers.source import Source
from erlif.io.readers.strips import LZW, NONE, Segments, read_segments

IMAGE = np.random.default_rng(4).integers(0, 4096, (7, 10), dtype=np.uint16)


def stored(tmp_path, *parts, **changes):
    """The parts one after the other in a file, and a description of them."""
    path = tmp_path / "a.raw"
    path.write_bytes(b"".join(parts))
    starts = np.cumsum([0, *map(len, parts)])
    page = {
        "shape": (7, 10),
        "dtype": "<u2",
        "bits": 16,
        "compression": NONE,
        "predictor": 1,
        "part": (7, 10),
        "padded": False,
        "offsets": tuple(int(n) for n in starts[:-1]),
        "lengths": tuple(map(len, parts)),
    }
    return path, Segments(**(page | changes))


def read(path, page):
    with Source(path) as source:
        return read_segments(source, page)


def test_the_last_strip_has_fewer_rows(tmp_path):
    parts = [IMAGE[y : y + 3].tobytes() for y in (0, 3, 6)]
    np.testing.assert_array_equal(read(*stored(tmp_path, *parts, part=(3, 10))), IMAGE)


def test_tiles_at_the_edges_are_stored_in_full(tmp_path):
    padded = np.zeros((8, 12), ">u2")
    padded[:7, :10] = IMAGE
    tiles = [padded[y : y + 4, x : x + 6].tobytes() for y in (0, 4) for x in (0, 6)]
    found = read(*stored(tmp_path, *tiles, part=(4, 6), padded=True, dtype=">u2"))
    np.testing.assert_array_equal(found, IMAGE)
    assert found.dtype.isnative


@pytest.mark.parametrize("bits", [10, 12, 14])
@pytest.mark.parametrize("columns", [8, 9])
def test_rows_of_packed_counts_begin_at_a_byte(tmp_path, bits, columns):
    """TIFF 6.0, section 8: the highest bit first, rows padded to bytes."""
    counts = IMAGE[:, :columns] >> (12 - min(bits, 12))
    rows = ["".join(f"{count:0{bits}b}" for count in row.tolist()) for row in counts]
    size = -(-columns * bits // 8)
    data = b"".join(int(row.ljust(8 * size, "0"), 2).to_bytes(size) for row in rows)
    path, page = stored(tmp_path, data, shape=(7, columns), part=(7, columns), bits=bits)
    assert page.decodable
    np.testing.assert_array_equal(read(path, page), counts)


def test_packed_counts_are_those_of_the_other_formats(tmp_path):
    data = pack_counts(IMAGE, "HIGH_12")
    np.testing.assert_array_equal(read(*stored(tmp_path, data, bits=12)), IMAGE)


@pytest.mark.parametrize("dtype", ["<u2", ">u2", "|u1", "<i2", ">i4"])
def test_differences_wrap_round(tmp_path, dtype):
    image = IMAGE.astype(dtype)
    differences = np.diff(image.astype(np.int64), axis=1, prepend=0).astype(dtype)
    found = read(
        *stored(tmp_path, differences.tobytes(), dtype=dtype, predictor=2, bits=8 * image.itemsize)
    )
    np.testing.assert_array_equal(found, image)


@pytest.mark.parametrize(
    "changes",
    [
        {"compression": 50000},
        {"predictor": 3},
        {"predictor": 2, "bits": 12},
        {"predictor": 2, "dtype": "<f4", "bits": 32},
        {"bits": 4},
        {"bits": 24, "dtype": "<u4"},
        {"part": (3, 10)},
        {"lengths": ()},
    ],
)
def test_other_pages_are_left_to_tifffile(tmp_path, changes):
    assert not stored(tmp_path, IMAGE.tobytes(), **changes)[1].decodable


def test_a_strip_that_is_too_short_is_refused(tmp_path):
    path, page = stored(tmp_path, IMAGE.tobytes()[:-1])
    with pytest.raises(FrameError, match="too short"):
        read(path, page)


def test_a_strip_that_would_expand_without_end_is_not_expanded(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", np.zeros((512, 512), np.uint16), compression="zlib")
    with tifffile.TiffFile(tmp_path / "a.tif") as file:
        offset, length = file.pages[0].dataoffsets[0], file.pages[0].databytecounts[0]
    data = (tmp_path / "a.tif").read_bytes()[offset : offset + length]
    np.testing.assert_array_equal(read(*stored(tmp_path, data, compression=8)), np.zeros((7, 10)))
    for damaged, compression in ((data[:8], 8), (b"\x78\x9c\xff", 8), (b"\xff\xff", LZW)):
        with pytest.raises(FrameError, match="a strip of the image is damaged"):
            read(*stored(tmp_path, damaged, compression=compression))
