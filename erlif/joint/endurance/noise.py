"""Correlated noise of friction: its covariance, the fit of its two parameters, its variance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import cholesky, solve_triangular, toeplitz
from scipy.special import digamma, polygamma

from erlif.core.arrays import Array

# Correlation times at which the fit may start. [sample interval]
_STARTS = (0.3, 1.0, 3.0, 10.0, 30.0)

# Bounds of the correlation time; beyond them noise is white, or drift. [sample interval]
_CORRELATION_TIMES = (0.1, 300.0)

# Largest share of white noise; beyond it the correlation time has no meaning. [1]
_MOST_WHITE = 0.95

_FIRST_STEPS = np.array([[0.4, 0.0], [0.0, 0.1]])

# Accuracy of the fit: a fraction of its standard deviation, which is above 0.1.
_SHARP = 0.02

_MOST_STEPS = 80

# Steps of the sizes of factors that are kept for stages of almost equal length.
_SIZES = 64

# Jitter of the samples below which their times count as equally spaced. [sample interval]
_REGULAR = 1e-2


@dataclass(frozen=True)
class Noise:
    """Noise of friction: a part that is forgotten exponentially, and white noise.

    Attributes
    ----------
    correlation_time : float
        Time in which the correlation falls to 1/e. [s]
    white : float
        Share of the variance that is white. [1]
    """

    correlation_time: float
    white: float

    def factor(self, time: Array) -> Array:
        """Lower Cholesky factor of the correlation matrix of samples at these times."""
        steps = np.diff(time)
        interval = float(np.median(steps)) if steps.size else 1.0
        if np.all(np.abs(steps - interval) < _REGULAR * interval):
            # a leading block of a factor is the factor of the leading block
            size = -(-time.size // _SIZES) * _SIZES
            return _regular_factor(self, interval, size)[: time.size, : time.size]
        lag = np.abs(time[:, None] - time[None, :])
        return self._factor(np.exp(-lag / self.correlation_time))

    def _factor(self, correlation: Array) -> Array:
        matrix = (1 - self.white) * correlation
        matrix[np.diag_indices(len(matrix))] = 1.0
        return np.asarray(cholesky(matrix, lower=True, overwrite_a=True, check_finite=False))


@lru_cache(maxsize=8)
def _regular_factor(noise: Noise, interval: float, size: int) -> Array:
    return noise._factor(toeplitz(np.exp(-interval * np.arange(size) / noise.correlation_time)))


def whiten(factor: Array, values: Array) -> Array:
    """Turn values, or columns of a matrix, into ones with uncorrelated noise of equal variance.

    Parameters
    ----------
    factor : array, (n, n)
        From `Noise.factor`.
    values : array, (n,) or (n, m)

    Returns
    -------
    array
        Of the shape of `values`.

    Examples
    --------
    >>> white = whiten(Noise(10.0, 0.0).factor(np.arange(4.0)), np.ones(4))
    >>> print(np.round(white, 3))
    [1.    0.224 0.224 0.224]
    """
    return np.asarray(solve_triangular(factor, values, lower=True, check_finite=False))


# Times (n,), columns that are fitted freely (n, p), and values (n,) of a stage.
StageFit = tuple[Array, Array, Array]


def restricted_likelihood(noise: Noise, stages: Sequence[StageFit]) -> float:
    """Compute the logarithm of the restricted likelihood of a noise.

    The restricted likelihood allows for the columns that were fitted: without it noise that is
    correlated over a good part of a stage seems shorter than it is. Each stage has a variance of
    its own.

    Parameters
    ----------
    noise : Noise
    stages : sequence of StageFit

    Returns
    -------
    float
        Up to a constant.

    Examples
    --------
    Values that alternate are no noise with a long memory:

    >>> time = np.arange(50.0)
    >>> stage = (time, np.ones((50, 1)), (-1.0) ** time)
    >>> short, long = (restricted_likelihood(Noise(t, 0.0), [stage]) for t in (0.3, 30.0))
    >>> short > long
    True
    """
    total = 0.0
    for time, design, values in stages:
        factor = noise.factor(time)
        columns = whiten(factor, np.column_stack([design, values]))
        diagonal = np.abs(np.diagonal(np.linalg.qr(columns, mode="r")))

        # the last entry of the triangle is the root of the residual sum of squares
        free = time.size - design.shape[1]
        left = max(diagonal[-1], np.finfo(float).tiny)
        total -= np.log(np.diagonal(factor)).sum() + np.log(diagonal[:-1]).sum()
        total -= free * np.log(left)
    return float(total)


def fit_noise(stages: Sequence[StageFit], *, interval: float) -> Noise:
    """Fit correlation time and white share by the largest restricted likelihood.

    Parameters
    ----------
    stages : sequence of StageFit
    interval : float
        Interval of the samples. [s]

    Returns
    -------
    Noise

    Examples
    --------
    >>> rng = np.random.default_rng(3)
    >>> time = np.arange(300.0)
    >>> values = Noise(8.0, 0.0).factor(time) @ rng.standard_normal(300)
    >>> noise = fit_noise([(time, np.ones((300, 1)), values)], interval=1.0)
    >>> 5 < noise.correlation_time < 13
    True
    """
    from scipy.optimize import minimize

    def make(x: Array) -> Noise:
        return Noise(float(np.exp(x[0])) * interval, float(x[1]))

    def cost(x: Array) -> float:
        return -restricted_likelihood(make(x), stages)

    low, high = np.log(_CORRELATION_TIMES)
    starts = [np.array([np.log(time), white]) for time in _STARTS for white in (0.0, 0.3)]
    start = min(starts, key=cost)
    minimum = minimize(
        cost,
        start,
        method="Nelder-Mead",
        bounds=[(low, high), (0.0, _MOST_WHITE)],
        options={
            "xatol": _SHARP,
            "fatol": _SHARP,
            "maxfev": _MOST_STEPS,
            "initial_simplex": [start, start + _FIRST_STEPS[0], start + _FIRST_STEPS[1]],
        },
    )
    return make(minimum.x)


_FEWEST = 2  # other stages that show how unlike stages are
_NEWTON_STEPS = 8


@dataclass(frozen=True)
class NoiseSpread:
    """A variance, and the number of independent values that it is worth.

    Attributes
    ----------
    variance : float
        Variance of the noise. [1]
    freedom : float
        Degrees of freedom; 0 where nothing is known.
    """

    variance: float
    freedom: float

    @property
    def power(self) -> float:
        """The sum of squares of these values."""
        return self.variance * self.freedom


# Nothing is known of the variance.
UNKNOWN = NoiseSpread(1.0, 0.0)


def pool_spreads(spreads: Sequence[NoiseSpread]) -> list[NoiseSpread]:
    """Estimate the variance of each stage from the other stages.

    Variances of stages scatter about a common one. How much they do follows from the scatter of
    their logarithms beyond that of few samples (Smyth 2004), and gives the degrees of
    freedom that the others are worth: all of theirs where the stages are alike, few where not.

    Parameters
    ----------
    spreads : sequence of NoiseSpread
        Variance of each stage.

    Returns
    -------
    list of NoiseSpread
        For each stage that of the others; `UNKNOWN` where there are fewer than two of them.

    Examples
    --------
    Stages that are alike are worth all of their samples, unlike ones hardly any:

    >>> alike = pool_spreads([NoiseSpread(2.0, 50.0)] * 4)[0]
    >>> print(f"{alike.variance:.2f} of {alike.freedom:.0f}")
    2.03 of 150
    >>> unlike = pool_spreads([NoiseSpread(2.0**k, 50.0) for k in range(-4, 5, 2)])[0]
    >>> unlike.freedom < 5
    True
    """
    if len(spreads) <= _FEWEST:
        return [UNKNOWN] * len(spreads)
    return [combine_spreads([*spreads[:k], *spreads[k + 1 :]]) for k in range(len(spreads))]


def combine_spreads(spreads: Sequence[NoiseSpread]) -> NoiseSpread:
    """Estimate the common variance of stages, worth less the more unlike they are."""
    half = np.array([spread.freedom / 2 for spread in spreads])
    logs = np.log([spread.variance for spread in spreads]) - digamma(half) + np.log(half)
    unlike = float(np.var(logs, ddof=1) - np.mean(polygamma(1, half)))

    # stages that are quite alike know no more than their samples do
    most = float(2 * half.sum())
    freedom = min(2 * _inverse_trigamma(unlike), most) if unlike > 0 else most
    level = float(np.mean(logs) + digamma(freedom / 2) - np.log(freedom / 2))
    return NoiseSpread(float(np.exp(level)), freedom)


def _inverse_trigamma(value: float) -> float:
    """Invert the trigamma function by Newton's method on its reciprocal (Smyth 2004)."""
    x = 0.5 + 1 / value
    for _ in range(_NEWTON_STEPS):
        trigamma = float(polygamma(1, x))
        x += trigamma * (1 - trigamma / value) / float(polygamma(2, x))
    return x
