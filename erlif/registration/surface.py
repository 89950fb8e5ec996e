"""Smooth displacement surfaces: tensor products of uniform cubic B-splines fitted to the cell sums.

A camera-to-camera map is smooth, so a few coefficients describe the whole frame, where separate
windows would need a vector each. `erlif.registration.selection` decides how many the data support.
The splines are those of de Boor (1978) on equidistant knots.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from erlif.core.arrays import AnyArray, Array, Image
from erlif.registration.matching import EE, WEIGHT, system_of

# x0, x1, y0, y1 of a rectangle of camera-1 pixels. [px]
Box = tuple[float, float, float, float]

# Ridge in parts of the mean diagonal of the normal matrix: far below all that data support.
RIDGE: Final = 1e-9
# Cells with less than this part of the pixels of a full cell have no weight.
LIT_SHARE: Final = 0.25

# Rows of a frame that are worked on at once: their arrays stay in the cache.
ROWS: Final = 32
# Multiplications in a matrix product, at most: larger ones would be divided among the processors,
# which costs more than it saves.
PRODUCT: Final = 2**18


def spline_weights(positions: AnyArray, start: float, stop: float, elements: int) -> Array:
    """Return the cubic B-spline weights of positions on an interval cut into equal elements.

    Parameters
    ----------
    positions : array, (n,)
        Coordinates; outside the interval the outer element is continued. [px]
    start, stop : float
        Ends of the interval. [px]
    elements : int
        Number of elements; there are three more coefficients.

    Returns
    -------
    array, (n, elements + 3)
        Weights of the coefficients, four of them at each position, which add up to 1.
    """
    # positions beyond the interval stay in the outer element, with u below 0 or above 1
    t = (np.asarray(positions, float) - start) * (elements / (stop - start))
    first = np.clip(np.floor(t), 0, elements - 1).astype(np.int64)

    # the four pieces of the B-spline as polynomials of the place within the element
    u = t - first
    pieces = [(1 - u) ** 3, 4 - 6 * u**2 + 3 * u**3, 1 + 3 * u + 3 * u**2 - 3 * u**3, u**3]
    weights = np.stack(pieces, axis=-1) / 6
    matrix = np.zeros((len(first), elements + 3))
    np.put_along_axis(matrix, first[:, None] + np.arange(4), weights, axis=1)
    return matrix


def weights_on(
    box: Box, elements: tuple[int, int], x: AnyArray, y: AnyArray
) -> tuple[Array, Array]:
    """Compute the weights on a box along x and along y.

    Parameters
    ----------
    box : Box
        Region of the elements. [px]
    elements : (int, int)
        Elements along x and y.
    x, y : array
        Coordinates. [px]

    Returns
    -------
    tuple of two arrays
        As of `spline_weights`.
    """
    nx, ny = elements
    return spline_weights(x, *box[:2], nx), spline_weights(y, *box[2:], ny)


class Pairs(NamedTuple):
    """Products of two splines at positions, for all pairs of splines that overlap.

    Attributes
    ----------
    products : Array
        (position, pair). [1]
    first : AnyArray
        (pair,): index of the one spline.
    second : AnyArray
        (pair,): index of the other; each pair of different splines comes in both orders.
    """

    products: Array
    first: AnyArray
    second: AnyArray


def pair_up(matrix: Array) -> Pairs:
    """Multiply the columns of `spline_weights` by the four at most that overlap on either side.

    A sum over the products of two tensor splines is a matrix product along each axis with these.
    """
    number = np.arange(matrix.shape[1])
    first, second = np.nonzero(np.abs(number[:, None] - number) < 4)
    return Pairs(matrix[:, first] * matrix[:, second], first, second)


def on_both_sides(left: Array, middle: Array, right: Array) -> Array:
    """The product ``left @ middle @ right`` on one processor; ``middle`` may be several matrices.

    The matrices are narrow: to divide them among processors costs more than it saves.
    """
    half = np.einsum("ij,...jk->...ik", left, middle)
    return np.asarray(np.einsum("...ij,jk->...ik", half, right))


def bilinear(values: Image, row: Image, column: Image) -> Image:
    """Interpolate a small float32 table at fractional rows and columns, constant beyond its edges.

    The rows are interpolated once for each output row, then the columns.
    """

    def between(positions: Image, number: int) -> tuple[AnyArray, Image]:
        t = np.clip(positions, np.float32(0), np.float32(number - 1))
        first = np.minimum(t.astype(np.int64), number - 2)
        return first, (t - first).astype(np.float32)

    j, v = between(row, values.shape[0])
    i, u = between(column, values.shape[1])
    lines = values[j] + v[:, None] * np.diff(values, axis=0)[j]

    # what lies right of the first column, on a part of the rows that stays in the cache
    out = np.empty((row.size, column.size), np.float32)
    for start in range(0, row.size, ROWS):
        part = lines[start : start + ROWS]
        step = np.take(np.diff(part, axis=1), i, axis=1)
        step *= u
        np.add(np.take(part, i, axis=1), step, out=out[start : start + ROWS])
    return out


@dataclass(frozen=True)
class Surface:
    """A displacement surface on a box of camera-1 pixels.

    Attributes
    ----------
    box : Box
        Region on which the elements are equal; beyond it the outer ones are continued. [px]
    coefficients : Array
        (component, y, x), three more than elements along each axis; component 0 is x. [px]
    """

    box: Box
    coefficients: Array

    @property
    def elements(self) -> tuple[int, int]:
        """Elements along x and along y."""
        return self.coefficients.shape[2] - 3, self.coefficients.shape[1] - 3

    def evaluate(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Displacement (dx, dy) at the grid of coordinates x and y, each (len(y), len(x)). [px]"""
        across, down = weights_on(self.box, self.elements, x, y)
        return down @ self.coefficients[0] @ across.T, down @ self.coefficients[1] @ across.T

    def on_pixels(self, shape: tuple[int, int], *, binning: int = 1) -> tuple[Image, Image]:
        """Displacement (dx, dy) on all pixels of a binned frame, float32. [binned px]

        Binned pixel k covers the pixels from ``k * binning`` and lies at their centre.
        """
        y, x = (np.arange(n) * binning + (binning - 1) / 2 for n in shape)
        across, down = weights_on(self.box, self.elements, x, y)

        # in float64, rounded once
        rows = max(PRODUCT // across.size, 1)
        fields = np.empty((2, *shape), np.float32)
        for field, coefficients in zip(fields, self.coefficients, strict=True):
            lines = down @ (coefficients / binning)
            for start in range(0, shape[0], rows):
                field[start : start + rows] = lines[start : start + rows] @ across.T
        return fields[0], fields[1]

    def moved(self, dx: float, dy: float) -> "Surface":
        """The surface with a translation added. [px]"""
        shift = np.array([dx, dy]).reshape(2, 1, 1)
        return Surface(self.box, self.coefficients + shift)


def affine_surface(box: Box, matrix: Array, offset: Array) -> Surface:
    """The affine displacement ``matrix @ (x, y) + offset`` as a surface of one element."""
    x0, x1, y0, y1 = box
    # a cubic B-spline whose coefficients are the values of a line at these places is the line
    gx = x0 + (x1 - x0) * np.arange(-1, 3)
    gy = y0 + (y1 - y0) * np.arange(-1, 3)
    x, y = np.meshgrid(gx, gy)
    return Surface(
        box, np.stack([m[0] * x + m[1] * y + o for m, o in zip(matrix, offset, strict=True)])
    )


def degree_basis(degree: int) -> Array:
    """Orthonormal coefficients (16, p) of the polynomials up to this total degree, at most 3.

    A surface of one element has 16 coefficients and holds all polynomials of the third degree in
    each coordinate; the columns span those whose degrees add up to at most ``degree``.
    """
    t = np.linspace(0, 1, 4)
    power = np.stack([(2 * t - 1) ** k for k in range(4)], axis=1)
    # spline coefficients (4,) of each power
    one = np.linalg.solve(spline_weights(t, 0.0, 1.0, 1), power)
    columns = [
        np.outer(one[:, j], one[:, i]).ravel()
        for i in range(4)
        for j in range(4)
        if i + j <= degree
    ]
    return np.linalg.qr(np.stack(columns, axis=1))[0]


@dataclass(frozen=True)
class SplineEquations:
    """Normal equations of one spline grid.

    Attributes
    ----------
    box : Box
        Region of the spline. [px]
    elements : tuple[int, int]
        Elements along x and along y.
    matrix : Array
        (2p, 2p), x coefficients first: information on the coefficients. [1/px^2]
    right : Array
        (2p,): the matrix times the solution. [1/px]
    start : Array
        (2p,): the plane to which coefficients without data fall back. [px]
    """

    box: Box
    elements: tuple[int, int]
    matrix: Array
    right: Array
    start: Array


@dataclass(frozen=True)
class Cells:
    """Cell sums with their places, the displacement at which they hold, and their weights.

    Attributes
    ----------
    sums : Array
        (row, column, 11), see `erlif.registration.matching.SUMS`.
    x : Array
        Columns of the cell centres. [px]
    y : Array
        Rows of the cell centres. [px]
    here_x : Array
        (row, column): displacement along x at which the sums were taken. [px]
    here_y : Array
        (row, column): displacement along y at which the sums were taken. [px]
    weight : Array
        (row, column): reciprocal of the residual variance of the textures. [1]
    """

    sums: Array
    x: Array
    y: Array
    here_x: Array
    here_y: Array
    weight: Array

    @property
    def box(self) -> Box:
        """The smallest box that holds all cells with weight. [px]"""
        across = np.nonzero((self.weight > 0).any(0))[0]
        down = np.nonzero((self.weight > 0).any(1))[0]
        hx = (self.x[1] - self.x[0]) / 2
        hy = (self.y[1] - self.y[0]) / 2
        return (
            float(self.x[across[0]] - hx),
            float(self.x[across[-1]] + hx),
            float(self.y[down[0]] - hy),
            float(self.y[down[-1]] + hy),
        )


def cell_weights(sums: Array) -> Array:
    """Reciprocal residual variance of each cell; 0 if it is nearly empty.

    The larger of the cell's own variance and that of the 3 by 3 cells around it counts: a single
    cell may match by chance.
    """
    # empty cells divide by zero and are left out below
    n, ee = sums[..., WEIGHT], sums[..., EE]
    near_n, near_e = _box3(n), _box3(ee)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(n > 0, ee / n, 0)
        near = np.where(near_n > 0, near_e / near_n, 0)
        variance = np.maximum(own, near)
        lit = n > LIT_SHARE * n.max()
        weight: Array = np.where(lit & (variance > 0), 1 / variance, 0)
    return weight


def _box3(cells: Array) -> Array:
    """Sum over 3 by 3 cells; nothing beyond the edges."""
    p = np.pad(cells, 1)
    p = p[:-2] + p[1:-1] + p[2:]
    return np.asarray(p[:, :-2] + p[:, 1:-1] + p[:, 2:])


def equations(
    cells: Cells, elements: tuple[int, int], *, box: Box | None = None
) -> SplineEquations:
    """Assemble the normal equations of a spline grid.

    Parameters
    ----------
    cells : Cells
        The data.
    elements : (int, int)
        Elements along x and y.
    box : Box, optional
        Region of the spline; that of the cells if missing.

    Returns
    -------
    SplineEquations
        Solved by `solve_surface`.
    """
    box = cells.box if box is None else box
    nx, ny = elements
    across, down = weights_on(box, elements, cells.x, cells.y)

    # cells without weight may hold anything
    on = cells.weight > 0
    weight = np.where(on, cells.weight, 0)
    here_x, here_y = np.where(on, cells.here_x, 0), np.where(on, cells.here_y, 0)
    gxx, gxy, gyy, bx, by = weight * np.where(on, system_of(cells.sums), 0)

    # the solution is the whole displacement: that which the cells already have goes to the right
    data = np.stack([bx + gxx * here_x + gxy * here_y, by + gxy * here_x + gyy * here_y])
    right = down.T @ data @ across

    p = (nx + 3) * (ny + 3)
    blocks = np.zeros((3, ny + 3, nx + 3, ny + 3, nx + 3))
    x, y = pair_up(across), pair_up(down)
    blocks[:, y.first[:, None], x.first, y.second[:, None], x.second] = on_both_sides(
        y.products.T, np.stack([gxx, gxy, gyy]), x.products
    )

    xx, xy, yy = blocks.reshape(3, p, p)
    matrix = np.block([[xx, xy], [xy, yy]])
    return SplineEquations(
        box, elements, matrix, right.reshape(2 * p), _plane(cells, box, elements)
    )


def _plane(cells: Cells, box: Box, elements: tuple[int, int]) -> Array:
    """Spline coefficients (2p,) of the plane nearest to the displacement of the cells."""
    x, y = np.meshgrid(
        (cells.x - box[0]) / (box[1] - box[0]), (cells.y - box[2]) / (box[3] - box[2])
    )
    on = cells.weight > 0
    terms = np.stack([np.ones(on.sum()), x[on], y[on]], axis=1)
    here = np.stack([cells.here_x[on], cells.here_y[on]], axis=1)
    fit = np.linalg.solve(terms.T @ terms + RIDGE * len(terms) * np.eye(3), terms.T @ here)

    # as in `affine_surface`, on the box scaled to 1
    gx, gy = np.meshgrid(*(np.arange(-1, n + 2) / n for n in elements))
    return np.concatenate([(fit[0, k] + fit[1, k] * gx + fit[2, k] * gy).ravel() for k in range(2)])


def solve_surface(system: SplineEquations, *, basis: Array | None = None) -> Surface:
    """Solve for the surface; ``basis`` restricts its coefficients (see `degree_basis`).

    The unknowns are the departures from the plane, so that the ridge pulls towards the plane.
    """
    matrix = system.matrix
    nx, ny = system.elements

    right = system.right - matrix @ system.start
    if basis is not None:
        # both components have the same degree
        both = np.kron(np.eye(2), basis)
        solution = both @ _solve_with_ridge(both.T @ matrix @ both, both.T @ right)
    else:
        solution = _solve_with_ridge(matrix, right)

    solution = solution + system.start
    return Surface(system.box, solution.reshape(2, ny + 3, nx + 3))


def _solve_with_ridge(matrix: Array, right: Array) -> Array:
    """Solve a symmetric system with a ridge; zeros if it is empty."""
    n = len(matrix)
    ridge = RIDGE * np.trace(matrix) / n
    if not ridge > 0:
        return np.zeros(n)
    solution: Array = cho_solve(
        cho_factor(matrix + ridge * np.eye(n), overwrite_a=True, check_finite=False), right
    )
    return solution
