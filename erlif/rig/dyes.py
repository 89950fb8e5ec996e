"""Two dyes, and the light of their film behind the filters of the two cameras.

The spectra are given (`DyeSpectra`), or synthetic: smooth curves placed so that a film behaves like
the pair of dyes of the thesis (attenuation about 0.40 and 0.25 per um in the bands of 580 and
610 nm). The synthetic ones are not measured spectra of any dye.

Not modelled: light of dye 1 that dye 2 absorbs is lost (no secondary emission), and neither dye
saturates. Bleaching takes absorption and light of a dye alike, warmth its light alone. The wall
behind the film returns the same share of laser and emission.
"""

from collections.abc import Callable
from dataclasses import dataclass

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
_TABLE = 2001  # entries of the table of the signal
_DENSER = 5.0  # e-folds by which they are denser in thin film, where the signal bends
_EQUAL = 1e-9  # 1/um: difference of two attenuations that is taken for none
_SATURATED = 40.0  # optical depth from which on the signal has saturated, for given dyes


# Dye 1 and dye 2 over what the fixture holds: another batch, and what bleaching has left.
Left = tuple[float, float]

_FRESH: Left = (1.0, 1.0)

# Light behind the filters of cameras 1 and 2 over that of a thick film, by thickness. [um]
Signals = tuple[Callable[[Array], Array], Callable[[Array], Array]]


@dataclass(frozen=True)
class DyedOil:
    """State of the dyed oil, and the wall behind it.

    Attributes
    ----------
    left : tuple[float, float]
        Dye 1 and dye 2 over what the fixture holds. [1]
    glow : tuple[float, float]
        Light of both by the laser that they absorb, over that at the calibration. [1]
    reflectance : float
        Share of laser and emission that the wall returns. [1]
    """

    left: Left = _FRESH
    glow: Left = _FRESH
    reflectance: float = 0.0


_AS_FILLED = DyedOil()


def absorption(wavelength: Array, left: Left = _FRESH, dyes: DyeSpectra | None = None) -> Array:
    """Napierian attenuation of the dyed oil, both dyes together. [1/um]"""
    if dyes is None:
        dye_1 = 0.213 * np.exp(-(((wavelength - 543) / 14) ** 2) / 2)
        dye_2 = 0.206 * np.exp(-(((wavelength - 572) / 22.3) ** 2) / 2)
    else:
        dye_1, dye_2 = (np.interp(wavelength, dyes.wavelength, one) for one in dyes.attenuation)
    return np.asarray(left[0] * dye_1 + left[1] * dye_2)


def emission(wavelength: Array, left: Left = _FRESH, dyes: DyeSpectra | None = None) -> Array:
    """Light per depth and wavelength by unit laser light, both dyes. [arbitrary unit]"""
    if dyes is None:
        above_1, above_2 = (np.maximum(wavelength - onset, 1e-9) for onset in (520, 560))
        dye_1 = 0.157 * np.exp(-((np.log(above_1 / 48) / 0.38) ** 2) / 2)
        dye_2 = 0.041 * np.exp(-((np.log(above_2 / 52) / 0.36) ** 2) / 2)
    else:
        dye_1, dye_2 = (np.interp(wavelength, dyes.wavelength, one) for one in dyes.emission)
    return np.asarray(left[0] * dye_1 + left[1] * dye_2)


def transmission(wavelength: Array, band: float, width: float = BANDWIDTH) -> Array:
    """Transmission of a filter with smooth edges around `band`, of full `width` [nm]. [1]"""
    rise = (wavelength - band + width / 2) / EDGE
    fall = (wavelength - band - width / 2) / EDGE
    return np.asarray((np.tanh(rise) - np.tanh(fall)) / 2)


def filtered_light(
    thickness: Array,
    band: float,
    *,
    derivative: bool = False,
    dyes: DyeSpectra | None = None,
    oil: DyedOil = _AS_FILLED,
) -> Array:
    """Light of a film of `thickness` [um] behind the filter at `band` [nm], or its slope.

    Laser light decays with the attenuation A at 532 nm on its way in. Light emitted at depth z
    decays with B(lambda) on its way out. Depth therefore integrates to
    ``(1 - exp(-(A + B) t)) / (A + B)``. Wavelength is integrated with the trapezoidal rule, which
    converges fast because the filter vanishes at both ends. A wall adds the laser that it returns,
    the emission that it returns, and the emission of returned laser that it returns.
    """
    laser, width, left = LASER, BANDWIDTH, oil.left
    if dyes is not None:
        laser, width = dyes.laser, dyes.bandwidth[dyes.bands.index(band)]
    reach = _REACH + (width - BANDWIDTH) / 2
    wavelength = np.arange(band - reach, band + reach + _STEP / 10, _STEP)
    shining = left[0] * oil.glow[0], left[1] * oil.glow[1]
    weight = _STEP * transmission(wavelength, band, width) * emission(wavelength, shining, dyes)
    into, out = absorption(np.asarray(laser), left, dyes), absorption(wavelength, left, dyes)
    t = np.asarray(thickness, dtype=np.float64)
    way_in, way_out = np.exp(-into * t)[..., np.newaxis], np.exp(-np.multiply.outer(t, out))
    both = way_in * way_out

    per_wavelength = both if derivative else (1 - both) / (into + out)
    if oil.reflectance:
        apart = np.where(np.abs(into - out) < _EQUAL, _EQUAL, into - out)
        if derivative:
            once = 2 * (into * way_in**2 - out * way_out**2) / apart
            again = 2 * both**2 - both
        else:
            once = (way_out**2 - way_in**2) / apart
            again = (both - both**2) / (into + out)
        per_wavelength = per_wavelength + oil.reflectance * once + oil.reflectance**2 * again
    return np.asarray(per_wavelength @ weight)


def thickest(dyes: DyeSpectra | None) -> float:
    """Film from which on the signal has saturated. [um]"""
    if dyes is None:
        return THICKEST
    return _SATURATED / float(absorption(np.asarray(dyes.laser), dyes=dyes))


def tabulate_signal(
    band: float, dyes: DyeSpectra | None = None, oil: DyedOil = _AS_FILLED
) -> Callable[[Array], Array]:
    """Return a function of thickness [um]: light behind the filter over that of a thick fresh film.

    It is a cubic Hermite table with exact slopes, 0.02 um apart in thin film of the invented dyes:
    the error is below 1e-10.
    """
    end = thickest(dyes)
    thickness = -end / _DENSER * np.log1p(np.linspace(0, 1, _TABLE) * np.expm1(-_DENSER))
    thickness[-1] = end
    signal, slope = (
        filtered_light(thickness, band, derivative=order, dyes=dyes, oil=oil)
        for order in (False, True)
    )
    fresh = signal[-1] if oil == _AS_FILLED else filtered_light(thickness[-1:], band, dyes=dyes)[0]
    table = CubicHermiteSpline(thickness, signal / fresh, slope / fresh)
    return lambda film: np.asarray(table(np.minimum(film, end)))


def signals_of(dyes: DyeSpectra | None, oil: DyedOil) -> Signals:
    """`tabulate_signal` behind the filters of cameras 1 and 2."""
    bands = BANDS if dyes is None else dyes.bands
    one, two = (tabulate_signal(band, dyes, oil) for band in bands)
    return one, two
