"""The version of the files that erlif writes, and the refusal of later ones."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from typing import Any

from erlif.core.version import __version__, digest_of_sources, version_and_sources

# Version of calibration.nc and film.nc; it rises when an older erlif would misread the file.
FORMAT_VERSION = 1

# Global attribute that holds it; files without it are of version 1.
ATTRIBUTE = "format_version"


class LaterVersionError(ValueError):
    """A file of a later erlif, which this one does not read."""

    def __init__(self, attrs: Mapping[Any, Any], more: str = "") -> None:
        written = str(attrs.get("erlif_version", "unknown"))[:40]
        super().__init__(f"it was written by a later version of erlif, {written}{more}")


def describe_origin(title: str, work: str) -> dict[str, Any]:
    """Global attributes of a film or prediction: title, and the work that made it, such as
    "process block A".
    """
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "history": f"erlif {__version__}: {work}",
        "erlif_version": __version__,
        "erlif_sources": digest_of_sources(),
        ATTRIBUTE: FORMAT_VERSION,
    }


def identify(*parts: str) -> str:
    """Identity of a piece of work: a hash of what it depends on, the sources of erlif included."""
    return hashlib.sha256("\0".join([version_and_sources(), *parts]).encode()).hexdigest()


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


def is_version_after(written: str, own: str) -> bool:
    """Whether a version of erlif is later than another one.

    Parameters
    ----------
    written, own : str
        Versions; what follows the numbers does not count.

    Returns
    -------
    bool
        False where a version has no numbers.

    Examples
    --------
    >>> is_version_after("99.0", "0.1.0"), is_version_after("0.1.0", "0.1")
    (True, False)
    """
    one, two = (
        [int(part) for part in re.split(r"[^0-9]+", text, maxsplit=3)[:3] if part]
        for text in (written, own)
    )
    if not (one and two):
        return False
    return [*one, 0, 0][:3] > [*two, 0, 0][:3]
