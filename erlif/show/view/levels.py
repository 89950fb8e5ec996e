"""Levels of detail: the visible part of a map in no more pixels than the screen shows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image

_SLACK = 0.2  # pixels of the map by which a point may be larger than a pixel of the screen


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels of a map.

    Attributes
    ----------
    left : int
        Number of the first column, from 0.
    top : int
        That of the first row.
    right : int
        Column behind the last one of the window.
    bottom : int
        The same for rows.
    """

    left: int
    top: int
    right: int
    bottom: int

    @classmethod
    def within(cls, shape: tuple[int, int], corners: tuple[float, float, float, float]) -> Window:
        """Smallest window of whole pixels around `corners`, inside a map of this shape.

        Parameters
        ----------
        shape : (int, int)
            Rows and columns of the map.
        corners : (float, float, float, float)
            Left, top, right and bottom, in pixels from the upper left corner of the map.

        Returns
        -------
        Window
            At least one pixel wide and high.

        Examples
        --------
        >>> Window.within((100, 200), (-5.0, 10.5, 50.2, 1e9))
        Window(left=0, top=10, right=51, bottom=100)
        """
        rows, columns = shape
        left, top, right, bottom = corners
        first_column = min(max(math.floor(left), 0), columns - 1)
        first_row = min(max(math.floor(top), 0), rows - 1)
        return cls(
            first_column,
            first_row,
            min(max(math.ceil(right), first_column + 1), columns),
            min(max(math.ceil(bottom), first_row + 1), rows),
        )

    def cut(self, values: AnyArray) -> AnyArray:
        """The part of a map that lies in the window."""
        return values[self.top : self.bottom, self.left : self.right]


def choose_step(window: Window, room: tuple[int, int], *, coarse: bool = False) -> int:
    """Pixels on a side that are averaged, so that the screen loses no detail it could show.

    Parameters
    ----------
    window : Window
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
    >>> choose_step(Window(0, 0, 1280, 1024), (640, 512))
    2
    >>> choose_step(Window(0, 0, 300, 200), (640, 512))
    1
    """
    width, height = max(room[0], 1), max(room[1], 1)
    ratio = max((window.right - window.left) / width, (window.bottom - window.top) / height)
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
