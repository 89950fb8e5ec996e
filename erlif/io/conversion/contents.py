"""Contents of a converted film: single maps, and one column for each number of a trigger."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.errors import ErlifError
from erlif.core.progress import Progress
from erlif.core.variables import FILM
from erlif.io.files import check_trigger, takes
from erlif.io.files.headers import MAPS

# Columns that stand first; the start of a table recognises it as one of erlif.
_FIRST = (
    *("trigger", "frames_used", "crank_angle", "encoder_angle", "stroke", "time"),
    *("film_min", "film_min_std", "film_min_std_random"),
    *("film_mean", "film_mean_std", "film_mean_std_random"),
)

# Numbers that a table for spreadsheets leaves to the other formats.
_DETAIL = re.compile(
    r"share_passed|noise_correlation|flagged_pixels|reference|film_gap_mean|film_theory_central"
    r"|attitude|film_predicted_mean|film_curvature|film_drag|friction_(torque|void|power)|pin_tilt"
    r"|film_over_.*_random"
)

_FULL_TURN = 360.0  # degree
_NEAR = 1.0  # degree from the angle of a film of one trigger


@dataclass(frozen=True)
class TriggerColumn:
    """A number or a text of each trigger.

    Attributes
    ----------
    name : str
        Name of the variable; for one of several numbers, with its label appended.
    unit : str
        Its unit; empty where the film states none.
    values : AnyArray
        (trigger,)
    """

    name: str
    unit: str
    values: AnyArray

    @property
    def heading(self) -> str:
        """Name and unit, as in ``film_min [um]``."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@takes(film="film")
def trigger_columns(film: xr.Dataset) -> list[TriggerColumn]:
    """List all numbers and texts that a film has for each trigger.

    A variable with a further dim gives one column for each of its entries. Of matrices, covariances
    and derivatives, the standard deviations of the position of the pin alone are listed.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it.

    Returns
    -------
    list of TriggerColumn
        Trigger, frames, angles, stroke, time and films first, then all others that erlif writes, in
        one order for all films, then further ones of the log by their names: a zarr store has no
        order of its own.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> columns = trigger_columns(example_film())
    >>> [column.heading for column in columns[:3]]
    ['trigger', 'frames_used [1]', 'crank_angle [degree]']
    >>> next(column.name for column in columns if column.name.startswith("pin"))
    'pin_displacement_load'
    """
    columns: list[TriggerColumn] = []
    for name in _ordered(film):
        variable = film[name]
        if variable.dims[:1] != ("trigger",) or variable.dims[1:3] == ("y", "x"):
            continue
        if name == "pin_position_cov":
            columns += _pin_errors(film)
        if variable.dtype.kind not in "iufbOUST" or variable.ndim > 2:
            continue
        values, unit = variable.values, str(variable.attrs.get("units", ""))
        labels = itertools.product(*(_labels(film, str(dim)) for dim in variable.dims[1:]))
        flat = values.reshape(len(values), -1)
        for words, column in zip(labels, flat.T, strict=True):
            columns.append(TriggerColumn("_".join([name, *words]), unit, column))
    return columns


def table_columns(film: xr.Dataset) -> list[TriggerColumn]:
    """List the columns of a table for spreadsheets: films, motion, theory and their errors.

    Argument, order and errors as in `trigger_columns`. Counts of each flag, parts of the friction,
    curvatures, tilts and random errors of ratios are left out; further columns of the log are not.

    Returns
    -------
    list of TriggerColumn
        Columns of the table.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> left_out = {each.name for each in trigger_columns(film)}
    >>> sorted(left_out - {each.name for each in table_columns(film)})[:2]
    ['attitude', 'film_curvature']
    """
    of_user = film.variables.keys() - FILM.keys()  # further columns of the log
    columns = trigger_columns(film)
    return [one for one in columns if one.name in of_user or not _DETAIL.match(one.name)]


def _pin_errors(film: xr.Dataset) -> Iterator[TriggerColumn]:
    """Standard deviations of displacement and tilt of the pin."""
    stds = np.sqrt(np.diagonal(film.pin_position_cov.values, axis1=1, axis2=2))
    for label, std in zip(_labels(film, str(film.pin_position_cov.dims[1])), stds.T, strict=True):
        quantity = f"pin_{label.partition('_')[0]}"
        unit = film[quantity].attrs.get("units", "") if quantity in film else ""
        yield TriggerColumn(f"pin_{label}_std", str(unit), std)


def _ordered(film: xr.Dataset) -> list[str]:
    """Names of all variables in an order that does not depend on the file."""
    known = (*_FIRST, *(name for name in FILM if name not in _FIRST))
    names = {str(name) for name in film.variables}
    return [*(name for name in known if name in names), *sorted(names.difference(known))]


def _labels(film: xr.Dataset, dim: str) -> list[str]:
    """Words for the entries of a dimension, which complete the name of a column."""
    if dim == "flag":
        # the bits have names, which stand at the maps of flags
        return str(film.flags.attrs["flag_meanings"]).split()
    named = dim.removesuffix("_other")
    if named in film.coords and film[named].dtype.kind in "OUST":
        return [str(label) for label in film[named].values]
    return [str(k) for k in range(film.sizes[dim])]


def maps_of(film: xr.Dataset, trigger: int) -> Iterator[tuple[str, AnyArray]]:
    """Read the maps of one trigger, one after the other.

    Parameters
    ----------
    film : xarray.Dataset
    trigger : int
        Number of the trigger, from 0.

    Yields
    ------
    str, array (y, x)
        Name of the variable and its values, thickness first.

    Returns
    -------
    iterator

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> for name, values in maps_of(example_film(), 0):
    ...     print(name, values.dtype, values.shape)
    thickness float32 (24, 64)
    thickness_std float32 (24, 64)
    thickness_std_shared float32 (24, 64)
    flags uint16 (24, 64)
    """
    for name in MAPS:
        yield name, film[name].isel(trigger=trigger).values


def maps_of_triggers(
    film: xr.Dataset, name: str, triggers: list[int], progress: Progress
) -> Iterator[AnyArray]:
    """Read the maps of one variable, one after the other.

    Parameters
    ----------
    film : xarray.Dataset
    name : str
        One of `MAPS`.
    triggers : list of int
    progress : Progress
        Called after each map has been used.

    Yields
    ------
    array (y, x)
    """
    done = MAPS.index(name) * len(triggers)
    for k, trigger in enumerate(triggers, 1):
        yield film[name].isel(trigger=trigger).values
        progress("maps", done + k, len(MAPS) * len(triggers))


def choose_trigger(
    film: xr.Dataset,
    *,
    trigger: int | None = None,
    crank_angle: float | None = None,
    encoder_angle: float | None = None,
) -> int | None:
    """Find the trigger that a user names by its number or by one of its angles.

    Parameters
    ----------
    film : xarray.Dataset
    trigger : int, optional
        Number of the trigger, from 0.
    crank_angle, encoder_angle : float, optional
        The nearest trigger is taken. [degree]

    Returns
    -------
    int or None
        None where nothing is given.

    Raises
    ------
    ErlifError
        If more than one is given, if there is no such trigger, or if the film has no such angles.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> film.crank_angle.values.tolist()
    [250.0, 290.0, 330.0, 70.0, 110.0, 150.0]
    >>> choose_trigger(film, crank_angle=75.0)
    3
    """
    named = {"trigger": trigger, "crank_angle": crank_angle, "encoder_angle": encoder_angle}
    given = {name: value for name, value in named.items() if value is not None}
    if len(given) > 1:
        listed = " and ".join(
            f"{name.replace('_', ' ')} {value:g}" for name, value in given.items()
        )
        raise ErlifError(
            f"Expected a trigger by its number or by one angle; got {listed}. Give one of them."
        )
    if trigger is not None:
        check_trigger(film, trigger)
        return trigger
    return next((_nearest(film, name, angle) for name, angle in given.items()), None)


def _nearest(film: xr.Dataset, name: str, angle: float) -> int:
    """Trigger nearest to an angle. [degree]"""
    title = name.replace("_", " ")
    if name not in film:
        raise ErlifError(
            f"Expected a film with the {title} of its triggers to find that at {angle:g} degree; "
            "this one has none. Choose the trigger by its number."
        )
    if not np.isfinite(angle):
        raise ErlifError(
            f"Expected the {title} of a trigger in degree; got {angle}. Give a number."
        )
    angles = film[name].values.astype(float)
    distance = np.abs(angles - angle)
    if name == "crank_angle":  # it starts again after a turn
        distance = np.abs((angles - angle + _FULL_TURN / 2) % _FULL_TURN - _FULL_TURN / 2)

    nearest = int(np.nanargmin(distance))
    steps = np.diff(np.unique(angles[np.isfinite(angles)]))
    if distance[nearest] > (np.median(steps) if steps.size else _NEAR):
        raise ErlifError(
            f"Expected the {title} of a trigger; got {angle:g} degree. Choose an angle near it; of "
            f"all triggers, that at {angles[nearest]:.2f} degree is the nearest."
        )
    return nearest


def attributes_of(film: xr.Dataset) -> dict[str, str]:
    """Text that a converted film keeps: title, settings, calibration, hashes and notes."""
    return {str(key): value for key, value in film.attrs.items() if isinstance(value, str)}


def describe_units(film: xr.Dataset) -> dict[str, str]:
    """Unit of every variable that is converted, by its name.

    A matrix of several units has its comment, which names them; a further column of the log none.
    """
    numbers = [name for name in _ordered(film) if film[name].dtype.kind in "iufb"]
    described = {name: film[name].attrs for name in numbers}
    return {
        name: str(attrs.get("units") or attrs.get("comment") or ("1" if name in film.dims else ""))
        for name, attrs in described.items()
    }


def small_variables(film: xr.Dataset, triggers: list[int]) -> dict[str, Any]:
    """Numbers and texts that are no maps, of the chosen triggers."""
    chosen = film.drop_vars(MAPS).isel(trigger=triggers)
    return {
        name: chosen[name].values
        for name in _ordered(chosen)
        if chosen[name].dtype.kind in "iufbOUST"
    }
