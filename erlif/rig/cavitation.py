"""Orbit of a pin whose film breaks up into oil and cavities; free, guided or on a spring.

In the frame that turns with half the bushing no oil is entrained. In one implicit step of time the
oil content of a cell, its film times the share of oil in it, then follows from the pressures alone:

    rate of content = div(h^3/(12 eta) grad p),  content <= film,  p >= p_cav,

and one of the two holds as an equation in each cell. These conditions are those of the minimum of a
convex quadratic function of the pressure above p_cav, which projected over-relaxation finds. The
oil is conserved whatever the pressure. An elastic liner, whose film rises with the pressure, adds a
term of the cell itself; the conductances of its film are found in rounds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline, interpn

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.speed.kernels import njit
from erlif.rig.orbit import THINNEST, RigidBearing

# Nodes round the circumference, five times denser at the load line than opposite.
AROUND = 96
# Nodes on half of the length, denser towards the end.
ALONG = 12
# Nodes on the whole length of a bore that is not straight, evenly spread.
SHAPED = 81

_CLUSTER = 0.7  # of the mapping a = pi s - q sin(pi s) of evenly spread s
_RELAXATION = 1.95, 0.14  # over-relaxation of an even film, and how much less a thin one needs
_SWEEPS = 20_000  # most sweeps of a pressure
_SETTLED = 1e-8  # largest change in a sweep over the largest pressure
_BALANCED = 1e-5  # force that is left over the load
_ROUNDS = 30  # of one step: places of the pin with one derivative, films of a liner for one place
_NUDGE = 1e-3  # of the film, for the derivative of the forces
_LEAST = 0.5  # of the film of the last trial that the next one keeps
_DEFLECTED = 1e-8  # of the clearance, change of the film in the last round of a liner
_AMPLITUDE, _DECAY = 0.9, 0.56  # of the pressure flow factor without lay. Patir and Cheng (1978)


@njit(cache=True, nogil=True)
def relax_pressure(
    pressure: Array,
    lack: Array,
    around: Array,
    along: Array,
    held: Array,
    compliance: Array,
    cavity: float,
    relaxation: float,
) -> int:
    """Find the pressure over ambient, in place; gives the sweeps, -1 if it failed.

    Minimum over q >= cavity of the quadratic function with gradient
    ``lack + compliance q - sum g (q' - q)`` over the neighbours q'.

    Parameters
    ----------
    pressure : array, (around, along)
        First guess, and the values that are held. The circumference is closed.
    lack : array, (around, along)
        Film that the old content does not fill, times the area of the cell.
    around : array, (around, along)
        Conductance from each node to the next round the circumference.
    along : array, (around, along)
        Conductance from each node to the next along the axis; that of the last column is 0.
    held : array, (around, along)
        1 where the pressure is given.
    compliance : array, (around, along)
        Change of the volume of a cell with its pressure, by elastic walls.
    cavity : float
        Pressure of cavities.
    relaxation : float
        Over-relaxation, 1 to 2.
    """
    rows, columns = pressure.shape
    for sweep in range(_SWEEPS):
        change, largest = 0.0, 0.0
        for i in range(rows):
            before, after = (i - 1) % rows, (i + 1) % rows
            for j in range(columns):
                if held[i, j]:
                    continue
                inflow = around[i, j] * pressure[after, j] + around[before, j] * pressure[before, j]
                conductance = compliance[i, j] + around[i, j] + around[before, j]
                if j > 0:
                    inflow += along[i, j - 1] * pressure[i, j - 1]
                    conductance += along[i, j - 1]
                if j < columns - 1:
                    inflow += along[i, j] * pressure[i, j + 1]
                    conductance += along[i, j]
                old = pressure[i, j]
                new = max(cavity, old + relaxation * ((inflow - lack[i, j]) / conductance - old))
                change = max(change, abs(new - old))
                largest = max(largest, abs(new))
                pressure[i, j] = new
        if change <= _SETTLED * largest:
            return sweep + 1
    return -1


@dataclass(frozen=True)
class _Grid:
    """Nodes in the frame of half the bushing; lengths over the radius.

    Those of one half of the length, or of the whole where the pin is tilted.
    """

    angle: Array  # from the load line at the middle of the stroke, (around,). [rad]
    face: Array  # half-way between each node and the next, (around,). [rad]
    area: Array  # of the cells, (around, along)
    reach: Array  # distance to the next node round the circumference, (around, 1)
    axial: Array  # place along the axis from the middle of the length, (along,)
    width: Array  # of the cells along the axis, (along,)
    pitch: Array  # distance to the next node along the axis, (along - 1,)
    held: Array  # 1 at the ends and along the line opposite to the load, (around, along)


def _lay_grid(bearing: RigidBearing, *, whole: bool) -> _Grid:
    """Lay nodes that are denser near the load line and near the ends, on half of the length."""
    even = -1 + 2 * np.arange(AROUND) / AROUND
    angle = np.pi * even - _CLUSTER * np.sin(np.pi * even)
    between = even + 1 / AROUND
    face = np.pi * between - _CLUSTER * np.sin(np.pi * between)
    reach = np.diff(angle, append=angle[0] + 2 * np.pi)
    breadth = np.diff(face, prepend=face[-1] - 2 * np.pi)

    half = bearing.length / bearing.radius / 2
    place = half * np.sin(np.pi / 2 * np.arange(ALONG) / (ALONG - 1))
    width = np.diff(np.concatenate([[0], (place[1:] + place[:-1]) / 2, [half]]))
    if bearing.shape is not None:
        place = np.linspace(-half, half, SHAPED)
        width = np.gradient(place) * np.where(np.abs(place) < half, 1.0, 0.5)
    elif whole:
        place = np.concatenate([-place[:0:-1], place])
        width = np.concatenate([width[:0:-1], [2 * width[0]], width[1:]])

    held = np.zeros((AROUND, place.size))
    held[0], held[:, -1] = 1, 1
    if whole:
        held[:, 0] = 1
    area, pitch = breadth[:, None] * width, np.diff(place)
    return _Grid(angle, face, area, reach[:, None], place, width, pitch, held)


class _Film:
    """Oil between pin and bushing; films over the clearance, pressures in units of one step."""

    def __init__(
        self,
        bearing: RigidBearing,
        step: float,
        cavity: float,
        place: Array,
        turn: float,
        tilt: float = 0.0,
    ) -> None:
        whole = tilt != 0 or bearing.shape is not None
        self.grid = _lay_grid(bearing, whole=whole)
        self.unit = 12 * bearing.viscosity * (bearing.radius / bearing.clearance) ** 2 / step  # Pa
        self.area = (1 if whole else 2) * bearing.radius**2  # or of both halves of the length [m2]
        self.cavity = cavity / self.unit
        self.lift = tilt * bearing.radius / bearing.clearance * self.grid.axial
        self.form: Array = np.zeros(self.grid.axial.size)
        if bearing.shape is not None:
            self.form = bearing.shape(self.grid.axial * bearing.radius) / bearing.clearance
        self.soft = bearing.compliance * self.unit / bearing.clearance
        self.roughness = bearing.roughness / bearing.clearance
        self.pressure = np.zeros_like(self.grid.area)
        self.content, _ = self.measure(place, turn)
        self.before: Array | None = None

    def measure(self, place: Array, turn: float) -> tuple[Array, Array]:
        """Film over the clearance at the nodes and half-way to the next ones, (around, along)."""
        at_nodes, between = (
            1
            + self.form
            - (place[0] + self.lift) * np.cos(angle + turn)[:, None]
            - place[1] * np.sin(angle + turn)[:, None]
            for angle in (self.grid.angle, self.grid.face)
        )
        return at_nodes, between

    def thicken(self, factor: float) -> None:
        """Multiply the viscosity of the oil by a factor."""
        self.unit *= factor
        self.soft *= factor
        self.cavity /= factor
        self.pressure /= factor

    def carry(self, place: Array, turn: float) -> Array:
        """Forces along the load and sideways [N] if the pin gets to a place over the clearance.

        `turn` is the angle of the frame from the middle of the stroke. [rad]
        """
        grid = self.grid
        rigid, rigid_face = self.measure(place, turn)
        even, less = _RELAXATION
        relaxation = even - less * float(place @ place)
        new, known = self.difference()
        lack = (new * rigid - known) * grid.area
        for _ in range(_ROUNDS):
            before = self.soft * self.pressure
            self._conduct(rigid + before, rigid_face + (before + np.roll(before, -1, axis=0)) / 2)
            sweeps = relax_pressure(
                self.pressure,
                lack,
                self.around,
                self.along,
                grid.held,
                new * self.soft * grid.area,
                self.cavity,
                relaxation,
            )
            deflection = self.soft * self.pressure
            self.film = rigid + deflection
            settled = float(np.abs(deflection - before).max()) <= _DEFLECTED
            if sweeps < 0 or settled:
                break
        if sweeps < 0 or not settled:
            raise ModelError(
                f"The pressure of the film did not settle within {_SWEEPS} sweeps. Choose a higher "
                "viscosity, a stiffer liner or fewer cycles since loading."
            )
        sides = np.stack([np.cos(grid.angle + turn), np.sin(grid.angle + turn)])
        return np.asarray(self.unit * self.area * (sides @ (self.pressure * grid.area).sum(axis=1)))

    def _conduct(self, film: Array, face: Array) -> None:
        """Conductances of a film over the clearance at the nodes and half-way to the next ones."""
        if film.min() < THINNEST:
            raise ModelError(
                "Expected a film that carries the load; the pin touches the bushing. Choose fewer "
                "cycles since loading or a higher viscosity."
            )
        grid, along = self.grid, 0.5 * (film[:, 1:] + film[:, :-1])
        self.around = self._open(face) / grid.reach * grid.width
        self.along = np.zeros_like(grid.area)
        self.along[:, :-1] = self._open(along) * grid.area[:, :1] / grid.width[0] / grid.pitch

    def _open(self, film: Array) -> Array:
        """Cube of a film over the clearance, times what rough walls let through."""
        if self.roughness == 0:
            return film**3
        return film**3 * (1 - _AMPLITUDE * np.exp(-_DECAY * film / self.roughness))

    def advance(self) -> None:
        """Accept the last trial: oil flows between the cells as its pressures drive it."""
        q, grid = self.pressure, self.grid
        round_flow = self.around * (np.roll(q, -1, axis=0) - q)
        inflow = round_flow - np.roll(round_flow, 1, axis=0)
        end_flow = self.along[:, :-1] * np.diff(q, axis=1)
        inflow[:, :-1] += end_flow
        inflow[:, 1:] -= end_flow
        new, known = self.difference()
        content = (known + inflow / grid.area) / new
        self.before = self.content
        self.content = np.where(grid.held > 0, self.film, content)

    def difference(self) -> tuple[float, Array]:
        """Coefficients of the backward difference: weight of the new content, and the old part.

        Backward differences of second order; the first step has only one content to look back to.
        """
        if self.before is None:
            return 1.0, self.content
        return 1.5, 2 * self.content - self.before / 2


class Deflection(NamedTuple):
    """Deflection of a liner at one moment.

    Attributes
    ----------
    angle : Array
        From the load line, rising over a turn, (around,). [rad]
    axial : Array
        Rising places along the axis: of the whole length from its middle, or of one half, (along,).
        [m]
    depth : Array
        (around, along). [m]
    """

    angle: Array
    axial: Array
    depth: Array

    def at(self, phi: Array, axial: Array) -> Array:
        """Deflection at angles from the load line [rad] and places along the axis [m], linear
        between the nodes; 0 beyond the ends of the joint. [m]
        """
        turn = np.append(self.angle, self.angle[0] + 2 * np.pi)
        depth = np.vstack([self.depth, self.depth[:1]])
        place = np.clip(axial if self.axial[0] < 0 else np.abs(axial), *self.axial[[0, -1]])
        around = turn[0] + (phi - turn[0]) % (2 * np.pi)
        return np.asarray(interpn((turn, self.axial), depth, np.stack([around, place], axis=-1)))


def follow_cavitated(
    bearing: RigidBearing,
    time: Array,
    *,
    load: Callable[[float], float],
    angle: Callable[[float], float],
    step: float,
    stiffness: float = 0.0,
    cavity: float = -1e5,
    start: tuple[float, float] = (0.0, 0.0),
    thicker: Callable[[float], float] | None = None,
    tilt: float = 0.0,
    deflections: list[Deflection] | None = None,
) -> Array:
    """Follow the pin from the moment of loading, with a full film at first.

    Other arguments, and what is returned, are those of `erlif.rig.orbit.follow_orbit`; the spring
    is at rest at `start`.

    Parameters
    ----------
    angle : callable
        Angle of the bushing [rad] from the middle of its stroke at a time [s].
    step : float
        Step of time. [s]
    stiffness : float
        Of the mount against sideways motion; infinite where the pin is guided. [N/m]
    cavity : float
        Pressure of cavities over the ambient one, not above 0. [Pa]
    deflections : list, optional
        Receives the deflection of an elastic liner at each time but the first.

    Raises
    ------
    ModelError
        If the pin touches the bushing, or the forces of a step do not balance.
    """
    free = 1 if np.isinf(stiffness) else 2
    spring = 0.0 if np.isinf(stiffness) else stiffness * bearing.clearance
    rest = np.array(start) / bearing.clearance
    film = _Film(bearing, step, cavity, rest, angle(time[0]) / 2, tilt)

    count = int(np.ceil((time[-1] - time[0]) / step)) + 1
    moments = time[0] + step * np.arange(count + 1)
    places = np.empty((moments.size, 2))
    places[0], derivative, thickness = rest, None, 1.0
    depth = np.zeros_like(film.pressure)
    for k, moment in enumerate(moments[1:], start=1):
        turn, weight = angle(moment) / 2, load(moment)
        if thicker is not None:
            thinner, thickness = thickness, thicker(moment)
            film.thicken(thickness / thinner)

        def unbalance(place: Array, turn: float = turn, weight: float = weight) -> Array:
            side = -spring * (place[1] - rest[1])
            left = film.carry(place, turn) - np.array([weight, side])
            return np.asarray(left[:free] / weight)

        guess = places[k - 1] + (places[k - 1] - places[k - 2] if k > 1 else 0)
        play = 1 + float(film.form.min())
        places[k], derivative = _balance(unbalance, places[k - 1], guess, derivative, free, play)
        film.advance()
        if deflections is not None:
            before, depth = depth, bearing.clearance * film.soft * film.pressure
            for one in time[(time > moments[k - 1]) & (time <= moment)]:
                between = before + (one - moments[k - 1]) / step * (depth - before)
                place = film.grid.axial * bearing.radius
                deflections.append(Deflection(film.grid.angle + angle(one) / 2, place, between))
    return np.asarray(bearing.clearance * CubicSpline(moments, places)(time))


def _balance(
    unbalance: Callable[[Array], Array],
    last: Array,
    guess: Array,
    derivative: Array | None,
    free: int,
    play: float,
) -> tuple[Array, Array]:
    """Find the place where the forces balance, by Broyden's method; gives the derivative as well.

    The derivative of the step before serves once more; where it fails, a new one is taken.
    """
    film = play - float(np.hypot(*last))
    for _ in range(2):
        place = guess if derivative is not None else last
        place = _keep_open(last, place, play)
        left = unbalance(place)
        if derivative is None:
            columns = []
            for axis in range(free):
                nudged = place.copy()
                nudged[axis] += _NUDGE * film
                columns.append((unbalance(nudged) - left) / (_NUDGE * film))
            derivative = np.stack(columns, axis=1)

        for _ in range(_ROUNDS):
            if np.abs(left).max() < _BALANCED:
                unbalance(place)  # the film of the place itself is the one to keep
                return place, derivative
            move = np.zeros(2)
            move[:free] = np.linalg.solve(derivative, -left)
            tried = _keep_open(place, place + move, play)
            move = (tried - place)[:free]
            after = unbalance(tried)
            derivative = derivative + np.outer(after - left - derivative @ move, move) / (
                move @ move
            )
            place, left = tried, after
        derivative = None
    raise ModelError(
        "The forces on the pin did not balance. Choose a higher viscosity or another stiffness."
    )


def _keep_open(last: Array, place: Array, play: float) -> Array:
    """Shorten a step of the pin so that it keeps enough of the film."""
    film = play - np.hypot(*last)
    while play - np.hypot(*place) < _LEAST * film:
        place = (last + place) / 2
    return place
