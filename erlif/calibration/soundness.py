"""Checks of the numbers in a calibration file against those that a fit can produce.

A file may have been edited, converted by another program, or damaged. A wrong number in it does
not fail by itself: it gives wrong films, or error bars that are NaN.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from erlif.calibration.curve import PARAMETERS, Calibration, RatioCurve
from erlif.calibration.departure import Departure
from erlif.calibration.profile import THICKEST
from erlif.calibration.regression import BLACK
from erlif.calibration.systematics import Systematics
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.core.format import LaterVersionError, is_later

# Largest size of the arrays of one group; a map of 25 megapixels has 425 MB. [byte]
LARGEST = 2**30

# Wavelengths that cameras and filters cover. [nm]
VISIBLE = (200.0, 2000.0)

# Ratios that two 16-bit cameras can show, with margin. [1]
RATIOS = (1e-6, 1e6)

# Units of the variables that have one, in the spellings that are accepted.
UNITS = {
    **dict.fromkeys(PARAMETERS[1:4], ("um-1", "1/um", "µm-1", "um^-1")),
    **dict.fromkeys(("thickness_range", "curve_thickness"), ("um", "µm")),
}

# Film error of a fit, over the film, above which it is refused where no film of its range is
# better; the fixtures of the virtual rig have below 0.02, in a tenth of the light too. [1]
LARGEST_ERROR = 0.3

# Share of the variance of the ratio that a fit may leave unexplained. [1]
LARGEST_SCATTER = 0.5

# Largest difference of mirrored elements of a covariance, relative to the standard deviations.
_SYMMETRIC = 1e-6

# Places over the calibrated range at which the slope of the ratio is checked.
_GRID = 1001


def check_file(dataset: xr.Dataset) -> None:
    """Refuse a group of a calibration file by its header: size, format version, units.

    Parameters
    ----------
    dataset : xarray.Dataset
        The group, opened and not read.

    Raises
    ------
    ValueError
        With the bare reason.
    """
    if dataset.nbytes > LARGEST:
        raise ValueError(f"its header claims {dataset.nbytes / 1e9:.1f} GB")
    if is_later(dataset.attrs):
        raise LaterVersionError(dataset.attrs)
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "c":
            raise ValueError(f"{name} has complex values")
    for name, accepted in UNITS.items():
        unit = dataset[name].attrs.get("units", accepted[0]) if name in dataset else accepted[0]
        if unit not in accepted:
            raise ValueError(f"{name} is in {str(unit)[:40]}, not in {accepted[0]}")


def check_calibration(calibration: Calibration, curve: RatioCurve | None = None) -> None:
    """Refuse a calibration whose numbers no fit gives.

    Parameters
    ----------
    calibration : Calibration
    curve : RatioCurve, optional
        What a run made of it; default: the calibration itself.

    Raises
    ------
    ValueError
        With the bare reason of the first fault.

    Examples
    --------
    >>> calibration = Calibration(
    ...     0.65, 0.40, 0.25, -np.eye(3), (0.1, 12.0), (580.0, 610.0), xr.Dataset(), 1.0, "wedge"
    ... )
    >>> check_calibration(calibration)
    Traceback (most recent call last):
        ...
    ValueError: covariance has a variance of -1, not a positive number
    """
    curve = calibration if curve is None else curve
    faults = [
        *_parameter_faults(calibration.parameters),
        *_covariance_faults("covariance", calibration.covariance, calibration.parameters.size),
        *_range_faults(calibration.thickness_range, calibration.bands),
        *_curve_faults(calibration.curve),
    ]
    if calibration.departure is not None:
        faults += _departure_faults(calibration.departure)
    if curve.systematics:
        faults += _systematics_faults(curve.systematics, len(calibration.fitted_covariance))
    if faults:
        raise ValueError(faults[0])

    # a curve that falls within its range would have two films for one ratio
    films = np.linspace(*curve.thickness_range, _GRID)
    falling = ~(curve.slope(films) > 0)
    if falling.any():
        raise ValueError(
            f"its ratio does not rise with thickness at {films[np.argmax(falling)]:.3g} um"
        )


def check_fit(calibration: Calibration, thickness: Array, log_ratio: Array) -> None:
    """Refuse a fit from which no film follows.

    Parameters
    ----------
    calibration : Calibration
        The fitted curve.
    thickness : array, (point,)
        Films of all points, those far off the curve included. [um]
    log_ratio : array, (point,)
        Logarithm of their measured ratio. [1]

    Raises
    ------
    CalibrationError
        If the error of the film exceeds `LARGEST_ERROR` in the whole range, or the residuals have
        more than `LARGEST_SCATTER` of the variance of the ratio.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> calibration, films = example_calibration(), np.linspace(1, 9, 9)
    >>> check_fit(calibration, films, calibration.predict_log(films))
    >>> check_fit(calibration, films, calibration.predict_log(films[::-1]))
    Traceback (most recent call last):
        ...
    erlif.core.errors.CalibrationError: Expected the ratio to follow the thickness of the profile...
    """
    cure = (
        f"(reduced chi-square {calibration.reduced_chi_square:.3g}). Compare profile, origin and "
        "direction in fixture.toml with the images, and look at the frames with: erlif check "
        "FIXTURE_DIR"
    )
    residual = log_ratio - calibration.predict_log(np.maximum(thickness, 0.0))
    scatter = float(np.mean(residual**2) / max(float(np.var(log_ratio)), np.finfo(float).tiny))
    if not scatter < LARGEST_SCATTER:
        raise CalibrationError(
            "Expected the ratio to follow the thickness of the profile; the fitted curve leaves "
            f"{min(scatter, 1.0):.0%} of the variance of the ratio unexplained {cure}"
        )
    # the error of no film is not relative
    films = np.linspace(*calibration.thickness_range, _GRID)[1:]
    error = calibration.thickness_std(films) / films
    best = float(error.min()) if np.isfinite(error).all() else np.inf
    if not best < LARGEST_ERROR:
        raise CalibrationError(
            f"Expected a calibration that determines films to better than {LARGEST_ERROR:.0%}; its "
            f"error is at least {best:.3g} times the film in the whole range {cure}"
        )


def _parameter_faults(parameters: Array) -> Iterator[str]:
    for name, value in zip(PARAMETERS, parameters, strict=False):
        if not (np.isfinite(value) and value > 0):
            yield f"{name} is {value:g}, not a positive number"
    K, p, q = parameters[:BLACK]
    if not RATIOS[0] < K < RATIOS[1]:
        yield f"ratio_at_zero is {K:g}, outside {RATIOS[0]:g} to {RATIOS[1]:g}"

    # dye 2 reabsorbs the light of camera 1, so this band is attenuated more
    if p <= q:
        yield (
            f"attenuation_camera1 is {p:g}, below attenuation_camera2, {q:g}: the ratio would fall "
            "with thickness, and the two look exchanged"
        )
    if len(parameters) > BLACK and not (parameters[3] <= q and parameters[4] <= 1):
        a, R = parameters[BLACK:]
        yield f"attenuation_laser is {a:g} and reflectance {R:g}, above attenuation_camera2 or 1"


def _covariance_faults(name: str, covariance: Array, count: int) -> Iterator[str]:
    if covariance.shape != (count, count):
        yield f"{name} has the shape {covariance.shape}, not ({count}, {count})"
        return
    if not np.isfinite(covariance).all():
        yield f"{name} has values that are not finite"
        return
    variance = np.diag(covariance)
    if (variance <= 0).any():
        yield f"{name} has a variance of {variance.min():g}, not a positive number"
        return

    # in units of the standard deviations the elements are correlation coefficients
    std = np.sqrt(variance)
    correlation = covariance / std / std[:, None]
    if np.abs(correlation - correlation.T).max() > _SYMMETRIC:
        yield f"{name} is not symmetric"
    elif np.linalg.eigvalsh(correlation)[0] < -_SYMMETRIC:
        yield f"{name} is not positive definite"


def _range_faults(
    thickness_range: tuple[float, float], bands: tuple[float, float]
) -> Iterator[str]:
    low, high = thickness_range
    if not 0 <= low < high <= THICKEST:
        yield (f"thickness_range is {low:g} to {high:g} um, not rising within 0 to {THICKEST:g} um")
    for band in bands:
        if not VISIBLE[0] < band < VISIBLE[1]:
            yield f"a band is at {band:g} nm, outside {VISIBLE[0]:g} to {VISIBLE[1]:g} nm"


def _curve_faults(curve: xr.Dataset) -> Iterator[str]:
    lengths = {str(name): curve[name].shape for name in curve.variables}
    if len(set(lengths.values())) > 1 or any(len(shape) != 1 for shape in lengths.values()):
        yield f"the variables of the curve have unlike shapes, {lengths}"
        return
    for name in lengths:
        values = np.asarray(curve[name].values, float)
        if not np.isfinite(values).all():
            yield f"{name} has values that are not finite"
        elif name in ("curve_ratio", "curve_ratio_std") and (values <= 0).any():
            yield f"{name} has a value of {values.min():g}, not a positive number"


def _systematics_faults(systematics: Systematics, parameters: int) -> Iterator[str]:
    covariance, size = systematics.covariance, len(systematics.terms)
    if covariance.shape != (size, size) or systematics.cross.shape != (parameters, size):
        yield f"the covariance of its {size} systematics has the shape {covariance.shape}"
    elif not np.isfinite(covariance).all() or (np.diag(covariance) < 0).any():
        yield "the covariance of its systematics has values that no error has"


def _departure_faults(departure: Departure) -> Iterator[str]:
    knots, count = departure.knots, departure.coefficients.size
    if not (knots.ndim == departure.coefficients.ndim == 1 and knots.size == count + 4 > 7):
        yield f"the spline has {knots.size} knots and {count} coefficients, not 4 knots more"
        return
    if not np.isfinite(departure.coefficients).all():
        yield "departure_coefficient has values that are not finite"
    if not (np.isfinite(knots).all() and (np.diff(knots) >= 0).all() and knots[0] < knots[-1]):
        yield "departure_knots are not in rising order"
    yield from _covariance_faults("departure_covariance", departure.covariance, count)
