"""Log ratio of known gaps: a parabola along x with a tilt across, on 160 x 200 pixels."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.products import RatioImages
from erlif.trend import PinView, Region
from scenes.fixture import K, P, Q, image

RANGE = (0.2, 16.0)  # um
RADIUS = 4.872  # m, R1 R2/(R1 - R2) of 33.59 and 33.36 mm (Farzaneh 2002)
TILT = 0.2  # um over the height of the image
BORE, PIN = 33.59, 33.36  # mm
LOAD_LINE, AXIAL_ORIGIN = 6.2, 4.77  # mm
CENTRE = 7.0  # mm, where the gap is thinnest along x
X, Y = 0.06 * np.arange(200), 0.06 * np.arange(160)
S, Z = np.linspace(-1, 1, X.size)[None, :], np.linspace(-1, 1, Y.size)[:, None]
WHOLE = Region(slice(0, Y.size), slice(0, X.size))
TURNED = Region(slice(0, X.size), slice(0, Y.size))  # of images with x and y exchanged
VIEW = PinView(PIN * 1e-3, BORE * 1e-3, X[1], LOAD_LINE, AXIAL_ORIGIN)


def known_calibration(
    k: float = K,
    p: float = P,
    q: float = Q,
    *,
    valid: tuple[float, float] = RANGE,
    thickest: float | None = None,
    covariance: np.ndarray | None = None,
) -> Calibration:
    """Calibration of the model that the ratios follow, with correlated errors of 0.2 % by default.

    The films of the fixture end at the thickest one. [um]
    """
    root = 1e-3 * np.array([[1.4, 0.0, 0.0], [-1.9, 0.8, 0.0], [-0.6, 0.6, 0.3]])
    covariance = root @ root.T if covariance is None else covariance
    films = {} if thickest is None else {"curve_thickness": ("bin", np.array([valid[0], thickest]))}
    curve, bands = xr.Dataset(films), (580.0, 610.0)
    return Calibration(k, p, q, covariance, valid, bands, curve, 1.0, "given")


def true_log_ratio(film: np.ndarray) -> np.ndarray:
    """Logarithm of the ratio camera 2 / camera 1 of a film in um, written out."""
    return np.log(K * P / Q * (1 - np.exp(-Q * film)) / (1 - np.exp(-P * film)))


def known_gap(minimum: float, *, centre: float = CENTRE, tilt: float = TILT) -> np.ndarray:
    """Gap of rigid cylinders with a tilt; its minimum lies at (centre, 0). (y, x) [um]"""
    parabola = (X - centre) ** 2 / (2 * RADIUS)  # mm2/m = um
    return minimum + parabola[None, :] + tilt * (Y / Y[-1])[:, None]


def ball(minimum: float, *, bend: tuple[float, float] = (3.0, 2.0)) -> np.ndarray:
    """Gap of a ball that touches off the middle; its curvatures along and across. [um]"""
    return minimum + bend[0] * (S - 0.1) ** 2 + bend[1] * (Z + 0.2) ** 2


def circle_gap(
    load: float, side: float, tilt_load: float = 0.0, tilt_side: float = 0.0, *, pin: float = PIN
) -> np.ndarray:
    """Distance of a displaced and tilted circular pin from the bore, along its radii. (y, x) [um]

    The axis of the pin is off that of the bore by (load, side) um at the axial origin, and by the
    tilts, in um/mm, times the distance from it elsewhere. Image x is the arc on the bore.
    """
    angle = (X - LOAD_LINE)[None, :] / BORE
    z = (Y - AXIAL_ORIGIN)[:, None]
    down, aside = 1e-3 * (load + tilt_load * z), 1e-3 * (side + tilt_side * z)
    along = down * np.cos(angle) + aside * np.sin(angle)
    beside = down * np.sin(angle) - aside * np.cos(angle)
    return 1e3 * (BORE - along - np.sqrt(pin**2 - beside**2))


def exact_ratios(film: np.ndarray) -> RatioImages:
    """Ratio images without noise; the variance is that of very bright light."""
    ratios = noisy_ratios(film, 1e-4, np.random.default_rng(0))
    ratios.log_ratio.values[:] = true_log_ratio(film)
    return ratios


def exchange_axes(ratios: RatioImages) -> RatioImages:
    """The same images with x and y exchanged."""
    return RatioImages(ratios.rename(x="y", y="x").transpose("y", "x"))


def noisy_ratios(film: np.ndarray, noise: float, rng: np.random.Generator) -> RatioImages:
    """Ratio images of a film with normal noise of the log ratio, and its variance."""
    return image(rng, true_log_ratio(film), noise=noise, shape=film.shape)
