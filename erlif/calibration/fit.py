"""The reabsorption model laid through thickness and ratio, with errors in both."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr
from odrpack import odr_fit

from erlif.calibration.curve import DIRECTION, Calibration
from erlif.calibration.pairing import Points, pair_profile_with_image
from erlif.calibration.profile import LEAST_POINTS, Profile
from erlif.core.errors import CalibrationError
from erlif.core.products import RatioImages, require
from erlif.models.fluorescence import log_band_ratio, log_band_ratio_slope

Array = npt.NDArray[np.float64]

_USEFUL = 0.25  # a single pixel must tell thickness to this share of itself, or the calibration does not answer there
_OUTLIER = 4.5  # points this many standard deviations off the curve are dust, bubbles or a slip of the CMM


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
        Refine the origin along the profile against the image.
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
        If too little of the profile lies in the image, or the ratio falls with thickness (cameras swapped).
    """
    require(ratios, "log_ratio", "log_ratio_var", "log_ratio_var_fixed", "flags")
    points, notes = pair_profile_with_image(
        ratios, profile, pixel_pitch=pixel_pitch, origin=origin, direction=direction
    )
    _refuse_swapped_cameras(points)
    if align:
        points, align, note = _find_origin(
            ratios, profile, points, pixel_pitch=pixel_pitch, origin=origin, direction=direction
        )
        notes.append(note)
    fit, kept = _fit_robustly(points, align=align)
    if not kept.all():
        notes.append(f"{int((~kept).sum())} of {kept.size} points lie far off the curve and were left out")
    low, high, limited = _answering_range(fit, points, kept, frames)
    if limited:
        notes.append(
            f"the profile reaches {points.thickness.max():.1f} um, but beyond {high:.1f} um a single pixel of one frame no longer tells "
            f"thickness to {_USEFUL:.0%}, or to what this light allows: the calibration answers up to there"
        )
    notes += _identifiability(fit)
    residual = np.exp(points.log_ratio) - np.exp(fit.predict(points.thickness, points.steepness))
    ratio = np.exp(points.log_ratio)
    curve = xr.Dataset(
        {
            "curve_thickness": ("bin", points.thickness[kept], {"units": "um", "long_name": "thickness by the CMM"}),
            "curve_ratio": ("bin", ratio[kept], {"units": "1", "long_name": "mean ratio camera 2 / camera 1"}),
            "curve_ratio_std": (
                "bin",
                (ratio * np.hypot(points.log_ratio_std, points.thickness_std * np.abs(fit.slope(points.thickness))))[
                    kept
                ],
                {"units": "1", "long_name": "standard deviation of the ratio, the CMM's error included"},
            ),
            "curve_residual": ("bin", residual[kept], {"units": "1", "long_name": "ratio less fitted ratio"}),
        }
    )
    K, p, q = (float(value) for value in fit.parameters)
    return Calibration(
        K, p, q, fit.covariance, (low, high), bands, curve, fit.reduced_chi_square, fixture, (*profile.notes, *notes)
    )


@dataclass(frozen=True)
class _Fit:
    parameters: Array  # K, p, q
    covariance: Array
    reduced_chi_square: float
    true_thickness: Array
    shift: float = 0.0
    shift_std: float = 0.0

    def predict(self, thickness: Array, steepness: Array) -> Array:
        K, p, q = self.parameters
        shifted = thickness + self.shift * steepness
        return np.asarray(log_band_ratio(shifted, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q))

    def slope(self, thickness: Array) -> Array:
        _, p, q = self.parameters
        return np.asarray(log_band_ratio_slope(thickness, attenuation_camera1=p, attenuation_camera2=q))


def _find_origin(
    ratios: RatioImages,
    profile: Profile,
    points: Points,
    *,
    pixel_pitch: float,
    origin: tuple[float, float],
    direction: float,
) -> tuple[Points, bool, str]:
    """Move the origin along the profile until the ratio fits best, where the profile has the form to tell.

    Returns the points at the origin found, whether it was found, and what to say of it.
    """
    given, moved = points, 0.0
    for _ in range(10):
        fit, _ = _fit_robustly(points, align=True)
        if fit.shift_std > pixel_pitch and abs(fit.shift) < 3 * fit.shift_std:
            return (
                given,
                False,
                (
                    f"the origin was left as given: the profile has too little form to find it (± {fit.shift_std * 1e3:.0f} um along "
                    "the profile; a straight wedge looks the same wherever it begins)"
                ),
            )
        moved += fit.shift  # the film under a pixel is met further along the profile: the origin lies further back
        back = -moved / pixel_pitch
        place = (origin[0] + back * math.cos(direction), origin[1] + back * math.sin(direction))
        points, _ = pair_profile_with_image(ratios, profile, pixel_pitch=pixel_pitch, origin=place, direction=direction)
        if abs(fit.shift) < 0.1 * fit.shift_std:
            break
    return points, True, f"the origin was moved by {-moved * 1e3:+.1f} ± {fit.shift_std * 1e3:.1f} um along the profile"


def _refuse_swapped_cameras(points: Points) -> None:
    order = np.argsort(points.thickness)
    third = max(len(order) // 3, 2)
    rise = points.log_ratio[order[-third:]].mean() - points.log_ratio[order[:third]].mean()
    if rise < 0:
        raise CalibrationError(
            f"Expected the ratio {DIRECTION} to rise with thickness; it falls by {-rise:.0%} from the thin to the thick end. The "
            "cameras look swapped: exchange [camera1] and [camera2], the reabsorbed (580 nm) band belongs to camera 1."
        )


def _fit_robustly(points: Points, *, align: bool) -> tuple[_Fit, npt.NDArray[np.bool_]]:
    """Orthogonal distance regression, repeated without outliers; a CMM without error bars gets them from the scatter."""
    kept = np.ones(points.thickness.size, bool)
    unknown = not np.isfinite(points.thickness_std).all()
    thickness_std = np.full(kept.size, 0.1) if unknown else points.thickness_std
    for _ in range(6):
        fit = _fit_once(points, thickness_std, kept, align=align)
        residual = points.log_ratio - fit.predict(points.thickness, points.steepness)
        total = np.hypot(points.log_ratio_std, thickness_std * np.abs(fit.slope(points.thickness)))
        if unknown:
            scatter = residual[kept] / np.abs(fit.slope(points.thickness[kept]))
            thickness_std = np.full(kept.size, max(1.4826 * float(np.median(np.abs(scatter))), 1e-3))
        width = _OUTLIER * max(1.0, math.sqrt(fit.reduced_chi_square))
        now = np.abs(residual) <= width * total
        if now.sum() < LEAST_POINTS or (np.array_equal(now, kept) and not unknown):
            break
        kept = now
    return fit, kept


def _fit_once(points: Points, thickness_std: Array, kept: npt.NDArray[np.bool_], *, align: bool) -> _Fit:
    t, y = points.thickness[kept], points.log_ratio[kept]
    steepness = points.steepness[kept]

    def model(x: Array, beta: Array) -> Array:
        q = math.exp(beta[2])
        p = q + math.exp(beta[1])
        film = x + beta[3] * steepness if align else x
        return np.asarray(
            log_band_ratio(film, ratio_at_zero=math.exp(beta[0]), attenuation_camera1=p, attenuation_camera2=q)
        )

    solution = None
    for start in _starts(t, y):
        beta = np.array([*start, 0.0] if align else start)
        low = np.array([-10.0, math.log(1e-4), math.log(1e-4), -5.0])[: beta.size]
        high = np.array([10.0, math.log(10.0), math.log(10.0), 5.0])[: beta.size]
        trial = odr_fit(
            model,
            t,
            y,
            np.clip(beta, low, high),
            weight_x=thickness_std[kept] ** -2.0,
            weight_y=points.log_ratio_std[kept] ** -2.0,
            bounds=(low, high),
            maxit=200,
        )
        if solution is None or trial.sum_square < solution.sum_square:
            solution = trial
    assert solution is not None
    beta = solution.beta
    K, q = math.exp(beta[0]), math.exp(beta[2])
    difference = math.exp(beta[1])
    chi_square = float(solution.sum_square) / max(t.size - beta.size, 1)
    covariance = np.asarray(solution.cov_beta) * max(1.0, chi_square)
    jacobian = np.zeros((3, beta.size))
    jacobian[0, 0] = K
    jacobian[1, 1:3] = difference, q
    jacobian[2, 2] = q
    return _Fit(
        np.array([K, q + difference, q]),
        jacobian @ covariance @ jacobian.T,
        chi_square,
        np.asarray(solution.xplusd),
        shift=float(beta[3]) if align else 0.0,
        shift_std=math.sqrt(covariance[3, 3]) if align else 0.0,
    )


def _starts(thickness: Array, log_ratio: Array) -> list[list[float]]:
    """Starting points (ln K, ln(p - q), ln q) from the rise of the ratio, for several scales of attenuation."""
    line = np.polyfit(thickness, log_ratio, 1)
    span = float(np.ptp(thickness))
    starts = []
    for optical_depth in (0.3, 2.0, 6.0):
        q = optical_depth / span
        rise = max(2 * line[0], 0.05 / span) * (1 + optical_depth / 2)
        starts.append([float(log_ratio[np.argmin(thickness)]), math.log(rise), math.log(q)])
    return starts


def _answering_range(fit: _Fit, points: Points, kept: npt.NDArray[np.bool_], frames: int) -> tuple[float, float, bool]:
    """Thickness the fixture covers, cut where a single pixel of one frame no longer tells it."""
    covered = fit.true_thickness
    low, high = max(float(covered.min()), 0.0), float(covered.max())
    order = np.argsort(points.thickness[kept])
    grid = np.linspace(low, high, 2001)[1:]
    noise = np.interp(
        grid, points.thickness[kept][order], np.sqrt(frames * points.pixel_var + points.fixed_var)[kept][order]
    )
    relative = noise / (fit.slope(grid) * grid)
    # in dim light no single pixel may tell so much; then the range ends where pixels are a quarter worse than their best
    useful = relative <= max(_USEFUL, 1.25 * float(relative.min()))
    thickest = float(grid[useful][-1])
    # thin films too are told badly in proportion to themselves, but averages over pixels make them good: they stay
    return low, thickest, thickest < grid[-1]


def _identifiability(fit: _Fit) -> list[str]:
    """Say so where the data fix K and p - q but not p and q."""
    _, p, q = fit.parameters
    std = np.sqrt(np.diag(fit.covariance))
    difference_std = math.sqrt(fit.covariance[1, 1] + fit.covariance[2, 2] - 2 * fit.covariance[1, 2])
    if std[2] < 0.3 * q:
        return []
    return [
        f"the films are too thin to tell p and q apart (q = {q:.3f} ± {std[2]:.3f} 1/um); only K and "
        f"p - q = {p - q:.4f} ± {difference_std:.4f} 1/um are fixed. Do not read films thicker than the fixture's"
    ]
