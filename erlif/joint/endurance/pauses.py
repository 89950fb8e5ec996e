"""Pauses of a log: where it has no samples, and time without them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, Array

# A longer step of the time is a pause of the log: in seconds, and in sample intervals.
PAUSE = (20.0, 5.0)

_GAP = 3.0  # sample intervals; in a longer step no moment is likelier than another


def find_pauses(time: Array) -> AnyArray:
    """Find the samples before which a log has paused.

    Parameters
    ----------
    time : array, (n,)
        Times, rising. [s]

    Returns
    -------
    array of int
        Places of the first samples after the pauses.

    Examples
    --------
    >>> find_pauses(np.array([0.0, 1.0, 2.0, 60.0, 61.0, 65.0])).tolist()
    [3]
    """
    steps = np.diff(time)
    if not steps.size:
        return np.zeros(0, int)
    seconds, intervals = PAUSE
    return np.flatnonzero(steps > max(seconds, intervals * float(np.median(steps)))) + 1


@dataclass(frozen=True)
class LogClock:
    """Time without the gaps of a log: a gap counts as one sample interval, as it has no sample.

    Attributes
    ----------
    before : Array
        Last sample before each gap. [s]
    after : Array
        First sample after it. [s]
    interval : float
        Interval of the samples. [s]
    """

    before: Array
    after: Array
    interval: float

    @classmethod
    def of(cls, samples: Array) -> LogClock:
        """Make the clock of a log from the times of its samples."""
        steps = np.diff(samples)
        interval = float(np.median(steps))
        gaps = np.flatnonzero(steps > _GAP * interval)
        return cls(samples[gaps], samples[gaps + 1], interval)

    @property
    def _cut(self) -> Array:
        return np.append(0.0, np.cumsum(self.after - self.before - self.interval))

    def logged(self, time: Array) -> Array:
        """Compute the time in the log of samples."""
        return np.asarray(time - self._cut[np.searchsorted(self.after, time, side="right")])

    def real(self, logged: Array) -> Array:
        """Compute the time of day; a place in a gap comes to lie just before its end."""
        starts = self.before - self._cut[:-1]
        return np.asarray(logged + self._cut[np.searchsorted(starts, logged, side="left")])

    def hold_gaps(
        self, low: float, middle: float, high: float
    ) -> tuple[float, float, float, tuple[float, float] | None]:
        """Extend an interval that reaches into a gap over all of it; state the last such gap."""
        held = None
        for before, after in zip(self.before.tolist(), self.after.tolist(), strict=True):
            inside = after - self.interval
            if high > inside and low < after:
                middle = 0.5 * (before + after) if inside < middle < after else middle
                low, high = before if low > inside else low, max(high, after)
                held = (before, after)
        return low, middle, high, held
