"""The numbers of the triggers, for the chart of the cycle."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.tables import read_table

_TABLES = read_table("erlif.show.view", "page.toml")
_DIGITS = 6  # significant ones of the numbers that are sent


def describe_cycle(film: xr.Dataset) -> dict[str, Any]:
    """Collect what is known of each trigger besides its maps.

    Parameters
    ----------
    film : Dataset
        As `erlif.open_film` returns it.

    Returns
    -------
    dict
        "axes" and "films": titles by name; "columns": a list of one number for each trigger by
        name, None where it is not known; "stroke": +1, -1 or 0 where there are no strokes.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> cycle = describe_cycle(example_film())
    >>> list(cycle["axes"])[:3], cycle["columns"]["trigger"]
    (['encoder_angle', 'crank_angle', 'rocker_speed'], [0, 1, 2, 3, 4, 5])
    """
    axes, films = (
        {name: title for name, title in table.items() if name in film}
        for table in (_TABLES["axes"], _TABLES["films"])
    )
    stds = [f"{name}_std" for name in films if f"{name}_std" in film]
    # numbers of triggers count from 0, whatever the film was cut from
    count = film.sizes["trigger"]
    columns = {name: to_list(film[name].values) for name in (*axes, *films, *stds)}
    columns["trigger"] = list(range(count))

    # the theory of a film with a transient prediction is this prediction
    if {"film_theory", "film_predicted_min"} <= films.keys() and np.array_equal(
        film.film_theory.values, film.film_predicted_min.values, equal_nan=True
    ):
        del films["film_theory"]
    axes.setdefault("trigger", _TABLES["axes"]["trigger"])
    stroke = np.sign(film.stroke.values) if "stroke" in film else np.zeros(count)
    return {
        "axes": axes,
        "films": films,
        "columns": columns,
        "stroke": np.nan_to_num(stroke).astype(int).tolist(),
    }


def to_list(values: Array) -> list[float | None]:
    """Numbers as JSON holds them.

    Parameters
    ----------
    values : array, (n,)
        Numbers; NaN where unknown.

    Returns
    -------
    list
        Rounded to six significant digits; None for NaN, which JSON lacks.

    Examples
    --------
    >>> to_list(np.array([1 / 3, np.nan]))
    [0.333333, None]
    """
    return [
        float(f"{value:.{_DIGITS}g}") if np.isfinite(value) else None
        for value in np.asarray(values, float).tolist()
    ]
