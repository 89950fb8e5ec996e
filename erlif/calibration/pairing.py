"""CMM points and the ratio of the pixels around each of them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy

from erlif.calibration.points import Points
from erlif.calibration.pose import Pose
from erlif.calibration.profile import MINIMUM_POINTS, Profile, gradient_of_thickness
from erlif.core.arrays import Array, Mask
from erlif.core.errors import CalibrationError
from erlif.core.notes import Note, remark, warn
from erlif.core.products import RatioImages

# Number of the CMM point that each pixel belongs to, (pixel,).
Cells = npt.NDArray[np.intp]

_MINIMUM_PIXELS = 20  # in the cell of one CMM point
_CELL = 0.51  # of the spacing of the points: half, and 2 % so that cells of even points touch
_COVERED = 0.995  # share of the usable pixels below which a note reports the rest

_COVERED_LEAST = 0.5  # share below which the pixel pitch is rather wrong
_SPACING = 1.5  # pixels between the points of a line; closer ones share their pixels
_OUTLIER = 4.0  # standard deviations of one cell
_OUTLIER_PASSES = 3
_LINE_NEIGHBOURS = 3  # cells for a slope along a line
_SURFACE_NEIGHBOURS = 13  # cells for the six terms of a parabola: a point and two rings


class _Pixels(NamedTuple):
    """Valid pixels of the ratio image that lie in the cell of a CMM point."""

    cell: Cells
    place: Array  # position on the profile, (pixel, axis). [mm]
    across: Array  # position across the profile, (pixel,). [mm]
    log_ratio: Array
    variance: Array  # variance of `log_ratio`, (pixel,)
    fixed: Array  # its part that repeats from frame to frame, (pixel,)
    covered: float  # share of the valid pixels that lie in a cell


def pair_profile_with_image(
    ratios: RatioImages, profile: Profile, pose: Pose
) -> tuple[Points, list[Note]]:
    """Average the ratio over the pixels nearest to each point of the profile.

    Parameters
    ----------
    ratios : RatioImages
        Ratio of the fixture, (y, x).
    profile : Profile
        Profile after `thin_out`.
    pose : Pose
        Position of the pixels on the profile.

    Returns
    -------
    Points
        The points that can be used, with the ratio there.
    list of Note
        What was left out, and why.

    Raises
    ------
    CalibrationError
        If fewer than eight points lie in the usable image.
    """
    position = profile.position.reshape(len(profile.position), -1)
    pixels = _assign_pixels(ratios, position, pose)
    cell, total = pixels.cell, len(position)
    count = np.bincount(cell, minlength=total)
    used = count >= _MINIMUM_PIXELS
    notes = _describe_coverage(pixels, used)

    mean, variance, keep = _robust_cell_mean(cell, pixels.log_ratio, total)
    mean, gradient = _carry_to_points(mean, pixels, position, used)

    # the scatter within a cell counts where it exceeds the stated variance
    total_var, fixed_var = (
        np.bincount(cell, values, total) / np.maximum(count, 1)
        for values in (pixels.variance, pixels.fixed)
    )
    std = np.sqrt(np.maximum(variance, total_var) / np.maximum(count, 1))

    uncertainty = profile.uncertainty
    if uncertainty is None:
        text = (
            "the profile has no uncertainty_um; it was estimated from the scatter about the curve"
        )
        notes.append(remark("", text))
        uncertainty = np.full(total, math.nan)

    if position.shape[1] == 1:
        middle, slope, slope_std = _slope_across(pixels, gradient, position, keep)
        thickness_gradient = gradient_of_thickness(position, profile.thickness, uncertainty)
    else:
        middle, slope, slope_std = np.zeros(total), *np.full((2, total), math.nan)
        thickness_gradient = profile.surface_gradient

    points = Points(
        thickness=profile.thickness[used],
        thickness_std=uncertainty[used],
        log_ratio=mean[used],
        log_ratio_std=std[used],
        pixel_var=(total_var - fixed_var)[used],
        fixed_var=fixed_var[used],
        position=position[used],
        gradient=thickness_gradient[used],
        ratio_gradient=gradient[used],
        mean_across=middle[used],
        across_slope=slope[used],
        across_slope_std=slope_std[used],
    )
    return points, notes


def _assign_pixels(ratios: RatioImages, position: Array, pose: Pose) -> _Pixels:
    """Valid pixels with the CMM point nearest to each, without those beyond all cells."""
    good = (ratios.flags.values == 0) & np.isfinite(ratios.log_ratio.values)
    row, column = np.nonzero(good)
    log_ratio = ratios.log_ratio.values[good].astype(float)
    variance = ratios.log_ratio_var.values[good].astype(float)
    fixed = ratios.log_ratio_var_fixed.values[good].astype(float)

    along, across = pose.place(column.astype(float), row.astype(float))
    place = along[:, None] if position.shape[1] == 1 else np.stack([along, across], axis=1)
    tree = scipy.spatial.cKDTree(position)
    spacing = float(np.median(np.asarray(tree.query(position, k=2)[0])[:, 1]))
    distance, cell = (np.asarray(found) for found in tree.query(place))
    near = distance <= _CELL * spacing * math.sqrt(place.shape[1])
    return _Pixels(
        cell=cell[near],
        place=place[near],
        across=across[near],
        log_ratio=log_ratio[near],
        variance=variance[near],
        fixed=fixed[near],
        covered=float(near.mean()) if near.size else 0.0,
    )


def _describe_coverage(pixels: _Pixels, used: Mask) -> list[Note]:
    """Notes on pixels without profile and on points without pixels; too few points are refused."""
    if used.sum() < MINIMUM_POINTS:
        raise CalibrationError(
            f"Expected at least {MINIMUM_POINTS} points of the profile in the image; "
            f"{int(used.sum())} of {used.size} are. Check origin, direction and pixel_pitch in "
            "fixture.toml, or measure a longer profile."
        )
    notes = []
    if pixels.covered < _COVERED:
        text = f"the profile covers {pixels.covered:.0%} of the usable pixels"
        doubt = (
            "pixel_pitch, origin or direction in fixture.toml may be wrong. All films are wrong "
            "with them: correct them, or measure a longer profile"
        )
        few = pixels.covered < _COVERED_LEAST
        notes.append(
            warn("", f"{text}: {doubt}") if few else remark("", f"{text}; the rest was left out")
        )
    if not used.all():
        outside = f"{int((~used).sum())} of {used.size} points of the profile"
        notes.append(remark("", f"{outside} lie outside the usable image"))
    return notes


def thin_out(profile: Profile, *, pixel_pitch: float) -> Profile:
    """Average the points of a line that lie closer than one and a half pixels.

    It is done once, with the given pitch: two photographs of one fixture then rest on the same
    points, wherever each is placed.

    Parameters
    ----------
    profile : Profile
        A surface is returned as it is.
    pixel_pitch : float
        Distance of pixels on the profile. [mm]

    Returns
    -------
    Profile
    """
    spacing = _SPACING * pixel_pitch
    if profile.position.ndim == 2 or np.median(np.diff(profile.position)) >= spacing:
        return profile
    group = np.floor((profile.position - profile.position[0]) / spacing).astype(int)
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


def _robust_cell_mean(cell: Cells, values: Array, cells: int) -> tuple[Array, Array, Mask]:
    """Compute mean and variance of each cell without outliers, and the mask of kept values."""
    keep = np.ones(cell.size, bool)
    for _ in range(_OUTLIER_PASSES):
        count = np.maximum(np.bincount(cell[keep], minlength=cells), 1)
        mean = np.bincount(cell[keep], values[keep], cells) / count
        variance = np.bincount(
            cell[keep], (values[keep] - mean[cell[keep]]) ** 2, cells
        ) / np.maximum(count - 1, 1)
        keep = np.abs(values - mean[cell]) <= _OUTLIER * np.sqrt(variance[cell])
    return mean, variance, keep


def _slope_across(
    pixels: _Pixels, gradient: Array, position: Array, keep: Mask
) -> tuple[Array, Array, Array]:
    """Slope of the ratio across a line in each cell; the image determines the turn by it.

    After the mean position across [mm] come the slope and its standard deviation. [1/mm]

    The slope along the line is removed first. The error comes from the scatter about the slope.
    """
    cells = len(position)
    along = gradient[pixels.cell, 0] * (pixels.place[:, 0] - position[pixels.cell, 0])
    cell, across, values = pixels.cell[keep], pixels.across[keep], (pixels.log_ratio - along)[keep]

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


def _carry_to_points(
    mean: Array, pixels: _Pixels, position: Array, used: Mask
) -> tuple[Array, Array]:
    """Mean of each cell carried from its centre of gravity to the CMM point, and its gradient."""
    cell, place, total = pixels.cell, pixels.place, len(position)
    count = np.maximum(np.bincount(cell, minlength=total), 1)
    centre = np.stack([np.bincount(cell, axis, total) for axis in place.T], axis=1) / count[:, None]
    if position.shape[1] == 1:
        gradient = _gradient_along(position, centre, mean, used)
        return mean + np.einsum("ij,ij->i", gradient, position - centre), gradient

    # the cells of a surface are wide: the curvature within them counts too
    gradient, curvature = _form_about(position, centre, mean, used)
    off = place - position[cell]
    bend = np.einsum("ij,ij->i", gradient[cell], off) + 0.5 * np.einsum(
        "ij,ijk,ik->i", off, curvature[cell], off
    )
    return mean - np.bincount(cell, bend, total) / count, gradient


def _gradient_along(position: Array, centre: Array, mean: Array, used: Mask) -> Array:
    """Slope of the cell means at each CMM point of a line, (point, 1), from neighbours. [1/mm]"""
    gradient = np.zeros_like(position)
    nearest, off = _find_neighbours(position, centre, used, _LINE_NEIGHBOURS)
    design = np.stack([np.ones_like(off[..., 0]), off[..., 0]], axis=-1)
    gradient[used] = _solve_each(design, mean[used][nearest])[:, 1:]
    return gradient


def _form_about(position: Array, centre: Array, mean: Array, used: Mask) -> tuple[Array, Array]:
    """Gradient (point, 2) [1/mm] and curvature (point, 2, 2) [1/mm2] at the points of a surface.

    They are those of the cell means, from a parabola through the neighbours: the cells are wide,
    and the film is not plane within one.
    """
    gradient, curvature = np.zeros_like(position), np.zeros((len(position), 2, 2))
    nearest, off = _find_neighbours(position, centre, used, _SURFACE_NEIGHBOURS)
    x, y = np.moveaxis(off, -1, 0)
    design = np.stack([np.ones_like(x), x, y, x**2 / 2, x * y, y**2 / 2], axis=-1)
    _, *slopes, xx, xy, yy = _solve_each(design, mean[used][nearest]).T
    gradient[used] = np.stack(slopes, axis=1)
    curvature[used] = np.moveaxis(np.array([[xx, xy], [xy, yy]]), -1, 0)
    return gradient, curvature


def _find_neighbours(
    position: Array, centre: Array, used: Mask, count: int
) -> tuple[npt.NDArray[np.intp], Array]:
    """Cells nearest to each used point among the used ones, and the way to their centres. [mm]"""
    tree = scipy.spatial.cKDTree(centre[used])
    nearest = np.asarray(tree.query(position, k=min(count, int(used.sum())))[1])[used]
    return nearest, centre[used][nearest] - position[used][:, None]


def _solve_each(design: Array, values: Array) -> Array:
    """Least squares at each point, (point, term), from its neighbours, (point, neighbour, ...)."""
    return np.asarray(np.einsum("pij,pj->pi", np.linalg.pinv(design), values))
