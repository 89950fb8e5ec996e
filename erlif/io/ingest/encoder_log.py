"""The encoder log of a run: one row for each frame, or a log in time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from erlif.core.errors import EncoderError
from erlif.core.notes import Note, remark, warn
from erlif.core.products import EncoderLog
from erlif.io.ingest.images import Page, is_one_file
from erlif.io.ingest.logs.checks import check_frame_numbers, check_values
from erlif.io.ingest.logs.clock_times import with_clocks
from erlif.io.ingest.logs.columns import ColumnChoice, convert_columns, find_columns, missing_column
from erlif.io.ingest.logs.resample import FEWEST_SAMPLES, ContinuousLog, unwrap_angle
from erlif.io.ingest.logs.table import LogColumn, LogTable
from erlif.io.ingest.logs.text import read_log_table
from erlif.io.ingest.numbering import find_missing, frame_numbers, has_numbers
from erlif.io.ingest.order import has_hyphen, number_files

# The column of each quantity, and what was taken for what.
_Found = tuple[dict[str, LogColumn], list[str]]


def read_encoder_log(path: Path, *, needs_angle: bool = True) -> EncoderLog:
    """Read an encoder log with one row for each frame.

    Parameters
    ----------
    path : Path
        Text file of a logger: ``frame,time_s,angle_deg,load_N,temperature_C`` and further columns,
        of which ``frame`` and ``angle_deg`` are required.
    needs_angle : bool
        Whether a log without an angle is refused.

    Returns
    -------
    EncoderLog
        number (frame), angle (frame) [degree], and the other logged columns.

    Raises
    ------
    EncoderError
        If the file or a required column is missing, a value is not a finite number or impossible,
        or frames are repeated or missing. Each message names row and column; the first row of the
        file is row 1.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "encoder.csv"
    >>> _ = path.write_text("frame,angle_deg,load_N\\n0,10.5,222\\n1,11.5,221\\n")
    >>> log = read_encoder_log(path)
    >>> log.angle.values, log.angle.units
    (array([10.5, 11.5]), 'degree')
    """
    choice = ColumnChoice()
    table = read_log_table(path, choice.wanted)
    columns = find_columns(table, choice)
    if "frame" not in columns[0]:
        missing_column("frame", table)
    return _by_frame(table, choice, columns, needs_angle=needs_angle)[0]


def read_log(
    path: Path,
    choice: ColumnChoice,
    *,
    frames: int | None,
    in_time: bool = False,
    needs_angle: bool = True,
) -> tuple[EncoderLog | ContinuousLog, list[Note]]:
    """Read the log of a run, by frame or in time.

    A log with a column of frame numbers, or with as many rows as there are frames, has one row for
    each frame. Any other log with a column of times is continuous.

    Parameters
    ----------
    path : Path
    choice : ColumnChoice
    frames : int or None
        Number of frame pairs; None while log and frames are recorded. A log is then continuous
        where it has pulses or the settings state how the frames lie in time.
    in_time : bool
        Whether the settings state how the frames lie in time, so that the log is continuous.
    needs_angle : bool
        Whether a log without an angle is refused.

    Returns
    -------
    log : EncoderLog or ContinuousLog
        One row for each frame, or a log in time.
    notes : list of Note
        What was taken for what.

    Raises
    ------
    EncoderError
        As `read_encoder_log`.
    """
    table = read_log_table(path, choice.wanted)
    if "time" in choice.names:
        table = with_clocks(table)
    known = find_columns(table, choice)
    columns, _ = known
    by_frame = "frame" in columns or frames is None or len(table.rows) == frames
    in_time = in_time or "pulse" in columns or (not by_frame and "time" in columns)
    if not in_time and not by_frame:
        names, rows = ", ".join(table.names), len(table.rows)
        raise EncoderError(
            f"Expected one row of {table.file} for each frame, or a log in time; it has {rows} "
            f"rows for {frames} frames, and no column is known as frame or time. Choose the column "
            'of the times in [encoder] of run.toml, time = "name in the header", or that of frame '
            f'numbers, frame = "name in the header"; the header is {names}.'
        )

    read = _in_time if in_time else _by_frame
    log, remarks = read(table, choice, known, needs_angle=needs_angle)
    notes = [remark(table.file, "; ".join(remarks))] if remarks else []
    return log, notes


def leave_out_late_rows(
    log: EncoderLog, pages: Sequence[Page], name: str
) -> tuple[EncoderLog, list[Note]]:
    """The log without rows after the last frame, where files and rows have the same numbers.

    Arguments as in `check_rows`.

    Returns
    -------
    (EncoderLog, list of Note)
        A warning where there are such rows.
    """
    if not _has_late_rows(log, pages):
        return log, []
    numbers, frames = log.number.values, len(pages)
    late = f"frames {numbers[frames]} to {numbers[-1]} have no files and are left out"
    return EncoderLog(log.isel(frame=slice(frames))), [warn(name, late)]


def _has_late_rows(log: EncoderLog, pages: Sequence[Page]) -> bool:
    """Whether the first rows have the numbers of the files, and more follow."""
    numbers, frames = log.number.values.tolist(), len(pages)
    same = len(numbers) > frames and numbers[:frames] == frame_numbers(pages)
    return same and has_numbers(pages)


def check_rows(log: EncoderLog, pages: Sequence[Page], name: str) -> None:
    """Refuse a log that does not have one row per frame.

    Parameters
    ----------
    log : EncoderLog
    pages : sequence of Page
        Frames of camera 1.
    name : str
        File name of the log in the message.

    Raises
    ------
    EncoderError
        Names the first row without a frame, or the first frame without a row.
    """
    rows, frames = log.sizes["frame"], len(pages)
    if rows == frames:
        _check_numbers(log.number.values.tolist(), pages, name)
        return

    if rows > frames:
        extra = _first_without_file(log.number.values.tolist(), frame_numbers(pages), name)
    else:
        extra = f"{pages[rows].name} is the first without a row"

    if is_one_file(pages):
        cure = (
            "Take the rows without a frame out of the log and number the rows anew; or export from "
            "both recordings only the frames that have a row"
        )
    elif rows - frames == len(find_missing(frame_numbers(pages))) or _has_late_rows(log, pages):
        cure = "Use --skip-bad-frames to leave out the rows of the numbers that no file has"
    else:
        cure = (
            "To leave a frame out, put an empty file of its name into both camera folders and use "
            "--skip-bad-frames; or take out row and files and number the rows anew"
        )
    raise EncoderError(
        f"Expected one row of {name} per frame; {name} has {rows} rows, the cameras have {frames} "
        f"frames each: {extra}. {cure}."
    )


def _check_numbers(logged: list[int], pages: Sequence[Page], name: str) -> None:
    """Refuse files in another order than the rows, by the numbers of both."""
    # a camera may count from another first number, but not from one that has lost its sign
    numbers = number_files([page.path for page in pages])
    single = len(set(numbers)) == len(pages)
    signed = single and logged[0] < 0 and any(has_hyphen(page.path) for page in pages)
    if numbers == logged or not (signed or set(numbers) == set(logged)):
        return
    k = next(k for k, (a, b) in enumerate(zip(numbers, logged, strict=True)) if a != b)
    raise EncoderError(
        f"Expected the files of the frames in the order of {name}; its row of frame {logged[k]} "
        f"meets {pages[k].name}, whose number is read as {numbers[k]}. Rename the files so that "
        "they have one stem and the numbers of the log."
    )


def _first_without_file(logged: list[int], numbers: list[int], name: str) -> str:
    """The row of a missing frame, where the numbers in the file names show it."""
    # names may carry the numbers of the log, or count from another first frame
    shift = logged[0] - numbers[0] if not set(numbers) <= set(logged) else 0
    shifted = {number + shift for number in numbers}
    missing = [number for number in logged if number not in shifted]
    if shifted <= set(logged) and missing:
        at_end = missing == logged[-len(missing) :]
        first = f"frame {missing[0]} of {name} is the first without a file"
        return (
            f"{first}; the names of the files show no gap, so a frame that was missed earlier "
            "cannot be excluded"
            if at_end
            else first
        )
    return (
        f"frame {logged[len(numbers)]} of {name} is the first without a file, if no frame was "
        "missed earlier; the numbers in the names of the files do not show it"
    )


def _by_frame(
    table: LogTable, choice: ColumnChoice, columns: _Found, *, needs_angle: bool
) -> tuple[EncoderLog, list[str]]:
    """A log with one row for each frame."""
    by_name, remarks = columns
    if needs_angle and "angle" not in by_name:
        missing_column("angle", table)
    log, more = convert_columns(table, by_name, choice, dim="frame")
    if "frame" in by_name:
        check_frame_numbers(log["number"].values.tolist(), by_name["frame"].name, table)
    else:
        log["number"] = ("frame", np.arange(len(table.rows)))
        remarks.append(f"no column of frame numbers; row k of {len(table.rows)} is frame k")
    check_values(log, by_name, table)
    return EncoderLog(log), [*table.remarks, *remarks, *more]


def _in_time(
    table: LogTable, choice: ColumnChoice, columns: _Found, *, needs_angle: bool
) -> tuple[ContinuousLog, list[str]]:
    """A log in time."""
    by_name, remarks = columns
    for quantity in ("time", "angle") if needs_angle else ("time",):
        if quantity not in by_name:
            missing_column(quantity, table)
    if len(table.rows) < FEWEST_SAMPLES:
        raise EncoderError(
            f"Expected a log over the time of the frames in {table.file}; it has {len(table.rows)} "
            "rows. Export the whole log."
        )

    # a count of frames is no quantity to interpolate
    by_name = {quantity: column for quantity, column in by_name.items() if quantity != "frame"}
    samples, more = convert_columns(table, by_name, choice, dim="sample")
    check_values(samples, by_name, table)
    if "angle" in samples:
        angle = unwrap_angle(samples["angle"].values, table.file)
        if not np.array_equal(angle, samples["angle"].values):
            remarks.append("the encoder starts again after a turn; its angle is counted on")
        samples["angle"] = ("sample", angle, samples["angle"].attrs)

    time = samples["time"].values
    step = float(np.median(np.diff(time)))
    remarks.append(
        f"a log in time, {time.size} rows from {time[0]:.6g} to {time[-1]:.6g} s, "
        f"{1 / step:.6g} per second"
    )
    return ContinuousLog(table.file, samples), [*table.remarks, *remarks, *more]
