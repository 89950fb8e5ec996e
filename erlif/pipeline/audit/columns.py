"""Single values of a log that stand apart from their neighbours."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, list_some, warn
from erlif.core.products import EncoderLog
from erlif.core.statistics import neighbours_of, robust_std
from erlif.core.units import count_of
from erlif.pipeline.audit.evidence import Evidence

_FEWEST = 12  # rows from which on they are compared

_MOST = 0.05  # share of the rows up to which values count as single

# How far a value lies from its neighbours: in ranges of all other values, and in robust standard
# deviations of such distances.
_RANGES, _SIGMAS = 3.0, 12.0

# Factor below all other values of a column without zeros at which a value is far off as well.
_LACKING = 3.0

# Least distance: of the median, or in kelvin for a temperature.
_RELATIVE, _KELVIN = 0.2, 3.0

# Factor between neighbouring loads that no test program has, and largest share of such rows.
_FACTOR, _SHARE = 30.0, 0.5

# Columns that are searched, with the least distance of each.
_SEARCHED = {"temperature": _KELVIN, "joint_load": None}


def note_columns(evidence: Evidence) -> Iterator[Note]:
    """Warn of outliers in the columns from which theory is computed.

    A column of unknown meaning may have single values: a mark, a sync pulse, a count.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    log, oil = evidence.run.log, evidence.run.settings.oil
    for name, values, odd in _search_columns(log):
        unit = str(log[name].attrs.get("units", "")).replace("degree_Celsius", "degC")
        if odd.size:
            counted = name == "joint_load" or (oil is not None and oil.vogel is not None)
            yield _note_single(name.removeprefix("joint_"), values, odd, unit, counted=counted)
        elif name == "joint_load":
            lost = find_lost(values)
            if lost.size:
                usual = float(np.median(np.delete(values, lost)))
                low, high = values[lost].min(), values[lost].max()
                rows, count = list_some(lost), count_of(lost.size, "row")
                yield warn(
                    "load",
                    f"the load cell or its cable is loose: {low:.3g} to {high:.3g} N in {count} "
                    f"({rows}), {usual:.4g} N in the others. Correct them, or take out these "
                    "pairs; speed exponent and theory count them",
                )


def without_single(log: EncoderLog) -> EncoderLog:
    """A log without the rows whose temperature or load stand apart.

    Parameters
    ----------
    log : EncoderLog

    Returns
    -------
    EncoderLog
    """
    kept = np.arange(log.sizes["frame"])
    for _, _, odd in _search_columns(log):
        kept = np.setdiff1d(kept, odd)
    return EncoderLog(log.isel(frame=kept))


def _search_columns(log: EncoderLog) -> Iterator[tuple[str, Array, AnyArray]]:
    """Name, values and single values of each column that is searched."""
    for name, least in _SEARCHED.items():
        if name in log and log[name].size >= _FEWEST:
            values = np.asarray(log[name].values, float)
            yield name, values, find_single(values, least=least)


def _note_single(name: str, values: Array, odd: AnyArray, unit: str, *, counted: bool) -> Note:
    shown = ", ".join(f"{values[k]:.5g}" for k in odd[:5])
    others, unit = np.delete(values, odd), f" {unit}" if unit else ""
    use = "; speed exponent and theory count them" if counted else ""
    return warn(
        name,
        f"{'row' if odd.size == 1 else 'rows'} {list_some(odd)} of the log: {shown}{unit}, where "
        f"all others are {others.min():.5g} to {others.max():.5g}{unit}. Correct them, or take out "
        f"these pairs{use}",
    )


def find_single(values: Array, *, least: float | None = None) -> AnyArray:
    """Rows whose values stand apart from their neighbours and from all others.

    A ramp, steps and a load that follows the crank have no such values: each has neighbours like
    it, or is within the range of the others.

    Parameters
    ----------
    values : array, (row,)
    least : float, optional
        Distance below which no value stands apart; default: a fifth of the median.

    Returns
    -------
    array of int

    Examples
    --------
    >>> load = np.linspace(20, 200, 50)
    >>> find_single(load)
    array([], dtype=int64)
    >>> load[7] *= 1000
    >>> find_single(load)
    array([7])
    """
    off = np.abs(values - np.median(neighbours_of(values, 3), axis=1))
    least = _RELATIVE * abs(float(np.median(values))) if least is None else least
    apart = off > max(least, _SIGMAS * robust_std(off))

    # the highest or the lowest values, as far as they are single ones
    order, most = np.argsort(values), max(int(_MOST * values.size), 1)
    for count in range(most, 0, -1):
        for far, others in (
            (order[-count:], order[:-count]),
            (order[:count], order[count:]),
        ):
            low, high = float(values[others[0]]), float(values[others[-1]])
            room = max(_RANGES * (high - low), least)
            beyond = (values[far] > high + room) | (values[far] < low - room)
            lacking = (low > 0) & (values[far] < low / _LACKING)
            if ((beyond | lacking) & apart[far]).all():
                return np.sort(far)
    return np.array([], int)


def find_lost(load: Array) -> AnyArray:
    """Find rows without load in a run that is loaded in most rows, as by a loose cable.

    Parameters
    ----------
    load : array, (row,)
        Above zero. [N]

    Returns
    -------
    array of int

    Examples
    --------
    >>> load = np.full(50, 220.0)
    >>> load[20:30] = 0.5
    >>> find_lost(load)
    array([20, 21, 22, 23, 24, 25, 26, 27, 28, 29])
    """
    order = np.sort(np.log(load))
    gap = np.diff(order)
    widest = int(np.argmax(gap))
    if gap[widest] < np.log(_FACTOR):
        return np.array([], int)
    low = np.log(load) <= order[widest]
    return np.flatnonzero(low) if low.mean() <= _SHARE else np.array([], int)
