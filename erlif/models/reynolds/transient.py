"""The pin in the swinging bushing, step by step."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.models.reynolds.balance import (
    THINNEST_FILM,
    Medium,
    NoConvergenceError,
    State,
    StepDrive,
    advance,
    displaced,
    forces,
    start_state,
)
from erlif.models.reynolds.cells import Faces, Grid, Walls
from erlif.models.reynolds.journal import (
    Groove,
    Journal,
    Motion,
    Mount,
    as_mount,
    covered,
    turn_vectors,
)

if TYPE_CHECKING:
    import xarray as xr

# Steps above which the compiled form is loaded; it is compiled once on each machine.
FEWEST_COMPILED = 1000

# Bend of a shape, over its largest, below which it is rounding.
_STRAIGHT = 1e-6

# How often a step that does not converge is cut in half.
MOST_HALVINGS = 8


def solve_journal(
    journal: Journal,
    motion: Motion,
    *,
    start: tuple[float, float] = (0.0, 0.0),
    sideways: str | float | Mount = "free",
    cells: tuple[int, int] = (256, 8),
    maps: Sequence[int] | None = None,
    grooves: Sequence[Groove] | None = None,
    frame: str = "half-angle",
    compiled: bool | None = None,
) -> "xr.Dataset":
    """Solve the transient Reynolds equation of a journal bearing with cavitation.

    div(h^3 / (12 eta) grad p) = d[h (1 - th)] / dt in the frame that turns with the mean of both
    surfaces, where nothing is entrained (Booker 1965); the load turns there instead. Pressure and
    void fraction th are complementary, so that mass is conserved where the film ruptures and forms
    again. Finite volumes in space; the flow belongs to the middle of a time step, the void to its
    end.

    Parameters
    ----------
    journal : Journal
        The joint and its oil.
    motion : Motion
        Rotation of the bushing and load at each time.
    start : (float, float)
        Displacement of the pin along the load line and sideways at the first time; the gap is then
        full of oil. [m]
    sideways : str, float or Mount
        "free", "guided" (no sideways motion), a stiffness [N/m], or a mount with a direction.
    cells : (int, int)
        Cells round the joint, an even number, and along half of its length.
    maps : sequence of int, optional
        Steps at which film, pressure and void fraction are returned as maps.
    grooves : sequence of Groove, optional
        Supplies of oil at ambient pressure, at rest in the image. By default one line opposite to
        the load line: the unloaded side is flooded. An infinitely long bearing needs one.
    frame : str
        "half-angle" for the frame above. "laboratory" keeps the entrainment and its numerical
        diffusion, for comparison: an oscillating joint then shows a film that does not exist.
    compiled : bool, optional
        Whether the steps are compiled, where they can be: half-angle frame, no foundation. By
        default above 1000 steps: the first use on a machine takes some seconds.

    Returns
    -------
    xarray.Dataset
        Over `time` (the first value is the start): `displacement_load`, `displacement_side`,
        `film_min` [m], `eccentricity` (over the clearance), `attitude` [rad], `peak_pressure` [Pa],
        `reaction_load`, `reaction_side` (force of the film on the pin against the load and towards
        negative phi) [N], `friction_torque` on the bushing [N m], with the shear of the oil alone
        where the film is partly void, `side_flow` out of both ends, `supply_flow` out of the
        grooves [m3/s], `oil_volume` [m3], `power` dissipated in the film [W], `iterations`. With
        `maps`, over `time_of_map`, `circumference` (distance from the load line) and `axial`:
        `film` [m], `pressure` [Pa], `void_fraction`. Positions, films and voids belong to their
        times; pressures, forces, torque and flows are those of the step that ends there.

    Raises
    ------
    ModelError
        A start outside the clearance, a held pin without a direction, a load that no film carries,
        a step that does not converge.

    Examples
    --------
    A long joint at rest sinks as the closed form of pure squeeze, eps / sqrt(1 - eps^2) = t W / K:

    >>> from erlif.models.reynolds import Journal, Motion
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
    >>> time = np.linspace(0.0, 5.0, 501)
    >>> sunk = solve_journal(joint, Motion(time, angle=0 * time, load=222.4), cells=(64, 1))
    >>> ratio = 5.0 * 222.4 / joint.squeeze_constant
    >>> print(f"{float(sunk.eccentricity[-1]):.3f} {ratio / np.hypot(1, ratio):.3f}")
    0.825 0.826
    """
    bearing = Bearing.of(journal, cells, grooves)
    mount = as_mount(sideways)
    film = TransientFilm(bearing, motion, mount, np.asarray(start, dtype=float), frame)
    wanted = _wanted(maps, motion.time.size)

    steps = motion.time.size
    if compiled is None:
        compiled = steps > FEWEST_COMPILED
    compiled = compiled and film.turning and journal.foundation is None

    # from map to map, so that only their films are kept
    pictures = [(0, *film.picture())] if 0 in wanted else []
    done = 0
    for stop in sorted({*wanted, steps - 1} - {0}):
        while done < stop:
            if compiled:
                done = film.march(done + 1, stop + 1) - 1
            if done < stop:
                done += 1
                film.go_to(done)
                film.record(done)
        if stop in wanted:
            pictures.append((stop, *film.picture()))
    return _dataset(bearing, motion, film.table, pictures)


@dataclass(frozen=True)
class Bearing:
    """The cells of a joint and what they hold constant.

    Attributes
    ----------
    journal : Journal
        The joint.
    medium : Medium
        Cells and oil.
    angles : Array
        Angles of the cells in their own frame, (circumference,). [rad]
    axial : Array
        Places of the cells along the axis from the middle, (axial,). [m]
    rigid : Walls
        The gap of a centred pin. [m]
    grooves : tuple of Groove
        Supplies of oil.
    """

    journal: Journal
    medium: Medium
    angles: Array
    axial: Array
    rigid: Walls
    grooves: tuple[Groove, ...]

    @classmethod
    def of(
        cls, journal: Journal, cells: tuple[int, int], grooves: Sequence[Groove] | None
    ) -> "Bearing":
        """Cells for a joint: half of the length where both halves are alike."""
        around, along_half = (int(number) for number in cells)
        if around < 8 or around % 2 or along_half < 1:
            raise ModelError(
                "cells must be an even number of 8 or more round the joint and 1 or more along the "
                f"axis, got {tuple(cells)}."
            )

        # half of the length where the other half is its image
        edges = axial_edges(journal, along_half)
        halved = edges[0] == 0.0
        grid = Grid(
            along=around,
            dx=2 * np.pi * journal.radius / around,
            dz=np.diff(edges),
            closed=True,
            open_sides=(False, False, not journal.long and not halved, not journal.long),
        )
        medium = Medium(
            grid,
            journal.fluid,
            journal.cavitation_pressure,
            journal.foundation,
            images=2 if halved else 1,
        )
        axial = 0.5 * (edges[1:] + edges[:-1])
        angles = np.arange(float(around)) * (2 * np.pi / around)
        grooves = (Groove(np.pi),) if grooves is None else tuple(grooves)
        return cls(journal, medium, angles, axial, _rigid(journal, grid, axial, edges), grooves)

    @cached_property
    def compass(self) -> tuple[Array, Array]:
        """Directions exp(i angle) of the cells and of the faces before and behind them."""
        centre = np.exp(1j * self.angles)[:, np.newaxis]
        faces = np.exp(1j * (self.angles - np.pi / self.medium.grid.along))[:, np.newaxis]
        return centre, np.concatenate([faces, faces[:1]])

    def directions(self, turned: float, toward: float) -> list[Walls]:
        """Decrease of the gap for a displacement towards a direction and a right angle ahead."""
        centre, faces = (each * np.exp(1j * (turned - toward)) for each in self.compass)
        axes = []
        for middle, edge in ((centre.real, faces.real), (centre.imag, faces.imag)):
            column = np.ascontiguousarray(middle)
            axes.append(Walls(column, np.ascontiguousarray(edge), column))
        return axes


def axial_edges(journal: Journal, along_half: int) -> Array:
    """Edges of cells along the axis; from 0 for half of the length.

    The cells are equal where the bore is straight, bent by straight lines or curved all over;
    otherwise half of them lie where it is curved.
    """
    if journal.long:
        return np.array([-0.5, 0.5]) * journal.length
    half = np.linspace(0.0, 0.5, along_half + 1) * journal.length
    shape = np.zeros(2) if journal.axial_shape is None else np.asarray(journal.axial_shape, float)
    halved = np.array_equal(shape, shape[::-1])
    edges = half if halved else np.concatenate([-half[:0:-1], half])
    bent = np.abs(np.diff(shape, 2))
    curved = bent > _STRAIGHT * bent.max(initial=0.0)
    places = np.linspace(-0.5, 0.5, shape.size) * journal.length
    here = np.pad(curved[1:] & curved[:-1], 1) & (places[1:] > edges[0])
    if not here.any() or curved.all():
        return edges
    share = 0.5 * (edges - edges[0]) / (edges[-1] - edges[0])
    crowded = np.append(0.0, np.cumsum(here)) * (0.5 / here.sum())
    whole = np.interp(places, edges, share) + crowded
    edges[1:-1] = np.interp(2 * share[1:-1], whole, places)
    return edges


def _rigid(journal: Journal, grid: Grid, axial: Array, edges: Array) -> Walls:
    """The gap of a centred pin."""
    if journal.axial_shape is None:
        centre = np.full((grid.along, 1), journal.clearance)
        return Walls(centre, np.full((grid.along + 1, 1), journal.clearance), centre)
    cells, faces = journal.clearance_at(axial), journal.clearance_at(edges)
    return Walls(
        np.tile(cells, (grid.along, 1)),
        np.tile(cells, (grid.along + 1, 1)),
        np.tile(faces, (grid.along, 1)),
    )


def _wanted(maps: Sequence[int] | None, steps: int) -> set[int]:
    """Steps of the maps as numbers from zero."""
    wanted = {int(k) for k in (() if maps is None else maps)}
    outside = [k for k in wanted if not -steps <= k < steps]
    if outside:
        raise ModelError(f"maps must be steps from 0 to {steps - 1}, got {outside[0]}.")
    return {k % steps for k in wanted}


class _Moment(NamedTuple):
    """Time, angle of the bushing, load and its direction."""

    time: float
    angle: float
    load: float
    direction: float


class TransientFilm:
    """The film as it follows a motion, step by step."""

    def __init__(
        self, bearing: Bearing, motion: Motion, mount: Mount, start: Array, frame: str
    ) -> None:
        if frame not in ("half-angle", "laboratory"):
            raise ModelError(f'frame must be "half-angle" or "laboratory", got {frame!r}.')
        self.bearing, self.motion, self.mount = bearing, motion, mount
        self.turning = frame == "half-angle"
        self.toward = mount.direction_for(motion)
        if start.shape != (2,) or not np.isfinite(start).all():
            raise ModelError("start must be two displacements, along the load line and sideways.")
        self.held = turn_vectors(start, -self.toward)
        if mount.rest is not None:
            self.held[1] = mount.rest if mount.guided else self.held[1]
        self.rest = self.held[1] if mount.rest is None else mount.rest
        turning = np.diff(motion.angle) / np.diff(motion.time)
        self.speed = np.concatenate([turning[:1], turning])  # of each step, as its flow and forces

        # the film of the start
        self.instant = self.moment(0, 1.0)
        step = self.step(self.instant, None)
        self.state = start_state(bearing.medium, step, self.held[: len(step.directions)])
        self.earlier: tuple[float, Array] | None = None
        self.halfway = self.turned(self.instant)  # angle of the cells in the middle of the step
        self.supply = 0.0
        if self.state.walls.centre.min() <= 0 or self.state.walls.along.min() <= 0:
            x, y, clearance = 1e6 * start[0], 1e6 * start[1], 1e6 * bearing.journal.clearance
            raise ModelError(
                f"start lies outside the clearance: displacements of {x:.4g} and {y:.4g} um leave "
                f"no film in a clearance of {clearance:.4g} um."
            )
        self.table = {name: np.full(motion.time.size, np.nan) for name in SERIES}
        self.record(0)

    def moment(self, k: int, part: float) -> "_Moment":
        """The motion at a part of the way to a step."""
        motion, before = self.motion, max(k - 1, 0)
        series = (motion.time, motion.angle, motion.load, motion.load_direction)
        return _Moment(*(float(one[before] + part * (one[k] - one[before])) for one in series))

    def turned(self, now: "_Moment") -> float:
        """Angle by which the cells have turned. [rad]"""
        return now.angle / 2 if self.turning else 0.0

    def step(self, now: "_Moment", before: "_Moment | None") -> StepDrive:
        """Input of the solver for the step between two moments; `before` is None at the start."""
        bearing, earlier = self.bearing, before or now
        turned = self.turned(now)
        directions = bearing.directions(turned, self.toward)
        axes = bearing.directions(0.5 * (turned + self.turned(earlier)), self.toward)
        base = bearing.rigid
        target = 0.5 * (self.pull(now) + self.pull(earlier))
        stiffness, rest = np.array([0.0, self.mount.stiffness]), np.array([0.0, self.rest])
        if self.mount.guided:
            base = base.moved(directions.pop(), self.held[1])
            axes, target, stiffness, rest = axes[:1], target[:1], stiffness[:1], rest[:1]

        duration = np.inf if before is None else now.time - before.time
        speed = 0.0
        if before is not None and not self.turning:
            # all belongs to the end of a step with entrainment
            speed = bearing.journal.radius * (now.angle - before.angle) / (2 * duration)
            target = self.pull(now)[: target.size]
        grid = bearing.medium.grid
        supplied = np.zeros(grid.shape, dtype=bool)
        supplied[covered(bearing.grooves, bearing.angles + turned)] = True
        return StepDrive(
            base, directions, axes, target, stiffness, rest, 1 / duration, speed, supplied
        )

    def pull(self, now: "_Moment") -> Array:
        """Load along the direction of free motion and across it. [N]"""
        apart = now.direction - self.toward
        return now.load * np.array([np.cos(apart), np.sin(apart)])

    def go_to(self, k: int) -> None:
        """Advance to a step of the motion, in parts where the whole does not converge."""
        motion = self.motion
        iterations, supply = 0, 0.0  # the supply as a volume
        done, share, halvings = 0.0, 1.0, 0
        while done < 1.0:
            part = min(done + share, 1.0)
            now = self.moment(k, part)
            step = self.step(now, self.instant)
            try:
                state = advance(self.bearing.medium, step, self.state, self.guess(step))
            except NoConvergenceError as error:
                halvings += 1
                share /= 2
                if halvings > MOST_HALVINGS:
                    # a film that the cells resolve doubles within two of them from its minimum
                    cell = 2 * np.pi / self.bearing.medium.grid.along
                    self.refuse_thin_film(now, k, self.bearing.journal.clearance * 2 * cell**2)
                    raise ModelError(
                        f"No film was found at {motion.time[k]:.6g} s (step {k}): {error}"
                    ) from error
                continue

            # the part is done; the next one starts from it with the same share
            supply += state.supply / step.rate
            self.halfway = 0.5 * (self.turned(self.instant) + self.turned(now))
            self.earlier = (now.time - self.instant.time, self.state.position)
            self.instant, self.state = now, state
            iterations += state.iterations
            done = part
            self.refuse_thin_film(now, k, THINNEST_FILM)
        self.iterations = iterations
        self.supply = supply / (motion.time[k] - motion.time[k - 1])

    def refuse_thin_film(self, now: "_Moment", k: int, limit: float) -> None:
        """Refuse a film that is thinner than a limit."""
        film = float(self.bearing.rigid.centre.min() - np.hypot(*self.pin()))
        if self.bearing.journal.foundation is None and film < limit:
            raise ModelError(
                f"No film carries the load at {now.time:.6g} s (step {k}): under {now.load:.4g} N "
                f"it is thinner than {limit * 1e6:.2g} um, which the cells do not resolve. Check "
                "load and viscosity, take more cells round the joint, or end the motion earlier."
            )

    def guess(self, step: StepDrive) -> State:
        """Initial guess of the Newton steps: the last film, extrapolated in position."""
        state = self.state
        if self.earlier is None:
            return state
        duration, position = self.earlier
        ahead = state.position + (state.position - position) / (duration * step.rate)
        film = displaced(step, ahead).centre
        if film.min() < 0.3 * state.walls.centre.min():  # as far as a Newton step may go
            return state
        return replace(state, position=ahead)

    def pin(self) -> Array:
        """Displacement along the load line and sideways."""
        held = self.held.copy()
        held[: self.state.position.size] = self.state.position
        return turn_vectors(held, self.toward)

    def record(self, k: int) -> None:
        """Store the results of step k in the table."""
        bearing, state, table = self.bearing, self.state, self.table
        medium, journal = bearing.medium, bearing.journal
        table["displacement_load"][k], table["displacement_side"][k] = self.pin()
        table["film_min"][k] = min(state.walls.centre.min(), state.walls.along.min())
        table["oil_volume"][k] = medium.images * (state.content @ medium.grid.area).sum()
        if k == 0:
            return
        pressure, _ = medium.fluid.pressure(state.reduced)
        along, across = forces(medium, bearing.directions(self.halfway, 0.0), pressure)
        found = {
            "peak_pressure": pressure.max(),
            "reaction_load": along,
            "reaction_side": across,
            **losses(medium, state, self.speed[k] * journal.radius, journal.radius),
            "supply_flow": self.supply,
            "iterations": self.iterations,
        }
        for name, value in found.items():
            table[name][k] = value

    def march(self, first: int, last: int) -> int:
        """Make steps in compiled form; the first that was not made."""
        from erlif.models.reynolds import compiled  # only here, because numba loads slowly

        bearing, motion, state, mount = self.bearing, self.motion, self.state, self.mount
        medium, grid = bearing.medium, bearing.medium.grid
        fluid, sides = medium.fluid, np.array(grid.open_sides[2:])[:, np.newaxis]
        joint = compiled.CompiledJoint(
            gap_cells=_owned(np.broadcast_to(bearing.rigid.centre[0], grid.across)),
            gap_faces=_owned(np.broadcast_to(bearing.rigid.across[0], grid.across + 1)),
            dx=float(grid.dx),
            dz=_owned(grid.dz),
            images=medium.images,
            radius=bearing.journal.radius,
            ways_across=_owned(grid.ways_across),
            end_weights=_owned(
                np.array(grid.end_weights) * np.concatenate([sides | True, sides], axis=1)
            ),
            viscosity=float(fluid.viscosity),
            pressure_viscosity=float(fluid.pressure_viscosity),
            roughness=float(fluid.roughness),
            floor=medium.floor,
            guided=mount.guided,
            stiffness=float(mount.stiffness),
            rest=float(self.rest),
            toward=float(self.toward),
            grooves=_owned(
                np.reshape([[one.angle, one.width] for one in bearing.grooves], (-1, 2))
            ),
        )
        apart = motion.load_direction - self.toward
        drive = compiled.Drive(
            time=_owned(motion.time),
            turned=_owned(motion.angle / 2),
            speeds=_owned(self.speed * bearing.journal.radius),
            loads=_owned(motion.load * [np.cos(apart), np.sin(apart)]),
        )
        free = state.position.size
        film = compiled.Film(
            position=np.array([*state.position, *self.held[free:]]),
            earlier=np.zeros(3),
            pressure=state.reduced.copy(),
            full=state.full.copy(),
            content=state.content.copy(),
            void=state.void.copy(),
        )
        if self.earlier is not None:
            film.earlier[2], film.earlier[:free] = self.earlier
        rows = np.empty((motion.time.size, len(SERIES)))
        done = compiled.march(first, last, joint, drive, film, rows)
        if done == first:
            return first

        # the film of the last step that was made, and the numbers of all
        made = slice(first, done)
        self.instant, position = self.moment(done - 1, 1.0), film.position[:free]
        step = self.step(self.instant, None)
        self.earlier = (float(film.earlier[2]), film.earlier[:free].copy())
        self.state = State(
            position, film.pressure, film.void, film.full, film.content, displaced(step, position)
        )
        for place, name in enumerate(SERIES):
            self.table[name][made] = rows[made, place]
        for kind in ("displacement", "reaction"):
            load, side = self.table[f"{kind}_load"][made], self.table[f"{kind}_side"][made]
            load[:], side[:] = turn_vectors(np.stack([load, side], axis=-1), self.toward).T
        return int(done)

    def picture(self) -> tuple[Array, Array, Array]:
        """Film, pressure and void fraction at places at rest in the image, whole length."""
        bearing, state = self.bearing, self.state
        pressure, _ = bearing.medium.fluid.pressure(state.reduced)
        fraction = np.clip(state.void / state.walls.centre, 0.0, 1.0)
        turned = self.turned(self.instant)
        shape = fraction.shape
        maps = []
        for values in (state.walls.centre, pressure, fraction):
            whole = np.broadcast_to(values, shape)
            if bearing.medium.images == 2:
                whole = np.concatenate([whole[:, ::-1], whole], axis=1)
            maps.append(at_rest(whole, turned))
        return maps[0], maps[1], maps[2]


def at_rest(values: Array, turned: float) -> Array:
    """Values of turned cells at the angles from -pi of cells at rest, linear between them."""
    columns = values.shape[0]
    place = np.arange(columns) - columns // 2 - turned * columns / (2 * np.pi)
    before = np.floor(place).astype(int)
    share = (place - before)[:, np.newaxis]
    return np.asarray(
        values[before % columns] * (1 - share) + values[(before + 1) % columns] * share
    )


def losses(medium: Medium, state: State, speed: float, radius: float) -> dict[str, float]:
    """Torque on the moving surface, flow out of the ends and heat. [N m; m3/s; W]

    The shear stress at that surface is eta U / h + h/2 dp/dx; a partly void cell has the share of
    its oil (Elrod 1981).
    """
    grid, area = medium.grid, medium.images * medium.grid.area
    walls = state.middle or state.walls
    pressure, _ = medium.fluid.pressure(state.reduced)
    viscosity = medium.fluid.viscosity_at(pressure)
    filled = 1 - np.clip(state.void / state.walls.centre, 0.0, 1.0)
    shear = speed * float(((viscosity * filled / walls.centre) @ area).sum())
    faces = state.faces or Faces(grid, medium.fluid, walls, state.full)
    steps = state.steps or faces.steps(state.reduced)

    # the pressures on both sides of each face; a closed film has its last face twice
    last = -1 if grid.closed else None
    drops = faces.steps(pressure) if medium.fluid.pressure_viscosity else steps
    if not faces.single:
        drops[1][:, [0, -1]] = steps[1][:, [0, -1]]  # to ambient, where viscosity hardly rises
    along = drops[0][:last]
    drag = 0.5 * medium.images * float(((walls.along[:last] * along) @ grid.dz).sum())
    heat = float((faces.along[:last] * steps[0][:last] * along).sum())
    if not faces.single:
        heat += float((faces.across * steps[1] * drops[1]).sum())
    return {
        "friction_torque": radius * (shear + drag),
        "side_flow": medium.images * faces.outflow((steps[0], steps[1])),
        "power": medium.images * heat + speed * shear,
    }


def _owned(values: Any) -> Array:
    """A copy in the one layout for which the steps are compiled."""
    return np.array(values, dtype=float, order="C")


# Variables over time.
SERIES: tuple[str, ...] = tuple(read_table("erlif.models", "variables.toml")["series"])

# Unit and name of each variable.
UNITS: dict[str, tuple[str, str]] = read_table("erlif.models", "variables.toml")["film"]


def _dataset(
    bearing: Bearing,
    motion: Motion,
    table: dict[str, Array],
    pictures: list[tuple[int, Array, Array, Array]],
) -> "xr.Dataset":
    """The results with dimensions, coordinates and units."""
    journal = bearing.journal
    load, side = table["displacement_load"], table["displacement_side"]
    whole = {
        **table,
        "eccentricity": np.hypot(load, side) / journal.clearance,
        "attitude": np.arctan2(side, load),
    }
    if journal.foundation is None and journal.axial_shape is None:
        whole["film_min"] = journal.clearance * (1 - whole["eccentricity"])
    variables: dict[str, Any] = {name: ("time", whole[name]) for name in UNITS if name in whole}
    coordinates: dict[str, Any] = {"time": ("time", motion.time)}
    if pictures:
        dims = ("time_of_map", "circumference", "axial")
        for place, name in enumerate(("film", "pressure", "void_fraction"), start=1):
            variables[name] = (dims, np.stack([picture[place] for picture in pictures]))
        columns = pictures[0][1].shape[0]
        turn = (np.arange(columns) - columns // 2) * (2 * np.pi / columns)
        axial = bearing.axial
        if bearing.medium.images == 2:
            axial = np.concatenate([-axial[::-1], axial])
        times = motion.time[[picture[0] for picture in pictures]]
        places = (times, journal.radius * turn, axial)
        coordinates |= {dim: (dim, values) for dim, values in zip(dims, places, strict=True)}
    return describe_by(UNITS, variables, coordinates)
