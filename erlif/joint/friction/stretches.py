"""Stretches of one direction in a torque log with reversals, without the dwell at the reversals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import EnduranceError

_MEDIAN = 5  # samples of the running median, against single jerks
_ENDS = (1.0, 99.0)  # percentiles of the torque so smoothed: the levels of both directions
_TURN = 0.1  # of half their difference, beyond the middle: what may be a direction reaches it
_REACHED = 0.4  # of the level nearby, beyond the middle: what is a direction reaches it
_EDGE = 0.25  # of that reach, beyond the middle: there the direction begins
_NEARBY = 5  # stretches whose median is the level nearby
_SHORTEST = 0.2  # of the usual stretch of its direction: shorter ones are chatter
_FEWEST = 4  # samples of a stretch that remain
_TRIM = 0.1  # of the sliding at each end, where the motor speeds up
_NOISY = 0.55  # scatter within a direction over half their difference; white noise gives 2.5

_PARTS = 8  # of a stretch, whose means are compared
_FEWEST_LEVELS = 2  # stretches of a direction whose levels can be compared
_BLOCKS = 40  # means of a stretch in which the dwell is sought
_SLIDING = 0.2  # of a stretch: least part that slides
_DROP = 0.05  # of half the difference of the directions by which dwell is lower
_CLEAR = 4.0  # standard errors, likewise


@dataclass(frozen=True)
class Stretch:
    """Motion in one direction.

    Attributes
    ----------
    forward : bool
        Whether the torque is the higher one.
    first : int
        Place of the first sample that counts.
    last : int
        Place of the last one.
    dwell : tuple[int, int]
        Samples of dwell that are left out before and after the sliding.
    """

    forward: bool
    first: int
    last: int
    dwell: tuple[int, int] = (0, 0)

    @property
    def samples(self) -> slice:
        """Its samples in the log."""
        return slice(self.first, self.last + 1)


def find_stretches(torque: Array) -> list[Stretch]:
    """Find the stretches of one direction.

    A direction must reach 0.4 of the level of the stretches nearby, from the middle of both
    directions, so that noise about the middle is no reversal. In a dwell the torque relaxes:
    a part at the ends of most stretches whose torque is lower by 5 % or more is left out.

    Parameters
    ----------
    torque : array, (n,)
        Torque with its sign. [N m]

    Returns
    -------
    list of Stretch
        In the order of time; none where the torque does not reverse.

    Raises
    ------
    EnduranceError
        If the torque scatters within a direction as noise does.

    Examples
    --------
    Three seconds of motion and one at rest, at 10 samples a second:

    >>> time = np.arange(0.0, 32.0, 0.1)
    >>> torque = np.where(time % 4 < 2.95, 1.0, 0.2) * np.where(time % 8 < 3.95, 1, -1)
    >>> one, two, *_ = find_stretches(torque)
    >>> one.forward, two.forward, two.dwell
    (True, False, (0, 10))
    """
    smooth = running_median(torque)
    low, high = np.percentile(smooth, _ENDS)
    half = 0.5 * (high - low)
    if not half > 0:
        return []
    away = smooth - 0.5 * (low + high)
    runs = _runs(away, _TURN * half)
    runs = _runs(away, _REACHED * _level_nearby(away, runs))
    parts = [_split(torque[a : b + 1] * (1 if up else -1), half) for a, b, up in runs]

    # dwell belongs to the machine: it is in most stretches, or in none
    before, after = (float(np.mean([part[k] > 0 for part in parts])) > 0.5 for k in (0, 1))
    stretches = []
    for (first, last, up), (lead, tail) in zip(runs, parts, strict=True):
        dwell = (lead if before else 0, tail if after else 0)
        first, last = first + dwell[0], last - dwell[1]
        cut = int(_TRIM * (last - first + 1))
        if last - first + 1 - 2 * cut >= _FEWEST:
            stretches.append(Stretch(up, first + cut, last - cut, dwell))
    _require_levels(torque, stretches)
    return stretches


def variation_within(torque: Array, stretches: list[Stretch]) -> float:
    """Compute by how much the torque varies within a stretch, in the mean of all of them.

    Parameters
    ----------
    torque : array, (n,)
        Torque with its sign. [any unit]
    stretches : list of Stretch
        As `find_stretches` returns them, of both directions.

    Returns
    -------
    float
        Range of the mean course over its mean, 0 where it is not larger than the scatter explains.
        [1]

    Examples
    --------
    A sine has no level, unlike a square wave:

    >>> torque = np.sin(np.arange(0.0, 60.0, 0.1))
    >>> print(f"{variation_within(torque, find_stretches(torque)):.1f}")
    0.9
    >>> variation_within(np.sign(torque), find_stretches(np.sign(torque)))
    0.0
    """
    long = [one for one in stretches if one.last - one.first + 1 >= _PARTS]
    parts = [np.array_split(torque[one.samples], _PARTS) for one in long]
    courses = np.array([[part.mean() for part in each] for each in parts]).reshape(-1, _PARTS)
    sides = _by_direction(courses, long)
    if min(map(len, sides)) < _FEWEST_LEVELS:
        return 0.0
    course = 0.5 * (sides[0].mean(axis=0) - sides[1].mean(axis=0))
    varied = float(np.ptp(course))
    error = 0.5 * float(np.hypot(*(side.std(axis=0).max() / np.sqrt(len(side)) for side in sides)))
    return varied / float(course.mean()) if varied > _CLEAR * error else 0.0


def _by_direction(values: Array, stretches: list[Stretch]) -> tuple[Array, Array]:
    forward = np.array([one.forward for one in stretches], dtype=bool)
    return values[forward], values[~forward]


def running_median(values: Array) -> Array:
    """Compute the median of five neighbouring samples, which single jerks do not shift.

    Parameters
    ----------
    values : array, (sample,)

    Returns
    -------
    array, (sample,)

    Examples
    --------
    >>> running_median(np.array([1.0, 1, 9, 1, 1, 2])).tolist()
    [1.0, 1.0, 1.0, 1.0, 2.0, 2.0]
    """
    if values.size < _MEDIAN:
        return values
    return np.asarray(median_filter(values, _MEDIAN, mode="nearest"))


def _level_nearby(away: Array, runs: list[tuple[int, int, bool]]) -> Array:
    """Typical distance of nearby stretches from the middle, for each sample."""
    sizes = np.array([np.percentile(np.abs(away[a : b + 1]), 75) for a, b, _ in runs])
    levels = median_filter(sizes, _NEARBY, mode="nearest")
    centres = [0.5 * (a + b) for a, b, _ in runs]
    return np.asarray(np.interp(np.arange(away.size), centres, levels))


def _runs(away: Array, beyond: Array | float) -> list[tuple[int, int, bool]]:
    """First and last sample of each run of one direction, and whether it is the higher one."""
    clear = np.flatnonzero(np.abs(away) > beyond)
    up = away[clear] > 0
    turns = np.flatnonzero(np.diff(up.astype(int))) + 1
    # it begins where the torque leaves the middle for it; a dwell ends the run before
    starts = clear[turns]
    edge = _EDGE * np.broadcast_to(beyond, away.shape)
    for sense, inside in ((True, away > edge), (False, away < -edge)):
        outside = np.flatnonzero(~inside)
        own = up[turns] == sense
        starts[own] = outside[np.searchsorted(outside, starts[own]) - 1] + 1
    starts = np.append(0, starts)
    ends = np.append(starts[1:] - 1, away.size - 1)
    upward = up[np.append(0, turns)]

    # a jerk, or chatter in a dwell, belongs to the run that it interrupts
    counts = ends - starts + 1
    usual = {sense: _usual(counts[upward == sense]) for sense in (True, False)}
    runs: list[tuple[int, int, bool]] = []
    for first, last, sense in zip(starts.tolist(), ends.tolist(), upward.tolist(), strict=True):
        brief = last - first + 1 < _SHORTEST * usual[sense]
        if runs and (brief or runs[-1][2] == sense):
            runs[-1] = (runs[-1][0], last, runs[-1][2])
        elif not brief:
            runs.append((first, last, sense))
    return runs


def _usual(counts: AnyArray) -> float:
    """Length of the run that contains the median sample, insensitive to many short runs."""
    if not counts.size:
        return 0.0
    ordered = np.sort(counts)
    return float(ordered[np.searchsorted(np.cumsum(ordered), 0.5 * ordered.sum())])


def _least(size: int) -> int:
    """Minimum number of sliding blocks among `size`."""
    return max(int(_SLIDING * size), 2)


@lru_cache(maxsize=8)
def _divisions(size: int) -> tuple[tuple[AnyArray, ...], Array]:
    """Bounds of all divisions of so many blocks into three, and a basis of parabolas over them."""
    first, last = np.triu_indices(size + 1, _least(size))
    place = np.linspace(-1, 1, size)
    basis = np.linalg.qr(np.column_stack([np.ones(size), place, place**2]))[0]
    return (np.zeros_like(first), first, last, np.full_like(last, size)), np.asarray(basis)


def _split(values: Array, half: float) -> tuple[int, int]:
    """Samples before and after the sliding, by the best three levels of a stretch."""
    edges = np.linspace(0, values.size, min(_BLOCKS, values.size) + 1).astype(int)
    size = edges.size - 1
    if size < 2 * _FEWEST:
        return 0, 0
    blocks = np.add.reduceat(values, edges[:-1]) / np.diff(edges)
    sums, squares = (np.append(0.0, np.cumsum(blocks**power)) for power in (1, 2))

    # lead, sliding and tail of every division
    bounds, basis = _divisions(size)
    _, first, last, _ = bounds
    left, means = np.zeros(first.size), []
    for one, other in pairwise(bounds):
        count = np.maximum(other - one, 1)
        means.append((sums[other] - sums[one]) / count)
        left += squares[other] - squares[one] - count * means[-1] ** 2

    # the torque is highest in sliding, but for a brief peak at its start
    for mean, count in ((means[0], first), (means[2], size - last)):
        left[(count >= _least(size)) & (mean > means[1])] = np.inf
    best = int(np.argmin(left))
    i, j = int(first[best]), int(last[best])

    # a torque that changes smoothly over the stretch, as its speed does, is no dwell
    smooth = float(np.sum((blocks - basis @ (basis.T @ blocks)) ** 2))
    if left[best] > 0.5 * smooth:
        return 0, 0

    level = blocks[i:j].mean()
    error = np.sqrt(max(left[best], 0.0) / max(size - 3, 1))
    turns = []
    for part in (blocks[:i], blocks[j:]):
        # a shorter part is the speeding up, and cut off with it
        lower = level - part.mean() if part.size > _TRIM * size else 0.0
        counts = lower > _DROP * half and lower > _CLEAR * error / np.sqrt(max(part.size, 1))
        turns.append(counts)
    return int(edges[i]) * bool(turns[0]), int(values.size - edges[j]) * bool(turns[1])


def _require_levels(torque: Array, stretches: list[Stretch]) -> None:
    """Refuse noise: within a direction it scatters nearly as much as the directions differ."""
    levels = np.array([torque[one.samples].mean() for one in stretches])
    sides = _by_direction(levels, stretches)
    if min(map(len, sides)) < _FEWEST_LEVELS:
        return
    # friction may change over the log, so that only neighbours are compared
    inside = float(np.mean([torque[one.samples].var() for one in stretches]))
    beside = float(np.mean([np.mean(np.diff(side) ** 2) / 2 for side in sides]))
    scatter = np.sqrt(inside + beside)
    half = 0.5 * float(np.mean(sides[0]) - np.mean(sides[1]))
    if scatter > _NOISY * half:
        raise EnduranceError(
            "Expected a torque that keeps a level in each direction; within a direction it "
            f"scatters by {scatter:.2g} N m, and the two directions differ by {2 * half:.2g} N m, "
            "as noise does. Log the torque with its sign over reversals of the motion; for a "
            "motion of one direction take erlif endurance."
        )
