"""Ratio of a trigger to its maps and to the sums for its statistics, in one pass over rows.

`erlif.thickness.measure_thickness` makes the same maps without the sums.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.calibration import Reabsorption
from erlif.core.arrays import FlagImage, Image
from erlif.pipeline.passes.blocks import BlockRows, add_to_blocks
from erlif.ratio import PairRatio
from erlif.thickness import FilmTables, compare_light, middle_of
from erlif.thickness.maps import LookUpRows, fill_maps, find_medians, look_up
from erlif.thickness.surroundings import PAD, Surroundings, decide, enter_row
from erlif.trend import BlockSums, Region

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


@numba.njit(nogil=True, cache=True, error_model="numpy")
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
