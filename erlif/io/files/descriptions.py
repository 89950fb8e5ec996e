"""Descriptions in a zarr store: what its groups and arrays hold."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from erlif.core.bounded import read_bounded

# Size of a description that is read. [byte]
_LARGEST = 2**24


def read_description(store: Path, name: str) -> dict[str, Any]:
    """Read the description of a group or array.

    Parameters
    ----------
    store : Path
        Folder of the store.
    name : str
        Place of the group or array in it, with "/"; "." for the store itself.

    Returns
    -------
    dict of str to object

    Raises
    ------
    OSError
        If it cannot be read, is not a regular file or is too large.
    ValueError
        If it is no record of JSON.
    """
    text = read_bounded(store / name / "zarr.json", largest=_LARGEST)
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{name}/zarr.json is no JSON") from error
    if not isinstance(found, dict):
        raise ValueError(f"{name}/zarr.json describes no array")
    return found
