"""Imports of the libraries behind a command."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def large_imports() -> Iterator[None]:
    """Import without the garbage collector.

    Modules stay until the program ends, and searching them for garbage while they load takes a
    sixth of the time. What is loaded is left out of later searches as well.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
            gc.freeze()
