"""Means over blocks and neighbourhoods, against sums written out."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.neighbourhood import block_light, mean_of_surroundings


@pytest.fixture
def image():
    return np.random.default_rng(1).normal(5.0, 1.0, (30, 41)).astype(np.float32)


def test_blocks_have_the_mean_light_of_both_cameras(image):
    light = block_light(image[:24, :40], 2 * image[:24, :40], 8)
    expected = 3 * image[:24, :40].reshape(3, 8, 5, 8).mean(axis=(1, 3))
    npt.assert_allclose(light, expected, rtol=1e-5)


def test_blocks_at_the_edge_are_the_mean_of_fewer_pixels(image):
    light = block_light(image, image, 8)
    assert light.shape == (4, 6)
    npt.assert_allclose(light[3, 5], 2 * image[24:, 40:].mean(), rtol=1e-5)


def test_unknown_pixels_of_either_camera_are_left_out_of_a_block(image):
    one, two = image.copy(), image.copy()
    one[0, 0] = two[3, 4] = np.nan
    one[8:16, :8] = np.nan
    light = block_light(one, two, 8)
    known = np.ones((8, 8), bool)
    known[0, 0] = known[3, 4] = False
    npt.assert_allclose(light[0, 0], 2 * image[:8, :8][known].mean(), rtol=1e-5)
    assert np.isnan(light[1, 0])
    assert np.isnan(light).sum() == 1


@pytest.mark.parametrize(("width", "without"), [(9, 0), (5, 3), (17, 5)])
def test_mean_is_that_of_the_valid_pixels_of_the_square(image, width, without):
    sound = np.random.default_rng(2).random(image.shape) < 0.7
    found = mean_of_surroundings(image, sound, width=width, without=without)
    y, x = np.indices(image.shape)
    for i, j in ((0, 0), (12, 20), (29, 40), (3, 38)):
        apart = np.maximum(abs(y - i), abs(x - j))
        use = sound & (apart <= width // 2)
        if without:
            use &= apart > without // 2
        npt.assert_allclose(found[i, j], image[use].mean(), rtol=1e-5)


def test_a_pixel_without_valid_neighbours_has_no_mean(image):
    sound = np.zeros(image.shape, bool)
    assert np.isnan(mean_of_surroundings(image, sound)).all()
    sound[2, 2] = True
    mean = mean_of_surroundings(image, sound, width=3)
    assert np.isfinite(mean[1:4, 1:4]).all()
    assert np.isfinite(mean).sum() == 9


def test_values_of_invalid_pixels_have_no_effect(image):
    sound = np.ones(image.shape, bool)
    sound[10, 10:14] = False
    other = image.copy()
    other[10, 10:14] = np.nan, np.inf, -1e30, 1e30
    npt.assert_array_equal(mean_of_surroundings(image, sound), mean_of_surroundings(other, sound))


def test_middle_of_the_square_and_flagged_pixels_are_left_out():
    image = np.arange(30 * 30, dtype=np.float32).reshape(30, 30)
    sound = np.ones(image.shape, bool)
    sound[10, 12] = False
    mean = mean_of_surroundings(image, sound, width=5, without=3)
    window = image[8:13, 8:13].copy()
    use = np.ones((5, 5), bool)
    use[1:4, 1:4] = False
    use[2, 4] = False
    npt.assert_allclose(mean[10, 10], window[use].mean(), rtol=1e-6)
    assert np.isnan(mean_of_surroundings(image, np.zeros_like(sound))).all()
