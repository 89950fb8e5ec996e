"""Standard deviation of the predicted minima by the errors of viscosity, load and clearance."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.prediction.given import GivenErrors
from erlif.prediction.start import INSENSITIVE

# Relative change from which derivatives are computed, above the jumps of a film whose cells change
# to cavities.
_STEP = 0.01


def find_band(
    minima: Callable[..., Array],
    start_film: float,
    given: GivenErrors,
    *,
    clearance: float,
    full: bool,
    weight: Array | None = None,
) -> Array:
    """Standard deviation of the predicted minima by the errors of what is given.

    The film is followed once more with each of them changed. A film without cavities depends on
    time times load over viscosity alone, so that the change by the viscosity is that by the load.
    Where cavities form, at a pressure that does not change with either, the load has a film of its
    own. A fitted start film is fitted anew: it takes up a part of each error, to first order.

    Parameters
    ----------
    minima : callable
        Start film [m], and by keyword viscosity, load and clearance over those of the joint, to the
        minimum films. [m]
    start_film : float
        [m]
    given : GivenErrors
    clearance : float
        Radial clearance of the joint. [m]
    full : bool
        Whether the film has no cavities.
    weight : array, optional
        Of the logarithm of each minimum in the fit of the start film. Default: it is given.

    Returns
    -------
    array
        As `minima` returns; NaN where a changed film cannot be followed. [m]

    Examples
    --------
    A film that is proportional to viscosity and clearance:

    >>> def minima(start, *, viscosity=1.0, clearance=1.0):
    ...     return start * viscosity * clearance * np.ones(2)
    >>> given = GivenErrors(viscosity=0.04, clearance=3e-6)
    >>> band = find_band(minima, 5e-6, given, clearance=100e-6, full=True)
    >>> (1e6 * band).round(3)
    array([0.25, 0.25])
    """
    here, more = np.log(minima(start_film)), 1 + _STEP
    sizes = {"viscosity": given.viscosity, "load": given.load}
    if full:
        sizes = {"viscosity": math.hypot(*sizes.values())}
    sizes["clearance"] = given.clearance / clearance
    errors = {name: size for name, size in sizes.items() if size}

    def change(film: Array) -> Array:
        return np.asarray((np.log(film) - here) / math.log(more))

    try:
        with ThreadPoolExecutor() as pool:
            later = pool.map(lambda name: minima(start_film, **{name: more}), errors)
            causes = [
                size * change(film) for size, film in zip(errors.values(), later, strict=True)
            ]
        if weight is not None and causes:
            slope = change(minima(more * start_film))
            curvature = float(weight @ slope**2)
            if curvature > INSENSITIVE**2 * float(weight.sum()):
                causes = [one - slope * float(weight @ (slope * one)) / curvature for one in causes]
    except ModelError:
        return np.full_like(here, np.nan)
    return np.asarray(np.exp(here) * np.sqrt(sum((one**2 for one in causes), np.zeros_like(here))))
