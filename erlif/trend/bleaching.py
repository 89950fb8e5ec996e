"""Dyes that bleach: light and ratio at equal film, against the number of the pulse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, Array

_FEWEST = 6  # degrees of freedom of the scatter about the lines, at least


@dataclass(frozen=True)
class Trend:
    """Change of light and ratio with every pulse, at equal film.

    Attributes
    ----------
    log_ratio : float
        Change of the logarithm of the ratio per pulse. [1]
    log_ratio_std : float
        Its standard deviation. [1]
    light : float
        Change of the logarithm of the light of camera 1 per pulse and energy; NaN where the energy
        of the pulses is not known. [1]
    light_std : float
        Its standard deviation. [1]
    """

    log_ratio: float
    log_ratio_std: float
    light: float
    light_std: float

    def significant(self) -> bool:
        """Whether the trend of ratio or light exceeds three standard deviations."""
        ratio = abs(self.log_ratio) > 3 * self.log_ratio_std
        return ratio or abs(self.light) > 3 * self.light_std


def fit_trend(
    pulse: Array,
    group: AnyArray,
    log_ratio: Array,
    light: Array,
) -> Trend | None:
    """Lines through light and ratio of frames with equal film.

    Parameters
    ----------
    pulse : array, (frame,)
        Number of the pulse.
    group : array of int, (frame,)
        Frames of one group have the same film: those of a trigger, or all for a reference patch.
    log_ratio : array, (frame, place)
        Logarithm of the ratio; NaN where it was not measured. [1]
    light : array, (frame, place)
        Logarithm of light over pulse energy; NaN without. [ln DN]

    Returns
    -------
    Trend or None
        None with fewer than 6 frames more than groups.

    Examples
    --------
    >>> pulse = np.arange(20.0)
    >>> rng = np.random.default_rng(1)
    >>> ratio = 0.3 - 1e-3 * pulse[:, None] + 1e-4 * rng.standard_normal((20, 5))
    >>> found = fit_trend(pulse, np.zeros(20, int), ratio, np.full((20, 5), np.nan))
    >>> round(found.log_ratio, 4), bool(np.isnan(found.light))
    (-0.001, True)
    """
    ratio = _slope(pulse, group, log_ratio)
    if ratio is None:
        return None
    dimmed = _slope(pulse, group, light) or (float("nan"), float("nan"))
    return Trend(*ratio, *dimmed)


def _slope(pulse: Array, group: AnyArray, values: Array) -> tuple[float, float] | None:
    """Slope over the pulses, with its standard deviation from the scatter of the frames."""
    known = np.isfinite(values)
    names, member = np.unique(group, return_inverse=True)

    # means of each group and place; a place that is missing in one frame leaves it alone
    count = np.zeros((names.size, values.shape[1]))
    total, pulses = np.zeros_like(count), np.zeros_like(count)
    filled = np.where(known, values, 0.0)
    np.add.at(count, member, known)
    np.add.at(total, member, filled)
    np.add.at(pulses, member, known * pulse[:, None])
    safe = np.maximum(count, 1)
    change = np.where(known, values - (total / safe)[member], 0.0).sum(axis=1)
    turn = np.where(known, pulse[:, None] - (pulses / safe)[member], 0.0).sum(axis=1)
    places = known.sum(axis=1)
    some = places > 0
    freedom = int(some.sum()) - np.unique(member[some]).size - 1
    if freedom < _FEWEST:
        return None

    x, y = turn[some] / places[some], change[some] / places[some]
    square = float((x**2).sum())
    if square == 0:
        return None
    slope = float((x * y).sum()) / square
    scatter = float(((y - slope * x) ** 2).sum()) / freedom
    return slope, float(np.sqrt(scatter / square))
