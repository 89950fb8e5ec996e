"""Search for galling: a sudden rise of friction that running-in, drift and load do not explain.

Within a stage friction is a level, running-in that decays, a slow drift and correlated noise. A
rise is tested at every place of every stage by generalised least squares, and the p-value counts
the places (Hunter 1976; Worsley 1982). The variance of a stage is estimated with the help of the
others (Smyth 2004).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri, owens_t, stdtr

from erlif.core.arrays import Array
from erlif.joint.endurance.blocks import (
    Candidate,
    LogClock,
    Record,
    StageFriction,
    find_pauses,
    fits,
    rises,
    without,
)
from erlif.joint.endurance.noise import Noise, Spread, fit_noise, pool_spreads, whiten
from erlif.joint.endurance.onset import COLLINEAR, Onset, locate_onset

# Time constants of the rise in the search for an onset; 0 is a step. [s]
SCANNED = (0.0, 10.0, 40.0)

# Samples of a stage that is searched, for each part between pauses of the log.
#
# A rise and four columns, and as many degrees of freedom.
FEWEST = 12

_MARGIN = 3  # blocks at both ends of a stage in which no onset is searched
_ROUNDS = 4  # of noise and candidate, which depend on each other


@dataclass(frozen=True)
class OnsetSearch:
    """What a search for galling has found.

    Attributes
    ----------
    onset : Onset | None
        None where no rise is both significant and large enough.
    p_value : float
        Probability of as clear a rise anywhere in a test without galling. [1]
    noise : Noise
        Noise of friction in this test.
    left_out : tuple[int, ...]
        Places of the stages that are too short to be searched.
    small : Onset | None
        A significant rise that is below `least_rise`.
    least_rise : float
        Smallest rise of friction that is called galling. [1]
    """

    onset: Onset | None
    p_value: float
    noise: Noise
    left_out: tuple[int, ...] = ()
    small: Onset | None = None
    least_rise: float = 0.02


def find_onset(
    stages: Sequence[StageFriction], *, significance: float = 0.01, least_rise: float = 0.02
) -> OnsetSearch:
    """Search the stages of an endurance test for the onset of galling.

    Parameters
    ----------
    stages : sequence of StageFriction
        The stages under load, without idle runs. Levels may differ from stage to stage.
    significance : float
        Largest probability of a false alarm in a test. [1]
    least_rise : float
        Smallest rise of friction that is called galling. [1]

    Returns
    -------
    OnsetSearch

    Examples
    --------
    Friction of 0.15 that rises by 0.05 at 333 s, in noise with a memory of 10 s:

    >>> time = np.arange(0.0, 400.0, 2.0)
    >>> noise = Noise(10.0, 0.1).factor(time) @ np.random.default_rng(2).standard_normal(200)
    >>> friction = 0.15 + 0.004 * noise + np.where(time > 333, 0.05, 0.0)
    >>> found = find_onset([StageFriction(time, friction)])
    >>> found.p_value < 1e-6, found.onset.earliest < 333 < found.onset.latest
    (True, True)
    """
    usable = [
        k
        for k, stage in enumerate(stages)
        if stage.time.size >= FEWEST * (1 + find_pauses(stage.time).size)
    ]
    left_out = tuple(k for k in range(len(stages)) if k not in usable)
    if not usable:
        return OnsetSearch(None, 1.0, Noise(1.0, 1.0), left_out, least_rise=least_rise)
    longest = max(_duration(stages[k].time) for k in usable)
    records = [Record.of(stages[k], longest) for k in usable]

    # the rise itself must not count as noise: noise and candidate are found in turn
    interval = float(np.median(np.concatenate([np.diff(record.time) for record in records])))
    candidate: Candidate | None = None
    for _ in range(_ROUNDS):
        noise = fit_noise(fits(records, candidate), interval=interval)
        spreads = pool_spreads([_spread(record, noise) for record in records])
        scans = [
            _scan(record, noise, spread) for record, spread in zip(records, spreads, strict=True)
        ]
        place = max(range(len(scans)), key=lambda k: scans[k].statistic)
        chosen = Candidate(place, scans[place].onset, scans[place].rise)
        if chosen == candidate:
            break
        candidate = chosen

    level = _normal_quantile(scans[place])
    p_value = min(1.0, sum(_exceedance(level, scan.correlation) for scan in scans))
    if p_value > significance:
        return OnsetSearch(None, p_value, noise, left_out, least_rise=least_rise)
    onset = locate_onset(
        records[place], noise, spreads[place], scans[place].deviation, usable[place]
    )
    galls = onset.rise >= least_rise
    return OnsetSearch(
        onset if galls else None, p_value, noise, left_out, None if galls else onset, least_rise
    )


def _duration(time: Array) -> float:
    """Duration of a stage without the pauses of the log."""
    first, last = LogClock.of(time).logged(np.array([time[0], time[-1]]))
    return float(last - first)


@dataclass(frozen=True)
class _Scan:
    """The best rise of a stage, and how the statistics of all its rises are correlated."""

    statistic: float
    freedom: float
    onset: float
    rise: float
    deviation: float
    correlation: Array


def _spread(record: Record, noise: Noise) -> Spread:
    """Variance of a stage about its background."""
    columns = np.column_stack([record.background, record.friction])
    triangle = np.asarray(np.linalg.qr(whiten(noise.factor(record.time), columns), mode="r"))
    freedom = max(record.time.size - record.background.shape[1], 1)
    return Spread(max(float(triangle[-1, -1] ** 2) / freedom, np.finfo(float).tiny), freedom)


def _scan(record: Record, noise: Noise, spread: Spread) -> _Scan:
    # the usual size of drift and running-in is known in units of the noise
    scan = _scan_with(record, noise, spread, np.inf)
    if not np.isfinite(scan.deviation):
        return scan
    return _scan_with(record, noise, spread, scan.deviation)


def _scan_with(record: Record, noise: Noise, spread: Spread, deviation: float) -> _Scan:
    """Scan a stage whose noise has about this standard deviation."""
    factor = noise.factor(record.time)
    columns = whiten(factor, np.column_stack([record.background, record.friction]))
    columns = np.vstack([columns, record.usual_rows(deviation)])
    basis = np.linalg.qr(columns[:, :-1])[0]
    values = without(basis, columns[:, -1])
    total = float(values @ values) + spread.power
    freedom = record.time.size - basis.shape[1] - 1 + spread.freedom

    onsets = record.samples[record.starts][_MARGIN:-_MARGIN]
    statistics, units, smallest = [], [], total
    for constant in SCANNED:
        shapes = record.average(rises(record.samples, onsets, constant))
        shapes = np.vstack([whiten(factor, shapes), np.zeros((record.usual.size, onsets.size))])
        shapes = without(basis, shapes)
        norm = np.sqrt(np.einsum("ij,ij->j", shapes, shapes))
        usable = norm > COLLINEAR
        shapes /= np.where(usable, norm, 1.0)
        size = values @ shapes
        left = np.maximum(total - size**2, np.finfo(float).tiny)
        smallest = min(smallest, float(left.min()))
        statistics.append(np.where(usable, size / np.sqrt(left / freedom), -np.inf))
        units.append(shapes)

    best = int(np.argmax(statistics))
    constant, place = divmod(best, onsets.size)
    return _Scan(
        statistic=float(statistics[constant][place]),
        freedom=freedom,
        onset=float(onsets[place]),
        rise=SCANNED[constant],
        deviation=float(np.sqrt(smallest / freedom)),
        correlation=_tree(units),
    )


def _tree(rises: Sequence[Array]) -> Array:
    """Correlation of each statistic, but the first, with the most similar one before it."""
    sums = [np.einsum("ij,ij->j", rises[0][:, 1:], rises[0][:, :-1])]
    for slower, faster in zip(rises[1:], rises[:-1], strict=True):
        along = np.einsum("ij,ij->j", slower[:, :-1], slower[:, 1:])
        across = np.einsum("ij,ij->j", slower, faster)
        sums.append(np.maximum(across, np.append(along, -1.0)))
    return np.asarray(np.clip(np.concatenate(sums), -1.0, 1.0))


def _normal_quantile(scan: _Scan) -> float:
    """The normal deviate as improbable as the statistic, whose variance is estimated."""
    tail = max(float(stdtr(scan.freedom, -scan.statistic)), np.finfo(float).tiny)
    return float(-ndtri(tail))


def _exceedance(level: float, correlation: Array) -> float:
    """Bound of the probability that one of many correlated normal deviates exceeds a level.

    Hunter (1976) and Worsley (1982): a sum over a tree, each deviate with one before it. Owen's T
    gives the probability that one exceeds the level and the one before it does not.
    """
    slope = np.sqrt((1 - correlation) / np.maximum(1 + correlation, np.finfo(float).eps))
    return float(ndtr(-level) + 2 * owens_t(level, slope).sum())
