"""The log among the files of a directory, and what its columns probably hold."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.columns import (
    CONTRACT,
    ColumnChoice,
    convert_column,
    find_columns,
    find_unit,
    plain_name,
)
from erlif.io.ingest.logs.table import LogColumn, LogTable, find_scale
from erlif.io.ingest.logs.text import read_log_table

# Endings of the files that loggers write.
LOG_SUFFIXES = frozenset(
    {".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".tdms", ".mat", ".h5", ".hdf5", ".hdf"}
)

# Columns of the profile of a fixture, which is no log.
PROFILE = {"x_mm", "thickness_um"}

# Quantities that a unit alone shows where one column has it, and the units they become.
_BY_UNIT = {"angle": "degree", "time": "s", "load": "N", "temperature": "degree_Celsius"}

# Names of a column that numbers the rows, where its values show it.
_COUNTER = re.compile(r"(sample|index|row|no|nr)( (no|nr|number|index))?")

_TRIGGER = re.compile(r"trigger|pulse|ttl|camera|strobe|q-?switch", re.IGNORECASE)


@dataclass(frozen=True)
class LogProposal:
    """A log that was found, and what its columns probably hold.

    Attributes
    ----------
    path : Path
    table : LogTable
    columns : dict[str, str]
        Column by quantity, those with documented names left out.
    without_unit : tuple[str, ...]
        Quantities whose unit the header does not give.
    in_time : bool
        Whether the log has no row for each frame, but times.
    pulse : str | None
        Column that rises at the frames of a log in time.
    values : xr.Dataset
        time and angle, as far as their units are known, on dim row.
    known : tuple[str, ...]
        Quantities whose column is recognised.
    by_unit : tuple[str, ...]
        Those of them that no name shows, but the unit of one column.
    """

    path: Path
    table: LogTable
    columns: dict[str, str]
    without_unit: tuple[str, ...]
    in_time: bool
    pulse: str | None
    values: xr.Dataset
    known: tuple[str, ...]
    by_unit: tuple[str, ...] = ()


def propose_log(paths: Iterable[Path], frames: int, *, unnamed: bool = False) -> LogProposal | None:
    """Find the log of an encoder among files, by the names and units of its columns.

    Parameters
    ----------
    paths : iterable of Path
    frames : int
        Number of frame pairs.
    unnamed : bool
        Whether a table with columns of unknown names is a log too.

    Returns
    -------
    LogProposal or None
        The first file with an angle and with one row for each frame or a column of times; with
        `unnamed`, else the first table of at least one row for each frame.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "rig.txt")
    >>> _ = path.write_text("Encoder [deg];Force [N]\\n1,5;20\\n2,5;21\\n")
    >>> propose_log([path], 2).columns
    {'angle': 'Encoder [deg]', 'load': 'Force [N]'}
    """
    other: LogProposal | None = None
    for path in paths:
        try:
            table = read_log_table(path, ())
        except EncoderError:
            continue  # a picture or a report
        try:
            named, _ = find_columns(table, ColumnChoice())
            columns = named | dict(_find_by_unit(table, named))
        except EncoderError:  # columns that may mean two things
            named = columns = {}
        by_frame = "frame" in columns or len(table.rows) == frames
        if "angle" in columns and (by_frame or "time" in columns):
            if "frame" not in columns and len(table.rows) == frames:
                columns |= _find_counter(table, columns)
            return _describe(path, table, columns, named, by_frame=by_frame)

        # a log in another language; the profile of a fixture is known by its columns
        long = len(table.rows) >= frames and not PROFILE & set(table.names)
        if unnamed and other is None and long:
            other = _describe(path, table, columns, named, by_frame=by_frame)
    return other


def _find_by_unit(table: LogTable, named: dict[str, LogColumn]) -> Iterator[tuple[str, LogColumn]]:
    """Yield quantities recognised by their unit, where a single column has this unit."""
    for quantity, result in _BY_UNIT.items():
        scales = (
            (column, find_scale(quantity, find_unit(column, quantity, {})))
            for column in table.columns
            if column not in named.values()
        )
        fitting = [column for column, scale in scales if scale and scale.unit == result]
        if quantity not in named and len(fitting) == 1 and not fitting[0].texts:
            yield quantity, fitting[0]


def _find_counter(table: LogTable, columns: dict[str, LogColumn]) -> dict[str, LogColumn]:
    """The column that counts the rows from 0 or 1, as the number of the frame."""
    rows = np.arange(len(table.rows))
    fitting = [
        column
        for column in table.columns
        if column not in columns.values()
        and not column.texts
        and _COUNTER.fullmatch(plain_name(column.name))
        and any(np.array_equal(column.values, rows + first) for first in (0, 1))
    ]
    return {"frame": fitting[0]} if len(fitting) == 1 else {}


def _describe(
    path: Path,
    table: LogTable,
    columns: dict[str, LogColumn],
    named: dict[str, LogColumn],
    *,
    by_frame: bool,
) -> LogProposal:
    """Make the proposal of a log from its recognised columns."""
    values, without_unit = xr.Dataset(), []
    for quantity, column in columns.items():
        try:
            numbers, _ = convert_column(column, quantity, table, ColumnChoice())
        except EncoderError:
            without_unit.append(quantity)
            continue
        if quantity in ("angle", "time"):
            values[quantity] = ("row", numbers)

    foreign = {
        quantity: column.name for quantity, column in columns.items() if column.name not in CONTRACT
    }
    pulse = None if by_frame else _find_pulse(table)
    return LogProposal(
        path,
        table,
        foreign,
        tuple(without_unit),
        not by_frame,
        pulse,
        values,
        known=tuple(columns),
        by_unit=tuple(one for one in columns if one not in named and one in _BY_UNIT),
    )


def _find_pulse(table: LogTable) -> str | None:
    """A column called after a trigger, with a low level most of the time."""
    for column in table.columns:
        values = column.values
        if _TRIGGER.search(column.name) and not column.texts and np.ptp(values) > 0:
            return column.name
    return None
