"""Light and ratio of a design, against the virtual rig and closed forms."""

import math
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad

from erlif.planning import (
    Spectrum,
    emitted_light,
    log_ratio,
    log_ratio_slope,
    mean_attenuation,
    optical_thickness,
    saturation_fluence,
    scale_of_optics,
    signal,
)
from erlif.rig.dyes import BANDS, tabulate_signal

FILMS = np.array([0.2, 1.0, 3.0, 8.0, 20.0, 60.0])


@pytest.mark.parametrize("number", [1, 2])
def test_signal_is_that_of_the_virtual_rig(design, number):
    """The rig integrates its own formulas, over a filter with soft edges."""
    thick = (11000.0, 11500.0)[number - 1]
    expected = thick * tabulate_signal(BANDS[number - 1])(FILMS)
    npt.assert_allclose(signal(design, number, FILMS), expected, rtol=2e-3)


def test_narrow_bands_give_the_ratio_of_the_thesis(design):
    """Farzaneh (2002), eq. 5.7: dye 1 emits at 580 nm, and dye 2, not reabsorbed, at 610."""
    nm = np.array([532.0, 580.0, 610.0])

    def dye(number, absorption, emission):
        return replace(
            design.dyes[number],
            absorption=Spectrum(nm, np.array(absorption), "absorption", narrow=True),
            emission=Spectrum(nm, np.array(emission), "emission", narrow=True),
        )

    e1, e2, b2, c1, c2 = 8e4, 7e3, 3.5e4, 0.008, 0.024
    narrow = replace(
        design,
        dyes=(dye(0, [e1, 0, 0], [0, 0.01, 0]), dye(1, [e2, b2, 0], [0, 0, 0.02])),
        cameras=tuple(replace(camera, scale=1.0) for camera in design.cameras),
    )
    per_um = math.log(10) * 1e-4
    A, B = per_um * (e1 * c1 + e2 * c2), per_um * b2 * c2
    K0 = e1 * c1 * 0.01 / (e2 * c2 * 0.02)
    R = K0 * A / (A + B) * np.expm1(-(A + B) * FILMS) / np.expm1(-A * FILMS)
    npt.assert_allclose(np.exp(-log_ratio(narrow, FILMS)), R, rtol=1e-12)
    npt.assert_allclose(optical_thickness(narrow), (B, A))


def test_light_is_the_integral_over_depth_and_filter(design):
    camera = design.cameras[0]

    def emitted(wavelength):
        a = sum(float(dye.attenuation(design.laser)) for dye in design.dyes)
        b = sum(float(dye.attenuation(wavelength)) for dye in design.dyes)
        light = sum(
            float(dye.attenuation(design.laser) * dye.quantum_yield * dye.emission.at(wavelength))
            for dye in design.dyes
        )
        return light * quad(lambda depth: math.exp(-(a + b) * depth), 0, 5.0)[0]

    ends = camera.band - camera.bandwidth / 2, camera.band + camera.bandwidth / 2
    expected = quad(emitted, *ends, epsrel=1e-5, limit=100)[0]
    npt.assert_allclose(emitted_light(design, 1, 5.0), expected, rtol=1e-3)


def test_slope_is_the_derivative_of_the_logarithm(design):
    step = 1e-5
    numeric = (log_ratio(design, FILMS + step) - log_ratio(design, FILMS - step)) / (2 * step)
    npt.assert_allclose(log_ratio_slope(design, FILMS), numeric, rtol=1e-4, atol=1e-9)


def test_the_dyes_of_the_thesis_attenuate_as_documented(design):
    """About 0.40 and 0.25 per um, and a reabsorption of the order of the absorption.

    Half of the concentrations stretch the curve to twice the thickness.
    """
    npt.assert_allclose([mean_attenuation(design, k) for k in (1, 2)], [0.40, 0.25], rtol=0.02)
    reabsorption, absorption = optical_thickness(design)
    assert 0.9 < reabsorption / absorption < 1.1
    thin = design.with_concentrations(design.concentrations / 2)
    npt.assert_allclose(log_ratio(thin, 2 * FILMS), log_ratio(design, FILMS), rtol=1e-9)


def test_optics_give_photons_from_first_principles():
    """1 mJ of 532 nm over 1 cm2, a pixel of 100 um, a hemisphere collected in full."""
    scale = scale_of_optics(
        pulse_energy=1e-3,
        wavelength=532.0,
        beam_diameter=math.sqrt(4 / math.pi) * 1e-2,
        pixel_pitch=1e-4,
        numerical_aperture=1.0,
        refractive_index=1.0,
        efficiency=0.5,
    )
    photons = 1e-3 / (1239.84198 / 532 * 1.602176634e-19)
    npt.assert_allclose(scale, photons * 1e-4 / 2 * 0.5, rtol=1e-6)


def test_saturation_is_one_photon_for_each_cross_section(design):
    cross_section = 3.823e-21 * 84903  # cm2 for a decadic coefficient in L/mol/cm
    assert saturation_fluence(design) == pytest.approx(3.734e-19 / cross_section, rel=1e-3)
