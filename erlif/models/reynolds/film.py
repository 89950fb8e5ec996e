"""Pressure in a film whose shape is given: sliders, plates, rollers, a measured map."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.models.arguments import Values, for_each, formula, warn_of_units
from erlif.models.reynolds.balance import (
    Medium,
    NoConvergenceError,
    State,
    StepDrive,
    advance,
    forces,
    settle,
    start_state,
)
from erlif.models.reynolds.cells import Grid, Walls, average_walls
from erlif.models.reynolds.flow import Fluid, check_cavitation
from erlif.models.reynolds.transient import UNITS, losses

if TYPE_CHECKING:
    import xarray as xr

# Time of the step from a given rate, over that in which the surfaces cross the film. [1]
SHORT_TIME = 1e-6


@formula(length="number", width="number", entrainment="speed", cavitation_pressure="signed number")
def solve_film(
    film: Values,
    *,
    length: float,
    viscosity: float,
    width: float | None = None,
    entrainment: Values = 0.0,
    film_rate: Values = None,
    void_fraction: Values = None,
    time: Values = None,
    load: Values = None,
    pressure_viscosity: float = 0.0,
    cavitation_pressure: float = -1e5,
    roughness: float | None = None,
    foundation: float | None = None,
    closed: bool = False,
) -> "xr.Dataset":
    """Solve the Reynolds equation with cavitation for a film of given shape.

    div(h^3 / (12 eta) grad p) = u d[h (1 - th)] / dx + d[h (1 - th)] / dt. Without `time` and
    `film_rate` the film is steady. With `time` the films follow each other, the first one full of
    oil. With `film_rate` the pressure of one instant is found for a film without a history: oil
    leaves the walls where the pressure would fall below that of cavitation, but no cavity is older
    than the instant.

    Parameters
    ----------
    film : array, (x,) or (x, z), with `time` (time, x) or (time, x, z)
        Film thickness at the middle of equal cells that cover length and width. x is the direction
        of sliding. [m]
    length : float
        Extent along x. [m]
    viscosity : float
        Viscosity at ambient pressure. [Pa s]
    width : float, optional
        Extent along z. Without it the film is infinitely wide, and forces are per metre of width.
        [m]
    entrainment : float or array, (time,)
        Mean of the speeds of both surfaces along x. [m/s]
    film_rate : array, optional
        Rate of change of the film, of its shape. [m/s]
    void_fraction : array, optional
        With `film_rate`: share of void in each cell from before, as a film with `time` has it. [1]
    time : array, (time,), optional
        Times of the films. [s]
    load : float or array, (time,), optional
        Load that the film carries. The given film is then the shape, from which the surfaces
        approach each other until the load is carried. [N, or N/m without a width]
    pressure_viscosity : float
        Coefficient of Barus' law. [1/Pa]
    cavitation_pressure : float
        Pressure at which the film ruptures, relative to ambient. [Pa]
    roughness : float, optional
        Combined rms roughness of both surfaces. [m]
    foundation : float, optional
        Pressure over deflection of an elastic liner. [Pa/m]
    closed : bool
        Whether the film closes round a joint, its last cell along x beside its first.

    Returns
    -------
    xarray.Dataset
        Over x (and z, time): `film` [m], `pressure` above ambient [Pa], `void_fraction`. For the
        whole film (over time): `force` [N], `force_position` along x [m], `peak_pressure` [Pa],
        `approach` [m] where a load was given, `friction_force` on the surface that moves at twice
        the entrainment beside a resting one [N], `side_flow` out of all sides [m3/s], `power` [W],
        `oil_volume` [m3]. In a series of films without entrainment, pressures, forces and flows are
        those in the middle of the step that ends at a time.

    Raises
    ------
    ModelError
        A film that is not positive and finite, arrays whose shapes do not fit, a steady film
        without entrainment, a load that no film carries.

    Examples
    --------
    An infinitely wide plane slider of film ratio 2.2 carries Rayleigh's (1918) 0.1602:

    >>> x = (np.arange(400) + 0.5) / 400
    >>> found = solve_film(1e-5 * (2.2 - 1.2 * x), length=1.0, viscosity=0.1, entrainment=0.5)
    >>> print(f"{float(found.force) * 1e-5**2 / (0.1 * 1.0):.4f}")
    0.1602
    """
    films = _checked_films(film, time)
    number = films.shape[0]
    times = np.zeros(1) if time is None else np.asarray(time, dtype=float)
    speeds = for_each(number, "film", entrainment=entrainment)
    loads = None if load is None else for_each(number, "film", load=load)
    check_cavitation(cavitation_pressure)
    fluid = Fluid(float(viscosity), float(pressure_viscosity), float(roughness or 0.0))
    grid = _grid(films.shape[1:], length, width, closed)
    medium = Medium(grid, fluid, float(cavitation_pressure), foundation)
    course = _Course(medium, films, times, speeds, loads)

    if time is not None:
        if film_rate is not None or void_fraction is not None:
            raise ModelError(
                "film_rate and void_fraction belong to one instant: give them without time."
            )
        states = course.follow()
    elif film_rate is None:
        states = [course.steady()]
    else:
        rate = np.asarray(film_rate, dtype=float).reshape(films.shape[1:])
        void = np.zeros_like(rate) if void_fraction is None else _checked_void(void_fraction, rate)
        states = [course.instant(rate, void)]
    return _dataset(course, states, with_time=time is not None, wide=width is None)


def _checked_films(film: Values, time: Values) -> Array:
    """The films as (time, along, across)."""
    films = np.array(film, dtype=float)
    if time is None:
        films = films[np.newaxis]
    if films.ndim == 2:
        films = films[:, :, np.newaxis]
    if films.ndim != 3 or films.shape[1] < 4:
        raise ModelError(
            "film must be an array (x,) or (x, z) of four or more cells along x, with time (time, "
            f"x) or (time, x, z); got shape {np.shape(film)}."
        )
    if not (np.isfinite(films).all() and (films > 0).all()):
        raise ModelError("film must be positive and finite in every cell; fill gaps of a map.")
    if time is not None:
        times = np.asarray(time, dtype=float)
        if times.shape != films.shape[:1] or times.size < 2 or not (np.diff(times) > 0).all():
            raise ModelError(
                f"time must hold {films.shape[0]} increasing values, one for each film, got shape "
                f"{times.shape}."
            )
    warn_of_units("film", film=films)
    return films


def _checked_void(void_fraction: Values, film_rate: Array) -> Array:
    """The share of void in each cell."""
    void = np.asarray(void_fraction, dtype=float)
    if void.size != film_rate.size or not ((void >= 0) & (void <= 1)).all():
        raise ModelError(
            f"void_fraction must hold values from 0 to 1 for {film_rate.size} cells, got shape "
            f"{void.shape}."
        )
    return void.reshape(film_rate.shape)


def _grid(shape: tuple[int, ...], length: float, width: float | None, closed: bool) -> Grid:
    """Cells of a film; one of infinite width is a metre wide and closed across."""
    along, across = shape
    if closed and along % 2:
        raise ModelError(f"A closed film needs an even number of cells along x, got {along}.")
    if width is None and across > 1:
        raise ModelError("A film (x, z) needs a width.")
    sides = (not closed, not closed, width is not None, width is not None)
    widths = np.full(across, (width or 1.0) / across)
    return Grid(along, length / along, widths, closed, sides)


@dataclass(frozen=True)
class _Course:
    """A film or a series of films, with its times, speeds and loads."""

    medium: Medium
    films: Array
    times: Array
    speeds: Array
    loads: Array | None

    @property
    def unit(self) -> Walls:
        """Decrease of the film for a unit approach: one everywhere."""
        return average_walls(np.ones(self.films.shape[1:]), self.medium.grid)

    def step(self, k: int, rate: float) -> StepDrive:
        """Input of the solver for film k."""
        free = 0 if self.loads is None else 1
        none = np.zeros(free)
        load = none if self.loads is None else self.loads[k : k + 1]
        return StepDrive(
            average_walls(self.films[k], self.medium.grid),
            [self.unit][:free],
            [self.unit][:free],
            load,
            none,
            none,
            rate,
            float(self.speeds[k]),
            np.zeros(self.films.shape[1:], dtype=bool),
        )

    def steady(self) -> State:
        """Solve for the steady film."""
        speed = abs(float(self.speeds[0]))
        if speed == 0:
            raise ModelError(
                "A steady film needs an entrainment; for squeeze give film_rate or time."
            )
        crossing = speed / (self.medium.grid.along * self.medium.grid.dx)
        step = self.step(0, 0.0)
        return settle(self.medium, step, np.zeros(step.load.size), rate=crossing)

    def instant(self, film_rate: Array, void: Array) -> State:
        """Solve for the film at a given rate of change, from a given share of void."""
        if self.loads is not None:
            raise ModelError("A film with a given rate carries what it does: give no load.")
        grid, film = self.medium.grid, self.films[0]

        # a step so short that no void moves, and that no rate takes more than a little film away
        extent = grid.along * grid.dx
        quickest = max(float(np.abs(film_rate / film).max()), abs(self.speeds[0]) / extent, 1e-12)
        rate = quickest / SHORT_TIME
        step = self.step(0, rate)
        before = start_state(self.medium, step, np.zeros(0))
        content = np.where(void > SHORT_TIME, film * (1 - void), film - film_rate / rate)
        return advance(self.medium, step, replace(before, content=content))

    def follow(self) -> list[State]:
        """The films one after the other."""
        first = self.step(0, 0.0)
        states = [start_state(self.medium, first, np.zeros(first.load.size))]
        for k in range(1, self.times.size):
            step = self.step(k, 1 / (self.times[k] - self.times[k - 1]))
            try:
                states.append(advance(self.medium, step, states[-1]))
            except NoConvergenceError as error:
                raise ModelError(
                    f"No film was found at {self.times[k]:.6g} s (film {k}): {error}"
                ) from error
        return states


def _dataset(course: _Course, states: list[State], *, with_time: bool, wide: bool) -> "xr.Dataset":
    """The results with dimensions, coordinates and units."""
    medium, grid = course.medium, course.medium.grid
    x = (np.arange(grid.along) + 0.5) * grid.dx
    rows: list[dict[str, Any]] = []
    for k, state in enumerate(states):
        pressure = np.array(medium.fluid.pressure(state.reduced)[0])
        (force,) = forces(medium, [course.unit], pressure)
        moment = float(x @ pressure @ grid.area)
        lost = losses(medium, state, 2 * float(course.speeds[k]), 1.0)
        row: dict[str, Any] = {
            "film": np.broadcast_to(state.walls.centre, grid.shape),
            "pressure": pressure,
            "void_fraction": np.clip(state.void / state.walls.centre, 0.0, 1.0),
            "force": force,
            "force_position": moment / force if force else np.nan,
            "peak_pressure": pressure.max(),
            "friction_force": lost["friction_torque"],
            "side_flow": lost["side_flow"],
            "power": lost["power"],
            "oil_volume": float((state.content @ grid.area).sum()),
        }
        if course.loads is not None:
            row["approach"] = state.position[0]
        rows.append(row)

    cells = ("x",) if wide else ("x", "z")
    variables: dict[str, Any] = {}
    for name in rows[0]:
        values = np.stack([np.asarray(row[name]) for row in rows])
        dims = ("time", *cells) if values.ndim == 3 else ("time",)
        values = values[..., 0] if values.ndim == 3 and wide else values
        variables[name] = (dims, values) if with_time else (dims[1:], values[0])
    coordinates: dict[str, Any] = {"x": ("x", x)}
    if not wide:
        coordinates["z"] = ("z", (np.arange(grid.across) + 0.5) * grid.dz[0])
    if with_time:
        coordinates["time"] = ("time", course.times)
    return describe_by(UNITS, variables, coordinates)
