"""Kernels that numba compiles and keeps, also where what it kept is damaged or cannot be written.

A loss of power or a full disk leaves files that end early. numba would raise the error of pickle
at every further start; here such a kernel is compiled again and kept again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numba
from numba.core.caching import FunctionCache

_logger = logging.getLogger(__name__)

_numba_cache: Any = FunctionCache  # numba has no types


class _KernelCache(_numba_cache):  # type: ignore[misc]
    """The kept kernels of one function."""

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        """None, upon which numba compiles, where the file cannot be read."""
        try:
            kept = super()._load_overload(sig, target_context)
            if kept is not None and kept.fndesc.qualname != self._py_func.__qualname__:
                raise ValueError(f"it holds {kept.fndesc.qualname}")
            return kept
        except Exception as error:  # pickle raises errors of many classes for bytes that are cut
            _logger.info("%s is compiled again, as its file is damaged (%r)", self._name, error)
            with suppress(OSError):
                self.flush()
            return None

    def _save_overload(self, sig: Any, data: Any) -> None:
        """Where nothing can be written the kernel lasts for the program."""
        try:
            super()._save_overload(sig, data)
        except Exception as error:  # also an index that another process has damaged since
            _logger.info("%s is not kept for the next start (%r)", self._name, error)


def njit(
    signature: str | None = None, *, cache: bool = False, **options: Any
) -> Callable[[Callable[..., Any]], Any]:
    """As `numba.njit`, whose kept kernels may be damaged.

    Parameters
    ----------
    signature : str, optional
        Types of arguments for which it is compiled at once, and for no others; default: for those
        of each call.
    cache : bool
        Keep the kernels for the next start.
    **options
        Of `numba.njit`.

    Returns
    -------
    callable
        Decorator, which returns the compiled function.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        kernel = numba.njit(**options)(function)
        if cache:
            kernel._cache = _KernelCache(function)
        if signature is not None:
            kernel.compile(signature)
            kernel.disable_compile()
        return kernel

    return compiled
