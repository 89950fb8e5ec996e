"""The encoder log: what is read of it, and each way in which a row or a column can be wrong."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import EncoderError
from erlif.io.ingest import Page
from erlif.io.ingest.encoder_log import check_rows, read_log
from erlif.io.ingest.logs.columns import ColumnChoice
from erlif.io.ingest.logs.resample import ContinuousLog, find_pulses


@pytest.fixture
def write_log(tmp_path):
    def write(text):
        path = tmp_path / "encoder.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def read_by_frame(path):
    """A log with one row for each frame."""
    return read_log(path, ColumnChoice(), frames=0)[0]


# what is read


def test_further_columns_keep_their_names(write_log):
    text = "frame,angle_deg,laser mJ,Kraft 2,note,\n0,1,5.5,,a,\n1,2,5.6,3,,\n"
    log = read_by_frame(write_log(text))
    assert log["laser mJ"].values.tolist() == [5.5, 5.6]
    np.testing.assert_array_equal(log["Kraft 2"], [np.nan, 3])
    assert log["note"].values.tolist() == ["a", ""]
    assert "" not in log


def test_numbers_may_begin_anywhere_and_be_as_large_as_double_precision_holds(write_log):
    first = 2**53 - 1
    log = read_by_frame(write_log(f"frame,angle_deg\n{first},1\n{first + 1},2\n"))
    assert log.number.values.tolist() == [first, first + 1]
    assert read_by_frame(write_log("frame,angle_deg\n-1,1\n0,2\n")).number.values[0] == -1
    with pytest.raises(EncoderError, match="whole number in row 2"):
        read_by_frame(write_log(f"frame,angle_deg\n{first + 3},1\n"))


# logs that cannot be read are refused by name in the catalogue of damages

# one row for each frame


def pages(*numbers):
    return [Page(Path(f"f_{number}.tif"), 0) for number in numbers]


def logged(*numbers):
    return xr.Dataset({"number": ("frame", np.array(numbers))})


@pytest.mark.parametrize(
    ("rows", "frames", "words"),
    [
        # the names carry the numbers of the log: the gap is found
        ([0, 1, 2, 3], [0, 1, 3], "frame 2 of log.csv is the first without a file"),
        ([5, 6, 7], [6, 7], "frame 5 of"),
        ([0, 1, 2, 3], [0, 1, 2], "frame 3 of"),
        # they do not: the surplus stands at the end
        ([0, 1, 2, 3], [10, 11], "frame 2 of log.csv is the first without a file; the names"),
        ([0, 1, 2, 3], [1, 2, 10], "frame 3 of"),
        # the files count from 1, the rows from 0: the gap of the names is the missing frame
        ([0, 1, 2, 3, 4], [1, 2, 4, 5], "frame 2 of"),
        ([0, 1, 2, 3, 4], [7, 20, 33, 46], "if no frame was missed earlier"),
    ],
)
def test_the_first_row_without_a_frame_is_named(rows, frames, words):
    with pytest.raises(EncoderError) as refused:
        check_rows(logged(*rows), pages(*frames), "log.csv")
    assert f"{len(rows)} rows, the cameras have {len(frames)} frames" in str(refused.value)
    assert words in str(refused.value)


def test_the_first_frame_without_a_row_is_named():
    with pytest.raises(EncoderError, match=r"f_3\.tif is the first without a row"):
        check_rows(logged(0, 1), pages(1, 2, 3, 4), "log.csv")


@pytest.mark.parametrize(
    ("rows", "names"),
    [
        ([-2, -1, 0], ("Img-0002", "Img-0001", "Img0000")),
        ([-2, -1, 0], ("f_1", "f_2", "f_3")),  # the camera counts from 1
        ([1, 2, 3], ("f-1", "f-2", "f-3")),
        ([4, 5, 6], ("b", "a", "c")),
    ],
)
def test_numbers_of_rows_and_files_agree(rows, names):
    check_rows(logged(*rows), [Page(Path(f"{name}.tif"), 0) for name in names], "log.csv")


@pytest.mark.parametrize(
    ("rows", "names", "words"),
    [
        # without a frame at or after the trigger the hyphen may be a separator
        ([-2, -1], ("Img-0001", "Img-0002"), "frame -2 meets Img-0001.tif, whose number is read"),
        ([-1, 0, 1], ("a-0002", "a-0001", "a0000"), "as -2"),
        ([0, 1, 2], ("east_1", "north_2", "west_0"), "row of frame 0 meets east_1.tif"),
        ([1, 2, 3], ("9h58_1", "10h01_3", "10h02_2"), "row of frame 2 meets 10h01_3.tif"),
    ],
)
def test_files_in_another_order_than_the_rows_are_refused(rows, names, words):
    with pytest.raises(EncoderError) as refused:
        check_rows(logged(*rows), [Page(Path(f"{name}.tif"), 0) for name in names], "log.csv")
    assert words in str(refused.value)


# logs of other loggers


def test_a_log_without_frame_numbers_has_one_row_for_each_frame_where_the_counts_agree(write_log):
    log, notes = read_log(write_log("angle_deg\tt\n1\t0\n2\t1\n"), ColumnChoice(), frames=2)
    assert log.number.values.tolist() == [0, 1]
    assert "row k of 2 is frame k" in str(notes[0])


def test_a_log_in_time_is_recognised_by_its_number_of_rows(write_log):
    rows = "".join(f"{k / 10},{(355 + 3 * k) % 360},{k}\n" for k in range(6))
    log, notes = read_log(write_log(f"time_s,angle_deg,F\n{rows}"), ColumnChoice(), frames=3)
    assert isinstance(log, ContinuousLog)
    assert log.samples.angle.values.tolist() == [355, 358, 361, 364, 367, 370]
    assert "6 rows from 0 to 0.5 s, 10 per second" in str(notes[0])
    assert "its angle is counted on" in str(notes[0])


def test_clock_times_that_are_chosen_are_times_over_the_end_of_summer_time(write_log):
    """02:59:59.5 of summer time is followed by 02:00:00, an hour before it by the clock."""
    before, after = ("2026-10-25 02:59:59", "2026-10-25 02:00:00")
    rows = [f"{clock}.{part},{k}" for clock in (before, after) for k, part in enumerate((0, 5))]
    path = write_log("\n".join(["Zeit,angle_deg", *rows]) + "\n")
    log, notes = read_log(path, ColumnChoice({"time": "Zeit", "angle": "angle_deg"}), frames=4)
    np.testing.assert_allclose(log.time, [0, 0.5, 1, 1.5])
    assert "changes by an hour in row 4" in notes[0].text


def test_a_count_of_the_frames_in_a_log_in_time_is_its_pulse(write_log):
    path = write_log("frame,time_s,angle_deg\n" + "".join(f"{k // 3},{k},{k}\n" for k in range(9)))
    with pytest.raises(EncoderError, match='counts the frames, write pulse = "frame"'):
        read_log(path, ColumnChoice(), frames=2)
    log = read_log(path, ColumnChoice({"pulse": "frame"}), frames=2)[0]
    assert find_pulses(log, log.samples["pulse"].values, 2).tolist() == [2.5, 5.5]


def test_a_log_in_time_needs_time_and_angle(write_log):
    text = "2 rows for 5 frames, and no column is known as frame or time. .* the header is F, angle"
    with pytest.raises(EncoderError, match=text):
        read_log(write_log("F,angle_deg\n1,2\n3,4\n"), ColumnChoice(), frames=5)
    with pytest.raises(EncoderError, match="Expected a column for the angle"):
        read_log(write_log("F,time_s\n1,2\n3,4\n"), ColumnChoice(), frames=5)
    log = read_log(
        write_log("F,time_s\n1,2\n3,4\n4,5\n5,6\n"), ColumnChoice(), frames=5, needs_angle=False
    )[0]
    assert "angle" not in log.samples
