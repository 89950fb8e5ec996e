"""Assignment of the columns of a log to quantities, and conversion to the units of erlif.

`choose_column` to `find_unit` serve every log; what follows is that of an encoder.
"""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.variables import FILM
from erlif.io.ingest.logs.checks import refuse_bad_rows
from erlif.io.ingest.logs.counters import count_on
from erlif.io.ingest.logs.table import (
    CLOCK,
    NAMES,
    UNITS,
    LogColumn,
    LogTable,
    Scale,
    find_scale,
    name_patterns,
    split_unit,
)

# Quantity and unit of the columns that erlif itself documents.
CONTRACT: dict[str, tuple[str, str]] = {
    name: (quantity, unit) for name, (quantity, unit) in NAMES["documented"].items()
}

# Everything that a column can hold.
MEANINGS: dict[str, str] = NAMES["meanings"]

# Names by which a column is found that no key of [encoder] chooses.
_OBVIOUS = name_patterns("encoder")

# What an obvious name stands for even where no unit is known; the angle is then refused.
_WITHOUT_UNIT = ("frame", "angle")

# Names of quantities in films that are not their own.
_STORED_AS = {"frame": "number", "load": "joint_load", "torque": "torque_logged"}

# Quantities that counters hold: ticks, a clock, frames.
_COUNTED = ("angle", "time", "frame")

# Whole numbers above this are not exact in double precision.
_LARGEST_EXACT = 2**53

# Names that netCDF and zarr both accept.
_FURTHER_COLUMN = re.compile(r"[^\W_][^/\x00-\x1f\x7f]*")

# Names of the film's own variables, which no further column of the log may have.
_RESERVED = frozenset(
    ["number", "angle", "angle_rate", "pulse_energy", *FILM]
    + [dim for variable in FILM.values() for dim in variable.dims]
)


# columns of any log


def choose_column(quantity: str, name: str, table: LogTable) -> LogColumn:
    """Find the column that the user chose.

    Parameters
    ----------
    quantity : str
        What it holds.
    name : str
        Name as the header has it; its group and the unit in brackets may be left out.
    table : LogTable

    Returns
    -------
    LogColumn

    Raises
    ------
    ErlifError
        If there is none or more than one. The message has the nearest name.

    Examples
    --------
    >>> log = LogTable("log.csv", (LogColumn("Load [N]", "N", np.zeros(1)),), [2])
    >>> choose_column("load", "Load", log).name
    'Load [N]'
    """
    near = [column for column in table.columns if column.name == name]
    near = near or [one for one in table.columns if split_unit(one.name)[0] == name]
    near = near or [one for one in table.columns if one.name.rpartition("/")[2] == name]
    if len(near) == 1:
        return near[0]
    if near:
        raise table.use.error(
            f"Expected one column {name!r} in {table.file}; there are {len(near)}. Rename one, or "
            f"choose another; {table.listed}."
        )
    guess = difflib.get_close_matches(name, table.names, n=1, cutoff=0.5)
    hint = f" Did you mean {guess[0]!r}?" if guess else ""
    chosen = table.use.column.format(quantity=quantity, choice=guess[0] if guess else "NAME")
    raise table.use.error(
        f"Expected column {name!r} in {table.file}, chosen as {quantity}; {table.listed}.{hint} "
        f"Choose one of them: {chosen}."
    )


def refuse_several(quantity: str, fitting: Sequence[LogColumn], table: LogTable) -> None:
    """Refuse columns of which any may be meant.

    Parameters
    ----------
    quantity : str
        What one of them holds.
    fitting : sequence of LogColumn
    table : LogTable

    Raises
    ------
    ErlifError
        Always.
    """
    listed = " and ".join(repr(column.name) for column in fitting)
    chosen = table.use.column.format(quantity=quantity, choice=fitting[0].name)
    raise table.use.error(
        f"Expected one column of {table.file} for the {quantity}; {listed} may be meant. Choose "
        f"one: {chosen}."
    )


def missing_column(quantity: str, table: LogTable) -> None:
    """Refuse a log without a column that is needed.

    Parameters
    ----------
    quantity : str
        What the column would hold; "torque or arm_force" where one of two would do.
    table : LogTable

    Raises
    ------
    ErlifError
        Always.
    """
    comma = "" if len(table.names) > 1 else " Separate the columns with commas, semicolons or tabs."
    chosen = table.use.column.format(quantity=quantity.partition(" ")[0], choice="NAME")
    raise table.use.error(
        f"Expected a column for the {quantity} in {table.file}; {table.listed}.{comma} Choose one: "
        f"{chosen}."
    )


def find_unit(column: LogColumn, quantity: str, units: Mapping[str, str]) -> str:
    """Unit of a column: that of the settings, of the header, or behind the name.

    Parameters
    ----------
    column : LogColumn
    quantity : str
        What it holds.
    units : mapping of str to str
        Units by quantity, which come before those of the header.

    Returns
    -------
    str
        Empty where none is known.
    """
    if column.unit == CLOCK:
        return CLOCK
    return units.get(quantity) or column.unit or unit_suffix(column.name)


def require_scale(unit: str, quantity: str, kind: str, column: LogColumn, table: LogTable) -> Scale:
    """Scale of the unit of a column, or a refusal that names the units.

    Parameters
    ----------
    unit : str
        From `find_unit`.
    quantity : str
        What the column holds.
    kind : str
        The kind of its unit, a key of `UNITS`.
    column : LogColumn
    table : LogTable

    Returns
    -------
    Scale

    Raises
    ------
    ErlifError
        If the unit is not known, or none of this kind.
    """
    scale = find_scale(kind, unit)
    if scale is not None:
        return scale
    got = repr(unit) if unit else "none in its header"
    chosen = table.use.unit.format(quantity=quantity, choice=UNITS[kind][0])
    raise table.use.error(
        f"Expected the unit of column {column.name} of {table.file}, the {quantity}; got {got}. "
        f"Give its unit: {chosen}; units are {', '.join(UNITS[kind])}. Where it holds something "
        "else, choose another column."
    )


def plain_name(name: str) -> str:
    """Reduce the name of a column to lower case, without its unit, words apart.

    Returns
    -------
    str

    Examples
    --------
    >>> plain_name("Encoder_Angle [deg]"), plain_name("time_ms"), plain_name("Log/Force")
    ('encoder angle', 'time', 'force')
    """
    base = split_unit(name.rpartition("/")[2] if " / " not in name else name)[0]
    suffix = unit_suffix(base)
    if suffix:
        base = base[: -len(suffix) - 1]
    return re.sub(r"[\s_]+", " ", base).strip().lower()


def unit_suffix(name: str) -> str:
    """Find the unit behind the last underscore of a name; empty where there is none.

    Examples
    --------
    >>> unit_suffix("time_ms"), unit_suffix("load_cell")
    ('ms', '')
    """
    text = name.rpartition("_")[2] if "_" in name else ""
    known = text and any(find_scale(quantity, text) for quantity in UNITS)
    return text if known else ""


# columns of an encoder


@dataclass(frozen=True)
class ColumnChoice:
    """Columns and units of the log as [encoder] states them.

    Attributes
    ----------
    names : Mapping[str, str]
        Column by the quantity that it holds, "angle" or "time".
    units : Mapping[str, str]
        Unit by quantity, where the header has none or a wrong one.
    ticks_per_turn : float | None
        Ticks of the encoder in one turn.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    ticks_per_turn: float | None = None

    @property
    def wanted(self) -> list[str]:
        """Names by which the header of a text file is recognised."""
        return list(self.names.values()) or ["frame", "angle_deg"]


def find_columns(table: LogTable, choice: ColumnChoice) -> tuple[dict[str, LogColumn], list[str]]:
    """Find the column of each quantity.

    Chosen columns come first, then the documented names, then obvious ones.

    Parameters
    ----------
    table : LogTable
    choice : ColumnChoice

    Returns
    -------
    columns : dict of str to LogColumn
        By quantity.
    remarks : list of str
        What was taken for what, other than by the documented names.

    Raises
    ------
    EncoderError
        If a chosen column is missing, a name fits several columns, or there is no angle.
    """
    by_name = {column.name: column for column in table.columns}
    known = {
        quantity: choose_column(quantity, name, table) for quantity, name in choice.names.items()
    }

    # names of the documentation, then obvious ones; a column serves one purpose
    remarks = [f"{quantity} from column {column.name!r}" for quantity, column in known.items()]
    for name, (quantity, _) in CONTRACT.items():
        if quantity not in known and name in by_name and by_name[name] not in known.values():
            if (count := table.names.count(name)) > 1:
                raise table.use.error(
                    f"Expected each column of {table.file} once; {name} comes {count} times. "
                    "Rename one."
                )
            known[quantity] = by_name[name]
    for quantity, pattern in _OBVIOUS.items():
        if quantity in known:
            continue
        fitting = [
            column
            for column in table.columns
            if column not in known.values()
            and re.fullmatch(pattern, plain_name(column.name))
            and (
                quantity in _WITHOUT_UNIT
                or find_scale(quantity, find_unit(column, quantity, choice.units))
            )
        ]
        if len(fitting) > 1:
            refuse_several(quantity, fitting, table)
        if fitting:
            known[quantity] = fitting[0]
            remarks.append(f"{quantity} from column {fitting[0].name!r}")
    return known, remarks


def convert_column(
    column: LogColumn, quantity: str, table: LogTable, choice: ColumnChoice
) -> tuple[Array, str]:
    """Numbers of a column in the unit of erlif.

    Parameters
    ----------
    column : LogColumn
    quantity : str
        What it holds.
    table : LogTable
        For messages.
    choice : ColumnChoice

    Returns
    -------
    values : array, (row,)
    unit : str
        As films spell it: degree, s, N, degree_Celsius, rad s-1 or m s-1, mJ; "1" without one.

    Raises
    ------
    EncoderError
        If a cell holds no finite number, with row and column, or if the unit is not known.
    """
    refuse_bad_rows(table, [column])
    if quantity not in UNITS:
        return column.values, "1"

    # the settings come first, then the documented suffix, then the header; of a pulse energy the
    # mean is all that matters
    documented = CONTRACT.get(column.name, ("", ""))
    units = {documented[0]: documented[1], **choice.units}
    unit = find_unit(column, quantity, units) or ("1" if quantity == "pulse_energy" else "")
    scale = require_scale(unit, quantity, quantity, column, table)
    if scale.unit != "tick":
        return column.values * scale.factor + scale.offset, scale.unit

    if choice.ticks_per_turn is None:
        raise table.use.error(
            f"Expected the number of ticks in a turn, because column {column.name} of {table.file} "
            "counts ticks; got none. Write ticks_per_turn = 3600 in [encoder] of run.toml."
        )
    return column.values * (360.0 / choice.ticks_per_turn), "degree"


def convert_columns(
    table: LogTable, columns: Mapping[str, LogColumn], choice: ColumnChoice, *, dim: str
) -> tuple[xr.Dataset, list[str]]:
    """Convert all columns of a log; known ones get the names of erlif, others keep theirs.

    Parameters
    ----------
    table : LogTable
    columns : mapping of str to LogColumn
        From `find_columns`.
    choice : ColumnChoice
    dim : str
        Name of the dimension of the rows.

    Returns
    -------
    log : xarray.Dataset
        number, angle and the others, each with its unit.
    remarks : list of str
        Counters that start again, and columns whose names films cannot hold.

    Raises
    ------
    EncoderError
        As `convert_column`; or if a column of a log with the documented names has a name that
        cannot be used.
    """
    log, remarks = xr.Dataset(), []
    for quantity, found in columns.items():
        column = found
        if quantity in _COUNTED and (quantity != "angle" or choice.ticks_per_turn):
            turn = (choice.ticks_per_turn or 0.0) if quantity == "angle" else 0.0
            values, bits = count_on(column.values, turn)
            column = replace(column, values=values)
            if bits:
                remarks.append(f"{column.name} is a counter of {bits} bits; it is counted on")
        values, unit = convert_column(column, quantity, table, choice)
        name = _STORED_AS.get(quantity, quantity)
        if quantity == "speed":
            name = "sliding_speed" if unit == "m s-1" else "rotation_speed"
        if name == "number":
            _check_whole(values, column, table)
            log[name] = (dim, values.astype(np.int64))
        else:
            log[name] = (dim, values, {"units": unit, "long_name": MEANINGS[quantity]})

    # headers of erlif's own form are checked strictly; those of a logger are as they are
    strict = {"frame", "angle_deg"} <= set(table.names)
    counts = Counter(table.names)
    left_out = []
    for place, column in enumerate(table.columns, 1):
        if column in columns.values() or not column.name:
            continue
        fault = _name_fault(column.name, counts)
        if fault and strict and not choice.names:
            if counts[column.name] > 1:
                raise table.use.error(
                    f"Expected each column of {table.file} once; {column.name} comes "
                    f"{counts[column.name]} times. Rename one."
                )
            known = ", ".join(CONTRACT)
            raise table.use.error(
                f"Expected a column of {table.file} to be one of {known} or to have a name of its "
                f"own that begins with a letter or digit; column {place} is {column.name!r}, "
                f"{fault}. Rename it."
            )
        if fault:
            left_out.append(column.name)
        else:
            log[column.name] = (dim, column.free(), {"long_name": f"{column.name} of the log"})
    if left_out:
        listed = ", ".join(repr(name) for name in dict.fromkeys(left_out))
        remarks.append(f"columns left out because of their names: {listed}")
    return log, remarks


def _name_fault(name: str, counts: Counter[str]) -> str:
    if counts[name] > 1:
        return "twice"
    if name in _RESERVED:
        return "which erlif uses itself"
    return "" if _FURTHER_COLUMN.fullmatch(name) else "which a film file cannot hold"


def _check_whole(values: Array, column: LogColumn, table: LogTable) -> None:
    off = np.flatnonzero((values != np.round(values)) | (np.abs(values) > _LARGEST_EXACT))
    if off.size:
        row, value = table.rows[off[0]], values[off[0]]
        raise table.use.error(
            f"Expected a whole number in row {row}, column {column.name} of {table.file}; got "
            f"{value:g}. Number the rows 0, 1, 2, ..."
        )
