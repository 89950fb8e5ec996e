"""Changes of a local clock to and from summer time."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import AnyArray, Array

_DAY, _HOUR = 86400.0, 3600.0

# Summer time begins on a Sunday before this hour; days are counted from 2000, a Saturday.
_SUNDAY, _EARLY = 1, 4 * _HOUR

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
    summer = (before // _DAY % 7 == _SUNDAY) & (before % _DAY < _EARLY) & dated
    return np.append(0.0, np.cumsum(_HOUR * (1.0 * (put(_HOUR) & summer) - put(-_HOUR))))
