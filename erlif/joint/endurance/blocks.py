"""Friction of a stage as blocks of samples, with its running-in, drift, pauses and restarts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.joint.endurance.disturbances import replace_spikes
from erlif.joint.endurance.noise import NoiseSpread, whiten

# A longer step of the time is a pause of the log: in seconds, and in sample intervals.
PAUSE = (20.0, 5.0)

_GAP = 3.0  # sample intervals; in a longer step no moment is likelier than another

# Blocks into which the samples of a stage are averaged; the work grows as the cube of it.
MOST_BLOCKS = 300

# Time constants of running-in, as shares of the longest stage; two span those between.
RUNNING_IN = (1 / 20, 1 / 5)

# Time constants of the rise in the posterior. [s]
EXPONENTIALS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.0, 16.0, 23.0, 32.0, 64.0)

# Durations of a straight rise in the posterior. [s]
RAMPS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.0, 16.0, 23.0, 32.0, 64.0)

# Standard deviations of drift in the longest stage and of both parts of running-in. [1]
#
# In a short stage a rise could else be offset by a huge running-in against a huge drift.
USUAL = (0.05, 0.05, 0.05)

# The same after a pause of the log: of the level, and of running-in that begins again. [1]
#
# The machine may have stood still in the pause. Its level differs then about as from stage to
# stage.
RESTART = (0.01, 0.05, 0.05)

_COLLINEAR = 1e-6  # norm of a rise that the background explains altogether
_WITHIN = 8  # samples in a block; more are averaged, as the work grows with them


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
        """Extend an interval that reaches into gaps over these gaps; return also the last gap."""
        held = None
        for before, after in zip(self.before.tolist(), self.after.tolist(), strict=True):
            inside = after - self.interval
            if high > inside and low < after:
                middle = 0.5 * (before + after) if inside < middle < after else middle
                low, high = before if low > inside else low, max(high, after)
                held = (before, after)
        return low, middle, high, held


@dataclass(frozen=True)
class StageFriction:
    """Friction of one stage.

    Attributes
    ----------
    time : Array
        Times, rising. [s]
    friction : Array
        Friction coefficient at these times. [1]
    """

    time: Array
    friction: Array


@dataclass(frozen=True)
class BlockRecord:
    """A stage whose samples are averaged into blocks.

    Attributes
    ----------
    samples : Array
        Times of the samples that are kept. [s]
    starts : Array
        Places of the first samples of the blocks.
    time : Array
        Mean times of the blocks. [s]
    friction : Array
        Mean friction of the blocks. [1]
    background : Array
        Columns (block, n) of level, drift and running-in, and of each restart.
    usual : Array
        Standard deviations of these columns but the first, whose level is free. [1]
    scale : Array
        Noise of the blocks over that of quiet ones. [1]
    """

    samples: Array
    starts: AnyArray
    time: Array
    friction: Array
    background: Array
    usual: Array
    scale: Array

    @classmethod
    def of(cls, stage: StageFriction, longest: float) -> BlockRecord:
        """Average a stage; the longest stage lasts `longest` without its pauses. [s]"""
        time, friction, parts, per_block = _kept(stage)
        starts = np.arange(0, time.size, per_block)
        blocks, firsts = _average(friction, starts), [first // per_block for first in parts[1:]]

        # level, drift, and running-in of any time constant between those two
        columns = [np.ones_like(time), (LogClock.of(time).logged(time) - time[0]) / longest]
        for number, first in enumerate(parts):
            inside = np.arange(time.size) >= first
            last = parts[number + 1] if number + 1 < len(parts) else time.size
            inside[last:] = False
            passed = np.maximum(time - time[first], 0.0)
            decays = [inside * np.exp(-passed / (share * longest)) for share in RUNNING_IN]
            columns += ([inside.astype(float)] if number else []) + decays
        return cls(
            time,
            starts,
            _average(time, starts),
            np.concatenate([replace_spikes(part) for part in np.split(blocks, firsts)]),
            _average(np.column_stack(columns), starts),
            np.array([*USUAL, *RESTART * (len(parts) - 1)]),
            np.ones(starts.size),
        )

    def whiten(self, factor: Array, columns: Array) -> Array:
        """Turn columns (block, n) into ones with uncorrelated noise of equal variance."""
        return whiten(factor, columns / self.scale[:, None])

    def with_rise(self, onset: float, constant: float) -> BlockRecord:
        """Make a record whose background holds a rise of any size."""
        return self._with(self.average(rises(self.samples, np.array([onset]), constant)))

    def with_decay(self, onset: float, constant: float) -> BlockRecord:
        """Return a record with a decaying rise of free amplitude in its background."""
        lag = self.time - onset
        return self._with(np.where(lag < 0, 0.0, np.exp(-np.maximum(lag, 0.0) / constant)))

    def without_samples(self, start: float, end: float) -> BlockRecord:
        """Make a record whose blocks in a span have no weight: each has a column of its own."""
        inside = (self.time >= start) & (self.time <= end)
        return self._with(np.eye(self.time.size)[:, inside])

    def _with(self, columns: Array) -> BlockRecord:
        background = np.column_stack([self.background, columns])
        more = background.shape[1] - self.background.shape[1]
        usual = np.append(self.usual, np.full(more, np.inf))
        return replace(self, background=background, usual=usual)

    def average(self, values: Array) -> Array:
        """Mean of each block of samples."""
        return _average(values, self.starts)

    def usual_rows(self, deviation: float) -> Array:
        """Rows of the fit by which the background is of its usual size, in units of the noise."""
        rows = np.zeros((self.usual.size, self.usual.size + 2))
        if np.isfinite(deviation):
            rows[:, 1:-1] = np.diag(deviation / self.usual)
        return rows


def _kept(stage: StageFriction) -> tuple[Array, Array, list[int], int]:
    """Samples in whole blocks, none across a pause; first places of the parts, size of a block."""
    pauses = find_pauses(stage.time)
    together = -(-stage.time.size // (_WITHIN * MOST_BLOCKS))
    size = sum(part.size // together for part in np.split(stage.time, pauses))
    per_block = -(-size // MOST_BLOCKS)

    times, frictions, firsts, count = [], [], [], 0
    for time, friction in zip(
        np.split(stage.time, pauses), np.split(stage.friction, pauses), strict=True
    ):
        kept = time.size // (together * per_block) * together * per_block
        if not kept:
            continue
        # averaged where the samples are many more than the blocks
        inner = np.arange(0, kept, together)
        times.append(_average(time[:kept], inner))
        frictions.append(_average(friction[:kept], inner))
        firsts.append(count)
        count += inner.size
    return np.concatenate(times), np.concatenate(frictions), firsts, per_block


def _average(values: Array, starts: AnyArray) -> Array:
    """Mean of each block of samples, all of one size, along the first axis."""
    return np.asarray(values.reshape(starts.size, -1, *values.shape[1:]).mean(axis=1))


@dataclass(frozen=True)
class Candidate:
    """A rise that may be galling.

    Attributes
    ----------
    record : int
        Place of its stage.
    onset : float
        Time at which it begins. [s]
    rise : float
        Its time constant. [s]
    """

    record: int
    onset: float
    rise: float


def explain(records: Sequence[BlockRecord], candidate: Candidate | None) -> list[BlockRecord]:
    """Put a candidate into the background of its stage."""
    explained = [*records]
    if candidate is not None:
        record = records[candidate.record]
        explained[candidate.record] = record.with_rise(candidate.onset, candidate.rise)
    return explained


def rises(time: Array, onsets: Array, constant: float) -> Array:
    """Draw rises of unit height, one column for each onset."""
    lag = time[:, None] - onsets[None, :]
    if constant == 0:
        return (lag >= 0).astype(float)
    return -np.expm1(-np.maximum(lag, 0) / constant)


def forms(time: Array, onsets: Array) -> Iterator[Array]:
    """Draw the forms of the rise: a step, exponentials, and ramps."""
    for constant in (0.0, *EXPONENTIALS):
        yield rises(time, onsets, constant)
    lag = np.maximum(time[:, None] - onsets[None, :], 0.0)
    for duration in RAMPS:
        yield np.minimum(lag / duration, 1.0)


def fit_rises(rises: Array, values: Array, spread: NoiseSpread) -> tuple[Array, Array, Array]:
    """Fit each of many rises to values, both whitened and without the background.

    Returns the norm of each rise, infinite where the background explains it altogether; the
    amplitude of the rise of unit norm; and the sum of squares that is left, with that of `spread`.
    """
    norm = np.sqrt(np.einsum("ij,ij->j", rises, rises))
    norm = np.where(norm > _COLLINEAR, norm, np.inf)
    amplitude = values @ rises / norm
    left = float(values @ values) + spread.power - amplitude**2
    return norm, amplitude, np.maximum(left, np.finfo(float).tiny)


def without(basis: Array, values: Array) -> Array:
    """Compute what is left of values when the columns of an orthonormal basis are fitted."""
    return np.asarray(values - basis @ (basis.T @ values))
