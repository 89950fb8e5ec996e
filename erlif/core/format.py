"""The version of the files that erlif writes, and the refusal of later ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Version of calibration.nc and film.nc; it rises when an older erlif would misread the file.
FORMAT_VERSION = 1

# Global attribute that holds it; files without it are of version 1.
ATTRIBUTE = "format_version"


def is_later(attrs: Mapping[Any, Any]) -> bool:
    """Check whether a file has a later version than this erlif reads.

    Parameters
    ----------
    attrs : mapping
        Global attributes of the file.

    Returns
    -------
    bool

    Raises
    ------
    ValueError
        If the version is no whole number.

    Examples
    --------
    >>> is_later({}), is_later({"format_version": FORMAT_VERSION + 1})
    (False, True)
    """
    version = attrs.get(ATTRIBUTE, FORMAT_VERSION)
    number = int(version)
    if number != version or number < 1:
        raise ValueError(f"{ATTRIBUTE} is {version!r}, no whole number from 1 on")
    return number > FORMAT_VERSION
