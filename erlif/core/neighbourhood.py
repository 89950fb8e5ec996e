"""Means over the neighbourhood of each pixel."""

from __future__ import annotations

import cv2
import numba
import numpy as np

from erlif.core.arrays import Image, Mask

_NEAR = 9  # width of the surroundings of a pixel, if not said otherwise [px]


_BLOCK = 8  # blocks of pixels whose light is averaged [px]


@numba.njit(nogil=True, cache=True)
def _block_light(one, two, block):  # type: ignore[no-untyped-def]
    """Mean light of both cameras in each block; NaN where no pixel is known."""
    height, width = one.shape
    rows, columns = (height + block - 1) // block, (width + block - 1) // block
    total = np.zeros((rows, columns), np.float32)
    count = np.zeros((rows, columns), np.float32)
    for i in range(height):
        for j in range(width):
            light = one[i, j] + two[i, j]
            if np.isfinite(light):
                total[i // block, j // block] += light
                count[i // block, j // block] += 1
    for i in range(rows):
        for j in range(columns):
            total[i, j] = total[i, j] / count[i, j] if count[i, j] > 0 else np.nan
    return total


def mean_of_surroundings(
    image: Image, sound: Mask, *, width: int = _NEAR, without: int = 0
) -> Image:
    """Mean of the sound pixels in a square about each pixel; NaN where there are none.

    Parameters
    ----------
    image : array, (y, x)
    sound : array of bool, (y, x)
        Pixels that count.
    width : int
        Of the square. [px]
    without : int
        Width of the middle of the square that is left out. [px]
    """
    # about the middle, because the sums are taken in single precision
    middle = np.float32(np.median(image[sound][::97])) if sound.any() else np.float32(0)
    values, count = np.where(sound, image - middle, np.float32(0)), sound.astype(np.float32)
    total, count = (
        _box(plane, width) - (_box(plane, without) if without else 0) for plane in (values, count)
    )
    return np.where(count > 0.5, middle + total / np.maximum(count, 1), np.float32(np.nan))


def _box(image: Image, width: int) -> Image:
    summed = cv2.boxFilter(
        image, -1, (width, width), normalize=False, borderType=cv2.BORDER_CONSTANT
    )
    return np.asarray(summed, np.float32)
