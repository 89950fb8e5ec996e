"""Rows of a log without a number: refused together, or left out."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from erlif.core.units import count_of
from erlif.io.ingest.logs.table import LogColumn, LogTable

_SHOWN = 5  # rows that a message names

_COMMA = re.compile(r"[+-]?\d+,\d+")


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
    found, places, got = [], set[int](), ""
    for column in used:
        bad = np.flatnonzero(~np.isfinite(column.values)).tolist()
        if not bad:
            continue
        places |= set(bad)
        got = column.texts.get(bad[0], "")
        shown = ", ".join(str(table.rows[n]) for n in bad[:_SHOWN])
        more = " and others" if len(bad) > _SHOWN else ""
        found.append(
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
    have = "has" if len(places) == 1 else "have"
    raise table.use.error(
        f"Expected finite numbers in {table.file}; {count_of(len(places), 'row')} of "
        f"{len(table.rows)} {have} none: {'; '.join(found)}. {cure}"
    )
