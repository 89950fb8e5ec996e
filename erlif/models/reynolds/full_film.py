"""The orbit of a pin that is free sideways, in a full film: no cavities and no entrainment.

In the frame that turns with half the bushing angle the film is squeezed and nothing else (Booker
1965). Without cavities the forces are proportional to the velocities of the pin, by two dampings
that depend on the eccentricity alone. The orbit is then an ordinary differential equation of two
numbers, a thousand times quicker than the film itself, and many orbits are followed at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.reynolds.journal import Journal, Motion, turn_vectors
from erlif.models.reynolds.squeeze_tables import THINNEST, tabulate_squeeze

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline  # loads scipy.optimize: imported where it is used

_RESOLUTION = 5e-4  # error of angle and load between the steps of the orbit, relative to their size
_LONGEST_STEP = 8  # steps of the motion in one of the orbit
LARGEST_FALL = 0.25  # share of the film by which the pin moves in a step without parts


@dataclass(frozen=True)
class FullFilm:
    """Dampings of a full film.

    The pressure is ambient at both ends, and along the thickest film, which is flooded.

    Attributes
    ----------
    unit : float
        eta L (R/c)^3, the unit of the dampings. [N s/m]
    stress : float
        eta R^2 / c^3, the unit of pressure over velocity. [Pa s/m]
    table : CubicSpline
        Over -log(film/clearance): logarithms of the dampings along and across the line of centres.
    suction : CubicSpline
        Over the same, logarithm of the depth of the lowest pressure of either motion.
    """

    unit: float
    stress: float
    table: CubicSpline
    suction: CubicSpline

    @classmethod
    def of(cls, journal: Journal) -> FullFilm:
        """The full film of a joint with rigid walls.

        Parameters
        ----------
        journal : Journal
            Its pressure viscosity is left out. Where it has a shape along the axis, its clearance
            below is the least one.

        Returns
        -------
        FullFilm

        Raises
        ------
        ModelError
            An elastic liner.

        Examples
        --------
        A long film between circles that touch nearly, 12 pi / (1 - eps^2)^1.5:

        >>> from erlif.models.reynolds import Journal
        >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
        >>> along, across = FullFilm.of(joint).damping(np.array([0.1])).ravel() * joint.clearance
        >>> print(f"{along / joint.squeeze_constant * (1 - 0.9**2) ** 1.5:.5f}")
        1.00000
        """
        if journal.foundation is not None:
            raise ModelError(
                "The orbit in a full film is that of rigid walls; the joint has an elastic liner. "
                "Use solve_journal."
            )
        clearance, radius = journal.least_clearance, journal.radius
        return cls(
            journal.viscosity * journal.length * (radius / clearance) ** 3,
            journal.viscosity * radius**2 / clearance**3,
            *tabulate_squeeze(journal),
        )

    def damping(self, film: Array) -> Array:
        """Force over velocity along and across the line of centres.

        Parameters
        ----------
        film : array, (...)
            Minimum film thickness over the clearance.

        Returns
        -------
        array, (..., direction)
            [N s/m]
        """
        thin = -np.log(np.clip(film, THINNEST, 1.0))
        return np.asarray(self.unit * np.exp(self.table(thin)))

    def lowest_pressure(self, film: Array, force: Array) -> Array:
        """A bound of the lowest pressure in the film, relative to ambient.

        Parameters
        ----------
        film : array, (...)
            Minimum film thickness over the clearance.
        force : array, (..., direction)
            Force on the pin along and across the line of centres. [N]

        Returns
        -------
        array, (...)
            [Pa]
        """
        thin = -np.log(np.clip(film, THINNEST, 1.0))
        velocity = np.abs(force) / (self.unit * np.exp(self.table(thin)))
        return np.asarray(-self.stress * (velocity * np.exp(self.suction(thin))).sum(axis=-1))


def follow_full_film(
    journal: Journal,
    motion: Motion,
    *,
    start: Array,
    fluidity: Array | float = 1.0,
    stiffness: Array | float = 0.0,
    rest: Array | float = 0.0,
) -> Array:
    """Follow pins of different start, viscosity and spring through one motion.

    Along and across the line of centres the velocity in the half-angle frame is force over damping.
    Runge-Kutta's rule of the fourth order, with the cubic of values and slopes between its steps.

    Parameters
    ----------
    journal : Journal
        The joint.
    motion : Motion
        Rotation of the bushing and load at each time.
    start : array, (case, axis)
        Displacement along the load line and sideways at the first time. [m]
    fluidity : array, (case,), or float
        Viscosity of the joint over that of the case.
    stiffness, rest : array, (case,), or float
        Sideways spring [N/m], and the position at which it is without force [m].

    Returns
    -------
    array, (case, step, axis)
        Displacement along the load line and sideways. [m]

    Raises
    ------
    ModelError
        A start outside the clearance, or a form of the joint that has no such orbit.

    Examples
    --------
    A long joint at rest sinks as eps / sqrt(1 - eps^2) = t W / K:

    >>> from erlif.models.reynolds import Journal, Motion
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
    >>> time = np.linspace(0.0, 5.0, 501)
    >>> rest = Motion(time, angle=0 * time, load=222.4)
    >>> sunk = follow_full_film(joint, rest, start=np.zeros((1, 2)))[0, -1, 0]
    >>> ratio = 5.0 * 222.4 / joint.squeeze_constant
    >>> print(f"{sunk / joint.clearance:.6f} {ratio / np.hypot(1, ratio):.6f}")
    0.825510 0.825510
    """
    from scipy.interpolate import CubicHermiteSpline

    from erlif.models.reynolds import compiled_orbit  # only here, because numba loads slowly

    film, clearance = FullFilm.of(journal), journal.least_clearance
    place = np.array(start, dtype=float, ndmin=2) / clearance
    if not (np.hypot(*place.T) < 1 - THINNEST).all():
        raise ModelError(
            f"start lies outside the clearance of {clearance * 1e6:.4g} um, or leaves no film."
        )
    half = 0.5 * motion.angle
    flow = np.broadcast_to(fluidity, len(place)) / (film.unit * clearance)
    spring = np.broadcast_to(stiffness, len(place)) * clearance
    unloaded = np.broadcast_to(rest, len(place)) / clearance
    cases = np.stack([flow, spring, unloaded], axis=1)
    table = np.ascontiguousarray(film.table.c)
    width = float(film.table.x[1])

    # in the frame that turns with half the bushing; a film that falls quickly at every step
    for stride in (_stride(motion), 1):
        time, turns, applied = _drive_of(motion, stride)
        orbit = np.empty((len(place), time.size, 2))
        slope = np.empty_like(orbit)
        orbit[:, 0] = turn_vectors(place, -half[0])
        compiled_orbit.march(
            time, turns, applied, cases, table, width, THINNEST, LARGEST_FALL, orbit, slope
        )
        moved = np.hypot(*slope[:, :-1].T).T * np.diff(time)
        if (moved <= LARGEST_FALL * (1 - np.hypot(*orbit[:, :-1].T).T)).all():
            break

    # back to the laboratory at every step of the motion
    if time.size < motion.time.size:
        orbit = CubicHermiteSpline(time, orbit, slope, axis=1)(motion.time)
    return np.asarray(turn_vectors(orbit, half) * clearance)


@lru_cache(maxsize=4)  # the orbits of a fit have one motion
def _drive_of(motion: Motion, stride: int) -> tuple[Array, Array, Array]:
    """Times of the steps of an orbit; at them and in their middle, cosine and sine of half the
    bushing angle, and forces.
    """
    from scipy.interpolate import CubicSpline

    steps = np.unique(np.append(np.arange(0, motion.time.size, stride), motion.time.size - 1))
    time, half = motion.time[steps], 0.5 * motion.angle

    # the middle of each step from the curve through the motion, its load in the mean
    turned = np.empty(2 * time.size - 1)
    between = 0.5 * (time[1:] + time[:-1])
    turned[::2], turned[1::2] = half[steps], CubicSpline(motion.time, half)(between)
    loads = motion.load * np.array([np.cos(motion.load_direction), np.sin(motion.load_direction)])
    forces = np.empty((2 * time.size - 1, 2))
    forces[::2] = loads[:, steps].T
    forces[1::2] = np.stack([np.interp(between, motion.time, one) for one in loads], axis=1)
    return time, np.stack([np.cos(turned), np.sin(turned)], axis=1), forces


@lru_cache(maxsize=4)
def _stride(motion: Motion) -> int:
    """Number of motion steps per step of the orbit that still resolves rotation and load."""
    from scipy.interpolate import CubicSpline

    stride = _LONGEST_STEP
    while stride > 1:
        kept = np.unique(np.append(np.arange(0, motion.time.size, stride), motion.time.size - 1))
        if kept.size >= 4 and all(
            np.abs(CubicSpline(motion.time[kept], one[kept])(motion.time) - one).max()
            <= _RESOLUTION * max(size, 1e-12)
            for one, size in (
                (motion.angle, 1.0),
                (motion.load, float(np.abs(motion.load).max())),
                (motion.load_direction, 1.0),
            )
            if np.ptp(one) > 0  # a constant is resolved by any steps
        ):
            break
        stride //= 2
    return stride
