"""Sums over blocks, row by row, against sums in closed form."""

import numpy as np
import numpy.testing as npt

from erlif.core.flags import Flag
from erlif.pipeline.passes.blocks import BlockRows, add_to_blocks
from erlif.trend import Region

SHAPE = (24, 21)


def add_all(images, region, offset=0.0, around=None, flags=None):
    """Sums by name; without flags of a map, those of the ratio."""
    rows = BlockRows.of(SHAPE, region)
    around = images[3] if around is None else around
    flags = images[3] if flags is None else flags
    for i in range(SHAPE[0]):
        add_to_blocks(images, i, np.float32(offset), around[i], flags, tuple(rows))
    return rows.named(offset, 1.0)


def images_of(ratio=1.0, variance=2.0, displaced=3.0):
    values = (np.full(SHAPE, value, np.float32) for value in (ratio, variance, displaced))
    return *values, np.zeros(SHAPE, np.uint16)


def test_sums_of_even_images_are_multiples_of_the_number_of_pixels():
    sums = add_all(images_of(), Region(slice(0, 24), slice(0, 21)), 0.25)
    pixels = np.outer([8, 8, 8], [8, 8, 5])
    npt.assert_array_equal(sums.lit, pixels)
    npt.assert_array_equal(sums.lit_ratio, 0.75 * pixels)
    npt.assert_array_equal(sums.ratio_squared, 0.75**2 * pixels)
    npt.assert_array_equal(sums.lit_var, 2 * pixels)
    npt.assert_array_equal(sums.displaced, 3 * pixels)
    assert (sums.valid, sums.beyond) == (SHAPE[0] * SHAPE[1], 0)


def test_flagged_pixels_are_left_out():
    images = images_of()
    images[3][5, 6] = Flag.NO_FILM
    images[0][5, 6] = np.nan
    around, flags = images[3].copy(), images[3].copy()
    around[0, 0] = flags[0, 0] = Flag.BELOW_RANGE  # by its surroundings
    flags[1, 1] = Flag.ABOVE_RANGE  # by its own ratio
    sums = add_all(images, Region(slice(0, 8), slice(0, 8)), around=around, flags=flags)
    assert (sums.lit[0, 0], sums.measurable[0, 0]) == (63, 62)
    assert (sums.lit_ratio[0, 0], sums.ratio[0, 0]) == (63, 62)
    assert (sums.valid, sums.beyond) == (61, 2)
    assert sums.row[0, 0] == 8 * np.arange(8).sum() - 5
