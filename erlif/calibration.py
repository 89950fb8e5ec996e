"""The ratio of a film of known thickness: fit, file and inverse.

A fixture whose gap a coordinate measuring machine (CMM) has measured gives thickness and ratio side by side. The
reabsorption model of `erlif.models.fluorescence` is laid through them with errors in both, because the CMM's is usually the
larger one: orthogonal distance regression, each CMM point counted once.
"""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from odrpack import odr_fit
from scipy.interpolate import UnivariateSpline
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from erlif.core.errors import CalibrationError
from erlif.core.products import RatioImages, require
from erlif.models.fluorescence import log_band_ratio, log_band_ratio_gradient, log_band_ratio_slope
from erlif.registration import CameraMap

Array = npt.NDArray[np.float64]

DIRECTION = "camera2/camera1"
"""The ratio that rises with thickness; the other way round is refused."""

_USEFUL = 0.25  # a single pixel must tell thickness to this share of itself, or the calibration does not answer there
_LEAST_POINTS = 8
_LEAST_PIXELS = 20  # in the cell of one CMM point
_OUTLIER = 4.5  # points this many standard deviations off the curve are dust, bubbles or a slip of the CMM


@dataclass(frozen=True)
class Profile:
    """Thickness of a fixture as the coordinate measuring machine saw it.

    Attributes
    ----------
    position : array, (point,) or (point, 2)
        Place along the profile, or on the surface. [mm]
    thickness : array, (point,)
        [um]
    uncertainty : array, (point,) or None
        Standard deviation of each thickness; None where the file gives none. [um]
    notes : tuple of str
        What had to be mended.
    """

    position: Array
    thickness: Array
    uncertainty: Array | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Calibration:
    """The reabsorption model fitted to a fixture: ratio against thickness and back.

    Attributes
    ----------
    ratio_at_zero, attenuation_camera1, attenuation_camera2 : float
        K [1], p and q [1/um] of `erlif.models.fluorescence.log_band_ratio`.
    covariance : array, (3, 3)
        Of K, p and q, in this order.
    thickness_range : (float, float)
        Where the calibration answers. [um]
    bands : (float, float)
        Filter bands of camera 1 and 2. [nm]
    curve : xarray.Dataset
        curve_thickness, curve_ratio, curve_ratio_std, curve_residual (bin): what was fitted.
    reduced_chi_square : float
    fixture : str
    notes : tuple of str
        What the fit has to say of itself.
    input_hashes : dict of str to str
    date : str
        When the fixture was photographed.
    camera_map : CameraMap or None
        Map from camera 1 to camera 2 on the fixture, for runs of the same rig.
    """

    ratio_at_zero: float
    attenuation_camera1: float
    attenuation_camera2: float
    covariance: Array
    thickness_range: tuple[float, float]
    bands: tuple[float, float]
    curve: xr.Dataset = field(repr=False)
    reduced_chi_square: float
    fixture: str
    notes: tuple[str, ...] = ()
    input_hashes: dict[str, str] = field(default_factory=dict, repr=False)
    date: str = ""
    camera_map: CameraMap | None = field(default=None, repr=False)

    @property
    def parameters(self) -> Array:
        """K [1], p and q [1/um]."""
        return np.array([self.ratio_at_zero, self.attenuation_camera1, self.attenuation_camera2])

    @property
    def standard_deviations(self) -> Array:
        """Of K, p and q."""
        return np.sqrt(np.diag(self.covariance))

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Ratio camera 2 / camera 1 of a film. `thickness` in um."""
        return np.exp(self.predict_log(thickness))

    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film. `thickness` in um."""
        K, p, q = self.parameters
        return np.asarray(log_band_ratio(thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q))

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""
        _, p, q = self.parameters
        return np.asarray(log_band_ratio_slope(thickness, attenuation_camera1=p, attenuation_camera2=q))

    def parameter_gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the logarithm of the ratio by K, p and q, (3, ...)."""
        K, p, q = self.parameters
        return log_band_ratio_gradient(thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q)

    def thickness_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation that the calibration alone leaves in a thickness. [um]"""
        gradient = self.parameter_gradient(thickness)
        variance: Array = np.einsum("i...,ij,j...->...", gradient, self.covariance, gradient)
        return np.asarray(np.sqrt(variance) / self.slope(thickness))

    @cached_property
    def inverse(self) -> InverseTable:
        """Table from the logarithm of the ratio to thickness, for whole images."""
        return InverseTable.of(self)

    def invert(self, log_ratio: npt.ArrayLike) -> Array:
        """Thickness at which the model has this logarithm of the ratio, by root finding; NaN beyond the range. [um]"""
        low, high = self.thickness_range
        values = np.asarray(log_ratio, float)
        limits = self.predict_log([low, high])
        found = [
            brentq(lambda t, goal=goal: float(self.predict_log(t)) - goal, low, high, xtol=1e-10)
            if limits[0] <= goal <= limits[1]
            else math.nan
            for goal in values.ravel()
        ]
        return np.array(found).reshape(values.shape)

    def to_dataset(self) -> xr.Dataset:
        """The calibration as it is stored in ``calibration.nc``."""
        K, p, q = self.parameters
        low, high = self.thickness_range
        dataset = self.curve.copy()
        scalars = {
            "ratio_at_zero": (K, "1", "ratio of a vanishing film, K"),
            "attenuation_camera1": (p, "um-1", "attenuation in the band of camera 1, p"),
            "attenuation_camera2": (q, "um-1", "attenuation in the band of camera 2, q"),
            "reduced_chi_square": (self.reduced_chi_square, "1", "of the fit"),
        }
        for name, (value, unit, meaning) in scalars.items():
            dataset[name] = ((), value, {"units": unit, "long_name": meaning})
        dataset["covariance"] = (
            ("parameter", "parameter2"),
            self.covariance,
            {"long_name": "covariance of K, p, q", "comment": "both dimensions in the order of parameter"},
        )
        dataset["thickness_range"] = (
            "bound",
            [low, high],
            {"units": "um", "long_name": "where the calibration answers"},
        )
        dataset["parameter"] = ("parameter", ["ratio_at_zero", "attenuation_camera1", "attenuation_camera2"])
        return dataset

    @property
    def attributes(self) -> dict[str, Any]:
        """Global attributes of ``calibration.nc``."""
        return {
            "band_camera1_nm": self.bands[0],
            "band_camera2_nm": self.bands[1],
            "ratio_direction": DIRECTION,
            "fixture": self.fixture,
            "notes": "\n".join(self.notes),
            "input_hashes": json.dumps(self.input_hashes, sort_keys=True),
            "date": self.date,
        }

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> Calibration:
        """Rebuild a calibration from its file.

        Raises
        ------
        CalibrationError
            If a variable or attribute is missing, or the ratio is the other way round.
        """
        try:
            if dataset.attrs["ratio_direction"] != DIRECTION:
                raise CalibrationError(
                    f"Expected a calibration of the ratio {DIRECTION}; this one is of {dataset.attrs['ratio_direction']}. "
                    "Calibrate again with erlif, with the reabsorbed band on camera 1."
                )
            names = [name for name in dataset.variables if str(name).startswith("curve_")]
            low, high = (float(bound) for bound in dataset.thickness_range.values)
            return cls(
                ratio_at_zero=float(dataset.ratio_at_zero),
                attenuation_camera1=float(dataset.attenuation_camera1),
                attenuation_camera2=float(dataset.attenuation_camera2),
                covariance=np.asarray(dataset.covariance.values, float),
                thickness_range=(low, high),
                bands=(float(dataset.attrs["band_camera1_nm"]), float(dataset.attrs["band_camera2_nm"])),
                curve=dataset[names].reset_coords(drop=True).drop_attrs(deep=False),
                reduced_chi_square=float(dataset.reduced_chi_square),
                fixture=str(dataset.attrs["fixture"]),
                notes=tuple(note for note in str(dataset.attrs.get("notes", "")).split("\n") if note),
                input_hashes=json.loads(dataset.attrs.get("input_hashes", "{}")),
                date=str(dataset.attrs.get("date", "")),
            )
        except (KeyError, AttributeError) as error:
            raise CalibrationError(
                f"Expected a calibration as erlif calibrate writes it; {error} is missing from this file."
            ) from error


@dataclass(frozen=True)
class InverseTable:
    """Thickness, slope and calibration error on an even grid of the logarithm of the ratio.

    Attributes
    ----------
    start, step : float
        Logarithm of the ratio at the first entry, and the distance of entries.
    thickness : array, (entry,)
        [um]
    per_log_ratio : array, (entry,)
        Derivative of thickness by the logarithm of the ratio. [um]
    calibration_std : array, (entry,)
        Standard deviation that the calibration leaves in the thickness. [um]
    """

    start: float
    step: float
    thickness: Array
    per_log_ratio: Array
    calibration_std: Array

    @classmethod
    def of(cls, calibration: Calibration, entries: int = 20001) -> InverseTable:
        """Tabulate the inverse over the range of the calibration; linear interpolation is good to 1e-5 um."""
        low, high = calibration.thickness_range
        first, last = calibration.predict_log([low, high])
        grid = np.linspace(first, last, entries)
        # Newton's steps from a dense direct table: the curve is monotonic and smooth
        dense = np.linspace(low, high, entries)
        thickness = np.interp(grid, calibration.predict_log(dense), dense)
        for _ in range(3):
            thickness -= (calibration.predict_log(thickness) - grid) / calibration.slope(thickness)
        thickness = np.clip(thickness, low, high)
        return cls(
            float(first),
            float(grid[1] - grid[0]),
            thickness,
            1 / calibration.slope(thickness),
            calibration.thickness_std(thickness),
        )


def read_profile(path: Path) -> Profile:
    """Read a CMM profile, ``x_mm,thickness_um[,uncertainty_um]`` or with ``y_mm`` after ``x_mm``.

    Points out of order are sorted and repeated ones averaged, and the notes say so.

    Raises
    ------
    CalibrationError
        If the file is missing, its header is another, a value is no number, or fewer than eight points are left.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            table = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError) as error:
        raise CalibrationError(
            f"Expected the profile {path.name} as a CSV file; it cannot be read: {error}."
        ) from error
    header = [cell.strip() for cell in table[0]] if table else []
    surface = "y_mm" in header
    required = ["x_mm", "y_mm", "thickness_um"] if surface else ["x_mm", "thickness_um"]
    if header not in (required, [*required, "uncertainty_um"]):
        raise CalibrationError(
            f"Expected the header x_mm,thickness_um[,uncertainty_um] or x_mm,y_mm,thickness_um[,uncertainty_um] in {path.name}; "
            f"got {','.join(header) or 'nothing'}."
        )
    values = np.empty((len(table) - 1, len(header)))
    for n, row in enumerate(table[1:]):
        for m, name in enumerate(header):
            try:
                values[n, m] = float(row[m])
            except (ValueError, IndexError):
                values[n, m] = math.nan
            if not math.isfinite(values[n, m]):
                raise CalibrationError(
                    f"Expected a number in row {n + 2}, column {name} of {path.name}; got {row[m] if m < len(row) else 'nothing'!r}."
                )
    notes: list[str] = []
    axes = 2 if surface else 1
    order = np.lexsort(values[:, :axes].T[::-1])
    if np.any(order != np.arange(len(order))) and not surface:
        notes.append(f"{path.name}: the points are not in the order of x_mm; they were sorted")
        values = values[order]
    places, group = np.unique(values[:, :axes], axis=0, return_inverse=True)
    if len(places) < len(values):
        notes.append(f"{path.name}: {len(values) - len(places)} points repeat a place; repeated ones were averaged")
        count = np.bincount(group)
        merged = np.stack([np.bincount(group, column) / count for column in values.T], axis=1)
        if header[-1] == "uncertainty_um":
            merged[:, -1] /= np.sqrt(count)
        values = merged
    if len(values) < _LEAST_POINTS:
        raise CalibrationError(
            f"Expected at least {_LEAST_POINTS} points in {path.name}; got {len(values)}. Measure the profile more closely."
        )
    uncertainty = values[:, -1] if header[-1] == "uncertainty_um" else None
    if uncertainty is not None and np.any(uncertainty <= 0):
        raise CalibrationError(
            f"Expected positive values of uncertainty_um in {path.name}; row {int(np.argmax(uncertainty <= 0)) + 2} has none. "
            "Leave the column out if the uncertainty is not known."
        )
    position = values[:, :2] if surface else values[:, 0]
    return Profile(position, values[:, axes], uncertainty, tuple(notes))


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
    points, notes = _pair_profile_with_image(
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
    K, p, q = fit.parameters
    return Calibration(
        K, p, q, fit.covariance, (low, high), bands, curve, fit.reduced_chi_square, fixture, (*profile.notes, *notes)
    )


@dataclass(frozen=True)
class _Points:
    """CMM points with the ratio of the pixels about each."""

    thickness: Array  # [um]
    thickness_std: Array  # [um]
    log_ratio: Array
    log_ratio_std: Array
    pixel_var: Array  # variance of a pixel that is new in every frame, in the mean image
    fixed_var: Array  # variance of a pixel that all frames share
    steepness: Array  # of the thickness along the profile [um/mm]


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


def _pair_profile_with_image(
    ratios: RatioImages, profile: Profile, *, pixel_pitch: float, origin: tuple[float, float], direction: float
) -> tuple[_Points, list[str]]:
    """Average the ratio over the pixels nearest to each CMM point."""
    notes: list[str] = []
    good = (ratios.flags.values == 0) & np.isfinite(ratios.log_ratio.values)
    row, column = np.nonzero(good)
    log_ratio = ratios.log_ratio.values[good].astype(float)
    variance = ratios.log_ratio_var.values[good].astype(float)
    fixed = ratios.log_ratio_var_fixed.values[good].astype(float)
    dx, dy = (column - origin[0]) * pixel_pitch, (row - origin[1]) * pixel_pitch
    along = math.cos(direction) * dx + math.sin(direction) * dy
    across = -math.sin(direction) * dx + math.cos(direction) * dy
    place = along[:, None] if profile.position.ndim == 1 else np.stack([along, across], axis=1)
    position, thickness, uncertainty = _thin_out(profile, 1.5 * pixel_pitch)
    tree = cKDTree(position)
    spacing = float(np.median(np.asarray(tree.query(position, k=2)[0])[:, 1]))
    distance, cell = (np.asarray(found) for found in tree.query(place))
    near = distance <= 0.51 * spacing * math.sqrt(place.shape[1])
    covered = float(near.mean()) if near.size else 0.0
    cell, place, log_ratio, variance, fixed = (values[near] for values in (cell, place, log_ratio, variance, fixed))
    count = np.bincount(cell, minlength=len(position))
    used = count >= _LEAST_PIXELS
    if used.sum() < _LEAST_POINTS:
        raise CalibrationError(
            f"Expected at least {_LEAST_POINTS} points of the profile in the image; {int(used.sum())} of {len(position)} are. Check "
            "origin, direction and pixel_pitch in fixture.toml, or measure a longer profile."
        )
    if covered < 0.995:
        notes.append(f"the profile covers {covered:.0%} of the usable pixels; the rest was left out")
    if not used.all():
        notes.append(f"{int((~used).sum())} of {len(position)} points of the profile lie outside the usable image")
    mean, scatter = _robust_cell_mean(cell, log_ratio, len(position))
    centre = (
        np.stack([np.bincount(cell, axis, len(position)) for axis in place.T], axis=1) / np.maximum(count, 1)[:, None]
    )
    gradient = _gradient_along(position, centre, mean, used)
    mean = mean + np.einsum("ij,ij->i", gradient, position - centre)
    total_var, fixed_var = (
        np.bincount(cell, values, len(position)) / np.maximum(count, 1) for values in (variance, fixed)
    )
    std = np.sqrt(np.maximum(scatter, total_var) / np.maximum(count, 1))
    if uncertainty is None:
        notes.append("the profile has no uncertainty_um; it was estimated from the scatter about the curve")
        uncertainty = np.full(len(position), math.nan)
    steepness = _steepness(position, thickness, uncertainty)
    columns = (thickness, uncertainty, mean, std, total_var - fixed_var, fixed_var, steepness)
    points = _Points(*(column[used] for column in columns))
    return points, notes


def _thin_out(profile: Profile, least: float) -> tuple[Array, Array, Array | None]:
    """Points of the profile as (point, axis), those of a line closer than `least` mm averaged."""
    if profile.position.ndim == 2:
        return profile.position, profile.thickness, profile.uncertainty
    group = np.floor((profile.position - profile.position[0]) / least).astype(int)
    if np.median(np.diff(profile.position)) >= least:
        return profile.position[:, None], profile.thickness, profile.uncertainty
    count = np.bincount(group)
    full = count > 0
    position, thickness = (
        np.bincount(group, values)[full] / count[full] for values in (profile.position, profile.thickness)
    )
    uncertainty = None
    if profile.uncertainty is not None:
        uncertainty = np.sqrt(np.bincount(group, profile.uncertainty**2)[full]) / count[full]
    return position[:, None], thickness, uncertainty


def _robust_cell_mean(cell: npt.NDArray[np.intp], values: Array, cells: int) -> tuple[Array, Array]:
    """Mean and variance of the values of each cell, without those beyond four standard deviations of it."""
    keep = np.ones(cell.size, bool)
    mean, variance = np.zeros(cells), np.zeros(cells)
    for _ in range(3):
        count = np.maximum(np.bincount(cell[keep], minlength=cells), 1)
        mean = np.bincount(cell[keep], values[keep], cells) / count
        variance = np.bincount(cell[keep], (values[keep] - mean[cell[keep]]) ** 2, cells) / np.maximum(count - 1, 1)
        keep = np.abs(values - mean[cell]) <= 4 * np.sqrt(variance[cell])
    return mean, variance


def _gradient_along(position: Array, centre: Array, mean: Array, used: npt.NDArray[np.bool_]) -> Array:
    """Slope of the cell means at each CMM point, (point, axis), from a plane through its neighbours. [1/mm]"""
    axes = position.shape[1]
    gradient = np.zeros_like(position)
    tree = cKDTree(centre[used])
    neighbours = min(3 if axes == 1 else 9, int(used.sum()))
    nearest = np.asarray(tree.query(position, k=neighbours)[1])
    places, values = centre[used], mean[used]
    for n in np.nonzero(used)[0]:
        around = nearest[n]
        design = np.column_stack([np.ones(neighbours), places[around] - position[n]])
        gradient[n] = np.linalg.lstsq(design, values[around], rcond=None)[0][1:]
    return gradient


def _steepness(position: Array, thickness: Array, uncertainty: Array) -> Array:
    """Slope of the thickness along profile x at each point, the noise smoothed away. [um/mm]"""
    if position.shape[1] == 1:
        known = bool(np.isfinite(uncertainty).all())
        noise = uncertainty if known else np.full(thickness.size, _noise_of(thickness))
        smooth = UnivariateSpline(position[:, 0], thickness, w=1 / noise, s=thickness.size)
        return np.asarray(smooth.derivative()(position[:, 0]))
    neighbours = min(max(thickness.size // 20, 9), thickness.size)
    nearest = np.asarray(cKDTree(position).query(position, k=neighbours)[1])
    steepness = np.empty(thickness.size)
    for n, around in enumerate(nearest):
        design = np.column_stack([np.ones(neighbours), position[around] - position[n]])
        steepness[n] = np.linalg.lstsq(design, thickness[around], rcond=None)[0][1]
    return steepness


def _noise_of(values: Array) -> float:
    """Standard deviation of white noise on a smooth sequence, from its second differences."""
    return max(1.4826 * float(np.median(np.abs(np.diff(values, 2)))) / math.sqrt(6), 1e-4)


def _find_origin(
    ratios: RatioImages,
    profile: Profile,
    points: _Points,
    *,
    pixel_pitch: float,
    origin: tuple[float, float],
    direction: float,
) -> tuple[_Points, bool, str]:
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
        points, _ = _pair_profile_with_image(
            ratios, profile, pixel_pitch=pixel_pitch, origin=place, direction=direction
        )
        if abs(fit.shift) < 0.1 * fit.shift_std:
            break
    return points, True, f"the origin was moved by {-moved * 1e3:+.1f} ± {fit.shift_std * 1e3:.1f} um along the profile"


def _refuse_swapped_cameras(points: _Points) -> None:
    order = np.argsort(points.thickness)
    third = max(len(order) // 3, 2)
    rise = points.log_ratio[order[-third:]].mean() - points.log_ratio[order[:third]].mean()
    if rise < 0:
        raise CalibrationError(
            f"Expected the ratio {DIRECTION} to rise with thickness; it falls by {-rise:.0%} from the thin to the thick end. The "
            "cameras look swapped: exchange [camera1] and [camera2], the reabsorbed (580 nm) band belongs to camera 1."
        )


def _fit_robustly(points: _Points, *, align: bool) -> tuple[_Fit, npt.NDArray[np.bool_]]:
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
        if now.sum() < _LEAST_POINTS or (np.array_equal(now, kept) and not unknown):
            break
        kept = now
    return fit, kept


def _fit_once(points: _Points, thickness_std: Array, kept: npt.NDArray[np.bool_], *, align: bool) -> _Fit:
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


def _answering_range(fit: _Fit, points: _Points, kept: npt.NDArray[np.bool_], frames: int) -> tuple[float, float, bool]:
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


def check_bands(calibration: Calibration, bands: tuple[float, float]) -> None:
    """Refuse a calibration of other filter bands.

    Raises
    ------
    CalibrationError
        If a band differs by more than 1 nm, recognising exchanged cameras.
    """
    if np.allclose(calibration.bands, bands, atol=1.0):
        return
    swapped = (
        " The bands are exchanged: the cameras look swapped."
        if np.allclose(calibration.bands, bands[::-1], atol=1.0)
        else ""
    )
    raise CalibrationError(
        f"Expected a calibration of the bands of the run, {bands[0]:g} and {bands[1]:g} nm; got one of {calibration.bands[0]:g} and "
        f"{calibration.bands[1]:g} nm.{swapped} Calibrate with the filters of the run."
    )
