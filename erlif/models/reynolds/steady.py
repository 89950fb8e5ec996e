"""The pin at the place of steady rotation, and the film's stiffness and damping about it."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.models.arguments import require_finite, require_positive, require_single
from erlif.models.reynolds.balance import (
    NoConvergenceError,
    State,
    StepDrive,
    advance,
    forces,
    settle,
)
from erlif.models.reynolds.journal import Groove, Journal, covered
from erlif.models.reynolds.transient import UNITS, Bearing, losses

if TYPE_CHECKING:
    import xarray as xr

# Eccentricity above which a film is not resolved by any grid in use. [1]
LARGEST_ECCENTRICITY = 0.9999

# Share of the load that keeps the logarithm of a vanishing force finite. [1]
TINY_LOAD = 1e-12

# Displacement over the clearance. [1]
SMALL_MOTION = 1e-3

# Velocity over clearance and speed. [1]
SMALL_VELOCITY = 1e-2

# Time of the step that has a velocity, over that of a radian: no cavity changes in it. [1]
SHORT_TIME = 1e-4


def steady_journal(
    journal: Journal,
    *,
    speed: float,
    load: float,
    grooves: Sequence[Groove] | None = None,
    cells: tuple[int, int] = (256, 8),
) -> "xr.Dataset":
    """Find the position of the pin under constant rotation and load.

    Parameters
    ----------
    journal : Journal
        The joint and its oil.
    speed : float
        Speed of the bushing about the resting pin, of either sign. [rad/s]
    load : float
        Load along the load line. [N]
    grooves : sequence of Groove, optional
        Supplies of oil at ambient pressure, at angles from the load line. By default one line at
        the largest gap, as in the charts of Raimondi and Boyd (1958).
    cells : (int, int)
        Cells round the joint and along half of its length.

    Returns
    -------
    xarray.Dataset
        `displacement_load`, `displacement_side`, `film_min` [m], `eccentricity`, `attitude` [rad],
        `peak_pressure` [Pa], `reaction_load`, `reaction_side` [N], `friction_torque` [N m],
        `side_flow` [m3/s], `power` [W]. Voids have the shear of their oil alone; published tables
        take that of the whole gap and have up to 30 % more friction.

    Raises
    ------
    ModelError
        A bushing at rest, or a load that no film carries.

    Examples
    --------
    The joint of Farzaneh (2002) turning steadily would float on a thick film:

    >>> from erlif.models.reynolds import Journal
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, cavitation_pressure=0.0)
    >>> found = steady_journal(joint, speed=2.54, load=222.4)
    >>> print(f"{float(found.film_min) * 1e6:.0f} um")
    123 um
    """
    require_single(speed=speed, load=load)
    require_finite(speed=speed)
    require_positive(load=load)
    if speed == 0:
        raise ModelError("speed must not be zero: a bushing at rest carries no steady load.")
    bearing = Bearing.of(journal, cells, [Groove(np.pi)] if grooves is None else grooves)
    case = Rotation(bearing, speed)
    if grooves is None:
        state, position = case.along_the_gap(load)
    else:
        state, position = case.beside_grooves(load)
    return _describe(case, state, position)


class Rotation:
    """A joint under steady rotation, in the frame at rest."""

    def __init__(self, bearing: Bearing, speed: float) -> None:
        self.bearing, self.speed = bearing, speed
        self.rigid = bearing.rigid
        self.axes = bearing.directions(0.0, 0.0)
        grid = bearing.medium.grid
        self.supplied = np.zeros(grid.shape, dtype=bool)
        self.supplied[covered(bearing.grooves, bearing.angles)] = True

    def step(self, load: Array, rate: float) -> StepDrive:
        """A free pin under a load, or a held one without."""
        none = np.zeros(load.size)
        entrained = self.bearing.journal.radius * self.speed / 2
        axes = self.axes[: load.size]
        return StepDrive(self.rigid, axes, axes, load, none, none, rate, entrained, self.supplied)

    def held_at(self, *place: float) -> State:
        """Solve for the steady film of a pin held at a displacement along the axes."""
        base = self.rigid
        for axis, shift in zip(self.axes, place, strict=False):
            base = base.moved(axis, shift)
        held = replace(self.step(np.zeros(0), 0.0), base=base)
        return settle(self.bearing.medium, held, np.zeros(0), rate=abs(self.speed))

    def force(self, state: State) -> Array:
        """Force of a film on the pin along both axes. [N]"""
        medium = self.bearing.medium
        return forces(medium, self.axes, medium.fluid.pressure(state.reduced)[0])

    def along_the_gap(self, load: float) -> tuple[State, Array]:
        """Find the displacement that carries the load, with the supply at the largest gap."""
        clearance = self.bearing.journal.clearance

        def surplus(eccentricity: float) -> float:
            force = self.force(self.held_at(eccentricity * clearance))
            return float(np.log((np.hypot(*force) + TINY_LOAD * load) / load))

        if surplus(LARGEST_ECCENTRICITY) < 0:
            raise ModelError(
                f"No film carries {load:g} N at {self.speed:g} rad/s: even at an eccentricity of "
                f"{LARGEST_ECCENTRICITY} it carries less."
            )
        found = scipy.optimize.brentq(surplus, 1e-9, LARGEST_ECCENTRICITY, xtol=1e-9, rtol=1e-9)
        state = self.held_at(found * clearance)
        force = self.force(state)
        ahead = -float(np.arctan2(force[1], force[0]))
        return state, found * clearance * np.array([np.cos(ahead), np.sin(ahead)])

    def beside_grooves(self, load: float) -> tuple[State, Array]:
        """Position of a free pin between grooves at rest."""
        start = 0.3 * self.bearing.journal.clearance * np.array([1.0, np.sign(self.speed)])
        step = self.step(np.array([load, 0.0]), 0.0)
        try:
            state = settle(self.bearing.medium, step, start, rate=abs(self.speed))
        except NoConvergenceError as error:
            raise ModelError(f"No film was found for {load:g} N: {error}") from error
        return state, state.position


def _describe(case: Rotation, state: State, position: Array) -> "xr.Dataset":
    """The results with units."""
    journal, medium = case.bearing.journal, case.bearing.medium
    pressure, _ = medium.fluid.pressure(state.reduced)
    force = case.force(state)
    size = float(np.hypot(*position))
    if state.position.size == 0:
        force = np.array([np.hypot(*force), 0.0])  # the load line follows the force
    values = {
        "displacement_load": position[0],
        "displacement_side": position[1],
        "film_min": float(state.walls.centre.min()),
        "eccentricity": size / journal.clearance,
        "attitude": float(np.arctan2(position[1], position[0])),
        "peak_pressure": float(pressure.max()),
        "reaction_load": force[0],
        "reaction_side": force[1],
        **losses(medium, state, case.speed * journal.radius, journal.radius),
    }
    if journal.foundation is None and journal.axial_shape is None:
        values["film_min"] = journal.clearance - size
    return describe_by(UNITS, {name: ((), value) for name, value in values.items()})


def journal_coefficients(
    journal: Journal,
    *,
    speed: float,
    load: float,
    grooves: Sequence[Groove] | None = None,
    cells: tuple[int, int] = (256, 8),
) -> "xr.Dataset":
    """Find the stiffness and damping of a film about the steady place of the pin.

    The change of the force with a displacement is that of steady films; the change with a velocity
    is that of the same film at one instant, in which its cavities stay as they are. Rotor dynamics
    takes such coefficients at every frequency of small motions.

    Parameters
    ----------
    journal : Journal
        The joint.
    speed : float
        Speed of the bushing about the resting pin, not zero. [rad/s]
    load : float
        Load on the pin, positive. [N]
    grooves : sequence of Groove, optional
        Supplies of oil, as for `steady_journal`. The line of supply at the largest gap stays where
        it is.
    cells : (int, int)
        Cells round the joint and along half of its length.

    Returns
    -------
    xarray.Dataset
        `stiffness` [N/m] and `damping` [N s/m] over `force_axis` and `motion_axis`: 0 along the
        load, 1 sideways in the direction of rotation; the force is that of the film against the
        motion. `stiffness_number` K c / W and `damping_number` B c omega / W, `eccentricity` and
        `attitude` [rad].

    Raises
    ------
    ModelError
        A bushing at rest, or a load that no film carries.

    Examples
    --------
    Two axial grooves of 20 degrees, L/D = 1, S = 0.235: Lund and Thomsen (1978) have 2.19 and 7.36
    along the load.

    >>> from erlif.models.reynolds import Groove, Journal
    >>> joint = Journal(0.04995, 0.05005, length=0.1, viscosity=0.02, cavitation_pressure=0.0)
    >>> pair = [Groove(side * np.pi / 2, np.radians(20)) for side in (-1, 1)]
    >>> load = 0.02 * 50 * 0.1 * 0.1 * 500**2 / 0.235
    >>> found = journal_coefficients(
    ...     joint, speed=100 * np.pi, load=load, grooves=pair, cells=(180, 6))
    >>> k, b = found.stiffness_number.values[0, 0], found.damping_number.values[0, 0]
    >>> print(f"{k:.2f} {b:.2f}")
    2.19 7.33
    """
    import xarray as xr  # only here, because models load without it

    found = steady_journal(journal, speed=speed, load=load, grooves=grooves, cells=cells)
    place = np.array([float(found.displacement_load), float(found.displacement_side)])
    if grooves is None:
        grooves = [Groove(float(found.attitude) + np.pi)]
    case = Rotation(Bearing.of(journal, cells, grooves), speed)

    def slopes(size: float, film: Callable[[Array], State]) -> Array:
        """Changes of both forces (force, motion) with motions of a size, by central differences."""
        pairs = ((film(size * one), film(-size * one)) for one in np.eye(2))
        columns = [(case.force(up) - case.force(down)) / (2 * size) for up, down in pairs]
        return np.stack(columns, axis=1)

    steady = case.held_at(*place)
    k = slopes(SMALL_MOTION * journal.clearance, lambda move: case.held_at(*(place + move)))
    quick = SMALL_VELOCITY * journal.clearance * abs(speed)
    b = slopes(quick, lambda velocity: _moving(case, steady, velocity))
    axes = ("force_axis", "motion_axis")
    return xr.Dataset(
        {
            "stiffness": (axes, k, {"units": "N m-1"}),
            "damping": (axes, b, {"units": "N s m-1"}),
            "stiffness_number": (axes, k * journal.clearance / load, {"units": "1"}),
            "damping_number": (axes, b * journal.clearance * abs(speed) / load, {"units": "1"}),
            "eccentricity": found.eccentricity,
            "attitude": found.attitude,
        }
    )


def _moving(case: Rotation, steady: State, velocity: Array) -> State:
    """Solve for the film at an instant at which the pin has a velocity."""
    rate = abs(case.speed) / SHORT_TIME
    film = np.broadcast_to(steady.walls.centre, steady.void.shape)
    thinning = sum(v * axis.centre for v, axis in zip(velocity, case.axes, strict=True))
    before = np.where(steady.void > 0, steady.content, film + thinning / rate)
    step = replace(case.step(np.zeros(0), rate), base=steady.walls)
    return advance(case.bearing.medium, step, replace(steady, content=before))
