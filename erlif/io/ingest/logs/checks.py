"""Checks of the numbers of a log for any mechanism, and of rows with missing numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.units import count_of
from erlif.io.ingest.logs.table import LogColumn, LogTable

# Lowest temperature. [degree_Celsius]
ABSOLUTE_ZERO = -273.15

# No oil is a liquid at this temperature. [degree_Celsius]
HOTTEST = 1000.0

_SHOWN = 5  # rows that a message names

# Rows more or less than frames up to which a row was meant for each, and the same over the frames.
_FEW_ROWS, _NEARLY = 2, 0.05

_COMMA = re.compile(r"[+-]?\d+,\d+")


def is_nearly_by_frame(rows: int, frames: int) -> bool:
    """Whether a log has one row for each frame but for a few that are missing or too many.

    Examples
    --------
    >>> is_nearly_by_frame(47, 48), is_nearly_by_frame(48, 48), is_nearly_by_frame(4800, 48)
    (True, False, False)
    """
    return 0 < abs(rows - frames) <= max(_FEW_ROWS, _NEARLY * frames)


def check_values(log: xr.Dataset, columns: Mapping[str, LogColumn], table: LogTable) -> None:
    """Refuse numbers that cannot be what their column states.

    Parameters
    ----------
    log : xarray.Dataset
        Columns by their names in erlif, in its units.
    columns : mapping of str to LogColumn
        Columns of the file by quantity.
    table : LogTable
        For messages.

    Raises
    ------
    EncoderError
        If time does not rise, a temperature is impossible, a load or a pulse energy is not
        positive. The message names row and column.
    """
    if "time" in log:
        check_time(log["time"].values, columns["time"].name, table)
    if "temperature" in log:
        check_temperature(log["temperature"].values, columns["temperature"].name, table)

    # theory divides by the load
    for quantity, name in (("load", "joint_load"), ("pulse_energy", "pulse_energy")):
        if name in log and log[name].values.min() <= 0:
            n = int(np.argmin(log[name].values))
            cure = (
                "load cell, or leave the column out and give the load in [joint] of run.toml."
                if quantity == "load"
                else "meter, or leave pulse_energy out of [encoder]."
            )
            raise table.use.error(
                f"Expected a positive {quantity.replace('_', ' ')} in row {table.rows[n]}, column "
                f"{columns[quantity].name} of {table.file}; got {log[name].values[n]:g} "
                f"{log[name].units}. Correct the zero of the {cure}"
            )


def check_time(time: Array, name: str, table: LogTable) -> None:
    """Refuse times that do not rise from row to row.

    Parameters
    ----------
    time : array, (row,)
        [s]
    name : str
        Name of the column.
    table : LogTable
        For messages.

    Raises
    ------
    ErlifError
        Names the first row that departs.
    """
    still = np.flatnonzero(np.diff(time) <= 0)
    if still.size:
        n = int(still[0]) + 1
        what = "repeats" if time[n] == time[n - 1] else "comes after"
        raise table.use.error(
            f"Expected time to rise from row to row; row {table.rows[n]}, column {name} of "
            f"{table.file}: {time[n]:.9g} s {what} {time[n - 1]:.9g} s of row {table.rows[n - 1]}. "
            "Export the log with more digits and in the order of time, or take the column out."
        )


def check_temperature(temperature: Array, name: str, table: LogTable) -> None:
    """Refuse temperatures that no oil has.

    Arguments and errors as in `check_time`, in degC.
    """
    off = np.flatnonzero((temperature < ABSOLUTE_ZERO) | (temperature > HOTTEST))
    if off.size:
        unit = table.use.unit.format(quantity="temperature", choice="degF")
        raise table.use.error(
            f"Expected a temperature from {ABSOLUTE_ZERO:g} to {HOTTEST:g} degC in row "
            f"{table.rows[off[0]]}, column {name} of {table.file}; got {temperature[off[0]]:g} "
            f"degC. Correct the unit, {unit}, or the value."
        )


def check_frame_numbers(number: Sequence[int], name: str, table: LogTable) -> None:
    """Refuse frame numbers that are repeated or missing.

    Arguments and errors as in `check_time`, with a number for each row.
    """
    # a repeated number is reported as such, before the gap that it leaves behind
    seen: dict[int, int] = {}
    for n, (row, one) in enumerate(zip(table.rows, number, strict=True)):
        where = f"row {row}, column {name}"
        if one in seen:
            raise table.use.error(
                f"Expected each frame once in {table.file}; {where}, repeats frame {one} of row "
                f"{seen[one]}. Delete one of the two rows; or, if this is a log in time that "
                f'counts the frames, write pulse = "{name}" in [encoder] of run.toml.'
            )
        seen[one] = row

        expected = number[0] + n
        if one != expected:
            raise table.use.error(
                f"Expected frame {expected} in {where} of {table.file}; got {one}: a frame is "
                "missing. Put its row back, or, if its frame files are missing too, number the "
                "rows anew."
            )


def leave_out_bad_rows(
    table: LogTable, used: Sequence[LogColumn], *, skip: bool
) -> tuple[LogTable, str]:
    """Leave out the rows in which a used column has no finite number, or refuse them.

    Parameters
    ----------
    table : LogTable
    used : sequence of LogColumn
        The columns that are used.
    skip : bool
        Whether such rows are left out.

    Returns
    -------
    (LogTable, str)
        The table of the other rows, and a note on those left out; empty where there is none.

    Raises
    ------
    ErlifError
        If there are such rows and `skip` is false.
    """
    if not skip:
        refuse_bad_rows(table, used)
    bad = {column.name: np.flatnonzero(~np.isfinite(column.values)) for column in used}
    places = np.unique(np.concatenate(list(bad.values())))
    if not places.size:
        return table, ""

    kept = np.setdiff1d(np.arange(len(table.rows)), places)
    columns = tuple(
        LogColumn(
            column.name,
            column.unit,
            column.values[kept],
            {n: column.texts[p] for n, p in enumerate(kept.tolist()) if p in column.texts},
        )
        for column in table.columns
    )
    which = ", ".join(f"{name} in {rows.size}" for name, rows in bad.items() if rows.size)
    note = (
        f"{count_of(places.size, 'row')} of {len(table.rows)} without a number in a used column "
        f"{'is' if places.size == 1 else 'are'} left out ({which}); first: row "
        f"{table.rows[int(places[0])]}"
    )
    return replace(table, columns=columns, rows=[table.rows[n] for n in kept.tolist()]), note


def refuse_bad_rows(table: LogTable, used: Sequence[LogColumn]) -> None:
    """Refuse rows in which a used column has no finite number, all in one message.

    Parameters
    ----------
    table : LogTable
    used : sequence of LogColumn
        The columns that are used.

    Raises
    ------
    ErlifError
        If there are such rows. The message names rows and columns.
    """
    faults, places, got = [], set[int](), ""
    for column in used:
        bad = np.flatnonzero(~np.isfinite(column.values)).tolist()
        if not bad:
            continue
        places |= set(bad)
        got = column.texts.get(bad[0], "")
        shown = ", ".join(str(table.rows[n]) for n in bad[:_SHOWN])
        more = " and others" if len(bad) > _SHOWN else ""
        faults.append(
            f"row{'s' if len(bad) > 1 else ''} {shown}{more}, column {column.name} "
            f"({len(bad)}; got {repr(got) if got else 'an empty cell'})"
        )
    if not places:
        return

    cure = table.use.bad_rows
    if _COMMA.fullmatch(got):
        cure = (
            "A comma within quotes may be decimal or separate thousands: write decimal points, or "
            "separate the columns with semicolons."
        )
    elif len(places) == len(table.rows):
        cure = (
            "Choose another column, or export the log with numbers; times may be HH:MM:SS, with "
            "the date before them."
        )
    raise table.use.error(
        f"Expected finite numbers in {table.file}; {count_of(len(places), 'row')} of "
        f"{len(table.rows)} {'has' if len(places) == 1 else 'have'} none: {'; '.join(faults)}. "
        f"{cure}"
    )
