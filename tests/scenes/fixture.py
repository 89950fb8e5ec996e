"""Fixtures made by quadrature and numpy noise alone, for the tests of the calibration."""

import functools
from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from erlif.calibration import Profile, RunCurve, Systematics, fit_calibration
from erlif.calibration.points import Points
from erlif.core.products import RatioImages
from erlif.rig import dyes

K, P, Q = 0.65, 0.40, 0.25
"""Parameters of the true ratio: K [1], p and q [1/um]."""
PITCH = 0.06
"""Pixel pitch. [mm]"""
SHAPE = (64, 320)
"""Rows and columns of the image. [px]"""
FILMS = np.array([1.0, 3.0, 8.0])
"""Films at which coverage is tested. [um]"""
WEDGE = 0.1 + 17.9 * np.arange(SHAPE[1]) / (SHAPE[1] - 1)
"""Film of a straight wedge, column by column. [um]"""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def light(thickness, attenuation):
    """Light of a film by quadrature over depth, not by the closed form that is fitted."""
    t = np.asarray(thickness, float)[..., None]
    return (t[..., 0] / 2) * (np.exp(-attenuation * t * (_NODES + 1) / 2) @ _WEIGHTS)


def log_ratio(thickness, *, k=K, p=P, q=Q, background=0.0):
    """Logarithm of camera 2 over camera 1; `background` is light in camera 2 from no dye."""
    return np.log(
        (k * light(thickness, q) + background * np.asarray(thickness)) / light(thickness, p)
    )


@functools.cache
def through_filters(reflectance):
    """Logarithm of the ratio of the rig's invented dyes before a wall, over the film. [um]

    Every wavelength of both filters is integrated by itself, so the model with one attenuation for
    each band is not what is fitted.
    """
    film, oil = np.linspace(0.05, 19, 2000), dyes.DyedOil(reflectance=reflectance)
    one, two = (dyes.filtered_light(film, band, oil=oil) for band in dyes.BANDS)
    return CubicSpline(film, np.log(two / one))


def image(rng, values, *, noise=0.004, shape=SHAPE):
    """Ratio image about `values`, the logarithm of the ratio at each pixel or column."""
    dims = ("y", "x")
    still = np.zeros(shape, np.float32)
    return RatioImages(
        xr.Dataset(
            {
                "log_ratio": (dims, (values + rng.normal(0, noise, shape)).astype(np.float32)),
                "log_ratio_var": (dims, np.full(shape, noise**2, np.float32)),
                "log_ratio_var_fixed": (dims, still),
                "log_ratio_var_shared": (dims, still),
                "flags": (dims, np.zeros(shape, np.uint16)),
            }
        )
    )


def make_points(film, **changes):
    """CMM points of a film on the true curve, the film being their position too."""
    count = film.size
    column, axis = np.zeros(count), np.zeros((count, 1))
    points = Points(
        thickness=film,
        thickness_std=np.full(count, 0.1),
        log_ratio=log_ratio(film),
        log_ratio_std=np.full(count, 1e-4),
        pixel_var=column,
        fixed_var=column,
        position=film[:, None],
        gradient=np.ones((count, 1)),
        ratio_gradient=axis,
        mean_across=column,
        across_slope=column,
        across_slope_std=column,
    )
    return replace(points, **changes)


def measure_points(rng, film, *, true=log_ratio, film_std, ratio_std):
    """CMM points of the curve `true`, with errors in film [um] and logarithm of the ratio [1]."""
    return make_points(
        film,
        thickness=film + rng.normal(0, film_std, film.size),
        thickness_std=np.full(film.size, film_std),
        log_ratio=true(film) + rng.normal(0, ratio_std, film.size),
        log_ratio_std=np.full(film.size, ratio_std),
    )


def wedge_profile(rng, *, noise=0.15):
    """Profile of the straight wedge every 0.1 mm, with the noise of a CMM [um]."""
    x = np.arange(0, SHAPE[1] * PITCH, 0.1)
    return Profile(
        x,
        np.interp(x, PITCH * np.arange(SHAPE[1]), WEDGE) + rng.normal(0, noise, x.size),
        np.full(x.size, noise),
    )


def calibrate(ratios, profile, **options):
    """Fit a calibration to 12 frames of the usual bands."""
    return fit_calibration(
        ratios, profile, **{"pixel_pitch": PITCH, "bands": (580.0, 610.0), "frames": 12, **options}
    )


def calibrate_wedge(rng, *, profile=None, noise=0.15, true=log_ratio, **ratio):
    """A straight wedge whose ratio is `true`, photographed and calibrated."""
    profile = wedge_profile(rng, noise=noise) if profile is None else profile
    return calibrate(image(rng, true(WEDGE, **ratio)), profile, fixture="wedge")


def find_films(curve, log_ratio):
    """Films of logarithms of the ratio by root finding; NaN beyond the range. [um]"""
    low, high = curve.thickness_range
    first, last = curve.predict_log([low, high])

    def find(goal):
        if not first <= goal <= last:
            return np.nan
        return brentq(lambda film: float(curve.predict_log(film)) - goal, low, high, xtol=1e-10)

    values = np.asarray(log_ratio, float)
    return np.array([find(goal) for goal in values.ravel()]).reshape(values.shape)


def find_pulls(calibration, films, true=log_ratio, **ratio):
    """Error of films measured with a calibration, over their standard deviation. [1]"""
    error = find_films(calibration, true(films, **ratio)) - films
    return error / calibration.thickness_std(films)


def pulls_of_curve(calibration, films):
    """Errors of K, p, q and films [um] over their standard deviations. [1]"""
    parameters = (calibration.parameters - [K, P, Q]) / calibration.standard_deviations
    return [*parameters, *find_pulls(calibration, films)]


def with_systematics(calibration, *, light=(1.0, 1.0), **widths):
    """The curve of a run with errors of these standard deviations. [1; um for a position]"""
    size = len(calibration.fitted_covariance)
    systematics = Systematics.of(widths, parameters=size, light=light)
    return RunCurve.of(replace(calibration, systematics=systematics))


def walled(calibration):
    """A calibration with a wall that reflects 30 ± 1 %, and a range in which its ratio rises."""
    return replace(
        calibration,
        attenuation_laser=0.2,
        reflectance=0.3,
        covariance=np.diag([1e-6, 4e-6, 4e-6, 1e-5, 1e-4]),
        thickness_range=(0.5, 10.0),
    )


def has_note(product, text):
    """Whether a calibration or a profile carries a note with this text."""
    return any(text in note.text for note in product.notes)


def share_within(pulls, width):
    """Share of the pulls within so many standard deviations, column by column."""
    return (np.abs(np.array(pulls)) < width).mean(axis=0)


def assert_covers(pulls, *, count=None):
    """68 and 95 % lie within one and two standard deviations, to three of the binomial.

    `count` is the number of independent pulls, where those of one fixture share its error.
    """
    count = len(pulls) if count is None else count
    for width, share in ((1, 0.683), (2, 0.954)):
        assert np.all(
            np.abs(share_within(pulls, width) - share) < 3 * np.sqrt(share * (1 - share) / count)
        )


def autoregression(rng, r, count):
    """First-order autoregression with variance 1 and correlation `r` of neighbours."""
    values = [rng.normal()]
    for _ in range(count - 1):
        values.append(r * values[-1] + np.sqrt(1 - r**2) * rng.normal())
    return np.array(values)
