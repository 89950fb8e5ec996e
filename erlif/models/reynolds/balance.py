"""One implicit step: pressure, void and the position of the pin, solved together.

In every cell what flows in equals the change of the oil in it. A cell is either full, with a
pressure above that of cavitation, or at the cavitation pressure and partly void (Jakobsson and
Floberg 1957, Olsson 1965). Which cell is which follows from the primal-dual active set method
(Hintermueller, Ito and Kunisch 2002): solve with a guess, then change the cells with a negative
pressure or a negative void. The displacements of a body that carries a load are unknowns of the
same Newton step.

Where nothing is entrained, flow and forces belong to the middle of the step, void and springs to
its end: the film is of second order in time, and neither cavities nor springs can oscillate. With
entrainment all belong to the end (implicit Euler).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.errors import ModelError
from erlif.models.reynolds.cells import Faces, Grid, Stencil, Walls, link_only, solve_ring
from erlif.models.reynolds.flow import SMALLEST_FLUIDITY, Fluid

# Relative size below zero from which a cell changes; rounding alone would change it for ever.
SWITCH_TOLERANCE = 1e-7

# Largest error of the balance of a cell or of a force, relative. One more step squares it.
RESIDUAL_TOLERANCE = 1e-7

# Share of the remaining film by which a Newton step may reduce it anywhere.
LARGEST_APPROACH = 0.7

# Factor between the rates of the steps that approach a steady film.
SLOWING = 0.25

# Rate over that of the first step at which the next step is the steady film. [1]
LOWEST_RATE = 1e-6

# Share of its load with which the film of a soft wall begins. [1]
SMALLEST_SHARE = 1e-4

# Steps from that share to the whole load, each by a factor of 1.4.
LOAD_STEPS = 30

# Cosine to the load from which a wall is taken to approach its oil. [1]
SMALLEST_COSINE = 0.1

# Share of the film by which a pin without resistance moves beyond where it meets oil. [1]
BEYOND = 10 * SWITCH_TOLERANCE

# Film below which oil is no continuum: the size of its molecules. [m]
THINNEST_FILM = 1e-9

# Newton steps until a solution is given up, besides those of moving edges; 3 or 4 are usual.
MOST_ITERATIONS = 60


class NoConvergenceError(ModelError):
    """A step whose equations were not solved; a shorter one may be."""


@dataclass(frozen=True)
class Medium:
    """Properties that are the same in all steps: grid, oil, cavitation and elastic walls.

    Attributes
    ----------
    grid : Grid
        The cells.
    fluid : Fluid
        The oil.
    cavitation_pressure : float
        Pressure of a partly void cell, relative to ambient. [Pa]
    foundation : float or None
        Pressure over deflection of the walls. [Pa/m]
    images : int
        2 where the cells cover half of a symmetric film, else 1.
    """

    grid: Grid
    fluid: Fluid
    cavitation_pressure: float
    foundation: float | None = None
    images: int = 1

    @property
    def floor(self) -> float:
        """Reduced pressure of a partly void cell. [Pa]"""
        return self.fluid.reduced(float(self.cavitation_pressure))


@dataclass(frozen=True)
class State:
    """The film at one time.

    Attributes
    ----------
    position : Array
        Displacements of the body along its free directions, (free,). [m]
    reduced, void, content : Array
        Reduced pressure relative to ambient [Pa], height of the void, and height of the oil as the
        flow conserves it: film less void [m]; all (along, across).
    full : Mask
        Cells without void.
    walls, middle : Walls
        The film, and the film half a step earlier, through which the oil has flown; None without a
        step.
    iterations : int
        Newton steps that it took.
    supply : float
        Flow that supplied cells needed to stay full. [m3/s]
    faces : Faces or None
        Conductances of the film; None where no step has been made.
    steps : tuple of Array
        Differences of the reduced pressure over the faces. [Pa]
    """

    position: Array
    reduced: Array
    void: Array
    full: Mask
    content: Array
    walls: Walls
    middle: Walls | None = None
    iterations: int = 0
    supply: float = 0.0
    faces: Faces | None = None
    steps: tuple[Array, ...] = ()


@dataclass(frozen=True)
class StepDrive:
    """Input of one time step: film, directions of motion, load, spring, rate and speed.

    Attributes
    ----------
    base : Walls
        Film at zero displacement. [m]
    directions : sequence of Walls
        Decrease of the film for a unit displacement, for each free direction. [1]
    axes : sequence of Walls
        The same in the middle of the step: weights of the pressure in the forces. [1]
    load : Array
        Force along each free direction that the film and the springs carry. [N]
    stiffness : Array
        Stiffness of a spring along each direction. [N/m]
    rest : Array
        Position at which that spring is without force. [m]
    rate : float
        One over the time step; zero for a steady film. [1/s]
    speed : float
        Mean speed of both surfaces along the cells. [m/s]
    supplied : Mask
        Cells at ambient pressure, full of oil.
    """

    base: Walls
    directions: Sequence[Walls]
    axes: Sequence[Walls]
    load: Array
    stiffness: Array
    rest: Array
    rate: float
    speed: float
    supplied: Mask


def start_state(medium: Medium, step: StepDrive, position: Array) -> State:
    """A film full of oil at ambient pressure."""
    walls, shape = displaced(step, position), medium.grid.shape
    return State(
        position=position,
        reduced=np.zeros(shape),
        void=np.zeros(shape),
        full=np.ones(shape, dtype=bool),
        content=np.array(np.broadcast_to(walls.centre, shape)),
        walls=walls,
    )


def displaced(step: StepDrive, position: Array) -> Walls:
    """Film between rigid walls at a position."""
    walls = step.base
    for shift, direction in zip(position, step.directions, strict=True):
        walls = walls.moved(direction, shift)
    return walls


def forces(medium: Medium, directions: Sequence[Walls], pressure: Array) -> Array:
    """Force of a pressure along each direction. [N]"""
    area = medium.images * medium.grid.area
    column = pressure @ area
    return np.array(
        [
            column @ each.centre[:, 0]
            if each.is_flat
            else np.vdot(pressure * area, np.broadcast_to(each.centre, pressure.shape))
            for each in directions
        ]
    )


def advance(medium: Medium, step: StepDrive, before: State, guess: State | None = None) -> State:
    """Solve one step.

    Parameters
    ----------
    medium : Medium
        Cells and oil.
    step : StepDrive
        Gap, load and motion at the end of the step.
    before : State
        Film at its beginning.
    guess : State, optional
        Where the Newton steps begin; `before` by default.

    Returns
    -------
    State
        Film at the end of the step.

    Raises
    ------
    NoConvergenceError
        Equations that were not solved within the iterations allowed.
    """
    guess = guess or before
    newton = _Newton(medium, step, before, guess)

    # an edge of a cavity may have to move cell by cell through the film
    most = MOST_ITERATIONS + medium.grid.along + medium.grid.across
    for iteration in range(most):
        changed = newton.switch()
        newton.balances()
        if not changed and newton.is_solved():
            newton.require_pressure()
            return newton.state(iteration)
        newton.move()
    raise NoConvergenceError(
        f"The film was not solved in {most} iterations. A load that the film does not carry is the "
        "usual reason; shorter steps help where load or speed change quickly."
    )


def settle(medium: Medium, step: StepDrive, position: Array, *, rate: float) -> State:
    """The steady film, approached from a full one by ever longer time steps.

    Parameters
    ----------
    medium : Medium
        Cells and oil.
    step : StepDrive
        Gap, load and speed; its own rate is not used.
    position : array, (free,)
        Displacements at the start. [m]
    rate : float
        One over the time in which the film is exchanged. [1/s]

    Returns
    -------
    State
        The steady film.

    Raises
    ------
    NoConvergenceError
        A step that is not solved.
    """
    # a soft wall takes up its load bit by bit, because the film depends on all of the pressure
    soft = medium.foundation is not None and step.load.size > 0
    loads = np.geomspace(SMALLEST_SHARE, 1.0, LOAD_STEPS) if soft else np.ones(1)

    state = start_state(medium, step, position)
    present = rate
    while present > 0:
        present = present * SLOWING if present > LOWEST_RATE * rate else 0.0
        state = advance(medium, replace(step, rate=present, load=loads[0] * step.load), state)
    for share in loads[1:]:
        state = advance(medium, replace(step, rate=0.0, load=share * step.load), state)
    return state


class _Newton:
    """Iterate of one Newton solution, with the residuals of its balances."""

    def __init__(self, medium: Medium, step: StepDrive, before: State, guess: State) -> None:
        self.medium, self.step, self.before = medium, step, before.content
        self.earlier = before.walls
        self.share = 0.5 if step.speed == 0 else 1.0  # of the new film in that of the flow
        self.position = guess.position.copy()
        self.reduced, self.void = guess.reduced.copy(), guess.void.copy()
        self.full = guess.full.copy()
        self.full[step.supplied] = True
        self.reduced[step.supplied] = 0.0
        self.void[step.supplied] = 0.0
        self.storage = medium.grid.area * step.rate
        self.steady = step.rate == 0
        self.still = step.speed == 0
        self.crossing = step.speed * medium.grid.dz
        self.moved()

    def moved(self) -> None:
        """Film and flow at the present position and pressure."""
        medium, step = self.medium, self.step
        self.walls = displaced(step, self.position)
        self.pressure, self.slope = medium.fluid.pressure(self.reduced)
        if medium.foundation is not None:
            # a pressure below that of cavitation is about to be raised to it
            held = np.maximum(self.pressure, medium.cavitation_pressure)
            self.walls = deflected(self.walls, held / medium.foundation, medium.grid)
        if not min(self.walls.centre.min(), self.walls.along.min()) > 0:
            raise NoConvergenceError(
                "The film vanished between the walls. Take more load steps in time, finer cells or "
                "a stiffer foundation."
            )
        self.middle = self.walls if self.share == 1 else halfway(self.earlier, self.walls)
        self.faces = Faces(medium.grid, medium.fluid, self.middle, self.full)
        self.flow()

    def flow(self) -> None:
        """Compute the flow into each cell; without sliding also oil and void from its balance."""
        self.steps = self.faces.steps(self.reduced)
        self.inflow = self.faces.inflow(self.steps)
        if not self.still:
            self.inflow -= self.carried()
            return
        self.oil = self.before + self.inflow / self.storage
        self.void = self.walls.centre - self.oil
        self.void[self.full] = 0.0

    def balances(self) -> None:
        """Errors of the balances of all cells and of the forces."""
        step = self.step
        kept = self.walls.centre - self.void - self.before
        self.error = self.inflow - self.storage * kept
        self.error[step.supplied] = 0.0
        self.carries = forces(self.medium, step.axes, self.pressure)
        spring = step.stiffness * (self.position - step.rest)
        self.missing = step.load - self.carries - spring

    def carried(self) -> Array:
        """Net outflow of each cell by the motion of the surfaces. [m3/s]"""
        grid = self.medium.grid
        along = np.array(np.broadcast_to(self.walls.along, (grid.along + 1, grid.across)))
        along *= self.crossing
        upwind = self.crossing * self.void
        closed = grid.closed
        if self.step.speed > 0:
            along[1:] -= upwind
            along[0] -= upwind[-1] if closed else 0.0
        else:
            along[:-1] -= upwind
            along[-1] -= upwind[0] if closed else 0.0
        return np.asarray(along[1:] - along[:-1])

    def switch(self) -> bool:
        """Exchange cells with a negative pressure or void; whether any were."""
        floor = self.medium.floor
        scale = max(float(np.abs(self.reduced).max()), 1.0)
        empty = self.full & (self.reduced < floor - SWITCH_TOLERANCE * scale)
        fill = ~self.full & (self.void < -SWITCH_TOLERANCE * self.walls.centre)
        if not (empty.any() or fill.any()):
            return False
        self.full &= ~empty
        self.full |= fill
        self.reduced[empty] = floor
        self.void[fill] = 0.0

        # a deflected wall follows the pressure; else the gap is as before
        if self.medium.foundation is not None:
            self.moved()
        else:
            self.pressure, self.slope = self.medium.fluid.pressure(self.reduced)
            self.flow()
        return True

    def is_solved(self) -> bool:
        """Whether all balances hold."""
        turnover = (self.storage + np.abs(self.crossing)) * self.walls.centre
        if (np.abs(self.error) > RESIDUAL_TOLERANCE * turnover).any():
            return False
        if not self.missing.size:
            return True
        # an unloaded film has no scale but its own pressure
        size = max(float(np.linalg.norm(self.step.load)), 1e-3 * float(np.abs(self.carries).max()))
        return float(np.abs(self.missing).max()) <= RESIDUAL_TOLERANCE * max(size, 1e-9)

    def require_pressure(self) -> None:
        """Refuse a reduced pressure that no pressure has."""
        highest = self.medium.fluid.pressure_viscosity * float(self.reduced.max())
        if highest >= 1 - SMALLEST_FLUIDITY:
            raise NoConvergenceError(
                "With Barus' law the pressure grows without bound in this film: its viscosity "
                f"would rise by more than {1 / SMALLEST_FLUIDITY:.0e}. The law holds to about 0.5 "
                "GPa; take a smaller pressure_viscosity or a foundation."
            )

    def move(self) -> None:
        """One Newton step of pressures, voids and displacements."""
        step = self.step
        right = np.empty((1 + len(step.directions), *self.medium.grid.shape))
        np.negative(self.error, out=right[0])
        for change, direction in zip(right[1:], step.directions, strict=True):
            # a displacement takes film away, so all changes have the opposite sign
            flow = self.faces.inflow_change(self.steps, direction.along, direction.across)
            np.subtract(self.share * flow, self.storage * direction.centre, out=change)
            if not self.still:
                change -= self.crossing * (direction.along[1:] - direction.along[:-1])
        unknown = (self.full & ~step.supplied) if self.still else ~step.supplied
        right *= unknown
        moved = solve_ring(self.coefficients(unknown), right)

        # displacements that restore the forces, with the change of pressure that follows
        shift = self.shift(moved)
        delta = moved[0]
        for part, change in zip(shift, moved[1:], strict=True):
            delta += part * change
        share = self.allowed(shift, delta)
        self.position = self.position + share * shift
        if share < 1:
            delta *= share
        if self.still:
            self.reduced += delta
        else:
            self.reduced += np.where(self.full, delta, 0.0)
            self.void += np.where(self.full, 0.0, delta)
        self.moved()

    def shift(self, found: Array) -> Array:
        """Displacements for which the forces balance to first order."""
        if len(found) == 1:
            return np.zeros(0)
        medium, step = self.medium, self.step
        changes = []
        for each in found:
            pressures = each if self.still else np.where(self.full, each, 0.0)
            changes.append(forces(medium, step.axes, pressures * self.slope))
        matrix = np.array(changes[1:]).T + np.diag(step.stiffness)
        if abs(np.linalg.det(matrix)) > 0:
            return np.asarray(np.linalg.solve(matrix, self.missing - changes[0]))
        return self.fall(found)

    def fall(self, found: Array) -> Array:
        """Displacement along the load until oil meets the wall; for a film without resistance."""
        size = float(np.linalg.norm(self.missing))
        empty = ~self.full
        if size > 0 and empty.any():
            toward = self.missing / size
            nearer = sum(
                part * each.centre for part, each in zip(toward, self.step.directions, strict=True)
            )
            nearer = np.broadcast_to(nearer, empty.shape)
            meets = empty & (nearer > SMALLEST_COSINE)
            if meets.any():
                found[:] = 0.0  # the pressures stay until the next solution
                way = (self.void + BEYOND * self.walls.centre)[meets] / nearer[meets]
                return np.asarray(toward * way.min())
        raise NoConvergenceError(
            "The film carries no load in its present position: its pressure does not change with "
            "the position of the body."
        )

    def allowed(self, shift: Array, change: Array) -> float:
        """Share of a Newton step that leaves enough film everywhere."""
        soft = self.medium.foundation
        if soft is None and not shift.size:
            return 1.0
        nearer = np.zeros((1, 1))
        if soft is not None:
            lowest = self.medium.cavitation_pressure - self.pressure
            nearer = -np.maximum(change * self.full * self.slope, np.minimum(lowest, 0.0)) / soft
        for part, each in zip(shift, self.step.directions, strict=True):
            nearer = nearer + part * each.centre
        worst = float((nearer / self.walls.centre).max())
        return 1.0 if worst <= LARGEST_APPROACH else LARGEST_APPROACH / worst

    def coefficients(self, unknown: Mask) -> Stencil:
        """Derivatives of the balances by the unknown of each cell and its neighbours."""
        stencil = self.faces.stencil()
        if self.medium.foundation is not None:
            self.add_deflection(stencil)
        if not self.still:
            self.add_voids(stencil)
        link_only(stencil, unknown)
        return stencil

    def add_deflection(self, stencil: Stencil) -> None:
        """Add the derivatives by the deflection of the walls under pressure to the stencil."""
        grid, faces = self.medium.grid, self.faces
        soft = np.broadcast_to(self.slope, self.reduced.shape) / self.medium.foundation
        along = 0.5 * self.share * faces.along_slope * self.steps[0]
        if not self.still:
            along = along - 0.5 * self.crossing
        stencil.centre[...] += (along[1:] - along[:-1]) * soft
        stencil.centre[...] -= self.storage * soft
        stencil.following[:-1] += along[1:-1] * soft[1:]
        stencil.previous[1:] -= along[1:-1] * soft[:-1]
        if grid.closed:
            stencil.following[-1] += along[-1] * soft[0]
            stencil.previous[0] -= along[0] * soft[-1]
        if faces.single:
            return
        across = 0.5 * self.share * faces.across_slope * self.steps[1]
        stencil.centre[...] += (across[:, 1:] - across[:, :-1]) * soft
        stencil.upper[:, :-1] += across[:, 1:-1] * soft[:, 1:]
        stencil.lower[:, 1:] -= across[:, 1:-1] * soft[:, :-1]

    def add_voids(self, stencil: Stencil) -> None:
        """In the columns of void cells, derivatives by the void in place of the pressure."""
        empty = ~self.full
        closed = self.medium.grid.closed
        ahead, behind = np.roll(empty, -1, axis=0), np.roll(empty, 1, axis=0)
        if not closed:
            ahead[-1] = behind[0] = False
        own = np.broadcast_to(self.storage + np.abs(self.crossing), empty.shape)
        stencil.centre[empty] = own[empty]
        for links, beside, part in (
            (stencil.following, ahead, np.minimum(self.crossing, 0.0)),
            (stencil.previous, behind, -np.maximum(self.crossing, 0.0)),
        ):
            links[beside] = np.broadcast_to(part, empty.shape)[beside]
        stencil.lower[:, 1:][empty[:, :-1]] = 0.0
        stencil.upper[:, :-1][empty[:, 1:]] = 0.0

    def state(self, iterations: int) -> State:
        """Return the solved film, with the oil content that the flow leaves in each cell."""
        supplied = self.step.supplied
        film = np.broadcast_to(self.walls.centre, supplied.shape)
        content = film - self.void if self.steady else self.before + self.inflow / self.storage
        given = self.storage * (film - self.before) - self.inflow
        content[supplied] = film[supplied]
        return State(
            position=self.position,
            reduced=self.reduced,
            void=self.void,
            full=self.full,
            content=content,
            walls=self.walls,
            middle=self.middle,
            iterations=iterations,
            supply=self.medium.images * float(given[supplied].sum()),
            faces=self.faces,
            steps=self.steps,
        )


def halfway(first: Walls, second: Walls) -> Walls:
    """The mean of two gaps."""
    centre = 0.5 * (first.centre + second.centre)
    flat = first.is_flat and second.is_flat
    across = centre if flat else 0.5 * (first.across + second.across)
    return Walls(centre, 0.5 * (first.along + second.along), across)


def deflected(walls: Walls, deflection: Array, grid: Grid) -> Walls:
    """Walls moved apart by a deflection of the cells, half of each neighbour at a face."""
    around = np.pad(deflection, ((1, 1), (0, 0)), mode="wrap" if grid.closed else "constant")
    beside = np.pad(deflection, ((0, 0), (1, 1)))
    along = walls.along + 0.5 * (around[1:] + around[:-1])
    across = walls.across + 0.5 * (beside[:, 1:] + beside[:, :-1])
    return Walls(walls.centre + deflection, along, across)
