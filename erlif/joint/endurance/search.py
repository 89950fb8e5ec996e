"""Search for galling: a sudden rise of friction that running-in, drift and load do not explain.

Within a stage friction is a level, running-in that decays, a slow drift and correlated noise. A
rise is tested at every place of every stage by generalised least squares, and the p-value counts
the places (Hunter 1976; Worsley 1982). The variance of a stage is estimated with the help of the
others (Smyth 2004). A rise must stand out from the falls of the same test, and a part of it must
last.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri, owens_t, stdtr

from erlif.core.arrays import Array
from erlif.joint.endurance.blocks import (
    BlockRecord,
    Candidate,
    LogClock,
    StageFriction,
    explain,
    find_pauses,
    fit_rises,
    rises,
    without,
)
from erlif.joint.endurance.disturbances import local_scale
from erlif.joint.endurance.noise import Noise, NoiseSpread, fit_noise, pool_spreads, whiten
from erlif.joint.endurance.onset import Onset, locate_onset

# Time constants of the rise in the search for an onset; 0 is a step. [s]
SCANNED = (0.0, 10.0, 40.0)

# Samples of a stage that is searched, for each part between pauses of the log.
#
# A rise and four columns, and as many degrees of freedom.
FEWEST = 12

_MARGIN = 3  # blocks at the start of a stage in which no onset is searched
_END = 6  # the same at its end: fewer high ones may be a disturbance that recovers
_MOST_TRANSIENTS = 8  # rises that recover
_TRANSIENT = (3, 10, 20.0)  # blocks, at least and at most, and time in which a rise recovers [s]
_PLACES = 5.0  # near the best rise, at which it may also begin
_UNLIKE = 1.5  # power of the excess: noise that is not normal has unlike extremes
_CHANCE_FALL = 0.3  # probability of a fall up to which it is ordinary
_ROUNDS = 4  # of noise and candidate, which depend on each other


@dataclass(frozen=True)
class OnsetSearch:
    """Result of a search for galling.

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
    records = [BlockRecord.of(stages[k], longest) for k in usable]

    # the rise itself must not count as noise: noise and candidate are found in turn
    interval = float(np.median(np.concatenate([np.diff(record.time) for record in records])))
    candidate: Candidate | None = None
    for _ in range(_ROUNDS):
        known = explain(records, candidate)
        stages_fit = [(one.time, one.background, one.friction) for one in known]
        noise = fit_noise(stages_fit, interval=interval)
        chosen, *_ = _best_rise(records, noise)
        if chosen == candidate:
            break
        candidate = chosen

    # what the noise does not describe
    known = explain(records, candidate)
    records = [
        replace(record, scale=_local_scale(one, noise))
        for record, one in zip(records, known, strict=True)
    ]
    for _ in range(_MOST_TRANSIENTS):
        found = _most_likely(records, noise)
        start, place = found.scan.onset, found.place
        left = records[place].time.size - records[place].background.shape[1] - _TRANSIENT[1]
        if found.p_value > significance or found.lasting <= significance or left < FEWEST:
            break
        records[place] = records[place].without_samples(start, start + _transient(interval))
    p_value = min(max(found.p_value, found.lasting), 1.0)
    if p_value > significance:
        return OnsetSearch(None, p_value, noise, left_out, least_rise=least_rise)
    onset = locate_onset(records[place], noise, found.spread, found.scan.deviation, usable[place])
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
    statistics: tuple[Array, ...]
    lowest: float


@dataclass(frozen=True)
class _Found:
    """The best rise of a test, its p-value, and that of the part of it which lasts."""

    place: int
    scan: _Scan
    spread: NoiseSpread
    p_value: float
    lasting: float


def _transient(interval: float) -> float:
    """Recovery time of a rise that is a disturbance and not galling. [s]"""
    least, most, time = _TRANSIENT
    return float(np.clip(time, least * interval, most * interval))


def _best_rise(
    records: Sequence[BlockRecord], noise: Noise
) -> tuple[Candidate, list[_Scan], list[NoiseSpread]]:
    """Search all stages for the best rise; return also their scans and variances."""
    spreads = pool_spreads([_spread(record, noise) for record in records])
    scans = [_scan(record, noise, spread) for record, spread in zip(records, spreads, strict=True)]
    place = max(range(len(scans)), key=lambda k: scans[k].statistic)
    return Candidate(place, scans[place].onset, scans[place].rise), scans, spreads


def _most_likely(records: Sequence[BlockRecord], noise: Noise) -> _Found:
    """Compute the p-values of the best rise of all stages."""
    candidate, scans, spreads = _best_rise(records, noise)
    place, known = candidate.record, explain(records, candidate)
    best = scans[place]
    rest = [_scan(record, noise, spread) for record, spread in zip(known, spreads, strict=True)]
    excess = max(_excess(rest)[SCANNED.index(best.rise)], _fall(rest)) ** _UNLIKE
    level = _normal_quantile(best, excess)
    p_value = min(1.0, sum(_exceedance(level, scan.correlation) for scan in scans))
    interval = float(np.median(np.diff(records[place].time)))
    decay = records[place].with_decay(best.onset, _transient(interval))
    lasting = _scan_with(
        decay,
        noise,
        spreads[place],
        best.deviation,
        onsets=np.array([best.onset]),
        constants=(0.0,),
    )
    chance = _PLACES * float(stdtr(lasting.freedom, -lasting.statistic / excess))
    return _Found(place, best, spreads[place], p_value, chance)


def _local_scale(record: BlockRecord, noise: Noise) -> Array:
    """Scatter of a stage near each block over the ordinary one, about its background."""
    factor = noise.factor(record.time)
    basis = np.linalg.qr(whiten(factor, record.background))[0]
    return local_scale(without(basis, whiten(factor, record.friction)))


def _excess(scans: Sequence[_Scan]) -> list[float]:
    """Scatter of the statistics of each form of rise over that of normal noise; at least 1."""
    forms = zip(*(scan.statistics for scan in scans), strict=True)
    pooled = [np.concatenate(form) for form in forms]
    return [max(1.0, float(np.sqrt(np.mean(one[np.isfinite(one)] ** 2)))) for one in pooled]


def _spread(record: BlockRecord, noise: Noise) -> NoiseSpread:
    """Variance of a stage about its background."""
    columns = np.column_stack([record.background, record.friction])
    whitened = record.whiten(noise.factor(record.time), columns)
    triangle = np.asarray(np.linalg.qr(whitened, mode="r"))
    freedom = max(record.time.size - record.background.shape[1], 1)
    return NoiseSpread(max(float(triangle[-1, -1] ** 2) / freedom, np.finfo(float).tiny), freedom)


def _scan(record: BlockRecord, noise: Noise, spread: NoiseSpread) -> _Scan:
    # the usual size of drift and running-in is known in units of the noise
    first = _scan_with(record, noise, spread, np.inf)
    return _scan_with(record, noise, spread, first.deviation)


def _scan_with(
    record: BlockRecord,
    noise: Noise,
    spread: NoiseSpread,
    deviation: float,
    *,
    onsets: Array | None = None,
    constants: Sequence[float] = SCANNED,
) -> _Scan:
    """Scan a stage whose noise has about this standard deviation."""
    factor = noise.factor(record.time)
    columns = record.whiten(factor, np.column_stack([record.background, record.friction]))
    columns = np.vstack([columns, record.usual_rows(deviation)])
    basis = np.linalg.qr(columns[:, :-1])[0]
    values = without(basis, columns[:, -1])
    freedom = record.time.size - basis.shape[1] - 1 + spread.freedom

    if onsets is None:
        onsets = record.samples[record.starts][_MARGIN:-_END]
    statistics, units, smallest = [], [], np.inf
    for constant in constants:
        shapes = record.average(rises(record.samples, onsets, constant))
        shapes = np.vstack(
            [record.whiten(factor, shapes), np.zeros((record.usual.size, onsets.size))]
        )
        shapes = without(basis, shapes)
        norm, size, left = fit_rises(shapes, values, spread)
        smallest = min(smallest, float(left.min()))
        statistics.append(np.where(np.isfinite(norm), size / np.sqrt(left / freedom), -np.inf))
        units.append(shapes / norm)

    best = int(np.argmax(statistics))
    constant, place = divmod(best, onsets.size)
    return _Scan(
        statistic=float(statistics[constant][place]),
        freedom=freedom,
        onset=float(onsets[place]),
        rise=constants[constant],
        deviation=float(np.sqrt(smallest / freedom)),
        correlation=_tree(units),
        statistics=tuple(statistics),
        lowest=-float(max(np.max(-one[np.isfinite(one)], initial=0.0) for one in statistics)),
    )


def _tree(rises: Sequence[Array]) -> Array:
    """Correlation of each statistic, but the first, with the most similar one before it."""
    sums = [np.einsum("ij,ij->j", rises[0][:, 1:], rises[0][:, :-1])]
    for slower, faster in zip(rises[1:], rises[:-1], strict=True):
        along = np.einsum("ij,ij->j", slower[:, :-1], slower[:, 1:])
        across = np.einsum("ij,ij->j", slower, faster)
        sums.append(np.maximum(across, np.append(along, -1.0)))
    return np.asarray(np.clip(np.concatenate(sums), -1.0, 1.0))


def _fall(scans: Sequence[_Scan]) -> float:
    """Largest fall of friction over the one expected by chance, at least 1."""
    lowest = min(range(len(scans)), key=lambda k: scans[k].lowest)
    falls = replace(scans[lowest], statistic=-scans[lowest].lowest)

    def chance(level: float) -> float:
        return sum(_exceedance(level, scan.correlation) for scan in scans) - _CHANCE_FALL

    return max(1.0, _normal_quantile(falls, 1.0) / float(brentq(chance, 0.0, 10.0)))


def _normal_quantile(scan: _Scan, excess: float) -> float:
    """Convert a t statistic to the normal deviate of the same tail probability."""
    tail = max(float(stdtr(scan.freedom, -scan.statistic / excess)), np.finfo(float).tiny)
    return float(-ndtri(tail))


def _exceedance(level: float, correlation: Array) -> float:
    """Bound of the probability that one of many correlated normal deviates exceeds a level.

    Hunter (1976) and Worsley (1982): a sum over a tree, each deviate with one before it. Owen's T
    gives the probability that one exceeds the level and the one before it does not.
    """
    slope = np.sqrt((1 - correlation) / np.maximum(1 + correlation, np.finfo(float).eps))
    return float(ndtr(-level) + 2 * owens_t(level, slope).sum())
