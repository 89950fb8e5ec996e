"""Ratio of a trigger to its maps and to the sums for its statistics, in one pass over rows.

The reference is `erlif.thickness.measure_thickness`, and `erlif.trend.sum_blocks` for the sums.
Sums in single precision differ from it by up to 1e-7 of log ratio. The flag of a pixel whose
surroundings are as near to a limit as that, one in some millions, may differ.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.passes.blocks import BlockRows, add_to_blocks
from erlif.passes.buffers import empty_image
from erlif.passes.pair import PairRatio
from erlif.passes.rows import PAD
from erlif.passes.surroundings import Surroundings, decide, enter_row
from erlif.passes.tables import FilmTables
from erlif.thickness import compare_light, middle_of
from erlif.trend import BlockSums, Region

_ZERO, _NAN = np.float32(0), np.float32(np.nan)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

_STEPS = (61, 67)
"""Rows and columns between the pixels whose median is the offset of the sums: some hundreds."""

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


class _Rows(NamedTuple):
    """Rows of the table look-up that stay in cache, (x,); those of `film` are three, (row, x)."""

    around: AnyArray
    near: Image
    entry: AnyArray
    part: Image
    film: Image

    @classmethod
    def of(cls, width: int) -> _Rows:
        """Empty rows of an image of some width."""
        near, part = (np.empty(width, np.float32) for _ in range(2))
        around, entry = np.empty(width, np.uint8), np.empty(width, np.uint32)
        return cls(around, near, entry, part, np.empty((3, width), np.float32))


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

    # plain tuples are types of numba's own, see `_measure`
    blocks = BlockRows.of(shape, region)
    _measure(
        (pair.log_ratio, pair.variance, pair.variance_shared, pair.flags),
        offset,
        (tables.start, tables.per_step, tables.last),
        np.stack([tables.thickness, tables.rate, tables.calibration_std]),
        tables.limits,
        tuple(Surroundings.of(shape[1])),
        tuple(_Rows.of(shape[1])),
        tuple(blocks),
        (thickness, std, std_shared, flags),
    )
    sums = blocks.named(float(offset), pair.noise_correlation)
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


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _look_up(log_ratio, i, tables, scale, rows):  # type: ignore[no-untyped-def]
    """Film at the ratio of row i, and its rate and the calibration's share at the ratio near."""
    _, near, entry, part, film = rows
    start, per_step, last = scale
    y = _at(i)
    for q in range(tables.shape[0]):
        # entry of the table below each value, and the distance from it in entries
        for t in range(entry.size if q < 2 else 0):
            x = _at(t)
            value = log_ratio[y, x] if q == 0 else near[x]
            place = (value - start) * per_step
            place = place if place > _ZERO else _ZERO  # NaN becomes 0
            place = place if place < last else last
            below = np.uint32(place)
            entry[x] = below
            part[x] = place - np.float32(below)

        table = _at(q)
        for t in range(entry.size):
            x = _at(t)
            n = _at(entry[x])
            below = tables[table, n]
            film[table, x] = below + part[x] * (tables[table, n + _at(1)] - below)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _fill(variance, displaced, i, film, maps):  # type: ignore[no-untyped-def]
    """Row i of the maps; NaN where it is flagged."""
    thickness, std, std_shared, flags = maps
    y = _at(i)
    for t in range(flags.shape[1]):
        x = _at(t)
        valid = flags[y, x] == 0
        rate, own = film[1, x], film[2, x]
        shared = np.sqrt(own * own + rate * rate * displaced[y, x])
        thickness[y, x] = film[0, x] if valid else _NAN
        std[y, x] = rate * np.sqrt(variance[y, x]) if valid else _NAN
        std_shared[y, x] = shared if valid else _NAN


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _measure(  # type: ignore[no-untyped-def]
    images, offset, scale, tables, limits, surroundings, rows, blocks, maps
):
    """Fill the maps and the sums over blocks.

    The cache of compiled kernels keeps the types of the arguments. A class of erlif among them
    could be missing in another version, which then could not read the cache.
    """
    log_ratio, variance, displaced, _ = images
    around, near, _, _, film = rows
    flags = maps[3]
    for u in range(log_ratio.shape[0] + PAD):
        enter_row(images, u, offset, surroundings)

        # row i is in the middle of the squares
        i = u - PAD
        if i >= 0:
            decide(log_ratio, i, offset, limits, surroundings, around, near, flags)
            _look_up(log_ratio, i, tables, scale, rows)
            _fill(variance, displaced, i, film, maps)
            add_to_blocks(images, i, offset, around, flags, blocks)
