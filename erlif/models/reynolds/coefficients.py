"""Stiffness and damping of a film for small motions of the pin about its steady place."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from erlif.core.arrays import Array
from erlif.models.reynolds.balance import State, advance
from erlif.models.reynolds.journal import Groove, Journal
from erlif.models.reynolds.steady import Rotation, steady_journal
from erlif.models.reynolds.transient import Bearing

if TYPE_CHECKING:
    import xarray as xr

# Displacement over the clearance. [1]
SMALL_MOTION = 1e-3

# Velocity over clearance and speed. [1]
SMALL_VELOCITY = 1e-2

# Time of the step that has a velocity, over that of a radian: no cavity changes in it. [1]
SHORT_TIME = 1e-4


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
    """That film at an instant in which the pin has a velocity."""
    rate = abs(case.speed) / SHORT_TIME
    film = np.broadcast_to(steady.walls.centre, steady.void.shape)
    thinning = sum(v * axis.centre for v, axis in zip(velocity, case.axes, strict=True))
    before = np.where(steady.void > 0, steady.content, film + thinning / rate)
    step = replace(case.step(np.zeros(0), rate), base=steady.walls)
    return advance(case.bearing.medium, step, replace(steady, content=before))
