"""Textures without illumination, against chequerboards, waves and noise of known response."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.normalise import binned, normalise

SHAPE = (128, 160)
Y, X = np.indices(SHAPE, dtype=np.float64)
BOARD = (-1.0) ** (X + Y)  # mean 0 and rms 1 over every cell
MIDDLE = (slice(40, -40), slice(40, -40))


# binning ----------------------------------------------------------------------------------------


def test_blocks_are_averaged_and_the_remainder_is_dropped():
    image = np.arange(7 * 10, dtype=np.uint16).reshape(7, 10)
    small, weight = binned(image, None, 3)
    assert small.shape == (2, 3)
    npt.assert_allclose(small[0, 0], image[:3, :3].mean())
    npt.assert_allclose(small[1, 2], image[3:6, 6:9].mean())
    npt.assert_array_equal(weight, 1)
    assert small.dtype == weight.dtype == np.float32


def test_pixels_without_weight_do_not_enter_the_mean():
    image = np.arange(16, dtype=np.float32).reshape(4, 4)
    weight = np.ones((4, 4), np.float32)
    weight[0, 0] = 0
    small, _ = binned(image, weight, 2)
    npt.assert_allclose(small[0, 0], (1 + 4 + 5) / 3)


@pytest.mark.parametrize(("missing", "counts"), [(1, 1), (2, 0), (3, 0), (4, 0)])
def test_a_block_needs_more_than_half_its_pixels(missing, counts):
    image = np.full((2, 2), 7, np.float32)
    weight = np.ones((2, 2), np.float32)
    weight.ravel()[:missing] = 0
    small, sound = binned(image, weight, 2)
    assert sound[0, 0] == counts
    assert small[0, 0] == 7 * counts


def test_weights_of_the_pixels_are_those_of_the_mean():
    image = np.array([[1, 5], [1, 5]], np.float32)
    weight = np.array([[3, 1], [3, 1]], np.float32)
    npt.assert_allclose(binned(image, weight, 2)[0], 2.0)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_pixel_that_is_not_finite_is_left_out_or_takes_its_block_out(value):
    image = np.full((2, 4), 7, np.float32)
    image[0, 0] = value
    small, sound = binned(image, np.ones((2, 4), np.float32), 2)
    npt.assert_array_equal(small, [[7, 7]])
    small, sound = binned(image, None, 2)
    npt.assert_array_equal(small, [[0, 7]])
    npt.assert_array_equal(sound, [[0, 1]])


# the texture ------------------------------------------------------------------------------------


@pytest.mark.parametrize("contrast", [0.02, 0.3])
@pytest.mark.parametrize("level", [50.0, 30000.0])
def test_level_and_contrast_are_divided_out(level, contrast):
    texture, weight = normalise(level * (1 + contrast * BOARD))
    npt.assert_allclose(texture, BOARD, atol=2e-3)
    npt.assert_array_equal(weight, 1)
    assert texture.dtype == weight.dtype == np.float32


@pytest.mark.parametrize("kind", [np.uint16, np.int32, np.float32, np.float64])
def test_any_real_type_gives_the_same_texture(kind):
    image = np.random.default_rng(1).integers(500, 1500, SHAPE)
    npt.assert_allclose(normalise(image.astype(kind))[0], normalise(image)[0], atol=1e-5)


def test_gain_of_a_camera_changes_nothing():
    image = np.random.default_rng(1).uniform(500, 1500, SHAPE).astype(np.float32)
    npt.assert_array_equal(normalise(4 * image)[0], normalise(image)[0])


def test_threads_change_nothing():
    image = np.random.default_rng(1).uniform(500, 1500, SHAPE)
    for threads in (2, 4):
        npt.assert_array_equal(normalise(image, threads=threads)[0], normalise(image)[0])


def test_noise_becomes_a_texture_of_mean_0_and_rms_1():
    image = 1000 + 50 * np.random.default_rng(2).standard_normal(SHAPE)
    texture, _ = normalise(image)
    assert abs(texture.mean()) < 0.02
    npt.assert_allclose(texture.std(), 1, atol=0.03)


def test_local_contrast_is_evened_out():
    contrast = np.where(X < 80, 0.05, 0.2)
    texture, _ = normalise(1000 * (1 + contrast * BOARD))
    npt.assert_allclose(np.abs(texture[:, :30]), 1, atol=0.1)
    npt.assert_allclose(np.abs(texture[:, -30:]), 1, atol=0.02)


@pytest.mark.parametrize("reach", [6.0, 12.0])
@pytest.mark.parametrize("along", [0, 1])
def test_slow_light_is_left_as_the_gaussian_of_the_mean_leaves_it(reach, along):
    """A wave of number k keeps 1 - exp(-(sigma k)^2 / 2) of its amplitude, the board all of it."""
    k = 2 * np.pi / 64
    wave = np.cos(k * (X if along else Y))
    texture, _ = normalise(1000 * (1 + 0.1 * BOARD + 0.01 * wave), reach=reach)
    board = (texture * BOARD)[MIDDLE].mean()
    period = (slice(32, 96), slice(48, 112))
    left = (texture * wave)[period].mean() / (wave**2)[period].mean()
    # cells of 4 px add to the variance of the average: 15/12 for the mean, 16/6 for the way between
    sigma2 = reach**2 + 15 / 12 + 16 / 6
    npt.assert_allclose(left / board, 0.1 * (1 - np.exp(-sigma2 * k**2 / 2)), rtol=0.03)


def test_a_ramp_of_light_leaves_no_texture():
    even, _ = normalise(1000 * (1 + 0.1 * BOARD))
    ramp, _ = normalise((1000 + 5 * X) * (1 + 0.1 * BOARD))
    npt.assert_allclose(ramp[MIDDLE], even[MIDDLE], atol=0.02)


# what does not count ----------------------------------------------------------------------------


@pytest.mark.parametrize(("level", "enters"), [(15.0, False), (30.0, True)])
def test_light_below_a_fiftieth_of_the_brighter_parts_does_not_enter_the_averages(level, enters):
    """Next to an edge an average over both sides would be too low, and the texture too bright."""
    image = np.where(X < 80, 1000.0, level) * (1 + 0.1 * BOARD)
    texture, _ = normalise(image, reach=6.0)
    mean = texture[:, 74:80].mean()
    assert mean > 0.2 if enters else abs(mean) < 0.05


def test_a_masked_pixel_changes_nothing_around_it():
    clean = 1000 * (1 + 0.1 * BOARD)
    weight = np.ones(SHAPE, np.float32)
    weight[40:50, 60:75] = 0
    spoilt = np.where(weight > 0, clean, 60000)
    texture, kept = normalise(spoilt, weight)
    npt.assert_array_equal(texture[weight == 0], 0)
    npt.assert_array_equal(kept, weight)
    npt.assert_allclose(texture[weight > 0], BOARD[weight > 0], atol=5e-3)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_pixel_that_is_not_finite_has_no_weight(value):
    image = (1000 * (1 + 0.1 * BOARD)).astype(np.float32)
    image[50, 70] = value
    image[2, 2] = value  # where the cell takes its pivot
    texture, weight = normalise(image)
    npt.assert_array_equal(np.argwhere(weight == 0), [[2, 2], [50, 70]])
    npt.assert_array_equal(texture[weight == 0], 0)
    npt.assert_allclose(texture[weight > 0], BOARD[weight > 0], atol=5e-3)


def test_weights_are_handed_on():
    weight = np.where(X < 80, 1, 0.5).astype(np.float32)
    npt.assert_array_equal(normalise(1000 * (1 + 0.1 * BOARD), weight)[1], weight)


def test_a_large_hole_does_not_darken_its_surroundings():
    """The average is over what counts alone; 60 px wide, the middle of the hole has nothing."""
    image = (1000 + 2 * Y) * (1 + 0.1 * BOARD)
    weight = np.ones(SHAPE, np.float32)
    weight[:, 50:110] = 0
    texture, kept = normalise(image, weight)
    npt.assert_array_equal(kept, weight)
    npt.assert_allclose(texture[20:-20, 30:50], BOARD[20:-20, 30:50], atol=0.05)


@pytest.mark.parametrize("image", [np.zeros(SHAPE, np.uint16), np.full(SHAPE, -5.0)])
def test_a_dark_frame_has_neither_texture_nor_weight(image):
    texture, weight = normalise(image)
    assert not texture.any()
    assert not weight.any()


def test_a_frame_without_sound_pixels_has_neither_texture_nor_weight():
    texture, weight = normalise(np.full(SHAPE, 1000.0), np.zeros(SHAPE, np.float32))
    assert not texture.any()
    assert not weight.any()


def test_an_even_frame_stays_finite():
    texture, weight = normalise(np.full(SHAPE, 1000.0))
    npt.assert_allclose(texture, 0, atol=1e-6)
    npt.assert_array_equal(weight, 1)


def test_flat_parts_are_not_blown_up_to_noise():
    """Their rms is taken as a fiftieth of the largest in the frame."""
    contrast = np.where(X < 64, 0.2, 0.0002)
    texture, _ = normalise(1000 * (1 + contrast * BOARD), reach=3.0)
    npt.assert_allclose(np.abs(texture[:, -20:]), 0.0002 / (0.02 * 0.2), rtol=0.05)


@pytest.mark.parametrize("shape", [(64, 64), (65, 67), (66, 130)])
def test_frames_need_not_be_made_of_whole_cells(shape):
    y, x = np.indices(shape)
    board = (-1.0) ** (x + y)
    texture, weight = normalise(1000 * (1 + 0.1 * board))
    assert texture.shape == weight.shape == shape
    inner = (slice(4, -4), slice(4, -4))
    npt.assert_allclose(texture[inner], board[inner], atol=0.02)
