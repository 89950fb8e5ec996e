"""Imports of the libraries behind a command."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

# Libraries whose arrays xarray knows. It loads each that is installed as soon as it makes its
# first array; dask and pint take 0.3 s, and the commands use none of their arrays.
_ARRAY_LIBRARIES = frozenset({"cupy", "dask", "pint", "sparse"})


@contextmanager
def large_imports() -> Iterator[None]:
    """Import without the garbage collector, and without array libraries that are not used.

    Together they take a quarter off the start of a command, 1.6 to 1.2 s. Modules stay until the
    program ends, so that searching them for garbage while they load finds nothing. What is loaded
    is left out of later searches as well.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    # an xarray that a program has loaded before may have looked for them already
    hidden = [] if "xarray" in sys.modules else list(_ARRAY_LIBRARIES - sys.modules.keys())
    # None stands for a module that cannot be imported
    sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]
    try:
        yield
        if hidden:
            _show_arrays_to_xarray()
    finally:
        for name in hidden:
            sys.modules.pop(name, None)
        if was_enabled:
            gc.enable()
            gc.freeze()


def _show_arrays_to_xarray() -> None:
    """Make xarray look for the libraries: it looks once."""
    import numpy as np
    import xarray as xr

    xr.Dataset(coords={"x": np.arange(2)}).compute()
