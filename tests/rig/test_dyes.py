"""Light of the invented dyes against independent integration over depth and wavelength."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import dblquad, quad
from scipy.optimize import least_squares

from erlif.rig.dyes import (
    BANDS,
    LASER,
    THICKEST,
    DyedOil,
    absorption,
    emission,
    filtered_light,
    tabulate_signal,
    transmission,
)
from erlif.rig.settings import DyeSpectra

# the light behind a filter and its limits


@pytest.mark.parametrize("band", [580.0, 610.0])
@pytest.mark.parametrize("thickness", [0.2, 5.0])
def test_filtered_light_is_the_double_integral(band, thickness):
    def light(depth, wavelength):
        lost = (absorption(np.asarray(LASER)) + absorption(np.asarray(wavelength))) * depth
        return float(
            transmission(np.asarray(wavelength), band)
            * emission(np.asarray(wavelength))
            * np.exp(-lost)
        )

    whole = dblquad(light, band - 12, band + 12, 0, thickness, epsrel=1e-9)[0]
    npt.assert_allclose(filtered_light(np.asarray(thickness), band), whole, rtol=1e-7)


def test_a_wall_returns_laser_and_emission():
    """Both reach every depth directly and by way of the wall; a narrow filter at 580 nm."""
    into, out = (float(absorption(np.asarray(nm))) for nm in (LASER, 580.0))

    def light(depth, thickness):
        back = 2 * thickness - depth
        ways = [np.exp(-rate * depth) + 0.4 * np.exp(-rate * back) for rate in (into, out)]
        return ways[0] * ways[1]

    def signal(thickness, reflectance):
        return float(
            filtered_light(np.asarray(thickness), 580.0, oil=DyedOil(reflectance=reflectance))
        )

    # over the width of the filter the attenuation changes by a few per cent, to both sides
    for thickness in (0.5, 4.0, 12.0):
        direct = -np.expm1(-(into + out) * thickness) / (into + out)
        expected = quad(light, 0, thickness, (thickness,))[0] / direct
        found = signal(thickness, 0.4) / signal(thickness, 0.0)
        npt.assert_allclose(found, expected, rtol=3e-3)
    step = 1e-5
    slope = float(
        filtered_light(np.asarray(4.0), 580.0, derivative=True, oil=DyedOil(reflectance=0.4))
    )
    numerical = (signal(4.0 + step, 0.4) - signal(4.0 - step, 0.4)) / (2 * step)
    npt.assert_allclose(slope, numerical, rtol=1e-7)


@pytest.mark.parametrize("band", [580.0, 610.0])
def test_thin_and_thick_limits(band):
    def made(wavelength):
        return float(transmission(np.asarray(wavelength), band) * emission(np.asarray(wavelength)))

    def left(wavelength):
        return made(wavelength) / float(
            absorption(np.asarray(LASER)) + absorption(np.asarray(wavelength))
        )

    thin, thick = (quad(what, band - 12, band + 12, epsrel=1e-10)[0] for what in (made, left))
    npt.assert_allclose(filtered_light(np.asarray(1e-6), band) / 1e-6, thin, rtol=1e-6)
    npt.assert_allclose(filtered_light(np.asarray(200.0), band), thick, rtol=1e-9)


def test_table_of_the_signal_is_exact_and_saturated_beyond_its_end():
    thickness = np.random.default_rng(0).uniform(0, THICKEST, 2000)
    for band, wall in ((580.0, 0.0), (610.0, 0.0), (610.0, 0.6)):
        oil = DyedOil(reflectance=wall)
        thick = filtered_light(np.asarray(THICKEST), band)
        signal = tabulate_signal(band, oil=oil)
        direct = filtered_light(thickness, band, oil=oil) / thick
        npt.assert_allclose(signal(thickness), direct, rtol=1e-9)
    signal = tabulate_signal(580.0)
    npt.assert_array_equal(signal(np.array([THICKEST, 2 * THICKEST])), 1)
    assert signal(np.array(0.0)) == 0


def test_filter_passes_ten_nanometres_at_half_height():
    npt.assert_allclose(
        transmission(np.array([575.0, 580.0, 585.0]), 580.0), [0.5, 1, 0.5], atol=1e-5
    )


def test_three_parameters_describe_the_ratio_of_the_bands():
    """The narrow-band law with p about 0.40 and q about 0.25 per um is good to 0.2 %."""
    t = np.geomspace(0.3, 15, 300)
    ratio = np.log(tabulate_signal(610.0)(t) / tabulate_signal(580.0)(t))

    def law(k, p, q):
        return np.log(k * p / q * np.expm1(-q * t) / np.expm1(-p * t))

    fit = least_squares(lambda v: law(*v) - ratio, [0.7, 0.4, 0.25], xtol=1e-12, ftol=1e-12)
    assert np.abs(fit.fun).max() < 2e-3
    npt.assert_allclose(fit.x[1:], [0.40, 0.25], rtol=0.05)


@pytest.mark.parametrize("band", BANDS)
def test_slope_of_the_signal_is_its_derivative(band):
    film, step = np.linspace(0.1, 20, 30), 1e-4
    numerical = (filtered_light(film + step, band) - filtered_light(film - step, band)) / (2 * step)
    npt.assert_allclose(filtered_light(film, band, derivative=True), numerical, rtol=1e-6)


def test_reabsorption_is_stronger_in_the_band_of_camera_1():
    """So the ratio camera 2 / camera 1 rises with thickness."""
    one, two = (absorption(np.asarray(band)) for band in BANDS)
    assert one > 2 * two
    film = np.linspace(0.05, 100, 2000)
    ratio = tabulate_signal(BANDS[1])(film) / tabulate_signal(BANDS[0])(film)
    assert np.all(np.diff(ratio) > 0)


def test_a_bleached_dye_1_dims_both_bands_and_a_bleached_dye_2_clears_camera_1():
    """Light of a thin film is emission times thickness, so it falls with the dye that made it."""
    thin = np.asarray(1e-5)
    for band in BANDS:
        wavelength = np.linspace(band - 12, band + 12, 20001)
        by_dye = [
            np.trapezoid(transmission(wavelength, band) * emission(wavelength, left), wavelength)
            for left in ((1.0, 0.0), (0.0, 1.0))
        ]
        for left in ((0.7, 1.0), (1.0, 0.7), (0.6, 0.8)):
            expected = (left[0] * by_dye[0] + left[1] * by_dye[1]) / sum(by_dye)
            light = filtered_light(thin, band, oil=DyedOil(left)) / filtered_light(thin, band)
            npt.assert_allclose(light, expected, rtol=1e-5)
            npt.assert_allclose(
                tabulate_signal(band, oil=DyedOil(left))(thin) / tabulate_signal(band)(thin),
                expected,
                rtol=1e-5,
            )

    # reabsorption by dye 2 lies in the band of camera 1, so that the ratio of a thick film falls
    thick = np.asarray(20.0)
    fresh, faded = (
        filtered_light(thick, 610.0, oil=DyedOil(left))
        / filtered_light(thick, 580.0, oil=DyedOil(left))
        for left in ((1.0, 1.0), (1.0, 0.8))
    )
    assert faded < fresh


# given spectra


def test_given_spectra_are_used_in_place_of_the_invented_ones():
    wavelength = np.concatenate([[LASER], np.arange(560.0, 631.0, 0.1)])

    def parts(of):
        return tuple(tuple(of(wavelength, left).tolist()) for left in ((1, 0), (0, 1)))

    same = DyeSpectra(
        LASER, BANDS, (10.0, 10.0), tuple(wavelength), parts(absorption), parts(emission)
    )
    film = np.array([0.3, 2.0, 9.0, 30.0])
    for band in BANDS:
        npt.assert_allclose(
            tabulate_signal(band, dyes=same)(film), tabulate_signal(band)(film), rtol=1e-5
        )


def test_weak_dyes_saturate_in_thick_films():
    wavelength = (532.0, 560.0, 630.0)
    weak = DyeSpectra(
        LASER, BANDS, (10.0, 10.0), wavelength, ((1e-3,) * 3, (2e-3,) * 3), ((1.0,) * 3,) * 2
    )
    of_film = tabulate_signal(580.0, dyes=weak)
    npt.assert_allclose(of_film(np.array([100.0, 400.0])), -np.expm1([-0.6, -2.4]), rtol=1e-6)
