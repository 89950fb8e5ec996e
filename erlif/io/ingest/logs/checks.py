"""What the numbers of a log must fulfil, whatever the mechanism."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.io.ingest.logs.table import LogColumn, LogTable

ABSOLUTE_ZERO = -273.15
"""Lowest temperature. [degree_Celsius]"""

HOTTEST = 1000.0
"""No oil is a liquid at this temperature. [degree_Celsius]"""


def check_values(log: xr.Dataset, found: Mapping[str, LogColumn], table: LogTable) -> None:
    """Refuse numbers that cannot be what their column states.

    Parameters
    ----------
    log : xarray.Dataset
        Columns by their names in erlif, in its units.
    found : mapping of str to LogColumn
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
        check_time(log["time"].values, found["time"].name, table)
    if "temperature" in log:
        check_temperature(log["temperature"].values, found["temperature"].name, table)

    # theory divides by the load
    for quantity, cure in (
        (
            "load",
            "Correct the zero of the load cell, or leave the column out and give the load in "
            "[joint] of run.toml.",
        ),
        ("pulse_energy", "Correct the zero of the meter, or leave pulse_energy out of [encoder]."),
    ):
        if quantity in log and log[quantity].values.min() <= 0:
            n = int(np.argmin(log[quantity].values))
            raise EncoderError(
                f"Expected a positive {quantity.replace('_', ' ')} in row {table.rows[n]}, column "
                f"{found[quantity].name} of {table.file}; got {log[quantity].values[n]:g} "
                f"{log[quantity].units}. {cure}"
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

    Parameters
    ----------
    number : sequence of int
        One for each row.
    name : str
        Name of the column.
    table : LogTable
        For messages.

    Raises
    ------
    EncoderError
        Names the first row that departs.
    """
    # a repeated number is reported as such, before the gap that it leaves behind
    seen: dict[int, int] = {}
    for n, (row, one) in enumerate(zip(table.rows, number, strict=True)):
        where = f"row {row}, column {name}"
        if one in seen:
            raise EncoderError(
                f"Expected each frame once in {table.file}; {where}, repeats frame {one} of "
                f"row {seen[one]}. Delete one of the two rows; or, if this is a log in time that "
                f'counts the frames, write pulse = "{name}" in [encoder] of run.toml.'
            )
        seen[one] = row

        expected = number[0] + n
        if one != expected:
            raise EncoderError(
                f"Expected frame {expected} in {where} of {table.file}; got {one}: a frame "
                "is missing. Put its row back, or, if its frame files are missing too, number the "
                "rows anew."
            )
