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
from erlif.ingest.pairing import _numbers

_KNOWN_COLUMNS = {
    "angle_deg": ("angle", "degree", "encoder angle"),
    "time_s": ("time", "s", "time of the trigger"),
    "load_N": ("load", "N", "load on the joint"),
    "temperature_C": ("temperature", "degree_Celsius", "temperature of the oil"),
}


_FURTHER_COLUMN = re.compile(r"[^\W_][^/\x00-\x1f\x7f]*")  # what every file format takes as a name


# fmt: off
_RESERVED = frozenset({
    "number", "angle", "time", "load", "temperature", "trigger", "x", "y", "thickness", "thickness_std",
    "thickness_std_shared", "flags", "frames_used", "encoder_angle", "stroke", "crank_angle", "rocker_speed",
    "sliding_speed", "film_mean", "film_mean_std", "film_min", "film_min_std", "film_hamrock_dowson",
    "film_theory", "film_parameter", "speed_exponent", "speed_exponent_std", "speed_exponent_mean",
    "speed_exponent_mean_std",
})
# fmt: on
"""Names of the film's own variables, which no further column of the log may have."""


def read_encoder_log(path: Path) -> EncoderLog:
    """Read an encoder log, ``frame,time_s,angle_deg,load_N,temperature_C`` and further columns.

    Returns
    -------
    EncoderLog
        number (frame), angle (frame) [degree], and what else was logged.

    Raises
    ------
    EncoderError
        If the file is missing, a required column is, or a value is no finite number; frames repeated or missing.
        Each message names row and column, the header being row 1.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            table = [
                (n, row)
                for n, row in enumerate(csv.reader(file), 1)
                if any(cell.strip() for cell in row)
            ]
    except OSError as error:
        raise EncoderError(
            f"Expected the encoder log {path.name}; it cannot be read: {error.strerror}. Correct file in [encoder] of run.toml."
        ) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise EncoderError(
            f"Expected {path.name} to be a CSV text file; it is not: {error}. Save the log as CSV in UTF-8."
        ) from error
    if len(table) < 2:
        raise EncoderError(
            f"Expected a header and one row per trigger in {path.name}; it has {len(table)} row(s). Export the whole log."
        )
    header = [cell.strip() for cell in table[0][1]]
    rows = [number for number, _ in table[1:]]
    _check_header(header, path)
    for number, row in table[1:]:
        if len(row) != len(header):
            comma = (
                " A decimal comma makes two values of one: write decimal points."
                if len(row) > len(header)
                else ""
            )
            raise EncoderError(
                f"Expected {len(header)} values in row {number} of {path.name}, as in its header; it has {len(row)}.{comma} Correct the row."
            )
    columns = dict(zip(header, zip(*(row for _, row in table[1:]), strict=True), strict=True))
    numbers = _number_column(columns.pop("frame"), rows, "frame", path)
    _check_frame_numbers(numbers, rows, path)
    log = xr.Dataset({"number": ("frame", numbers.astype(np.int64))})
    for name, cells in columns.items():
        if name in _KNOWN_COLUMNS:
            short, unit, meaning = _KNOWN_COLUMNS[name]
            log[short] = (
                "frame",
                _number_column(cells, rows, name, path),
                {"units": unit, "long_name": meaning},
            )
        elif name:
            log[name] = ("frame", _free_column(cells))
    if "load" in log and log["load"].values.min() <= 0:
        n = int(np.argmin(log["load"].values))
        raise EncoderError(
            f"Expected a positive load in row {rows[n]}, column load_N of {path.name}; got {log['load'].values[n]:g} N. Correct the zero of the "
            "load cell, or leave the column out and give the load in [joint] of run.toml."
        )
    return EncoderLog(log)


def _check_header(header: list[str], path: Path) -> None:
    for required in ("frame", "angle_deg"):
        if required not in header:
            comma = "" if len(header) > 1 else " Separate the columns with commas."
            raise EncoderError(
                f"Expected a column {required} in {path.name}; its header is {','.join(header)}.{comma} Columns erlif knows: frame, "
                f"{', '.join(_KNOWN_COLUMNS)}."
            )
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
                f"Expected a column of {path.name} to be one of frame, {', '.join(_KNOWN_COLUMNS)} or to have a name of its own that begins "
                f"with a letter or digit; column {place} is {name!r}, {reason}. Rename it."
            )


def _number_column(cells: Sequence[str], rows: Sequence[int], name: str, path: Path) -> Array:
    values = np.empty(len(cells))
    for n, (row, cell) in enumerate(zip(rows, cells, strict=True)):
        try:
            values[n] = float(cell) if "_" not in cell else math.nan
        except ValueError:
            values[n] = math.nan
        if not math.isfinite(values[n]):
            raise EncoderError(
                f"Expected a finite number in row {row}, column {name} of {path.name}; got {cell.strip() or 'nothing'!r}. Correct the value, "
                "or take the row and its frame of both cameras out and number the rows anew."
            )
    return values


def _check_frame_numbers(numbers: Array, rows: Sequence[int], path: Path) -> None:
    seen: dict[float, int] = {}
    for n, (row, number) in enumerate(zip(rows, numbers, strict=True)):
        if number != round(number) or abs(number) > 2**53:
            raise EncoderError(
                f"Expected a whole number in row {row}, column frame of {path.name}; got {number:g}. Number the rows 0, 1, 2, ..."
            )
        if number in seen:
            raise EncoderError(
                f"Expected each frame once in {path.name}; row {row}, column frame, repeats frame {number:g} of row {seen[number]}. Delete "
                "one of the two rows."
            )
        seen[number] = row
        expected = numbers[0] + n
        if number != expected:
            raise EncoderError(
                f"Expected frame {expected:g} in row {row}, column frame of {path.name}; got {number:g}: a frame is missing. Put its row back, "
                "or, if its frame files are missing too, number the rows anew."
            )


def _free_column(cells: Sequence[str]) -> AnyArray:
    """Numbers where all cells that are not empty are numbers, text otherwise."""
    try:
        return np.array([float(cell) if cell.strip() else math.nan for cell in cells])
    except ValueError:
        return np.array([cell.strip() for cell in cells], dtype=object).astype(str)


def _check_rows(log: EncoderLog, pages: Sequence[Page], name: str) -> None:
    """Refuse a log that has not one row per frame, naming the first row or frame without its like."""
    rows, frames = log.sizes["frame"], len(pages)
    if rows == frames:
        return
    if rows > frames:
        # where the files carry the numbers of the log, the gap in them is the missing one
        numbers = _numbers(pages)
        logged = log.number.values.tolist()
        lacking = (
            [number for number in logged if number not in numbers]
            if set(numbers) <= set(logged)
            else []
        )
        row = logged.index(lacking[0]) if lacking else frames
        extra = f"frame {logged[row]} of {name} is the first without a file"
    else:
        extra = f"{pages[rows].name} is the first without a row"
    raise EncoderError(
        f"Expected one row of {name} per frame; {name} has {rows} rows, the cameras have {frames} frames each: {extra}. To leave a frame "
        "out, put an empty file of its name into both camera folders and use --skip-bad-frames; or take out row and files and number the "
        "rows anew."
    )
