"""Measurements on maps: profiles along a line, statistics of a rectangle, differences."""

from __future__ import annotations

from typing import Any

import numpy as np

from erlif.core.arrays import Array, FlagImage, Image
from erlif.core.errors import ErlifError

_LONGEST, _WIDEST = 100_000, 500  # pixels along a profile, and across its line

# x and y of the first and the last point. [mm]
Line = tuple[float, float, float, float]

# Position of the first pixel, and distance of two. [mm]
Axis = tuple[float, float]

# Low and high x, low and high y, included. [mm]
Rectangle = tuple[float, float, float, float]


def line_profile(
    values: Image, std: Image, line: Line, *, x: Axis, y: Axis, width: int = 1
) -> dict[str, Array]:
    """Read a map along a line, and average over its width.

    Each point has the value of the nearest pixel: what is drawn is what was measured.

    Parameters
    ----------
    values, std : array, (y, x)
        A map and the random standard deviation of its pixels; NaN where flagged.
    line : (float, float, float, float)
        x and y of the first point, x and y of the last. [mm]
    x, y : (float, float)
        Position of the first pixel along each axis, and distance of two pixels. [mm]
    width : int
        Width over which is averaged. [px]

    Returns
    -------
    dict of array, (point,)
        position, the distance from the first point [mm]; value, the mean over the width; std, its
        random standard deviation. NaN without valid pixels, and where the line leaves the map.

    Raises
    ------
    ErlifError
        If the line is longer or wider than any image.

    Examples
    --------
    A plane that rises by 1 along x and by 10 along y:

    >>> plane = np.add.outer(10.0 * np.arange(5), np.arange(8)).astype(np.float32)
    >>> grid = {"x": (0.0, 0.5), "y": (0.0, 0.5)}
    >>> profile = line_profile(plane, np.ones_like(plane), (1.0, 0.0, 1.0, 2.0), **grid)
    >>> profile["value"].tolist(), profile["position"].tolist()
    ([2.0, 12.0, 22.0, 32.0, 42.0], [0.0, 0.5, 1.0, 1.5, 2.0])
    """
    from skimage.measure import profile_line

    x0, y0, x1, y1 = line
    start = ((y0 - y[0]) / y[1], (x0 - x[0]) / x[1])
    end = ((y1 - y[0]) / y[1], (x1 - x[0]) / x[1])
    if np.hypot(end[0] - start[0], end[1] - start[1]) > _LONGEST or not 1 <= width <= _WIDEST:
        raise ErlifError(
            f"Expected a line of at most {_LONGEST} px and a width from 1 to {_WIDEST} px; got "
            f"{line} mm and {width} px. Draw a shorter one."
        )

    # the nearest pixels, each with its own value; NaN beyond the map
    options: dict[str, Any] = {"order": 0, "mode": "constant", "cval": np.nan}
    options |= {"linewidth": width, "reduce_func": None}

    def along(image: Image) -> Array:
        profile = profile_line(  # type: ignore[no-untyped-call]
            np.asarray(image, float), start, end, **options
        )
        return np.asarray(profile).reshape(profile.shape[0], -1)

    # pixels without a value neither count nor lower the error of the others
    across, spread = along(values), along(std)
    good = np.isfinite(across)
    count = good.sum(axis=1)
    with np.errstate(invalid="ignore"):
        mean = np.where(good, across, 0).sum(axis=1) / np.where(count, count, np.nan)
        variance = np.where(good, spread, 0) ** 2
        error = np.sqrt(variance.sum(axis=1)) / np.where(count, count, np.nan)
    position = np.linspace(0, np.hypot(x1 - x0, y1 - y0), mean.size)
    return {"position": position, "value": mean, "std": error}


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
        left, right, top, bottom = region
        raise ErlifError(
            f"Expected a region with pixels of the map, x {x[0]:.2f} to {x[-1]:.2f} mm and y "
            f"{y[0]:.2f} to {y[-1]:.2f} mm; got x {left:.4g} to {right:.4g}, y {top:.4g} to "
            f"{bottom:.4g}. Draw another one."
        )
    return rows, columns


def region_statistics(
    values: Image, flags: FlagImage, std: Image, std_shared: Image
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
    >>> flags = np.array([[0, 0], [0, 1]], np.uint16)
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


def subtract_maps(
    one: tuple[Image, Image, FlagImage], other: tuple[Image, Image, FlagImage]
) -> tuple[Image, Image, FlagImage]:
    """Subtract the first map from the second.

    Parameters
    ----------
    one, other : tuple of array, (y, x)
        First and second map: values, random standard deviation and flags of a map.

    Returns
    -------
    tuple of array
        Difference, its random standard deviation, and the flags of both. Errors that two maps
        share, such as that of one calibration, cancel in part and are left out.

    Examples
    --------
    >>> flags = np.zeros((1, 2), np.uint16)
    >>> thick = (np.full((1, 2), 5, np.float32), np.full((1, 2), 0.3, np.float32), flags)
    >>> thin = (np.full((1, 2), 4, np.float32), np.full((1, 2), 0.4, np.float32), flags | [0, 2])
    >>> difference, std, flags = subtract_maps(thin, thick)
    >>> difference.tolist(), std.tolist(), flags.tolist()
    ([[1.0, nan]], [[0.5, nan]], [[0, 2]])
    """
    # a difference is known where both maps are
    flags = (one[2] | other[2]).astype(np.uint16)
    valid = flags == 0
    difference = np.where(valid, other[0] - one[0], np.nan).astype(np.float32)
    std = np.where(valid, np.hypot(one[1], other[1]), np.nan).astype(np.float32)
    return difference, std, flags


def significance(difference: Image, std: Image) -> Image:
    """Divide a difference by its standard deviation.

    Parameters
    ----------
    difference, std : array, (y, x)
        From `subtract_maps`.

    Returns
    -------
    array, (y, x)
        NaN where there is no difference, or no standard deviation.

    Examples
    --------
    >>> significance(np.full((1, 1), 1, np.float32), np.full((1, 1), 0.5, np.float32)).tolist()
    [[2.0]]
    """
    ratio = np.full(difference.shape, np.nan, np.float32)
    np.divide(difference, std, out=ratio, where=std > 0)
    return ratio
