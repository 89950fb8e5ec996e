"""Surroundings of a pixel, which decide whether it is measurable, and the slope there.

A pixel is outside the measurable range where its noise could make the film zero, or arbitrarily
thick. Its own value must not decide this: pixels selected by their noise leave a biased mean. The
surroundings decide, without the pixel itself, and their noise is many times smaller. Their mean
ratio must lie within the calibrated range, and two standard deviations of a single pixel from the
ends of what the fixture covers. A normal error exceeds this once in 44; Currie (1968) takes 1.645,
once in 20.

Sums over squares come from summed-area tables (Crow
1984): each entry is the sum of all pixels above and to the left, and four of them give the sum over
any rectangle. The tables are of whole numbers, whose differences are exact even after they have
passed the largest one; so a few rows of a table are enough, whatever the size of the image.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Image
from erlif.core.flags import Flag
from erlif.core.speed.kernels import njit

# Distance of a measurable film from the ends of the calibration. [std of a pixel]
CLEAR = 2.0

# Rows and columns between a pixel and the end of the widest square, 17 px. [px]
PAD = 8

# Rows that are kept: those of the widest square, and the one above it.
_KEPT = 18

_BELOW, _ABOVE, _POOR = (
    np.uint16(flag) for flag in (Flag.BELOW_RANGE, Flag.ABOVE_RANGE, Flag.POOR_REGISTRATION)
)
_CLEAR, _HALF, _ZERO, _NONE = np.float32(CLEAR), np.float32(0.5), np.float32(0), np.uint16(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# Whole numbers per log ratio: the mean over 81 pixels is then rounded by 1e-7 at most.
_PER_RATIO = np.float32(2**19)
# Log ratios farther from the offset, a factor of 1e6, are taken as this; 289 stay below 2^31.
_FARTHEST = np.float32(14)

# Whole numbers per median variance; a mean over 81 pixels is then rounded by 1e-5 of it.
_PER_MEDIAN = 2.0**13
# Variances beyond, 3000 times the median, are taken as this; 81 of them stay below 2^31.
_LARGEST = np.float32(2**31 // 81 - 2)

_PIXEL, _MIDDLE, _BITS = np.int64(2**32), np.int64(2**31), np.int64(32)
# A sound pixel in the upper half of a number whose lower half is its log ratio.
_NO_PIXEL, _NO_NOISE = np.int64(0), np.int32(0)


class Surroundings(NamedTuple):
    """Rows that stay in cache; row u of an image is stored as row u modulo their number.

    Attributes
    ----------
    state : AnyArray
        Flags, (row, x).
    ratios : AnyArray
        Summed-area table of the log ratio, and in the upper half of each number of sound pixels.
    noise : AnyArray
        Summed-area table of the variance.
    around : Image
        Log ratio about each pixel of one row, and number of pixels in the square of 9 px.
    units : Image
        Log ratio that is subtracted, and whole numbers per unit of variance.
    """

    state: AnyArray
    ratios: AnyArray
    noise: AnyArray
    around: Image
    units: Image

    @classmethod
    def of(cls, width: int, *, offset: float, variance: float) -> Surroundings:
        """Rows of an image of some width, of which nothing has entered yet.

        Parameters
        ----------
        width : int
        offset : float
            Log ratio that is subtracted before summing: sums of small numbers keep their digits.
        variance : float
            Median variance.

        Returns
        -------
        Surroundings
        """
        size = _KEPT, width + 2 * PAD + 1
        per_variance = _PER_MEDIAN / variance if variance > 0 else 1.0
        return cls(
            np.ones((_KEPT, width), np.uint16),
            np.zeros(size, np.int64),
            np.zeros(size, np.int32),
            np.empty((2, width), np.float32),
            np.array([offset, per_variance], np.float32),
        )


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
def enter_row(images, u, surroundings):  # type: ignore[no-untyped-def]
    """Add row u to the sums over squares; below the image, no pixel is sound.

    Parameters
    ----------
    images : tuple of array, (y, x)
        Log ratio, its variance, that by the registration, and flags.
    u : int
        Rows enter in turn, and `PAD` more than the image has.
    surroundings : tuple of array
        `Surroundings` as a plain tuple.
    """
    log_ratio, variance, displaced, flags = images
    state, ratios, noise, _, units = surroundings
    offset, per_variance = units[0], units[1]
    height, width = flags.shape
    extra = _NONE if u < height else _POOR
    y, z, before = _at(min(u, height - 1)), _at(u % _KEPT), _at((u - 1) % _KEPT)
    for t in range(width):
        x = _at(t)
        poor = (flags[y, x] == 0) & (displaced[y, x] > variance[y, x])
        state[z, x] = (_POOR if poor else flags[y, x]) | extra

    # entry PAD + 1 + x of a table belongs to pixel x; those before it are 0
    for t in range(width):
        x, entry = _at(t), _at(t + PAD + 1)
        sound = state[z, x] == 0
        ratio = log_ratio[y, x] - offset
        ratio = ratio if ratio > -_FARTHEST else -_FARTHEST
        ratio = ratio if ratio < _FARTHEST else _FARTHEST
        whole = np.int64(np.int32(np.floor(ratio * _PER_RATIO + _HALF)))
        ratios[z, entry] = whole + _PIXEL if sound else _NO_PIXEL
        share = variance[y, x] * per_variance + _HALF
        share = share if share < _LARGEST else _LARGEST
        noise[z, entry] = np.int32(share) if sound else _NO_NOISE

    ratio, share = np.int64(0), np.int32(0)
    for t in range(PAD + 1, PAD + 1 + width):
        entry = _at(t)
        ratio += ratios[z, entry]
        share = np.int32(share + noise[z, entry])
        ratios[z, entry] = ratios[before, entry] + ratio
        noise[z, entry] = noise[before, entry] + share
    for t in range(PAD + 1 + width, ratios.shape[1]):
        ratios[z, _at(t)] = ratios[z, _at(PAD + width)]
        noise[z, _at(t)] = noise[z, _at(PAD + width)]


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
def decide(  # type: ignore[no-untyped-def]
    log_ratio, i, limits, surroundings, bits_around, near, flags
):
    """Flags of row i, once `PAD` more rows have entered.

    The slope of a curve at a noisy ratio is correlated with its error; half-way to the mean of the
    surroundings it is that of the chord.

    Parameters
    ----------
    log_ratio : array, (y, x)
    i : int
    limits : array, (6,)
        As in `FilmTables`.
    surroundings : tuple of array
        `Surroundings` as a plain tuple.
    bits_around : array, (x,), uint16
        Receives the flags of the row by its surroundings alone.
    near : array, (x,)
        Receives the log ratio at which the slope is taken.
    flags : array, (y, x), uint16
        Receives the flags of the row, by its own ratio too.
    """
    state, ratios, noise, around, units = surroundings
    offset, per_variance = units[0], units[1]
    first, last, thinnest, thickest = limits[0], limits[1], limits[2], limits[3]
    lowest, highest = limits[4], limits[5]
    y, z = _at(i), _at(i % _KEPT)

    # rows of the tables at the lower end of the squares of 17, 9 and 5 px, and above the upper one
    a, b = _at((i + 8) % _KEPT), _at((i - 9) % _KEPT)
    c, d = _at((i + 4) % _KEPT), _at((i - 5) % _KEPT)
    e, f = _at((i + 2) % _KEPT), _at((i - 3) % _KEPT)

    # few rows a loop: more would need more comparisons of addresses than the compiler accepts
    for t in range(log_ratio.shape[1]):
        left, right, inner, outer = _at(t), _at(t + 17), _at(t + 6), _at(t + 11)
        square = (ratios[a, right] - ratios[a, left]) - (ratios[b, right] - ratios[b, left])
        square -= (ratios[e, outer] - ratios[e, inner]) - (ratios[f, outer] - ratios[f, inner])
        pixels = np.int32((square + _MIDDLE) >> _BITS)
        mean = np.float32(np.int32(square)) / (_PER_RATIO * np.float32(pixels))
        around[_at(0), _at(t)] = offset + mean
    for t in range(log_ratio.shape[1]):
        x, left, right = _at(t), _at(t + 4), _at(t + 13)
        square = (ratios[c, right] - ratios[c, left]) - (ratios[d, right] - ratios[d, left])
        pixels = np.int32((square + _MIDDLE) >> _BITS)
        mean = np.float32(np.int32(square)) / (_PER_RATIO * np.float32(pixels))
        near[x] = _HALF * (log_ratio[y, x] + (offset + mean))
        around[_at(1), x] = np.float32(pixels)
    for t in range(log_ratio.shape[1]):
        x, left, right = _at(t), _at(t + 4), _at(t + 13)
        square = (noise[c, right] - noise[c, left]) - (noise[d, right] - noise[d, left])
        spread = np.float32(np.int32(square)) / (per_variance * around[_at(1), x])
        margin, mean = _CLEAR * np.sqrt(spread), around[_at(0), x]
        beyond = _BELOW if (mean < first) | (mean - margin < thinnest) else _NONE
        beyond = _ABOVE if (mean > last) | (mean + margin > thickest) else beyond
        bits_around[x] = beyond if state[z, x] == 0 else state[z, x]
    for t in range(log_ratio.shape[1]):
        x = _at(t)
        own = log_ratio[y, x]
        single = _BELOW if own < lowest else _NONE
        single = _ABOVE if own > highest else single
        flags[y, x] = single if bits_around[x] == 0 else bits_around[x]
