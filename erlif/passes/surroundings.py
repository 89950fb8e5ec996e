"""What the surroundings of a pixel decide: whether its noise leaves a thickness, and its slope.

The reference is `erlif.thickness.find_range`.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import AnyArray, Image
from erlif.core.flags import Flag
from erlif.passes.rows import (
    PAD,
    STATES,
    Part,
    Place,
    Ring,
    Step,
    across,
    add_squares,
    number_parts,
    table_of,
)
from erlif.thickness import CLEAR

_BELOW, _ABOVE, _POOR = (
    np.uint8(flag) for flag in (Flag.BELOW_RANGE, Flag.ABOVE_RANGE, Flag.POOR_REGISTRATION)
)
_CLEAR, _HALF, _ZERO, _NONE = np.float32(CLEAR), np.float32(0.5), np.float32(0), np.uint8(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

_SINGLE, _SEVERAL = 17, 9
"""Rows of the rings of single rows, and of sums of several.

A row is used for the last time when 16 or 8 rows have entered after it.
"""

_RATIO, _NOISE = Ring(0, _SINGLE), Ring(17, _SINGLE)
_RATIO_2, _RATIO_4, _RATIO_8 = Ring(34, _SEVERAL), Ring(43, _SEVERAL), Ring(52, _SEVERAL)
_NOISE_2, _NOISE_4 = Ring(61, _SEVERAL), Ring(70, _SEVERAL)
_COUNT_17, _COUNT_9, _COUNT_5 = 79, 80, 81
_SHARES = [Ring(82), Ring(83), Ring(84), Ring(85)]
_PAIR, _DOWN = Ring(86), Ring(87)
_WIDE, _NEAR, _MIDDLE, _SPREAD, _PIXELS_17, _PIXELS_9, _PIXELS_5, _ROWS = range(88, 96)
"""Rows of the buffer."""


def _square(
    several: Ring, newer: int, older: int, single: Ring, at: int, side: int, out: int
) -> list[Step]:
    """Steps that add up a square: two sums of rows and one row, then along the row."""
    return [
        (_PAIR, Place(several, newer), Place(several, older)),
        (_DOWN, Place(_PAIR), Place(single, at)),
        *across(_DOWN, side, _SHARES, Ring(out)),
    ]


_PARTS = [
    # sums of rows; 16 ahead in a ring of 17 rows is the row before, 1 the oldest one
    Part(
        [
            (_RATIO_2, Place(_RATIO), Place(_RATIO, 16)),
            (_NOISE_2, Place(_NOISE), Place(_NOISE, 16)),
            (_RATIO_4, Place(_RATIO_2), Place(_RATIO_2, 7)),
            (_NOISE_4, Place(_NOISE_2), Place(_NOISE_2, 7)),
            (_RATIO_8, Place(_RATIO_4), Place(_RATIO_4, 5)),
        ]
    ),
    # pixels of the three squares, whose middle is the same row
    Part(across(Ring(_COUNT_17), 17, _SHARES, Ring(_PIXELS_17)), _COUNT_17, 17, 0),
    Part(across(Ring(_COUNT_9), 9, _SHARES, Ring(_PIXELS_9)), _COUNT_9, 9, 14),
    Part(across(Ring(_COUNT_5), 5, _SHARES, Ring(_PIXELS_5)), _COUNT_5, 5, 12),
    # sums over the squares
    Part(
        [
            *_square(_RATIO_8, 0, 1, _RATIO, 1, 17, _WIDE),
            *_square(_RATIO_4, 5, 1, _RATIO, 5, 9, _NEAR),
            *_square(_RATIO_2, 3, 1, _RATIO, 7, 5, _MIDDLE),
            *_square(_NOISE_4, 5, 1, _NOISE, 5, 9, _SPREAD),
        ]
    ),
]
_STEPS = number_parts(_PARTS)
_TABLE = table_of([step for part in _PARTS for step in part.steps])


class Surroundings(NamedTuple):
    """Rows that stay in cache; `erlif.passes.rows` explains the rings.

    Attributes
    ----------
    state : AnyArray
        Flags of the rows of the widest square, (row, x).
    rows : Image
        Log ratio, variance and their sums.
    """

    state: AnyArray
    rows: Image

    @classmethod
    def of(cls, width: int) -> Surroundings:
        """Rows of an image of some width, of which nothing has entered yet.

        Parameters
        ----------
        width : int

        Returns
        -------
        Surroundings
        """
        return cls(
            np.ones((STATES, width), np.uint8), np.zeros((_ROWS, width + 2 * PAD), np.float32)
        )


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _enter(  # type: ignore[no-untyped-def]
    log_ratio, variance, displaced, flags, i, extra, offset, state, s, rows, k
):
    """Row i enters: its flags with poor registration and extra bits, its sound pixels."""
    ratio, noise = _at(k), _at(_SINGLE + k)
    y, z = _at(i), _at(s)
    for t in range(flags.shape[1]):
        x = _at(t)
        poor = (flags[y, x] == 0) & (displaced[y, x] > variance[y, x])
        bits = (_POOR if poor else flags[y, x]) | extra
        state[z, x] = bits
        rows[ratio, _at(t + PAD)] = log_ratio[y, x] - offset if bits == 0 else _ZERO
        rows[noise, _at(t + PAD)] = variance[y, x] if bits == 0 else _ZERO


@numba.njit(nogil=True, cache=True, error_model="numpy")
def enter_row(images, u, offset, surroundings):  # type: ignore[no-untyped-def]
    """Add row u to the sums over squares; below the image, no pixel is sound.

    Parameters
    ----------
    images : tuple of array, (y, x)
        Log ratio, its variance, that by the registration, and flags.
    u : int
        Rows enter in turn, and `PAD` more than the image has.
    offset : np.float32
        Log ratio that is subtracted: sums of small numbers keep their digits.
    surroundings : tuple of array
        `Surroundings` as a plain tuple.
    """
    log_ratio, variance, displaced, flags = images
    state, rows = surroundings
    bottom = flags.shape[0] - 1
    at, extra = min(u, bottom), _NONE if u <= bottom else _POOR
    s, k = u % STATES, u % _SINGLE
    _enter(log_ratio, variance, displaced, flags, at, extra, offset, state, s, rows, k)
    add_squares(state, rows, _TABLE, _STEPS, u, u >= PAD)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def decide(  # type: ignore[no-untyped-def]
    log_ratio, i, offset, limits, surroundings, bits_around, near, flags
):
    """Flags of row i, once `PAD` more rows have entered.

    The slope of a curve at a noisy ratio is correlated with its error; half-way to the mean of the
    surroundings it is that of the chord.

    Parameters
    ----------
    log_ratio : array, (y, x)
    i : int
    offset : np.float32
    limits : array, (6,)
        As in `FilmTables`.
    surroundings : tuple of array
    bits_around : array, (x,), uint8
        Receives the flags of the row by its surroundings alone.
    near : array, (x,)
        Receives the log ratio at which the slope is taken.
    flags : array, (y, x), uint8
        Receives the flags of the row, by its own ratio too.
    """
    state, rows = surroundings
    first, last, thinnest, thickest = limits[0], limits[1], limits[2], limits[3]
    lowest, highest = limits[4], limits[5]
    y, z = _at(i), _at(i % STATES)
    for t in range(log_ratio.shape[1]):
        x = _at(t)
        middle, pixels = rows[_MIDDLE, x], rows[_PIXELS_5, x]
        around = offset + (rows[_WIDE, x] - middle) / (rows[_PIXELS_17, x] - pixels)
        margin = _CLEAR * np.sqrt(rows[_SPREAD, x] / rows[_PIXELS_9, x])
        beyond = _BELOW if (around < first) | (around - margin < thinnest) else _NONE
        beyond = _ABOVE if (around > last) | (around + margin > thickest) else beyond
        bits = beyond if state[z, x] == 0 else state[z, x]
        bits_around[x] = bits

        own = log_ratio[y, x]
        single = _BELOW if own < lowest else _NONE
        single = _ABOVE if own > highest else single
        flags[y, x] = single if bits == 0 else bits
        near[x] = _HALF * (own + (offset + rows[_NEAR, x] / rows[_PIXELS_9, x]))
