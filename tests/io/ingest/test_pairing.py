"""Pairs of frames from two folders that a test fills, unequal, out of step and damaged."""

import numpy as np
import pytest
import tifffile
from scenes.camera_files import write_im7
from scenes.tiff_pages import write_pages

from erlif.core.errors import FrameError
from erlif.io.ingest import read_frames, read_pair
from erlif.io.ingest.numbering import add_lost_pairs
from erlif.io.ingest.pairing import pair_cameras
from erlif.io.ingest.recording import number_frames
from erlif.io.ingest.selection import Selection

SHAPE = (64, 80)
GREY = np.random.default_rng(6).integers(0, 1000, SHAPE, dtype=np.uint16)


@pytest.fixture
def record(tmp_path):
    """Write frames of these numbers for each camera and pair them."""

    def fill(one, two, *, names=("f_{}.tif", "f_{}.tif")):
        for camera, numbers, name in zip((1, 2), (one, two), names, strict=True):
            (tmp_path / f"camera{camera}").mkdir(exist_ok=True)
            for number in numbers:
                tifffile.imwrite(tmp_path / f"camera{camera}" / name.format(number), GREY)
        return tmp_path

    return fill


def pair(directory, *, patterns=("camera1/*", "camera2/*"), bit_depths=(12, 12), **options):
    return pair_cameras(directory, patterns, bit_depths=bit_depths, **options)


def refusal(directory, **options):
    with pytest.raises(FrameError) as refused:
        pair(directory, **options)
    return str(refused.value)


def break_data(path):
    """Compressed pixels that no decoder reads, under a sound header."""
    tifffile.imwrite(path, GREY, compression="zlib")
    with tifffile.TiffFile(path) as file:
        start = file.pages[0].dataoffsets[0]
    content = bytearray(path.read_bytes())
    content[start : start + 40] = b"\xff" * 40
    path.write_bytes(content)


# frames that pair


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (range(4), range(4)),
        (range(4), range(1, 5)),  # the cameras count from different numbers
        (range(4), range(100, 104)),
        (range(0, 8, 2), range(101, 109, 2)),  # one trigger in two
        ([3, 90, 500, 501], [11, 22, 33, 44]),
    ],
)
def test_frames_pair_in_natural_order(record, one, two):
    pairs = pair(record(one, two))
    for pages, numbers in zip(pairs.pages, (one, two), strict=True):
        assert [page.name for page in pages] == [f"f_{number}.tif" for number in numbers]
    assert (pairs.shape, pairs.bit_depths, pairs.skipped) == (SHAPE, (12, 12), {})


# frames that do not pair, and odd ones, are refused by name in the catalogue of damages

# damaged frames


def test_a_damaged_pair_is_left_out_on_request(record):
    directory = record(range(4), range(4))
    (directory / "camera2" / "f_0.tif").write_bytes(b"")
    (directory / "camera1" / "f_2.tif").write_bytes(b"foreign")
    pairs = pair(directory, skip_bad_frames=True)
    assert pairs.usable == [1, 3]
    assert pairs.skipped[0] == "camera2/f_0.tif: the file is empty"
    assert pairs.skipped[2].startswith("camera1/f_2.tif: the file is damaged or not a TIFF")


def test_pixels_that_cannot_be_decoded_are_left_out_on_request(record):
    directory = record(range(3), range(3))
    break_data(directory / "camera2" / "f_1.tif")
    pairs = pair(directory, skip_bad_frames=True)
    assert pairs.usable == [0, 2]
    assert pairs.skipped == {1: "camera2/f_1.tif: it cannot be decoded"}
    # without the request the headers alone are read; the frame is refused where it is used
    with pytest.raises(FrameError, match=r"f_1\.tif; it cannot be decoded"):
        read_frames(pair(directory), [1])


def test_no_pair_left_is_refused_even_on_request(record):
    directory = record(range(2), range(2))
    (directory / "camera1" / "f_0.tif").write_bytes(b"")
    (directory / "camera2" / "f_1.tif").write_bytes(b"")
    message = refusal(directory, skip_bad_frames=True)
    assert "every pair has an unreadable file: camera1/f_0.tif: the file is empty" in message
    assert "--skip-bad-frames" not in refusal(directory)


def test_both_cameras_are_named_where_both_are_unreadable(record):
    directory = record(range(2), range(2))
    for name in ("camera1/f_0.tif", "camera1/f_1.tif", "camera2/f_0.tif", "camera2/f_1.tif"):
        (directory / name).write_bytes(b"")
    for skip in (False, True):
        message = refusal(directory, skip_bad_frames=skip)
        assert "camera1/f_0.tif: the file is empty; camera2/f_0.tif: the file is empty" in message
        assert "--skip-bad-frames" not in message


@pytest.mark.parametrize("camera", [1, 2])
def test_a_truncated_multi_page_file_loses_its_last_pairs_only(tmp_path, camera):
    for number in (1, 2):
        write_pages(tmp_path / f"all{number}.tif", [GREY] * 6)
    path = tmp_path / f"all{camera}.tif"
    with tifffile.TiffFile(path) as file:
        fourth = file.pages[3].aspage().dataoffsets[0]
    path.write_bytes(path.read_bytes()[: fourth + 100])
    patterns = ("all1.tif", "all2.tif")
    assert f"all{camera}.tif[3] of camera {camera}: the file is truncated" in refusal(
        tmp_path, patterns=patterns
    )
    pairs = pair(tmp_path, patterns=patterns, skip_bad_frames=True)
    assert pairs.usable == [0, 1, 2]
    assert sorted(pairs.skipped) == [3, 4, 5]
    assert all("the file is truncated" in reason for reason in pairs.skipped.values())


# frames that are lost


@pytest.mark.parametrize(
    ("one", "two", "skipped"),
    [
        ([0, 1, 2, 3], [0, 1, 3], {2: 2}),
        ([0, 1, 3], [0, 1, 2, 3], {2: 1}),
        ([0, 1, 3, 4], [0, 2, 3, 4], {1: 2, 2: 1}),  # as many of both cameras
        ([0, 1, 2, 3], [0, 1, 2], {3: 2}),
        ([8, 9, 10, 11], [8, 9, 11], {2: 2}),
        ([1, 3, 7], [1, 3, 5, 7], {2: 1}),
    ],
)
def test_a_lost_frame_is_left_out_with_its_partner_on_request(record, one, two, skipped):
    directory = record(one, two)
    assert "Use --skip-bad-frames to leave it out" in refusal(directory)
    pairs = pair(directory, skip_bad_frames=True)
    numbers = sorted({*one, *two})
    assert [page.name for page in pairs.pages[0]] == [f"f_{number}.tif" for number in numbers]
    assert pairs.pages[0][0].path.parent != pairs.pages[1][0].path.parent
    assert pairs.skipped == {
        k: f"camera{camera}/f_{numbers[k]}.tif: the file is missing"
        for k, camera in skipped.items()
    }
    for k in pairs.usable:
        assert all(pages[k].path.exists() for pages in pairs.pages)


def test_a_lost_frame_and_a_damaged_one_have_their_own_reasons(record):
    directory = record([0, 1, 2, 3], [0, 1, 3], names=("a_{:03}.tif", "b_{:03}.tif"))
    (directory / "camera2" / "b_003.tif").write_bytes(b"")
    assert pair(directory, skip_bad_frames=True).skipped == {
        2: "camera2/b_002.tif: the file is missing",
        3: "camera2/b_003.tif: the file is empty",
    }


@pytest.mark.parametrize(
    ("one", "two", "names"),
    [
        (range(5), range(1, 5), ("f_{}.tif", "f_{}.tif")),  # the first one, or another first number
        (range(5), [100, 101, 103, 104], ("f_{}.tif", "f_{}.tif")),
        (range(5), range(4), ("{}.tif", "{}_b1.tif")),  # no number of camera 2 counts frames
        (range(6), [0, 1, 7, 8, 9], ("f_{}.tif", "f_{}.tif")),  # few are common
    ],
)
def test_frames_without_numbers_that_show_the_lost_one_stay_refused(record, one, two, names):
    directory = record(one, two, names=names)
    message = refusal(directory, skip_bad_frames=True)
    assert f"camera1 has {len(one)}, camera2 has {len(two)}" in message
    assert "Use --skip-bad-frames to leave it out" not in message


def test_numbers_that_neither_camera_has_are_pairs_that_are_left_out(record):
    pairs = pair(record([0, 1, 2, 4, 5], [0, 1, 2, 4]), skip_bad_frames=True)
    whole = add_lost_pairs(pairs)
    assert [page.name for page in whole.pages[1]] == [f"f_{number}.tif" for number in range(6)]
    assert whole.skipped == {
        3: "neither camera has f_3.tif",
        5: "camera2/f_5.tif: the file is missing",
    }
    assert add_lost_pairs(whole) is whole


# two cameras in one file

PARTS = [("left", "right"), ("top", "bottom"), ("odd", "even")]


def write_both(path, part, one, two):
    """One file in which each part holds the frames of its camera."""
    if part == "odd":
        pages = [page for pair in zip(one, two, strict=True) for page in pair]
    else:
        stack = np.hstack if part == "left" else np.vstack
        pages = [stack(pair) for pair in zip(one, two, strict=True)]
    tifffile.imwrite(path, np.stack(pages), photometric="minisblack")


@pytest.mark.parametrize("mirrored", [False, True], ids=["in order", "exchanged"])
@pytest.mark.parametrize("parts", PARTS, ids=" ".join)
def test_each_camera_has_its_part_of_a_shared_file(tmp_path, parts, mirrored):
    rng = np.random.default_rng(3)
    counts = rng.integers(0, 4096, (2, 3, *SHAPE), dtype=np.uint16)
    write_both(tmp_path / "both.tif", parts[0], *counts)
    parts, counts = (parts[::-1], counts[::-1]) if mirrored else (parts, counts)
    selections = tuple(Selection(part) for part in parts)
    pairs = pair(tmp_path, patterns=("both.tif", "both.tif"), selections=selections)
    np.testing.assert_array_equal(read_frames(pairs, [0, 1, 2]).counts, counts)
    assert read_pair(pairs, 2, digests=True).digests == ("", "")  # other frames share the file


@pytest.mark.parametrize(
    "parts", [("", ""), ("left", ""), ("left", "left"), ("left", "top"), ("odd", "right")]
)
def test_the_same_files_without_parts_that_exclude_one_another_are_refused(tmp_path, parts):
    write_both(tmp_path / "both.tif", "left", [GREY, GREY], [GREY, GREY])
    message = refusal(
        tmp_path,
        patterns=("both.tif", "*.tif"),
        selections=tuple(Selection(part) for part in parts),
    )
    assert "both [camera1] and [camera2] name both.tif" in message
    assert 'part = "left" and part = "right"' in message


@pytest.mark.parametrize("cut", ["camera1", "camera2"])
def test_times_of_a_cut_recording_are_those_of_the_other_camera(tmp_path, cut):
    """Fewer times than frames had ended in a traceback."""
    for name in ("camera1", "camera2"):
        content = np.stack([GREY] * 5).tobytes()
        (tmp_path / f"{name}.raw").write_bytes(content[:-20_000] if name == cut else content)
        (tmp_path / f"{name}.toml").write_text(
            'width = 80\nheight = 64\npixel_format = "Mono12"\nframe_rate = 100.0\n'
        )
    pairs = pair(tmp_path, patterns=("camera1.raw", "camera2.raw"), skip_bad_frames=True)
    assert sorted(pairs.skipped) == [3, 4]
    np.testing.assert_allclose(number_frames(pairs).time, np.arange(5) / 100)


@pytest.mark.parametrize(
    ("channels", "expected"),
    [((1, 3), ""), ((2, 4), ""), ((1, 4), "are 10 ms later"), ((2, 3), "are 10 ms earlier")],
)
def test_channels_of_two_exposures_are_warned_of(tmp_path, channels, expected):
    """Double frames of two cameras, with times as DaVis writes them."""
    times = [b"AcqTimeSeries%d=18040840 \xb5s" % n for n in range(4)]
    times += [b"AcqTime%d=%d \xb5s" % (n, 500 + 10_000 * (n % 2)) for n in range(4)]
    for number in (1, 2):
        frames = np.random.default_rng(number).integers(0, 1000, (4, *SHAPE), dtype=np.uint16)
        write_im7(tmp_path / f"B0000{number}.im7", frames, attributes=times)
    selections = [Selection(f"channel {n}") for n in channels]
    pairs = pair(tmp_path, patterns=("*.im7", "*.im7"), selections=selections)
    assert not pairs.warnings[0]
    assert expected in pairs.warnings[1]
    assert bool(expected) == bool(pairs.warnings[1])


def test_frames_of_recordings_in_one_file_each_are_not_dropped_by_empty_files(tmp_path):
    write_pages(tmp_path / "all1.tif", [GREY] * 6)
    write_pages(tmp_path / "all2.tif", [GREY] * 5)
    message = refusal(tmp_path, patterns=("all1.tif", "all2.tif"))
    assert "The first unmatched one is all1.tif[5] of camera 1. Export the same frames" in message
    assert "empty file" not in message


@pytest.mark.parametrize(("frames", "asks"), [(7, True), (5, False)])
def test_very_unequal_counts_are_a_matter_of_the_names_of_the_files(tmp_path, frames, asks):
    for number, count in ((1, frames), (2, 3)):
        for k in range(count):
            write_pages(tmp_path / f"{number}_{k}.tif", [GREY])
    message = refusal(tmp_path, patterns=("1_*.tif", "2_*.tif"))
    assert ("Check files of [camera1] and [camera2] first" in message) == asks
    assert ("--skip-bad-frames" in message) != asks


def test_two_recordings_under_one_pattern_are_named_with_their_frames(tmp_path):
    for name, count in {"run_1": 4, "wedge_1": 2, "run_2": 4}.items():
        write_pages(tmp_path / f"{name}.tif", [GREY] * count)
    message = refusal(tmp_path, patterns=("*_1.tif", "run_2.tif"))
    assert "camera1 has the frames of run_1.tif (4), wedge_1.tif (2)" in message


@pytest.mark.parametrize("padded", [0, 2])
@pytest.mark.parametrize("parts", [(None, None), ("left", "right")])
def test_the_time_that_a_pco_camera_writes_over_pixels_is_warned_of(tmp_path, parts, padded):
    """First pixels of Cam0A.tiff of pco_image, of a pco.pixelfly; some are left-aligned."""
    stamped = np.random.default_rng(6).integers(0, 16384, (64, 160), dtype=np.uint16)
    stamped[0, :14] = [0, 0, 0, 1, 32, 35, 2, 20, 35, 5, 32, 117, 73, 70]
    tifffile.imwrite(tmp_path / "a.tif", stamped << padded)
    selections = [Selection(part or "", shift=padded) for part in parts]
    patterns = ("a.tif", "a.tif")
    if parts == (None, None):
        tifffile.imwrite(tmp_path / "b.tif", stamped[::-1] << padded)
        patterns = ("a.tif", "b.tif")
    pairs = pair(tmp_path, patterns=patterns, bit_depths=(14, 14), selections=selections)
    assert (
        "the first pixels of a.tif of camera 1 hold the time 2023-02-14 23:05:20"
        in pairs.warnings[0]
    )
    assert not pairs.warnings[1]
