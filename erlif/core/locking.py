"""Locks of HDF5 that the environment demands: had where the drive has them, else done without."""

from __future__ import annotations

import logging
import os
from functools import cache

_logger = logging.getLogger(__name__)

# Variable by which the library of HDF5 insists on locks, whatever a program asks for.
_VARIABLE = "HDF5_USE_FILE_LOCKING"


@cache
def take_demand() -> bool:
    """Take the demand for locks from the environment; to be called before HDF5 is loaded.

    The library has locks without it too, and can then open a file on a drive that has none.

    Returns
    -------
    bool
        Whether locks were demanded.

    Examples
    --------
    >>> take_demand()
    False
    """
    demanded = os.environ.get(_VARIABLE, "").upper() in ("TRUE", "1", "BEST_EFFORT")
    if demanded:
        del os.environ[_VARIABLE]
    return demanded


@cache
def note_unlocked() -> None:
    """Note once that a file is open without the locks that were demanded."""
    if take_demand():
        _logger.warning("this drive has no locks, which %s asks for: read without", _VARIABLE)
