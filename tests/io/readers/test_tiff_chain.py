"""Directories of TIFF files that tifffile wrote, and such as only a damaged file has."""

from __future__ import annotations

import struct
import time

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.io.readers import open_frames
from erlif.io.readers.tiff_chain import count_directories

COUNTS = np.zeros((3, 64, 80), np.uint16)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"bigtiff": True},
        {"byteorder": ">"},
        {"ome": True},
        {"imagej": True},
        {"tile": (16, 16)},
    ],
    ids=str,
)
def test_the_directories_of_tifffile_are_counted(tmp_path, options):
    tifffile.imwrite(tmp_path / "a.tif", COUNTS, photometric="minisblack", **options)
    assert count_directories(tmp_path / "a.tif") == 3


def test_a_chain_that_was_cut_off_is_left_to_the_reader(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", COUNTS, photometric="minisblack")
    content = (tmp_path / "a.tif").read_bytes()
    (tmp_path / "a.tif").write_bytes(content[:-50])
    assert 1 <= count_directories(tmp_path / "a.tif") < 3


def test_a_chain_that_leaves_the_file_ends_there(tmp_path):
    """Found at random: tifffile went round in a circle of broken directories behind it."""
    body = directory(2, 40) + bytes(2) + directory(1, 2)[:-4]
    (tmp_path / "a.tif").write_bytes(b"MM\0*" + struct.pack(">I", 8) + body)
    assert count_directories(tmp_path / "a.tif") == 1
    file = open_frames(tmp_path / "a.tif")
    assert [kind.dtype for kind in file.kinds] == ["truncated"]
    file.close()


def directory(entries: int, following: int, kind: int = 3, count: int = 1) -> bytes:
    """Entries for a private tag, and the place of the next directory."""
    entry = struct.pack(">HHIHH", 65000, kind, count, 1, 0)
    return struct.pack(">H", entries) + entries * entry + struct.pack(">I", following)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (directory(2, 8), "form a ring or overlap"),
        (directory(5, 74) + directory(7, 8), "form a ring or overlap"),
        (directory(60, 0, kind=99), "no list of entries"),
        (directory(1, 0, count=10**9), "no list of entries"),
    ],
)
def test_chains_of_a_damaged_file_are_refused(tmp_path, body, reason):
    (tmp_path / "a.tif").write_bytes(b"MM\0*" + struct.pack(">I", 8) + body)
    with pytest.raises(FrameError, match=reason):
        count_directories(tmp_path / "a.tif")
    with pytest.raises(FrameError, match=reason):
        open_frames(tmp_path / "a.tif")


@pytest.mark.parametrize("content", [b"", b"II*", b"PK\3\4 no TIFF", b"II+\0\x08\0\0\0"])
def test_other_files_are_refused(tmp_path, content):
    (tmp_path / "a.tif").write_bytes(content)
    with pytest.raises(FrameError, match=r"not a TIFF|truncated"):
        count_directories(tmp_path / "a.tif")


def test_directories_through_the_pixels_are_refused_at_once(tmp_path):
    """Found at random: 65,535 entries in each directory took tifffile minutes and 11 GB."""
    words = np.full(200_000, 3, ">u2")  # any place is a directory of three entries
    words[1::7] = 0xFFFF
    (tmp_path / "a.tif").write_bytes(b"MM\0*" + struct.pack(">I", 10) + words.tobytes())
    start = time.perf_counter()
    with pytest.raises(FrameError):
        open_frames(tmp_path / "a.tif")
    assert time.perf_counter() - start < 1
