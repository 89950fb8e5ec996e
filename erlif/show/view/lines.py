"""Profiles of a map along a line in any direction."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array, Image
from erlif.core.errors import ErlifError

_LONGEST = 100_000
"""Points of a profile. [px]"""

_WIDEST = 500
"""Width of a line. [px]"""

Line = tuple[float, float, float, float]
"""x and y of the first and the last point. [mm]"""

Axis = tuple[float, float]
"""Position of the first pixel, and distance of two. [mm]"""


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

    def along(image: Image) -> Array:
        found = profile_line(  # type: ignore[no-untyped-call]
            np.asarray(image, float),
            start,
            end,
            linewidth=width,
            order=0,
            mode="constant",
            cval=np.nan,
            reduce_func=None,
        )
        return np.asarray(found).reshape(found.shape[0], -1)

    across, spread = along(values), along(std)
    good = np.isfinite(across)
    count = good.sum(axis=1)
    with np.errstate(invalid="ignore"):
        mean = np.where(good, across, 0).sum(axis=1) / np.where(count, count, np.nan)
        variance = np.where(good, spread, 0) ** 2
        error = np.sqrt(variance.sum(axis=1)) / np.where(count, count, np.nan)
    position = np.linspace(0, np.hypot(x1 - x0, y1 - y0), mean.size)
    return {"position": position, "value": mean, "std": error}
