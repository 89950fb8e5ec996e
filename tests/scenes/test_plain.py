"""The references of the compiled kernels, against sums written out and closed forms."""

import numpy as np
import numpy.testing as npt
import pytest

from scenes.plain import block_light, log_gradient, mean_of_surroundings


@pytest.fixture
def image():
    return np.random.default_rng(1).normal(5.0, 1.0, (30, 41)).astype(np.float32)


def test_blocks_are_means_and_those_at_the_edge_are_smaller(image):
    light = block_light(image, 8)
    assert light.shape == (4, 6)
    inner = image[:24, :40].reshape(3, 8, 5, 8).mean(axis=(1, 3))
    npt.assert_allclose(light[:3, :5], inner, rtol=1e-5)
    npt.assert_allclose(light[3, 5], image[24:, 40:].mean(), rtol=1e-5)


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
    assert np.isfinite(mean_of_surroundings(image, sound, width=3)).sum() == 9


def test_log_gradient_of_an_exponential_ramp():
    y, x = np.indices((40, 50))
    ramp = np.exp(0.03 * x + 0.04 * y).astype(np.float32)
    npt.assert_allclose(log_gradient(ramp)[2:-2, 2:-2], 0.05, rtol=1e-3)
