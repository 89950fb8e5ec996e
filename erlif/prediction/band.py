"""Standard deviation of the predicted minima by the errors of viscosity, load and clearance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.prediction.given import GivenErrors
from erlif.prediction.start import INSENSITIVE

# Relative change of viscosity and clearance from which derivatives are computed, above the jumps of
# a film whose cells change to cavities; and changes of the start film that serve as well.
_STEP = 0.01
_BESIDE = 0.002, 0.1


def find_band(
    minima: Callable[..., Array],
    start_film: float,
    given: GivenErrors,
    *,
    clearance: float,
    full: bool,
    weight: Array | None = None,
    tried: Sequence[float] = (),
) -> Array:
    """Standard deviation of the predicted minima by the errors of what is given.

    One film more for each of them; but in a full film more load is less viscosity: there the film
    depends on time times load over viscosity alone. Cavities form at a pressure that neither
    changes. A fitted start film is fitted anew, so that the part of an error that it takes up is
    left out.

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
    tried : sequence of float, optional
        Start films whose minima are known. [m]

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
    try:
        with ThreadPoolExecutor() as pool:
            films = pool.map(lambda name: minima(start_film, **{name: more}), errors)
            causes = [
                size / math.log(more) * (np.log(film) - here)
                for size, film in zip(errors.values(), films, strict=True)
            ]
        if weight is not None and causes:
            low, high = _BESIDE
            apart = [one for one in tried if low < abs(math.log(one / start_film)) < high]
            beside = apart[-1] if apart else more * start_film
            slope = (np.log(minima(beside)) - here) / math.log(beside / start_film)
            curvature = float(weight @ slope**2)
            if curvature > INSENSITIVE**2 * float(weight.sum()):
                causes = [one - slope * float(weight @ (slope * one)) / curvature for one in causes]
    except ModelError:
        return np.full_like(here, np.nan)
    return np.asarray(np.exp(here) * np.sqrt(sum((one**2 for one in causes), np.zeros_like(here))))
