"""Frame pairs, chosen and read, against the counts that were written."""

import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.core.notes import Level
from erlif.io.ingest import FramePairs, Page, format_notes, open_run, read_frames, read_pair
from erlif.io.ingest.frames import skipped_notes
from erlif.io.ingest.selection import Selection


def recorded(lab):
    """Counts of both cameras as tifffile reads them. [DN]"""
    return np.array([[tifffile.imread(path) for path in lab.frames(camera)] for camera in (1, 2)])


def make_pairs(count, skipped=(), bit_depths=(12, 12)):
    pages = tuple(Page(Path(f"{k}.tif"), 0) for k in range(count))
    return FramePairs(Path(), (pages, pages), (64, 80), bit_depths, dict.fromkeys(skipped, "empty"))


@pytest.mark.parametrize(
    ("stated", "subjects"),
    [
        ((None, None), []),
        ((12, 16), []),
        ((10, None), ["camera1"]),
        ((8, 11), ["camera1", "camera2"]),
    ],
)
def test_a_header_with_fewer_bits_than_the_settings_is_reported(stated, subjects):
    """Full scale would be missed: no pixel at 1023 is flagged where 4095 is expected."""
    notes = format_notes(replace(make_pairs(1), stated_bits=stated))
    assert [note.subject for note in notes] == subjects
    for note in notes:
        assert note.level == Level.WARNING
        assert "bit_depth = 12: counts at" in note.text


def test_an_order_of_axes_that_is_not_known_is_noted():
    pages = tuple(Page(Path("a.h5"), k, selection=Selection(array_order="unknown")) for k in (0, 1))
    (note,) = format_notes(replace(make_pairs(2), pages=(make_pairs(2).pages[0], pages)))
    assert note.subject == "camera2"
    assert 'array_order = "column" in [camera2]' in note.text


def test_the_order_of_several_stacks_is_noted():
    files = [("run.tif", 2), ("run (2).tif", 1)]
    pages = tuple(Page(Path(name), k) for name, count in files for k in range(count))
    notes = format_notes(replace(make_pairs(3), pages=(pages, make_pairs(3).pages[1])))
    assert [(note.subject, note.level) for note in notes] == [("camera1", Level.NOTE)]
    assert notes[0].text.endswith("in this order: run.tif, run (2).tif")


@pytest.mark.parametrize(
    ("count", "wanted", "chosen"),
    [(11, 3, [0, 5, 10]), (50, 8, [0, 7, 14, 21, 28, 35, 42, 49]), (9, 1, [0]), (3, 8, [0, 1, 2])],
)
def test_chosen_frames_are_spread_from_the_first_to_the_last(count, wanted, chosen):
    assert make_pairs(count).spread(wanted) == chosen


def test_frames_left_out_are_not_chosen():
    assert make_pairs(7, skipped=(0, 3, 6)).spread(2) == [1, 5]


def test_frames_come_as_they_were_written_in_the_order_asked_for(lab):
    frames = read_frames(open_run(lab.run).pairs, [4, 1])
    assert frames.counts.dims == ("camera", "frame", "y", "x")
    assert frames.counts.attrs["units"] == "DN"
    assert frames.counts.dtype == np.uint16
    assert frames.frame.values.tolist() == [4, 1]
    assert frames.camera.values.tolist() == [1, 2]
    np.testing.assert_array_equal(frames.counts, recorded(lab)[:, [4, 1]])


def test_files_are_hashed_as_they_are_read_where_asked(lab):
    pairs = open_run(lab.run).pairs
    assert read_pair(pairs, 4).digests == ("", "")
    found = read_pair(pairs, 4, digests=True)
    np.testing.assert_array_equal(found.counts, recorded(lab)[:, 4])
    files = (lab.frames(camera)[4].read_bytes() for camera in (1, 2))
    assert found.digests == tuple(hashlib.sha256(content).hexdigest() for content in files)


def test_counts_beyond_the_bit_depth_are_refused_in_every_frame(lab):
    odd = recorded(lab)[1, 3].copy()
    odd[10, 20] = 4096
    pairs = open_run(lab.run).pairs
    tifffile.imwrite(lab.frames(2)[3], odd)
    read_frames(pairs, [0, 1, 2])
    with pytest.raises(FrameError, match=r"frame_0003\.tif reaches 4096: bit_depth = 13 fits"):
        read_frames(pairs, [0, 3])


def test_pairs_in_a_row_with_one_reason_share_a_note():
    skipped = {k: f"camera2/frame_{k:04d}.tif: the file is missing" for k in (30, 150, 151, 152)}
    skipped[153] = "camera1/frame_0153.tif: the file is empty"
    notes = skipped_notes(FramePairs(Path(), ((), ()), (64, 64), (12, 12), skipped))
    assert [str(note) for note in notes] == [
        "frame pair 30 left out: camera2/frame_0030.tif: the file is missing",
        "frame pairs 150 to 152 left out: camera2/frame_0150.tif: the file is missing, and 2 more",
        "frame pair 153 left out: camera1/frame_0153.tif: the file is empty",
    ]
