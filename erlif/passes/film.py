"""Ratio of a trigger to its maps and to the sums for its statistics, in one pass over rows.

The reference is `erlif.thickness.measure_thickness`, and `erlif.trend.sum_blocks` for the sums.
Sums in single precision differ from it by up to 1e-7 of log ratio. The flag of a pixel whose
surroundings are as near to a limit as that, one in some millions, may differ.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.flags import Flag
from erlif.passes.buffers import empty_image
from erlif.passes.pair import PairRatio
from erlif.passes.rows import PAD, Place, Ring, Step, across, add_rows, count, table_of
from erlif.thickness import CLEAR, compare_light, middle_of
from erlif.trend import BLOCK, BlockSums, Region

_BELOW, _ABOVE, _POOR = (
    np.uint8(flag) for flag in (Flag.BELOW_RANGE, Flag.ABOVE_RANGE, Flag.POOR_REGISTRATION)
)
_CLEAR, _HALF, _ZERO = np.float32(CLEAR), np.float32(0.5), np.float32(0)
_NAN, _NONE = np.float32(np.nan), np.uint8(0)
_at = np.uint64  # an index that cannot count from the end

_STEPS = (61, 67)
"""Rows and columns between the pixels whose median is the offset of the sums: some hundreds."""

_SINGLE, _SEVERAL, _STATES = 17, 9, 18
"""Rows of the rings of single rows, of sums of several and of flags.

A row is used for the last time when 16 or 8 rows have entered after it; flags once more, when the
row that leaves the square is compared with the one that enters.
"""

_RATIO, _NOISE = Ring(0, _SINGLE), Ring(17, _SINGLE)
_RATIO_2, _RATIO_4, _RATIO_8 = Ring(34, _SEVERAL), Ring(43, _SEVERAL), Ring(52, _SEVERAL)
_NOISE_2, _NOISE_4 = Ring(61, _SEVERAL), Ring(70, _SEVERAL)
_COUNTS = [Ring(79), Ring(80), Ring(81)]
_PARTS = [Ring(82), Ring(83), Ring(84), Ring(85)]
_PAIR, _DOWN = Ring(86), Ring(87)
_WIDE, _NEAR, _MIDDLE, _SPREAD, _PIXELS_17, _PIXELS_9, _PIXELS_5 = range(88, 95)
_OWN, _PART, _FILM, _ROWS = 95, 96, 97, 100
"""Rows of the buffer; those of the film are followed by its rate and the calibration's share."""


def _square(
    several: Ring, newer: int, older: int, single: Ring, at: int, side: int, out: int
) -> list[Step]:
    """Steps that add up a square: two sums of rows and one row, then along the row."""
    return [
        (_PAIR, Place(several, newer), Place(several, older)),
        (_DOWN, Place(_PAIR), Place(single, at)),
        *across(_DOWN, side, _PARTS, Ring(out)),
    ]


_TABLE_PARTS = [
    # sums of rows; 16 ahead in a ring of 17 rows is the row before, 1 the oldest one
    [
        (_RATIO_2, Place(_RATIO), Place(_RATIO, 16)),
        (_NOISE_2, Place(_NOISE), Place(_NOISE, 16)),
        (_RATIO_4, Place(_RATIO_2), Place(_RATIO_2, 7)),
        (_NOISE_4, Place(_NOISE_2), Place(_NOISE_2, 7)),
        (_RATIO_8, Place(_RATIO_4), Place(_RATIO_4, 5)),
    ],
    across(_COUNTS[0], 17, _PARTS, Ring(_PIXELS_17)),
    across(_COUNTS[1], 9, _PARTS, Ring(_PIXELS_9)),
    across(_COUNTS[2], 5, _PARTS, Ring(_PIXELS_5)),
    [
        *_square(_RATIO_8, 0, 1, _RATIO, 1, 17, _WIDE),
        *_square(_RATIO_4, 5, 1, _RATIO, 5, 9, _NEAR),
        *_square(_RATIO_2, 3, 1, _RATIO, 7, 5, _MIDDLE),
        *_square(_NOISE_4, 5, 1, _NOISE, 5, 9, _SPREAD),
    ],
]
_TABLE = table_of([step for part in _TABLE_PARTS for step in part])
"""Every sum of two rows: sums of rows, pixels of the three squares, then the sums over squares."""
_ENDS = np.cumsum([0, *map(len, _TABLE_PARTS)])
_ENTERING, _LEAVING = np.array([0, 0, 14, 12]), np.array([0, 1, 5, 7])
"""Rows of flags, ahead of the one that is filled, that enter and leave the three squares."""
_FIRST_COUNT = _COUNTS[0].first - 1
_SQUARES = len(_TABLE_PARTS) - 1
"""The last part of the table, which begins once a square is complete."""

_SUMS = 9
"""Sums of each block."""

_FIRST, _SECOND, _THIRD = np.float32(1), np.float32(2**8), np.float32(2**16)
"""Units of three numbers that are packed into one; eight of them stay below 2^24, exact."""


_NOWHERE = Region(slice(0, 0), slice(0, 0))


@dataclass(frozen=True)
class FilmTables:
    """What the pass reads from a calibration, in single precision.

    Attributes
    ----------
    start : np.float32
        Log ratio at the first entry of the tables. [1]
    per_step : np.float32
        One over the distance of the entries. [1]
    last : np.float32
        The largest number below that of the last entry.
    thickness : Image
        Film thickness, (entry,). [um]
    rate : Image
        Derivative of the thickness by the log ratio, (entry,). [um]
    calibration_std : Image
        Standard deviation of the thickness due to the calibration, (entry,). [um]
    limits : Image
        Log ratios of the calibrated range, of what the fixture covers, and the first and last one
        that the tables hold, (6,). [1]
    """

    start: np.float32
    per_step: np.float32
    last: np.float32
    thickness: Image
    rate: Image
    calibration_std: Image
    limits: Image

    @classmethod
    def of(cls, calibration: Calibration) -> FilmTables:
        """Tables of a calibration.

        Parameters
        ----------
        calibration : Calibration

        Returns
        -------
        FilmTables
        """
        table = calibration.inverse
        limits = np.concatenate(
            [
                calibration.predict_log(calibration.thickness_range),
                calibration.predict_log(calibration.covered_range),
            ]
        ).astype(np.float32)

        # the first and last number in single precision that lie between the ends of the tables
        end = table.start + table.step * (table.thickness.size - 1)
        first, last = np.float32(table.start), np.float32(end)
        if float(first) < table.start:
            first = np.nextafter(first, np.float32(np.inf))
        while (float(last) - table.start) / table.step > table.thickness.size - 1:
            last = np.nextafter(last, np.float32(-np.inf))
        return cls(
            np.float32(table.start),
            np.float32(1 / table.step),
            np.nextafter(np.float32(table.thickness.size - 1), _ZERO),
            table.thickness.astype(np.float32),
            table.per_log_ratio.astype(np.float32),
            table.calibration_std.astype(np.float32),
            np.append(limits, [first, last]).astype(np.float32),
        )


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


class _Buffers(NamedTuple):
    """Rows that stay in cache; `rows` explains the rings."""

    state: AnyArray
    rows: Image
    entry: AnyArray
    sums: Image
    places: Image
    columns: Image

    @classmethod
    def of(cls, width: int, left: int) -> _Buffers:
        """Buffers of an image of some width, of which nothing has entered yet.

        The blocks of the region begin at column left.
        """
        return cls(
            # one row more for the flags of the surroundings
            state=np.ones((_STATES + 1, width), np.uint8),
            rows=np.zeros((_ROWS, width + 2 * PAD), np.float32),
            entry=np.zeros(width, np.uint32),
            sums=np.zeros((_SUMS, width), np.float32),
            places=_pack(np.arange(BLOCK)),
            columns=_pack((np.arange(width) - left) % BLOCK),
        )


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
    >>> from erlif.plots import example_calibration
    >>> calibration = example_calibration()
    >>> even = np.full((64, 64), calibration.predict_log(3.0), np.float32)
    >>> noise, flags = np.full_like(even, 1e-6), np.zeros(even.shape, np.uint8)
    >>> pair = PairRatio(even, noise, 0 * noise, 0 * noise, flags, even)
    >>> whole = Region(slice(0, 64), slice(0, 64))
    >>> maps = measure_film(pair, FilmTables.of(calibration), whole)
    >>> round(float(maps.thickness[32, 32]), 3), int(maps.sums.lit[0, 0])
    (3.0, 64)
    """
    shape = pair.log_ratio.shape
    thickness, std, std_shared = pair.spare or tuple(empty_image(shape) for _ in range(3))
    flags = empty_image(shape, np.uint8)

    sample = slice(None, None, _STEPS[0]), slice(None, None, _STEPS[1])
    sound = pair.log_ratio[sample][pair.flags[sample] == 0]
    offset = np.float32(np.median(sound)) if sound.size else _ZERO

    top, bottom, _ = region.rows.indices(shape[0])
    left, right, _ = region.columns.indices(shape[1])
    blocks = np.zeros((_SUMS, -(-(bottom - top) // BLOCK), -(-(right - left) // BLOCK)))
    _measure(
        pair.log_ratio,
        pair.variance,
        pair.variance_shared,
        pair.flags,
        offset,
        tables.start,
        tables.per_step,
        tables.last,
        np.stack([tables.thickness, tables.rate, tables.calibration_std]),
        tables.limits,
        np.array([top, bottom, left, right]),
        tuple(_Buffers.of(shape[1], left)),  # a type of numba's own, see `_measure`
        thickness,
        std,
        std_shared,
        flags,
        blocks,
    )
    size = bottom - top, right - left
    sums = _name_sums(blocks, size, float(offset), pair.noise_correlation)
    return FilmMaps(thickness, std, std_shared, flags, sums)


def measure_pulse(pair: PairRatio, tables: FilmTables, *, attenuation: float) -> float:
    """Relative energy of the pulse of one frame among several, `measure_pulse_energy` of its film.

    The film is measured in the middle half of the image alone, with the surroundings that decide
    about its flags.

    Parameters
    ----------
    pair : PairRatio
        Ratio of the frame.
    tables : FilmTables
    attenuation : float
        Attenuation coefficient in the band of camera 1. [1/um]

    Returns
    -------
    float
        NaN with too few valid pixels. [DN/um]

    Examples
    --------
    >>> from erlif.models.fluorescence import band_signal
    >>> from erlif.plots import example_calibration
    >>> calibration = example_calibration()
    >>> even = np.full((64, 64), calibration.predict_log(3.0), np.float32)
    >>> noise, flags = np.full_like(even, 1e-6), np.zeros(even.shape, np.uint8)
    >>> light = np.full_like(even, 500 * band_signal(3.0, attenuation=0.4))
    >>> pair = PairRatio(even, noise, 0 * noise, 0 * noise, flags, light)
    >>> round(measure_pulse(pair, FilmTables.of(calibration), attenuation=0.4))
    500
    """
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
        attenuation=attenuation,
    )


def _name_sums(
    blocks: Array, size: tuple[int, int], offset: float, noise_correlation: float
) -> BlockSums:
    """Sums by name, from the order in which `_accumulate` fills them; places within the region."""
    lit_ratio, lit_var, rows, columns, ratio, squared, var, displaced, marks = blocks
    lit, row, row_squared = _unpack(rows)
    _, column, column_squared = _unpack(columns)
    measurable, valid, beyond = _unpack(marks)
    down, along = (BLOCK * index for index in np.indices(lit.shape, float))
    return BlockSums(
        size,
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
def _decide(log_ratio, i, offset, limits, state, s, rows, flags):  # type: ignore[no-untyped-def]
    """Flags of row i by its surroundings into the last row of state, by its own ratio into flags.

    The row near becomes the log ratio at which the slope is taken. The slope of a curve at a noisy
    ratio is correlated with its error; half-way to the mean of the surroundings it is that of the
    chord.
    """
    first, last, thinnest, thickest = limits[0], limits[1], limits[2], limits[3]
    lowest, highest = limits[4], limits[5]
    y, z = _at(i), _at(s)
    for t in range(log_ratio.shape[1]):
        x = _at(t)
        middle, pixels = rows[_MIDDLE, x], rows[_PIXELS_5, x]
        around = offset + (rows[_WIDE, x] - middle) / (rows[_PIXELS_17, x] - pixels)
        margin = _CLEAR * np.sqrt(rows[_SPREAD, x] / rows[_PIXELS_9, x])
        beyond = _BELOW if (around < first) | (around - margin < thinnest) else _NONE
        beyond = _ABOVE if (around > last) | (around + margin > thickest) else beyond
        bits = beyond if state[z, x] == 0 else state[z, x]
        state[_STATES, x] = bits

        own = log_ratio[y, x]
        single = _BELOW if own < lowest else _NONE
        single = _ABOVE if own > highest else single
        flags[y, x] = single if bits == 0 else bits
        rows[_OWN, x] = own
        rows[_NEAR, x] = _HALF * (own + (offset + rows[_NEAR, x] / rows[_PIXELS_9, x]))


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _look_up(tables, start, per_step, last, entry, rows):  # type: ignore[no-untyped-def]
    """Film of the row own, and its rate and the calibration's share of the row near."""
    for q in range(tables.shape[0]):
        # entry of the table below each value, and the distance from it in entries
        values = _at(_OWN if q == 0 else _NEAR)
        for t in range(entry.size if q < 2 else 0):
            x = _at(t)
            place = (rows[values, x] - start) * per_step
            place = place if place > _ZERO else _ZERO  # NaN becomes 0
            place = place if place < last else last
            below = np.uint32(place)
            entry[x] = below
            rows[_PART, x] = place - np.float32(below)

        table, out = _at(q), _at(_FILM + q)
        for t in range(entry.size):
            x = _at(t)
            n = _at(entry[x])
            below = tables[table, n]
            rows[out, x] = below + rows[_PART, x] * (tables[table, n + _at(1)] - below)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _fill(  # type: ignore[no-untyped-def]
    variance, displaced, flags, i, rows, thickness, std, std_shared
):
    """Row i of the maps; NaN where it is flagged."""
    y = _at(i)
    for t in range(flags.shape[1]):
        x = _at(t)
        valid = flags[y, x] == 0
        rate, own = rows[_FILM + 1, x], rows[_FILM + 2, x]
        shared = np.sqrt(own * own + rate * rate * displaced[y, x])
        thickness[y, x] = rows[_FILM, x] if valid else _NAN
        std[y, x] = rate * np.sqrt(variance[y, x]) if valid else _NAN
        std_shared[y, x] = shared if valid else _NAN


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _accumulate(  # type: ignore[no-untyped-def]
    log_ratio, variance, displaced, lit, i, place, offset, state, flags, columns, sums
):
    """Add row i to the sums down the columns; `_name_sums` has their order.

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
        good = state[_STATES, j] == 0
        sums[4, j] += ratio if good else _ZERO
        sums[5, j] += ratio * ratio if good else _ZERO
    for j in range(flags.shape[1]):
        good = state[_STATES, j] == 0
        sums[6, j] += variance[i, j] if good else _ZERO
        sums[7, j] += displaced[i, j] if good else _ZERO
    for j in range(flags.shape[1]):
        outside = (flags[i, j] == _BELOW) | (flags[i, j] == _ABOVE)
        mark = (_FIRST if state[_STATES, j] == 0 else _ZERO) + (
            _SECOND if flags[i, j] == 0 else _ZERO
        )
        sums[8, j] += mark + (_THIRD if outside else _ZERO)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _close_blocks(sums, row, left, right, blocks):  # type: ignore[no-untyped-def]
    """Add up a row of blocks along the row, and begin the next."""
    for q in range(sums.shape[0]):
        for n in range(blocks.shape[2]):
            total = 0.0
            for t in range(left + BLOCK * n, min(left + BLOCK * (n + 1), right)):
                total += sums[q, _at(t)]
                sums[q, _at(t)] = _ZERO
            blocks[q, row, n] = total


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _measure(  # type: ignore[no-untyped-def]
    log_ratio,
    variance,
    displaced,
    lit,
    offset,
    start,
    per_step,
    last,
    tables,
    limits,
    region,
    buffers,
    thickness,
    std,
    std_shared,
    flags,
    blocks,
):
    """Fill the last five arguments; `buffers` are those of `_Buffers`, as a plain tuple.

    The cache of compiled kernels keeps the types of the arguments. A class of erlif among them
    could be missing in another version, which then could not read the cache.
    """
    state, rows, entry, sums, places, columns = buffers
    top, bottom, left, right = region[0], region[1], region[2], region[3]
    bottom_row = log_ratio.shape[0] - 1
    for u in range(log_ratio.shape[0] + PAD):
        # row u enters the sums, without any sound pixel below the image
        at, extra = min(u, bottom_row), _NONE if u <= bottom_row else _POOR
        s, k = u % _STATES, u % _SINGLE
        _enter(log_ratio, variance, displaced, lit, at, extra, offset, state, s, rows, k)
        for part in range(_SQUARES if u < PAD else _SQUARES + 1):
            changed = True
            if 0 < part < _SQUARES:
                new, old = (u + _ENTERING[part]) % _STATES, (u + _LEAVING[part]) % _STATES
                changed = count(state, new, old, rows, _FIRST_COUNT + part)
            if changed:
                add_rows(rows, _TABLE, _ENDS[part], _ENDS[part + 1], u)

        # row i is in the middle of the squares
        i = u - PAD
        if i < 0:
            continue
        _decide(log_ratio, i, offset, limits, state, i % _STATES, rows, flags)
        _look_up(tables, start, per_step, last, entry, rows)
        _fill(variance, displaced, flags, i, rows, thickness, std, std_shared)

        if top <= i < bottom:
            place = places[(i - top) % BLOCK]
            _accumulate(
                log_ratio,
                variance,
                displaced,
                lit,
                i,
                place,
                offset,
                state,
                flags,
                columns,
                sums,
            )
            if (i - top) % BLOCK == BLOCK - 1 or i == bottom - 1:
                _close_blocks(sums, (i - top) // BLOCK, left, right, blocks)
