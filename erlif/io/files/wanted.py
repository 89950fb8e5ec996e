"""The product that a function needs, compared with the one it was given.

A film is recognised by its variables, a calibration by its parameters. Paths of films are opened
where a film is wanted. Everything else is refused with what was given and how to get the right one.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from os import fspath
from typing import Any, ParamSpec, TypeVar

import xarray as xr

from erlif.core.errors import ErlifError
from erlif.io.files.film import open_film
from erlif.io.files.kinds import KINDS, kind_of

P = ParamSpec("P")
R = TypeVar("R")

# Kind of an argument of a figure by its name.
PRODUCTS = {
    "film": "film",
    "frames": "frames",
    "registration": "registration",
    "images": "images",
    "found": "pressure",
    "comparison": "comparison",
    "calibration": "calibration",
}


def take(value: Any, kind: str, *, where: str = "") -> Any:
    """Return a product of the wanted kind, opened if it is a path; refuse any other.

    Parameters
    ----------
    value : object
        What the caller gave. Paths are opened where a film or a group of it is wanted.
    kind : str
        A kind of `KINDS`.
    where : str
        The argument, for the message.

    Returns
    -------
    object
        `value`, or the opened film.

    Raises
    ------
    ErlifError
        If it is another kind: with what was given and how to get the right one.

    Examples
    --------
    >>> take(xr.Dataset({"drift_x": ("frame", [0.1])}), "film", where="film")
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected a film as film=, got the group frames of a film. \
erlif.open_film("film.nc") opens one, erlif.process(RUN_DIR) makes one.
    """
    kind_given, wanted = kind_of(value), KINDS[kind]
    if kind_given == "path" and wanted.group is not None:
        return open_film(value, group=wanted.group or None)
    if kind_given in (kind, *wanted.also) or (kind_given == "dataset" and wanted.marks):
        return value
    if kind == "part of a film" and isinstance(value, xr.Dataset):
        return value

    argument = f" as {where}=" if where else ""
    source = value.encoding.get("source", "") if isinstance(value, xr.Dataset) else ""
    hint = f"{wanted.way}."
    if source and kind in ("film file", "run or film", "path"):
        hint = f"Name its file: {source}."
    given = _describe(value, kind_given)
    raise ErlifError(f"Expected {wanted.words}{argument}, got {given}. {hint}")


def _describe(value: Any, kind: str) -> str:
    if kind == "path":
        return f"the path {fspath(value)}"
    if kind in KINDS:
        return KINDS[kind].words
    if value is None:
        return "None"
    if isinstance(value, xr.DataArray):
        return f"the single variable {value.name}"
    if isinstance(value, xr.Dataset):
        return f"a dataset with {', '.join(str(name) for name in list(value)[:5]) or 'nothing'}"
    return f"{type(value).__name__} {str(value)[:40]!r}"


def takes(**wanted: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate a function: refuse wrong products, and open films given by their paths.

    Parameters
    ----------
    **wanted : str
        Kind of each argument by its name, as for `take`; a default of None passes. Names that the
        function lacks are left out: figures share `PRODUCTS`.

    Returns
    -------
    callable
        Decorates a function.

    Examples
    --------
    >>> @takes(film="film")
    ... def count(film):
    ...     return film.sizes["trigger"]
    >>> count(xr.Dataset({"film_min": ("trigger", [4.1, 4.3])}))
    2
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        signature = inspect.signature(function)

        @functools.wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            try:
                bound = signature.bind(*args, **kwargs)
            except TypeError:  # the call itself names what is missing or too much
                return function(*args, **kwargs)
            for name in [name for name in wanted if name in bound.arguments]:
                # None stands for what may be left out
                value = bound.arguments[name]
                if value is not None or signature.parameters[name].default is not None:
                    bound.arguments[name] = take(value, wanted[name], where=name)
            return function(*bound.args, **bound.kwargs)

        return checked

    return decorate
