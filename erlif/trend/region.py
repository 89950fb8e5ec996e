"""The region of interest: the rows and columns whose film is summed up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError

_SMALLEST = 32  # least width and height: four blocks of eight pixels for the fit of the gap [px]

Interval = tuple[float, float]


@dataclass(frozen=True)
class Region:
    """A rectangle of pixels.

    Attributes
    ----------
    rows : slice
        Rows of the image.
    columns : slice
        Columns of the image.
    """

    rows: slice
    columns: slice


def find_region(x: Array, y: Array, *, roi: tuple[Interval, Interval] | None = None) -> Region:
    """Rows and columns of the region of interest.

    Parameters
    ----------
    x : array, (column,)
        Pixel positions. [mm]
    y : array, (row,)
        Pixel positions, downwards. [mm]
    roi : ((x_low, x_high), (y_low, y_high)), optional
        Bounds, included. Default: all of the image. [mm]

    Returns
    -------
    Region

    Raises
    ------
    ConfigError
        If fewer than 32 x 32 pixels of the image lie in it.

    Examples
    --------
    >>> position = np.arange(100) * 0.1
    >>> find_region(position, position, roi=((1.0, 5.0), (0.0, 9.0))).columns
    slice(10, 51, None)
    """
    if roi is None:
        return Region(slice(0, y.size), slice(0, x.size))

    across, down = roi
    columns = _slice_between(x, across)
    rows = _slice_between(y, down)
    if columns.stop - columns.start < _SMALLEST or rows.stop - rows.start < _SMALLEST:
        raise ConfigError(
            f"Expected a region of interest of at least {_SMALLEST} x {_SMALLEST} pixels within "
            f"the image, x 0 to {x[-1]:.2f} mm and y 0 to {y[-1]:.2f} mm; [thickness] roi is x = "
            f"[{across[0]:g}, {across[1]:g}], y = [{down[0]:g}, {down[1]:g}]. Correct roi, or "
            "pixel_pitch in [optics]."
        )
    return Region(rows, columns)


def _slice_between(position: Array, bounds: Interval) -> slice:
    low, high = bounds
    first = int(np.searchsorted(position, low))
    return slice(first, int(np.searchsorted(position, high, side="right")))
