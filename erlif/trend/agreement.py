"""Agreement of the film with theory and with speed: its ratio to a formula, correlation, delay."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.trend.exponent import LEAST_TRIGGERS

_LEAST_SPREAD = 0.05  # of the logarithm of the speed, below which no correlation is determined
_95 = 1.96  # standard deviations of a 95 % interval
_FEWEST_COUNTED = 4.0  # triggers that count as independent, at least
_ONE = 1 - 1e-12  # correlation whose area tangent is finite
_MEDIAN = math.sqrt(math.pi / 2)  # std of a median over that of a mean, normal errors

# Farthest triggers of a cycle that has a delay, and the largest delay looked for: |speed| has two
# maxima in a cycle. [degree]
_GAP, _LATEST = 90.0, 90.0
# Error of a cubic in the middle of a gap between triggers whose slopes are known, of a sine, over
# the fourth power of the gap.
_CUBIC = 1 / 384
# Gain in chi-square by the speed from which it is no chance among 37 delays. Other smooth courses
# reach it too; the speed has to explain half of the variance about the trend as well.
_GAIN = 20.0
_MOST_ALIKE = 0.95  # correlation of neighbouring residuals above which it is not determined [1]
_DETERMINED = 20.0  # largest standard deviation of a delay that is stated [degree]


class Factor(NamedTuple):
    """Film over theory, over the triggers of a run.

    Attributes
    ----------
    value : float
        Median. [1]
    std_random, std_shared : float
        Its standard deviation by what is new at every trigger, and by what all share. [1]
    low, high : float
        Smallest and largest ratio. [1]
    outward, back : float
        Medians of the two strokes; NaN where there is one direction alone. [1]
    """

    value: float
    std_random: float
    std_shared: float
    low: float
    high: float
    outward: float
    back: float

    @property
    def std(self) -> float:
        """Standard deviation by both. [1]"""
        return math.hypot(self.std_random, self.std_shared)


class Correlation(NamedTuple):
    """Correlation of the film with a speed.

    Attributes
    ----------
    rank : float
        Spearman's coefficient of the measured films. [1]
    log : float
        Pearson's coefficient of the logarithms. [1]
    log_low, log_high : float
        95 % interval of this coefficient for the true film. [1]
    """

    rank: float
    log: float
    log_low: float
    log_high: float


def film_factor(
    ratio: Array, random_std: Array, std: Array, *, stroke: Array | None = None
) -> Factor:
    """Median of the film over a theory, with its errors.

    Parameters
    ----------
    ratio, random_std, std : array, (trigger,)
        Film over theory, the random part of its standard deviation, and all of it; NaN where there
        is none, or the speed is below a tenth of the highest. [1]
    stroke : array, (trigger,), optional
        +1 outward, -1 back.

    Returns
    -------
    Factor
        NaN without a trigger.

    Examples
    --------
    >>> ones = np.ones(9)
    >>> found = film_factor(5 * ones, 0.3 * ones, 0.5 * ones)
    >>> found.value, round(found.std_random, 3), round(found.std_shared, 3)
    (5.0, 0.125, 0.4)
    """
    use = np.isfinite(ratio) & np.isfinite(std)
    if not use.any():
        return Factor(*(math.nan,) * 7)
    random = _MEDIAN * float(np.sqrt(np.mean(random_std[use] ** 2) / use.sum()))
    shared = float(np.median(np.sqrt(np.maximum(std[use] ** 2 - random_std[use] ** 2, 0.0))))
    strokes = np.zeros(len(ratio)) if stroke is None else stroke
    ways = [ratio[use & (strokes == way)] for way in (1, -1)]
    both = [float(np.median(way)) if way.size else math.nan for way in ways]
    low, high = float(ratio[use].min()), float(ratio[use].max())
    return Factor(float(np.median(ratio[use])), random, shared, low, high, *both)


def correlate(film: Array, random_std: Array, speed: Array) -> Correlation:
    """Correlation of the film with a speed over the triggers.

    Noise of the film lowers the coefficients (Spearman 1904). The interval of 95 % is that of the
    true film, for which the loss is made good, over other triggers of the same motion (Fisher
    1921): neighbours that are alike count as fewer (Bartlett 1935). It is all of -1 to 1 where the
    film is constant within its noise.

    Parameters
    ----------
    film, random_std : array, (trigger,)
        Film and the random part of its standard deviation; NaN is left out. [um]
    speed : array, (trigger,)
        Speed, or speed over load; its sign does not matter.

    Returns
    -------
    Correlation
        NaN with fewer than five triggers, or a speed that hardly varies.

    Examples
    --------
    >>> speed = np.linspace(0.2, 2.5, 20)
    >>> found = correlate(3.0 * speed**0.62, np.full(20, 0.01), speed)
    >>> round(found.rank, 3), round(found.log, 3), found.log_low > 0.99
    (1.0, 1.0, True)
    """
    size = np.abs(speed)
    use = (film > 0) & np.isfinite(random_std) & (size > 0)
    if use.sum() < LEAST_TRIGGERS or np.std(np.log(size[use])) < _LEAST_SPREAD:
        return Correlation(*(math.nan,) * 4)
    x, y = np.log(size[use]), np.log(film[use])
    if np.ptp(y) == 0:
        return Correlation(0.0, 0.0, -1.0, 1.0)
    error = random_std[use] / film[use]
    rank, log = (float(np.corrcoef(*pair)[0, 1]) for pair in ((_ranks(x), _ranks(y)), (x, y)))
    noise, variance = float(np.mean(error**2)), float(np.var(y, ddof=1))
    true = variance - noise
    if true < 2 * noise * math.sqrt(2 / len(y)):  # no change beyond the noise
        return Correlation(rank, log, -1.0, 1.0)

    # without the loss by noise, and its effect to first order
    share = noise / true
    middle = min(max(log * math.sqrt(variance / true), -1.0), 1.0)
    spread = _95 * math.sqrt((share * (1 - middle**2) + 0.5 * (middle * share) ** 2) / len(y))
    alike = max(_lag_one(x) * _lag_one(y), 0.0)
    count = max(len(y) * (1 - alike) / (1 + alike), _FEWEST_COUNTED)
    about, reach = math.atanh(max(min(middle, _ONE), -_ONE)), _95 / math.sqrt(count - 3)
    low = max(min(middle - spread, math.tanh(about - reach)), -1.0)
    high = min(max(middle + spread, math.tanh(about + reach)), 1.0)
    return Correlation(rank, log, low, high)


def _lag_one(values: Array) -> float:
    """Correlation of neighbours."""
    away = values - values.mean()
    return float(away[1:] @ away[:-1] / (away @ away))


def _alike(residual: Array) -> float:
    """Correlation of neighbours among residuals of a fit, from 0, without its loss by the fit.

    The loss of n values about their mean is (1 + 4 r)/n to first order.
    """
    if not residual.any():
        return 0.0
    found = _lag_one(residual)
    return min(max(found + (1 + 4 * found) / len(residual), 0.0), _MOST_ALIKE)


def _ranks(values: Array) -> Array:
    """Places in the order of the values; equal ones share their mean."""
    _, place, count = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(count) - (count - 1) / 2)[place])


def find_delay(film: Array, speed: Array, angle: Array) -> tuple[float, float]:
    """Delay of the film behind the size of the speed, in degrees of the drive.

    The film is fitted by a + b |v(angle - delay)| + c n with the measured speed, a periodic spline
    between the triggers n: a film that sinks has no delay by that. The error follows from the
    scatter about the fit, of which neighbours that are alike count as fewer (Bartlett 1935), and
    from the error of the spline in the widest gap between triggers.

    Parameters
    ----------
    film : array, (trigger,)
        NaN is left out. [um]
    speed : array, (trigger,)
        With its sign.
    angle : array, (trigger,)
        Of the drive, 0 to 360. [degree]

    Returns
    -------
    delay, std : float
        Positive where the film is late. NaN where triggers do not cover the cycle, the speed or the
        film hardly changes, or the error is above 20 degrees. [degree]

    Examples
    --------
    >>> angle = np.arange(0.0, 360.0, 10.0)
    >>> film = 3 + np.abs(np.sin(np.radians(angle - 15.0)))
    >>> [round(one) for one in find_delay(film, np.sin(np.radians(angle)), angle)]
    [15, 0]
    """
    unknown = math.nan, math.nan
    use = np.isfinite(film)
    if use.sum() < LEAST_TRIGGERS or not np.ptp(np.abs(speed)) > 0:
        return unknown
    phase, first = np.unique(angle, return_index=True)
    closed = np.append(phase, phase[0] + 360.0)
    gap = float(np.diff(closed).max())
    if gap > _GAP:
        return unknown
    spline = scipy.interpolate.CubicSpline(
        closed, np.append(speed[first], speed[first[0]]), bc_type="periodic"
    )
    number = np.flatnonzero(use) / film.size
    rest = np.stack([np.ones_like(number), number])

    def fit(delay: float) -> tuple[float, float]:
        """Mean square about the fit at a delay, and its b."""
        shapes = np.vstack([np.abs(spline(angle[use] - delay)), rest])
        amplitudes, residual = _fit_shapes(shapes, film[use])
        return float(np.mean(residual**2)), float(amplitudes[0])

    # the film of a joint rises with the speed; the best of a grid is refined
    grid = np.arange(-_LATEST, _LATEST + 1, 5.0)
    squares = [square if slope > 0 else math.inf for square, slope in map(fit, grid)]
    best = float(grid[int(np.argmin(squares))])
    search = scipy.optimize.minimize_scalar
    found = search(lambda one: fit(one)[0], bounds=(best - 5, best + 5), method="bounded")
    delay = float(found.x)

    # neighbours that are alike count as fewer triggers
    before, at, after = (np.abs(spline(angle[use] - delay + step)) for step in (1.0, 0.0, -1.0))
    shapes = np.vstack([at, rest])
    amplitudes, residual = _fit_shapes(shapes, film[use])
    slope, square, free = float(amplitudes[0]), float(np.mean(residual**2)), use.sum() - 4
    alike = _alike(residual)
    wider = (1 + alike) / (1 - alike)

    explained = float(np.mean(_fit_shapes(rest, film[use])[1] ** 2)) - square
    gain = max(_GAIN * wider, free)
    if slope <= 0 or abs(best) == _LATEST or explained * free < gain * square:
        return unknown

    # change of the fitted film with the delay, as far as the other amplitudes do not follow it
    bend = _fit_shapes(shapes, slope * (after - before) / 2)[1]
    scatter = wider * square * use.sum() / free / float(bend @ bend)

    # the share gap/360 of a cycle has the error of the spline
    by_gap = math.degrees(_CUBIC * math.radians(gap) ** 4) * gap / 360
    std = math.hypot(math.sqrt(scatter), by_gap)
    return (delay, std) if std < _DETERMINED else unknown


def _fit_shapes(shapes: Array, values: Array) -> tuple[Array, Array]:
    """Least-squares amplitudes of shapes, (shape, value), and what they leave of the values."""
    amplitudes = np.asarray(np.linalg.lstsq(shapes.T, values, rcond=None)[0], float)
    return amplitudes, values - amplitudes @ shapes
