"""The film round a pin whose motion is known: its pressure, and the cavities along its path."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.reynolds import Journal, solve_film
from erlif.prediction.pin_motion import PinMotion

# Cells round the joint and over its length.
CELLS = (384, 24)

# Steps over which cavities are followed in a turn of the crank.
STEPS_PER_TURN = 100


class OverlapError(ModelError):
    """The gap that continues a map closes somewhere in the joint."""


def solve_pin_motion(
    journal: Journal,
    position: Array,
    rate: Array,
    turning: float,
    *,
    turned: float = 0.0,
    void_fraction: Array | None = None,
    cells: tuple[int, int] = CELLS,
) -> xr.Dataset:
    """Solve the pressure of one position of the pin and its rate.

    In the frame that turns with half the bushing no oil is entrained: there the film changes by
    dh/dt + (turning/2) dh/dphi, which is all that drives the pressure.

    Parameters
    ----------
    journal : Journal
    position : array, (number,)
        Displacements towards the load and sideways [m], tilts [m/m].
    rate : array, (number,)
        Their rates. [m/s, 1/s]
    turning : float
        Speed of rotation of the bushing. [rad/s]
    turned : float
        Angle by which the cells are turned, half that of the bushing where cavities are given.
        [rad]
    void_fraction : array, (angle, axial), optional
        Cavities from before, as `follow_cavities` finds them.
    cells : (int, int)
        Round the joint and over its length; a long one has one.

    Returns
    -------
    xarray.Dataset
        On angle from the load line [rad] and axial place from the middle of the length [m]: film
        [m], pressure [Pa] and void_fraction. reaction_load and reaction_side [N].

    Raises
    ------
    OverlapError
        If pin and bushing touch.
    ModelError
        If the pressure does not converge.

    Notes
    -----
    The line opposite to the load line and the ends are at ambient pressure.

    Examples
    --------
    A long joint that is squeezed at the rate e' has the peak 24 eta (R/c)^2 e'/(1 - e^2)^2:

    >>> joint = Journal(0.0333, 0.0335, length=0.2, viscosity=0.1, long=True)
    >>> found = solve_pin_motion(joint, np.array([1e-4, 0, 0, 0]), np.array([1e-4, 0, 0, 0]), 0.0)
    >>> form = 24 * 0.1 * (joint.radius / joint.clearance) ** 2 * 0.5 / (1 - 0.5**2) ** 2
    >>> print(f"{float(found.pressure.max()) / form:.2f}")
    1.00
    """
    angle, axial = lay_cells(journal, cells)
    around, along, angle = angle.size, axial.size, angle + turned
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    load, side = tilted(position, axial)
    film = journal.clearance_at(axial) - load * cosine - side * sine
    if film.min() <= 0:
        raise OverlapError(
            "Expected a gap all over the joint; pin and bushing overlap by "
            f"{-1e6 * film.min():.2g} um. Compare clearance, tilts and length in [joint] with the "
            "maps."
        )

    load_rate, side_rate = tilted(rate, axial)
    change = (turning / 2 * load - side_rate) * sine - (turning / 2 * side + load_rate) * cosine
    change = change[:, 0] if journal.long else change
    solved = solve_round(journal, film, film_rate=change, void_fraction=void_fraction)
    pressure = np.atleast_2d(solved.pressure.values.T).T
    area = 2 * np.pi * journal.radius / around * journal.length / along
    where = ("angle", "axial")
    return xr.Dataset(
        {
            "film": (where, film),
            "pressure": (where, pressure),
            "void_fraction": (where, np.atleast_2d(solved.void_fraction.values.T).T),
            "reaction_load": float((pressure * cosine).sum() * area),
            "reaction_side": float((pressure * sine).sum() * area),
        },
        {"angle": angle, "axial": axial},
    )


def solve_round(journal: Journal, film: Array, **driven: Any) -> xr.Dataset:
    """The Reynolds equation on a film round the joint, (..., angle, axial)."""
    return solve_film(
        film[..., 0] if journal.long else film,
        length=2 * np.pi * journal.radius,
        width=None if journal.long else journal.length,
        viscosity=journal.viscosity,
        pressure_viscosity=journal.pressure_viscosity,
        cavitation_pressure=journal.cavitation_pressure,
        roughness=journal.roughness,
        foundation=journal.foundation,
        **driven,
    )


def tilted(numbers: Array, axial: Array) -> tuple[Array, Array]:
    """Displacements, or their rates, towards the load and sideways at axial places."""
    return numbers[0] + numbers[2] * axial, numbers[1] + numbers[3] * axial


def lay_cells(journal: Journal, cells: tuple[int, int]) -> tuple[Array, Array]:
    """Angles [rad] and axial places [m] of the cells."""
    around, along = cells[0], 1 if journal.long else cells[1]
    angle = (np.arange(around) + 0.5) * (2 * np.pi / around) - np.pi
    axial = ((np.arange(along) + 0.5) / along - 0.5) * journal.length
    return np.asarray(angle, float), np.asarray(axial, float)


def follow_cavities(
    journal: Journal,
    motion: PinMotion,
    *,
    sinking: float = 1.0,
    cells: tuple[int, int] = CELLS,
) -> Array:
    """Follow the cavities of the film along the path of the pin.

    The cavities at the first trigger are those of a turn before, over which the pin has moved as
    in the recorded one. The oil is conserved in the frame that turns with half the bushing.

    Parameters
    ----------
    journal : Journal
    motion : PinMotion
        Over a turn of the crank, or a large part of it.
    sinking : float
        Displacement of the pin over the turn before, over that of the recorded turn.
    cells : (int, int)
        As for `solve_pin_motion`.

    Returns
    -------
    array, (trigger, angle, axial)
        Share of void in each cell, which turns with half the bushing. [1]

    Raises
    ------
    OverlapError, ModelError
        As `solve_pin_motion`.

    Examples
    --------
    A pin that approaches the bushing has a full film:

    >>> time = np.linspace(0.0, 0.5, 5)
    >>> toward = np.array([1.0, 0.0, 0.0, 0.0])
    >>> motion = PinMotion(time, 0 * time, 1e-4 * np.outer(1 + time, toward),
    ...                    np.tile(1e-4 * toward, (5, 1)), 0 * time, None, None, np.ones(4))
    >>> joint = Journal(0.0333, 0.0335, length=0.2, viscosity=0.1, long=True)
    >>> float(follow_cavities(joint, motion, cells=(64, 1)).max())
    0.0
    """
    from scipy.interpolate import CubicHermiteSpline  # loads scipy.optimize: only where needed

    # the turn before joins the recorded one, also where the film sinks from turn to turn
    period, sunk = motion.turn, motion.sunk
    ahead = (motion.time[0] + period - motion.time[:, None]) / period  # turns to the recorded one
    before = motion.position - sunk * (1 + (sinking - 1) * ahead)
    time = np.concatenate([motion.time - period, motion.time])
    path = CubicHermiteSpline(
        time,
        np.concatenate([before, motion.position]),
        np.concatenate([motion.rate + (sinking - 1) / period * sunk, motion.rate]),
    )
    swing = CubicHermiteSpline(time, np.tile(motion.angle, 2), np.tile(motion.turning, 2))

    # triggers are steps, and between them no step is longer than that of an even turn
    parts = np.ceil(np.diff(time) / period * STEPS_PER_TURN - 1e-6).astype(np.int64)
    place = np.concatenate([[0], np.cumsum(parts)])
    fine = np.interp(np.arange(place[-1] + 1), place, time)
    angle, axial = lay_cells(journal, cells)
    at, turned = path(fine), angle + swing(fine)[:, None] / 2
    load, side = tilted(at.T[..., None, None], axial)
    film = journal.clearance_at(axial) - load * np.cos(turned)[..., None]
    film = film - side * np.sin(turned)[..., None]
    if film.min() <= 0:
        raise OverlapError("Expected a gap all over the joint; pin and bushing overlap on the way.")
    solved = solve_round(journal, film, time=fine - fine[0])
    void = solved.void_fraction.values.reshape(film.shape)
    return np.asarray(void[place[motion.time.size :]])
