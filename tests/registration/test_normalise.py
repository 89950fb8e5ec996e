"""Textures without illumination, against chequerboards, waves and noise of known response."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.normalise import binned, normalise

SHAPE = (128, 160)
Y, X = np.indices(SHAPE, dtype=np.float64)
BOARD = (-1.0) ** (X + Y)  # mean 0 and rms 1 over every cell
MIDDLE = (slice(40, -40), slice(40, -40))


def test_blocks_are_averaged_and_the_remainder_is_dropped():
    image = np.arange(7 * 10, dtype=np.uint16).reshape(7, 10)
    small, weight = binned(image, None, 3)
    assert small.shape == (2, 3)
    npt.assert_allclose(small[0, 0], image[:3, :3].mean())
    npt.assert_allclose(small[1, 2], image[3:6, 6:9].mean())
    npt.assert_array_equal(weight, 1)
    assert small.dtype == weight.dtype == np.float32


@pytest.mark.parametrize(("missing", "counts"), [(1, 1), (2, 0), (3, 0), (4, 0)])
def test_a_block_needs_more_than_half_its_pixels(missing, counts):
    image = np.full((2, 2), 7, np.float32)
    weight = np.ones((2, 2), np.float32)
    weight.ravel()[:missing] = 0
    small, sound = binned(image, weight, 2)
    assert sound[0, 0] == counts
    assert small[0, 0] == 7 * counts


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_pixel_that_is_not_finite_is_left_out_or_takes_its_block_out(value):
    image = np.full((2, 4), 7, np.float32)
    image[0, 0] = value
    small, sound = binned(image, np.ones((2, 4), np.float32), 2)
    npt.assert_array_equal(small, [[7, 7]])
    small, sound = binned(image, None, 2)
    npt.assert_array_equal(small, [[0, 7]])
    npt.assert_array_equal(sound, [[0, 1]])


@pytest.mark.parametrize("contrast", [0.02, 0.3])
@pytest.mark.parametrize("level", [50.0, 30000.0])
def test_level_and_contrast_are_divided_out(level, contrast):
    texture, weight = normalise(level * (1 + contrast * BOARD))
    npt.assert_allclose(texture, BOARD, atol=2e-3)
    npt.assert_array_equal(weight, 1)
    assert texture.dtype == weight.dtype == np.float32


@pytest.mark.parametrize("reach", [6.0, 12.0])
@pytest.mark.parametrize("along", [0, 1])
def test_slow_light_is_left_as_the_parabolas_of_the_mean_leave_it(reach, along):
    """A wave of number k keeps 1 - (1 + s) exp(-s), s = (sigma k)^2 / 2; the board all of it.

    (3 - x^2/sigma^2) / 2 times the Gaussian gives the middle of a parabola fitted with it; its
    Fourier transform is (1 + s) exp(-s).
    """
    k = 2 * np.pi / 64
    wave = np.cos(k * (X if along else Y))
    texture, _ = normalise(1000 * (1 + 0.1 * BOARD + 0.01 * wave), reach=reach)
    board = (texture * BOARD)[MIDDLE].mean()
    period = (slice(32, 96), slice(48, 112))
    left = (texture * wave)[period].mean() / (wave**2)[period].mean()
    # cells of 4 px add to the variance of the average: 15/12 for the mean, 16/6 for the way between
    square = reach**2 * k**2 / 2
    passed = (1 + square) * np.exp(-square - (15 / 12 + 16 / 6) * k**2 / 2)
    npt.assert_allclose(left / board, 0.1 * (1 - passed), rtol=0.03)


def test_light_with_slope_and_bend_is_no_texture_even_at_the_edges():
    """Each band has its slope elsewhere: what is left of it would draw one image to the other."""
    u, v = X / SHAPE[1] - 0.5, Y / SHAPE[0] - 0.5
    light = 1000 * (1 + 0.8 * u - 0.5 * v + 0.4 * u * v + 0.3 * u**2 - 0.2 * v**2)
    texture, _ = normalise(light * (1 + 0.1 * BOARD))
    # squares of 4 px; no derivative is taken in the outermost two pixels
    slow = (texture - BOARD)[2:-2, 2:-2].reshape(31, 4, 39, 4).mean((1, 3))
    assert np.abs(slow).max() < 0.05  # 0.5 % of the light; a Gaussian mean leaves 17 %


@pytest.mark.parametrize(("level", "enters"), [(15.0, False), (30.0, True)])
def test_light_below_a_fiftieth_of_the_brighter_parts_does_not_enter_the_averages(level, enters):
    """Next to an edge an average over both sides would be too low, and the texture too bright."""
    image = np.where(X < 80, 1000.0, level) * (1 + 0.1 * BOARD)
    texture, _ = normalise(image, reach=6.0)
    mean = texture[:, 74:80].mean()
    assert mean > 0.2 if enters else abs(mean) < 0.05


def test_flat_parts_are_not_blown_up_to_noise():
    """Their rms is taken as a fiftieth of the largest in the frame."""
    contrast = np.where(X < 64, 0.2, 0.0002)
    texture, _ = normalise(1000 * (1 + contrast * BOARD), reach=3.0)
    npt.assert_allclose(np.abs(texture[:, -20:]), 0.0002 / (0.02 * 0.2), rtol=0.05)
