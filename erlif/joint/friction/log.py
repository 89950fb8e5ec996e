"""A log of load and torque: any file of a data logger, with columns of any name."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError, EnduranceError
from erlif.io.ingest.logs.binary import is_binary_log, read_binary_table
from erlif.io.ingest.logs.columns import named_columns, plain_name, unit_suffix
from erlif.io.ingest.logs.table import LogColumn, LogTable
from erlif.io.ingest.logs.text import read_text_table
from erlif.io.ingest.logs.units import UNITS, Scale, find_scale
from erlif.joint.friction.bad_rows import leave_out_bad_rows
from erlif.joint.friction.clock_times import CLOCK, with_clocks

QUANTITIES = {
    "time": "time",
    "cells": "load",
    "torque": "torque",
    "arm_force": "load",
    "temperature": "temperature",
    "vibration": "",
}
"""What a column can hold, and the kind of its unit; a vibration may have any."""

SEVERAL = ("cells", "temperature", "vibration")
"""What several columns may hold: load cells are added, others averaged."""

_KNOWN = {
    "time": r"t|time|zeit|(elapsed|relative|test) time|time ?stamp|uhrzeit|zeitstempel"
    r"|date ?(and )?time|datum ?(und )?(uhr)?zeit|clock( time)?",
    "arm_force": r"arm|(torque|friction|support|reaction)? ?arm( (force|load|load cell|cell))?"
    r"|(torque|friction) (cell|force)|third (load )?cell",
    "torque": r"torque|friction torque|moment|drehmoment|reibmoment",
    "cells": r"(normal |radial |bearing |applied )?(load|force)|(load )?cell|last"
    r"|(normal)?kraft",
    "temperature": r"(pin|oil|lubricant|bushing|bearing|case)? ?(temperature|temp)|temperatur"
    r"|t (pin|oil|lubricant|bushing|bearing)|thermocouple",
    "vibration": r"(rms )?(vibration|acceleration|accelerometer|vib|accel|acc|schwingung)"
    r"( (level|rms))?",
}
"""Names by which a column is found that is not chosen, without their unit and number."""

_LOOSE = {"temperature": r".*temp(eratur|erature)?\b.*"}
"""Words by which one column is found where none has a known name; its unit must be known."""

_ELSEWHERE = re.compile(r"umgebung|raum|luft|ambient|room|air|junction|ref")
"""Temperatures that are not those of the bearing."""

_FEWEST = 60  # samples of a test: fewer hold no stage
_COLDEST, _HOTTEST = -273.15, 1000.0  # degC


@dataclass(frozen=True)
class LogColumns:
    """Which columns of a log hold what; what is left empty is found by its name.

    Attributes
    ----------
    time : str
        Column of the times; the unit in its brackets may be left out, as everywhere.
    torque : str
        Column of the torque.
    arm_force : str
        Column of the force on the arm that holds the torque, in place of the torque.
    cells : tuple[str, ...]
        Columns of the load cells, which are added.
    temperature : tuple[str, ...]
        Columns of the temperature, which are averaged.
    vibration : tuple[str, ...]
        Columns of the vibration, which are averaged.
    units : Mapping[str, str]
        Units by quantity, where the header has none or a wrong one.
    """

    time: str = ""
    cells: tuple[str, ...] = ()
    torque: str = ""
    arm_force: str = ""
    temperature: tuple[str, ...] = ()
    vibration: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)

    def chosen(self, quantity: str) -> tuple[str, ...]:
        """Names that are chosen for a quantity."""
        names = getattr(self, quantity)
        return names if isinstance(names, tuple) else (names,) * bool(names)


def read_torque_log(
    path: Path | str,
    columns: LogColumns | None = None,
    *,
    vector: bool = False,
    skip_bad_rows: bool = False,
    compression_negative: bool = False,
) -> xr.Dataset:
    """Read a log of load and torque.

    Parameters
    ----------
    path : path
        CSV or other text of a data logger, NI TDMS, MATLAB or HDF5, as
        `erlif.io.ingest.read_encoder_log` reads them.
    columns : LogColumns, optional
        Which columns hold what. Columns with plain names, such as time, load, cell 1, torque, arm
        force, temperature and vibration, are found without it.
    vector : bool
        The cells are components across the shaft, of either sign; default: the load is their sum.
    skip_bad_rows : bool
        Leave out rows in which a used column has no number; default: refuse them.
    compression_negative : bool
        The cells of the load read compression as negative; their sign is turned.

    Returns
    -------
    xarray.Dataset
        Over ``time`` [s]: ``cells`` (cell, time) [N], ``torque`` [N m] or ``arm_force`` [N], and,
        where they are logged, ``temperature`` [degC] and ``vibration``. The attribute ``columns``
        states what was taken for what, ``unused`` names the other columns, and ``left_out`` the
        rows that were left out. Clock times count from the first row.

    Raises
    ------
    EnduranceError
        If the file cannot be read, a column is missing or may mean several things, a value is no
        number, or the times do not rise. The message names rows and column.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "run.csv")
    >>> rows = [f"{n},{n % 7 + 36},{0.5 + n % 3}" for n in range(100)]
    >>> _ = path.write_text("\\n".join(["t [s],Load [kN],Moment [N m]", *rows]))
    >>> log = read_torque_log(path)
    >>> log.attrs["columns"]
    "time from 't [s]', cells from 'Load [kN]', torque from 'Moment [N m]'"
    >>> float(log.cells[0, 0])
    36000.0
    """
    path, columns = Path(path), columns or LogColumns()
    table = with_clocks(_read_table(path, columns))
    used = _find(table, columns)
    places = {quantity: _places(table, members) for quantity, members in used.items()}
    members = [column for one in used.values() for column in one]
    table, left_out = leave_out_bad_rows(table, members, skip=skip_bad_rows)
    found = {name: [table.columns[n] for n in one] for name, one in places.items()}

    log = xr.Dataset()
    for quantity, members in found.items():
        values = [_convert(column, quantity, table, columns) for column in members]
        unit = _unit(members[0], quantity, columns)
        if quantity == "time":
            log["time"] = ("time", values[0], {"units": "s"})
        elif quantity == "cells":
            sign = -1.0 if compression_negative else 1.0
            log["cells"] = (("cell", "time"), sign * np.array(values), {"units": "N"})
        else:
            log[quantity] = ("time", np.mean(values, axis=0), {"units": unit})
    _check(log, found, table, vector=vector)
    log.attrs["file"] = path.name
    log.attrs["columns"] = ", ".join(
        f"{quantity} from {' and '.join(repr(column.name) for column in members)}"
        for quantity, members in found.items()
    )
    taken = {n for one in places.values() for n in one}
    others = [column.name for n, column in enumerate(table.columns) if n not in taken]
    log.attrs["unused"] = ", ".join(repr(name) for name in others if name)
    log.attrs["left_out"] = left_out
    return log


def _places(table: LogTable, members: Sequence[LogColumn]) -> list[int]:
    """Places of columns in their table."""
    return [n for n, column in enumerate(table.columns) if any(column is one for one in members)]


def _read_table(path: Path, columns: LogColumns) -> LogTable:
    """The table of a file, with messages that suit it."""
    if not path.is_file():
        what = "it is no regular file" if path.exists() else "there is no such file"
        raise EnduranceError(
            f"Expected a log of load and torque in {path}; {what}. Give the name of a file."
        )
    if path.stat().st_size == 0:
        raise EnduranceError(
            f"Expected a log of load and torque in {path}; it is empty. Export the log again."
        )
    wanted = [name for quantity in QUANTITIES for name in columns.chosen(quantity)]
    try:
        return read_binary_table(path) if is_binary_log(path) else read_text_table(path, wanted)
    except EncoderError as error:
        # the reader is that of the encoder's log, and so are its examples
        reason = str(error).replace("one row per trigger", "one row for each sample")
        reason = reason.replace("Correct file in [encoder] of run.toml", "Give another file")
        raise EnduranceError(reason.replace("frame,angle_deg", "time_s,load_N")) from error


# columns


def _find(table: LogTable, columns: LogColumns) -> dict[str, list[LogColumn]]:
    """Columns by quantity: chosen ones first, then those of a known name, then of a similar one."""
    found = {
        quantity: [_choose(quantity, name, table) for name in columns.chosen(quantity)]
        for quantity in QUANTITIES
        if columns.chosen(quantity)
    }
    for quantity, pattern in _KNOWN.items():
        if quantity in found or (quantity == "torque" and "arm_force" in found):
            continue
        known = _known(quantity, pattern, table, columns, taken=_taken(found))
        if known:
            _refuse_many(quantity, known, table)
            found[quantity] = known

    taken = _taken(found)
    for quantity, pattern in _LOOSE.items():
        if quantity in found:
            continue
        similar = _similar(quantity, pattern, table, columns, taken=taken)
        if len({_base(column.name) for column in similar}) == 1:
            found[quantity] = similar

    for quantity in ("time", "cells"):
        if quantity not in found:
            _refuse_missing(quantity, table)
    if "torque" not in found and "arm_force" not in found:
        _refuse_missing("torque or arm_force", table)
    return {quantity: found[quantity] for quantity in QUANTITIES if quantity in found}


def _taken(found: dict[str, list[LogColumn]]) -> list[LogColumn]:
    """The columns that belong to a quantity already."""
    return [column for columns in found.values() for column in columns]


def _known(
    quantity: str, pattern: str, table: LogTable, columns: LogColumns, *, taken: list[LogColumn]
) -> list[LogColumn]:
    """Columns of a known name whose unit is of the right kind."""
    fitting = [
        column
        for column in table.columns
        if column not in taken
        and re.fullmatch(pattern, _base(column.name))
        and _fits(column, quantity, columns)
    ]
    if quantity == "time" and len(fitting) > 1:
        # seconds beside the time of day
        return [column for column in fitting if column.unit != CLOCK] or fitting
    return fitting


def _similar(
    quantity: str, pattern: str, table: LogTable, columns: LogColumns, *, taken: list[LogColumn]
) -> list[LogColumn]:
    """Columns whose name resembles a known one, with a unit of the right kind."""
    return [
        column
        for column in table.columns
        if column not in taken
        and re.fullmatch(pattern, _base(column.name))
        and not _ELSEWHERE.search(_base(column.name))
        and _scale(column, quantity, columns) is not None
    ]


def _base(name: str) -> str:
    """A plain name without the number or letter behind it."""
    return re.sub(r"[ #.]*(\d+|\b[ab])$", "", plain_name(name)).strip()


def _fits(column: LogColumn, quantity: str, columns: LogColumns) -> bool:
    """Whether the unit of a column, where one is known, is of the right kind."""
    kind = QUANTITIES[quantity]
    if column.unit == CLOCK:
        return quantity == "time"
    unit = column.unit or unit_suffix(column.name)
    given = quantity in columns.units
    return given or not kind or not unit or find_scale(kind, unit) is not None


def _choose(quantity: str, name: str, table: LogTable) -> LogColumn:
    """The column of a chosen name; the unit in its brackets may be left out."""
    near, columns = named_columns(name, table)
    if len(near) == 1:
        return near[0]
    if near:
        raise EnduranceError(
            f"Expected one column {name!r} in {table.file}; there are {len(near)}. Rename one."
        )
    raise EnduranceError(
        f"Expected column {name!r} in {table.file}, chosen as {quantity}; its {columns} Choose one "
        "of them."
    )


def _refuse_many(quantity: str, fitting: Sequence[LogColumn], table: LogTable) -> None:
    """Refuse columns that may mean several things: only numbered ones belong together."""
    alike = len({_base(column.name) for column in fitting}) == 1 and quantity in SEVERAL
    if len(fitting) == 1 or alike:
        return
    listed = " and ".join(repr(column.name) for column in fitting)
    raise EnduranceError(
        f"Expected to know which column of {table.file} is the {quantity}; {listed} may be meant. "
        f"Choose with --column {quantity}={fitting[0].name!r}, or under [columns] of the settings."
    )


def _refuse_missing(quantity: str, table: LogTable) -> None:
    known = ", ".join(repr(one) for one in table.names[:20] if one)
    one = quantity.partition(" ")[0]
    raise EnduranceError(
        f"Expected a column for the {quantity} in {table.file}; its columns are {known}. Choose "
        f'one with --column {one}="NAME", or under [columns] of the settings.'
    )


# numbers


def _unit(column: LogColumn, quantity: str, columns: LogColumns) -> str:
    scale = _scale(column, quantity, columns)
    return scale.unit if scale else column.unit or "1"


def _scale(column: LogColumn, quantity: str, columns: LogColumns) -> Scale | None:
    if column.unit == CLOCK:
        return Scale("s") if quantity == "time" else None
    unit = _stated_unit(column, quantity, columns)
    return find_scale(QUANTITIES[quantity], unit) if QUANTITIES[quantity] and unit else None


def _stated_unit(column: LogColumn, quantity: str, columns: LogColumns) -> str:
    """Unit that is given, of the header, or behind the name."""
    return columns.units.get(quantity) or column.unit or unit_suffix(column.name)


def _convert(column: LogColumn, quantity: str, table: LogTable, columns: LogColumns) -> Array:
    """Numbers of a column in s, N, N m or degC."""
    kind = QUANTITIES[quantity]
    if not kind:
        return column.values
    scale = _scale(column, quantity, columns)
    if scale is not None:
        return column.values * scale.factor + scale.offset

    unit = _stated_unit(column, quantity, columns)
    got = repr(unit) if unit else "none in its header"
    raise EnduranceError(
        f"Expected the unit of column {column.name} of {table.file}, the {quantity}; got {got}. "
        f"Give it with --unit {quantity}={next(iter(UNITS[kind]))!r} or under [units] of the "
        f"settings; units are {', '.join(UNITS[kind])}."
    )


def _check(
    log: xr.Dataset,
    found: Mapping[str, Sequence[LogColumn]],
    table: LogTable,
    *,
    vector: bool,
) -> None:
    """Refuse numbers that cannot be those of a test."""
    time = log["time"].values
    if time.size < _FEWEST:
        raise EnduranceError(
            f"Expected at least {_FEWEST} rows in {table.file}; it has {time.size}. Export the "
            "whole log."
        )
    still = np.flatnonzero(np.diff(time) <= 0)
    if still.size:
        n = int(still[0]) + 1
        what = "repeats" if time[n] == time[n - 1] else "comes after"
        raise EnduranceError(
            f"Expected time to rise from row to row; row {table.rows[n]}, column "
            f"{found['time'][0].name} of {table.file}: {time[n]:.9g} s {what} {time[n - 1]:.9g} s "
            "of the row before. Export the log in the order of time and with more digits."
        )
    cells = log["cells"].values
    load = np.sqrt((cells**2).sum(axis=0)) if vector else cells.sum(axis=0)
    if not np.percentile(load, 95) > 0:
        raise EnduranceError(
            f"Expected a positive load in {table.file}; the {'vector ' if vector else ''}sum of "
            f"its cells is at most "
            f"{load.max():g} N. Where the cells read compression as negative, give "
            "--compression-negative; else correct their sign, or choose other columns."
        )
    if "temperature" in log:
        temperature = log["temperature"].values
        off = np.flatnonzero((temperature < _COLDEST) | (temperature > _HOTTEST))
        if off.size:
            n = int(off[0])
            raise EnduranceError(
                f"Expected a temperature from {_COLDEST:g} to {_HOTTEST:g} degC in row "
                f"{table.rows[n]}, column {found['temperature'][0].name} of {table.file}; got "
                f"{temperature[n]:g} degC. Correct its unit or the value."
            )
