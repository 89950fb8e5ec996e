"""Error of an extrapolation of cycles, bounded by halving it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values

if TYPE_CHECKING:
    import xarray as xr

_SAFETY, _CAUTION = 1.25, 3.0
"""Factors of Roache (1994, 2011) on an estimated error, with an order as expected and without."""

_EXPECTED_ORDER = (0.95, 1.05)
"""Orders within 5 % of the first count as expected, Roache (2011)."""


def bound_extrapolation(
    extrapolation: int, *, wear: Callable[[int], xr.Dataset], halvings: int = 2
) -> xr.Dataset:
    """Bound the error that an extrapolation factor makes, by halving it. Roache (1994, 2011).

    The error of a first-order step falls with the step, so that the last change by halving
    estimates what is left. The bound is 1.25 times this where the changes fall with the first
    order within 5 %, 3 times where they do not (Roache 2011). These factors are of experience.

    Parameters
    ----------
    extrapolation : int
        Largest extrapolation factor, A_E of Mukras et al. (2008), eq. 5.
    wear : callable
        `wear_slider_crank` as a function of the extrapolation factor.
    halvings : int
        Number of halvings, 2 or more.

    Returns
    -------
    xarray.Dataset
        Over `extrapolation`, falling: worn_volume [m3] and greatest_depth [m] at the end, and of
        each the limit for small steps, the order of convergence and the bound of the error of
        every factor, by the names of the two with the endings _limit, _order and _bound.

    Raises
    ------
    ModelError
        Fewer than two halvings, or a factor that cannot be halved as often.

    Examples
    --------
    A quantity that is off by 1 % at a factor of 1000 and has the first order:

    >>> import xarray as xr
    >>> def wear(factor):
    ...     value = ("cycle", [0.0, 1.0 + 1e-5 * factor])
    ...     return xr.Dataset({"worn_volume": value, "greatest_depth": value})
    >>> found = bound_extrapolation(1000, wear=wear)
    >>> print(f"{found.worn_volume_limit:.6f} {found.worn_volume_bound[0]:.4f}")
    1.000000 0.0125
    """
    import xarray as xr

    if halvings < 2 or extrapolation < 2**halvings:
        raise ModelError(
            f"halvings must be 2 or more and leave a factor of 1 at least, got {halvings} of "
            f"{extrapolation}."
        )
    factors = [extrapolation // 2**k for k in range(halvings + 1)]
    ends = [wear(factor).isel(cycle=-1) for factor in factors]
    found: dict[str, Values] = {}
    for name, unit in (("worn_volume", "m3"), ("greatest_depth", "m")):
        values = np.array([float(end[name]) for end in ends])
        earlier, last = values[-3] - values[-2], values[-2] - values[-1]
        order = float(np.log2(earlier / last)) if earlier * last > 0 else float("nan")
        as_expected = _EXPECTED_ORDER[0] <= order <= _EXPECTED_ORDER[1]

        # by the first order the last change is what is left
        limit = values[-1] - last
        bound = (_SAFETY if as_expected else _CAUTION) * np.maximum(abs(values - limit), abs(last))
        found[name] = ("extrapolation", values, {"units": unit})
        found[f"{name}_limit"] = ((), limit, {"units": unit})
        found[f"{name}_order"] = ((), order, {"units": "1"})
        found[f"{name}_bound"] = ("extrapolation", bound, {"units": unit})
    return xr.Dataset(found, {"extrapolation": ("extrapolation", factors, {"units": "1"})})
