"""The film in cells: where they lie, how flow crosses their faces, what remains in each."""

from dataclasses import dataclass, field

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.models.reynolds.band import Stencil
from erlif.models.reynolds.flow import Fluid


@dataclass(frozen=True)
class Grid:
    """Cells of equal size, (along, across), and which of the four sides are open to a pressure.

    Along is the sliding direction x, across the axis z. A film that closes round a joint has no
    sides along; a half of a symmetric film is open on one side across.

    Attributes
    ----------
    along : int
        Number of cells along.
    across : int
        Number of cells across.
    dx : float
        Size of a cell along. [m]
    dz : float
        Size of a cell across. [m]
    closed : bool
        Whether the last cell along is the neighbour of the first.
    open_sides : tuple of bool
        Whether flow leaves through the sides at the first and last cell along, and the first and
        last cell across.
    area : float
        Area of a cell. [m2]
    """

    along: int
    across: int
    dx: float
    dz: float
    closed: bool
    open_sides: tuple[bool, bool, bool, bool]
    area: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "area", self.dx * self.dz)


@dataclass(frozen=True)
class Walls:
    """The gap between rigid walls at the cells and their faces. [m]

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
        return Walls(
            self.centre - distance * direction.centre,
            self.along - distance * direction.along,
            self.across - distance * direction.across,
        )


def average_walls(film: Array, grid: Grid) -> Walls:
    """Walls of a film that is known at the cells alone, with the mean at the faces."""
    along = np.empty((grid.along + 1, grid.across))
    along[1:-1] = 0.5 * (film[1:] + film[:-1])
    if grid.closed:
        along[0] = along[-1] = 0.5 * (film[0] + film[-1])
    else:
        # linear to the side, from the two cells beside it
        along[0], along[-1] = 1.5 * film[0] - 0.5 * film[1], 1.5 * film[-1] - 0.5 * film[-2]
    across = np.empty((grid.along, grid.across + 1))
    across[:, 1:-1] = 0.5 * (film[:, 1:] + film[:, :-1])
    if grid.across > 1:
        across[:, 0] = 1.5 * film[:, 0] - 0.5 * film[:, 1]
        across[:, -1] = 1.5 * film[:, -1] - 0.5 * film[:, -2]
    else:
        across[:, 0] = across[:, -1] = film[:, 0]
    return Walls(film, along, across)


class Faces:
    """Conductances of the faces for a film, and the flow that a reduced pressure drives.

    A conductance is the flow in m3/s over the difference of the reduced pressures on both sides.
    """

    def __init__(self, grid: Grid, fluid: Fluid, walls: Walls) -> None:
        self.grid = grid
        mobility, slope = fluid.mobility(walls.along)
        self.along, self.along_slope = mobility * (grid.dz / grid.dx), slope * (grid.dz / grid.dx)
        start, end, lower, upper = grid.open_sides
        if not grid.closed:
            _close_sides(self.along, self.along_slope, start, end)

        # one row of cells without open sides has no flow across at all
        self.flat = grid.across == 1 and not (lower or upper)
        if self.flat:
            self.across = self.across_slope = np.zeros(walls.across.shape)
            return
        mobility, slope = fluid.mobility(walls.across)
        self.across = mobility * (grid.dx / grid.dz)
        self.across_slope = slope * (grid.dx / grid.dz)
        _close_sides(self.across.T, self.across_slope.T, lower, upper)

    def steps(self, reduced: Array) -> tuple[Array, Array]:
        """Differences of the reduced pressure over the faces along and across; ambient is zero."""
        grid = self.grid
        along = np.empty((grid.along + 1, grid.across))
        np.subtract(reduced[1:], reduced[:-1], out=along[1:-1])
        if grid.closed:
            along[0] = along[-1] = reduced[0] - reduced[-1]
        else:
            along[0], along[-1] = reduced[0], -reduced[-1]
        if self.flat:
            return along, np.zeros((grid.along, grid.across + 1))
        across = np.empty((grid.along, grid.across + 1))
        np.subtract(reduced[:, 1:], reduced[:, :-1], out=across[:, 1:-1])
        across[:, 0], across[:, -1] = reduced[:, 0], -reduced[:, -1]
        return along, across

    def inflow(self, steps: tuple[Array, Array]) -> Array:
        """Flow into each cell that the pressure drives. [m3/s]"""
        flow = np.diff(self.along * steps[0], axis=0)
        if not self.flat:
            flow += np.diff(self.across * steps[1], axis=1)
        return flow

    def inflow_change(self, steps: tuple[Array, Array], along: Array, across: Array) -> Array:
        """Change of that inflow with a change of the film at the faces."""
        flow = np.diff(self.along_slope * steps[0] * along, axis=0)
        if not self.flat:
            flow += np.diff(self.across_slope * steps[1] * across, axis=1)
        return flow

    def stencil(self) -> Stencil:
        """Coefficients of the inflow for the reduced pressures of a cell and its neighbours."""
        before, behind = self.along[:-1], self.along[1:]
        centre = -(before + behind)
        lower, upper = self.across[:, :-1], self.across[:, 1:]
        if not self.flat:
            centre -= lower + upper
        previous, following = before.copy(), behind.copy()
        if not self.grid.closed:
            previous[0] = following[-1] = 0.0
        return Stencil(centre, previous, following, lower.copy(), upper.copy())

    def outflow(self, steps: tuple[Array, Array]) -> float:
        """Flow out of the open sides. [m3/s]"""
        flow = float((self.across[:, 0] * steps[1][:, 0]).sum())
        flow -= float((self.across[:, -1] * steps[1][:, -1]).sum())
        if not self.grid.closed:
            flow += float((self.along[0] * steps[0][0]).sum())
            flow -= float((self.along[-1] * steps[0][-1]).sum())
        return flow


def _close_sides(conductance: Array, slope: Array, first: bool, last: bool) -> None:
    """No flow through closed sides; an open one is half a cell away from the middle of its cell."""
    for side, is_open in ((0, first), (-1, last)):
        factor = 2.0 if is_open else 0.0
        conductance[side] *= factor
        slope[side] *= factor


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
