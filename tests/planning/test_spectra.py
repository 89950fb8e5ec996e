"""Spectra of dyes: Beer and Lambert, files, and what is refused."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ConfigError
from erlif.planning import SYNTHETIC, Dye, Spectrum, normalise_emission, read_spectrum
from erlif.planning import synthetic_spectra as synthetic
from erlif.rig import dyes as rig

FLAT = Spectrum(np.array([500.0, 700.0]), np.array([1.0, 1.0]), "emission of dye 1")


def test_attenuation_is_that_of_beer_and_lambert():
    """A decadic absorbance of 1: 1e4 L/mol/cm, 1e-4 mol/L, 1 cm."""
    absorption = Spectrum(np.array([500.0, 700.0]), np.full(2, 1e4), "absorption of dye 1")
    dye = Dye(1e-4, 1.0, absorption, FLAT)
    npt.assert_allclose(np.exp(-dye.attenuation(600.0) * 1e4), 0.1)


@pytest.mark.parametrize(("name", "left"), [(SYNTHETIC[0], (1, 0)), (SYNTHETIC[1], (0, 1))])
def test_synthetic_spectra_are_those_of_the_virtual_rig(name, left):
    concentration = dict(zip(SYNTHETIC, (0.008, 0.024), strict=True))[name]
    absorption, emission = synthetic(name)
    wavelength = np.arange(530.0, 621.0)  # where they are tabulated
    dye = Dye(concentration, 0.7, absorption, emission)
    npt.assert_allclose(
        dye.attenuation(wavelength), rig.absorption(wavelength, left), rtol=1e-4, atol=1e-6
    )
    shape = rig.emission(wavelength, left)
    npt.assert_allclose(
        emission.at(wavelength) / emission.at(580.0),
        shape / rig.emission(np.array(580.0), left),
        rtol=1e-4,
        atol=1e-5,
    )


def test_emission_is_normalised_to_one_photon():
    for name in SYNTHETIC:
        _, emission = synthetic(name)
        npt.assert_allclose(np.trapezoid(emission.value, emission.wavelength), 1.0)
    assert normalise_emission(FLAT).value[0] == 1 / 200


def test_coefficients_hold_for_their_band_alone():
    narrow = Spectrum(np.array([532.0, 580.0]), np.array([1.0, 2.0]), "absorption", narrow=True)
    npt.assert_array_equal(narrow.at([531.0, 574.0, 586.0]), [1.0, 2.0, 2.0])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (None, "cannot be read: No such file"),
        ("wavelength_nm,value\n500,1\0\n", "it holds a null byte. Save the spectrum as CSV"),
        ("wavelength_nm,value\n500," + 200_000 * "1", "field larger than field limit"),
        ("nm,value\n500,1\n600,2\n", "header wavelength_nm,value"),
        ("wavelength_nm,value\n500,1\n", "rising wavelengths"),
        ("wavelength_nm,value\n500,one\n600,2\n", "could not convert"),
        ("wavelength_nm,value\n500,-1\n600,2\n", "baseline"),
        ("wavelength_nm,value\n500,nan\n600,2\n", "finite"),
        ("wavelength_nm,value\n0.5,1\n0.6,2\n", "to nm"),
    ],
)
def test_a_file_that_is_no_spectrum_is_refused(tmp_path, text, expected):
    path = tmp_path / "dye.csv"
    if text is not None:
        path.write_text(text)
    with pytest.raises(ConfigError, match=expected):
        read_spectrum(path, "absorption of dye 1")


def test_an_unknown_name_and_a_wavelength_beyond_the_spectrum_are_refused():
    with pytest.raises(ConfigError, match="synthetic 605, synthetic 650"):
        synthetic("rhodamine")
    with pytest.raises(ConfigError, match="covers 500 to 700 nm"):
        FLAT.at([695.0, 705.0])
