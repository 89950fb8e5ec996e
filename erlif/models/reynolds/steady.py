"""The pin under steady rotation, where entrainment and load keep it at one place."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.models.arguments import require_finite, require_positive, require_single
from erlif.models.reynolds.balance import NoConvergenceError, State, Step, forces, settle
from erlif.models.reynolds.journal import Groove, Journal, covered
from erlif.models.reynolds.transient import UNITS, Bearing, losses

if TYPE_CHECKING:
    import xarray as xr

# Eccentricity above which a film is not resolved by any grid in use. [1]
LARGEST_ECCENTRICITY = 0.9999

# Share of the load that keeps the logarithm of a vanishing force finite. [1]
TINY_LOAD = 1e-12


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
        `side_flow` [m3/s], `power` [W].

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

    def step(self, load: Array, rate: float) -> Step:
        """A free pin under a load, or a held one without."""
        none = np.zeros(load.size)
        entrained = self.bearing.journal.radius * self.speed / 2
        axes = self.axes[: load.size]
        return Step(self.rigid, axes, axes, load, none, none, rate, entrained, self.supplied)

    def held_at(self, *place: float) -> State:
        """The steady film of a pin that is held at a place, along the axes."""
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
        """Displacement whose force is the load, with the supply at the largest gap."""
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
