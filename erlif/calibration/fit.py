"""Fit of a calibration to the ratio of a fixture and its CMM profile.

The steps are the pose, the reabsorption model, the departure from it, and the calibrated range.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from erlif.calibration.curve import DIRECTION, PARAMETERS, Calibration
from erlif.calibration.departure import (
    STRUCTURE,
    Choice,
    SplineCandidate,
    choose_departure,
    find_correlation,
    fit_departure,
    longest_rise,
)
from erlif.calibration.pairing import pair_profile_with_image, thin_out
from erlif.calibration.placement import add_uncertainty_of_turn, refine_pose
from erlif.calibration.points import Points
from erlif.calibration.pose import ALONG, FoundPose, Freedom, Pose
from erlif.calibration.profile import Profile
from erlif.calibration.regression import OUTLIER, Fit, fit_robustly
from erlif.calibration.soundness import check_fit
from erlif.calibration.systematics import Systematics
from erlif.core.arrays import Array, Mask
from erlif.core.errors import CalibrationError
from erlif.core.notes import Note, remark, warn
from erlif.core.products import RatioImages, require
from erlif.core.units import count_of
from erlif.core.variables import CALIBRATION

# Error of a single pixel at which the calibrated range ends, of the thickness.
USEFUL = 0.25

# The same in dim light, over the error of the best pixel.
DIM_LIGHT = 1.25

# Films among which the highest ratio is sought [um], and their number.
_HIGHEST = (0.1, 200.0, 2000)
_CORRELATED = 3.3  # standard deviations that chance exceeds once in a thousand
_LARGEST_INFLATION = 10.0  # of the covariance by correlated residuals
_OUTLIER_PASSES = 4
_NOISE_SETTLED = 0.02  # deviation of the noise from 1 at which the estimate is accepted
_UNRESOLVED = 0.3  # relative standard deviation of q from which on q alone is unknown


def fit_calibration(
    ratios: RatioImages,
    profile: Profile,
    *,
    pixel_pitch: float,
    bands: tuple[float, float],
    origin: tuple[float, float] = (0.0, 0.0),
    direction: float = 0.0,
    align: bool = False,
    frames: int = 1,
    fixture: str = "",
    position_std: float = 0.0,
    size_std: float = 0.0,
    reflectance: float | None = None,
) -> Calibration:
    """Fit the reabsorption model to the fixture's ratio and its CMM profile.

    Errors of both are weighted (orthogonal distance regression). Where the residuals require it,
    a spline is added to the model, see `erlif.calibration.departure`.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of the fixture, mean of `frames` frames.
    profile : Profile
        Thickness of the fixture by the CMM.
    pixel_pitch : float
        Distance of pixels on the fixture. [mm]
    bands : (float, float)
        Filter bands of camera 1 and 2. [nm]
    origin : (float, float)
        Pixel (x, y) of camera 1 at profile x = 0 (y = 0). [px]
    direction : float
        Turn from image x to profile x, positive towards image y (down). [rad]
    align : bool
        Refine offset, scale and turn of the profile against the image, each as far as the form of
        the profile determines it.
    frames : int
        Frames averaged in `ratios`; the noise of a single pixel in one frame limits the
        calibrated range.
    fixture : str
        Name to store.
    position_std : float
        Standard deviation of the origin along the profile, where `align` does not determine it.
        [mm]
    size_std : float
        Standard deviation of the scale of the profile's thickness. [1]
    reflectance : float, optional
        Share of laser and emission that the wall behind the film returns; default: as the ratio
        shows it. [1]

    Returns
    -------
    Calibration

    Raises
    ------
    CalibrationError
        If too little of the profile lies in the image, if its thickness or its position does not
        change, or if the ratio falls with thickness.

    Examples
    --------
    A wedge of 0.1 to 18 um without noise, 40 rows of 300 columns, returns its parameters:

    >>> from erlif.models.fluorescence import log_band_ratio
    >>> x = 0.06 * np.arange(300)  # mm
    >>> film = 0.1 + x  # um
    >>> values = log_band_ratio(
    ...     film, ratio_at_zero=0.65, attenuation_camera1=0.40, attenuation_camera2=0.25
    ... )
    >>> image = np.tile(values, (40, 1))
    >>> noise = np.full(image.shape, 1e-6)
    >>> columns = {
    ...     "log_ratio": image,
    ...     "log_ratio_var": noise,
    ...     "log_ratio_var_fixed": noise,
    ...     "flags": np.zeros(image.shape, np.uint16),
    ... }
    >>> ratios = RatioImages(
    ...     xr.Dataset({name: (("y", "x"), values) for name, values in columns.items()})
    ... )
    >>> profile = Profile(x[::2], film[::2], np.full(150, 0.01))
    >>> calibration = fit_calibration(ratios, profile, pixel_pitch=0.06, bands=(580.0, 610.0))
    >>> calibration.parameters.round(3)
    array([0.65, 0.4 , 0.25])
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_fixed", "flags")
    pose, profile = Pose(origin, direction, pixel_pitch), thin_out(profile, pixel_pitch=pixel_pitch)
    points, notes = pair_profile_with_image(ratios, profile, pose)
    _refuse_constant_thickness(points)
    _refuse_falling_ratio(points)

    freedom, refined_pose = Freedom.none(points), None
    if align:
        points, freedom, refined_pose = refine_pose(ratios, profile, points, pose)
        notes += refined_pose.describe(points)

    # another origin shifts all films alike, and K, p and q follow a shifted film as well
    steepness = 0.0
    if refined_pose is None or not refined_pose.determined[ALONG]:
        steepness = float(np.median(np.abs(points.gradient[:, 0])))  # um/mm
        text = (
            "the origin along the profile is used as given: each pixel of error shifts all films "
            f"by {steepness * pixel_pitch:.2g} um. [systematics] position in fixture.toml states "
            "its standard deviation; a mark on the fixture lowers it"
        )
        notes.append(remark("", text))

    fit = fit_robustly(points, freedom, reflectance=reflectance)
    if refined_pose is not None:
        fit = add_uncertainty_of_turn(fit, points, freedom, refined_pose)
    settled = _settle_departure(points, fit, freedom)
    fit, candidate, kept = settled.fit, settled.candidate, settled.fit.kept
    notes += settled.notes
    if not kept.all():
        text = f"{int((~kept).sum())} of {kept.size} points lie far off the curve and were left out"
        notes.append(remark("", text))

    calibration = _make_curve(settled, refined_pose, bands=bands, fixture=fixture)
    best = fit if candidate is None else candidate

    # the calibrated range follows from the slope of the finished curve
    films = best.true_thickness[kept]
    thickness_range, limited = _calibrated_range(calibration, films, points, kept, frames)
    if limited:
        thickest, end = points.thickness.max(), thickness_range[1]
        text = (
            f"the profile reaches {thickest:.1f} um, but beyond {end:.1f} um the noise of a single "
            f"pixel of one frame exceeds {USEFUL:.0%} of the thickness, or what this light allows: "
            "the calibrated range ends there"
        )
        notes.append(remark("", text))
    notes += [*_describe_unresolved(calibration), *_describe_wall(calibration)]
    moved = freedom.displacement @ best.displacement
    calibration = replace(calibration, thickness_range=thickness_range)
    check_fit(calibration, points.thickness + moved, points.log_ratio)
    widths = {"position": steepness * position_std, "size": size_std}
    systematics = Systematics.of(
        {term: width for term, width in widths.items() if width > 0},
        parameters=len(calibration.full_covariance),
    )
    return replace(
        calibration,
        systematics=systematics,
        pixel_pitch=pixel_pitch,
        curve=_describe_curve(calibration, points, kept, moved, fit.thickness_std),
        notes=(*profile.notes, *notes),
    )


def _make_curve(
    settled: _Settled, pose: FoundPose | None, *, bands: tuple[float, float], fixture: str
) -> Calibration:
    """The calibration without range and points, with the error bars of the actual scatter."""
    fit, candidate = settled.fit, settled.candidate
    noise, departure = fit.reduced_chi_square, None
    if candidate is not None:
        noise = candidate.noise(int(fit.kept.sum()), len(fit.covariance))
        departure = candidate.departure

    # scatter above the stated noise, and correlated errors, widen all error bars
    scale = max(1.0, noise) * settled.inflation
    if departure is not None:
        departure = replace(departure, covariance=scale * departure.covariance)
    size = fit.parameters.size
    parameters: dict[str, Any] = dict(zip(PARAMETERS, map(float, fit.parameters), strict=False))
    return Calibration(
        **parameters,
        covariance=scale * fit.covariance[:size, :size],
        thickness_range=(0.0, 0.0),
        bands=bands,
        curve=xr.Dataset(),
        reduced_chi_square=noise,
        fixture=fixture,
        departure=departure,
        pose=pose,
    )


def _describe_curve(
    calibration: Calibration, points: Points, kept: Mask, moved: Array, thickness_std: Array
) -> xr.Dataset:
    """The fitted points as the file stores them.

    `moved` [um] is the change of the film under each point that the last fit of the pose adds.
    """
    ratio = np.exp(points.log_ratio)
    residual = ratio - calibration.predict(points.thickness + moved)
    std = ratio * np.hypot(
        points.log_ratio_std, thickness_std * np.abs(calibration.slope(points.thickness))
    )
    columns = {
        "curve_thickness": points.thickness,
        "curve_ratio": ratio,
        "curve_ratio_std": std,
        "curve_residual": residual,
        "curve_x": points.position[:, 0],
    }
    curve = xr.Dataset({name: CALIBRATION[name].fill(columns[name][kept]) for name in columns})
    if points.on_surface:
        across = points.position[kept, 1]
        curve["curve_y"] = CALIBRATION["curve_x"].fill(
            across, long_name="position across the profile"
        )
    return curve


def _refuse_constant_thickness(points: Points) -> None:
    """Refuse a fixture of a single film thickness."""
    if np.ptp(points.thickness) == 0:
        raise CalibrationError(
            "Expected a fixture of films of many thicknesses; its profile is "
            f"{points.thickness[0]:g} um thick at all points in the image. Photograph a wedge or a "
            "gap that widens."
        )


def _refuse_falling_ratio(points: Points) -> None:
    """Refuse a ratio that falls from the thin to the thick third of the points.

    Thick films give more light, and their pixels less noise: where the noise rises with thickness,
    the profile is likely to run the other way.
    """
    order = np.argsort(points.thickness)
    third = max(len(order) // 3, 2)
    thin, thick = order[:third], order[-third:]
    rise = points.log_ratio[thick].mean() - points.log_ratio[thin].mean()
    if rise < 0:
        mirrored = points.pixel_var[thick].mean() > points.pixel_var[thin].mean()
        cure = (
            ", and so does the light. Likely, in this order: (1) the profile runs the other way; "
            "(2) light is missing at the thick end, and the cameras are exchanged. Correct "
            "direction and origin in fixture.toml, or the files of [camera1] and [camera2]."
            if mirrored
            else ". Likely, in this order: (1) the cameras look swapped: exchange the files of "
            "[camera1] and [camera2], the reabsorbed (580 nm) band belongs to camera 1; (2) the "
            "profile runs the other way: look at direction and origin in fixture.toml."
        )
        raise CalibrationError(
            f"Expected the ratio {DIRECTION} to rise with thickness; it falls by {-rise:.0%} from "
            f"the thin to the thick end{cure}"
        )


class _Settled(NamedTuple):
    """Curve chosen for the calibration: the model alone or with a spline."""

    fit: Fit
    candidate: SplineCandidate | None  # the spline; None where the model stands alone
    inflation: float  # factor by which correlated errors widen the covariance
    notes: list[Note]


def _settle_departure(points: Points, fit: Fit, freedom: Freedom) -> _Settled:
    """Choose between model and spline, and report structure in the residuals."""
    choice = choose_departure(points, fit, freedom)
    if choice is None:
        return _Settled(fit, None, 1.0, [])

    notes = []
    candidate = choice.candidate
    if candidate is not None:
        fit, candidate = _settle_outliers(points, fit, freedom, candidate)
        notes.append(_describe_departure(fit, candidate, choice))
    elif choice.chance < STRUCTURE:
        notes.append(_describe_structure(fit, choice))

    # errors that neighbours share do not average out over the points
    residuals = _residuals(points, fit, freedom, candidate)
    correlation = find_correlation(points.position[fit.kept], residuals[fit.kept])
    if correlation.significance < _CORRELATED:
        return _Settled(fit, candidate, 1.0, notes)
    inflation = min(correlation.inflation, _LARGEST_INFLATION)
    widened = math.sqrt(inflation)
    text = (
        "errors of neighbouring points along the profile are correlated (coefficient "
        f"{correlation.coefficient:.2f}); errors were widened by {widened:.2f}. Form, position or "
        "light of the fixture is not as stated"
    )
    notes.append(warn("", text))
    return _Settled(fit, candidate, inflation, notes)


def _describe_departure(fit: Fit, candidate: SplineCandidate, choice: Choice) -> Note:
    """Note on the spline that is used."""
    falling = "; it falls somewhere, where the calibrated range ends" if choice.falling else ""
    return remark(
        "",
        f"the ratio departs from the reabsorption model {_describe_largest(fit, candidate)}: a "
        f"spline of {count_of(candidate.pieces, 'piece')} is added to the model, the Bayesian "
        f"information criterion being lower by {choice.evidence:.0f}{falling}",
    )


def _describe_structure(fit: Fit, choice: Choice) -> Note:
    """Note on a departure that is not used."""
    chance = max(choice.chance, 1e-12)  # below it only the order of magnitude is known
    largest = _describe_largest(fit, choice.tested)
    return warn(
        "",
        f"the residuals have structure (once in {1 / chance:.0g} by chance). A spline would "
        f"depart from the reabsorption model {largest}, but the evidence is too weak to use it",
    )


def _residuals(
    points: Points, fit: Fit, freedom: Freedom, candidate: SplineCandidate | None
) -> Array:
    """Residual of the curve at each point, in units of its standard deviation."""
    displacement = fit.displacement if candidate is None else candidate.displacement
    film = points.thickness + freedom.displacement @ displacement
    residual, slope = points.log_ratio - fit.predict(film), fit.slope(film)
    if candidate is not None:
        residual = residual - candidate.departure.predict(film)
        slope = slope + candidate.departure.slope(film)
    return np.asarray(residual / np.hypot(points.log_ratio_std, fit.thickness_std * slope))


def _settle_outliers(
    points: Points, fit: Fit, freedom: Freedom, candidate: SplineCandidate
) -> tuple[Fit, SplineCandidate]:
    """Fit the spline again without outliers.

    Where the CMM states no uncertainty, it is estimated from the scatter about the spline.
    """
    for _ in range(_OUTLIER_PASSES):
        residual = _residuals(points, fit, freedom, candidate)
        noise = candidate.noise(int(fit.kept.sum()), len(fit.covariance))
        now = np.abs(residual) <= OUTLIER * max(1.0, math.sqrt(noise))
        known = points.has_error_bars
        if np.array_equal(now, fit.kept) and (known or abs(noise - 1) < _NOISE_SETTLED):
            break
        thickness_std = fit.thickness_std if known else fit.thickness_std * math.sqrt(noise)
        fit = replace(fit, kept=now, thickness_std=thickness_std)
        candidate = fit_departure(points, fit, freedom)
    return fit, candidate


def _describe_largest(fit: Fit, candidate: SplineCandidate) -> str:
    """The largest significant departure and its thickness, as text."""
    true = candidate.true_thickness[fit.kept]
    grid = np.linspace(float(true.min()), float(true.max()), 501)
    departure, basis = candidate.departure.predict(grid), candidate.departure.basis(grid)
    std = np.sqrt(
        np.maximum(np.einsum("it,ij,jt->t", basis, candidate.departure.covariance, basis), 0.0)
    )

    # largest beyond its error; the plain maximum would be found where the spline is noisiest
    n = int(np.argmax(np.abs(departure) - 2 * std))
    film = abs(departure[n] / fit.slope(grid[n]))
    return (
        f"by {100 * departure[n]:+.2f} ± {100 * std[n]:.2f} % at {grid[n]:.1f} um "
        f"({film:.2g} um of film)"
    )


def _calibrated_range(
    calibration: Calibration, covered: Array, points: Points, kept: Mask, frames: int
) -> tuple[tuple[float, float], bool]:
    """Thickness covered by the fixture, up to where the noise of a single pixel is too large. [um]

    And whether noise ends it below the thickest film of the fixture.
    """
    low, high = max(float(covered.min()), 0.0), float(covered.max())
    order = np.argsort(points.thickness[kept])
    grid = np.linspace(low, high, 2001)[1:]
    noise = np.interp(
        grid,
        points.thickness[kept][order],
        np.sqrt(frames * points.pixel_var + points.fixed_var)[kept][order],
    )
    relative = noise / (calibration.slope(grid) * grid)

    # In dim light no single pixel may reach the limit; the range then ends where pixels are a
    # quarter worse than the best. Thin films stay although their relative noise is large, because
    # averages over pixels resolve them.
    first, last = longest_rise(relative > 0)
    rising = slice(first, last)
    useful = relative[rising] <= max(USEFUL, DIM_LIGHT * float(relative[rising].min()))
    low, thickest = low if first == 0 else float(grid[first]), float(grid[rising][useful][-1])
    return (low, thickest), bool(thickest < grid[-1])


def _describe_wall(calibration: Calibration) -> list[Note]:
    """Note on a wall that reflects, and on the ratio that no film exceeds."""
    if calibration.reflectance is None:
        return []
    films = np.linspace(*_HIGHEST)
    highest = films[np.argmax(calibration.model.predict(films))]
    std = calibration.standard_deviations[-1]
    text = (
        f"the wall behind the film of the fixture reflects {calibration.reflectance:.0%} ± "
        f"{std:.0%} of laser and emission: the ratio has its maximum at {highest:.1f} um and falls "
        "beyond it. The wall of the joint must reflect as much, or wall in [optics] states what it "
        "reflects"
    )
    return [remark("", text)]


def _describe_unresolved(calibration: Calibration) -> list[Note]:
    """Note where the data determine K and p - q but not p and q."""
    p, q = calibration.attenuation_camera1, calibration.attenuation_camera2
    std, covariance = calibration.standard_deviations, calibration.covariance
    if std[2] < _UNRESOLVED * q or calibration.model.reflects:
        return []
    difference_std = math.sqrt(covariance[1, 1] + covariance[2, 2] - 2 * covariance[1, 2])
    text = (
        f"the films are too thin to separate p and q (q = {q:.3f} ± {std[2]:.3f} 1/um); only K and "
        f"p - q = {p - q:.4f} ± {difference_std:.4f} 1/um are determined. Do not measure films "
        "thicker than the fixture's"
    )
    return [warn("", text)]
