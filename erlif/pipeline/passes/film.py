"""Ratio of a trigger to its maps and to the sums for its statistics, in one pass over rows.

`erlif.thickness.measure_thickness` makes the same maps without the sums.

The sums are those of the blocks of a region, added up row by row.

`erlif.trend.sum_blocks` makes the same sums from finished maps. Rows of one block are added down
the columns first, and along the row once the block is complete.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.calibration import Reabsorption
from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.flags import Flag
from erlif.core.speed.kernels import njit
from erlif.ratio import PairRatio
from erlif.thickness import FilmTables, compare_light, middle_of
from erlif.thickness.maps import LookUpRows, fill_maps, find_medians, look_up
from erlif.thickness.surroundings import PAD, Surroundings, decide, enter_row
from erlif.trend import BLOCK, BlockSums, Region

_NOWHERE = Region(slice(0, 0), slice(0, 0))


class FilmMaps(NamedTuple):
    """Maps of a trigger as plain arrays, (y, x), and the sums over its region.

    Attributes
    ----------
    thickness : Image
        NaN exactly where flags is not 0. [um]
    thickness_std : Image
        From the noise of the pixel. [um]
    thickness_std_shared : Image
        From calibration and registration. [um]
    flags : FlagImage
        Bits of `erlif.core.flags.Flag`.
    sums : BlockSums
        What the statistics of the region need.
    """

    thickness: Image
    thickness_std: Image
    thickness_std_shared: Image
    flags: FlagImage
    sums: BlockSums


def measure_film(pair: PairRatio, tables: FilmTables, region: Region) -> FilmMaps:
    """Maps of film thickness, and the sums over the blocks of a region.

    Parameters
    ----------
    pair : PairRatio
        Ratio of a trigger.
    tables : FilmTables
    region : Region
        Region of interest of the statistics.

    Returns
    -------
    FilmMaps

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> calibration = example_calibration()
    >>> even = np.full((64, 64), calibration.predict_log(3.0), np.float32)
    >>> noise, flags = np.full_like(even, 1e-6), np.zeros(even.shape, np.uint16)
    >>> pair = PairRatio(even, noise, 0 * noise, 0 * noise, flags, even)
    >>> whole = Region(slice(0, 64), slice(0, 64))
    >>> maps = measure_film(pair, FilmTables.of(calibration), whole)
    >>> round(float(maps.thickness[32, 32]), 3), int(maps.sums.lit[0, 0])
    (3.0, 64)
    """
    shape = pair.log_ratio.shape
    thickness, std, std_shared = pair.spare or tuple(np.empty((3, *shape), np.float32))
    flags = np.empty(shape, np.uint16)

    offset, variance = find_medians(pair.log_ratio, pair.variance, pair.flags)

    # plain tuples are types of numba's own, see `_measure_film`
    blocks = BlockRows.of(shape, region)
    _measure_film(
        (pair.log_ratio, pair.variance, pair.variance_shared, pair.flags),
        np.float32(offset),
        *tables,
        tuple(Surroundings.of(shape[1], offset=offset, variance=variance)),
        tuple(LookUpRows.of(shape[1])),
        tuple(blocks),
        (thickness, std, std_shared, flags),
    )
    sums = blocks.named(offset, pair.noise_correlation)
    return FilmMaps(thickness, std, std_shared, flags, sums)


def measure_pulse(pair: PairRatio, tables: FilmTables, *, model: Reabsorption) -> float:
    """Relative energy of the pulse of one frame among several, `measure_pulse_energy` of its film.

    The film is measured in the middle half of the image alone, with the surroundings that decide
    about its flags.

    Parameters
    ----------
    pair : PairRatio
        Ratio of the frame.
    tables : FilmTables
    model : Reabsorption
        That of the calibration.

    Returns
    -------
    float
        NaN with too few valid pixels. [DN/um]

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> calibration = example_calibration()
    >>> even = np.full((64, 64), calibration.predict_log(3.0), np.float32)
    >>> noise, flags = np.full_like(even, 1e-6), np.zeros(even.shape, np.uint16)
    >>> light = np.full_like(even, 500 * calibration.model.light(3.0).signal)
    >>> pair = PairRatio(even, noise, 0 * noise, 0 * noise, flags, light)
    >>> round(measure_pulse(pair, FilmTables.of(calibration), model=calibration.model))
    500
    """
    # the surroundings of the outer pixels reach beyond the middle half
    rows, columns = middle_of(pair.flags.shape)
    within = slice(max(rows.start - PAD, 0), rows.stop + PAD)
    along = slice(max(columns.start - PAD, 0), columns.stop + PAD)
    around = within, along
    crop = PairRatio(
        log_ratio=np.ascontiguousarray(pair.log_ratio[around]),
        variance=np.ascontiguousarray(pair.variance[around]),
        variance_fixed=pair.variance_fixed[around],
        variance_shared=np.ascontiguousarray(pair.variance_shared[around]),
        flags=np.ascontiguousarray(pair.flags[around]),
        light_one=pair.light_one[around],
    )

    # statistics are those of the whole trigger: none of the crop
    maps = measure_film(crop, tables, _NOWHERE)

    # the same pixels, counted from the corner of the crop
    inner = (
        slice(rows.start - within.start, rows.stop - within.start, rows.step),
        slice(columns.start - along.start, columns.stop - along.start, columns.step),
    )
    return compare_light(
        pair.light_one[rows, columns],
        maps.thickness[inner],
        maps.flags[inner],
        model=model,
    )


@njit(nogil=True, cache=True, error_model="numpy")
def _measure_film(  # type: ignore[no-untyped-def]
    images, offset, scale, tables, limits, surroundings, rows, blocks, maps
):
    """Fill the maps and the sums over blocks.

    The cache of compiled kernels keeps the types of the arguments. A class of erlif among them
    could be missing in another version, which then could not read the cache. The functions that it
    calls become part of it (inline), so that they are not compiled a second time by themselves.
    """
    log_ratio, variance, displaced, _ = images
    around, near = rows[0], rows[1]
    flags = maps[3]
    for u in range(log_ratio.shape[0] + PAD):
        enter_row(images, u, surroundings)

        # row i is in the middle of the squares
        i = u - PAD
        if i >= 0:
            decide(log_ratio, i, limits, surroundings, around, near, flags)
            look_up(log_ratio, i, tables, scale, rows)
            add_to_blocks(images, i, offset, around, flags, blocks)
            fill_maps(variance, displaced, i, rows, maps)


_BELOW, _ABOVE = (np.uint16(flag) for flag in (Flag.BELOW_RANGE, Flag.ABOVE_RANGE))
_ZERO = np.float32(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# Sums of each block.
_SUMS = 8

# Units of three numbers that are packed into one; eight of them stay below 2^24, exact.
_FIRST, _SECOND, _THIRD = np.float32(1), np.float32(2**8), np.float32(2**16)


class BlockRows(NamedTuple):
    """Buffers of `add_to_blocks`: sums, and the places of pixels within their blocks.

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
        """Make empty sums over a region of an image.

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
        lit_ratio, lit_var, rows, columns, ratio, var, displaced, marks = self.blocks
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


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
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
    for j in range(flags.shape[1]):
        good = around[j] == 0
        sums[5, j] += variance[i, j] if good else _ZERO
        sums[6, j] += displaced[i, j] if good else _ZERO
    for j in range(flags.shape[1]):
        outside = (flags[i, j] == _BELOW) | (flags[i, j] == _ABOVE)
        mark = (_FIRST if around[j] == 0 else _ZERO) + (_SECOND if flags[i, j] == 0 else _ZERO)
        sums[7, j] += mark + (_THIRD if outside else _ZERO)


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
def _close_blocks(sums, row, left, right, blocks):  # type: ignore[no-untyped-def]
    """Add up a row of blocks along the row, and begin the next."""
    for q in range(sums.shape[0]):
        for n in range(blocks.shape[2]):
            total = 0.0
            for t in range(left + BLOCK * n, min(left + BLOCK * (n + 1), right)):
                total += sums[q, _at(t)]
                sums[q, _at(t)] = _ZERO
            blocks[q, row, n] = total


@njit(nogil=True, cache=True, error_model="numpy", inline="always")
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
