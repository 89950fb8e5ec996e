"""The power of speed over load that the film follows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array, Mask

# Triggers below this share of the top speed are left out of the speed exponent.
SLOWEST = 0.1

# Share of the region beyond the measurable range above which a mean is that of another place: a
# trigger with more has no part in the power of the mean film.
LARGEST_BEYOND = 0.02

_LEAST_RANGE = 0.1  # range of the logarithm of speed over load below which there is no power to fit

LEAST_TRIGGERS = 5  # triggers of a fit of two parameters and a scatter, at least


@dataclass(frozen=True)
class Exponent:
    """Power of |speed|/load that the film follows.

    Attributes
    ----------
    value : float
        The power. [1]
    std : float
        Its standard deviation. [1]
    log_scale : float
        Logarithm of the film in um at a speed over load of 1 rad s-1 N-1.
    triggers : int
        Triggers of the fit.
    """

    value: float
    std: float
    log_scale: float
    triggers: int


def fast_triggers(speed: Array) -> Mask:
    """Find the triggers above a tenth of the highest speed: squeeze carries the film below.

    Parameters
    ----------
    speed : array, (trigger,)
        Its sign does not matter.

    Returns
    -------
    array of bool, (trigger,)

    Examples
    --------
    >>> fast_triggers(np.array([-2.0, 0.1, 1.0])).tolist()
    [True, False, True]
    """
    size = np.abs(speed)
    return np.asarray(size >= SLOWEST * np.nanmax(size, initial=0.0))


def fit_exponent(
    film: Array,
    random_std: Array,
    *,
    speed: Array,
    load: Array,
    gradient: Array | None = None,
    covariance: Array | None = None,
) -> Exponent:
    """Fit film = c (|speed|/load)^n through its logarithms.

    Triggers slower than a tenth of the fastest are left out: squeeze carries the film there. The
    weights follow from the error bars and the scatter about the line together. Errors common to all
    triggers add their share to the standard deviation.

    Parameters
    ----------
    film, random_std : array, (trigger,)
        Film and the random part of its standard deviation. [um]
    speed, load : array, (trigger,)
        [rad s-1], [N]
    gradient : array, (trigger, n), optional
        Change of the film with what all triggers share: the parameters of the calibration, the
        marks of the surfaces.
    covariance : array, (n, n), optional
        Covariance of what they share.

    Returns
    -------
    Exponent
        NaN where fewer than five triggers can be used, or speed over load hardly varies.

    Examples
    --------
    >>> speed = np.linspace(0.2, 2.5, 20)
    >>> found = fit_exponent(
    ...     3.0 * (speed / 200.0) ** 0.62, np.full(20, 0.01), speed=speed, load=np.full(20, 200.0)
    ... )
    >>> round(found.value, 6)
    0.62
    """
    use = fast_triggers(speed) & (film > 0) & np.isfinite(film) & np.isfinite(random_std)
    x = np.log(np.abs(speed[use]) / load[use])
    if x.size < LEAST_TRIGGERS or np.ptp(x) < _LEAST_RANGE:
        return Exponent(math.nan, math.nan, math.nan, int(use.sum()))
    y = np.log(film[use])
    own = random_std[use] / film[use]
    design = np.column_stack([np.ones_like(x), x])

    # scatter beyond the error bars is taken as the same relative share of each film
    excess = 0.0
    for _ in range(20):  # fixed-point iteration; it converges in a few steps
        weight = 1 / (own**2 + excess)
        normal = design.T @ (design * weight[:, None])
        line = np.linalg.solve(normal, design.T @ (weight * y))
        residual = y - design @ line
        chi_square = float((weight * residual**2).sum()) / (x.size - 2)
        if abs(chi_square - 1) < 1e-3 or (chi_square < 1 and excess == 0.0):
            break
        excess = max(excess + (chi_square - 1) / float(weight.mean()), 0.0)

    inverse = np.linalg.inv(normal)
    variance = float(inverse[1, 1])
    if gradient is not None and covariance is not None:
        change = inverse @ design.T @ (weight[:, None] * (gradient[use] / film[use, None]))
        variance += float(change[1] @ covariance @ change[1])
    return Exponent(float(line[1]), math.sqrt(variance), float(line[0]), int(use.sum()))


def mean_at_constant_minimum(displacement: Array, clearance: float, angle: Array) -> Array:
    """Mean film over a region, of a rigid gap that moves and keeps its minimum.

    The gap c - e cos(phi - beta) is wider away from its minimum: where the place of the minimum
    moves, the mean over a region that stays changes without a change of the film.

    Parameters
    ----------
    displacement : array, (trigger, 2)
        Of the pin, along the load and sideways. [um]
    clearance : float
        Radial clearance. [um]
    angle : array, (pixel,)
        Angles of the region from the load line. [rad]

    Returns
    -------
    array, (trigger,)
        At the median of the minima; NaN without a displacement. [um]

    Examples
    --------
    A minimum of 5 um in the middle of 20 mm and 5 mm beside it; R^2/c is 4.87 m:

    >>> angle, side = np.linspace(-10, 10, 401) / 33.475, 5 / 33.475
    >>> place = 225 * np.array([[1, 0], [np.cos(side), np.sin(side)]])
    >>> mean_at_constant_minimum(place, 230.0, angle).round(2)
    array([ 8.35, 10.82])
    """
    eccentricity, attitude = np.hypot(*displacement.T), np.arctan2(*displacement.T[::-1])

    # the minimum may lie beside the region, as that of the measured film
    nearest = np.clip(attitude, angle.min(), angle.max())
    across = np.cos(nearest - attitude)
    minimum = clearance - eccentricity * across
    if not np.isfinite(minimum).any():
        return np.full(len(minimum), np.nan)
    kept = (clearance - np.nanmedian(minimum)) / across
    return np.asarray(clearance - kept * np.cos(angle - attitude[:, np.newaxis]).mean(axis=1))
