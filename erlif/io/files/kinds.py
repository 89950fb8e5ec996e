"""Products of erlif recognised by what they hold; ``kinds.toml`` beside this module lists them."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

import xarray as xr

from erlif.core.tables import read_table


@dataclass(frozen=True)
class Kind:
    """Kind of product that a function may take.

    Attributes
    ----------
    words : str
        The kind in a message.
    way : str
        How to get one.
    marks : tuple[str, ...]
        Variables of which only a dataset of this kind has any; one of an unknown kind may be a part
        of it.
    also : tuple[str, ...]
        Further kinds that may be meant, "path" for any path.
    group : str | None
        Group of a film that is opened by its path, empty for the root; None: paths are not opened.
    opener : str
        Function that opens a file of this kind, where that is no film.
    """

    words: str
    way: str = ""
    marks: tuple[str, ...] = ()
    also: tuple[str, ...] = ()
    group: str | None = None
    opener: str = ""


# Kinds by their names.
KINDS = {name: Kind(**keys) for name, keys in read_table("erlif.io.files", "kinds.toml").items()}


def kind_of(value: Any) -> str:
    """Recognise a product.

    Returns
    -------
    str
        A kind as for `take`; "path" for any path, "dataset" for an unknown one, else empty.

    Examples
    --------
    >>> kind_of("film.nc"), kind_of(xr.Dataset({"film_min": 4.1})), kind_of(3)
    ('path', 'film', '')
    """
    if isinstance(value, str | PathLike):
        return "path"
    if isinstance(value, xr.Dataset):
        kinds = (name for name, kind in KINDS.items() if any(mark in value for mark in kind.marks))
        return next(kinds, "dataset")
    if {"ratio_at_zero", "attenuation_camera1", "thickness_range"} <= set(dir(value)):
        return "calibration"
    return ""
