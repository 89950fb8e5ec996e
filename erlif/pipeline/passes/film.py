"""Ratio of a trigger to its maps and to the sums for its statistics, in one pass over rows.

The reference is `erlif.thickness.measure_thickness`, and `erlif.trend.sum_blocks` for the sums.
Sums over surroundings differ from it by up to 1e-7 of log ratio. The flag of a pixel whose
surroundings are as near to a limit as that, one in some millions, may differ.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.pipeline.passes.blocks import BlockRows, add_to_blocks
from erlif.pipeline.passes.buffers import empty_image
from erlif.pipeline.passes.pair import PairRatio
from erlif.pipeline.passes.surroundings import PAD, Surroundings, decide, enter_row
from erlif.pipeline.passes.tables import FilmTables
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
    """Rows of the table look-up that stay in cache, (x,).

    `entry` and `part` have two rows, for the ratio itself and that near it. `film` has two numbers
    for each pixel: the entries of the table below and above. So has `pairs`, whose numbers are
    pairs of rate and calibration; `slopes` is the same memory.
    """

    around: AnyArray
    near: Image
    entry: AnyArray
    part: Image
    film: Image
    pairs: AnyArray
    slopes: Image
    own: Image

    @classmethod
    def of(cls, width: int) -> _Rows:
        """Empty rows of an image of some width."""
        near, own = (np.empty(width, np.float32) for _ in range(2))
        around, entry = np.empty(width, np.uint8), np.empty((2, width), np.uint32)
        part, film = np.empty((2, width), np.float32), np.empty(2 * width, np.float32)
        pairs = np.empty(2 * width, np.float64)
        return cls(around, near, entry, part, film, pairs, pairs.view(np.float32), own)


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

    offset, variance = _find_medians(pair)

    # plain tuples are types of numba's own, see `_measure`
    blocks = BlockRows.of(shape, region)
    _measure(
        (pair.log_ratio, pair.variance, pair.variance_shared, pair.flags),
        np.float32(offset),
        (tables.start, tables.per_step, tables.last),
        (tables.thickness, tables.pairs),
        tables.limits,
        tuple(Surroundings.of(shape[1], offset=offset, variance=variance)),
        tuple(_Rows.of(shape[1])),
        tuple(blocks),
        (thickness, std, std_shared, flags),
    )
    sums = blocks.named(offset, pair.noise_correlation)
    return FilmMaps(thickness, std, std_shared, flags, sums)


def _find_medians(pair: PairRatio) -> tuple[float, float]:
    """Median log ratio and variance of some hundred sound pixels, of all where none of them is."""
    for steps in (_STEPS, (1, 1)):
        sample = slice(None, None, steps[0]), slice(None, None, steps[1])
        sound = pair.flags[sample] == 0
        if sound.any():
            images = pair.log_ratio[sample], pair.variance[sample]
            ratio, variance = (float(np.median(image[sound])) for image in images)
            return ratio, variance
    return 0.0, 0.0


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
    >>> from erlif.show.plots import example_calibration
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


@numba.njit(nogil=True, cache=True, error_model="numpy", inline="always")
def _look_up(log_ratio, i, tables, scale, rows):  # type: ignore[no-untyped-def]
    """Entries for the film at the ratio of row i, and for rate and calibration at the row near."""
    _, near, entry, part, film, pairs, _, _ = rows
    films, slopes = tables
    start, per_step, last = scale
    y = _at(i)
    for q in range(2):
        # entry of the table below each value, and the distance from it in entries
        row = _at(q)
        for t in range(near.size):
            x = _at(t)
            place = ((log_ratio[y, x] if q == 0 else near[x]) - start) * per_step
            place = place if place > _ZERO else _ZERO  # NaN becomes 0
            place = place if place < last else last
            below = np.uint32(place)
            entry[row, x] = below
            part[row, x] = place - np.float32(below)
    for t in range(near.size):
        n = entry[_at(0), _at(t)]
        film[_at(2 * t)] = films[_at(n)]
        film[_at(2 * t + 1)] = films[_at(n) + _at(1)]
    for t in range(near.size):
        n = entry[_at(1), _at(t)]
        pairs[_at(2 * t)] = slopes[_at(n)]
        pairs[_at(2 * t + 1)] = slopes[_at(n) + _at(1)]


@numba.njit(nogil=True, cache=True, error_model="numpy", inline="always")
def _fill(variance, displaced, i, rows, maps):  # type: ignore[no-untyped-def]
    """Row i of the maps; NaN where it is flagged."""
    _, rate, _, part, film, _, slopes, own = rows
    thickness, std, std_shared, flags = maps
    y, first, second = _at(i), _at(0), _at(1)

    # few rows a loop: more would need more comparisons of addresses than the compiler accepts
    for t in range(flags.shape[1]):
        x = _at(t)
        below = film[_at(2 * t)]
        value = below + part[first, x] * (film[_at(2 * t + 1)] - below)
        thickness[y, x] = value if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        below, also = slopes[_at(4 * t)], slopes[_at(4 * t + 1)]
        rate[x] = below + part[second, x] * (slopes[_at(4 * t + 2)] - below)
        own[x] = also + part[second, x] * (slopes[_at(4 * t + 3)] - also)

    # the maps may be in the memory of the ratio, which loops in vector registers do not expect
    for t in range(flags.shape[1]):
        x = _at(t)
        film[x] = rate[x] * np.sqrt(variance[y, x]) if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        shared = np.sqrt(own[x] * own[x] + rate[x] * rate[x] * displaced[y, x])
        own[x] = shared if flags[y, x] == 0 else _NAN
    for t in range(flags.shape[1]):
        x = _at(t)
        std[y, x] = film[x]
    for t in range(flags.shape[1]):
        x = _at(t)
        std_shared[y, x] = own[x]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _measure(  # type: ignore[no-untyped-def]
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
            _look_up(log_ratio, i, tables, scale, rows)
            add_to_blocks(images, i, offset, around, flags, blocks)
            _fill(variance, displaced, i, rows, maps)
