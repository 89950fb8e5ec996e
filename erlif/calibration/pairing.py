"""CMM points and the ratio of the pixels about each of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from erlif.calibration.points import Points
from erlif.calibration.pose import Pose
from erlif.calibration.profile import LEAST_POINTS, Profile, gradient_of_thickness
from erlif.core.arrays import Array, Mask
from erlif.core.errors import CalibrationError
from erlif.core.products import RatioImages

_LEAST_PIXELS = 20  # in the cell of one CMM point


def pair_profile_with_image(
    ratios: RatioImages, profile: Profile, pose: Pose
) -> tuple[Points, list[str]]:
    """Average the ratio over the pixels nearest to each point of a profile that `thin_out` has thinned."""
    notes: list[str] = []
    good = (ratios.flags.values == 0) & np.isfinite(ratios.log_ratio.values)
    row, column = np.nonzero(good)
    log_ratio = ratios.log_ratio.values[good].astype(float)
    variance = ratios.log_ratio_var.values[good].astype(float)
    fixed = ratios.log_ratio_var_fixed.values[good].astype(float)
    along, across = pose.place(column.astype(float), row.astype(float))
    place = along[:, None] if profile.position.ndim == 1 else np.stack([along, across], axis=1)
    position = profile.position.reshape(len(profile.position), -1)
    thickness, uncertainty = profile.thickness, profile.uncertainty
    tree = cKDTree(position)
    spacing = float(np.median(np.asarray(tree.query(position, k=2)[0])[:, 1]))
    distance, cell = (np.asarray(found) for found in tree.query(place))
    near = distance <= 0.51 * spacing * math.sqrt(place.shape[1])
    covered = float(near.mean()) if near.size else 0.0
    cell, place, across = cell[near], place[near], across[near]
    log_ratio, variance, fixed = log_ratio[near], variance[near], fixed[near]
    count = np.bincount(cell, minlength=len(position))
    used = count >= _LEAST_PIXELS
    if used.sum() < LEAST_POINTS:
        raise CalibrationError(
            f"Expected at least {LEAST_POINTS} points of the profile in the image; {int(used.sum())} of {len(position)} are. Check "
            "origin, direction and pixel_pitch in fixture.toml, or measure a longer profile."
        )
    if covered < 0.995:
        notes.append(
            f"the profile covers {covered:.0%} of the usable pixels; the rest was left out"
        )
    if not used.all():
        notes.append(
            f"{int((~used).sum())} of {len(position)} points of the profile lie outside the usable image"
        )
    mean, scatter, keep = _robust_cell_mean(cell, log_ratio, len(position))
    centre = (
        np.stack([np.bincount(cell, axis, len(position)) for axis in place.T], axis=1)
        / np.maximum(count, 1)[:, None]
    )
    if place.shape[1] == 1:
        gradient = _gradient_along(position, centre, mean, used)
        mean = mean + np.einsum("ij,ij->i", gradient, position - centre)
    else:
        gradient, curvature = _form_about(position, centre, mean, used)
        off = place - position[cell]
        bend = np.einsum("ij,ij->i", gradient[cell], off) + 0.5 * np.einsum(
            "ij,ijk,ik->i", off, curvature[cell], off
        )
        mean = mean - np.bincount(cell, bend, len(position)) / np.maximum(count, 1)
    total_var, fixed_var = (
        np.bincount(cell, values, len(position)) / np.maximum(count, 1)
        for values in (variance, fixed)
    )
    std = np.sqrt(np.maximum(scatter, total_var) / np.maximum(count, 1))
    if uncertainty is None:
        notes.append(
            "the profile has no uncertainty_um; it was estimated from the scatter about the curve"
        )
        uncertainty = np.full(len(position), math.nan)
    if position.shape[1] == 1:
        beside = log_ratio - gradient[cell, 0] * (place[:, 0] - position[cell, 0])
        across_line = _slope_across(cell[keep], across[keep], beside[keep], len(position))
    else:
        unknown = np.full(len(position), math.nan)
        across_line = (np.zeros(len(position)), unknown, unknown)
    columns = [thickness, uncertainty, mean, std, total_var - fixed_var, fixed_var, position]
    surface = position.shape[1] == 2
    form = (
        profile.surface_gradient
        if surface
        else gradient_of_thickness(position, thickness, uncertainty)
    )
    columns += [form, gradient, *across_line]
    points = Points(*(column[used] for column in columns))
    return points, notes


def thin_out(profile: Profile, *, pixel_pitch: float) -> Profile:
    """The profile with those points of a line averaged that lie closer than one and a half pixels. `pixel_pitch` in mm.

    It is done once, with the pitch that was given: two photographs of one fixture then rest on the same points, wherever each is laid.
    """
    least = 1.5 * pixel_pitch
    if profile.position.ndim == 2 or np.median(np.diff(profile.position)) >= least:
        return profile
    group = np.floor((profile.position - profile.position[0]) / least).astype(int)
    count = np.bincount(group)
    full = count > 0
    position, thickness = (
        np.bincount(group, values)[full] / count[full]
        for values in (profile.position, profile.thickness)
    )
    uncertainty = None
    if profile.uncertainty is not None:
        uncertainty = np.sqrt(np.bincount(group, profile.uncertainty**2)[full]) / count[full]
    return replace(profile, position=position, thickness=thickness, uncertainty=uncertainty)


def _robust_cell_mean(
    cell: npt.NDArray[np.intp], values: Array, cells: int
) -> tuple[Array, Array, Mask]:
    """Mean and variance of the values of each cell, without those beyond four standard deviations of it, and which are within."""
    keep = np.ones(cell.size, bool)
    mean, variance = np.zeros(cells), np.zeros(cells)
    for _ in range(3):
        count = np.maximum(np.bincount(cell[keep], minlength=cells), 1)
        mean = np.bincount(cell[keep], values[keep], cells) / count
        variance = np.bincount(
            cell[keep], (values[keep] - mean[cell[keep]]) ** 2, cells
        ) / np.maximum(count - 1, 1)
        keep = np.abs(values - mean[cell]) <= 4 * np.sqrt(variance[cell])
    return mean, variance, keep


def _slope_across(
    cell: npt.NDArray[np.intp], across: Array, values: Array, cells: int
) -> tuple[Array, Array, Array]:
    """Mean place across the profile, slope of the values over it, and the slope's standard deviation, cell by cell."""
    count = np.maximum(np.bincount(cell, minlength=cells), 1)
    middle, mean = (np.bincount(cell, each, cells) / count for each in (across, values))
    off, rest = across - middle[cell], values - mean[cell]
    spread = np.bincount(cell, off**2, cells)
    with np.errstate(divide="ignore", invalid="ignore"):  # a cell of a single row has no slope
        slope = np.bincount(cell, off * rest, cells) / spread
        scatter = np.bincount(cell, (rest - slope[cell] * off) ** 2, cells) / np.maximum(
            count - 2, 1
        )
        std = np.sqrt(scatter / spread)
    return middle, slope, std


def _gradient_along(position: Array, centre: Array, mean: Array, used: Mask) -> Array:
    """Slope of the cell means at each CMM point of a line, (point, 1), through its neighbours. [1/mm]"""
    gradient = np.zeros_like(position)
    neighbours = min(3, int(used.sum()))
    nearest = np.asarray(cKDTree(centre[used]).query(position, k=neighbours)[1])
    places, values = centre[used], mean[used]
    for n in np.nonzero(used)[0]:
        around = nearest[n]
        design = np.column_stack([np.ones(neighbours), places[around] - position[n]])
        gradient[n] = np.linalg.lstsq(design, values[around], rcond=None)[0][1:]
    return gradient


def _form_about(position: Array, centre: Array, mean: Array, used: Mask) -> tuple[Array, Array]:
    """Gradient (point, 2) and second derivatives (point, 2, 2) of the cell means at each CMM point of a surface, from a parabola through its
    neighbours: the cells are wide, and the film is not plane in them. [1/mm, 1/mm2]"""
    gradient, curvature = np.zeros_like(position), np.zeros((len(position), 2, 2))
    neighbours = min(13, int(used.sum()))
    nearest = np.asarray(cKDTree(centre[used]).query(position, k=neighbours)[1])
    places, values = centre[used], mean[used]
    for n in np.nonzero(used)[0]:
        x, y = (places[nearest[n]] - position[n]).T
        design = np.column_stack([np.ones(neighbours), x, y, x**2 / 2, x * y, y**2 / 2])
        _, gradient[n, 0], gradient[n, 1], xx, xy, yy = np.linalg.lstsq(
            design, values[nearest[n]], rcond=None
        )[0]
        curvature[n] = [[xx, xy], [xy, yy]]
    return gradient, curvature
