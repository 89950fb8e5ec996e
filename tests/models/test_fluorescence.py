"""Two-band emission against integrals, limits and a published slope."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import quad

from erlif.models.fluorescence import (
    band_light,
    band_ratio,
    band_signal,
    log_band_ratio,
    mean_transmission,
)

DYES = {"ratio_at_zero": 0.65, "attenuation_camera1": 0.40, "attenuation_camera2": 0.25}


@pytest.mark.parametrize("thickness", [0.01, 1.0, 7.0, 60.0])
def test_band_signal_is_the_integral_over_depth(thickness):
    depth_integral, _ = quad(lambda x: np.exp(-0.3 * x), 0, thickness, epsabs=1e-14)
    npt.assert_allclose(band_signal(thickness, attenuation=0.3), depth_integral, rtol=1e-10)


@pytest.mark.parametrize("thickness", [0.01, 1.0, 7.0, 30.0])
def test_log_ratio_is_that_of_two_integrals(thickness):
    one, _ = quad(lambda x: np.exp(-0.40 * x), 0, thickness, epsabs=1e-14)
    two, _ = quad(lambda x: np.exp(-0.25 * x), 0, thickness, epsabs=1e-14)
    npt.assert_allclose(log_band_ratio(thickness, **DYES), np.log(0.65 * two / one), atol=1e-10)


def test_slope_has_the_value_of_eq_5_7():
    # A = 0.03, B = 0.06 1/um at 10 um, by hand from eq. 5.7 of Farzaneh (2002):
    # d ln R/dt = -0.02408828 1/um for camera 1 / camera 2
    ratio = band_ratio(10.0, ratio_at_zero=1.0, attenuation_camera1=0.09, attenuation_camera2=0.03)
    npt.assert_allclose(ratio.slope, 0.02408828, rtol=3e-7)


def test_thin_and_thick_limits():
    npt.assert_allclose(np.exp(log_band_ratio(0.0, **DYES)), 0.65)
    npt.assert_allclose(band_ratio(0.0, **DYES).slope, 0.075)
    npt.assert_allclose(np.exp(log_band_ratio(1e4, **DYES)), 0.65 * 0.40 / 0.25, rtol=1e-12)


@given(st.floats(0.01, 40), st.floats(0.02, 1.0), st.floats(0.01, 0.5), st.floats(0.2, 3.0))
@example(thickness=39.625, q=0.97265625, difference=0.01, ratio_at_zero=1.0)
def test_ratio_rises_and_slope_is_its_derivative(thickness, q, difference, ratio_at_zero):
    model = {
        "ratio_at_zero": ratio_at_zero,
        "attenuation_camera1": q + difference,
        "attenuation_camera2": q,
    }
    slope = band_ratio(thickness, **model).slope
    assert slope > 0
    step = 1e-4 * thickness
    rise = log_band_ratio(thickness + step, **model) - log_band_ratio(thickness - step, **model)
    npt.assert_allclose(slope, rise / (2 * step), rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("thickness", [30.0, 100.0, 500.0])
def test_slope_of_a_thick_film_keeps_its_digits(thickness):
    """q exp(-q t) - p exp(-p t), the first term of the series, in 50 digits by decimal."""
    from decimal import Decimal

    p, q, t = Decimal("0.99"), Decimal("0.97"), Decimal(thickness)
    expected = q / ((q * t).exp() - 1) - p / ((p * t).exp() - 1)
    ratio = band_ratio(
        thickness, ratio_at_zero=1.0, attenuation_camera1=0.99, attenuation_camera2=0.97
    )
    npt.assert_allclose(ratio.slope, float(expected), rtol=1e-12)


def test_gradient_is_the_derivative_by_each_parameter():
    thickness = np.array([0.0, 1e-4, 0.5, 4.0, 20.0])
    names = list(DYES)
    gradient = band_ratio(thickness, **DYES).gradient
    for n, name in enumerate(names):
        step = 1e-5 * DYES[name]
        up, down = ({**DYES, name: DYES[name] + sign * step} for sign in (1, -1))
        npt.assert_allclose(
            gradient[n],
            (log_band_ratio(thickness, **up) - log_band_ratio(thickness, **down)) / (2 * step),
            atol=1e-7,
        )


def test_series_joins_the_closed_form_smoothly():
    around = np.array([0.9e-5, 1.1e-5, 0.9e-3, 1.1e-3])
    npt.assert_allclose(mean_transmission(around), 1 - around / 2 + around**2 / 6, rtol=1e-9)
    light = band_light(around, attenuation=1.0)
    npt.assert_allclose(light.gradient[0], around * (-0.5 + around / 12), atol=2e-14)
    npt.assert_allclose(light.slope, 1 / around - 0.5 + around / 12, rtol=2e-14)


WALL = DYES | {"attenuation_laser": 0.20, "reflectance": 0.3}


def light_before_wall(thickness, laser, band, reflectance):
    """Laser and emission, each direct and by way of the wall, integrated over depth."""

    def from_depth(z):
        back = 2 * thickness - z
        into = np.exp(-laser * z) + reflectance * np.exp(-laser * back)
        out = np.exp(-band * z) + reflectance * np.exp(-band * back)
        return into * out

    return quad(from_depth, 0, thickness, epsabs=0, epsrel=1e-12, limit=400)[0]


@pytest.mark.parametrize("reflectance", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("thickness", [1e-4, 0.5, 7.0, 60.0])
def test_ratio_before_a_wall_is_that_of_two_integrals(thickness, reflectance):
    one, two = (light_before_wall(thickness, 0.20, b, reflectance) for b in (0.20, 0.05))
    found = band_ratio(thickness, **WALL | {"reflectance": reflectance})
    npt.assert_allclose(found.log_ratio, np.log(0.65 * two / one), atol=1e-12)
    light = band_light(thickness, attenuation=0.40, attenuation_laser=0.20, reflectance=reflectance)
    npt.assert_allclose(light.signal * (1 + reflectance) ** 2, one, rtol=1e-12)


@pytest.mark.parametrize("name", WALL)
def test_gradient_before_a_wall_is_the_derivative(name):
    film, step, n = np.array([0.1, 3.0, 12.0, 40.0]), 1e-6, list(WALL).index(name)

    def ratio(change):
        return band_ratio(film, **WALL | {name: WALL[name] + change})

    numerical = (ratio(step).log_ratio - ratio(-step).log_ratio) / (2 * step)
    npt.assert_allclose(ratio(0).gradient[n], numerical, rtol=1e-5, atol=1e-8)


def test_slopes_before_a_wall_are_derivatives():
    film, step = np.array([0.1, 3.0, 12.0, 40.0]), 1e-5
    wall = {name: WALL[name] for name in ("attenuation_laser", "reflectance")}

    def light(thickness=film, **change):
        return band_light(thickness, **{"attenuation": 0.4} | wall | change)

    above, below = band_ratio(film + step, **WALL), band_ratio(film - step, **WALL)
    numerical = (above.log_ratio - below.log_ratio) / (2 * step)
    npt.assert_allclose(band_ratio(film, **WALL).slope, numerical, atol=1e-9)
    numerical = np.log(light(film + step).signal / light(film - step).signal) / (2 * step)
    npt.assert_allclose(light().slope, numerical, atol=1e-9)
    for n, (name, value) in enumerate(({"attenuation": 0.4} | wall).items()):
        up, down = (light(**{name: value + change}).signal for change in (step, -step))
        npt.assert_allclose(light().gradient[n], np.log(up / down) / (2 * step), atol=1e-8)
