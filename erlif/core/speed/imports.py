"""Imports of the libraries behind a command."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from erlif.core.speed.later import after_import

# Libraries whose arrays xarray knows. It loads each that is installed as soon as it makes its
# first array; dask and pint take 0.3 s, and the commands use none of their arrays.
_ARRAY_LIBRARIES = frozenset({"cupy", "dask", "pint", "sparse"})

# Libraries that numpy and numba load where they are installed, and do without: 6 MB.
_UNUSED = _ARRAY_LIBRARIES | {"charset_normalizer", "coverage"}

# With it scipy adds notes to the docstrings of 400 functions while it loads, which takes 0.1 s.
_DOCSTRINGS = "scipy._lib._docscrape"


@contextmanager
def large_imports() -> Iterator[None]:
    """Import without the garbage collector, and without what is not used of libraries.

    Together they take a third off the start of a command, 1.2 to 0.8 s. Modules stay until the
    program ends, so that searching them for garbage while they load finds nothing. What is loaded
    is left out of later searches as well.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    # an xarray that a program has loaded before may have looked for them already
    hidden = [] if "xarray" in sys.modules else list(_UNUSED - sys.modules.keys())
    if _DOCSTRINGS not in sys.modules:
        after_import(_DOCSTRINGS, _leave_docstrings)
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


def _leave_docstrings() -> None:
    """Let scipy leave the docstrings of its functions as they are."""
    module = sys.modules[_DOCSTRINGS]
    if not hasattr(module, "FunctionDoc"):  # private to scipy: a later version may have another
        return

    class Unread(module.FunctionDoc):  # type: ignore[misc, name-defined]
        def _parse(self) -> None:
            pass

        def __str__(self, func_role: str = "") -> str:
            return "\n" + (self._f.__doc__ or "")

    module.FunctionDoc = Unread  # type: ignore[attr-defined]
