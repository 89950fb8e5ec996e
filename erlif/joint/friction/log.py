"""A log of load and torque: any file of a data logger, with columns of any name."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EnduranceError
from erlif.io.ingest.logs.checks import check_temperature, check_time, leave_out_bad_rows
from erlif.io.ingest.logs.clock_times import with_clocks
from erlif.io.ingest.logs.columns import (
    choose_column,
    find_unit,
    missing_column,
    plain_name,
    refuse_several,
    require_scale,
)
from erlif.io.ingest.logs.table import CLOCK, LogColumn, LogTable, LogUse, find_scale, name_patterns
from erlif.io.ingest.logs.text import read_log_table

# What a column can hold, and the kind of its unit; a vibration may have any.
QUANTITIES = {
    "time": "time",
    "cells": "load",
    "torque": "torque",
    "arm_force": "load",
    "temperature": "temperature",
    "vibration": "",
}

# What several columns may hold: load cells are added, others averaged.
SEVERAL = ("cells", "temperature", "vibration")

# Names by which a column is found that is not chosen, without their unit and number.
_KNOWN = name_patterns("torque")

# Words by which a temperature of the bearing is found where none has a known name; its unit must be
# known.
_ANY_TEMPERATURE = (
    r"(?!.*(umgebung|raum|luft|ambient|room|air|junction|ref)).*temp(eratur|erature)?\b.*"
)

_FEWEST = 60  # samples of a test: fewer hold no stage

# A log of load and torque.
TORQUE_LOG = LogUse(
    EnduranceError,
    column="--column {quantity}={choice!r}",
    unit="--unit {quantity}={choice!r}",
    bad_rows="Correct them, or leave these rows out with --skip-bad-rows.",
    name="the path of the log",
)


@dataclass(frozen=True)
class LogColumns:
    """Columns of a log by quantity; empty ones are found by their names.

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
    load: float | None = None,
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
    load : float, optional
        Constant load; columns of cells are then not read. [N]
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
    wanted = [name for quantity in QUANTITIES for name in columns.chosen(quantity)]
    table = with_clocks(read_log_table(path, wanted, TORQUE_LOG))
    found = _find(table, columns, with_load=load is None)
    used = [column for members in found.values() for column in members]
    others = [column.name for column in table.columns if column not in used]
    kept, left_out = leave_out_bad_rows(table, used, skip=skip_bad_rows)
    now = dict(zip(table.columns, kept.columns, strict=True))
    by_name = {quantity: [now[column] for column in found[quantity]] for quantity in found}

    log = xr.Dataset()
    for quantity, members in by_name.items():
        values, unit = _convert(members, quantity, kept, columns)
        if quantity == "time":
            log["time"] = ("time", values[0], {"units": "s"})
        elif quantity == "cells":
            sign = -1.0 if compression_negative else 1.0
            log["cells"] = (("cell", "time"), sign * np.array(values), {"units": "N"})
        else:
            log[quantity] = ("time", np.mean(values, axis=0), {"units": unit})
    if load is not None:
        log["cells"] = (("cell", "time"), np.full((1, log.sizes["time"]), load), {"units": "N"})
    _check(log, by_name, kept, vector=vector)
    log.attrs["file"] = path.name
    names = ", ".join(
        f"{quantity} from {' and '.join(repr(column.name) for column in members)}"
        for quantity, members in by_name.items()
    )
    given = [] if load is None else [f"load {load:g} N as given"]
    log.attrs["columns"] = "; ".join([names, *given, *table.remarks])
    log.attrs["unused"] = ", ".join(repr(name) for name in others if name)
    log.attrs["left_out"] = left_out
    return log


# columns


def _find(table: LogTable, columns: LogColumns, *, with_load: bool) -> dict[str, list[LogColumn]]:
    """Columns by quantity: chosen ones first, then those of a known name, then of a similar one."""
    of = {
        quantity: [choose_column(quantity, name, table) for name in columns.chosen(quantity)]
        for quantity in QUANTITIES
    }

    def free(quantity: str, pattern: str) -> list[LogColumn]:
        """Columns of such a name, and of a unit of its kind, that belong to no quantity yet."""
        return [
            column
            for column in table.columns
            if not any(column in members for members in of.values())
            and re.fullmatch(pattern, _base(column.name))
            and _fits(column, quantity, columns)
        ]

    for quantity, pattern in _KNOWN.items():
        # a force on the arm takes the place of a torque
        if of[quantity] or (quantity == "torque" and of["arm_force"]):
            continue
        found = free(quantity, pattern)
        if quantity == "time" and len(found) > 1:
            # seconds beside the time of day
            found = [column for column in found if column.unit != CLOCK] or found
        if len(found) > 1 and not (_are_alike(found) and quantity in SEVERAL):
            refuse_several(quantity, found, table)
        of[quantity] = found
    if not of["temperature"]:
        # of one place of the bearing, whichever it is
        similar = [
            column
            for column in free("temperature", _ANY_TEMPERATURE)
            if find_unit(column, "temperature", columns.units)
        ]
        of["temperature"] = similar if _are_alike(similar) else []

    if not with_load:
        del of["cells"]
    of = {quantity: members for quantity, members in of.items() if members}
    for quantity in ("time", "cells") if with_load else ("time",):
        if quantity not in of:
            missing_column(quantity, table)
    if "torque" not in of and "arm_force" not in of:
        missing_column("torque or arm_force", table)
    return of


def _base(name: str) -> str:
    """A plain name without the number or letter behind it."""
    return re.sub(r"[ #.]*(\d+|\b[ab])$", "", plain_name(name)).strip()


def _are_alike(found: Sequence[LogColumn]) -> bool:
    """Whether columns have one name but for their numbers, so that they belong together."""
    return len({_base(column.name) for column in found}) == 1


def _fits(column: LogColumn, quantity: str, columns: LogColumns) -> bool:
    """Whether the unit of a column, where one is known, is of the right kind."""
    kind, unit = QUANTITIES[quantity], find_unit(column, quantity, {})
    if unit == CLOCK:
        return quantity == "time"
    given = quantity in columns.units
    return given or not kind or not unit or find_scale(kind, unit) is not None


# numbers


def _convert(
    members: Sequence[LogColumn], quantity: str, table: LogTable, columns: LogColumns
) -> tuple[list[Array], str]:
    """Numbers of the columns in s, N, N m or degC, and this unit."""
    kind = QUANTITIES[quantity]
    if not kind:
        return [column.values for column in members], members[0].unit or "1"
    scales = [
        require_scale(find_unit(column, quantity, columns.units), quantity, kind, column, table)
        for column in members
    ]
    values = [
        column.values * scale.factor + scale.offset
        for column, scale in zip(members, scales, strict=True)
    ]
    return values, scales[0].unit


def _check(
    log: xr.Dataset,
    columns: Mapping[str, Sequence[LogColumn]],
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
    check_time(time, columns["time"][0].name, table)
    cells = log["cells"].values
    load = np.sqrt((cells**2).sum(axis=0)) if vector else cells.sum(axis=0)
    if not np.percentile(load, 95) > 0:
        total = "vector sum" if vector else "sum"
        raise EnduranceError(
            f"Expected a positive load in {table.file}; the {total} of its cells is at most "
            f"{load.max():g} N. Where the cells read compression as negative, give "
            "--compression-negative; else correct their sign, or choose other columns."
        )
    if "temperature" in log:
        check_temperature(log["temperature"].values, columns["temperature"][0].name, table)
