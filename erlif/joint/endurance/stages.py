"""Stages and idle runs of an endurance test, from its load alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.ndimage import uniform_filter1d

from erlif.core.arrays import AnyArray, Array, Mask
from erlif.core.notes import Note, remark, warn
from erlif.core.statistics import robust_std
from erlif.joint.endurance.blocks import find_pauses
from erlif.joint.friction.stretches import running_median

# Share of a load by which it may change within a stage. [1]
SAME_LOAD = 0.03

# Shorter stretches of one load, such as a load that is being raised, are left out. [s]
LEAST_DURATION = 20.0

_FLOOR = 0.005  # of the highest load: smaller differences are noise of the cells
_MEMORY = 20.0  # s: bolts relax more slowly, loads are changed faster
_FEWEST = 5  # samples of a mean
_UNLOADED = 0.25  # of the second load: a lower first one is idle where nothing else shows it
_BRIEF = 1 / 3  # of the duration of the second stretch, likewise
_ZERO = 0.02  # of the highest load: below it nothing is loaded
_AVERAGE = 10.0  # s: mean of a load that scatters, but at least the samples of the median
_CLEAR = 4.0  # standard deviations: few of some thousand samples exceed them
_MOST_TOLERANCE = 0.1  # of a load: steps of the load are larger
_DRIFT = 0.06  # of a load, within a stage; bolts lose less
_TENTH = 0.1  # of a stage at its ends, between which its drift is measured
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
    part : int
        Part of the stage or idle run, from 1: a pause of the log divides it.
    """

    number: int
    first: int
    last: int
    start: float
    end: float
    load: float
    part: int = 1

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
    idle_load : float, optional
        Stretches up to this load are idle and all others are stages. Default: as above. [N]

    Returns
    -------
    tuple of Stage
        In the order of time. A pause of the log divides a stage into parts of one number.

    Examples
    --------
    Two stages with an idle run of 40 s before and between them, whose load is not zero:

    >>> time = np.arange(0.0, 680.0)
    >>> load = np.select([time < 40, time < 340, time < 380], [9e3, 36e3, 9e3], 54e3)
    >>> [(stage.number, stage.load) for stage in find_stages(time, load)]
    [(0, 9000.0), (1, 36000.0), (0, 9000.0), (2, 54000.0)]
    """
    highest = float(np.max(load, initial=0.0))
    floor = _FLOOR * highest
    pauses = find_pauses(time)
    spans = [
        (first, last)
        for first, last in _steady_spans(time, load, pauses, floor)
        if time[last] - time[first] >= LEAST_DURATION
    ]
    runs = _join_parts(spans, load, pauses, floor)
    loads = np.array([np.median(np.concatenate([load[a : b + 1] for a, b in run])) for run in runs])
    durations = [float(sum(time[b] - time[a] for a, b in run)) for run in runs]
    idle = loads <= (_ZERO * highest if idle_load is None else idle_load)
    if idle_load is None:
        idle |= _find_idle(loads, durations, floor)

    stages: list[Stage] = []
    number = 0
    for run, is_idle in zip(runs, idle, strict=True):
        if torque is not None and not is_idle:
            run = [_cut_rest(torque, first, last) for first, last in run]
        run = [(a, b) for a, b in run if time[b] - time[a] >= LEAST_DURATION or is_idle]
        number += bool(run) and not is_idle
        for part, (first, last) in enumerate(run, 1):
            stages.append(
                Stage(
                    0 if is_idle else number,
                    first,
                    last,
                    float(time[first]),
                    float(time[last]),
                    float(np.median(load[first : last + 1])),
                    part,
                )
            )
    return tuple(stages)


def join_stages(stages: Sequence[Stage]) -> tuple[Stage, ...]:
    """Join the parts of stages that pauses of the log divide.

    Parameters
    ----------
    stages : sequence of Stage
        From `find_stages`.

    Returns
    -------
    tuple of Stage
        From the first sample of the first part to the last one of the last part.

    Examples
    --------
    >>> parts = [Stage(1, 0, 99, 0.0, 99.0, 36e3), Stage(1, 100, 199, 500.0, 599.0, 36e3, 2)]
    >>> join_stages(parts)
    (Stage(number=1, first=0, last=199, start=0.0, end=599.0, load=36000.0, part=1),)
    """
    joined: list[Stage] = []
    for stage in stages:
        if stage.part == 1:
            joined.append(stage)
        else:
            joined[-1] = replace(joined[-1], last=stage.last, end=stage.end)
    return tuple(joined)


def note_stages(
    time: Array, load: Array, stages: Sequence[Stage], *, idle_load: float | None = None
) -> list[Note]:
    """Describe what is doubtful about stages.

    Parameters
    ----------
    time, load, idle_load
        As for `find_stages`.
    stages : sequence of Stage
        From `find_stages`.

    Returns
    -------
    list of Note
        A load that scatters, a load that changes within a stage, and a first stretch that is idle
        only as it is short or light.
    """
    notes = []
    pauses = find_pauses(time)
    width = _average_samples(time)
    raw = _scatter(np.split(load, pauses), width)
    scatter = _scatter([running_median(part) for part in np.split(load, pauses)], width)
    if _CLEAR * scatter > SAME_LOAD:
        scattered = f"the load scatters by {100 * raw:.1f} % (standard deviation)"
        notes.append(
            remark("", f"{scattered}; stages are found from its mean over {width} samples")
        )

    # the only idle run is the first stretch, and nothing was stated about it
    idle = [place for place, stage in enumerate(stages) if stage.is_idle]
    if idle == [0] and len(stages) > 1 and idle_load is None:
        first = stages[0]
        if first.load > _ZERO * float(np.max(load, initial=0.0)):
            stretch = f"{first.load / 1e3:.1f} kN from {first.start:.0f} to {first.end:.0f} s"
            reason = "it is shorter than a third of the next or below a quarter of its load"
            taken = f"the stretch of {stretch} is taken for an idle run, as {reason}"
            notes.append(warn("", f"{taken}; if it is a stage, give --idle-load"))

    for stage in join_stages([stage for stage in stages if not stage.is_idle]):
        inside = load[stage.samples]
        tenth = max(round(_TENTH * inside.size), 1)
        start, end = float(np.median(inside[:tenth])), float(np.median(inside[-tenth:]))
        chance = _CLEAR * raw * np.sqrt(2 / tenth)
        if abs(end - start) > (_DRIFT + chance) * stage.load:
            changes = f"the load changes from {start / 1e3:.1f} to {end / 1e3:.1f} kN; it is a ramp"
            median = f"its median of {stage.load / 1e3:.1f} kN counts as the load of the stage"
            notes.append(warn(f"stage {stage.number}", f"{changes}, and {median}"))
    return notes


# First and last sample.
_Span = tuple[int, int]


def _join_parts(
    spans: Sequence[_Span], load: Array, pauses: AnyArray, floor: float
) -> list[list[_Span]]:
    """Spans by their stage: those of one load with a pause of the log between them are parts."""
    runs: list[list[_Span]] = []
    level = 0.0
    for first, last in spans:
        here = float(np.median(load[first : last + 1]))
        continues = runs and first in pauses and runs[-1][-1][1] == first - 1
        if continues and abs(here - level) <= max(SAME_LOAD * abs(level), floor):
            runs[-1].append((first, last))
        else:
            runs.append([(first, last)])
        level = here
    return runs


def _steady_spans(time: Array, load: Array, pauses: AnyArray, floor: float) -> list[_Span]:
    """First and last sample of each stretch whose load follows its own recent mean."""
    same_load = SAME_LOAD
    parts = list(pairwise([0, *pauses.tolist(), time.size]))
    smooth = [running_median(load[start:end]) for start, end in parts]

    # a load that scatters by more than the tolerance would be shattered
    width = _average_samples(time)
    if _CLEAR * _scatter(smooth, width) > same_load:
        smooth = [_running_mean(part, width) for part in smooth]
        same_load = max(same_load, min(_CLEAR * _scatter(smooth, width), _MOST_TOLERANCE))

    spans: list[_Span] = []
    for (start, end), values in zip(parts, smooth, strict=True):
        steady = values.tolist()
        first, mean = start, float("nan")
        for n, (now, value) in enumerate(zip(time[start:end].tolist(), steady, strict=True), start):
            if abs(value - mean) <= max(same_load * abs(mean), floor):
                # the mean of all at first, of the last seconds later
                passed = now - float(time[n - 1])
                mean += (value - mean) * max(passed / _MEMORY, 1 / (n - first + 1))
            else:
                if n > start:
                    spans.append((first, n - 1))
                first, mean = n, value
        if end > start:
            spans.append((first, end - 1))
    return spans


def _average_samples(time: Array) -> int:
    """Samples of the mean of a load that scatters."""
    if time.size < _FEWEST:
        return _FEWEST
    return max(_FEWEST, round(_AVERAGE / float(np.median(np.diff(time)))))


def _running_mean(values: Array, width: int) -> Array:
    """Mean over a width, or of all where these are fewer."""
    if 0 < values.size < width:
        return np.full(values.size, values.mean())
    return uniform_filter1d(values, width, mode="nearest")


def _scatter(parts: Sequence[Array], width: int) -> float:
    """Standard deviation of a load as a share of it, from its differences up to a width apart."""
    highest = max((float(part.max(initial=0.0)) for part in parts), default=0.0)
    largest = 0.0
    for lag in 2 ** np.arange(width.bit_length()):
        shares = []
        for part in parts:
            loaded = np.flatnonzero(part[:-lag] > _UNLOADED * highest)
            shares.append((part[loaded + lag] - part[loaded]) / part[loaded])
        differences = np.concatenate(shares)
        if differences.size:
            largest = max(largest, robust_std(differences) / np.sqrt(2))
    return largest


def _find_idle(loads: Array, durations: Sequence[float], floor: float) -> Mask:
    """Mark the stretches that are idle runs by the loads before them."""
    # below the highest load so far by more than a stage may change
    highest = np.append(-np.inf, np.maximum.accumulate(loads))[:-1]
    idle: Mask = loads < highest - np.maximum(2 * SAME_LOAD * np.abs(highest), floor)

    # the run before the first stage follows no higher load, but has that of the other idle runs
    if idle.any():
        dropped = float(loads[idle].max())
        reach = dropped + max(SAME_LOAD * abs(dropped), floor)
    elif loads.size > 1:
        # a test of one stage has no other idle run: the run before it is light, or short
        brief = durations[0] < _BRIEF * durations[1]
        reach = loads[0] if brief else _UNLOADED * loads[1]
    else:
        reach = -np.inf
    idle[np.logical_and.accumulate(~idle & (loads <= reach))] = True
    return idle


def _cut_rest(torque: Array, first: int, last: int) -> _Span:
    """A stage without the time before the machine starts and after it stops."""
    inside = torque[first : last + 1]
    running = np.flatnonzero(inside > _AT_REST * np.median(inside))
    if not running.size:
        return first, first
    return first + int(running[0]), first + int(running[-1])
