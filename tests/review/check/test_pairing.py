"""The pairing table and the numbers of the files."""

from pathlib import Path

import numpy as np

from erlif.io.ingest import FramePairs, Page
from erlif.review.check.pairing import note_numbers, tabulate_pairs


def test_a_missing_number_is_named_for_each_camera():
    pages = tuple(
        tuple(Page(Path(f"camera{c}/frame_{k:04d}.tif"), 0) for k in (0, 1, 2, 4, 5))
        for c in (1, 2)
    )
    one, two = note_numbers(FramePairs(Path(), pages, (64, 64), (12, 12)))
    assert one.text.startswith("camera1: no file has the number 3, between frame_0000.tif and")
    assert two.text.startswith("camera2: no file has the number 3")


def test_the_table_has_files_rows_angles_and_times_of_the_log(run, small_rig):
    rows = tabulate_pairs(run.pairs, run, odd=[3])
    assert [row.pair for row in rows] == [0, 1, 3, 5]
    log = np.genfromtxt(small_rig.run / "encoder.csv", delimiter=",", names=True)
    row = rows[2]
    assert (row.camera1, row.camera2, row.row) == ("frame_0003.tif", "frame_0003.tif", 3)
    assert (row.angle, row.time) == (log["angle_deg"][3], log["time_s"][3])
    assert str(row).startswith("pair 3: frame_0003.tif with frame_0003.tif, log frame 3, ")


def test_a_fixture_has_no_log(run):
    assert tabulate_pairs(run.pairs, None)[0].row is None
