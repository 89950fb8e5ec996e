"""Changes of a local clock to and from summer time."""

from __future__ import annotations

from datetime import datetime, timedelta
from zoneinfo import ZoneInfo, available_timezones

import numpy as np

from erlif.core.arrays import AnyArray, Array

_HOUR = 3600.0

# Longest usual step of a log in which a change of the clock differs from a pause. [s]
_LONGEST_STEP = 900.0

# Step of a fast log that may come with the change: between the pulses at both sides of a dead
# point, a rocker takes ten times as long as elsewhere. [s]
_DWELL = 1.0


def put_forward(local: Array, *, dated: bool) -> Array:
    """Find by how much a local clock was put forward since the first row.

    Parameters
    ----------
    local : array, (row,)
        Times of the clock, with a date since 2000. [s]
    dated : bool
        Whether they have a date; without one a clock that was put forward looks like a pause.

    Returns
    -------
    array, (row,)
        Negative where it was put back. [s]

    Examples
    --------
    >>> put_forward(np.array([10790.0, 10795.0, 7200.0, 7205.0]), dated=False)
    array([    0.,     0., -3600., -3600.])
    """
    before, after = local[:-1], local[1:]
    usual = float(np.median(after - before)) if before.size else 0.0
    if not 0 < usual <= _LONGEST_STEP:
        return np.zeros(local.size)

    def put(hour: float) -> AnyArray:
        """Where the clock jumps by an hour in one step over a full hour."""
        step = after - before - hour
        over = (after - hour) // _HOUR > before // _HOUR
        return np.asarray((step > 0) & (step <= max(2 * usual, _DWELL)) & over)

    # a pause of an hour looks alike but on the day of the change
    ahead = 0.0 - put(-_HOUR)
    for row in np.flatnonzero(put(_HOUR)) if dated else ():
        ahead[row] += _begins_summer(before[row], after[row])
    return np.append(0.0, np.cumsum(_HOUR * ahead))


def _begins_summer(before: float, after: float) -> bool:
    """Whether clocks anywhere in the world are put forward between two local times since 2000."""
    one, two = (datetime(2000, 1, 1) + timedelta(seconds=time) for time in (before, after))
    elapsed = (
        two.replace(tzinfo=zone).timestamp() - one.replace(tzinfo=zone).timestamp()
        for zone in map(ZoneInfo, sorted(available_timezones()))
    )
    return any(abs(after - before - _HOUR - seconds) < 1 for seconds in elapsed)
