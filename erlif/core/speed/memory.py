"""Return of unused memory to the system between two stages."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

# Parameters of mallopt, and their values: freed memory at the end of the heap up to which it stays,
# the size from which on an array is no part of the heap [byte], and the number of heaps.
_OPTIONS = {-1: 2**28, -3: 2**25, -8: 1}


def keep_memory() -> bool:
    """Keep freed memory within a stage, in one heap for all threads.

    The C library of Linux (glibc) returns the end of the heap as soon as it is free; the next image
    of the same stage then asks the system for each page again. A heap for each thread holds what
    the others could use. Workers of dask start with MALLOC_TRIM_THRESHOLD_, and without this all
    arrays of a pair are new memory.

    Returns
    -------
    bool
        False with another C library.

    Examples
    --------
    >>> keep_memory() in (True, False)
    True
    """
    choose = _find_function("mallopt")
    return choose is not None and all(choose(name, value) for name, value in _OPTIONS.items())


def release_memory() -> bool:
    """Return freed memory to the system, where the C library would keep it for later.

    The C library of Linux (glibc) keeps freed arrays of up to 32 MB, and the next stage, whose
    arrays have other sizes, does not fit into the gaps: the program grows by both, by 58 of 527 MB
    at 1280 x 1024. Called between two stages; within one, the same arrays are needed again.

    Returns
    -------
    bool
        Whether any memory was returned; False with another C library as well.

    Examples
    --------
    >>> release_memory() in (True, False)
    True
    """
    trim = _find_function("malloc_trim")
    return bool(trim is not None and trim(0))


@cache
def _find_function(name: str) -> Callable[..., Any] | None:
    """A function of the C library; None where it has none."""
    try:
        function: Callable[..., Any] = getattr(ctypes.CDLL(None), name)
    except (AttributeError, OSError, TypeError):  # no such function; no such library on Windows
        return None
    return function
