"""Tables of texts and numbers that stand in TOML files beside the modules that read them."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Any


@cache
def read_table(package: str, name: str) -> dict[str, Any]:
    """Read a table of the package.

    Parameters
    ----------
    package : str
        Package in whose folder the file lies.
    name : str
        Name of the file.

    Returns
    -------
    dict
        The same one for every caller; not to be changed.

    Examples
    --------
    >>> read_table("erlif.core", "variables.toml")["film"]["load"]["units"]
    'N'
    """
    return tomllib.loads(resources.files(package).joinpath(name).read_text(encoding="utf-8"))
