"""A fixture's ratio and its CMM profile to a calibration: pose, reabsorption model, and what departs from it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr

from erlif.calibration.curve import DIRECTION, Calibration
from erlif.calibration.departure import (
    STRUCTURE,
    Candidate,
    choose_departure,
    find_correlation,
    fit_departure,
)
from erlif.calibration.pairing import pair_profile_with_image, thin_out
from erlif.calibration.placement import add_uncertainty_of_turn, refine_pose
from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom, Pose
from erlif.calibration.profile import Profile
from erlif.calibration.regression import OUTLIER, Fit, fit_robustly
from erlif.core.arrays import Array, Mask
from erlif.core.errors import CalibrationError
from erlif.core.products import RatioImages, require

_USEFUL = 0.25  # a single pixel must tell thickness to this share of itself, or the calibration does not answer there
_CORRELATED = 3.3  # standard deviations: neighbours err alike by chance once in a thousand


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
) -> Calibration:
    """Fit the reabsorption model to the fixture's ratio and its CMM profile.

    Errors of both are weighed (orthogonal distance regression). Where the residuals insist on it, a spline departs from the model,
    see `erlif.calibration.departure`.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of the fixture, mean of `frames` frames.
    profile : Profile
    pixel_pitch : float
        [mm]
    bands : (float, float)
        Filter bands of camera 1 and 2. [nm]
    origin : (float, float)
        Pixel (x, y) of camera 1 at profile x = 0 (y = 0).
    direction : float
        Turn from image x to profile x. [rad]
    align : bool
        Refine offset, scale and turn of the profile against the image, each as far as the profile's form tells it.
    frames : int
        Frames averaged in `ratios`; a single pixel of one frame decides how thick a film can be told.
    fixture : str
        Name to store.

    Returns
    -------
    Calibration

    Raises
    ------
    CalibrationError
        If too little of the profile lies in the image, its thickness or its place does not change, or the ratio falls with thickness (cameras swapped).
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_fixed", "flags")
    pose, profile = Pose(origin, direction, pixel_pitch), thin_out(profile, pixel_pitch=pixel_pitch)
    points, notes = pair_profile_with_image(ratios, profile, pose)
    if np.ptp(points.thickness) == 0:
        raise CalibrationError(
            f"Expected a fixture of films of many thicknesses; its profile is {points.thickness[0]:g} um thick at all points in the image. "
            "Photograph a wedge or a gap that widens."
        )
    _refuse_swapped_cameras(points)
    freedom, found = Freedom.none(points), None
    if align:
        points, freedom, found = refine_pose(ratios, profile, points, pose)
        notes += found.describe(points)
    fit = fit_robustly(points, freedom)
    if found is not None:
        fit = add_uncertainty_of_turn(fit, points, freedom, found)
    fit, candidate, inflation, said = _settle_departure(points, fit, freedom)
    notes += said
    kept = fit.kept
    if not kept.all():
        notes.append(
            f"{int((~kept).sum())} of {kept.size} points lie far off the curve and were left out"
        )
    noise = (
        fit.reduced_chi_square
        if candidate is None
        else candidate.noise(int(kept.sum()), len(fit.covariance))
    )
    scale = max(1.0, noise) * inflation
    K, p, q = (float(value) for value in fit.parameters)
    calibration = Calibration(
        K,
        p,
        q,
        scale * fit.covariance[:3, :3],
        (0.0, 0.0),
        bands,
        xr.Dataset(),
        noise,
        fixture,
        departure=None
        if candidate is None
        else replace(candidate.departure, covariance=scale * candidate.departure.covariance),
        pose=found,
    )
    true_thickness = (fit if candidate is None else candidate).true_thickness[kept]
    low, high, limited = _answering_range(calibration, true_thickness, points, kept, frames)
    if limited:
        notes.append(
            f"the profile reaches {points.thickness.max():.1f} um, but beyond {high:.1f} um a single pixel of one frame no longer tells "
            f"thickness to {_USEFUL:.0%}, or to what this light allows: the calibration answers up to there"
        )
    notes += _identifiability(calibration)
    moved = freedom.displacement @ (fit if candidate is None else candidate).displacement
    return replace(
        calibration,
        thickness_range=(low, high),
        curve=_describe_curve(calibration, points, kept, moved, fit.thickness_std),
        notes=(*profile.notes, *notes),
    )


def _describe_curve(
    calibration: Calibration, points: Points, kept: Mask, moved: Array, thickness_std: Array
) -> xr.Dataset:
    """What was fitted, as the file keeps it; `moved` [um] is what the pose still adds to the film under each point."""
    ratio = np.exp(points.log_ratio)
    residual = ratio - calibration.predict(points.thickness + moved)
    std = ratio * np.hypot(
        points.log_ratio_std, thickness_std * np.abs(calibration.slope(points.thickness))
    )
    columns = {
        "curve_thickness": (points.thickness, "um", "thickness by the CMM"),
        "curve_ratio": (ratio, "1", "mean ratio camera 2 / camera 1"),
        "curve_ratio_std": (std, "1", "standard deviation of the ratio, the CMM's error included"),
        "curve_residual": (residual, "1", "ratio less fitted ratio"),
        "curve_x": (points.position[:, 0], "mm", "place along the profile"),
    }
    if points.position.shape[1] == 2:
        columns["curve_y"] = (points.position[:, 1], "mm", "place across the profile")
    return xr.Dataset(
        {
            name: ("bin", values[kept], {"units": unit, "long_name": meaning})
            for name, (values, unit, meaning) in columns.items()
        }
    )


def _refuse_swapped_cameras(points: Points) -> None:
    order = np.argsort(points.thickness)
    third = max(len(order) // 3, 2)
    rise = points.log_ratio[order[-third:]].mean() - points.log_ratio[order[:third]].mean()
    if rise < 0:
        raise CalibrationError(
            f"Expected the ratio {DIRECTION} to rise with thickness; it falls by {-rise:.0%} from the thin to the thick end. The "
            "cameras look swapped: exchange [camera1] and [camera2], the reabsorbed (580 nm) band belongs to camera 1."
        )


def _settle_departure(
    points: Points, fit: Fit, freedom: Freedom
) -> tuple[Fit, Candidate | None, float, list[str]]:
    """Choose between model and spline, and say what structure the residuals show.

    Returns the fit, the spline where one is used, the factor by which correlated errors widen the covariance, and notes.
    """
    choice = choose_departure(points, fit, freedom)
    if choice is None:
        return fit, None, 1.0, []
    notes = []
    candidate = choice.candidate
    if candidate is not None:
        fit, candidate = _settle_outliers(points, fit, freedom, candidate)
        pieces = candidate.inner_knots + 1
        notes.append(
            f"the ratio departs from the reabsorption model {_say_largest(fit, candidate)}: a spline of {pieces} piece{'s' * (pieces > 1)} "
            f"follows it, the Bayesian information criterion being lower by {choice.evidence:.0f}"
            + (" (with more pieces the ratio would fall somewhere)" if choice.falling else "")
        )
    elif choice.chance < STRUCTURE:
        why = (
            "but lets the ratio fall and is not used"
            if choice.falling
            else "but not so clearly that it is used"
        )
        notes.append(
            f"the residuals have structure (once in {1 / max(choice.chance, 1e-12):.0g} by chance): a spline would depart from the reabsorption "
            f"model {_say_largest(fit, choice.smooth)}, {why}"
        )
    correlation, significance = find_correlation(
        points.position[fit.kept], _residuals(points, fit, freedom, candidate)[fit.kept]
    )
    if significance < _CORRELATED:
        return fit, candidate, 1.0, notes
    inflation = min((1 + correlation) / max(1 - correlation, 0.1), 10.0)
    notes.append(
        f"neighbouring points along the profile err alike (correlation {correlation:.2f}): form, place or light of the fixture is not "
        f"as stated; the standard deviations were widened by {math.sqrt(inflation):.2f}"
    )
    return fit, candidate, inflation, notes


def _residuals(points: Points, fit: Fit, freedom: Freedom, candidate: Candidate | None) -> Array:
    """What the curve leaves at each point, in units of its standard deviation."""
    displacement = fit.displacement if candidate is None else candidate.displacement
    film = points.thickness + freedom.displacement @ displacement
    residual, slope = points.log_ratio - fit.predict(film), fit.slope(film)
    if candidate is not None:
        residual, slope = (
            residual - candidate.departure.predict(film),
            slope + candidate.departure.slope(film),
        )
    return np.asarray(residual / np.hypot(points.log_ratio_std, fit.thickness_std * slope))


def _settle_outliers(
    points: Points, fit: Fit, freedom: Freedom, candidate: Candidate
) -> tuple[Fit, Candidate]:
    """Leave out what lies far off the spline, and take the CMM's error bars from the scatter about it where there are none."""
    for _ in range(4):
        residual = _residuals(points, fit, freedom, candidate)
        noise = candidate.noise(int(fit.kept.sum()), len(fit.covariance))
        now = np.abs(residual) <= OUTLIER * max(1.0, math.sqrt(noise))
        known = bool(np.isfinite(points.thickness_std).all())
        if np.array_equal(now, fit.kept) and (known or abs(noise - 1) < 0.02):
            break
        thickness_std = fit.thickness_std if known else fit.thickness_std * math.sqrt(noise)
        fit = replace(fit, kept=now, thickness_std=thickness_std)
        candidate = fit_departure(points, fit, freedom, candidate.inner_knots)
    return fit, candidate


def _say_largest(fit: Fit, candidate: Candidate) -> str:
    """How large a departure surely is, and where."""
    true = candidate.true_thickness[fit.kept]
    grid = np.linspace(float(true.min()), float(true.max()), 501)
    departure, basis = candidate.departure.predict(grid), candidate.departure.basis(grid)
    std = np.sqrt(
        np.maximum(np.einsum("it,ij,jt->t", basis, candidate.departure.covariance, basis), 0.0)
    )
    n = int(
        np.argmax(np.abs(departure) - 2 * std)
    )  # where it is largest beyond its error, not where it is noisiest
    film = abs(departure[n] / fit.slope(grid[n]))
    return f"by {100 * departure[n]:+.2f} ± {100 * std[n]:.2f} % at {grid[n]:.1f} um ({film:.2g} um of film)"


def _answering_range(
    calibration: Calibration, covered: Array, points: Points, kept: Mask, frames: int
) -> tuple[float, float, bool]:
    """Thickness the fixture covers, cut where a single pixel of one frame no longer tells it."""
    low, high = max(float(covered.min()), 0.0), float(covered.max())
    order = np.argsort(points.thickness[kept])
    grid = np.linspace(low, high, 2001)[1:]
    noise = np.interp(
        grid,
        points.thickness[kept][order],
        np.sqrt(frames * points.pixel_var + points.fixed_var)[kept][order],
    )
    relative = noise / (calibration.slope(grid) * grid)
    # in dim light no single pixel may tell so much; then the range ends where pixels are a quarter worse than their best
    useful = relative <= max(_USEFUL, 1.25 * float(relative.min()))
    thickest = float(grid[useful][-1])
    # thin films too are told badly in proportion to themselves, but averages over pixels make them good: they stay
    return low, thickest, thickest < grid[-1]


def _identifiability(calibration: Calibration) -> list[str]:
    """Say so where the data fix K and p - q but not p and q."""
    _, p, q = calibration.parameters
    std, covariance = calibration.standard_deviations, calibration.covariance
    difference_std = math.sqrt(covariance[1, 1] + covariance[2, 2] - 2 * covariance[1, 2])
    if std[2] < 0.3 * q:
        return []
    return [
        f"the films are too thin to tell p and q apart (q = {q:.3f} ± {std[2]:.3f} 1/um); only K and "
        f"p - q = {p - q:.4f} ± {difference_std:.4f} 1/um are fixed. Do not read films thicker than the fixture's"
    ]
