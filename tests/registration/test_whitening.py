"""Spectra and filters against Parseval's theorem, hand-made coherences and single waves."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy import fft

from erlif.registration.whitening import (
    REACH,
    Filter,
    Spectra,
    make_filter,
    measure_spectra,
    padded_size,
    slope_gain,
    whiten,
)

SIDE = 64
TAPER = np.sin(np.pi * np.arange(1, SIDE + 1) / (SIDE + 1)) ** 2  # Hann, without its zeros
RADIUS = np.hypot(fft.fftfreq(SIDE)[:, None], fft.rfftfreq(SIDE)[None, :]) * SIDE


def noise(shape=(192, 256), seed=0, sigma=1.0):
    return np.random.default_rng(seed).normal(0, sigma, shape).astype(np.float32)


def ones(shape=(192, 256)):
    return np.ones(shape, np.float32)


def spectra(gamma, blocks=10000, power=1.0):
    """Spectra of two textures of equal power whose coherence is ``gamma``, (y, x) like RADIUS."""
    flat = np.full(RADIUS.shape, power)
    return Spectra(flat, flat, gamma * flat, blocks)


# spectra ----------------------------------------------------------------------------------------


def test_white_noise_has_the_power_of_its_variance_under_the_taper():
    """Parseval: each frequency holds variance times the sum of the squared taper."""
    found = measure_spectra(noise(sigma=3), ones(), noise(seed=1))
    away = RADIUS > 3  # the mean of each block is taken out
    expected = (np.outer(TAPER, TAPER) ** 2).sum()
    npt.assert_allclose(found.first[away].mean() / found.blocks, 9 * expected, rtol=0.03)
    npt.assert_allclose(found.second[away].mean() / found.blocks, expected, rtol=0.03)
    assert abs(found.cross[away].mean() / found.blocks) < 0.05 * 3 * expected


@pytest.mark.parametrize("factor", [1.0, -1.0, 0.5])
def test_the_cross_spectrum_has_the_sign_and_size_of_the_common_texture(factor):
    a = noise()
    found = measure_spectra(a, ones(), (factor * a).astype(np.float32))
    npt.assert_allclose(found.cross, factor * found.first, rtol=1e-3)
    npt.assert_allclose(found.second, factor**2 * found.first, rtol=1e-3)


def test_textures_in_quadrature_share_nothing():
    """Only the part in phase counts, for aligned textures are in phase."""
    x = np.broadcast_to(np.arange(256), (192, 256))
    k = 2 * np.pi * 8 / SIDE
    a, b = np.cos(k * x).astype(np.float32), np.sin(k * x).astype(np.float32)
    found = measure_spectra(a, ones(), b)
    assert abs(found.cross).max() < 1e-3 * found.first.max()


@pytest.mark.parametrize(("cycles_y", "cycles_x"), [(0, 8), (5, 0), (60, 12)])
def test_a_wave_shows_at_its_frequency(cycles_y, cycles_x):
    y, x = np.indices((192, 256))
    wave = np.cos(2 * np.pi * (cycles_y * y + cycles_x * x) / SIDE).astype(np.float32)
    power = measure_spectra(wave, ones(), wave).first
    row, column = np.unravel_index(np.argmax(power), power.shape)
    assert min(row, SIDE - row) == min(cycles_y, SIDE - cycles_y)
    assert column == cycles_x


@pytest.mark.parametrize(
    ("shape", "side", "blocks"),
    [
        ((128, 128), 64, 3 * 3),
        ((127, 200), 32, 6 * 11),
        ((64, 64), 32, 3 * 3),
        ((640, 640), 64, 181),  # every second of 19 x 19, for no more than 250 are needed
    ],
)
def test_blocks_overlap_by_half_and_are_thinned_out_if_many(shape, side, blocks):
    found = measure_spectra(ones(shape), ones(shape), ones(shape))
    assert found.blocks == blocks
    assert found.first.shape == (side, side // 2 + 1)


def test_the_mean_of_a_block_is_no_texture():
    found = measure_spectra(5 * ones(), ones(), 5 * ones())
    npt.assert_allclose(found.first, 0, atol=1e-6)


@pytest.mark.parametrize(("columns", "blocks"), [(6, 9), (7, 6)])
def test_blocks_that_lack_a_tenth_of_their_pixels_are_left_out(columns, blocks):
    """7 of 64 columns are more than a tenth; the first column of blocks then goes."""
    weight = ones((128, 128))
    weight[:, :columns] = 0
    assert measure_spectra(noise((128, 128)), weight, noise((128, 128))).blocks == blocks
    b = noise((128, 128))
    b[:, :columns] = np.nan
    assert measure_spectra(noise((128, 128)), ones((128, 128)), b).blocks == blocks


def test_missing_pixels_take_no_part():
    a, b = noise(), noise(seed=1)
    holes = np.random.default_rng(2).uniform(size=a.shape) < 0.03
    weight = np.where(holes, 0, 1).astype(np.float32)
    plain = measure_spectra(a, weight, b)
    spoilt = measure_spectra(np.where(holes, 1e6, a), weight, np.where(holes, np.nan, b))
    npt.assert_allclose(spoilt.first, plain.first, rtol=1e-4)
    npt.assert_allclose(spoilt.second, plain.second, rtol=1e-4)


def test_frames_without_sound_blocks_have_empty_spectra():
    found = measure_spectra(noise(), 0 * ones(), noise())
    assert found.blocks == 0
    assert not found.first.any()


def test_spectra_of_several_frames_add_up():
    one = measure_spectra(noise(), ones(), noise(seed=1))
    two = measure_spectra(noise(seed=2), ones(), noise(seed=3))
    both = one + two
    assert both.blocks == one.blocks + two.blocks
    npt.assert_allclose(both.first, one.first + two.first)
    npt.assert_allclose(both.second, one.second + two.second)
    npt.assert_allclose(both.cross, one.cross + two.cross)


# the filter -------------------------------------------------------------------------------------


def knapp_carter(gamma):
    """Root of C/((1 - C) |S12|) for unit power, C = gamma^2."""
    return np.sqrt(gamma**2 / (1 - gamma**2) / gamma)


def test_the_amplitude_is_the_root_of_knapp_and_carters_weight():
    gamma = np.where(RADIUS < 16, 0.9, 0.5)
    found = make_filter(spectra(gamma))
    npt.assert_allclose(found.coherence[5:15], 0.81, rtol=1e-3)
    npt.assert_allclose(found.coherence[18:30], 0.25, rtol=1e-2)
    npt.assert_allclose(found.amplitude[5:14], 1, rtol=1e-3)
    expected = knapp_carter(0.5) / knapp_carter(0.9)
    npt.assert_allclose(found.amplitude[19:30], expected, rtol=1e-2)
    assert found.spacing == 1 / SIDE


def test_power_that_both_cameras_have_in_excess_is_evened_out():
    """Of equal coherence, four times the power gets half the amplitude: the texture is whitened."""
    one = spectra(np.full(RADIUS.shape, 0.8))
    factor = np.where(RADIUS < 16, 4.0, 1.0)
    found = make_filter(Spectra(*(factor * s for s in (one.first, one.second, one.cross)), 10000))
    npt.assert_allclose(found.amplitude[5:14] / found.amplitude[19], 0.5, rtol=1e-3)


def test_amplitudes_are_averaged_over_neighbouring_rings():
    """1-2-1 at a step of the coherence."""
    gamma = np.where(np.rint(RADIUS) < 16, 0.9, 0.5)
    amplitude = make_filter(spectra(gamma)).amplitude
    low, high = amplitude[20], amplitude[10]
    npt.assert_allclose(amplitude[15], 0.75 * high + 0.25 * low, rtol=1e-2)
    npt.assert_allclose(amplitude[16], 0.25 * high + 0.75 * low, rtol=1e-2)


def test_frequencies_within_their_own_scatter_get_no_weight():
    found = make_filter(spectra(np.where(RADIUS < 16, 0.9, 0.02), blocks=60))
    npt.assert_array_equal(found.amplitude[18:], 0)
    npt.assert_array_equal(found.coherence[18:], 0)


def test_textures_of_opposite_sign_share_nothing():
    found = make_filter(spectra(np.where(RADIUS < 16, 0.9, -0.9)))
    npt.assert_array_equal(found.coherence[18:], 0)
    assert make_filter(spectra(np.full(RADIUS.shape, -0.9))) is None


def test_frequencies_below_the_width_of_the_taper_count_only_by_their_neighbours():
    found = make_filter(spectra(np.full(RADIUS.shape, 0.9)))
    npt.assert_array_equal(found.coherence[:2], 0)
    npt.assert_allclose(found.amplitude[0], 0.25, rtol=1e-3)
    npt.assert_allclose(found.amplitude[2], 0.75, rtol=1e-3)


def test_noise_free_textures_get_a_finite_filter():
    found = make_filter(spectra(np.ones(RADIUS.shape)))
    assert np.isfinite(found.amplitude).all()
    assert found.amplitude.max() == 1


@pytest.mark.parametrize("blocks", [0, 3])
def test_a_few_blocks_give_no_filter(blocks):
    assert make_filter(spectra(np.full(RADIUS.shape, 0.9), blocks)) is None


def test_unrelated_textures_give_no_filter():
    assert make_filter(measure_spectra(noise(), ones(), noise(seed=1))) is None
    assert make_filter(spectra(np.full(RADIUS.shape, 0.9), power=0.0)) is None


def test_texture_of_one_camera_alone_is_suppressed():
    """Common texture is smooth, that of camera 2 alone white: the filter favours the smooth one."""
    common = fft.irfft2(
        fft.rfft2(noise())
        * np.exp(-2 * np.hypot(fft.fftfreq(192)[:, None], fft.rfftfreq(256)[None, :]) / 0.1)
    ).astype(np.float32)
    common /= common.std()
    found = make_filter(measure_spectra(common, ones(), common + noise(seed=5, sigma=0.3)))
    assert found.coherence[4] > 0.9
    assert found.coherence[28] < 0.3
    assert found.amplitude[4] > 3 * found.amplitude[28]


# the filter on images ---------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(96, 128), (97, 101)])
def test_the_amplitude_lies_on_the_frequencies_of_the_image(shape):
    """Linear between the frequencies, constant beyond the last one."""
    ramp = Filter(np.linspace(0, 1, 33), 1 / 64, np.zeros(33))
    radius = np.hypot(fft.fftfreq(shape[0])[:, None], fft.rfftfreq(shape[1])[None, :])
    expected = np.minimum(radius * 2, 1)
    npt.assert_allclose(ramp.on_grid(shape), expected, atol=1e-5)
    assert ramp.on_grid(shape).dtype == np.float32


def test_an_open_filter_leaves_the_texture_but_for_its_rms():
    texture = noise(sigma=3)
    filtered, _ = whiten(texture, ones(), np.ones((192, 129), np.float32))
    npt.assert_allclose(filtered, texture / np.sqrt((texture**2).mean()), rtol=1e-4, atol=1e-4)


def test_frequencies_are_passed_or_stopped():
    y, x = np.indices((192, 256))
    fast, slow = np.cos(2 * np.pi * x / 4), np.cos(2 * np.pi * (x + y) / 32)
    low = Filter(np.where(np.arange(48) < 12, 1.0, 0.0), 1 / 64, np.zeros(48)).on_grid((192, 256))
    filtered, _ = whiten((fast + slow).astype(np.float32), ones(), low)
    npt.assert_allclose(filtered, np.sqrt(2) * slow, atol=2e-3)


def test_weight_ends_where_the_filter_reaches_beyond_the_frame():
    weight = ones()
    weight[50, 60] = 0
    _, kept = whiten(noise(), weight, np.ones((192, 129), np.float32))
    inner = kept[REACH:-REACH, REACH:-REACH]
    assert inner.sum() == inner.size - 1
    assert kept.sum() == inner.sum()
    assert weight.sum() == weight.size - 1


def test_a_frame_without_texture_stays_zero():
    filtered, _ = whiten(0 * noise(), ones(), np.ones((192, 129), np.float32))
    assert not filtered.any()


def test_a_frame_of_an_awkward_size_is_padded_for_the_transform():
    rows, cols = padded_size((197, 263))
    assert rows >= 197
    assert cols >= 263
    for size in (rows, cols):
        for prime in (2, 3, 5):
            while size % prime == 0:
                size //= prime
        assert size == 1
    open_filter = Filter(np.ones(33), 1 / 64, np.zeros(33)).on_grid((rows, cols))
    texture = noise((197, 263))
    filtered, _ = whiten(texture, ones((197, 263)), open_filter)
    assert filtered.shape == (197, 263)
    npt.assert_allclose(np.corrcoef(filtered.ravel(), texture.ravel())[0, 1], 1, atol=1e-6)


# the slope of the score -------------------------------------------------------------------------


def at(*places):
    """Spectra with common texture at single frequencies (row, column) only."""
    cross = np.zeros(RADIUS.shape)
    for row, column in places:
        cross[row, column] = 1.0
    return Spectra(cross, cross, cross, 100)


def derivative(k):
    return (8 * np.sin(k) - np.sin(2 * k)) / 6


@pytest.mark.parametrize("cycles", [2, 8, 16, 24])
def test_a_wave_along_one_axis_falls_short_by_its_derivative(cycles):
    k = 2 * np.pi * cycles / SIDE
    npt.assert_allclose(slope_gain(at((0, cycles)), None), k / derivative(k), rtol=1e-9)
    npt.assert_allclose(slope_gain(at((cycles, 0)), None), k / derivative(k), rtol=1e-9)
    npt.assert_allclose(slope_gain(at((SIDE - cycles, 0)), None), k / derivative(k), rtol=1e-9)


def test_waves_count_by_their_gradient_products():
    k, q = 2 * np.pi * np.array([6, 20]) / SIDE
    expected = (k * derivative(k) + q * derivative(q)) / (derivative(k) ** 2 + derivative(q) ** 2)
    npt.assert_allclose(slope_gain(at((0, 6), (20, 0)), None), expected, rtol=1e-9)


def test_the_filter_weights_the_waves_by_its_square():
    k, q = 2 * np.pi * np.array([6, 20]) / SIDE
    half = Filter(np.interp(np.arange(48), [6, 20], [1.0, 0.5]), 1 / SIDE, np.zeros(48))
    expected = (k * derivative(k) + 0.25 * q * derivative(q)) / (
        derivative(k) ** 2 + 0.25 * derivative(q) ** 2
    )
    npt.assert_allclose(slope_gain(at((0, 6), (20, 0)), half), expected, rtol=1e-9)


def test_nothing_in_common_asks_for_no_correction():
    assert slope_gain(spectra(np.zeros(RADIUS.shape)), None) == 1
    assert slope_gain(spectra(np.full(RADIUS.shape, -0.5)), None) == 1
    assert slope_gain(spectra(np.ones(RADIUS.shape), blocks=0), None) == 1
    assert slope_gain(at((0, 0)), None) == 1  # the mean is no texture
