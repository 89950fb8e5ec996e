"""Image files against what tifffile and imageio wrote, byte by byte where a file is damaged."""

import hashlib
import os
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tifffile
from scenes.camera_files import write_mraw
from scenes.tiff_pages import write_pages

from erlif.core.errors import FrameError
from erlif.core.notes import Level
from erlif.io.ingest import Page, depth_warning, read_reference_pages
from erlif.io.ingest.images import (
    UNREADABLE,
    check_depth,
    find_pages,
    match_files,
    read_content,
    read_page,
)
from erlif.io.ingest.selection import Selection
from erlif.io.readers.base import FrameKind

RNG = np.random.default_rng(5)
GREY = RNG.integers(0, 4096, (64, 80), dtype=np.uint16)


# names


def test_bytes_of_a_name_that_are_not_utf_8_are_replaced():
    name = Page(Path(os.fsdecode(b"frame_\xff.tif")), 0).name
    assert name == "frame_\N{REPLACEMENT CHARACTER}.tif"


# files


def test_files_come_in_natural_order_without_hidden_ones_and_folders(tmp_path):
    for name in ("f_10.tif", "f_2.tif", "f_1.tif", "._f_1.tif", ".f_3.tif", "other.png"):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "folder.tif").mkdir()
    found = match_files(tmp_path, "*.tif")
    assert [path.name for path in found] == ["f_1.tif", "f_2.tif", "f_10.tif"]


def test_brackets_of_a_name_are_no_pattern_where_they_match_nothing(tmp_path):
    (tmp_path / "camera1 [580nm]").mkdir()
    for name in ("camera1 [580nm]/f_1.tif", "f_1.tif", "f_2.tif"):
        (tmp_path / name).touch()
    assert [p.name for p in match_files(tmp_path, "camera1 [580nm]/*.tif")] == ["f_1.tif"]
    assert [p.name for p in match_files(tmp_path, "f_[2-9].tif")] == ["f_2.tif"]


# headers


def test_each_page_of_each_file_is_found_with_its_kind(tmp_path):
    write_pages(tmp_path / "1.tif", [GREY, GREY])
    write_pages(tmp_path / "2.tif", [GREY.astype(np.uint8)])
    found = find_pages(tmp_path, "*.tif", "camera1")
    assert [page.name for page in found.pages] == ["1.tif", "1.tif[1]", "2.tif"]
    assert found.kinds == [FrameKind((64, 80), dtype) for dtype in ("uint16", "uint16", "uint8")]
    assert found.faults == {}


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("b.tif", b"", "the file is empty"),
        ("b.dat", b"not an image", "its format is none of those that are read: TIFF, "),
    ],
)
def test_a_damaged_file_keeps_its_place_as_one_unreadable_page(tmp_path, name, content, reason):
    write_pages(tmp_path / "a.tif", [GREY])
    write_pages(tmp_path / "c.tif", [GREY])
    (tmp_path / name).write_bytes(content)
    found = find_pages(tmp_path, "*", "camera1")
    assert [page.path.name for page in found.pages] == ["a.tif", name, "c.tif"]
    assert list(found.faults) == [1]
    assert reason in found.faults[1]
    assert found.kinds[1] == UNREADABLE


def test_a_black_frame_under_deflate_is_not_damaged(tmp_path):
    """Deflate reaches 1032 bytes a byte at most (RFC 1951): 516 pixels of 16 bits."""
    black = np.zeros((1024, 1024), np.uint16)
    tifffile.imwrite(tmp_path / "a.tif", black, compression="zlib", rowsperstrip=1024)
    assert black.nbytes / (tmp_path / "a.tif").stat().st_size > 500
    found = find_pages(tmp_path, "a.tif", "camera1")
    assert found.faults == {}
    np.testing.assert_array_equal(read_page(found.pages[0], tmp_path, black.shape), black)


# counts


def test_left_aligned_counts_are_shifted(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", GREY << 4)
    (page,) = find_pages(tmp_path, "a.tif", "camera1", Selection(shift=4)).pages
    np.testing.assert_array_equal(read_page(page, tmp_path, (64, 80)), GREY)
    with pytest.raises(FrameError, match=r"a\.tif; its counts are not left-aligned"):
        read_page(replace(page, selection=Selection(shift=6)), tmp_path, (64, 80))


@pytest.mark.parametrize("part", ["top", "right"])
def test_the_hash_of_a_part_is_that_of_the_file(tmp_path, part):
    tifffile.imwrite(tmp_path / "a.tif", GREY)
    (page,) = find_pages(tmp_path, "a.tif", "camera1", Selection(part)).pages
    shape = Selection(part).crop_shape((64, 80))
    content = read_content(page, tmp_path, shape, digest=True)
    assert content.digest == hashlib.sha256((tmp_path / "a.tif").read_bytes()).hexdigest()
    assert content.counts.shape == shape


# bit depth


@pytest.mark.parametrize(("bit_depth", "top"), [(8, 255), (10, 1023), (12, 4095), (16, 65535)])
def test_full_scale_itself_fits(bit_depth, top):
    check_depth(np.arange(top - 63, top + 1).astype(np.uint16), bit_depth=bit_depth, name="a")


@pytest.mark.parametrize(("top", "fits"), [(4096, 13), (8191, 13), (8193, 14), (65535, 16)])
def test_counts_above_full_scale_are_refused_with_the_depth_that_fits(top, fits):
    counts = np.array([[1, 2, 3, top]], np.uint16)
    with pytest.raises(FrameError, match=rf"a\.tif reaches {top}: bit_depth = {fits} fits"):
        check_depth(counts, bit_depth=12, name="a.tif")


@pytest.mark.parametrize(("offset", "inverted"), [(0, False), (61440, True)])
def test_counts_of_an_inverted_image_are_named(offset, inverted):
    counts = (65535 - GREY) if inverted else GREY + np.uint16(4096)
    with pytest.raises(FrameError) as refused:
        check_depth(counts, bit_depth=12, name="a.tif")
    assert ("stored inverted (MINISWHITE)" in str(refused.value)) == inverted


def test_a_folder_in_the_place_of_a_file_is_named(tmp_path):
    (tmp_path / "camera1.zarr").mkdir()
    with pytest.raises(FrameError, match=r"camera1\.zarr of camera1 in .*; it is a folder\."):
        find_pages(tmp_path, "camera1.zarr", "camera1")


@pytest.mark.parametrize(
    ("own", "shift", "bit_depth", "advice"),
    [
        *((12, 4, 12, 'Set alignment = "left" and'), (12, 4, 16, 'Set alignment = "left" and')),
        *((14, 2, 16, 'Set alignment = "left" and'), (10, 6, 12, 'Set alignment = "left" and')),
        (8, 4, 12, "Divide the counts by 16, save them again and set"),
    ],
)
def test_left_aligned_counts_are_refused_with_their_own_depth(own, shift, bit_depth, advice):
    counts = np.arange((1 << own) - 32, 1 << own).astype(np.uint16) << shift
    with pytest.raises(FrameError) as refused:
        check_depth(counts, bit_depth=bit_depth, name="a.tif")
    assert f"multiples of {1 << shift} up to {counts.max()}" in str(refused.value)
    assert f"{own}-bit counts, left-aligned" in str(refused.value)
    assert f"{advice} bit_depth = {own}." in str(refused.value)


def test_a_single_unused_bit_is_chance_and_few_levels_are_not_judged():
    check_depth(np.arange(0, 400, 2, dtype=np.uint16), bit_depth=12, name="a")
    check_depth(np.arange(4, 4 * 17, 4, dtype=np.uint16), bit_depth=12, name="a")  # 16 levels
    with pytest.raises(FrameError, match="left-aligned"):
        check_depth(np.arange(4, 4 * 18, 4, dtype=np.uint16), bit_depth=12, name="a")
    check_depth(np.zeros((4, 4), np.uint16), bit_depth=12, name="a")


@pytest.mark.parametrize(
    ("bit_depth", "highest", "fits"), [(12, 255, 8), (12, 5, 8), (16, 4095, 12), (16, 600, 10)]
)
def test_a_run_within_a_sixteenth_of_full_scale_is_reported(bit_depth, highest, fits):
    note = depth_warning(highest, bit_depth=bit_depth, camera=2)
    assert (note.level, note.subject) == (Level.WARNING, "camera2")
    assert f"no count is above {highest} of {2**bit_depth - 1}" in note.text
    assert f"bit_depth = {fits} would fit" in note.text


def test_a_recording_of_two_files_keeps_its_times(tmp_path):
    write_mraw(tmp_path / "m.mraw", np.zeros((3, 64, 80), np.uint16), rate=2000)
    for pattern in ("m.mraw", "m.*"):
        np.testing.assert_allclose(find_pages(tmp_path, pattern, "x").times, [0, 5e-4, 1e-3])
    write_mraw(tmp_path / "n.mraw", np.zeros((3, 64, 80), np.uint16), rate=2000)
    assert find_pages(tmp_path, "*.mraw", "x").times is None


def test_a_file_longer_than_its_frame_is_not_taken_into_memory(tmp_path):
    """A file may be longer than its frame; it was read whole for its hash."""
    path = tmp_path / "a.npy"
    image = np.arange(64 * 80, dtype=np.uint16).reshape(64, 80)
    np.save(path, image)
    with path.open("ab") as file:
        file.truncate(2**28)
    (page,) = find_pages(tmp_path, "a.npy", "x").pages
    tracemalloc.start()
    content = read_content(page, tmp_path, (64, 80), digest=True)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10_000_000
    np.testing.assert_array_equal(content.counts, image)


# darks and flats

PAGES = np.random.default_rng(7).integers(40, 90, (5, 64, 80), dtype=np.uint16)


def read_darks(directory, pattern="dark.tif", *, bit_depth=12, shape=(64, 80)):
    return read_reference_pages(
        directory, pattern, what="camera2 dark", bit_depth=bit_depth, shape=shape
    )


def test_a_page_is_read_when_it_is_asked_for(tmp_path):
    """A recording larger than the memory can be read: the second page may still be changed."""
    write_pages(tmp_path / "dark_1.tif", PAGES[:1])
    write_pages(tmp_path / "dark_2.tif", PAGES[1:2])
    pages = read_darks(tmp_path, "dark_*.tif")
    next(pages)
    write_pages(tmp_path / "dark_2.tif", PAGES[2:3])
    np.testing.assert_array_equal(next(pages), PAGES[2])


def test_every_page_must_fit_the_bit_depth(tmp_path):
    pages = PAGES.copy()
    pages[3, 0, 0] = 4096
    write_pages(tmp_path / "dark.tif", pages)
    found = read_darks(tmp_path)
    for _ in range(3):
        next(found)
    with pytest.raises(FrameError, match=r"dark\.tif\[3\] reaches 4096: bit_depth = 13 fits"):
        next(found)
    assert len(list(read_darks(tmp_path, bit_depth=13))) == 5
