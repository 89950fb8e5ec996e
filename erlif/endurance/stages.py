"""Stages and idle runs of an endurance test, from its load alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array

SAME_LOAD = 0.03
"""Share of a load by which it may change within a stage. [1]"""

LEAST_DURATION = 20.0
"""Shorter stretches of one load, such as a load that is being raised, are left out. [s]"""

_FLOOR = 0.005  # of the highest load: smaller differences are noise of the cells
_MEMORY = 20.0  # s: bolts relax more slowly, loads are changed faster
_MEDIAN = 5  # samples of the running median, against single bad readings
_UNLOADED = 0.25  # of the second load: a lower first one is idle where nothing else shows it
_BRIEF = 1 / 3  # of the duration of the second stretch, likewise
_AT_REST = 0.2  # of the median torque of a stage: below it the machine stands


@dataclass(frozen=True)
class Stage:
    """A stretch of one load.

    Attributes
    ----------
    number : int
        Number of the stage from 1; 0 for an idle run.
    first : int
        Place of its first sample.
    last : int
        Place of its last sample.
    start : float
        Time of the first sample. [s]
    end : float
        Time of the last sample. [s]
    load : float
        Median load. [N]
    """

    number: int
    first: int
    last: int
    start: float
    end: float
    load: float

    @property
    def is_idle(self) -> bool:
        """Whether the bearing runs without its load."""
        return self.number == 0

    @property
    def samples(self) -> slice:
        """Its samples in the log."""
        return slice(self.first, self.last + 1)


def find_stages(
    time: Array,
    load: Array,
    torque: Array | None = None,
    *,
    same_load: float = SAME_LOAD,
    least_duration: float = LEAST_DURATION,
    idle_load: float | None = None,
) -> tuple[Stage, ...]:
    """Find stages of constant load and the idle runs between them.

    The load of a test rises from stage to stage. A stretch below the highest load so far is
    therefore an idle run, whatever its load; so is a first stretch that is no higher than these.

    Parameters
    ----------
    time : array, (n,)
        Times, rising. [s]
    load : array, (n,)
        Load. [N]
    torque : array, (n,), optional
        Size of the torque. With it the ends of a stage at which the machine stands are cut off.
        [any unit]
    same_load : float
        Share of a load by which it may change within a stage. [1]
    least_duration : float
        Shortest stage or idle run. [s]
    idle_load : float, optional
        Stretches up to this load are idle and all others are stages. Default: as above. [N]

    Returns
    -------
    tuple of Stage
        In the order of time.

    Examples
    --------
    Two stages with an idle run of 40 s before and between them, whose load is not zero:

    >>> time = np.arange(0.0, 680.0)
    >>> load = np.select([time < 40, time < 340, time < 380], [9e3, 36e3, 9e3], 54e3)
    >>> [(stage.number, stage.load) for stage in find_stages(time, load)]
    [(0, 9000.0), (1, 36000.0), (0, 9000.0), (2, 54000.0)]
    """
    floor = _FLOOR * float(np.max(load, initial=0.0))
    steady = _running_median(load)
    spans = [
        (first, last)
        for first, last in _steady_spans(time, steady, same_load, floor)
        if time[last] - time[first] >= least_duration
    ]
    loads = [float(np.median(load[first : last + 1])) for first, last in spans]
    durations = [float(time[last] - time[first]) for first, last in spans]
    idle = _find_idle(loads, durations, same_load, floor, idle_load)

    stages, number = [], 0
    for (first, last), level, is_idle in zip(spans, loads, idle, strict=True):
        if torque is not None and not is_idle:
            first, last = _cut_rest(torque, first, last)
            if time[last] - time[first] < least_duration:
                continue
            level = float(np.median(load[first : last + 1]))
        number += not is_idle
        stages.append(
            Stage(
                0 if is_idle else number,
                int(first),
                int(last),
                float(time[first]),
                float(time[last]),
                level,
            )
        )
    return tuple(stages)


def _running_median(values: Array) -> Array:
    if values.size < _MEDIAN:
        return values
    padded = np.pad(values, _MEDIAN // 2, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, _MEDIAN), axis=1))


def _steady_spans(
    time: Array, load: Array, same_load: float, floor: float
) -> list[tuple[int, int]]:
    """First and last sample of each stretch whose load follows its own recent mean."""
    spans: list[tuple[int, int]] = []
    first, mean = 0, float("nan")
    for n, (now, value) in enumerate(zip(time.tolist(), load.tolist(), strict=True)):
        if abs(value - mean) <= max(same_load * abs(mean), floor):
            # the mean of all at first, of the last seconds later
            passed = now - float(time[n - 1])
            mean += (value - mean) * max(passed / _MEMORY, 1 / (n - first + 1))
        else:
            if n:
                spans.append((first, n - 1))
            first, mean = n, value
    if load.size:
        spans.append((first, load.size - 1))
    return spans


def _find_idle(
    loads: Sequence[float],
    durations: Sequence[float],
    same_load: float,
    floor: float,
    idle_load: float | None,
) -> list[bool]:
    """Which stretches are idle runs."""
    if idle_load is not None:
        return [load <= idle_load for load in loads]

    # below the highest load so far by more than a stage may change
    highest, idle = -np.inf, []
    for load in loads:
        idle.append(load < highest - max(2 * same_load * abs(highest), floor))
        highest = max(highest, load)

    # the run before the first stage follows no higher load, but has that of the other idle runs
    dropped = [load for load, is_idle in zip(loads, idle, strict=True) if is_idle]
    if dropped:
        reach = max(dropped) + max(same_load * abs(max(dropped)), floor)
    elif len(loads) > 1:
        # a test of one stage has no other idle run: the run before it is light, or short
        brief = durations[0] < _BRIEF * durations[1]
        reach = loads[0] if brief else _UNLOADED * loads[1]
    else:
        reach = -np.inf
    for n, load in enumerate(loads):
        if idle[n] or load > reach:
            break
        idle[n] = True
    return idle


def _cut_rest(torque: Array, first: int, last: int) -> tuple[int, int]:
    """A stage without the time before the machine starts and after it stops."""
    inside = torque[first : last + 1]
    running = np.flatnonzero(inside > _AT_REST * np.median(inside))
    if not running.size:
        return first, first
    return first + int(running[0]), first + int(running[-1])
