"""The difference of two maps."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import FlagImage, Image


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
    >>> flags = np.zeros((1, 2), np.uint8)
    >>> thick = (np.full((1, 2), 5, np.float32), np.full((1, 2), 0.3, np.float32), flags)
    >>> thin = (np.full((1, 2), 4, np.float32), np.full((1, 2), 0.4, np.float32), flags | [0, 2])
    >>> difference, std, flags = subtract_maps(thin, thick)
    >>> difference.tolist(), std.tolist(), flags.tolist()
    ([[1.0, nan]], [[0.5, nan]], [[0, 2]])
    """
    flags = (one[2] | other[2]).astype(np.uint8)
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
