"""Two invented dyes, and the light of their film behind the filters of the two cameras.

The spectra are synthetic: smooth curves placed so that a film behaves like the pair of dyes of the
thesis (attenuation about 0.40 and 0.25 per um in the bands of 580 and 610 nm). They are not
measured spectra of any dye.

Not modelled: light of dye 1 that dye 2 absorbs is lost (no secondary emission), the laser passes
once (no reflection from the pin), and neither dye bleaches or saturates.
"""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from erlif.core.arrays import Array

LASER = 532.0
"""Wavelength of the laser. [nm]"""
BANDS = (580.0, 610.0)
"""Centres of the filters of cameras 1 and 2. [nm]"""
BANDWIDTH = 10.0
"""Full width of a filter at half of its transmission. [nm]"""
EDGE = 0.7
"""Softness of a filter's edges. [nm]"""
THICKEST = 200.0
"""Film from which on the signal has saturated. [um]"""

_REACH = 12  # nm from the centre of a band, where the filter has fallen below 1e-8
_STEP = 0.1  # nm of the integration over wavelengths
_TABLE = 10001  # entries of the table of the signal, 0.02 um apart


def absorption(wavelength: Array) -> Array:
    """Napierian attenuation of the dyed oil, both dyes together. [1/um]"""
    dye_1 = 0.213 * np.exp(-(((wavelength - 543) / 14) ** 2) / 2)
    dye_2 = 0.206 * np.exp(-(((wavelength - 572) / 22.3) ** 2) / 2)
    return np.asarray(dye_1 + dye_2)


def emission(wavelength: Array) -> Array:
    """Light per depth and wavelength by unit laser light, both dyes. [arbitrary unit]"""
    above_1, above_2 = (np.maximum(wavelength - onset, 1e-9) for onset in (520, 560))
    dye_1 = 0.157 * np.exp(-((np.log(above_1 / 48) / 0.38) ** 2) / 2)
    dye_2 = 0.041 * np.exp(-((np.log(above_2 / 52) / 0.36) ** 2) / 2)
    return np.asarray(dye_1 + dye_2)


def transmission(wavelength: Array, band: float) -> Array:
    """Transmission of a filter with smooth edges around `band` [nm]. [1]"""
    rise = (wavelength - band + BANDWIDTH / 2) / EDGE
    fall = (wavelength - band - BANDWIDTH / 2) / EDGE
    return np.asarray((np.tanh(rise) - np.tanh(fall)) / 2)


def band_signal(thickness: Array, band: float, *, derivative: bool = False) -> Array:
    """Light of a film of `thickness` [um] behind the filter at `band` [nm], or its slope.

    Laser light decays with the attenuation A at 532 nm on its way in. Light emitted at depth z
    decays with B(lambda) on its way out. Depth therefore integrates to
    ``(1 - exp(-(A + B) t)) / (A + B)``. Wavelength is integrated with the trapezoidal rule, which
    converges fast because the filter vanishes at both ends.
    """
    wavelength = np.arange(band - _REACH, band + _REACH + _STEP / 10, _STEP)
    weight = _STEP * transmission(wavelength, band) * emission(wavelength)
    both_ways = absorption(np.asarray(LASER)) + absorption(wavelength)
    depth = np.multiply.outer(np.asarray(thickness, dtype=np.float64), both_ways)
    per_wavelength = np.exp(-depth) if derivative else -np.expm1(-depth) / both_ways
    return np.asarray(per_wavelength @ weight)


def tabulate_signal(band: float) -> Callable[[Array], Array]:
    """Return a function of thickness [um]: light behind the filter over that of a thick film.

    It is a cubic Hermite table with exact slopes, 0.02 um apart: the error is below 1e-10.
    """
    thickness = np.linspace(0, THICKEST, _TABLE)
    signal, slope = (band_signal(thickness, band, derivative=order) for order in (False, True))
    table = CubicHermiteSpline(thickness, signal / signal[-1], slope / signal[-1])
    return lambda film: np.asarray(table(np.minimum(film, THICKEST)))
