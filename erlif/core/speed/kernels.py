"""Kernels that numba compiles and keeps, also where what it kept is damaged or cannot be written.

A loss of power or a full disk leaves files that end early. numba would raise the error of pickle
at every further start; here such a kernel is compiled again and kept again.
"""

from __future__ import annotations

import logging
from contextlib import suppress
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache

__all__ = ["njit"]

_logger = logging.getLogger(__name__)

_cache: Any = FunctionCache
_load, _save = _cache._load_overload, _cache._save_overload


def _load_or_compile(self: Any, sig: Any, target_context: Any) -> Any:
    """As the method of numba; None, upon which it compiles, where the file cannot be read."""
    try:
        return _load(self, sig, target_context)
    except Exception as error:  # pickle raises errors of many classes for bytes that are cut
        _logger.info("%s is compiled again, as its file is damaged (%r)", self._name, error)
        with suppress(OSError):
            self.flush()
        return None


def _save_if_possible(self: Any, sig: Any, data: Any) -> None:
    """As the method of numba; where nothing can be written the kernel lasts for the program."""
    try:
        _save(self, sig, data)
    except Exception as error:  # also an index that another process has damaged since
        _logger.info("%s is not kept for the next start (%r)", self._name, error)


_cache._load_overload, _cache._save_overload = _load_or_compile, _save_if_possible
