"""The encoder log, checked row by row."""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import EncoderError
from erlif.core.products import EncoderLog
from erlif.ingest.images import Page
from erlif.ingest.pairing import frame_numbers

_KNOWN_COLUMNS = {
    "angle_deg": ("angle", "degree", "encoder angle"),
    "time_s": ("time", "s", "time of the trigger"),
    "load_N": ("load", "N", "load on the joint"),
    "temperature_C": ("temperature", "degree_Celsius", "temperature of the oil"),
}


_FURTHER_COLUMN = re.compile(r"[^\W_][^/\x00-\x1f\x7f]*")
"""Names that netCDF and zarr both accept."""


_RESERVED = frozenset(
    [
        "number",
        "angle",
        "time",
        "load",
        "temperature",
        "trigger",
        "x",
        "y",
        "thickness",
        "thickness_std",
        "thickness_std_shared",
        "flags",
        "frames_used",
        "valid_pixels",
        "flagged_pixels",
        "flag",
        "encoder_angle",
        "stroke",
        "crank_angle",
        "rocker_speed",
        "sliding_speed",
        "film_mean",
        "film_mean_std",
        "film_min",
        "film_min_std",
        "film_hamrock_dowson",
        "film_theory",
        "film_parameter",
        "speed_exponent",
        "speed_exponent_std",
        "speed_exponent_mean",
        "speed_exponent_mean_std",
    ]
)
"""Names of the film's own variables, which no further column of the log may have."""


_FEWEST_ROWS = 2
"""A header and one row."""

_LARGEST_EXACT = 2**53
"""Whole numbers above this are not exact in double precision."""


def read_encoder_log(path: Path) -> EncoderLog:
    """Read an encoder log: ``frame,time_s,angle_deg,load_N,temperature_C`` and further columns.

    Parameters
    ----------
    path : Path
        CSV file in UTF-8; ``frame`` and ``angle_deg`` are required.

    Returns
    -------
    EncoderLog
        number (frame), angle (frame) [degree], and the other logged columns.

    Raises
    ------
    EncoderError
        If the file or a required column is missing, a value is not a finite number, or frames are
        repeated or missing. Each message names row and column; the header is row 1.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "encoder.csv"
    >>> _ = path.write_text("frame,angle_deg,load_N\\n0,10.5,222\\n1,11.5,221\\n")
    >>> log = read_encoder_log(path)
    >>> log.angle.values, log.angle.units
    (array([10.5, 11.5]), 'degree')
    """
    table = _read_table(path)
    header = [cell.strip() for cell in table[0][1]]
    rows = [number for number, _ in table[1:]]
    _check_header(header, path)
    _check_row_lengths(table, header, path)

    columns = dict(zip(header, zip(*(row for _, row in table[1:]), strict=True), strict=True))
    numbers = _number_column(columns.pop("frame"), rows, "frame", path)
    _check_frame_numbers(numbers, rows, path)

    # known columns get their short names and units, others keep the name in the header
    log = xr.Dataset({"number": ("frame", numbers.astype(np.int64))})
    for name, cells in columns.items():
        if name in _KNOWN_COLUMNS:
            short, unit, meaning = _KNOWN_COLUMNS[name]
            values = _number_column(cells, rows, name, path)
            log[short] = ("frame", values, {"units": unit, "long_name": meaning})
        elif name:
            log[name] = ("frame", _free_column(cells))

    # theory divides by the load
    if "load" in log and log["load"].values.min() <= 0:
        n = int(np.argmin(log["load"].values))
        raise EncoderError(
            f"Expected a positive load in row {rows[n]}, column load_N of {path.name}; got "
            f"{log['load'].values[n]:g} N. Correct the zero of the load cell, or leave the column "
            "out and give the load in [joint] of run.toml."
        )
    return EncoderLog(log)


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
        return

    if rows > frames:
        # where file names carry the numbers of the log, the gap in the names is the missing frame
        numbers = frame_numbers(pages)
        logged = log.number.values.tolist()
        missing = [number for number in logged if number not in numbers]
        row = logged.index(missing[0]) if missing and set(numbers) <= set(logged) else frames
        extra = f"frame {logged[row]} of {name} is the first without a file"
    else:
        extra = f"{pages[rows].name} is the first without a row"

    raise EncoderError(
        f"Expected one row of {name} per frame; {name} has {rows} rows, the cameras have {frames} "
        f"frames each: {extra}. To leave a frame out, put an empty file of its name into both "
        "camera folders and use --skip-bad-frames; or take out row and files and number the rows "
        "anew."
    )


def _read_table(path: Path) -> list[tuple[int, list[str]]]:
    """Row numbers and cells of a CSV file; empty rows are left out."""
    # "utf-8-sig" also reads the byte order mark that spreadsheets write
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = enumerate(csv.reader(file), 1)
            table = [(n, row) for n, row in rows if any(cell.strip() for cell in row)]
    except OSError as error:
        raise EncoderError(
            f"Expected the encoder log {path.name}; it cannot be read: {error.strerror}. Correct "
            "file in [encoder] of run.toml."
        ) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise EncoderError(
            f"Expected {path.name} to be a CSV text file; it is not: {error}. Save the log as CSV "
            "in UTF-8."
        ) from error

    if len(table) < _FEWEST_ROWS:
        raise EncoderError(
            f"Expected a header and one row per trigger in {path.name}; it has {len(table)} "
            "row(s). Export the whole log."
        )
    return table


def _check_row_lengths(
    table: Sequence[tuple[int, Sequence[str]]], header: Sequence[str], path: Path
) -> None:
    for number, row in table[1:]:
        if len(row) == len(header):
            continue
        comma = (
            " A decimal comma makes two values of one: write decimal points."
            if len(row) > len(header)
            else ""
        )
        raise EncoderError(
            f"Expected {len(header)} values in row {number} of {path.name}, as in its header; it "
            f"has {len(row)}.{comma} Correct the row."
        )


def _check_header(header: list[str], path: Path) -> None:
    known = f"frame, {', '.join(_KNOWN_COLUMNS)}"
    for required in ("frame", "angle_deg"):
        if required not in header:
            comma = (
                ""
                if len(header) > 1
                else " Separate the columns with commas, and write decimal points."
            )
            raise EncoderError(
                f"Expected a column {required} in {path.name}; its header is "
                f"{','.join(header)}.{comma} Columns erlif knows: {known}."
            )

    # the rest of the header: names must be distinct, and usable in the file of the result
    for place, (name, count) in enumerate(Counter(header).items(), 1):
        if count > 1 and name:
            raise EncoderError(
                f"Expected each column of {path.name} once; {name} comes {count} times. Rename one."
            )
        if name in _RESERVED or (name and not _FURTHER_COLUMN.fullmatch(name)):
            reason = (
                "which erlif uses itself" if name in _RESERVED else "which a film file cannot hold"
            )
            raise EncoderError(
                f"Expected a column of {path.name} to be one of {known} or to have a name of its "
                f"own that begins with a letter or digit; column {place} is {name!r}, {reason}. "
                "Rename it."
            )


def _number_column(cells: Sequence[str], rows: Sequence[int], name: str, path: Path) -> Array:
    values = np.empty(len(cells))
    for n, (row, cell) in enumerate(zip(rows, cells, strict=True)):
        try:
            # float() reads "1_000", which no logger means
            values[n] = float(cell) if "_" not in cell else math.nan
        except ValueError:
            values[n] = math.nan

        if not math.isfinite(values[n]):
            raise EncoderError(
                f"Expected a finite number in row {row}, column {name} of {path.name}; got "
                f"{cell.strip() or 'nothing'!r}. Correct the value, or take the row and its frame "
                "of both cameras out and number the rows anew."
            )
    return values


def _check_frame_numbers(numbers: Array, rows: Sequence[int], path: Path) -> None:
    """Frame numbers must be whole, distinct and consecutive."""
    # a repeated number is reported as such, before the gap that it leaves behind
    seen: dict[float, int] = {}
    for n, (row, number) in enumerate(zip(rows, numbers, strict=True)):
        where = f"row {row}, column frame"
        if number != round(number) or abs(number) > _LARGEST_EXACT:
            raise EncoderError(
                f"Expected a whole number in {where} of {path.name}; got {number:g}. Number the "
                "rows 0, 1, 2, ..."
            )
        if number in seen:
            raise EncoderError(
                f"Expected each frame once in {path.name}; {where}, repeats frame {number:g} of "
                f"row {seen[number]}. Delete one of the two rows."
            )
        seen[number] = row

        expected = numbers[0] + n
        if number != expected:
            raise EncoderError(
                f"Expected frame {expected:g} in {where} of {path.name}; got {number:g}: a frame "
                "is missing. Put its row back, or, if its frame files are missing too, number the "
                "rows anew."
            )


def _free_column(cells: Sequence[str]) -> AnyArray:
    """Numbers where all cells that are not empty are numbers, text otherwise."""
    try:
        return np.array([float(cell) if cell.strip() else math.nan for cell in cells])
    except ValueError:
        return np.array([cell.strip() for cell in cells], dtype=object).astype(str)
