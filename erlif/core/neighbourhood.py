"""Means over blocks of pixels and over the neighbourhood of each pixel."""

from __future__ import annotations

import cv2
import numpy as np

from erlif.core.arrays import Image, Mask

BLOCK = 8
"""Width of the blocks whose light is averaged. [px]"""

_NEAR = 9
"""Width of the neighbourhood of a pixel, unless given. [px]"""

_SAMPLE = 97
"""Step between the pixels whose median is the offset of the sums; a prime, to avoid columns."""


def block_light(one: Image, two: Image, width: int = BLOCK) -> Image:
    """Mean light of both cameras together in square blocks.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of the two cameras on one grid, NaN where unknown. [DN]
    width : int
        Of a block; blocks at the lower and right edge may be smaller. [px]

    Returns
    -------
    array, (row, column)
        NaN where no pixel of a block is known. [DN]

    Examples
    --------
    >>> light = np.float32([[1, 3, 10], [5, 7, np.nan]])
    >>> block_light(light, light, 2)
    array([[ 8., 20.]], dtype=float32)
    """
    light = one + two
    known = np.isfinite(light)
    total = _sum_blocks(light if known.all() else np.where(known, light, np.float32(0)), width)
    count = _sum_blocks(known.astype(np.float32), width)
    return np.where(count > 0, total / np.maximum(count, 1), np.float32(np.nan))


def _sum_blocks(image: Image, width: int) -> Image:
    """Sums over square blocks; those at the lower and right edge may be smaller."""
    # zeros fill up the last blocks
    below, beside = (-size % width for size in image.shape)
    if below or beside:
        image = np.pad(image, ((0, below), (0, beside)))
    rows = image[::width].copy()
    for k in range(1, width):
        rows += image[k::width]
    total = rows[:, ::width].copy()
    for k in range(1, width):
        total += rows[:, k::width]
    return total


def mean_of_surroundings(
    image: Image, sound: Mask, *, width: int = _NEAR, without: int = 0
) -> Image:
    """Mean of the valid pixels in a square about each pixel.

    Parameters
    ----------
    image : array, (y, x)
    sound : array of bool, (y, x)
        Valid pixels.
    width : int
        Of the square, odd. [px]
    without : int
        Width of the middle of the square that is left out, odd, or 0. [px]

    Returns
    -------
    array, (y, x)
        NaN where the square holds no valid pixel. Unit of the image.

    Examples
    --------
    >>> ramp = np.arange(5, dtype=np.float32) * np.ones((3, 1), np.float32)
    >>> mean_of_surroundings(ramp, ramp != 4, width=3)[1]
    array([0.5, 1. , 2. , 2.5, 3. ], dtype=float32)
    """
    # sums of differences from the median: in single precision, sums of large values lose digits
    middle = np.float32(np.median(image[sound][::_SAMPLE])) if sound.any() else np.float32(0)
    values, count = np.where(sound, image - middle, np.float32(0)), sound.astype(np.float32)
    total, count = (
        _sum_over_square(plane, width) - (_sum_over_square(plane, without) if without else 0)
        for plane in (values, count)
    )

    valid = count > 0.5  # whole numbers, up to rounding
    return np.where(valid, middle + total / np.maximum(count, 1), np.float32(np.nan))


def _sum_over_square(image: Image, width: int) -> Image:
    """Sum over a square of a width about each pixel; nothing is added beyond the border."""
    summed = cv2.boxFilter(
        image, -1, (width, width), normalize=False, borderType=cv2.BORDER_CONSTANT
    )
    return np.asarray(summed, np.float32)
