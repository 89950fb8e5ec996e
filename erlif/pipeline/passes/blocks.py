"""Sums over the blocks of a region, added up row by row beside the maps.

`erlif.trend.sum_blocks` makes the same sums from finished maps. Rows of one block are added down
the columns first, and along the row once the block is complete.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.flags import Flag
from erlif.trend import BLOCK, BlockSums, Region

_BELOW, _ABOVE = (np.uint16(flag) for flag in (Flag.BELOW_RANGE, Flag.ABOVE_RANGE))
_ZERO = np.float32(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# Sums of each block.
_SUMS = 9

# Units of three numbers that are packed into one; eight of them stay below 2^24, exact.
_FIRST, _SECOND, _THIRD = np.float32(1), np.float32(2**8), np.float32(2**16)


class BlockRows(NamedTuple):
    """What `add_to_blocks` adds up, and the places of pixels within their blocks.

    Attributes
    ----------
    edges : AnyArray
        First row, row below the last, first column and column right of the last of the region.
    sums : Image
        Sums down the columns of one row of blocks, (sum, x).
    places : Image
        Packed place of each row of a block.
    columns : Image
        Packed place of each column, (x,).
    blocks : Array
        Sums of the blocks that are complete, (sum, row, column).
    """

    edges: AnyArray
    sums: Image
    places: Image
    columns: Image
    blocks: Array

    @classmethod
    def of(cls, shape: tuple[int, int], region: Region) -> BlockRows:
        """Sums over a region of an image, of which nothing has been added yet.

        Parameters
        ----------
        shape : tuple of int
            Rows and columns of the image.
        region : Region

        Returns
        -------
        BlockRows
        """
        top, bottom, _ = region.rows.indices(shape[0])
        left, right, _ = region.columns.indices(shape[1])
        size = -(-(bottom - top) // BLOCK), -(-(right - left) // BLOCK)
        return cls(
            np.array([top, bottom, left, right]),
            np.zeros((_SUMS, shape[1]), np.float32),
            _pack(np.arange(BLOCK)),
            _pack((np.arange(shape[1]) - left) % BLOCK),
            np.zeros((_SUMS, *size)),
        )

    def named(self, offset: float, noise_correlation: float) -> BlockSums:
        """Sums by name, in the order in which `_accumulate` fills them; places within the region.

        Parameters
        ----------
        offset : float
            Log ratio that was subtracted before summing. [1]
        noise_correlation : float
            Variance of a mean over many pixels, relative to that of independent pixels. [1]

        Returns
        -------
        BlockSums
        """
        top, bottom, left, right = self.edges.tolist()
        lit_ratio, lit_var, rows, columns, ratio, squared, var, displaced, marks = self.blocks
        lit, row, row_squared = _unpack(rows)
        _, column, column_squared = _unpack(columns)
        measurable, valid, beyond = _unpack(marks)

        # places within a block become places within the region
        down, along = (BLOCK * index for index in np.indices(lit.shape, float))
        return BlockSums(
            (bottom - top, right - left),
            offset,
            lit,
            lit_ratio,
            lit_var,
            row + down * lit,
            row_squared + 2 * down * row + down**2 * lit,
            column + along * lit,
            column_squared + 2 * along * column + along**2 * lit,
            measurable,
            ratio,
            squared,
            var,
            displaced,
            int(valid.sum()),
            int(beyond.sum()),
            noise_correlation,
        )


def _pack(place: AnyArray) -> Image:
    """Number, place and square of the place of a pixel within its block, in one number."""
    return (_FIRST + _SECOND * place + _THIRD * place**2).astype(np.float32)


def _unpack(packed: Array) -> tuple[Array, Array, Array]:
    """Sums of three packed numbers, of which the first two are below 256."""
    whole = packed.astype(np.int64)
    first, second, third = whole & 255, (whole >> 8) & 255, whole >> 16
    return first.astype(float), second.astype(float), third.astype(float)


@numba.njit(nogil=True, cache=True, error_model="numpy", inline="always")
def _accumulate(  # type: ignore[no-untyped-def]
    log_ratio, variance, displaced, lit, i, place, offset, around, flags, columns, sums
):
    """Add row i to the sums down the columns; `BlockRows.named` has their order.

    Numbers of pixels are packed, a byte each, as a block has 64 pixels.
    """
    # few rows a loop: more would need more comparisons of addresses than the compiler accepts
    for j in range(flags.shape[1]):
        some = lit[i, j] == 0
        sums[0, j] += log_ratio[i, j] - offset if some else _ZERO
        sums[1, j] += variance[i, j] if some else _ZERO
    for j in range(flags.shape[1]):
        some = lit[i, j] == 0
        sums[2, j] += place if some else _ZERO
        sums[3, j] += columns[j] if some else _ZERO
    for j in range(flags.shape[1]):
        ratio = log_ratio[i, j] - offset
        good = around[j] == 0
        sums[4, j] += ratio if good else _ZERO
        sums[5, j] += ratio * ratio if good else _ZERO
    for j in range(flags.shape[1]):
        good = around[j] == 0
        sums[6, j] += variance[i, j] if good else _ZERO
        sums[7, j] += displaced[i, j] if good else _ZERO
    for j in range(flags.shape[1]):
        outside = (flags[i, j] == _BELOW) | (flags[i, j] == _ABOVE)
        mark = (_FIRST if around[j] == 0 else _ZERO) + (_SECOND if flags[i, j] == 0 else _ZERO)
        sums[8, j] += mark + (_THIRD if outside else _ZERO)


@numba.njit(nogil=True, cache=True, error_model="numpy", inline="always")
def _close_blocks(sums, row, left, right, blocks):  # type: ignore[no-untyped-def]
    """Add up a row of blocks along the row, and begin the next."""
    for q in range(sums.shape[0]):
        for n in range(blocks.shape[2]):
            total = 0.0
            for t in range(left + BLOCK * n, min(left + BLOCK * (n + 1), right)):
                total += sums[q, _at(t)]
                sums[q, _at(t)] = _ZERO
            blocks[q, row, n] = total


@numba.njit(nogil=True, cache=True, error_model="numpy", inline="always")
def add_to_blocks(images, i, offset, around, flags, block_rows):  # type: ignore[no-untyped-def]
    """Add row i of the images, if it lies in the region, and close the blocks that it completes.

    Parameters
    ----------
    images : tuple of array, (y, x)
        Log ratio, its variance, that by the registration, and flags.
    i : int
    offset : np.float32
        Log ratio that is subtracted. [1]
    around : array, (x,), uint16
        Flags of the row by the surroundings alone.
    flags : array, (y, x), uint16
        Flags of the map.
    block_rows : tuple of array
        `BlockRows` as a plain tuple.
    """
    log_ratio, variance, displaced, lit = images
    edges, sums, places, columns, blocks = block_rows
    top, bottom, left, right = edges[0], edges[1], edges[2], edges[3]
    if i < top or i >= bottom:
        return
    place = places[(i - top) % BLOCK]
    _accumulate(log_ratio, variance, displaced, lit, i, place, offset, around, flags, columns, sums)
    if (i - top) % BLOCK == BLOCK - 1 or i == bottom - 1:
        _close_blocks(sums, (i - top) // BLOCK, left, right, blocks)
