"""Two-band emission of a dyed film of given thickness, and the ratio of the bands.

Thickness and attenuation may be in any units whose product is dimensionless (m and 1/m, or um and
1/um). Attenuations are napierian; decadic coefficients are multiplied by ln 10. Farzaneh (2002),
section 5.1, with reabsorption in both bands; Hidrovo and Hart (2001).

A wall behind the film that returns a share R of the laser and of the emission adds three paths to
the direct one: the laser returned, the emission returned, and both. With the attenuation a of the
laser and b of the band, x = (a + b) t and y = (a - b) t, the four integrals over depth sum to
``I = C t [(1 + R^2 e^-x) (1 - e^-x)/x + 2 R e^-x sinh(y)/y]``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from erlif.core.arrays import Array
from erlif.models.arguments import Values, formula

# Optical depth below which (1 - exp(-x))/x is a series; the next term, x^3/24, is 4e-17 there.
SERIES_BELOW = 1e-5

# The same for its derivative, whose closed form subtracts two numbers of size 1/x.
SLOPE_SERIES_BELOW = 1e-3

# Optical depth at which exp(x) is still finite.
LARGEST_DEPTH = 700.0


@formula(depth="signed number")
def mean_transmission(depth: Values) -> Values:
    """Mean over a layer of the light transmitted from each depth, (1 - exp(-x))/x.

    Parameters
    ----------
    depth : float or array
        Optical depth x of the layer, attenuation times thickness. [1]

    Returns
    -------
    float or array
        1 at x = 0, falling as 1/x for a thick layer. [1]

    Examples
    --------
    >>> mean_transmission([0.0, np.log(2), 1e3]).round(4)
    array([1.    , 0.7213, 0.001 ])
    """
    return _evaluate(_mean_transmission, depth)


@formula(thickness="signed number")
def band_signal(thickness: Values, *, attenuation: Values, brightness: Values = 1.0) -> Values:
    """Light of a film in one narrow band, reabsorbed on its way out, before a black wall.

    Excitation and emission are attenuated together by `attenuation`, the sum A + B of the
    absorption at the laser and in the band: I = C t (1 - exp(-(A + B) t)) / ((A + B) t).
    Farzaneh (2002), eq. 5.5, for all light of a narrow band, whichever dye emitted it.

    Parameters
    ----------
    thickness, attenuation, brightness : float or array
        Film thickness t [unit of length], A + B of the band [inverse of the unit of thickness], C,
        light per thickness of a very thin film [any light/m].

    Returns
    -------
    float or array
        Light of the film, in the unit of `brightness` times thickness.

    Examples
    --------
    A thick film shows the light of one attenuation length:

    >>> band_signal(1000.0, attenuation=0.25)
    4.0
    """
    t = _float64(thickness)
    return brightness * t * mean_transmission(attenuation * t)


@formula(thickness="signed number")
def log_band_ratio(
    thickness: Values,
    *,
    ratio_at_zero: Values,
    attenuation_camera1: Values,
    attenuation_camera2: Values,
) -> Values:
    """Natural logarithm of the camera 2 / camera 1 ratio of a film.

    r(t) = K (p/q) (1 - exp(-q t)) / (1 - exp(-p t)), the inverse of Farzaneh (2002), eq. 5.7, with
    reabsorption in both bands. The ratio rises from K at t = 0 to K p/q, and the slope of its
    logarithm at t = 0 is (p - q)/2.

    Parameters
    ----------
    thickness, ratio_at_zero : float or array
        Film thickness t [unit of length], K, the ratio of a vanishing film [1].
    attenuation_camera1, attenuation_camera2 : float or array
        p and q, attenuation in the band of camera 1 and of camera 2, not negative; p > q for a
        ratio that rises with thickness. [inverse of the unit of thickness]

    Returns
    -------
    float or array
        ln r. [1]

    Notes
    -----
    Eq. 5.7 of the source is camera 1 / camera 2; its processed images are camera 2 / camera 1, as
    here. Eqs. 5.5 and 5.6 lack the filter bandwidth; it cancels in the ratio except for K.

    Examples
    --------
    The ratio of a thick film is K p/q:

    >>> thick = log_band_ratio(
    ...     1e3, ratio_at_zero=0.65, attenuation_camera1=0.40, attenuation_camera2=0.25
    ... )
    >>> round(float(np.exp(thick)), 6)
    1.04
    """
    t = _float64(thickness)
    return (
        np.log(ratio_at_zero)
        + np.log(_evaluate(_mean_transmission, attenuation_camera2 * t))
        - np.log(_evaluate(_mean_transmission, attenuation_camera1 * t))
    )


@dataclass(frozen=True)
class BandRatio:
    """Ratio of a film, and its derivatives; each is computed on demand.

    Attributes
    ----------
    ratio_at_zero : float
        K. [1]
    thickness : Array
        [unit of length]
    attenuations : tuple[float, float, float]
        p, q and a. [inverse of the unit of thickness]
    layers : tuple[_Layer, _Layer]
        Of camera 1 and camera 2.
    """

    ratio_at_zero: float
    thickness: Array
    attenuations: tuple[float, float, float]
    layers: tuple[_Layer, _Layer]

    @property
    def log_ratio(self) -> Array:
        """ln r. [1]"""
        one, two = self.layers
        return np.asarray(np.log(self.ratio_at_zero) + two.log - one.log)

    @property
    def slope(self) -> Array:
        """Derivative of ln r with respect to thickness. [inverse of the unit of thickness]"""
        t, (p, q, a), (one, two) = self.thickness, self.attenuations, self.layers
        thin = np.abs(min(p, q) * t) < SLOPE_SERIES_BELOW
        slope = (two.by_log - one.by_log) / np.where(thin, 1.0, t)
        if not thin.any():
            return np.asarray(slope)
        # of a thin film, the series of each layer
        series = two.by_x * q + two.by_y * (2 * a - q) - one.by_x * p - one.by_y * (2 * a - p)
        return np.where(thin, series, slope)

    @property
    def by_reflectance(self) -> Array:
        """Derivative of ln r with respect to R. [1]"""
        one, two = self.layers
        return np.asarray(two.by_reflectance - one.by_reflectance)

    @property
    def gradient(self) -> Array:
        """Derivatives of ln r with respect to K, p, q, a and R, in this order, (5, ...)."""
        t, (one, two) = self.thickness, self.layers
        rows = [
            np.full_like(t, 1 / self.ratio_at_zero),
            -t * (one.by_x - one.by_y),
            t * (two.by_x - two.by_y),
            2 * t * (two.by_y - one.by_y),
            self.by_reflectance,
        ]
        return np.stack(rows)


def band_ratio(
    thickness: Values,
    *,
    ratio_at_zero: float,
    attenuation_camera1: float,
    attenuation_camera2: float,
    attenuation_laser: float = 0.0,
    reflectance: float = 0.0,
) -> BandRatio:
    """Camera 2 / camera 1 ratio of a film before a wall that reflects laser and emission.

    ln r = ln K + ln G(q t, (2 a - q) t) - ln G(p t, (2 a - p) t) with
    G(x, y) = (1 + R^2 e^-x) (1 - e^-x)/x + 2 R e^-x sinh(y)/y. Without reflection it is
    `log_band_ratio`, and its slope is q/(exp(q t) - 1) - p/(exp(p t) - 1). With it, the ratio rises
    from K, has a maximum, and falls to K p/q: light of a thick film returns from the wall in the
    band that is absorbed less.

    Parameters
    ----------
    thickness : float or array
        Film thickness t. [unit of length]
    ratio_at_zero : float
        K, the ratio of a vanishing film. [1]
    attenuation_camera1, attenuation_camera2 : float
        p and q, attenuation of the laser and of the band of camera 1 and 2 together. [inverse of
        the unit of thickness]
    attenuation_laser : float
        a, attenuation of the laser alone. [inverse of the unit of thickness]
    reflectance : float
        R, share of the light that the wall returns, the same for laser and emission; a black wall
        by default. [1]

    Returns
    -------
    BandRatio

    Examples
    --------
    >>> film = np.linspace(0.1, 30, 300)
    >>> found = band_ratio(
    ...     film,
    ...     ratio_at_zero=0.65,
    ...     attenuation_camera1=0.40,
    ...     attenuation_camera2=0.25,
    ...     attenuation_laser=0.20,
    ...     reflectance=0.3,
    ... )
    >>> round(film[np.argmax(found.log_ratio)])
    13
    """
    p, q, a = attenuation_camera1, attenuation_camera2, attenuation_laser
    # a fit may try films far below zero, where exp would overflow
    t = np.maximum(np.asarray(thickness, float), -LARGEST_DEPTH / (4 * max(p, q)))
    one, two = (_Layer(band * t, (2 * a - band) * t, reflectance) for band in (p, q))
    return BandRatio(ratio_at_zero, t, (p, q, a), (one, two))


@dataclass(frozen=True)
class BandLight:
    """Light of a film in one band, and its derivatives; each is computed on demand.

    Attributes
    ----------
    thickness : Array
        [unit of length]
    attenuations : tuple[float, float]
        p and a. [inverse of the unit of thickness]
    layer : _Layer
        The film without its thickness.
    black : bool
        Whether the gradient is that with respect to p alone, as before a black wall.
    """

    thickness: Array
    attenuations: tuple[float, float]
    layer: _Layer
    black: bool = False

    @property
    def signal(self) -> Array:
        """Light over that per thickness of a very thin film. [unit of length]"""
        full = (1 + self.layer.reflectance) ** 2
        return np.asarray(self.thickness * np.exp(self.layer.log) / full)

    @property
    def slope(self) -> Array:
        """Derivative of its logarithm with respect to thickness. [inverse of that unit]"""
        (p, a), layer = self.attenuations, self.layer
        return np.asarray(1 / self.thickness + p * layer.by_x + (2 * a - p) * layer.by_y)

    @property
    def gradient(self) -> Array:
        """Derivatives of its logarithm with respect to p, a and R, in this order, (3, ...)."""
        t, layer = self.thickness, self.layer
        if self.black:
            return np.asarray((t * (layer.by_x - layer.by_y))[np.newaxis])
        by_reflectance = layer.by_reflectance - 2 / (1 + layer.reflectance)
        return np.stack([t * (layer.by_x - layer.by_y), 2 * t * layer.by_y, by_reflectance])


def band_light(
    thickness: Values,
    *,
    attenuation: float,
    attenuation_laser: float = 0.0,
    reflectance: float = 0.0,
) -> BandLight:
    """Light of a film in one band before a wall, whose factors `band_ratio` compares.

    Parameters
    ----------
    thickness : float or array
        Film thickness t, above 0. [unit of length]
    attenuation : float
        p, attenuation of the laser and of the band together. [inverse of the unit of thickness]
    attenuation_laser : float
        a, as for `band_ratio`. [inverse of the unit of thickness]
    reflectance : float
        R, as for `band_ratio`; a black wall by default. [1]

    Returns
    -------
    BandLight

    Examples
    --------
    A thick film shows the light of one attenuation length; a mirror behind a thin film changes
    nothing but the brightness, which is left out:

    >>> black = band_light(1000.0, attenuation=0.25)
    >>> round(float(black.signal), 6)
    4.0
    >>> mirrored = band_light(1e-3, attenuation=0.2, attenuation_laser=0.1, reflectance=1.0)
    >>> round(float(mirrored.signal), 6)
    0.001
    """
    t = np.asarray(thickness, float)
    p, a, R = attenuation, attenuation_laser, reflectance
    return BandLight(t, (p, a), _Layer(p * t, (2 * a - p) * t, R))


@dataclass(frozen=True)
class _Layer:
    """Light of a layer over that of the same layer without attenuation or wall, G(x, y) with R.

    A film of thousands of blocks seldom needs all derivatives.
    """

    x: Array
    y: Array
    reflectance: float

    @cached_property
    def log(self) -> Array:
        """ln G."""
        return np.asarray(np.log(self._total))

    @cached_property
    def by_log(self) -> Array:
        """Derivative of ln(t G) by ln t; that of a thick film keeps its digits."""
        R, decay = self.reflectance, self._decay
        if R == 0:
            return np.asarray(decay / self._direct)
        by_log = decay * (1 - R**2 + 2 * R**2 * decay) + 2 * R * (self._even - self.x * self._mixed)
        return np.asarray(by_log / self._total)

    @cached_property
    def by_x(self) -> Array:
        """Derivative of ln G by x."""
        x, R, direct, decay = self.x, self.reflectance, self._direct, self._decay
        # the closed form is 0/0 at zero, so it is evaluated at 1 there and then replaced
        small = np.abs(x) < SLOPE_SERIES_BELOW
        closed = (decay - direct) / np.where(small, 1.0, x)
        slope = np.where(small, direct * (-0.5 + x / 12 - x**3 / 720), closed)
        if R == 0:
            return np.asarray(slope / direct)
        by_x = slope * (1 + R**2 * decay) - R**2 * direct * decay - 2 * R * self._mixed
        return np.asarray(by_x / self._total)

    @cached_property
    def by_y(self) -> Array:
        """By y."""
        y, R = self.y, self.reflectance
        if R == 0:
            return np.zeros_like(y)
        small = np.abs(y) < SLOPE_SERIES_BELOW
        closed = (self._even - self._mixed) / np.where(small, 1.0, y)
        by_y = np.where(small, self._decay * y / 3, closed)
        return np.asarray(2 * R * by_y / self._total)

    @cached_property
    def by_reflectance(self) -> Array:
        """By R."""
        by_reflectance = 2 * self.reflectance * self._direct * self._decay + 2 * self._mixed
        return np.asarray(by_reflectance / self._total)

    @cached_property
    def _direct(self) -> Array:
        return _mean_transmission(self.x)

    @cached_property
    def _decay(self) -> Array:
        return np.asarray(np.exp(-self.x))

    @cached_property
    def _even(self) -> Array:
        """e^-x cosh(y) without a large number; x exceeds y."""
        far = np.abs(self.y)
        return np.asarray(np.exp(far - self.x) * (1 + np.exp(-2 * far)) / 2)

    @cached_property
    def _mixed(self) -> Array:
        """e^-x sinh(y)/y, likewise."""
        far = np.abs(self.y)
        return np.asarray(np.exp(far - self.x) * _mean_transmission(2 * far))

    @cached_property
    def _total(self) -> Array:
        R = self.reflectance
        if R == 0:
            return self._direct
        return np.asarray(self._direct * (1 + R**2 * self._decay) + 2 * R * self._mixed)


def _float64(value: Values) -> Values:
    """In double precision, because the formulas subtract nearly equal numbers."""
    return value.astype(float) if hasattr(value, "dims") else np.asarray(value, float)


def _evaluate(function: Callable[[Array], Array], x: Values) -> Values:
    """A function of optical depths; a fit takes it thousands of times."""
    x = _float64(x)
    return x.copy(data=function(x.data)) if hasattr(x, "dims") else function(x)


def _mean_transmission(x: Array) -> Array:
    # the closed form is 0/0 at zero, so it is evaluated at 1 there and then replaced
    small = np.abs(x) < SERIES_BELOW
    if not small.any():
        return np.asarray(-np.expm1(-x) / x)
    safe = np.where(small, 1.0, x)
    return np.where(small, 1 - x / 2 + x * x / 6, -np.expm1(-safe) / safe)
