"""Errors of the mean and of the change of friction over a log, whose values are correlated.

Friction that changes over several pairs of stretches leaves fewer independent values than pairs.
The scatter about a straight line is that of an autoregressive process of the first order and white
noise. Its correlation and the share of the noise are not estimated once but averaged, weighted by
their restricted likelihood (Harville, J. Am. Stat. Assoc. 72 (1977) 320): few pairs hold little of
a long correlation, and one best value of it would be too short.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtr, stdtrit

from erlif.core.arrays import Array

_CORRELATIONS = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97])
# a prior between one even over the correlation of neighbours and one even over its arcsine
_WIDTHS = np.gradient(_CORRELATIONS) / (1 - _CORRELATIONS**2) ** 0.25
_NOISES = (0.0, 0.3, 0.6)  # shares of white noise in the variance
_WHITE = 0.3  # prior share of no correlation at all
_VALUES = 40  # more of them are averaged in blocks
_FEWEST = 4  # values from which on a straight line is taken off
_LEVELS = (0.682689, 0.95)


@dataclass(frozen=True)
class Spread:
    """Half widths of intervals about an estimate.

    Attributes
    ----------
    std : float
        Half width of the interval of 68 %, with Student's factor.
    wide : float
        Half width of that of 95 %; more than 1.96 `std` where few values are independent.
    """

    std: float
    wide: float


def spread_of_line(time: Array, values: Array) -> tuple[Spread, Spread]:
    """Compute the errors of the mean and of the change of a correlated series.

    Parameters
    ----------
    time : array, (n,)
        Times, rising. [s]
    values : array, (n,)
        Two values or more. [any unit]

    Returns
    -------
    tuple of Spread
        Of the mean, and of the change from the first to the last value by a straight line by least
        squares; NaN for the change of two values.

    Examples
    --------
    Ten values whose sign changes every second one are not correlated over the series:

    >>> mean, change = spread_of_line(np.arange(10.0), np.tile([1.0, -1.0], 5))
    >>> 0.3 < mean.std < 0.6 < mean.wide
    True
    """
    blocks = min(values.size, _VALUES)
    time = np.array([part.mean() for part in np.array_split(time, blocks)])
    values = np.array([part.mean() for part in np.array_split(values, blocks)])
    away = (time - time.mean()) / (time[-1] - time[0])

    mean = np.full(blocks, 1 / blocks)
    line = np.column_stack([np.ones(blocks), away])
    found = _spread(time, values, line if blocks >= _FEWEST else line[:, :1], mean)
    if blocks < 3:
        return found, Spread(np.nan, np.nan)
    return found, _spread(time, values, line, away / (away @ away))


def _spread(time: Array, values: Array, design: Array, estimate: Array) -> Spread:
    """Half widths for the sum of the values with the weights `estimate`."""
    size, unknowns = design.shape
    correlation, prior = _correlations(time)

    # restricted likelihood of each correlation, free of mean and slope
    inverse = np.linalg.inv(correlation)
    seen = inverse @ design
    normal = np.swapaxes(design.T @ seen, 1, 2)
    left = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    moved = np.linalg.solve(normal, (left @ seen)[..., None])[..., 0]
    residual = left @ inverse @ left - np.sum(moved * (left @ seen), axis=1)
    residual = np.maximum(residual, (1e-14 * np.max(np.abs(values))) ** 2 + 1e-300)
    free = size - unknowns
    chance = np.log(prior) - 0.5 * free * np.log(residual)
    chance -= 0.5 * (np.linalg.slogdet(correlation)[1] + np.linalg.slogdet(normal)[1])
    weight = np.exp(chance - chance.max())
    weight /= weight.sum()

    # each correlation gives a distribution of Student; the sum of them has the wanted share
    scale = np.sqrt(residual / free * (estimate @ correlation @ estimate))

    def half_width(level: float) -> float:
        tail = 0.5 * (1 - level)
        largest = float(scale.max() * stdtrit(free, 1 - tail))
        return float(
            brentq(lambda half: float(weight @ stdtr(free, -half / scale)) - tail, 0, 2 * largest)
        )

    return Spread(*(half_width(level) for level in _LEVELS))


def _correlations(time: Array) -> tuple[Array, Array]:
    """Correlation matrices that are tried, and their prior weights."""
    size = time.size
    apart = np.abs(time[:, None] - time) / np.median(np.diff(time))
    slow = _CORRELATIONS[:, None, None] ** apart
    white = np.eye(size)
    matrices = np.concatenate([[white], *((1 - part) * slow + part * white for part in _NOISES)])
    share = (1 - _WHITE) * np.tile(_WIDTHS / _WIDTHS.sum(), len(_NOISES)) / len(_NOISES)
    return matrices, np.append(_WHITE, share)
