"""The film in cells: where they lie, how flow crosses their faces, what remains in each.

Their linear systems have five neighbours and close round the joint; they are solved as a band.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from erlif.core.arrays import AnyArray, Array, Mask
from erlif.core.errors import ModelError
from erlif.models.reynolds.flow import Fluid


@dataclass(frozen=True)
class Grid:
    """Cells of a film, (along, across), and which of its four sides are open to ambient pressure.

    Along is the sliding direction x, in equal cells; across is the axis z. A film that closes round
    a joint has no sides along; a half of a symmetric film is open on one side across.

    Attributes
    ----------
    along : int
        Number of cells along.
    dx : float
        Size of a cell along. [m]
    dz : Array
        Sizes of the cells across, (across,). [m]
    closed : bool
        Whether the last cell along is the neighbour of the first.
    open_sides : tuple of bool
        Whether flow leaves through the sides at the first and last cell along, and the first and
        last cell across.
    """

    along: int
    dx: float
    dz: Array
    closed: bool
    open_sides: tuple[bool, bool, bool, bool]

    @property
    def across(self) -> int:
        """Number of cells across."""
        return self.dz.size

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of cells along and across."""
        return self.along, self.dz.size

    @cached_property
    def area(self) -> Array:
        """Areas of the cells of a column, (across,). [m2]"""
        return np.asarray(self.dx * self.dz)

    @cached_property
    def ways_along(self) -> Array:
        """Width over length of the flow through the faces along, (along + 1 or 1, across)."""
        ways = np.asarray(self.dz / self.dx)[np.newaxis]
        if self.closed:
            return ways
        ways = np.repeat(ways, self.along + 1, axis=0)
        for side, is_open in ((0, self.open_sides[0]), (-1, self.open_sides[1])):
            ways[side] *= 2.0 if is_open else 0.0  # a side is half a cell from its cell's middle
        return ways

    @cached_property
    def ways_across(self) -> Array:
        """Width over length of the flow through the faces across, (across + 1,)."""
        apart = np.empty(self.across + 1)
        apart[1:-1] = 0.5 * (self.dz[1:] + self.dz[:-1])
        apart[0], apart[-1] = 0.5 * self.dz[0], 0.5 * self.dz[-1]
        ways = self.dx / apart
        ways[0] *= self.open_sides[2]
        ways[-1] *= self.open_sides[3]
        return ways

    @cached_property
    def end_weights(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Weights of the two cells beside an open end in the step of pressure there, for both ends.

        The parabola with ambient pressure at the end and the mean pressures of both cells has the
        slope alpha p1 - beta p2 at the end; the step is half a cell of it.
        """
        if self.across == 1:
            return (1.0, 0.0), (1.0, 0.0)
        weights = []
        for first, second in ((self.dz[0], self.dz[1]), (self.dz[-1], self.dz[-2])):
            ratio = 3 + 3 * second / first + (second / first) ** 2
            beta = 1 / (ratio * first / 2 - first - second / 2)
            weights.append((float(0.5 * first * ratio * beta), float(0.5 * first * beta)))
        return weights[0], weights[1]


@dataclass(frozen=True)
class Walls:
    """The gap between rigid walls at the cells and their faces. [m]

    A gap that does not change across has one column in place of all.

    Attributes
    ----------
    centre : Array
        Film at the cells, (along, across).
    along : Array
        Film at the faces along, (along + 1, across); of a closed film the last is the first.
    across : Array
        Film at the faces across, (along, across + 1).
    """

    centre: Array
    along: Array
    across: Array

    def moved(self, direction: "Walls", distance: float) -> "Walls":
        """The gap after a displacement that takes away `direction` for each unit of it."""
        centre = self.centre - distance * direction.centre
        return Walls(
            centre,
            self.along - distance * direction.along,
            centre
            if self.is_flat and direction.is_flat
            else self.across - distance * direction.across,
        )

    @property
    def is_flat(self) -> bool:
        """Whether the gap does not change across."""
        return self.across is self.centre


def average_walls(film: Array, grid: Grid) -> Walls:
    """Walls of a film that is known at cells of equal size alone, with the mean at the faces."""
    along = np.empty((grid.along + 1, film.shape[1]))
    along[1:-1] = 0.5 * (film[1:] + film[:-1])
    if grid.closed:
        along[0] = along[-1] = 0.5 * (film[0] + film[-1])
    else:
        # linear to the side, from the two cells beside it
        along[0], along[-1] = 1.5 * film[0] - 0.5 * film[1], 1.5 * film[-1] - 0.5 * film[-2]
    if film.shape[1] == 1:
        return Walls(film, along, film)

    across = np.empty((grid.along, grid.across + 1))
    across[:, 1:-1] = 0.5 * (film[:, 1:] + film[:, :-1])
    across[:, 0] = 1.5 * film[:, 0] - 0.5 * film[:, 1]
    across[:, -1] = 1.5 * film[:, -1] - 0.5 * film[:, -2]
    return Walls(film, along, across)


@dataclass(frozen=True)
class Stencil:
    """Coefficients of each cell's own value and of its neighbours' values, all (cell, axial).

    Attributes
    ----------
    centre : Array
        Coefficient of the cell itself.
    previous : Array
        Coefficient of the neighbour before, along the circumference. The first cell and the last
        one are neighbours; in a film that does not close, these links are zero.
    following : Array
        Coefficient of the neighbour behind.
    lower : Array
        Coefficient of the neighbour before, along the axis; ignored in the first row.
    upper : Array
        Coefficient of the neighbour behind; ignored in the last row.
    """

    centre: Array
    previous: Array
    following: Array
    lower: Array
    upper: Array


def solve_ring(stencil: Stencil, right: Array) -> Array:
    """Solve the equations of all cells for several right-hand sides.

    Where two columns are not linked, the ring is cut there and the band is as wide as a column has
    cells. A ring without such a place is folded, so that the cells on both of its arms alternate,
    and the band is twice as wide (LAPACK gbsv).

    Parameters
    ----------
    stencil : Stencil
        Coefficients. The number of columns must be even.
    right : array, (side, cell, axial)
        Right-hand sides.

    Returns
    -------
    array, (side, cell, axial)
        Solutions.

    Raises
    ------
    ModelError
        A singular system.

    Examples
    --------
    Four cells in a row, p'' = -2 between two ends of pressure zero:

    >>> links = np.array([[0.0], [1.0], [1.0], [1.0]])
    >>> none = np.zeros((4, 1))
    >>> row = Stencil(np.full((4, 1), -2.0), links, links[::-1], none, none)
    >>> solve_ring(row, np.full((1, 4, 1), -2.0)).ravel()
    array([4., 6., 6., 4.])
    """
    columns, axial = stencil.centre.shape
    linked = (stencil.previous != 0).any(axis=1)
    linked |= np.roll((stencil.following != 0).any(axis=1), 1)
    if linked.all():
        return _solve_folded(stencil, right)
    cut = int(np.argmin(linked))
    order = (np.arange(columns) + cut) % columns
    band, middle = _columns(stencil, order, axial)
    band[1:, :, middle - axial] += stencil.following[order][:-1]
    band[:-1, :, middle + axial] += stencil.previous[order][1:]
    return _solve_band(band, right, order, axial)


def _solve_folded(stencil: Stencil, right: Array) -> Array:
    """The closed ring, its columns in the order 0, n-1, 1, n-2, and so on."""
    columns, axial = stencil.centre.shape
    half = columns // 2
    order = np.empty(columns, dtype=np.intp)
    order[0::2], order[1::2] = np.arange(half), np.arange(columns - 1, half - 1, -1)
    previous, following = stencil.previous[order], stencil.following[order]
    width = 2 * axial
    band, middle = _columns(stencil, order, width)

    # along one arm the next column is two places on, along the other two places back
    outer, inner = slice(0, columns - 2), slice(2, columns)
    outward, inward = previous.copy(), following.copy()
    outward[1::2], inward[1::2] = following[1::2], previous[1::2]
    band[inner, :, middle - width] = inward[outer]
    band[outer, :, middle + width] = outward[inner]

    # both arms meet at their two ends
    band[1, :, middle - axial] = previous[0]
    band[0, :, middle + axial] = following[1]
    band[-1, :, middle - axial] = following[-2]
    band[-2, :, middle + axial] = previous[-1]
    return _solve_band(band, right, order, width)


def _columns(stencil: Stencil, order: AnyArray, width: int) -> tuple[Array, int]:
    """Band with the links within each column, the columns in an order, and the place of centres.

    LAPACK stores A[i, j] at row middle + i - j of column j; here the columns lie in rows.
    """
    columns, axial = stencil.centre.shape
    middle = 2 * width
    band = np.zeros((columns, axial, 3 * width + 1))
    band[:, :, middle] = stencil.centre[order]
    if axial > 1:
        band[:, 1:, middle - 1] = stencil.upper[order][:, :-1]
        band[:, :-1, middle + 1] = stencil.lower[order][:, 1:]
    return band, middle


def _solve_band(band: Array, right: Array, order: AnyArray, width: int) -> Array:
    """Solve with a band stored by columns, which lie in an order that the sides do not have."""
    columns, axial, rows = band.shape
    sides = right[:, order].reshape(right.shape[0], -1).T
    _, _, found, info = lapack.dgbsv(
        width,
        width,
        band.reshape(columns * axial, rows).T,
        sides,
        overwrite_ab=True,
        overwrite_b=False,
    )
    if info != 0:
        raise ModelError(
            "The equations of the film are singular: no part of it is open to a known pressure. "
            "Give it ends of finite length or a supply."
        )
    result = np.empty(right.shape)
    result[:, order] = found.T.reshape(right.shape)
    return result


class Faces:
    """Conductances of the faces for a film, and the flow that a reduced pressure drives.

    A conductance is the flow in m3/s over the difference of the reduced pressures on both sides.
    """

    def __init__(self, grid: Grid, fluid: Fluid, walls: Walls, full: Mask) -> None:
        self.grid, self.full = grid, full
        mobility, slope = fluid.mobility(walls.along)
        self.along, self.along_slope = mobility * grid.ways_along, slope * grid.ways_along

        # one row of cells without open sides has no flow across at all
        self.single = grid.across == 1 and not any(grid.open_sides[2:])
        if self.single:
            return
        mobility, slope = fluid.mobility(walls.across)
        self.across, self.across_slope = mobility * grid.ways_across, slope * grid.ways_across

    def steps(self, reduced: Array) -> tuple[Array, Array]:
        """Differences of the reduced pressure over the faces along and across; ambient is zero."""
        grid = self.grid
        along = np.empty((grid.along + 1, grid.across))
        np.subtract(reduced[1:], reduced[:-1], out=along[1:-1])
        if grid.closed:
            along[0] = along[-1] = reduced[0] - reduced[-1]
        else:
            along[0], along[-1] = reduced[0], -reduced[-1]
        if self.single:
            return along, along[:0]
        across = np.empty((grid.along, grid.across + 1))
        np.subtract(reduced[:, 1:], reduced[:, :-1], out=across[:, 1:-1])
        across[:, 0], across[:, -1] = self.end_step(reduced, 0), -self.end_step(reduced, -1)
        return along, across

    def end_step(self, reduced: Array, end: int) -> Array:
        """Step of the reduced pressure from ambient to half a cell inside an end.

        It follows the parabola of the last two cells, where the last one is full of oil.
        """
        beside = 1 if end == 0 else -2
        own, other = self.grid.end_weights[end]
        if not (other and self.grid.open_sides[2 + end % 2]):
            return reduced[:, end]
        curved = own * reduced[:, end] - other * reduced[:, beside]
        return np.where(self.full[:, end], curved, reduced[:, end])

    def inflow(self, steps: tuple[Array, Array]) -> Array:
        """Flow into each cell that the pressure drives. [m3/s]"""
        side = None if self.single else self.across * steps[1]
        return _into_cells(self.along * steps[0], side)

    def inflow_change(self, steps: tuple[Array, Array], along: Array, across: Array) -> Array:
        """Change of that inflow with a change of the film at the faces."""
        side = None if self.single else self.across_slope * steps[1] * across
        return _into_cells(self.along_slope * along * steps[0], side)

    def stencil(self) -> Stencil:
        """Coefficients of the inflow for the reduced pressures of a cell and its neighbours."""
        shape = self.grid.shape
        previous = np.array(np.broadcast_to(self.along[:-1], shape))
        following = np.array(np.broadcast_to(self.along[1:], shape))
        centre = -(previous + following)
        lower, upper = np.zeros(shape), np.zeros(shape)
        if not self.single:
            lower, upper = self.across[:, :-1].copy(), self.across[:, 1:].copy()
            centre -= lower
            centre -= upper
            for end, links in ((0, upper), (-1, lower)):
                own, other = self.grid.end_weights[end]
                side = self.across[:, end] * self.full[:, end]
                centre[:, end] -= (own - 1) * side
                links[:, end] += other * side
        if not self.grid.closed:
            previous[0] = following[-1] = 0.0
        return Stencil(centre, previous, following, lower, upper)

    def outflow(self, steps: tuple[Array, Array]) -> float:
        """Flow out of the open sides. [m3/s]"""
        flow = 0.0
        if not self.single:
            flow += float((self.across[:, 0] * steps[1][:, 0]).sum())
            flow -= float((self.across[:, -1] * steps[1][:, -1]).sum())
        if not self.grid.closed:
            flow += float((self.along[0] * steps[0][0]).sum())
            flow -= float((self.along[-1] * steps[0][-1]).sum())
        return flow


def _into_cells(along: Array, across: Array | None) -> Array:
    """Difference of the flows through the faces of each cell, along and across."""
    flow = along[1:] - along[:-1]
    if across is not None:
        flow += across[:, 1:]
        flow -= across[:, :-1]
    return np.asarray(flow)


def link_only(stencil: Stencil, unknown: Mask) -> None:
    """Take cells whose value is known out of the equations, in place."""
    known = ~unknown
    stencil.centre[known] = 1.0
    for links in (stencil.previous, stencil.following, stencil.lower, stencil.upper):
        links[known] = 0.0
    stencil.previous[1:] *= unknown[:-1]
    stencil.previous[0] *= unknown[-1]
    stencil.following[:-1] *= unknown[1:]
    stencil.following[-1] *= unknown[0]
    stencil.lower[:, 1:] *= unknown[:, :-1]
    stencil.upper[:, :-1] *= unknown[:, 1:]
