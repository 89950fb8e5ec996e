"""Statistics of a rectangle of a map."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array, FlagImage, Image
from erlif.core.errors import ErlifError

Rectangle = tuple[float, float, float, float]
"""Low and high x, low and high y, included. [mm]"""


def select_region(x: Array, y: Array, region: Rectangle) -> tuple[slice, slice]:
    """Rows and columns whose pixel centres lie in a rectangle.

    Parameters
    ----------
    x, y : array
        Positions of columns and rows, rising. [mm]
    region : (float, float, float, float)
        Low and high x, low and high y, included. [mm]

    Returns
    -------
    (slice, slice)
        Rows and columns.

    Raises
    ------
    ErlifError
        If no pixel lies in it.

    Examples
    --------
    >>> position = 0.1 * np.arange(100)
    >>> select_region(position, position, (1.0, 2.0, 0.0, 0.25))
    (slice(0, 3, None), slice(10, 21, None))
    """
    # positions have rounding errors far below a pixel
    slack = 1e-6 * float(x[-1] - x[0]) / max(x.size - 1, 1)
    columns, rows = (
        slice(
            int(np.searchsorted(axis, low - slack)),
            int(np.searchsorted(axis, high + slack, side="right")),
        )
        for axis, low, high in ((x, *region[:2]), (y, *region[2:]))
    )
    if columns.stop <= columns.start or rows.stop <= rows.start:
        raise ErlifError(
            f"Expected a region with pixels of the map, x {x[0]:.2f} to {x[-1]:.2f} mm and y "
            f"{y[0]:.2f} to {y[-1]:.2f} mm; got x {region[0]:.4g} to {region[1]:.4g}, y "
            f"{region[2]:.4g} to {region[3]:.4g}. Draw another one."
        )
    return rows, columns


def region_statistics(
    values: Image,
    flags: FlagImage,
    std: Image,
    std_shared: Image,
) -> dict[str, float]:
    """Compute count, mean, range and standard deviations of the pixels of a region.

    Parameters
    ----------
    values : array, (y, x)
        A map, cut to the region.
    flags : array, (y, x)
        Bits of `erlif.core.flags.Flag`; flagged pixels are left out.
    std, std_shared : array, (y, x)
        Random and shared standard deviation of the pixels.

    Returns
    -------
    dict
        count of the pixels, and of the valid ones the number, mean, std, min and max; mean_std,
        the random standard deviation of the mean of independent pixels; mean_std_shared, the mean
        of the shared ones. NaN without valid pixels.

    Examples
    --------
    >>> values = np.array([[1, 2], [3, 9]], np.float32)
    >>> flags = np.array([[0, 0], [0, 1]], np.uint8)
    >>> found = region_statistics(values, flags, 0 * values + 0.3, 0 * values + 0.1)
    >>> found["count"], found["valid"], found["mean"], round(found["mean_std"], 4)
    (4, 3, 2.0, 0.1732)
    """
    good = (flags == 0) & np.isfinite(values)
    count = int(np.count_nonzero(good))
    names = ("mean", "std", "min", "max", "mean_std", "mean_std_shared")
    numbers = [float("nan")] * len(names)
    if count:
        inside = values[good].astype(float)
        random, shared = std[good].astype(float), std_shared[good].astype(float)
        error = np.sqrt((random**2).sum()) / count
        found = (inside.mean(), inside.std(), inside.min(), inside.max(), error, shared.mean())
        numbers = [float(one) for one in found]
    return {"count": values.size, "valid": count, **dict(zip(names, numbers, strict=True))}
