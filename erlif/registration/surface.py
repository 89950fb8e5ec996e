"""Smooth displacement surfaces: tensor products of uniform cubic B-splines fitted to the cell sums.

A camera-to-camera map is smooth, so a few coefficients describe the whole frame, where separate
windows would need a vector each. `erlif.registration.selection` decides how many the data support.
The splines are those of de Boor (1978) on equidistant knots.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from scipy.linalg import cho_factor, cho_solve

from erlif.core.arrays import AnyArray, Array, Image
from erlif.registration.matching import EE, WEIGHT

Box = tuple[float, float, float, float]
"""x0, x1, y0, y1 of a rectangle of camera-1 pixels. [px]"""

RIDGE: Final = 1e-9
"""Ridge in parts of the mean diagonal of the normal matrix: far below all that data support."""
LIT_SHARE: Final = 0.25
"""Cells with less than this part of the pixels of a full cell have no weight."""


def spline_weights(
    positions: AnyArray, start: float, stop: float, elements: int
) -> tuple[AnyArray, Array]:
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
    first : array, (n,), int
        Index of the first of the four coefficients.
    weights : array, (n, 4)
        Their weights, which add up to 1.
    """
    # positions beyond the interval stay in the outer element, with u below 0 or above 1
    t = (np.asarray(positions, float) - start) * (elements / (stop - start))
    first = np.clip(np.floor(t), 0, elements - 1).astype(np.int64)

    # the four pieces of the B-spline as polynomials of the place within the element
    u = t - first
    weights = (
        np.stack(
            [(1 - u) ** 3, 4 - 6 * u**2 + 3 * u**3, 1 + 3 * u + 3 * u**2 - 3 * u**3, u**3], axis=-1
        )
        / 6
    )
    return first, weights


def design(positions: AnyArray, start: float, stop: float, elements: int) -> Array:
    """The weights of `spline_weights` as a full matrix (position, coefficient)."""
    first, weights = spline_weights(positions, start, stop, elements)
    matrix = np.zeros((len(first), elements + 3))
    for k in range(4):
        matrix[np.arange(len(first)), first + k] = weights[:, k]
    return matrix


@njit(nogil=True, cache=True, error_model="numpy", fastmath=True)
def _evaluate(
    coefficients: AnyArray,
    first_x: AnyArray,
    weight_x: AnyArray,
    first_y: AnyArray,
    weight_y: AnyArray,
    out: AnyArray,
) -> None:
    """Tensor spline at the grid of positions; ``weight_x`` is (4, x), ``weight_y`` (y, 4)."""
    line = np.empty(coefficients.shape[1])
    for y in range(out.shape[0]):
        j = first_y[y]
        for i in range(line.size):
            line[i] = 0.0
            for k in range(4):
                line[i] += weight_y[y, k] * coefficients[j + k, i]
        for x in range(out.shape[1]):
            # four terms in float64, rounded once
            i = first_x[x]
            value = weight_x[0, x] * line[i] + weight_x[1, x] * line[i + 1]
            out[y, x] = value + weight_x[2, x] * line[i + 2] + weight_x[3, x] * line[i + 3]


@njit(nogil=True, cache=True, error_model="numpy")
def bilinear(values: Image, row: Image, column: Image) -> Image:
    """Interpolate a small float32 table at fractional rows and columns, constant beyond its edges.

    The rows are interpolated once for each output row, then the columns.
    """
    rows, cols = values.shape
    out = np.empty((row.size, column.size), np.float32)
    line = np.empty(cols, np.float32)
    for y in range(row.size):
        t = min(max(row[y], np.float32(0)), np.float32(rows - 1))
        j = min(int(t), rows - 2)
        v = t - np.float32(j)
        for i in range(cols):
            line[i] = values[j, i] + v * (values[j + 1, i] - values[j, i])
        for x in range(column.size):
            t = min(max(column[x], np.float32(0)), np.float32(cols - 1))
            i = min(int(t), cols - 2)
            out[y, x] = line[i] + (t - np.float32(i)) * (line[i + 1] - line[i])
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
        x0, x1, y0, y1 = self.box
        nx, ny = self.elements
        across = design(x, x0, x1, nx)
        down = design(y, y0, y1, ny)
        return down @ self.coefficients[0] @ across.T, down @ self.coefficients[1] @ across.T

    def on_pixels(self, shape: tuple[int, int], *, binning: int = 1) -> tuple[Image, Image]:
        """Displacement (dx, dy) on all pixels of a binned frame, float32. [binned px]

        Binned pixel k covers the pixels from ``k * binning`` and lies at their centre.
        """
        x0, x1, y0, y1 = self.box
        nx, ny = self.elements
        centre = (binning - 1) / 2
        first_x, weight_x = spline_weights(np.arange(shape[1]) * binning + centre, x0, x1, nx)
        first_y, weight_y = spline_weights(np.arange(shape[0]) * binning + centre, y0, y1, ny)

        fields = []
        for c in self.coefficients:
            field = np.empty(shape, np.float32)
            _evaluate(
                np.ascontiguousarray(c / binning),
                first_x,
                weight_x.T.copy(),
                first_y,
                weight_y,
                field,
            )
            fields.append(field)
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
    one = np.linalg.solve(design(t, 0.0, 1.0, 1), power)  # spline coefficients (4,) of each power

    columns = [
        np.outer(one[:, j], one[:, i]).ravel()
        for i in range(4)
        for j in range(4)
        if i + j <= degree
    ]
    return np.linalg.qr(np.stack(columns, axis=1))[0]


@njit(nogil=True, cache=True, error_model="numpy", fastmath=True)
def _assemble(
    sums: AnyArray,
    weight: AnyArray,
    first_x: AnyArray,
    weight_x: AnyArray,
    first_y: AnyArray,
    weight_y: AnyArray,
    here_x: AnyArray,
    here_y: AnyArray,
    matrix: AnyArray,
    right: AnyArray,
) -> None:
    """Add each cell to the normal equations, first along its row and then, row by row, along y.

    ``matrix`` is (xx xy yy, y, x, y, x), ``right`` (component, y, x). The solution is the whole
    displacement: the part that the cells already have, ``here``, goes to the right-hand side.
    """
    rows, cols = weight.shape
    nx = right.shape[2]
    band = np.empty((3, nx + 3, 4))
    line = np.empty((2, nx))

    for r in range(rows):
        band[:] = 0.0
        line[:] = 0.0

        # the equations along x of this row: four weights on each, so a band of four
        for c in range(cols):
            w = weight[r, c]
            if w <= 0:
                continue

            gxx = w * sums[r, c, 0]
            gxy = w * sums[r, c, 1]
            gyy = w * sums[r, c, 2]
            bx = w * sums[r, c, 3] + gxx * here_x[r, c] + gxy * here_y[r, c]
            by = w * sums[r, c, 4] + gxy * here_x[r, c] + gyy * here_y[r, c]
            for p in range(4):
                i = first_x[c] + p
                line[0, i] += weight_x[c, p] * bx
                line[1, i] += weight_x[c, p] * by
                for q in range(p, 4):
                    both = weight_x[c, p] * weight_x[c, q]
                    band[0, i, q - p] += both * gxx
                    band[1, i, q - p] += both * gxy
                    band[2, i, q - p] += both * gyy

        # times the weights along y, with the band unfolded into both triangles
        for p in range(4):
            j = first_y[r] + p
            for i in range(nx):
                right[0, j, i] += weight_y[r, p] * line[0, i]
                right[1, j, i] += weight_y[r, p] * line[1, i]
            for q in range(4):
                k = first_y[r] + q
                both = weight_y[r, p] * weight_y[r, q]
                for m in range(3):
                    for i in range(nx):
                        matrix[m, j, i, k, i] += both * band[m, i, 0]
                        for d in range(1, min(4, nx - i)):
                            matrix[m, j, i, k, i + d] += both * band[m, i, d]
                            matrix[m, j, i + d, k, i] += both * band[m, i, d]


@dataclass(frozen=True)
class Equations:
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


def equations(cells: Cells, elements: tuple[int, int], *, box: Box | None = None) -> Equations:
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
    Equations
        Solved by `solve_surface`.
    """
    box = cells.box if box is None else box
    nx, ny = elements
    first_x, weight_x = spline_weights(cells.x, box[0], box[1], nx)
    first_y, weight_y = spline_weights(cells.y, box[2], box[3], ny)

    p = (nx + 3) * (ny + 3)
    blocks = np.zeros((3, ny + 3, nx + 3, ny + 3, nx + 3))
    right = np.zeros((2, ny + 3, nx + 3))
    _assemble(
        cells.sums,
        cells.weight,
        first_x,
        weight_x,
        first_y,
        weight_y,
        cells.here_x,
        cells.here_y,
        blocks,
        right,
    )

    xx, xy, yy = blocks.reshape(3, p, p)
    matrix = np.block([[xx, xy], [xy, yy]])
    return Equations(box, elements, matrix, right.reshape(2 * p), _plane(cells, box, elements))


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


def solve_surface(system: Equations, *, basis: Array | None = None) -> Surface:
    """Solve for the surface; ``basis`` restricts its coefficients (see `degree_basis`).

    The unknowns are the departures from the plane, so that the ridge pulls towards the plane.
    """
    matrix = system.matrix
    nx, ny = system.elements

    right = system.right - matrix @ system.start
    if basis is not None:
        # both components have the same degree
        both = np.kron(np.eye(2), basis)
        solution = both @ _solve(both.T @ matrix @ both, both.T @ right)
    else:
        solution = _solve(matrix, right)

    solution = solution + system.start
    return Surface(system.box, solution.reshape(2, ny + 3, nx + 3))


def _solve(matrix: Array, right: Array) -> Array:
    """Solve a symmetric system with a ridge; zeros if it is empty."""
    n = len(matrix)
    ridge = RIDGE * np.trace(matrix) / n
    if not ridge > 0:
        return np.zeros(n)
    solution: Array = cho_solve(
        cho_factor(matrix + ridge * np.eye(n), overwrite_a=True, check_finite=False), right
    )
    return solution
