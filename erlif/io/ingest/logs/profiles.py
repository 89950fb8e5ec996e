"""Columns of measured profiles, of a fixture or of a bore, in any form that a log may have."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from erlif.core.arrays import Array
from erlif.io.ingest.logs.checks import refuse_bad_rows
from erlif.io.ingest.logs.columns import (
    find_unit,
    missing_column,
    plain_name,
    refuse_several,
    require_scale,
)
from erlif.io.ingest.logs.table import LogColumn, LogTable, name_patterns

# Kinds of the units of columns by the unit of the result, which ends their names.
_KINDS = {"mm": "position", "um": "film"}


def find_columns(table: LogTable, profile: str) -> dict[str, list[LogColumn]]:
    """Columns that may be meant by each name of a profile.

    Parameters
    ----------
    table : LogTable
    profile : str
        Table of names.toml, "profile" or "bore".

    Returns
    -------
    dict of str to list of LogColumn
    """
    return {
        name: [column for column in table.columns if re.fullmatch(names, plain_name(column.name))]
        for name, names in name_patterns(profile).items()
    }


def read_columns(
    table: LogTable, found: Mapping[str, Sequence[LogColumn]], needed: Collection[str]
) -> tuple[dict[str, Array], list[str]]:
    """Numbers of the columns of a profile.

    Parameters
    ----------
    table : LogTable
    found : mapping of str to sequence of LogColumn
        Columns by their names, which end in the unit of the result, "_mm" or "_um".
    needed : collection of str
        Names without which there is no profile.

    Returns
    -------
    columns : dict of str to array, (row,)
    remarks : list of str
        How the table was read, and which columns were taken for what.

    Raises
    ------
    ErlifError
        If a column is missing, not the only one, without unit, or holds cells that are no numbers.
    """
    for name, fitting in found.items():
        if len(fitting) > 1:
            refuse_several(name, fitting, table)
        if not fitting and name in needed:
            missing_column(name, table)
    used = {name: fitting[0] for name, fitting in found.items() if fitting}
    refuse_bad_rows(table, list(used.values()))

    columns = {}
    for name, column in used.items():
        quantity, _, unit = name.partition("_")
        own = find_unit(column, quantity, {})
        scale = require_scale(own, quantity, _KINDS[unit], column, table)
        columns[name] = column.values * scale.factor
    remarks = list(table.remarks)
    remarks += [f"{name} from {one.name!r}" for name, one in used.items() if name != one.name]
    return columns, remarks
