"""Two dyes, and the light of their film behind the filters of the two cameras.

The spectra are given (`DyeSpectra`), or synthetic: smooth curves placed so that a film behaves like
the pair of dyes of the thesis (attenuation about 0.40 and 0.25 per um in the bands of 580 and
610 nm). The synthetic ones are not measured spectra of any dye.

Not modelled: light of dye 1 that dye 2 absorbs is lost (no secondary emission), the laser passes
once (no reflection from the pin), and neither dye saturates. Bleaching takes absorption and light
of a dye alike.
"""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from erlif.core.arrays import Array
from erlif.rig.settings import DyeSpectra

# Wavelength of the laser. [nm]
LASER = 532.0
# Centres of the filters of cameras 1 and 2. [nm]
BANDS = (580.0, 610.0)
# Full width of a filter at half of its transmission. [nm]
BANDWIDTH = 10.0
# Softness of a filter's edges. [nm]
EDGE = 0.7
# Film from which on the signal has saturated. [um]
THICKEST = 200.0

_REACH = 12  # nm from the centre of a band, where the filter has fallen below 1e-8
_STEP = 0.1  # nm of the integration over wavelengths
_TABLE = 10001  # entries of the table of the signal, 0.02 um apart for the invented dyes
_SATURATED = 40.0  # optical depth from which on the signal has saturated, for given dyes


# Shares of dye 1 and dye 2 that bleaching has left.
Left = tuple[float, float]

_FRESH: Left = (1.0, 1.0)


def _sum(
    dyes: DyeSpectra, of: tuple[tuple[float, ...], tuple[float, ...]], wavelength: Array, left: Left
) -> Array:
    """A spectrum of both given dyes together, with what bleaching has left of each."""
    one, two = (np.interp(wavelength, dyes.wavelength, values) for values in of)
    return np.asarray(left[0] * one + left[1] * two)


def absorption(wavelength: Array, left: Left = _FRESH, dyes: DyeSpectra | None = None) -> Array:
    """Napierian attenuation of the dyed oil, both dyes together. [1/um]"""
    if dyes is not None:
        return _sum(dyes, dyes.attenuation, wavelength, left)
    dye_1 = 0.213 * np.exp(-(((wavelength - 543) / 14) ** 2) / 2)
    dye_2 = 0.206 * np.exp(-(((wavelength - 572) / 22.3) ** 2) / 2)
    return np.asarray(left[0] * dye_1 + left[1] * dye_2)


def emission(wavelength: Array, left: Left = _FRESH, dyes: DyeSpectra | None = None) -> Array:
    """Light per depth and wavelength by unit laser light, both dyes. [arbitrary unit]"""
    if dyes is not None:
        return _sum(dyes, dyes.emission, wavelength, left)
    above_1, above_2 = (np.maximum(wavelength - onset, 1e-9) for onset in (520, 560))
    dye_1 = 0.157 * np.exp(-((np.log(above_1 / 48) / 0.38) ** 2) / 2)
    dye_2 = 0.041 * np.exp(-((np.log(above_2 / 52) / 0.36) ** 2) / 2)
    return np.asarray(left[0] * dye_1 + left[1] * dye_2)


def transmission(wavelength: Array, band: float, width: float = BANDWIDTH) -> Array:
    """Transmission of a filter with smooth edges around `band`, of full `width` [nm]. [1]"""
    rise = (wavelength - band + width / 2) / EDGE
    fall = (wavelength - band - width / 2) / EDGE
    return np.asarray((np.tanh(rise) - np.tanh(fall)) / 2)


def band_signal(
    thickness: Array,
    band: float,
    *,
    derivative: bool = False,
    left: Left = _FRESH,
    dyes: DyeSpectra | None = None,
) -> Array:
    """Light of a film of `thickness` [um] behind the filter at `band` [nm], or its slope.

    Laser light decays with the attenuation A at 532 nm on its way in. Light emitted at depth z
    decays with B(lambda) on its way out. Depth therefore integrates to
    ``(1 - exp(-(A + B) t)) / (A + B)``. Wavelength is integrated with the trapezoidal rule, which
    converges fast because the filter vanishes at both ends.
    """
    laser, width = (LASER, BANDWIDTH)
    if dyes is not None:
        laser, width = dyes.laser, dyes.bandwidth[dyes.bands.index(band)]
    reach = _REACH + (width - BANDWIDTH) / 2
    wavelength = np.arange(band - reach, band + reach + _STEP / 10, _STEP)
    weight = _STEP * transmission(wavelength, band, width) * emission(wavelength, left, dyes)
    both_ways = absorption(np.asarray(laser), left, dyes) + absorption(wavelength, left, dyes)
    depth = np.multiply.outer(np.asarray(thickness, dtype=np.float64), both_ways)
    per_wavelength = np.exp(-depth) if derivative else -np.expm1(-depth) / both_ways
    return np.asarray(per_wavelength @ weight)


def thickest(dyes: DyeSpectra | None) -> float:
    """Film from which on the signal has saturated. [um]"""
    if dyes is None:
        return THICKEST
    return _SATURATED / float(absorption(np.asarray(dyes.laser), dyes=dyes))


def tabulate_signal(
    band: float, left: Left = _FRESH, dyes: DyeSpectra | None = None
) -> Callable[[Array], Array]:
    """Return a function of thickness [um]: light behind the filter over that of a thick fresh film.

    It is a cubic Hermite table with exact slopes, 0.02 um apart for the invented dyes: the error is
    below 1e-10.
    """
    end = thickest(dyes)
    thickness = np.linspace(0, end, _TABLE)
    signal, slope = (
        band_signal(thickness, band, derivative=order, left=left, dyes=dyes)
        for order in (False, True)
    )
    fresh = signal[-1] if left == _FRESH else band_signal(thickness[-1:], band, dyes=dyes)[0]
    table = CubicHermiteSpline(thickness, signal / fresh, slope / fresh)
    return lambda film: np.asarray(table(np.minimum(film, end)))


def signals_of(
    dyes: DyeSpectra | None, left: Left = _FRESH
) -> tuple[Callable[[Array], Array], Callable[[Array], Array]]:
    """`tabulate_signal` behind the filters of cameras 1 and 2."""
    bands = BANDS if dyes is None else dyes.bands
    return tabulate_signal(bands[0], left, dyes), tabulate_signal(bands[1], left, dyes)
