"""Imports of the libraries behind a command.

Work may wait until a package is imported.
"""

from __future__ import annotations

import gc
import importlib.util
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

# Libraries whose arrays xarray knows. It loads each that is installed as soon as it makes its
# first array; dask and pint take 0.3 s, and the commands use none of their arrays.
_ARRAY_LIBRARIES = frozenset({"cupy", "dask", "pint", "sparse"})

# Libraries that numpy and numba load where they are installed, and do without: 6 MB.
_UNUSED = _ARRAY_LIBRARIES | {"charset_normalizer", "coverage", "yaml"}

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
    """Prevent scipy from parsing the docstrings of its functions."""
    module = sys.modules[_DOCSTRINGS]
    if not hasattr(module, "FunctionDoc"):  # private to scipy: a later version may have another
        return

    class Unread(module.FunctionDoc):  # type: ignore[misc, name-defined]
        def _parse(self) -> None:
            pass

        def __str__(self, func_role: str = "") -> str:
            return "\n" + (self._f.__doc__ or "")

    module.FunctionDoc = Unread  # type: ignore[attr-defined]


def after_import(name: str, action: Callable[[], None]) -> None:
    """Do something as soon as a package is there, without importing it.

    Parameters
    ----------
    name : str
        Package or module.
    action : callable
        Called once: now where the package is imported already, else after its import.

    Examples
    --------
    >>> after_import("numpy", lambda: print("numpy is there"))
    numpy is there
    """
    if name in sys.modules:
        action()
    else:
        sys.meta_path.insert(0, _Watcher(name, action))


class _Watcher(MetaPathFinder):
    """Finds one package in the usual way, and lets its loader call an action at the end."""

    def __init__(self, name: str, action: Callable[[], None]) -> None:
        self.name, self.action = name, action

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self.name:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(fullname)
        if spec is None or spec.loader is None:
            return None

        execute = spec.loader.exec_module

        def execute_and_act(module: ModuleType) -> None:
            execute(module)
            self.action()

        spec.loader.exec_module = execute_and_act  # type: ignore[method-assign]
        return spec
