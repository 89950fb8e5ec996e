"""Light that lamp, lens and film shape: divided out before two bands are compared, or left out.

Where a film thickens fast, the light of the two bands differs in shape, and a registration that
takes this for texture shifts one camera against the other. A plain local mean leaves the curvature
of such light behind, and at the border of the image its slope; a local quadratic leaves neither
(local polynomial regression: Fan and Gijbels, 1996).
"""

from functools import cache
from typing import Final

import cv2
import numpy as np
import scipy

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.correction.light import BLOCK
from erlif.registration.normalise import BRIGHTER_PARTS, CUT, DARK

# Side of the cells whose sums are fitted. [px]
CELL: Final = 8

# A cell needs this part of its pixels to have a mean of its own. [1]
HALF: Final = 0.5

# Distance of the nodes between which the light is taken as linear. [px]
NODE: Final = 4

# Standard deviation of the Gaussian window of the fit. [px]
REACH: Final = 12.0

# Relative rise over blocks of 8 px above which light is steep. [1/px]
STEEP: Final = 0.04

# Light from which on its logarithm is taken; dark blocks are set to it. [counts]
LEAST_LIGHT: Final = 1e-3

_TERMS: Final = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))  # powers of x and y
_ORDERS: Final = 5  # the products of two quadratic terms have powers 0 to 4
_RIDGE: Final = 1e-6  # relative; keeps the fit solvable where hardly a pixel counts
_FEWEST_CELLS: Final = 4  # fewer have a parabola or a straight line in place of a spline
_NOTHING: Final = 1e-12  # absolute; the same where no pixel counts


def local_light(image: AnyArray, weight: AnyArray) -> Image:
    """Fit a quadratic about every place and return its value there.

    Parameters
    ----------
    image, weight : array, (y, x)
        As for `divide_by_light`.

    Returns
    -------
    array, (y, x), float32
        The smooth part of the light, in the unit of the image; 0 where nothing near counts.

    Examples
    --------
    Light that is quadratic in x is found as it is:

    >>> x = np.broadcast_to(np.arange(96.0), (64, 96))
    >>> light = 2000 - 0.1 * (x - 40) ** 2
    >>> bool(np.allclose(local_light(light, np.ones_like(light)), light, rtol=2e-3))
    True
    """
    nodes_y, nodes_x = (_to_nodes(size) for size in image.shape)
    nodes = (nodes_y @ _fit_quadratic(image, weight) @ nodes_x.T).astype(np.float32)

    # linear between the nodes, one of which lies beyond the image on every side
    rows, cols = nodes.shape
    light = cv2.resize(nodes, (cols * NODE, rows * NODE), interpolation=cv2.INTER_LINEAR)
    return np.asarray(light[NODE : NODE + image.shape[0], NODE : NODE + image.shape[1]])


def _fit_quadratic(image: AnyArray, weight: AnyArray) -> Array:
    """Value (row, column) at the middle of each cell of the quadratic that is fitted about it."""
    sound = weight > 0
    image = np.asarray(image, np.float32)
    if sound.all():
        return _values(_cell_means(image), _coefficients(image.shape))

    # the pixels of a cell that count stand for the others, unless they are fewer than half
    part = _cell_means(sound.astype(np.float32)) / _cell_parts(image.shape)
    known = part > HALF
    light = _cell_means(np.where(sound, image, np.float32(0)))
    light = np.where(known, light / np.where(known, part, 1), 0)
    fitted = _values(light, _coefficients(image.shape))

    # near cells without light the quadratic is fitted to the others
    size = 2 * _reach() + 1
    near = cv2.dilate((~known).astype(np.uint8), np.ones((size, size), np.uint8)) > 0
    normal = _normal_matrices(np.where(known, _cell_parts(image.shape), 0), near)
    fitted[near] = np.linalg.solve(normal, _right_side(light)[near][..., None])[..., 0, 0]
    return fitted


def _reach() -> int:
    """Cells that the Gaussian window spans on either side of its middle."""
    return int(np.ceil(CUT * REACH / CELL))


def _cell_moment(cells: Array, along_x: int, along_y: int) -> Array:
    """Gaussian average of the cells times powers of their distance in standard deviations."""
    d = np.arange(-_reach(), _reach() + 1) / (REACH / CELL)
    x, y = (np.exp(-0.5 * d**2) * d**n for n in (along_x, along_y))
    return np.asarray(cv2.sepFilter2D(cells, cv2.CV_64F, x, y, borderType=cv2.BORDER_CONSTANT))


def _right_side(light: Array) -> Array:
    """Right side (row, column, term) of the normal equations about each cell."""
    return np.stack([_cell_moment(light, a, b) for a, b in _TERMS], axis=-1)


def _normal_matrices(count: Array, where: Mask) -> Array:
    """Normal matrices (cell, term, term) of the weighted quadratics about some of the cells."""
    orders = [(a, b) for a in range(_ORDERS) for b in range(_ORDERS - a)]
    moments = {order: _cell_moment(count, *order)[where] for order in orders}
    normal = np.stack(
        [np.stack([moments[a + c, b + d] for c, d in _TERMS], -1) for a, b in _TERMS], -2
    )
    return np.asarray(normal + (_RIDGE * normal[..., :1, :1] + _NOTHING) * np.eye(len(_TERMS)))


@cache
def _coefficients(shape: tuple[int, int]) -> Array:
    """Weights (row, column, term) with which the data of a frame without gaps give the light."""
    count = _cell_parts(shape)
    normal = _normal_matrices(count, np.ones(count.shape, np.bool_))
    first = np.eye(len(_TERMS))[:, :1]  # the constant term is the value at the cell itself
    solved = np.asarray(np.linalg.solve(normal, first)[..., 0], np.float64)
    return solved.reshape(*count.shape, len(_TERMS))


def _values(light: Array, coefficients: Array) -> Array:
    return np.asarray((_right_side(light) * coefficients).sum(-1))


def divide_by_light(
    image: AnyArray, weight: AnyArray, *, out: Image | None = None
) -> tuple[Image, Image]:
    """Divide an image by its smooth light.

    Parameters
    ----------
    image : array, (y, x)
        Counts above the dark level.
    weight : array, (y, x)
        0 for a pixel that must not count, otherwise 1.
    out : array, (y, x), float32, optional
        Receives the texture; it may be the image.

    Returns
    -------
    texture : array, (y, x), float32
        About 1 everywhere; 1 where the weight is 0. [1]
    weight : array, (y, x), float32
        0 also where the light is below a fiftieth of the brighter parts, otherwise 1.

    Examples
    --------
    A ramp of light leaves no texture:

    >>> ramp = np.broadcast_to(500 + 4 * np.arange(96.0, dtype=np.float32), (64, 96))
    >>> texture, weight = divide_by_light(ramp, np.ones_like(ramp))
    >>> bool(np.allclose(texture, 1, atol=2e-3)), bool(weight.all())
    (True, True)
    """
    light = local_light(image, weight)
    bright = float(np.percentile(light[::CELL, ::CELL], BRIGHTER_PARTS))
    lit = (weight > 0) & (light > DARK * bright)
    texture = np.empty(image.shape, np.float32) if out is None else out
    with np.errstate(divide="ignore", invalid="ignore"):
        np.divide(image, light, out=texture)
    texture[~lit] = 1
    return texture, lit.astype(np.float32)


def is_steep(blocks: Image, shape: tuple[int, int], *, side: int = BLOCK) -> Mask:
    """Find where the film itself makes the light steep, as at the thin end of a wedge.

    There the ratio of the two bands varies as well, so their light rises differently, and a
    registration that took the rise for texture would shift one camera against the other.

    Parameters
    ----------
    blocks : array, (row, column), float32
        Mean light of the blocks of 8 px of one camera, NaN where it is not known; only ratios
        count.
    shape : tuple of int
        Rows and columns of the image.
    side : int
        Pixels of the image along a block.

    Returns
    -------
    array of bool, (y, x)
        True on the pixels of steep blocks.

    Examples
    --------
    Exponential light rises everywhere by the same part of itself:

    >>> middle = 8 * np.broadcast_to(np.arange(8, dtype=np.float32), (6, 8))
    >>> bool(is_steep(np.exp(0.06 * middle), (48, 64))[:, 8:-8].all())
    True
    >>> bool(is_steep(np.exp(0.02 * middle), (48, 64)).any())
    False
    """
    level = np.log(np.fmax(blocks, LEAST_LIGHT))

    # a median over 3 by 3 blocks, so that a single scratch or speck is not taken for the film
    down, along = np.gradient(cv2.medianBlur(level, 3))
    steep = down * down + along * along > (STEEP * BLOCK) ** 2
    if not steep.any():
        return np.zeros(shape, bool)
    pixels = np.repeat(np.repeat(steep, side, axis=0), side, axis=1)
    return np.asarray(pixels[: shape[0], : shape[1]])


@cache
def _to_nodes(size: int) -> Array:
    """Matrix (node, cell) of the cubic spline from the cell centres to the nodes of one axis.

    The first and the last node lie beyond the image, where the spline is extrapolated.
    """
    cells = -(-size // CELL)
    nodes = NODE * (np.arange(-1, -(-size // NODE) + 1) + 0.5) - 0.5
    places = (nodes + 0.5) / CELL - 0.5
    if cells < _FEWEST_CELLS:
        return np.asarray(scipy.interpolate.CubicSpline(np.arange(cells), np.eye(cells))(places))
    return _spline_matrix(cells, places)


def _spline_matrix(count: int, places: Array) -> Array:
    """Matrix (place, sample) of the cubic spline through samples at 0, 1, 2 and so on.

    The third derivative is continuous at the second and at the last but one sample (de Boor 1978,
    not-a-knot). That of scipy is the same; loading it takes 25 MB and a tenth of a second.
    """
    # second derivatives m of a spline: m[i-1] + 4 m[i] + m[i+1] = 6 (y[i-1] - 2 y[i] + y[i+1])
    unit = np.eye(count)
    beside = np.eye(count, k=-1) + np.eye(count, k=1)
    left, right = beside + 4 * unit, 6 * (beside - 2 * unit)
    for row, samples in ((0, [0, 1, 2]), (count - 1, [-1, -2, -3])):
        left[row], right[row] = 0, 0
        left[row, samples] = 1, -2, 1
    bend = np.linalg.solve(left, right)

    # a cubic between two samples from its values and second derivatives there
    below = np.clip(np.floor(places).astype(int), 0, count - 2)
    b = (places - below)[:, None]
    a = 1 - b
    curved = (a**3 - a) * bend[below] + (b**3 - b) * bend[below + 1]
    return np.asarray(a * unit[below] + b * unit[below + 1] + curved / 6)


@cache
def _cell_parts(shape: tuple[int, int]) -> Array:
    """Part of each cell that lies within an image."""
    return _cell_means(np.ones(shape, np.float32))


def _cell_means(image: AnyArray) -> Array:
    """Means over the cells; a cell that the border cuts is filled up with zeros."""
    rows, cols = -(-image.shape[0] // CELL), -(-image.shape[1] // CELL)
    full = (rows * CELL, cols * CELL)
    if image.shape != full:
        padded = np.zeros(full, np.float32)
        padded[: image.shape[0], : image.shape[1]] = image
        image = padded
    means = cv2.resize(np.asarray(image, np.float32), (cols, rows), interpolation=cv2.INTER_AREA)
    return np.asarray(means, np.float64)
