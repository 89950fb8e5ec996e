"""CMM points and the ratio of the pixels about each of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import UnivariateSpline
from scipy.spatial import cKDTree

from erlif.calibration.profile import LEAST_POINTS, Profile
from erlif.core.errors import CalibrationError
from erlif.core.products import RatioImages

Array = npt.NDArray[np.float64]

_LEAST_PIXELS = 20  # in the cell of one CMM point


@dataclass(frozen=True)
class Points:
    """CMM points with the ratio of the pixels about each."""

    thickness: Array  # [um]
    thickness_std: Array  # [um]
    log_ratio: Array
    log_ratio_std: Array
    pixel_var: Array  # variance of a pixel that is new in every frame, in the mean image
    fixed_var: Array  # variance of a pixel that all frames share
    steepness: Array  # of the thickness along the profile [um/mm]


def pair_profile_with_image(
    ratios: RatioImages, profile: Profile, *, pixel_pitch: float, origin: tuple[float, float], direction: float
) -> tuple[Points, list[str]]:
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
    if used.sum() < LEAST_POINTS:
        raise CalibrationError(
            f"Expected at least {LEAST_POINTS} points of the profile in the image; {int(used.sum())} of {len(position)} are. Check "
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
    points = Points(*(column[used] for column in columns))
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
