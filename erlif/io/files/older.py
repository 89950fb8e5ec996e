"""Films of earlier versions in the form of today's: variables where attributes held lists."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray

_MOVED = (
    ("film_mean", "share_beyond_range", "share_beyond_range", "1"),
    ("film_curvature", "expected", "film_curvature_expected", "um mm-2"),
)
"""Variable and attribute that held numbers of all triggers, then name and unit as a variable."""


def renew_film(film: xr.Dataset) -> xr.Dataset:
    """Make variables of what earlier versions wrote as lists in attributes.

    Parameters
    ----------
    film : Dataset
        Of any version; a film of today stays as it is.

    Returns
    -------
    Dataset
        With share_beyond_range, film_curvature_expected and film_regime (trigger), as far as the
        film holds them.

    Raises
    ------
    ValueError
        With the bare reason, if a list has not one value for each trigger, or is missing.

    Examples
    --------
    >>> share = {"share_beyond_range": [0.0, 0.2]}
    >>> old = xr.Dataset({"film_mean": ("trigger", [4.1, 4.3], share)})
    >>> renew_film(old).share_beyond_range.values
    array([0. , 0.2])
    """
    found = {}
    for holder, attribute, name, unit in _MOVED:
        if holder in film and name not in film and attribute in film[holder].attrs:
            values = np.atleast_1d(np.asarray(film[holder].attrs[attribute]))
            if values.dtype.kind not in "iuf":
                raise ValueError(f"the attribute {attribute} of {holder} holds no numbers")
            found[name] = _by_trigger(film, attribute, values.astype(float), {"units": unit})
    if "film_regime" not in film:
        for holder in ("film_regime_map", "film_theory"):
            names = film[holder].attrs.get("regimes_by_trigger") if holder in film else None
            if names is not None:
                values = np.array(str(names).split(), dtype=str)
                found["film_regime"] = _by_trigger(film, "regimes_by_trigger", values, {})
    if "film_curvature" in film and "film_curvature_expected" not in (*film, *found):
        raise ValueError("it has no variable film_curvature_expected")
    if not found:
        return film

    renewed = film.assign(found)
    renewed.set_close(film.close)
    return renewed


def _by_trigger(
    film: xr.Dataset, attribute: str, values: AnyArray, attrs: dict[str, str]
) -> xr.Variable:
    """A list of an attribute as a variable, if it has one value for each trigger."""
    if values.shape != (film.sizes["trigger"],):
        raise ValueError(f"its attribute {attribute} has the shape {values.shape}")
    return xr.Variable(("trigger",), values, attrs)
