"""Levels of detail: the visible part of a map in no more pixels than the screen shows."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image

_SLACK = 0.2  # pixels of the map by which a point may be larger than a pixel of the screen


# Rows and columns of a part of a map.
Part = tuple[slice, slice]


def cover(shape: tuple[int, int], corners: Sequence[float]) -> Part:
    """Smallest part of whole pixels around `corners`, inside a map of this shape.

    Parameters
    ----------
    shape : (int, int)
        Rows and columns of the map.
    corners : sequence of float
        Left, top, right and bottom, in pixels from the upper left corner of the map.

    Returns
    -------
    (slice, slice)
        Rows and columns, at least one of each.

    Examples
    --------
    >>> cover((100, 200), (-5.0, 10.5, 50.2, 1e9))
    (slice(10, 100, None), slice(0, 51, None))
    """
    left, top, right, bottom = corners
    parts = []
    for count, low, high in ((shape[0], top, bottom), (shape[1], left, right)):
        first = min(max(math.floor(low), 0), count - 1)
        parts.append(slice(first, min(max(math.ceil(high), first + 1), count)))
    return parts[0], parts[1]


def choose_step(window: Part, room: tuple[int, int], *, coarse: bool = False) -> int:
    """Pixels on a side that are averaged, so that the screen loses no detail it could show.

    Parameters
    ----------
    window : (slice, slice)
        Part of the map on the screen.
    room : (int, int)
        Width and height on the screen. [px]
    coarse : bool
        Half the detail, for maps that pass quickly.

    Returns
    -------
    int
        1 where the screen has room for every pixel.

    Examples
    --------
    >>> choose_step((slice(0, 1024), slice(0, 1280)), (640, 512))
    2
    >>> choose_step((slice(0, 200), slice(0, 300)), (640, 512))
    1
    """
    shown = zip(reversed(window), room, strict=True)  # columns by the width, rows by the height
    ratio = max(float(part.stop - part.start) / max(length, 1) for part, length in shown)
    step = max(math.floor(ratio + _SLACK), 1)
    return 2 * step if coarse and (2 * ratio) > 1 else step


def reduce_map(values: Image, flags: FlagImage, *, step: int) -> tuple[Image, FlagImage]:
    """Average a map over squares of pixels.

    Parameters
    ----------
    values : array of float32, (y, x)
        A map; NaN where it has no value.
    flags : array of uint16, (y, x)
        Bits of `erlif.core.flags.Flag`; pixels with a flag are left out.
    step : int
        Pixels on a side of a square. Squares at the right and lower edge may be cut.

    Returns
    -------
    tuple of array
        Mean of the valid pixels of each square, and flags. A square of which half or less is valid
        is NaN and has all flags of its pixels; the other squares have none.

    Examples
    --------
    >>> values = np.array([[1, 2, 5], [3, np.nan, 7]], np.float32)
    >>> flags = np.array([[0, 0, 0], [0, 128, 2]], np.uint16)
    >>> reduce_map(values, flags, step=2)
    (array([[ 2., nan]], dtype=float32), array([[0, 2]], dtype=uint16))
    """
    if step == 1:
        return values, flags
    # squares at the edges have fewer pixels, so that half is half of what is there
    good = (flags == 0) & np.isfinite(values)
    total = _fold(np.where(good, values, np.float32(0)), step, np.add)
    valid = _fold(good.astype(np.uint32), step, np.add)
    seen = _fold(np.ones(flags.shape[0], np.uint32), step, np.add)[:, None] * _fold(
        np.ones(flags.shape[1], np.uint32), step, np.add
    )
    union = _fold(flags, step, np.bitwise_or)

    enough = 2 * valid > seen
    mean = np.full(total.shape, np.nan, np.float32)
    np.divide(total, valid, out=mean, where=enough)
    union[enough] = 0
    return mean, union


def _fold(values: AnyArray, step: int, combine: np.ufunc) -> AnyArray:
    """Combine the elements of each square, or of each piece of a line."""
    # whole rows first: they lie in one piece, and leave little for the columns
    for axis in range(values.ndim):
        pieces = [values[(slice(None),) * axis + (slice(k, None, step),)] for k in range(step)]
        folded = pieces[0].copy()
        for piece in pieces[1:]:
            there = folded[tuple(slice(length) for length in piece.shape)]
            combine(there, piece, out=there)
        values = folded
    return values
