"""Onset of galling: a sudden rise of friction that running-in, drift and load do not explain.

Within a stage friction is a level, running-in that decays, a slow drift and correlated noise. A
rise is tested at every place of every stage by generalised least squares, and the p-value counts
the places (Hunter 1976; Worsley 1982). The interval of the onset is that of its posterior, over
forms of the rise and changes of the noise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtr, ndtri, owens_t, stdtr

from erlif.core.arrays import AnyArray, Array
from erlif.endurance.noise import Noise, StageFit, fit_noise, whiten

MOST_BLOCKS = 300
"""Blocks into which the samples of a stage are averaged; the work grows as the cube of it."""

RUNNING_IN = (1 / 20, 1 / 5)
"""Time constants of running-in, as shares of the longest stage; two span those between."""

SCANNED = (0.0, 10.0, 40.0)
"""Time constants of the rise in the search for an onset; 0 is a step. [s]"""

EXPONENTIALS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.0, 16.0, 23.0, 32.0, 64.0)
"""Time constants of the rise in the posterior. [s]"""

RAMPS = (1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.0, 16.0, 23.0, 32.0, 64.0)
"""Durations of a straight rise in the posterior. [s]"""

GROWTHS = (1.0, 1.4, 2.0, 2.8)
"""Noise after the onset over that before it. [1]"""

USUAL = (0.05, 0.05, 0.05)
"""Standard deviations of drift in the longest stage and of both parts of running-in. [1]

In a short stage a rise could else be offset by a huge running-in against a huge drift.
"""

FEWEST = 12
"""Samples of a stage that is searched: a rise, four columns, and as many degrees of freedom."""

INTERVAL = (0.025, 0.5, 0.975)
"""Quantiles of the onset."""

_MARGIN = 3  # blocks at both ends of a stage in which no onset is searched
_ROUNDS = 4  # of noise and candidate, which depend on each other
_FINE = 8  # places of the posterior in a sample interval
_WITHIN = 8  # samples in a block; more are averaged, as the work grows with them
_MOST_PLACES = 240  # of the posterior, where it is wide
_FAR = 15.0  # logarithm of a density beyond which it is nothing
_COLLINEAR = 1e-6  # norm of a rise that the background explains altogether


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
class Onset:
    """The onset of galling.

    Attributes
    ----------
    time : float
        Median of the posterior. [s]
    earliest : float
        Start of the interval that holds the onset with a probability of 95 %. [s]
    latest : float
        End of that interval. [s]
    stage : int
        Place of its stage among those that were given, from 0.
    friction_before : float
        Friction coefficient just before. [1]
    rise : float
        Rise of friction up to the end of the stage. [1]
    rise_std : float
        Its standard deviation. [1]
    places : Array
        Times of the posterior. [s]
    weights : Array
        Their probabilities. [1]
    """

    time: float
    earliest: float
    latest: float
    stage: int
    friction_before: float
    rise: float
    rise_std: float
    places: Array = field(repr=False, compare=False)
    weights: Array = field(repr=False, compare=False)


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
    """

    onset: Onset | None
    p_value: float
    noise: Noise
    left_out: tuple[int, ...] = ()


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
    usable = [k for k, stage in enumerate(stages) if stage.time.size >= FEWEST]
    left_out = tuple(k for k in range(len(stages)) if k not in usable)
    if not usable:
        return OnsetSearch(None, 1.0, Noise(1.0, 1.0), left_out)
    longest = max(stages[k].time[-1] - stages[k].time[0] for k in usable)
    records = [_Record.of(stages[k], longest) for k in usable]

    # the rise itself must not count as noise: noise and candidate are found in turn
    interval = float(np.median(np.concatenate([np.diff(record.time) for record in records])))
    candidate: _Candidate | None = None
    for _ in range(_ROUNDS):
        noise = fit_noise(_fits(records, candidate), interval=interval)
        scans = [_scan(record, noise) for record in records]
        place = max(range(len(scans)), key=lambda k: scans[k].statistic)
        found = _Candidate(place, scans[place].onset, scans[place].rise)
        if found == candidate:
            break
        candidate = found

    level = _normal_quantile(scans[place])
    p_value = min(1.0, sum(_exceedance(level, scan.correlation) for scan in scans))
    if p_value > significance:
        return OnsetSearch(None, p_value, noise, left_out)
    onset = _posterior(records[place], noise, scans[place].deviation, usable[place])
    return OnsetSearch(onset if onset.rise >= least_rise else None, p_value, noise, left_out)


# stages as blocks


@dataclass(frozen=True)
class _Candidate:
    record: int
    onset: float
    rise: float


@dataclass(frozen=True)
class _Record:
    """A stage whose samples are averaged into blocks."""

    samples: Array
    starts: AnyArray
    time: Array
    friction: Array
    background: Array

    @classmethod
    def of(cls, stage: StageFriction, longest: float) -> _Record:
        time, friction = _thinned(stage)
        per_block = int(np.ceil(time.size / MOST_BLOCKS))
        kept = time.size // per_block * per_block
        samples, starts = time[:kept], np.arange(0, kept, per_block)

        # level, drift, and running-in of any time constant between those two
        passed = samples - samples[0]
        columns = [np.ones_like(passed), passed / longest]
        columns += [np.exp(-passed / (share * longest)) for share in RUNNING_IN]
        return cls(
            samples,
            starts,
            _average(samples, starts),
            _average(friction[:kept], starts),
            _average(np.column_stack(columns), starts),
        )

    def average(self, values: Array) -> Array:
        return _average(values, self.starts)


def _thinned(stage: StageFriction) -> tuple[Array, Array]:
    """Time and friction, averaged where the samples are many more than the blocks."""
    together = int(np.ceil(stage.time.size / (_WITHIN * MOST_BLOCKS)))
    if together == 1:
        return stage.time, stage.friction
    kept = stage.time.size // together * together
    starts = np.arange(0, kept, together)
    return _average(stage.time[:kept], starts), _average(stage.friction[:kept], starts)


def _average(values: Array, starts: AnyArray) -> Array:
    """Mean of each block of samples, all of one size, along the first axis."""
    return np.asarray(values.reshape(starts.size, -1, *values.shape[1:]).mean(axis=1))


def _rises(time: Array, onsets: Array, constant: float) -> Array:
    """Rises of unit height, one column for each onset."""
    lag = time[:, None] - onsets[None, :]
    if constant == 0:
        return (lag >= 0).astype(float)
    return -np.expm1(-np.maximum(lag, 0) / constant)


def _fits(records: Sequence[_Record], candidate: _Candidate | None) -> list[StageFit]:
    """What the noise is fitted to: the stages, with the candidate as a column of its stage."""
    fits = []
    for k, record in enumerate(records):
        columns = record.background
        if candidate is not None and candidate.record == k:
            rise = _rises(record.samples, np.array([candidate.onset]), candidate.rise)
            columns = np.column_stack([columns, record.average(rise)])
        fits.append((record.time, columns, record.friction))
    return fits


# search


@dataclass(frozen=True)
class _Scan:
    """The best rise of a stage, and how the statistics of all its rises are correlated."""

    statistic: float
    freedom: int
    onset: float
    rise: float
    deviation: float
    correlation: Array


def _scan(record: _Record, noise: Noise) -> _Scan:
    # the usual size of drift and running-in is known in units of the noise
    scan, deviation = _scan_with(record, noise, np.inf)
    return _scan_with(record, noise, deviation)[0] if np.isfinite(deviation) else scan


def _scan_with(record: _Record, noise: Noise, deviation: float) -> tuple[_Scan, float]:
    """Scan a stage whose noise has this standard deviation, and estimate that."""
    factor = noise.factor(record.time)
    columns = whiten(factor, np.column_stack([record.background, record.friction]))
    columns = np.vstack([columns, _usual_rows(deviation)])
    basis = np.linalg.qr(columns[:, :-1])[0]
    values = _without(basis, columns[:, -1])
    total = float(values @ values)
    freedom = record.time.size - basis.shape[1] - 1

    onsets = record.samples[record.starts][_MARGIN:-_MARGIN]
    statistics, rises, smallest = [], [], total
    for constant in SCANNED:
        shapes = record.average(_rises(record.samples, onsets, constant))
        shapes = np.vstack([whiten(factor, shapes), np.zeros((len(USUAL), onsets.size))])
        shapes = _without(basis, shapes)
        norm = np.sqrt(np.einsum("ij,ij->j", shapes, shapes))
        usable = norm > _COLLINEAR
        shapes /= np.where(usable, norm, 1.0)
        size = values @ shapes
        left = np.maximum(total - size**2, np.finfo(float).tiny)
        smallest = min(smallest, float(left.min()))
        statistics.append(np.where(usable, size / np.sqrt(left / freedom), -np.inf))
        rises.append(shapes)

    best = int(np.argmax(statistics))
    constant, place = divmod(best, onsets.size)
    scan = _Scan(
        statistic=float(statistics[constant][place]),
        freedom=freedom,
        onset=float(onsets[place]),
        rise=SCANNED[constant],
        deviation=float(np.sqrt(smallest / freedom)),
        correlation=_tree(rises),
    )
    return scan, scan.deviation


def _usual_rows(deviation: float) -> Array:
    """Rows of the fit by which drift and running-in are of their usual size."""
    rows = np.zeros((len(USUAL), len(USUAL) + 2))
    if np.isfinite(deviation):
        rows[:, 1:-1] = np.diag(deviation / np.array(USUAL))
    return rows


def _without(basis: Array, values: Array) -> Array:
    """What is left of values when the columns of an orthonormal basis are fitted."""
    return np.asarray(values - basis @ (basis.T @ values))


def _tree(rises: Sequence[Array]) -> Array:
    """Correlation of each statistic, but the first, with the most similar one before it."""
    found = [np.einsum("ij,ij->j", rises[0][:, 1:], rises[0][:, :-1])]
    for slower, faster in zip(rises[1:], rises[:-1], strict=True):
        along = np.einsum("ij,ij->j", slower[:, :-1], slower[:, 1:])
        across = np.einsum("ij,ij->j", slower, faster)
        found.append(np.maximum(across, np.append(along, -1.0)))
    return np.asarray(np.clip(np.concatenate(found), -1.0, 1.0))


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


# posterior


def _posterior(record: _Record, noise: Noise, deviation: float, stage: int) -> Onset:
    """The onset with its interval, over forms of the rise and growth of the noise."""
    factor = noise.factor(record.time)
    step = float(np.median(np.diff(record.time)))
    coarse = _beside_samples(
        np.arange(record.samples[0] + step / 2, record.samples[-1], step), record.samples, step
    )
    density = _log_density(record, factor, deviation, coarse, growths=(1.0,))[0].max(axis=(0, 1))
    near = np.flatnonzero(density > density.max() - _FAR)
    low, high = coarse[max(near[0] - 2, 0)], coarse[min(near[-1] + 2, coarse.size - 1)]

    # between two samples a sharp onset can be anywhere: the grid is finer than the samples
    sample = float(np.median(np.diff(record.samples)))
    fine = max(sample / _FINE, (high - low) / _MOST_PLACES)
    places = np.arange(low, high + fine, fine)
    logarithm, size, error = _log_density(record, factor, deviation, places, growths=GROWTHS)
    joint = np.exp(logarithm - logarithm.max())
    joint /= joint.sum()

    weights = joint.sum(axis=(0, 1))
    edges = np.append(places - fine / 2, places[-1] + fine / 2)
    earliest, middle, latest = np.interp(INTERVAL, np.append(0.0, np.cumsum(weights)), edges)
    rise = float((joint * size).sum())
    spread = float((joint * (error**2 + (size - rise) ** 2)).sum())
    before = record.samples < earliest
    last = record.friction[record.time < max(earliest, record.time[_MARGIN])][-_MARGIN * 5 :]
    return Onset(
        time=float(middle),
        earliest=float(earliest),
        latest=float(latest),
        stage=stage,
        friction_before=float(np.median(last)) if before.any() else float("nan"),
        rise=rise,
        rise_std=float(np.sqrt(spread)),
        places=places,
        weights=weights,
    )


def _beside_samples(places: Array, samples: Array, reach: float) -> Array:
    """Places with a sample within reach: in the pause of a logger all onsets look alike."""
    after = np.searchsorted(samples, places)
    distance = np.minimum(places - samples[after - 1], samples[after] - places)
    return np.asarray(places[distance <= reach])


def _forms(time: Array, onsets: Array) -> Iterator[Array]:
    """Forms of the rise: a step, exponentials, and ramps."""
    lag = np.maximum(time[:, None] - onsets[None, :], 0.0)
    yield (time[:, None] >= onsets[None, :]).astype(float)
    for constant in EXPONENTIALS:
        yield -np.expm1(-lag / constant)
    for duration in RAMPS:
        yield np.minimum(lag / duration, 1.0)


def _log_density(
    record: _Record, factor: Array, deviation: float, onsets: Array, *, growths: Sequence[float]
) -> tuple[Array, Array, Array]:
    """Logarithm of the posterior density, rise up to the end of the stage and its std.

    All are arrays (growth, form, onset). Amplitude, background and variance are integrated out:
    level, amplitude and the logarithm of the variance have flat priors, drift and running-in those
    of `USUAL`; an amplitude is positive.
    """
    forms = np.stack([record.average(form) for form in _forms(record.samples, onsets)])
    ends = forms[:, -1, :]
    shape = (len(growths), forms.shape[0], onsets.size)
    logarithm, size, error = np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape)
    n, p = record.background.shape
    freedom = n - p - 1

    # the growth of the noise begins with a block, so that onsets in one block share the work
    first = np.searchsorted(record.samples[record.starts], onsets)
    fixed = np.column_stack([record.background, record.friction])
    usual = _usual_rows(deviation)
    for a, growth in enumerate(growths):
        for block in np.unique(first):
            at = np.flatnonzero(first == block)
            scale = np.where(np.arange(n) >= block, growth, 1.0)
            many = forms[:, :, at].transpose(1, 0, 2).reshape(n, -1)
            columns = whiten(factor, np.column_stack([fixed, many]) / scale[:, None])
            columns = np.vstack([columns, np.pad(usual, ((0, 0), (0, many.shape[1])))])
            basis, triangle = np.linalg.qr(columns[:, :p])
            rest = _without(basis, columns[:, p:])
            values, rises = rest[:, 0], rest[:, 1:]

            norm = np.sqrt(np.einsum("ij,ij->j", rises, rises))
            usable = norm > _COLLINEAR
            norm = np.where(usable, norm, 1.0)
            amplitude = (values @ rises) / norm
            left = np.maximum(values @ values - amplitude**2, np.finfo(float).tiny)
            deviation = np.sqrt(left / freedom)
            found = -0.5 * freedom * np.log(left) - np.log(norm) - np.log(scale).sum()
            found -= np.log(np.abs(np.diagonal(triangle))).sum()
            positive = stdtr(freedom, amplitude / deviation)
            found += np.log(np.maximum(positive, np.finfo(float).tiny))

            end = ends[:, at].ravel()
            cells = (forms.shape[0], at.size)
            logarithm[a][:, at] = np.where(usable, found, -np.inf).reshape(cells)
            size[a][:, at] = (amplitude / norm * end).reshape(cells)
            error[a][:, at] = (deviation / norm * end).reshape(cells)
    return logarithm, size, error
