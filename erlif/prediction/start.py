"""The film at the first frame from which the predicted minima are nearest to the measured ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Predictions until the search ends; four are usual.
MOST_TRIALS = 12

# Relative change of the start film below which the search ends: below the error of the steps.
CONVERGED = 1e-3

# Bounds of the start film: a nanometre [m], and a share of the clearance.
_THINNEST, _THICKEST = 1e-9, 0.999

_LARGEST_STEP = 1.0  # largest change of the logarithm of the start film in one trial

# Change of the predicted films with the start film, relative, below which it is not determined.
INSENSITIVE = 1e-3


def find_start_film(
    predict: Callable[[float], Array],
    measured: Array,
    measured_std: Array,
    *,
    clearance: float,
    rough: Callable[[float], Array] | None = None,
) -> float:
    """Find the start film of the least squares.

    Parameters
    ----------
    predict : callable
        Start film [m] to the minimum film of each trigger. [m]
    measured, measured_std : array, (trigger,)
        Measured minimum film and its standard deviation; NaN where there is none. [m]
    clearance : float
        Radial clearance of the joint. [m]
    rough : callable, optional
        As `predict`, less exact and quicker: the search begins with it.

    Returns
    -------
    float
        Minimum film thickness at the first frame. [m]

    Raises
    ------
    ModelError
        If no film was measured.

    Examples
    --------
    Films that sink by a tenth from trigger to trigger:

    >>> sinking = 0.9 ** np.arange(4)
    >>> measured = 5e-6 * sinking
    >>> found = find_start_film(
    ...     lambda start: start * sinking, measured, 0.01 * measured, clearance=230e-6)
    >>> round(found * 1e6, 3)
    5.0
    """
    weight = log_weights(measured, measured_std)
    known = weight > 0
    if not known.any():
        raise ModelError(
            "Expected a measured minimum film from which to find the start film; no trigger has "
            'one. Give start_film = "20 um" in [prediction].'
        )
    film, weight = np.log(measured[known]), weight[known]
    low, high = np.log(_THINNEST), np.log(_THICKEST * clearance)

    def miss(follow: Callable[[float], Array], logarithm: float) -> Array:
        return film - np.log(follow(float(np.exp(logarithm)))[known])

    # the first film is the natural start; films scale with it unless something else carries them
    place = float(np.clip(film[0], low, high))
    slope = np.ones_like(film)
    for follow in (predict,) if rough is None else (rough, predict):
        off = miss(follow, place)
        cost, largest = float(weight @ off**2), _LARGEST_STEP
        for _ in range(1, MOST_TRIALS):
            curvature = float(weight @ slope**2)
            if curvature < INSENSITIVE**2 * float(weight.sum()):
                break
            step = float(np.clip(weight @ (slope * off) / curvature, -largest, largest))
            step = float(np.clip(place + step, low, high)) - place
            if abs(step) < CONVERGED:
                break

            # the change of the films along a step is the slope of the next, also where it misled
            there = miss(follow, place + step)
            slope, largest = (off - there) / step, abs(step) / 2
            if (reached := float(weight @ there**2)) < cost:
                place, off, cost, largest = place + step, there, reached, _LARGEST_STEP
    return float(np.exp(place))


def log_weights(measured: Array, measured_std: Array) -> Array:
    """Weights of the logarithms of films in the least squares, 0 where none is known.

    Parameters
    ----------
    measured, measured_std : array, (trigger,)
        As for `find_start_film`.

    Returns
    -------
    array, (trigger,)

    Examples
    --------
    >>> log_weights(np.array([5.0, np.nan]), np.array([0.1, 0.1]))
    array([2500.,    0.])
    """
    known = np.isfinite(measured) & (measured > 0) & np.isfinite(measured_std) & (measured_std > 0)
    return np.where(known, (measured / np.where(known, measured_std, 1.0)) ** 2, 0.0)
