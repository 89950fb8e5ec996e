"""Images that are used again once nothing refers to them: new memory costs as much as a pass."""

from __future__ import annotations

import sys
import threading
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray


class _Kept(threading.local):
    """The images of one thread."""

    def __init__(self) -> None:
        self.arrays: list[AnyArray] = []


_KEPT = _Kept()


def _references(arrays: list[AnyArray], n: int) -> int:
    """References to one array of a list, those of its views included."""
    return sys.getrefcount(arrays[n])


_UNUSED = _references([np.empty(0)], 0)
"""References to an array that only the list holds."""


def empty_image(shape: tuple[int, ...], dtype: npt.DTypeLike = np.float32) -> npt.NDArray[Any]:
    """Return an array of any content, as `numpy.empty`.

    The array belongs to the caller as long as the caller, or a view, refers to it. Its memory is
    then used again for the next array of its shape and type in the same thread.

    Parameters
    ----------
    shape : tuple of int
    dtype : dtype

    Returns
    -------
    array

    Examples
    --------
    >>> first = empty_image((480, 640))
    >>> second = empty_image((480, 640))
    >>> second is first
    False
    """
    wanted, arrays = np.dtype(dtype), _KEPT.arrays
    # by number: a name for the array would be one more reference
    unused = [n for n in range(len(arrays)) if _references(arrays, n) == _UNUSED]
    for n in unused:
        if arrays[n].shape == shape and arrays[n].dtype == wanted:
            return arrays[n]

    # images of another size are left over from another recording
    for n in reversed(unused):
        if arrays[n].shape != shape:
            del arrays[n]
    arrays.append(np.empty(shape, wanted))
    return arrays[-1]
