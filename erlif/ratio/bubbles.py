"""Bubbles and bare wall: places where the fluorescence of both bands is missing."""

from __future__ import annotations

import cv2
import numpy as np

from erlif.core.arrays import FlagImage, Image, Mask
from erlif.core.flags import Flag
from erlif.core.speed.kernels import njit

# Width of the blocks whose light is averaged. [px]
_BLOCK = 16

# Width of the meniscus about a dark patch, which is marked with it. [px]
_MARGIN = 3

# Half width of each row of that disc; the meniscus bends the light beside a bubble. [px]
_DISC = (
    cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _MARGIN + 1, 2 * _MARGIN + 1)).sum(axis=1)
    // 2
).astype(np.int64)

# Width of the surroundings whose median is the undisturbed light. [blocks]
_REACH = 5

_ZERO, _ONE, _INFINITE, _NAN = (np.float32(value) for value in (0, 1, np.inf, np.nan))

_NO_FILM = np.uint16(Flag.NO_FILM)

# Relative margin of a comparison of sums in single precision.
_ROUNDING = 1e-6


def find_bubbles(one: Image, two: Image, *, share: float) -> Mask:
    """Find where fluorescence is missing from both cameras.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of the two cameras on one grid; a pixel with NaN is not dark. [DN]
    share : float
        A pixel is dark below this share of the median light about it, over 5 x 5 blocks of 16 px.

    Returns
    -------
    array of bool, (y, x)
        True in dark patches and the meniscus of 3 px about them.

    Examples
    --------
    >>> light = np.full((48, 64), 1000, np.float32)
    >>> light[20, 30] = 50
    >>> bubble = find_bubbles(light, light, share=0.25)
    >>> np.flatnonzero(bubble[20]).tolist()
    [27, 28, 29, 30, 31, 32, 33]
    """
    dark = np.zeros(one.shape, np.uint16)
    flag_bubbles(one, two, dark, share=share)
    return np.asarray(dark != 0)


def flag_bubbles(one: Image, two: Image, flags: FlagImage, *, share: float) -> None:
    """Add no_film to the flags where `find_bubbles` finds something.

    Parameters
    ----------
    one, two, share
        As of `find_bubbles`.
    flags : array, (y, x)
        Bits of `Flag`, changed in place.

    Examples
    --------
    >>> light = np.full((48, 64), 1000, np.float32)
    >>> light[20, 30] = 50
    >>> flags = np.zeros(light.shape, np.uint16)
    >>> flag_bubbles(light, light, flags, share=0.25)
    >>> Flag(int(flags[20, 27])).name
    'NO_FILM'
    """
    blocks, least = _measure_blocks(one, two, _BLOCK)
    # a block that one camera does not see must not enter a median
    known = np.isfinite(blocks)
    if not known.any():
        return

    filled = np.where(known, blocks, np.median(blocks[known]))
    limit = share * cv2.medianBlur(filled, _REACH)

    # the limit of a pixel lies between those of its own and the neighbouring blocks
    highest = cv2.dilate(limit, np.ones((3, 3), np.uint8))
    near = least < highest * (1 + _ROUNDING)
    if near.any():
        _flag_dark(one, two, limit, near, _BLOCK, _DISC, flags)


@njit(nogil=True, cache=True, error_model="numpy", fastmath={"nsz", "contract"})
def _measure_blocks(one, two, block):  # type: ignore[no-untyped-def]
    """Mean and least light of both cameras together in square blocks; NaN and infinity without."""
    height, width = one.shape
    rows, columns = (height + block - 1) // block, (width + block - 1) // block
    mean = np.empty((rows, columns), np.float32)
    least = np.empty((rows, columns), np.float32)
    total = np.empty(width, np.float32)
    count = np.empty(width, np.float32)
    lowest = np.empty(width, np.float32)

    for k in range(rows):
        # first over the rows of the blocks, for all columns at once
        total[:] = _ZERO
        count[:] = _ZERO
        lowest[:] = _INFINITE
        for i in range(k * block, min((k + 1) * block, height)):
            for j in range(width):
                light = one[i, j] + two[i, j]
                known = abs(light) < _INFINITE
                total[j] += light if known else _ZERO
                count[j] += _ONE if known else _ZERO
                lowest[j] = light if light < lowest[j] else lowest[j]

        for m in range(columns):
            level, known_pixels, low = _ZERO, _ZERO, _INFINITE
            for j in range(m * block, min((m + 1) * block, width)):
                level += total[j]
                known_pixels += count[j]
                low = min(low, lowest[j])
            mean[k, m] = level / known_pixels if known_pixels > _ZERO else _NAN
            least[k, m] = low
    return mean, least


@njit(nogil=True, cache=True)
def _flag_dark(one, two, limit, near, block, disc, flags):  # type: ignore[no-untyped-def]
    """Flag pixels with less light than a limit given per block, interpolated between centres.

    Only the blocks of `near` are searched. A disc about each pixel is flagged, of which the half
    width of each row is given.
    """
    height, width = one.shape
    rows, columns = limit.shape
    for row, column in np.argwhere(near):
        first, last = column * block, min((column + 1) * block, width)
        for i in range(row * block, min((row + 1) * block, height)):
            # position among the centres of the blocks; beyond the outermost the limit is constant
            y = min(max((i + 0.5) / block - 0.5, 0.0), rows - 1.0)
            k = min(int(y), rows - 2)
            v = y - k

            begin = last
            for j in range(first, last + 1):
                dark = False
                if j < last:
                    x = min(max((j + 0.5) / block - 0.5, 0.0), columns - 1.0)
                    m = min(int(x), columns - 2)
                    u = x - m
                    top = limit[k, m] + u * (limit[k, m + 1] - limit[k, m])
                    bottom = limit[k + 1, m] + u * (limit[k + 1, m + 1] - limit[k + 1, m])
                    dark = one[i, j] + two[i, j] < top + v * (bottom - top)
                if dark:
                    begin = min(begin, j)
                elif begin < last:
                    _flag_about(i, begin, j, disc, flags)
                    begin = last


@njit(nogil=True, cache=True)
def _flag_about(row, begin, end, disc, flags):  # type: ignore[no-untyped-def]
    """Flag the discs about the pixels of a row from begin to end."""
    for n in range(disc.size):
        i = row + n - disc.size // 2
        if 0 <= i < flags.shape[0]:
            for j in range(max(begin - disc[n], 0), min(end + disc[n], flags.shape[1])):
                flags[i, j] |= _NO_FILM
