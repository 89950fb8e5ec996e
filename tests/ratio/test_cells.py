"""Light and ratio in coarse cells."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.ratio import NO_CELLS, cell_centres, sample_cells


def images(shape=(160, 192), seed=1):
    rng = np.random.default_rng(seed)
    light = (1000 * np.exp(0.1 * rng.standard_normal(shape))).astype(np.float32)
    ratio = (0.3 + 0.02 * rng.standard_normal(shape)).astype(np.float32)
    return light, ratio, np.full(shape, 4e-4, np.float32), np.zeros(shape, np.uint8)


def test_cells_are_means_over_blocks():
    """Each cell holds 2 x 2 blocks of 8 x 8 pixels."""
    light, ratio, variance, flags = images()
    cells = sample_cells(light, ratio, variance, flags)
    blocks = light.reshape(20, 8, 24, 8).mean(axis=(1, 3), dtype=float)
    of_light = np.log(blocks).reshape(10, 2, 12, 2).mean(axis=(1, 3))
    npt.assert_allclose(cells.light, of_light.ravel(), rtol=1e-6)
    of_ratio = ratio.reshape(10, 16, 12, 16).mean(axis=(1, 3), dtype=float)
    npt.assert_allclose(cells.log_ratio, of_ratio.ravel(), rtol=1e-5)
    npt.assert_allclose(cells.variance, 4e-4 / 256, rtol=1e-5)


def test_spread_is_that_of_the_film_without_the_noise():
    light, ratio, variance, flags = images((320, 384), seed=2)
    rows = np.arange(320, dtype=np.float32)[:, None] // 8 * 0.01  # a step from block to block
    cells = sample_cells(light, ratio + rows, variance, flags)
    steps = 0.01**2 * np.var(np.arange(4))
    npt.assert_allclose(cells.spread.mean(), steps, rtol=0.05)
    assert abs(sample_cells(light, ratio, variance, flags).spread.mean()) < 0.1 * 4e-4 / 64


def test_a_cell_with_a_bubble_is_left_out_and_single_defects_are_not():
    light, ratio, variance, flags = images()
    flags[5, 5] = 4
    flags[40:46, 40:46] = 128
    cells = sample_cells(light, ratio, variance, flags)
    assert np.isfinite(cells.log_ratio[0])
    assert np.flatnonzero(np.isnan(cells.log_ratio)).tolist() == [2 * 12 + 2]


def test_saturated_grains_take_the_light_of_a_cell_and_leave_its_ratio():
    light, ratio, variance, flags = images()
    grains = np.random.default_rng(4).random(light.shape) < 0.1
    flags[grains] = 1
    cells = sample_cells(light, np.where(grains, np.float32(9), ratio), variance, flags)
    assert np.isnan(cells.light).mean() > 0.8
    npt.assert_allclose(cells.log_ratio, 0.3, atol=5 * 0.02 / 16)


@pytest.mark.parametrize("shape", [(72, 200), (200, 88)])
def test_small_images_have_no_cells(shape):
    npt.assert_array_equal(sample_cells(*images(shape)), NO_CELLS)


@pytest.mark.parametrize("shape", [(80, 96), (128, 160), (256, 320)])
def test_centres_are_those_of_the_pixels_that_are_averaged(shape):
    """Images of the column and of the row as ratios."""
    light, variance = np.full(shape, 1000, np.float32), np.full(shape, 1e-4, np.float32)
    flags = np.zeros(shape, np.uint16)
    rows, columns = (np.asarray(part, np.float32) for part in np.indices(shape))
    for image, centre in zip((columns, rows), cell_centres(shape), strict=True):
        found = sample_cells(light, np.ascontiguousarray(image), variance, flags)
        npt.assert_allclose(centre, found.log_ratio, rtol=1e-5)
