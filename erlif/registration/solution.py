"""The dense displacement, from a surface or from windows, and the camera map made of it.

The standard deviation of a fitted surface is that of the scores themselves.

The sandwich M^-1 (sum of s s') M^-1 takes the scores s of independent blocks as they are, so
texture that one camera alone sees, correlated noise and unequal light all count (Huber 1967).
Residual scores are too small where the fit could follow them; dividing them by one minus their
leverage is the jackknife (MacKinnon and White 1985).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.registration import local
from erlif.registration.camera_map import CameraMap, MapKind
from erlif.registration.matching import EE, WEIGHT, centres_along_axis, system_of, without_noise
from erlif.registration.selection import Model
from erlif.registration.surface import (
    RIDGE,
    ROWS,
    Box,
    Cells,
    Pairs,
    Surface,
    bilinear,
    equations,
    on_both_sides,
    pair_up,
    weights_on,
)
from erlif.registration.views import TextureViews

# The displacement is given this far beyond the frame of camera 2, for frames that drift. [px]
BEYOND: Final = 8.0

# Standard deviation of the displacement from which on a pixel is poorly registered. [px]
POOR_STD: Final = 0.25

# Remaining displacement of a neighbourhood from which on it is poorly registered. [px]
POOR_RESIDUAL: Final = 0.3

# A map is refused if a larger part of the common field is poorly registered. [1]
MOST_POOR: Final = 0.5

# Windows replace a surface if they leave less than this part of its squared difference. [1]
CLEARLY_LESS: Final = 0.9

# Rows at which the standard deviation of a surface is evaluated, bilinear between them.
STD_ROWS: Final = 65

# Columns of the same.
STD_COLUMNS: Final = 81

# Standard deviation of a window without texture, finite so that it can be interpolated. [px]
UNKNOWN_STD: Final = 1e3


def find_overlap(dx: Image, dy: Image, std: Image, height: int, width: int) -> Mask:
    """Mark the pixels whose point camera 2 sees; the fields become NaN far beyond its frame.

    ``height`` and ``width`` are those of camera 2. The fields are changed in place.
    """
    overlap = np.empty(dx.shape, np.bool_)
    x, y = np.arange(dx.shape[1], dtype=float), np.arange(dx.shape[0], dtype=float)[:, None]
    for start in range(0, dx.shape[0], ROWS):
        part = slice(start, start + ROWS)
        px, py = x + dx[part], y[part] + dy[part]
        across, down = np.maximum(-px, px - (width - 1)), np.maximum(-py, py - (height - 1))
        beyond = np.maximum(across, down)
        overlap[part] = beyond <= 0

        # an unknown displacement is far as well
        far = ~(beyond <= BEYOND)
        for field in (dx, dy, std):
            field[part][far] = np.nan
    return overlap


@dataclass(frozen=True)
class Solution:
    """A dense displacement with its standard deviation, on every pixel of camera 1.

    Attributes
    ----------
    dx : Image
        (y, x), along x. [px]
    dy : Image
        (y, x), along y. [px]
    std : Image
        (y, x), standard deviation of one component. [px]
    kind : MapKind
        Surface or local windows.
    resolution : str
        How fine the surface or the windows are, for the reader.
    """

    dx: Image
    dy: Image
    std: Image
    kind: MapKind
    resolution: str

    def moved(self, dx: float, dy: float) -> Solution:
        """The solution with a translation added. [px]"""
        return replace(self, dx=self.dx + np.float32(dx), dy=self.dy + np.float32(dy))


def describe_surface(
    cells: Cells, surface: Surface, model: Model, shape: tuple[int, int]
) -> Solution:
    """Evaluate a surface on every pixel, with the uncertainty of its coefficients.

    Parameters
    ----------
    cells : Cells
        The sums on the surface, whose scatter gives the uncertainty.
    surface : Surface
        The surface. [px]
    model : Model
        The family to which it belongs.
    shape : (int, int)
        Rows and columns of camera 1.

    Returns
    -------
    Solution
    """
    # the standard deviation is smooth: a coarse grid and interpolation between
    covariance = surface_covariance(cells, model, surface.box)
    x, y = np.linspace(0, shape[1] - 1, STD_COLUMNS), np.linspace(0, shape[0] - 1, STD_ROWS)
    coarse = surface_std(covariance, model, surface.box, x, y)
    zoom = ((shape[0] - 1) / (STD_ROWS - 1), (shape[1] - 1) / (STD_COLUMNS - 1))
    row, column = (
        np.arange(n, dtype=np.float32) / np.float32(z) for n, z in zip(shape, zoom, strict=True)
    )
    std = bilinear(coarse.astype(np.float32), row, column)

    dx, dy = surface.on_pixels(shape)
    return Solution(dx, dy, std, MapKind.SURFACE, str(model))


def solve_local(views: TextureViews, surface: Surface, slope: float, scale: Array) -> Solution:
    """Find one displacement for each window, in passes that start from the surface.

    Parameters
    ----------
    views : TextureViews
        The frames.
    surface : Surface
        The start. [px]
    slope : float
        See `erlif.registration.whitening.slope_gain`. [1]
    scale : array, (row, column)
        Expected rms difference of each cell. [1]

    Returns
    -------
    Solution
    """
    settings = views.settings
    sigma = local.window_sigma(settings.window, settings.step)
    base_x, base_y = surface.on_pixels(views.shape)
    y, x = (centres_along_axis(n, settings.step) for n in views.shape)

    def dense(field: Array) -> tuple[Image, Image]:
        return (
            base_x + local.to_pixels(field[0], y, x, views.shape),
            base_y + local.to_pixels(field[1], y, x, views.shape),
        )

    # one round more than passes: the last one only takes the sums where the field has ended
    field = np.zeros((2, len(y), len(x)))
    dx, dy = base_x, base_y
    for number in range(settings.passes + 1):
        sums, mean = views.sums(dx, dy, scale)
        field += mean.reshape(2, 1, 1)
        sums = without_noise(sums, slope)
        if number == settings.passes:
            break

        # smoothing between the passes keeps them stable; the last field stays as it is
        step, _, sound = local.solve_windows(sums, sigma)
        field = field + np.clip(step, -local.LARGEST_STEP, local.LARGEST_STEP)
        field = local.replace_outliers(field, sound)
        if number < settings.passes - 1:
            field = local.smooth(field)
        dx, dy = dense(field)

    # the interpolation overshoots next to windows without texture; no std falls below the least
    std = np.minimum(local.window_std(sums, sigma, settings.passes), UNKNOWN_STD)
    dense_std = local.to_pixels(std, y, x, views.shape)
    dense_std = np.maximum(dense_std, np.float32(std.min()))
    return Solution(*dense(field), dense_std, MapKind.LOCAL, f"{settings.window} px")


def fits_better(views: TextureViews, windows: Solution, surface: Solution) -> bool:
    """Whether windows leave clearly less difference between the textures than a fine surface does.

    Distortion finer than the surface shows in the difference, whatever its scale. Windows always
    take off a little noise as well, some per cent at 32 px; more than a tenth is distortion.
    """
    left = []
    for solution in (windows, surface):
        sums, _ = views.sums(solution.dx, solution.dy, None)
        left.append(float(sums[..., EE].sum()) / float(sums[..., WEIGHT].sum()))
    return left[0] < CLEARLY_LESS * left[1]


def finish_map(solution: Solution, views: TextureViews, cells: Cells, quality: float) -> CameraMap:
    """Make the camera map: mark what camera 2 does not see and what is poorly registered.

    Parameters
    ----------
    solution : Solution
        The displacement.
    views : TextureViews
        The frames, for their shapes and settings.
    cells : Cells
        The sums on the surface.
    quality : float
        Correlation coefficient of the textures. [1]

    Returns
    -------
    CameraMap

    Raises
    ------
    RegistrationError
        If most of the overlap is poorly registered.
    """
    h, w = views.shape
    height, width = views.shape_moving
    dx, dy, std = solution.dx.copy(), solution.dy.copy(), solution.std.copy()
    overlap = find_overlap(dx, dy, std, height, width)

    # a surface may pass by what its cells ask for, which its standard deviation does not show
    poor = std > POOR_STD
    if solution.kind is MapKind.SURFACE:
        pitch = round(float(cells.x[1] - cells.x[0]))
        off = local.still_off(cells.sums * cells.weight[..., None], pitch, tolerance=POOR_RESIDUAL)
        row = np.minimum(np.arange(h) // pitch, len(cells.y) - 1)
        column = np.minimum(np.arange(w) // pitch, len(cells.x) - 1)
        poor |= off[np.ix_(row, column)]

    part = float(poor[overlap].mean()) if overlap.any() else 1.0
    if part > MOST_POOR:
        raise RegistrationError(
            f"The cameras could not be laid over each other: {part:.0%} of their common field is "
            f"uncertain by more than {POOR_STD} px or does not agree with its neighbourhood. Give "
            "more frames, more light or a wall with more texture, and check the focus."
        )
    kind, resolution = solution.kind, solution.resolution
    return CameraMap(dx, dy, std, overlap, poor, quality, kind, resolution, views.settings)


# Side of the blocks whose scores are taken as independent: several correlation lengths. [px]
BLOCK: Final = 32.0
# The same for surfaces of many coefficients, which need more blocks. [px]
FINE_BLOCK: Final = 16.0
# Coefficients up to which the larger blocks are used: four by four elements.
COARSE: Final = 49
# Blocks along each axis, so that the scatter of the scores is known.
FEWEST_BLOCKS: Final = 8
# Part of its true score that a block keeps after the fit, at least.
SMALLEST_REST: Final = 0.1


def _block_scores(cells: Cells, block: AnyArray, across: Array, down: Array) -> Array:
    """Scores (block, component, y, x) of the splines: sums over the cells of each block."""
    on = cells.weight > 0
    rows = np.flatnonzero(np.diff(block[:, 0], prepend=-1))
    columns = np.flatnonzero(np.diff(block[0], prepend=-1))
    shape = len(rows), len(columns), 2, down.shape[1], across.shape[1]
    scores = np.empty(shape)

    for component, score in enumerate(system_of(cells.sums)[3:]):
        score = np.where(on, cells.weight * score, 0)
        lines = np.add.reduceat(score[:, :, None] * across, columns, axis=1)
        for row, (start, stop) in enumerate(pairwise([*rows, len(block)])):
            scores[row, :, component] = np.einsum(
                "rj,rbi->bji", down[start:stop], lines[start:stop]
            )
    return scores.reshape(-1, *shape[2:])


def _between(matrix: Array, x: Pairs, y: Pairs) -> Array:
    """Quadratic form of a matrix over the coefficients with the tensor splines at a grid."""
    n, m = int(y.first[-1]) + 1, int(x.first[-1]) + 1
    terms = matrix.reshape(n, m, n, m)[y.first[:, None], x.first, y.second[:, None], x.second]
    return on_both_sides(y.products, terms, x.products.T)


def surface_covariance(cells: Cells, model: Model, box: Box) -> Array:
    """Return the covariance of the spline coefficients of a fitted surface.

    In the corners of frames below some 500 px, where single blocks determine a spline, it is too
    large: up to four times in standard deviation for 2 by 2 elements on 256 by 256 px.

    Parameters
    ----------
    cells : Cells
        Sums moved to the fitted surface, so that their scores are residuals.
    model : Model
        The fitted model.
    box : Box
        Region of its spline.

    Returns
    -------
    array, (2p, 2p)
        x coefficients first. [px^2]
    """
    nx, ny = model.elements
    system = equations(cells, model.elements, box=box)
    block = blocks_of(cells, model, box)
    across, down = weights_on(box, model.elements, cells.x, cells.y)

    # a polynomial is a restriction of the spline: its matrix is inverted in its own space
    p = (nx + 3) * (ny + 3)
    basis = np.eye(2 * p) if model.basis is None else np.kron(np.eye(2), model.basis)
    matrix = basis.T @ system.matrix @ basis
    ridge = RIDGE * np.trace(matrix) / len(matrix)
    inverse = np.linalg.inv(matrix + ridge * np.eye(len(matrix)))
    inverse = basis @ inverse @ basis.T

    # leverage of block b: the trace of M_b M^-1, M_b its part of the normal matrix M
    x, y = pair_up(across), pair_up(down)
    gxx, gxy, gyy, _, _ = system_of(cells.sums)
    share = gxx * _between(inverse[:p, :p], x, y) + 2 * gxy * _between(inverse[:p, p:], x, y)
    share = share + gyy * _between(inverse[p:, p:], x, y)
    share = np.where(cells.weight > 0, cells.weight * share, 0)
    leverage = np.bincount(block.ravel(), share.ravel())
    scores = _block_scores(cells, block, across, down).reshape(len(leverage), 2 * p)

    # the fit has bent towards each block by its leverage, half of it on either component
    scores /= np.maximum(1 - leverage / 2, SMALLEST_REST)[:, None]
    spread = scores @ inverse
    return np.asarray(spread.T @ spread)


def blocks_of(cells: Cells, model: Model, box: Box) -> AnyArray:
    """Number (row, column) of the square block to which each cell belongs."""
    side = BLOCK if model.coefficients <= COARSE else FINE_BLOCK
    side = min(side, (box[1] - box[0]) / FEWEST_BLOCKS, (box[3] - box[2]) / FEWEST_BLOCKS)
    side = max(side, float(cells.x[1] - cells.x[0]))  # no block is smaller than a cell

    # half a pixel keeps the cells that begin a block clear of rounding
    column = ((cells.x - cells.x[0] + 0.5) // side).astype(np.int64)
    row = ((cells.y - cells.y[0] + 0.5) // side).astype(np.int64)
    return np.asarray(row[:, None] * (column[-1] + 1) + column[None, :])


def surface_std(covariance: Array, model: Model, box: Box, x: Array, y: Array) -> Array:
    """Return the standard deviation of the displacement of a surface.

    Parameters
    ----------
    covariance : array, (2p, 2p)
        Of the spline coefficients, x coefficients first. [px^2]
    model : Model
        The fitted model.
    box : Box
        Region of its spline.
    x, y : array, (m,) and (n,)
        Coordinates. [px]

    Returns
    -------
    array, (n, m)
        Standard deviation of one component, the rms of the two. [px]
    """
    nx, ny = model.elements
    x_pairs, y_pairs = (pair_up(one) for one in weights_on(box, model.elements, x, y))
    p = (nx + 3) * (ny + 3)
    out = 0.5 * _between(covariance[:p, :p] + covariance[p:, p:], x_pairs, y_pairs)
    return np.sqrt(np.maximum(out, 0))
