"""Bubbles and bare wall: places where the fluorescence of both bands is missing."""

from __future__ import annotations

import cv2
import numba
import numpy as np
from scipy import ndimage

from erlif.core.arrays import Image, Mask
from erlif.core.neighbourhood import BLOCK, block_light

_REACH = 9
"""Width of the surroundings whose median is the undisturbed light. [blocks]"""


def find_bubbles(one: Image, two: Image, *, share: float, margin: int = 3) -> Mask:
    """Find where fluorescence is missing from both cameras.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of the two cameras on one grid; a pixel with NaN is not dark. [DN]
    share : float
        A pixel is dark below this share of the median light about it, over 9 x 9 blocks of 8 px.
    margin : int
        Width of the meniscus about a dark patch, which is marked with it. [px]

    Returns
    -------
    array of bool, (y, x)

    Examples
    --------
    >>> light = np.full((48, 64), 1000, np.float32)
    >>> light[20, 30] = 50
    >>> bubble = find_bubbles(light, light, share=0.25, margin=1)
    >>> np.argwhere(bubble).tolist()
    [[19, 30], [20, 29], [20, 30], [20, 31], [21, 30]]
    """
    blocks = block_light(one, two, BLOCK)
    known = np.isfinite(blocks)
    if not known.any():
        return np.zeros(one.shape, bool)

    filled = np.where(known, blocks, np.median(blocks[known]))
    surroundings = ndimage.median_filter(filled, size=_REACH, mode="nearest")
    dark = _below(one, two, share * surroundings, BLOCK)
    if not dark.any():
        return np.asarray(dark, bool)

    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * margin + 1, 2 * margin + 1))
    return cv2.dilate(dark, disc).astype(bool)


@numba.njit(nogil=True, cache=True)
def _below(one, two, limit, block):  # type: ignore[no-untyped-def]
    """Pixels with less light than a limit given per block, interpolated between their centres."""
    height, width = one.shape
    rows, columns = limit.shape
    dark = np.zeros((height, width), np.uint8)
    for i in range(height):
        # position among the centres of the blocks; beyond the outermost the limit is constant
        y = min(max((i + 0.5) / block - 0.5, 0.0), rows - 1.0)
        k = min(int(y), rows - 2)
        v = y - k

        for j in range(width):
            x = min(max((j + 0.5) / block - 0.5, 0.0), columns - 1.0)
            m = min(int(x), columns - 2)
            u = x - m

            top = limit[k, m] + u * (limit[k, m + 1] - limit[k, m])
            bottom = limit[k + 1, m] + u * (limit[k + 1, m + 1] - limit[k + 1, m])
            if one[i, j] + two[i, j] < top + v * (bottom - top):
                dark[i, j] = 1
    return dark
