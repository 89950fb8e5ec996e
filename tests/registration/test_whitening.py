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
    slope_gain,
    whiten_texture,
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


@pytest.mark.parametrize(("columns", "blocks"), [(6, 9), (7, 6)])
def test_blocks_that_lack_a_tenth_of_their_pixels_are_left_out(columns, blocks):
    """7 of 64 columns are more than a tenth; the first column of blocks then goes."""
    weight = ones((128, 128))
    weight[:, :columns] = 0
    assert measure_spectra(noise((128, 128)), weight, noise((128, 128))).blocks == blocks
    b = noise((128, 128))
    b[:, :columns] = np.nan
    assert measure_spectra(noise((128, 128)), ones((128, 128)), b).blocks == blocks


def knapp_carter(gamma):
    """Root of C/((1 - C) |S12|) for unit power, C = gamma^2."""
    return np.sqrt(gamma**2 / (1 - gamma**2) / gamma)


def test_the_amplitude_is_the_root_of_knapp_and_carters_weight():
    gamma = np.where(RADIUS < 16, 0.9, 0.5)
    found = make_filter(spectra(gamma))
    npt.assert_allclose(found.amplitude[5:14], 1, rtol=1e-3)
    expected = knapp_carter(0.5) / knapp_carter(0.9)
    npt.assert_allclose(found.amplitude[19:30], expected, rtol=1e-2)
    assert found.spacing == 1 / SIDE


def test_amplitudes_are_averaged_over_neighbouring_rings():
    """1-2-1 at a step of the coherence."""
    gamma = np.where(np.rint(RADIUS) < 16, 0.9, 0.5)
    amplitude = make_filter(spectra(gamma)).amplitude
    low, high = amplitude[20], amplitude[10]
    npt.assert_allclose(amplitude[15], 0.75 * high + 0.25 * low, rtol=1e-2)
    npt.assert_allclose(amplitude[16], 0.25 * high + 0.75 * low, rtol=1e-2)


def test_few_blocks_and_unrelated_textures_give_no_filter():
    common = np.full(RADIUS.shape, 0.9)
    unlike = measure_spectra(noise(), ones(), noise(seed=1))
    nothing = measure_spectra(noise(), 0 * ones(), noise())
    assert nothing.blocks == 0
    for one in (spectra(common, 3), spectra(common, power=0.0), unlike, nothing):
        assert make_filter(one) is None


def test_weight_ends_where_the_filter_reaches_beyond_the_frame():
    weight = ones()
    weight[50, 60] = 0
    _, kept = whiten_texture(noise(), weight, np.ones((192, 129), np.float32))
    inner = kept[REACH:-REACH, REACH:-REACH]
    assert inner.sum() == inner.size - 1
    assert kept.sum() == inner.sum()
    assert weight.sum() == weight.size - 1


def at(*places):
    """Spectra with common texture at single frequencies (row, column) only."""
    cross = np.zeros(RADIUS.shape)
    for row, column in places:
        cross[row, column] = 1.0
    return Spectra(cross, cross, cross, 100)


def derivative(k):
    return (8 * np.sin(k) - np.sin(2 * k)) / 6


def test_the_filter_weights_the_waves_by_its_square():
    k, q = 2 * np.pi * np.array([6, 20]) / SIDE
    half = Filter(np.interp(np.arange(48), [6, 20], [1.0, 0.5]), 1 / SIDE)
    expected = (k * derivative(k) + 0.25 * q * derivative(q)) / (
        derivative(k) ** 2 + 0.25 * derivative(q) ** 2
    )
    npt.assert_allclose(slope_gain(at((0, 6), (20, 0)), half), expected, rtol=1e-9)


def test_nothing_in_common_asks_for_no_correction():
    assert slope_gain(spectra(np.zeros(RADIUS.shape)), None) == 1
    assert slope_gain(spectra(np.full(RADIUS.shape, -0.5)), None) == 1
    assert slope_gain(spectra(np.ones(RADIUS.shape), blocks=0), None) == 1
    assert slope_gain(at((0, 0)), None) == 1  # the mean is no texture
