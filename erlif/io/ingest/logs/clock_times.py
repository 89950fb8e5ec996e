"""Times that a logger or spreadsheet writes as clock times, with or without the date."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import date
from functools import lru_cache
from itertools import pairwise

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.io.ingest.logs.summer_time import put_forward
from erlif.io.ingest.logs.table import CLOCK, LogColumn, LogTable

_DAY, _HOUR, _MINUTE = 86400.0, 3600.0, 60.0
_TRIED = 5  # cells of a column by which clock times are recognised

_FORM = re.compile(
    r"(?:(?:(?P<y>\d{4})[-/.](?P<m>\d{1,2})[-/.](?P<d>\d{1,2})"
    r"|(?P<one>\d{1,2})(?P<mark>[-/.])(?P<two>\d{1,2})(?P=mark)(?P<year>\d{4}|\d{2}))[ T,]+)?"
    r"(?P<hour>\d{1,3}):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d)(?:[.,:](?P<part>\d+))?)?"
    r" ?(?P<half>[aApP])?(?(half)\.?[mM]\.?)"
    r"\s*(?P<zone>Z|UTC|[+-]\d{2}:?\d{2})?"
)


def read_clock(texts: Iterable[str]) -> Array:
    """Compute seconds from clock times.

    Parameters
    ----------
    texts : iterable of str
        ``"04.03.2026 08:00:00"``, ``"2026-03-04T08:00:00.5Z"``, ``"3/4/2026 8:00:00 PM"`` or
        ``"08:00:00"``; without a date the clock may pass midnight.

    Returns
    -------
    array
        Seconds after the first of them; NaN for a text that is none. [s]

    Examples
    --------
    >>> read_clock(["23:59:58", "23:59:59,5", "00:00:01"])
    array([0. , 1.5, 3. ])
    >>> read_clock(["31.12.2026 23:59:59", "01.01.2027 00:00:00", "broken"])
    array([ 0.,  1., nan])
    """
    return _read(texts)[0]


def _read(texts: Iterable[str]) -> tuple[Array, AnyArray]:
    """As `read_clock`, and the places where a local clock was put forward or back by an hour."""
    matches = [_FORM.fullmatch(text.strip()) for text in texts]

    # 3/4 is the third of April or the fourth of March: the order that gives the shorter log
    orders = [
        np.array([_seconds(match, day_first=first) for match in matches]) for first in (True, False)
    ]
    seconds: Array = min(orders, key=lambda one: (np.isnan(one).sum(), _span(one)))
    known = np.flatnonzero(np.isfinite(seconds))
    if not known.size:
        return seconds, known

    # without a date the clock begins again at midnight
    dated = any(_has_date(match) for match in matches)
    if not dated and seconds[known].max() < _DAY:
        falls = np.array([b - a < -_DAY / 2 for a, b in pairwise(seconds[known])], int)
        seconds[known[1:]] += _DAY * np.cumsum(falls)

    ahead = np.zeros(known.size)
    if not any(match and match["zone"] for match in matches):
        ahead = put_forward(seconds[known], dated=dated)
        seconds[known] -= ahead
    return seconds - seconds[known[0]], known[1:][np.diff(ahead) != 0]


def with_clocks(table: LogTable) -> LogTable:
    """Replace columns of clock times by seconds, of the unit `CLOCK`.

    Returns
    -------
    LogTable
        Cells that are no clock time stay texts. A local clock is counted on where summer time
        begins or ends; a remark has the row.
    """
    read = [_in_seconds(column) for column in table.columns]
    remarks = [
        f"the clock of {column.name!r} changes by an hour in row {table.rows[place]}, as summer "
        "time does; it is counted on"
        for column, changes in read
        for place in changes
    ]
    return replace(
        table, columns=tuple(column for column, _ in read), remarks=(*table.remarks, *remarks)
    )


def _in_seconds(column: LogColumn) -> tuple[LogColumn, Sequence[int]]:
    """The column in seconds, and the places where its clock was put forward or back."""
    rows = len(column.values)
    filled = [text for text in column.texts.values() if text]
    if 2 * len(filled) < rows or not any(_FORM.fullmatch(text) for text in filled[:_TRIED]):
        return column, []
    texts = [column.texts.get(place, "") for place in range(rows)]
    # a number among clock times is no time
    values, changes = _read(texts)
    left = {int(n): texts[n] or _number(column.values[n]) for n in np.flatnonzero(np.isnan(values))}
    return LogColumn(column.name, CLOCK, values, left), changes.tolist()


def _number(value: float) -> str:
    return f"{value:g}" if np.isfinite(value) else ""


def _has_date(match: re.Match[str] | None) -> bool:
    return match is not None and bool(match["y"] or match["year"])


def _seconds(match: re.Match[str] | None, *, day_first: bool) -> float:
    if match is None:
        return np.nan
    dated = _has_date(match)
    if not dated and match["second"] is None:
        return np.nan  # hours and minutes, or minutes and seconds
    hour = int(match["hour"])
    if match["half"]:
        hour = hour % 12 + 12 * (match["half"] in "pP")
    if dated:
        # after a point the day comes first wherever this is written
        day_first = day_first or match["mark"] == "."
        day = _days(match["y"], match["m"], match["d"]) if match["y"] else np.nan
        if match["year"]:
            parts: Sequence[str] = (match["two"], match["one"])
            day = _days(match["year"], *(parts if day_first else parts[::-1]))
    else:
        day = 0.0
    second = float(f"{match['second'] or 0}.{match['part'] or 0}")
    return day * _DAY + hour * _HOUR + int(match["minute"]) * _MINUTE + second - _ahead(match)


@lru_cache(maxsize=64)
def _days(year: str, month: str, day: str) -> float:
    """Days since 2000, which leaves microseconds their digits."""
    whole = int(year) + (2000 if len(year) == 2 else 0)
    try:
        return float(date(whole, int(month), int(day)).toordinal() - date(2000, 1, 1).toordinal())
    except ValueError:
        return np.nan


def _ahead(match: re.Match[str]) -> float:
    """Seconds by which a time zone is ahead of UTC."""
    zone = match["zone"]
    if not zone or zone[0] not in "+-":
        return 0.0
    size = int(zone[1:3]) * _HOUR + int(zone[-2:]) * _MINUTE
    return size if zone[0] == "+" else -size


def _span(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(np.ptp(known)) if known.size else 0.0
