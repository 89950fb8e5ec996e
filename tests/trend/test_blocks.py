"""Sums over blocks of 8 x 8 pixels, against sums written out."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import known_calibration, known_gap, noisy_ratios

from erlif.core.errors import ConfigError
from erlif.core.flags import Flag
from erlif.core.products import RatioImages
from erlif.thickness import measure_thickness
from erlif.trend import Region, find_region
from erlif.trend.blocks import sum_blocks

REGION = Region(slice(3, 30), slice(10, 53))
"""27 rows and 43 columns: blocks at the lower and right edge are smaller."""


@pytest.fixture(scope="module")
def images():
    """A gap that is partly beyond the calibrated range, with flagged pixels."""
    ratios = noisy_ratios(known_gap(14.0), 0.005, np.random.default_rng(1))
    ratios.flags.values[5:9, 12:20] = Flag.NO_FILM
    ratios.log_ratio_var_shared.values[:] = 1e-6
    return ratios, measure_thickness(ratios, known_calibration())


def block(image, row, column):
    """Pixels of one block of the region."""
    within = image.values[REGION.rows, REGION.columns]
    return within[8 * row : 8 * row + 8, 8 * column : 8 * column + 8]


@pytest.mark.parametrize(("row", "column"), [(0, 0), (1, 2), (3, 5), (0, 5)])
def test_sums_are_those_of_the_chosen_pixels(images, row, column):
    ratios, maps = images
    sums = sum_blocks(ratios, REGION, maps)
    log_ratio, variance, displaced = (
        block(ratios[name], row, column).astype(float)
        for name in ("log_ratio", "log_ratio_var", "log_ratio_var_shared")
    )
    lit = block(ratios.flags, row, column) == 0
    measurable = np.isfinite(block(maps.log_ratio_near, row, column))
    places = np.indices(lit.shape)
    off = log_ratio - sums.offset

    at = row, column
    assert (sums.lit[at], sums.measurable[at]) == (lit.sum(), measurable.sum())
    npt.assert_allclose(sums.lit_ratio[at], off[lit].sum(), atol=1e-12)
    npt.assert_allclose(sums.lit_var[at], variance[lit].sum())
    npt.assert_allclose(sums.ratio[at], off[measurable].sum(), atol=1e-12)
    npt.assert_allclose(sums.var[at], variance[measurable].sum())
    npt.assert_allclose(sums.displaced[at], displaced[measurable].sum())
    assert sums.row[at] == (places[0][lit] + 8 * row).sum()
    assert sums.row_squared[at] == ((places[0][lit] + 8 * row) ** 2).sum()
    assert sums.column[at] == (places[1][lit] + 8 * column).sum()
    assert sums.column_squared[at] == ((places[1][lit] + 8 * column) ** 2).sum()


def test_blocks_cover_the_region_once(images):
    ratios, maps = images
    sums = sum_blocks(ratios, REGION, maps)
    flags = maps.flags.values[REGION.rows, REGION.columns]
    assert sums.size == (27, 43)
    assert sums.lit.shape == (4, 6)
    assert sums.valid == (flags == 0).sum()
    assert sums.beyond == ((flags == Flag.ABOVE_RANGE) | (flags == Flag.BELOW_RANGE)).sum()
    assert sums.lit.sum() == 27 * 43 - 4 * 8

    without = sum_blocks(ratios, REGION)
    assert without.lit.sum() == 27 * 43 - 4 * 8
    assert (without.measurable.sum(), without.valid, without.beyond) == (0, 0, 0)
    dark = ratios.copy(deep=True)
    dark.log_ratio.values[:] = np.nan
    dark.flags.values[:] = Flag.DIM
    sums = sum_blocks(RatioImages(dark), REGION)
    assert (sums.offset, sums.lit.sum(), sums.lit_ratio.sum()) == (0.0, 0.0, 0.0)


X, Y = 0.06 * np.arange(200), 0.06 * np.arange(160)


def test_bounds_between_pixels_keep_the_pixels_inside():
    region = find_region(X, Y, roi=((3, 9), (2, 8)))
    rows, columns = region.rows, region.columns
    assert (X[columns][0], X[columns][-1]) == (pytest.approx(3.0), pytest.approx(9.0))
    assert (Y[rows][0], Y[rows][-1]) == (pytest.approx(2.04), pytest.approx(7.98))


@pytest.mark.parametrize("pitch", [0.12, 0.1, 0.07, 1e3 * 1.2e-4])
def test_a_bound_at_a_pixel_includes_it_whatever_its_last_digit(pitch):
    x = pitch * np.arange(200)
    for last in range(60, 190):
        columns = find_region(x, x, roi=((0, round(last * pitch, 2)), (0, 10))).columns
        assert columns == slice(0, last + 1)


def test_bounds_beyond_the_image_end_with_it():
    region = find_region(X, Y, roi=((-5, 100), (4, 100)))
    assert region == Region(rows=slice(67, 160), columns=slice(0, 200))


@pytest.mark.parametrize(
    "roi", [((30, 40), (0, 5)), ((0, 5), (-9, -3)), ((0, 1.8), (0, 5)), ((0, 5), (2, 3.8))]
)
def test_region_of_few_pixels_is_refused_with_the_size_of_the_image(roi):
    with pytest.raises(ConfigError, match="at least 32 x 32 pixels") as refused:
        find_region(X, Y, roi=roi)
    assert "x 0 to 11.94 mm and y 0 to 9.54 mm" in str(refused.value)
