"""Bubbles and bare wall: places where both bands lack fluorescence."""

from __future__ import annotations

import cv2
import numba
import numpy as np
from scipy import ndimage

from erlif.core.arrays import Image, Mask
from erlif.core.neighbourhood import BLOCK, block_light

_REACH = 9  # surroundings of a bubble: the median of 9 x 9 blocks of 8 px


def find_bubbles(one: Image, two: Image, *, share: float, margin: int = 3) -> Mask:
    """Find where fluorescence is missing from both cameras.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of the two cameras on one grid; NaN counts as lit.
    share : float
        A pixel counts as dark below this share of the median light about it, taken over 9 x 9 blocks of 8 px.
    margin : int
        Pixels about a dark patch that are taken for its meniscus.

    Returns
    -------
    array of bool, (y, x)
    """
    blocks = block_light(one, two, BLOCK)
    known = np.isfinite(blocks)
    if not known.any():
        return np.zeros(one.shape, bool)
    surroundings = ndimage.median_filter(
        np.where(known, blocks, np.median(blocks[known])), size=_REACH, mode="nearest"
    )
    dark = _below(one, two, share * surroundings, BLOCK)
    if not dark.any():
        return np.asarray(dark, bool)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * margin + 1, 2 * margin + 1))
    return cv2.dilate(dark, disc).astype(bool)


@numba.njit(nogil=True, cache=True)
def _below(one, two, limit, block):  # type: ignore[no-untyped-def]
    """Pixels whose light is below `limit`, given per block and interpolated between the centres of blocks."""
    height, width = one.shape
    rows, columns = limit.shape
    dark = np.zeros((height, width), np.uint8)
    for i in range(height):
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
