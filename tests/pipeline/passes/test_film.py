"""The pass from ratio to film, held to the plain measurement, sums and pulse energy."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import P, known_calibration, true_log_ratio
from scenes.plain import measure_thickness

from erlif.core.flags import Flag
from erlif.core.products import RatioImages
from erlif.pipeline.passes import measure_film, measure_pulse
from erlif.pipeline.passes.film import BlockRows, add_to_blocks
from erlif.ratio import PairRatio
from erlif.thickness import FilmTables, measure_pulse_energy
from erlif.trend import Region, sum_blocks

EPS = float(np.finfo(np.float32).eps)
"""A single operation in single precision is rounded by at most half of this."""

SHAPE = (150, 131)
REGION = Region(slice(9, 140), slice(11, 121))
WHOLE = Region(slice(0, SHAPE[0]), slice(0, SHAPE[1]))


@pytest.fixture(scope="module")
def calibration():
    """Calibrated from 0.5 to 12 um, covered up to 14 um."""
    return known_calibration(valid=(0.5, 12.0), thickest=14.0)


def pair_of(shape=SHAPE, noise=0.0135, seed=1):
    """Films from below to above the range, with noise and flagged pixels of every kind."""
    rng = np.random.default_rng(seed)
    y, x = np.indices(shape)
    film = 0.3 + 14.5 * x / shape[1] + 0.4 * y / shape[0]
    log_ratio = true_log_ratio(film)
    noise = noise * (1 + 0.5 * y / shape[0])
    log_ratio += noise * rng.standard_normal(shape)
    variance = noise**2 * rng.uniform(0.8, 1.2, shape)
    flags = np.where(rng.random(shape) < 0.01, Flag.BAD_PIXEL, 0).astype(np.uint16)
    flags[:, :3] = Flag.OUTSIDE_OVERLAP
    flags[shape[0] // 2 : shape[0] // 2 + 30, shape[1] // 3 : shape[1] // 3 + 30] = Flag.NO_FILM
    log_ratio[flags != 0] = np.nan
    shared = 0.1 * variance * rng.uniform(0, 1, shape)
    shared[rng.random(shape) < 0.02] = 1.0  # the registration is poor
    images = (log_ratio, variance, 0.1 * variance, shared)
    light = 900.0 * (1 - np.exp(-P * film)) / P * rng.normal(1, 0.02, shape)
    return PairRatio(
        *(image.astype(np.float32) for image in images), flags, light.astype(np.float32), 1.2
    )


def plain(pair):
    return RatioImages(pair.to_images().isel(frame=0))


@pytest.mark.parametrize("shape", [SHAPE, (17, 40), (5, 9), (64, 1)])
@pytest.mark.parametrize("noise", [0.004, 0.0135, 0.04])
def test_maps_are_those_of_the_plain_measurement(calibration, shape, noise):
    pair = pair_of(shape, noise)
    whole = Region(slice(0, shape[0]), slice(0, shape[1]))
    found = measure_film(pair, FilmTables.of(calibration), whole)
    expected = measure_thickness(plain(pair), calibration)
    npt.assert_array_equal(found.flags, expected["flags"].values)

    # the log ratio in single precision, of order one, decides: thickness changes by its rate
    rate = 1 / calibration.slope(14.0)
    npt.assert_allclose(found.thickness, expected.thickness, rtol=2 * EPS, atol=2 * EPS * rate)
    # the rate is that of a film that is rounded likewise, and changes by 60 % in 1 um
    for name in ("thickness_std", "thickness_std_shared"):
        npt.assert_allclose(getattr(found, name), expected[name], rtol=EPS * rate)


def test_maps_may_replace_the_ratio(calibration):
    tables = FilmTables.of(calibration)
    expected, pair = measure_film(pair_of(), tables, WHOLE), pair_of()
    images = pair.log_ratio, pair.variance, pair.variance_shared
    found = measure_film(replace(pair, spare=images), tables, WHOLE)
    for name in ("thickness", "thickness_std", "thickness_std_shared", "flags"):
        npt.assert_array_equal(getattr(found, name), getattr(expected, name))
    for name, values in vars(expected.sums).items():
        npt.assert_array_equal(getattr(found.sums, name), values)
    assert found.thickness is images[0]


@pytest.mark.parametrize("region", [REGION, WHOLE, Region(slice(60, 92), slice(0, 33))])
def test_sums_are_those_of_the_plain_blocks(calibration, region):
    pair = pair_of()
    found = measure_film(pair, FilmTables.of(calibration), region).sums
    expected = sum_blocks(plain(pair), region, measure_thickness(plain(pair), calibration))

    # numbers of pixels and their places are whole numbers, and exact
    for name in ("size", "valid", "beyond", "noise_correlation"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), abs=0)
    for name in ("lit", "row", "row_squared", "column", "column_squared", "measurable"):
        npt.assert_array_equal(getattr(found, name), getattr(expected, name))

    # eight numbers down the columns are added in single precision
    for name in ("lit_var", "var", "displaced"):
        npt.assert_allclose(getattr(found, name), getattr(expected, name), rtol=8 * EPS)
    shift = found.offset - expected.offset
    for name, count in (("lit_ratio", found.lit), ("ratio", found.measurable)):
        ratio = getattr(found, name) + count * shift
        npt.assert_allclose(ratio, getattr(expected, name), atol=64 * 8 * EPS)


@pytest.mark.parametrize("shape", [SHAPE, (150, 132), (30, 41)])
def test_pulse_energy_is_that_of_the_plain_film(calibration, shape):
    pair = pair_of(shape)
    maps = measure_thickness(plain(pair), calibration)
    expected = measure_pulse_energy(
        pair.light_one, maps.thickness.values, maps.flags.values, model=calibration.model
    )
    found = measure_pulse(pair, FilmTables.of(calibration), model=calibration.model)
    npt.assert_allclose(found, expected, rtol=1e-5)


SHAPE_OF_BLOCKS = (24, 21)


def add_all(images, region, offset=0.0, around=None, flags=None):
    """Sums by name; without flags of a map, those of the ratio."""
    rows = BlockRows.of(SHAPE_OF_BLOCKS, region)
    around = images[3] if around is None else around
    flags = images[3] if flags is None else flags
    for i in range(SHAPE_OF_BLOCKS[0]):
        add_to_blocks(images, i, np.float32(offset), around[i], flags, tuple(rows))
    return rows.named(offset, 1.0)


def images_of(ratio=1.0, variance=2.0, displaced=3.0):
    values = (np.full(SHAPE_OF_BLOCKS, value, np.float32) for value in (ratio, variance, displaced))
    return *values, np.zeros(SHAPE_OF_BLOCKS, np.uint16)


def test_sums_of_even_images_are_multiples_of_the_number_of_pixels():
    sums = add_all(images_of(), Region(slice(0, 24), slice(0, 21)), 0.25)
    pixels = np.outer([8, 8, 8], [8, 8, 5])
    npt.assert_array_equal(sums.lit, pixels)
    npt.assert_array_equal(sums.lit_ratio, 0.75 * pixels)
    npt.assert_array_equal(sums.lit_var, 2 * pixels)
    npt.assert_array_equal(sums.displaced, 3 * pixels)
    assert (sums.valid, sums.beyond) == (SHAPE_OF_BLOCKS[0] * SHAPE_OF_BLOCKS[1], 0)


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
