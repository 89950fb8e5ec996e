"""Onset of galling: its posterior within the stage in which friction rises.

It goes over forms of the rise and changes of the noise. Level, running-in and drift of the stage
are integrated out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import stdtr

from erlif.core.arrays import Array
from erlif.joint.endurance.blocks import BlockRecord, LogClock, fit_rises, forms, without
from erlif.joint.endurance.noise import Noise, NoiseSpread, whiten

# Noise after the onset over that before it. [1]
GROWTHS = (1.0, 1.4, 2.0, 2.8)

# Quantiles of the onset.
INTERVAL = (0.025, 0.5, 0.975)

_FINE = 8  # places of the posterior in a sample interval
_MOST_PLACES = 240  # of the posterior, where it is wide
_FAR = 15.0  # logarithm of a density beyond which it is nothing
_FEWEST_BEFORE = 3  # blocks before the onset to which the background is fitted


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
        Friction coefficient just before, with its running-in and drift fitted. [1]
    rise : float
        Rise of friction up to the end of the stage. [1]
    rise_std : float
        Its standard deviation. [1]
    places : Array
        Times of the posterior; those in a pause of the log stand for all of it. [s]
    weights : Array
        Their probabilities. [1]
    pause : tuple[float, float] | None
        The pause of the log that the interval holds, if any: its first and last moment. [s]
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
    pause: tuple[float, float] | None = None


def locate_onset(
    record: BlockRecord,
    noise: Noise,
    spread: NoiseSpread,
    deviation: float,
    stage: int,
) -> Onset:
    """Compute the onset with its interval.

    Parameters
    ----------
    record : BlockRecord
        The stage.
    noise : Noise
        Noise of the test.
    spread : NoiseSpread
        What is known of the variance from the other stages.
    deviation : float
        Standard deviation of the noise, in which drift and running-in are of their usual size. [1]
    stage : int
        Place of the stage, for the result.

    Returns
    -------
    Onset
    """
    clock = LogClock.of(record.samples)
    samples = clock.logged(record.samples)
    step = float(np.median(np.diff(record.time)))
    factor = noise.factor(record.time)

    # a coarse look for the stretch that matters
    coarse = np.arange(samples[0] + step / 2, samples[-1], step)
    look = _log_density(record, factor, spread, deviation, clock.real(coarse), growths=(1.0,))
    density = look[0].max(axis=(0, 1))
    near = np.flatnonzero(density > density.max() - _FAR)
    low, high = coarse[max(near[0] - 2, 0)], coarse[min(near[-1] + 2, coarse.size - 1)]

    # between two samples a sharp onset can be anywhere: the grid is finer than the samples
    fine = max(clock.interval / _FINE, (high - low) / _MOST_PLACES)
    places = np.arange(low, high + fine, fine)
    logarithm, size, error = _log_density(
        record, factor, spread, deviation, clock.real(places), growths=GROWTHS
    )
    joint = np.exp(logarithm - logarithm.max())
    joint /= joint.sum()

    weights = joint.sum(axis=(0, 1))
    edges = np.append(places - fine / 2, places[-1] + fine / 2)
    quantiles = np.interp(INTERVAL, np.append(0.0, np.cumsum(weights)), edges)
    earliest, middle, latest, pause = clock.hold_gaps(*clock.real(quantiles).tolist())
    rise = float((joint * size).sum())
    spread_of_rise = float((joint * (error**2 + (size - rise) ** 2)).sum())
    return Onset(
        time=middle,
        earliest=earliest,
        latest=latest,
        stage=stage,
        friction_before=_level_before(record, factor, deviation, earliest),
        rise=rise,
        rise_std=float(np.sqrt(spread_of_rise)),
        places=clock.real(places),
        weights=weights,
        pause=pause,
    )


def _level_before(record: BlockRecord, factor: Array, deviation: float, earliest: float) -> float:
    """Friction at the last block before the onset: the background, fitted to all before it.

    A median of these would hold the running-in, which an early onset has not left behind.
    """
    n = int(np.searchsorted(record.time, earliest, side="right"))
    if n < _FEWEST_BEFORE:
        return float(np.median(record.friction[:_FEWEST_BEFORE]))

    # the factor of the first blocks is the first block of the factor
    fixed = np.column_stack([record.background, record.friction])[:n]
    fixed = fixed / record.scale[:n, None]
    rows = np.vstack([whiten(factor[:n, :n], fixed), record.usual_rows(deviation)])
    background, *_ = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=None)
    return float(record.background[n - 1] @ background)


def _log_density(
    record: BlockRecord,
    factor: Array,
    spread: NoiseSpread,
    deviation: float,
    onsets: Array,
    *,
    growths: Sequence[float],
) -> tuple[Array, Array, Array]:
    """Logarithm of the posterior density, rise up to the end of the stage and its std.

    All are arrays (growth, form, onset). Amplitude, background and variance are integrated out:
    level, amplitude and the logarithm of the variance have flat priors, drift and running-in those
    of `BlockRecord.usual`; an amplitude is positive.
    """
    shapes = np.stack([record.average(form) for form in forms(record.samples, onsets)])
    ends = shapes[:, -1, :]
    shape = (len(growths), shapes.shape[0], onsets.size)
    logarithm, size, error = np.full(shape, -np.inf), np.zeros(shape), np.zeros(shape)
    n, p = record.background.shape
    freedom = n - p - 1 + spread.freedom

    # the growth of the noise begins with a block, so that onsets in one block share the work
    first = np.searchsorted(record.samples[record.starts], onsets)
    fixed = np.column_stack([record.background, record.friction])
    usual = record.usual_rows(deviation)
    for a, growth in enumerate(growths):
        for block in np.unique(first):
            at = np.flatnonzero(first == block)
            scale = record.scale * np.where(np.arange(n) >= block, growth, 1.0)
            many = shapes[:, :, at].transpose(1, 0, 2).reshape(n, -1)
            columns = whiten(factor, np.column_stack([fixed, many]) / scale[:, None])
            columns = np.vstack([columns, np.pad(usual, ((0, 0), (0, many.shape[1])))])
            basis, triangle = np.linalg.qr(columns[:, :p])
            rest = without(basis, columns[:, p:])
            values, rises = rest[:, 0], rest[:, 1:]

            norm, amplitude, left = fit_rises(rises, values, spread)
            scatter = np.sqrt(left / freedom)
            found = -0.5 * freedom * np.log(left) - np.log(norm) - np.log(scale).sum()
            found -= np.log(np.abs(np.diagonal(triangle))).sum()
            positive = stdtr(freedom, amplitude / scatter)
            found += np.log(np.maximum(positive, np.finfo(float).tiny))

            end = ends[:, at].ravel()
            cells = (shapes.shape[0], at.size)
            logarithm[a][:, at] = found.reshape(cells)
            size[a][:, at] = (amplitude / norm * end).reshape(cells)
            error[a][:, at] = (scatter / norm * end).reshape(cells)
    return logarithm, size, error
