"""The power of speed over load that the film follows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array

SLOWEST = 0.1
"""Triggers below this share of the top speed are left out of the speed exponent."""


@dataclass(frozen=True)
class Exponent:
    """Power of |speed|/load that the film follows, with its standard deviation and the film at the mean."""

    value: float
    std: float
    log_scale: float
    triggers: int


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

    Triggers slower than a tenth of the fastest are left out: there the film lives on squeeze. The scatter about the line
    decides the weights together with the error bars, and what bends or shifts all films alike adds its share to the standard
    deviation.

    Parameters
    ----------
    film, random_std : array, (trigger,)
        Film and the part of its standard deviation that each trigger has for itself. [um]
    speed, load : array, (trigger,)
        [rad s-1], [N]
    gradient : array, (trigger, n), optional
        Change of the film with what all triggers share: the parameters of the calibration, the marks of the surfaces.
    covariance : array, (n, n), optional
        Of what they share.

    Returns
    -------
    Exponent
        NaN where fewer than five triggers can be used.
    """
    fast = np.abs(speed) >= SLOWEST * np.abs(speed).max()
    use = fast & (film > 0) & np.isfinite(film) & np.isfinite(random_std)
    if use.sum() < 5:
        return Exponent(math.nan, math.nan, math.nan, int(use.sum()))
    x = np.log(np.abs(speed[use]) / load[use])
    y = np.log(film[use])
    own = random_std[use] / film[use]
    design = np.column_stack([np.ones_like(x), x])
    excess = 0.0
    for _ in range(20):
        weight = 1 / (own**2 + excess)
        normal = design.T @ (design * weight[:, None])
        line = np.linalg.solve(normal, design.T @ (weight * y))
        residual = y - design @ line
        chi_square = float((weight * residual**2).sum()) / (x.size - 2)
        if abs(chi_square - 1) < 1e-3 or (chi_square < 1 and excess == 0.0):
            break
        # scatter that the error bars do not explain is taken as the same share of each film
        excess = max(excess + (chi_square - 1) / float(weight.mean()), 0.0)
    inverse = np.linalg.inv(normal)
    variance = float(inverse[1, 1])
    if gradient is not None and covariance is not None:
        change = inverse @ design.T @ (weight[:, None] * (gradient[use] / film[use, None]))
        variance += float(change[1] @ covariance @ change[1])
    return Exponent(float(line[1]), math.sqrt(variance), float(line[0]), int(use.sum()))
