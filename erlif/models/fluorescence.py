"""Two-band emission of a dyed film of given thickness, and the ratio of the bands.

Thickness and attenuation may be in any unit whose product is dimensionless (m and 1/m, or um and 1/um).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array


def mean_transmission(depth: npt.ArrayLike) -> Any:
    """Mean over a layer of the light that its depth lets through, (1 - exp(-x))/x.

    Parameters
    ----------
    depth : array
        Optical depth x of the layer, attenuation times thickness. [1]

    Returns
    -------
    array
        1 at x = 0, falling as 1/x for a thick layer. [1]
    """
    x = np.asarray(depth, float)
    small = np.abs(x) < 1e-5
    safe = np.where(small, 1.0, x)
    return np.where(small, 1 - x / 2 + x * x / 6, -np.expm1(-safe) / safe)


def mean_transmission_log_slope(depth: npt.ArrayLike) -> Any:
    """Derivative of the logarithm of `mean_transmission` by the optical depth, 1/(exp(x) - 1) - 1/x. [1]"""
    x = np.asarray(depth, float)
    small = np.abs(x) < 1e-3
    safe = np.where(small, 1.0, np.minimum(x, 700.0))
    return np.where(small, -0.5 + x / 12 - x**3 / 720, 1 / np.expm1(safe) - 1 / safe)


def band_signal(thickness: npt.ArrayLike, *, attenuation: float, brightness: float = 1.0) -> Any:
    """Light of a film in one narrow band, reabsorbed on its way out.

    Excitation and emission are attenuated together by `attenuation`, the sum A + B of the absorption at the laser and in
    the band: I = C t (1 - exp(-(A + B) t)) / ((A + B) t). Eq. 5.5 of the pin-joint thesis, for all light of a narrow band
    whichever dye emitted it.

    Parameters
    ----------
    thickness : array
        Film thickness t.
    attenuation : float
        A + B of the band, inverse of the unit of thickness (napierian; decadic coefficients times ln 10).
    brightness : float
        C, light of a very thin film per thickness.
    """
    t = np.asarray(thickness, float)
    return brightness * t * mean_transmission(attenuation * t)


def log_band_ratio(
    thickness: npt.ArrayLike,
    *,
    ratio_at_zero: float,
    attenuation_camera1: float,
    attenuation_camera2: float,
) -> Any:
    """Natural logarithm of the camera 2 / camera 1 ratio of a film.

    r(t) = K (p/q) (1 - exp(-q t)) / (1 - exp(-p t)), the inverse of eq. 5.7 of the pin-joint thesis with reabsorption in both
    bands. It rises from K at t = 0 to K p/q, with slope (p - q)/2 of its logarithm at t = 0.

    Parameters
    ----------
    thickness : array
        Film thickness t.
    ratio_at_zero : float
        K, the ratio of a vanishing film. [1]
    attenuation_camera1, attenuation_camera2 : float
        p and q, attenuation in the band of camera 1 and of camera 2; p > q > 0 for a ratio that rises with thickness.

    Notes
    -----
    The thesis's eq. 5.7 is camera 1 / camera 2; its processed images are camera 2 / camera 1, as here. Eqs 5.5 and 5.6
    lack the filter bandwidth; it cancels in the ratio up to K.
    """
    t = np.asarray(thickness, float)
    return (
        np.log(ratio_at_zero)
        + np.log(mean_transmission(attenuation_camera2 * t))
        - np.log(mean_transmission(attenuation_camera1 * t))
    )


def log_band_ratio_slope(
    thickness: npt.ArrayLike, *, attenuation_camera1: float, attenuation_camera2: float
) -> Any:
    """Derivative of `log_band_ratio` by thickness, q/(exp(q t) - 1) - p/(exp(p t) - 1), at fixed K; inverse of its unit."""
    t = np.asarray(thickness, float)
    p, q = attenuation_camera1, attenuation_camera2
    return q * mean_transmission_log_slope(q * t) - p * mean_transmission_log_slope(p * t)


def log_band_ratio_gradient(
    thickness: npt.ArrayLike,
    *,
    ratio_at_zero: float,
    attenuation_camera1: float,
    attenuation_camera2: float,
) -> Array:
    """Derivatives of `log_band_ratio` by its parameters.

    Returns
    -------
    array, (3, ...)
        By K, p and q, in this order.
    """
    t = np.asarray(thickness, float)
    p, q = attenuation_camera1, attenuation_camera2
    return np.stack(
        [
            np.full_like(t, 1 / ratio_at_zero),
            -t * mean_transmission_log_slope(p * t),
            t * mean_transmission_log_slope(q * t),
        ]
    )
