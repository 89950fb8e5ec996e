"""Smoothing of the ratio: stated noise, films, steps and holes keep their shape and place."""

import math

import numpy as np
import numpy.testing as npt
import pytest
from scenes.gap import known_calibration
from scenes.gap import true_log_ratio as log_ratio_of
from scenes.pair import ratio_images

from erlif.core.errors import ModelError
from erlif.core.flags import Flag
from erlif.ratio import smooth_ratio
from erlif.thickness import measure_thickness

NOISE = 0.0135  # standard deviation of the log ratio
Y, X = np.mgrid[:240, :320]
SMOOTH_FILM = 3.0 + 1.5 * ((X - 160) / 160) ** 2 + 0.4 * (Y - 120) / 120  # parabola and tilt [um]
EDGE = 160  # first column of the thick side of the step


@pytest.fixture(scope="module")
def calibration():
    return known_calibration()


def images_of(log_ratio, variance=NOISE**2, flags=0):
    return ratio_images(log_ratio, variance, fixed=np.multiply(variance, 0.1), flags=flags)


def noisy(film, seed, flags=0):
    rng = np.random.default_rng(seed)
    return images_of(log_ratio_of(film) + rng.normal(0, NOISE, film.shape), flags=flags)


@pytest.fixture(scope="module", params=[201, 202, 203, 204])
def smooth_film(request, calibration):
    images = noisy(SMOOTH_FILM, request.param)
    both = images, smooth_ratio(images, resolution=5)
    return [measure_thickness(each, calibration) for each in both]


def test_scatter_of_a_smooth_film_falls_threefold_and_error_bars_cover(smooth_film):
    before, after = (float((maps.thickness - SMOOTH_FILM).std()) for maps in smooth_film)
    assert after < before / 3
    pull = np.abs((smooth_film[1].thickness - SMOOTH_FILM) / smooth_film[1].thickness_std).values
    assert 0.66 <= np.mean(pull < 1) <= 0.70
    assert 0.945 <= np.mean(pull < 2) <= 0.965


def test_noise_falls_as_a_gaussian_window_allows():
    """A Gaussian window of standard deviation s leaves 1/(4 pi s^2) of the variance."""
    sigma = 5 / math.sqrt(8 * math.log(2))
    after = smooth_ratio(noisy(SMOOTH_FILM, 211), resolution=5)
    inner = after.isel(x=slice(12, -12), y=slice(12, -12))
    npt.assert_allclose(
        np.median(inner.log_ratio_var), NOISE**2 / (4 * math.pi * sigma**2), rtol=0.03
    )
    rest = inner.log_ratio.values - log_ratio_of(SMOOTH_FILM)[12:-12, 12:-12]
    npt.assert_allclose(rest.std(), NOISE / math.sqrt(4 * math.pi) / sigma, rtol=0.05)


def test_weights_follow_the_variance():
    """Five times the noise beyond an edge: the stated deviations cover on either side."""
    rng = np.random.default_rng(7)
    std = np.where(X < EDGE, NOISE, 5 * NOISE)
    after = smooth_ratio(images_of(rng.normal(0, 1, X.shape) * std, std**2), resolution=5)
    deviation = np.sqrt(after.log_ratio_var.values)
    for columns in (slice(EDGE - 5, EDGE), slice(EDGE, EDGE + 5), slice(EDGE + 20, None)):
        pull = after.log_ratio.values[:, columns] / deviation[:, columns]
        npt.assert_allclose(np.sqrt(np.mean(pull**2)), 1, atol=0.12)
    assert deviation[:, EDGE - 1].max() < NOISE


@pytest.mark.parametrize("resolution", [2, 5, 9.5])
def test_a_plane_is_reproduced_at_borders_and_holes(resolution):
    plane = 0.2 + 0.004 * X - 0.006 * Y
    flags = np.where((X - 100) ** 2 + (Y - 90) ** 2 < 15**2, Flag.NO_FILM, 0).astype(np.uint16)
    flags[:, 200] = Flag.BAD_PIXEL
    values = np.where(flags != 0, 1e3, plane)
    after = smooth_ratio(images_of(values, flags=flags), resolution=resolution)
    npt.assert_allclose(
        after.log_ratio.values[flags == 0], plane[flags == 0], atol=2e-5
    )  # single precision


def test_remaining_variance_is_the_sum_of_squared_weights():
    """The weights are the response to each single pixel, small enough to be no step."""
    rng = np.random.default_rng(3)
    variance = NOISE**2 * rng.uniform(0.5, 2.0, (15, 15))
    flags = np.zeros((15, 15), np.uint16)
    flags[6:9, 8:11] = Flag.NO_FILM
    base = smooth_ratio(images_of(np.zeros((15, 15)), variance, flags=flags), resolution=4)
    # one frame for each pixel
    single = 1e-4 * np.eye(225).reshape(225, 15, 15)
    weights = smooth_ratio(images_of(single, variance, flags=flags), resolution=4).log_ratio / 1e-4
    total = np.tensordot(variance.ravel(), weights.values**2, 1)
    sound = flags == 0
    npt.assert_allclose(base.log_ratio_var.values[sound], total[sound], rtol=1e-3)


@pytest.mark.parametrize("turn", [False, True])
def test_a_step_stays_where_it_is(calibration, turn):
    """A film of 3 um that steps to 4 um."""
    film = np.where(X >= EDGE, 4.0, 3.0)
    images = noisy(film.T if turn else film, 31)
    maps = measure_thickness(smooth_ratio(images, resolution=5), calibration)
    mean = maps.thickness.mean("x" if turn else "y").values
    above = np.nonzero(mean > 3.5)[0]
    k = above[0]
    crossing = k - 1 + (3.5 - mean[k - 1]) / (mean[k] - mean[k - 1])
    assert abs(crossing - (EDGE - 0.5)) <= 1
    npt.assert_array_equal(above, np.arange(k, mean.size))


def test_error_bars_cover_beside_a_step(calibration):
    film = np.where(X >= EDGE, 4.0, 3.0)
    near = slice(EDGE - 6, EDGE + 6)
    pulls = []
    for seed in range(300, 312):
        maps = measure_thickness(smooth_ratio(noisy(film, seed), resolution=5), calibration)
        pulls.append(np.abs((maps.thickness.values - film) / maps.thickness_std.values)[:, near])
    assert 0.64 <= np.mean(np.array(pulls) < 1) <= 0.72
    assert 0.935 <= np.mean(np.array(pulls) < 2) <= 0.97


def test_holes_are_not_filled_and_do_not_affect_their_rim():
    bubble = (X - 100) ** 2 + (Y - 90) ** 2 < 12**2
    flags = np.where(bubble, Flag.NO_FILM, 0).astype(np.uint16)
    images = noisy(SMOOTH_FILM, 51, flags=flags)
    images.log_ratio.values[bubble] = 5.0
    filled_with_nan = images.copy(deep=True)
    filled_with_nan.log_ratio.values[bubble] = np.nan
    after, other = (smooth_ratio(each, resolution=5) for each in (images, filled_with_nan))
    npt.assert_array_equal(after.log_ratio.values[~bubble], other.log_ratio.values[~bubble])
    npt.assert_array_equal(after.log_ratio.values[bubble], 5.0)
    npt.assert_array_equal(after.flags, images.flags)
    rim = ~bubble & ((X - 100) ** 2 + (Y - 90) ** 2 < 15**2)
    error = after.log_ratio.values - log_ratio_of(SMOOTH_FILM)
    assert np.sqrt(np.mean((error**2 / after.log_ratio_var.values)[rim])) < 1.3


def test_correlated_noise_of_neighbours_raises_the_remaining_variance():
    """A quarter of the noise of each neighbour along x, as after interpolation."""
    rng = np.random.default_rng(71)
    white = rng.normal(0, 1, X.shape)
    mixed = white + 0.25 * (np.roll(white, 1, axis=1) + np.roll(white, -1, axis=1))
    after = smooth_ratio(images_of(NOISE * mixed / math.sqrt(1.125)), resolution=5)
    pull = after.log_ratio.values / np.sqrt(after.log_ratio_var.values)
    assert 0.93 < pull.std() < 1.07


@pytest.mark.parametrize("resolution", [1.9, 0, -3, math.nan, math.inf])
def test_a_resolution_below_two_pixels_is_refused(resolution):
    with pytest.raises(ModelError, match="at least 2 px"):
        smooth_ratio(noisy(SMOOTH_FILM, 1), resolution=resolution)
