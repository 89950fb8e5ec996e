"""Forward dynamics of the slider-crank: perfect, simplified and general joint at the crank pin.

The joints are those of Mukras et al. (2008). The equations of motion are Lagrange's in the fewest
coordinates, integrated with the work of every force beside them, so that the balance of energy of
a result can be checked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from erlif.core.arrays import Array
from erlif.core.described import describe
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.joint.models.reaction import SliderCrankBodies, warn_of_compression
from erlif.joint.models.slider.contact import ContactLaw
from erlif.joint.models.slider.motion import QUADRATURES, GeneralJoint, SimplifiedJoint, Torque
from erlif.models.arguments import (
    formula,
    require_known,
    require_positive,
    require_single,
)
from erlif.models.mechanism import SliderCrank

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ContactLaw", "Torque", "simulate_slider_crank"]

_Model = SimplifiedJoint | GeneralJoint

# Absolute error allowed in a step over the relative one: the shortest length is a penetration.
_ABSOLUTE = 1e-4

# Gap at a touch or its end that counts as closed or open. [m]
_SHUT = 1e-14

# Steps per turn at least, so that no touch of the pin is overlooked in free flight.
_STEPS_PER_TURN = 60

# Steps in a simulation at least.
_FEWEST_STEPS = 10

# Touches and losses of contact after which a simulation is given up.
_MOST_TOUCHES = 100_000

# Units and descriptions of the variables of a simulation.
_VARIABLES = read_table("erlif.joint.models", "variables.toml")["slider_crank"]


@formula(tolerance="number")
def simulate_slider_crank(
    linkage: SliderCrank,
    *,
    bodies: SliderCrankBodies,
    crank_speed: float,
    duration: float,
    crank_angle: float = 0.0,
    torque: Torque | None = None,
    crank_inertia: float = 0.0,
    contact: ContactLaw | None = None,
    eccentricity: tuple[float, float] | None = None,
    samples: int = 361,
    worn: xr.Dataset | None = None,
    tolerance: float = 1e-10,
) -> xr.Dataset:
    """Integrate the motion of a slider-crank whose crank is driven by a speed or a torque.

    The clearance of `linkage` is the radial clearance at the crank pin. Without `contact` the rod
    is longer by it, the simplified joint of Mukras et al. (2008), eqs. 15 to 19; with `contact` the
    pin moves freely in its bushing, the general joint, eqs. 10 to 14. The linkage lies flat, so
    gravity does no work.

    Parameters
    ----------
    linkage : SliderCrank
        Lengths and clearance. [m]
    bodies : SliderCrankBodies
        Masses, spring and friction, single numbers. `pin_radius` is the radius of the pin.
    crank_speed : float
        Speed of the crank, held or, with a torque, at the start. [rad/s]
    duration : float
        Length of the simulation. [s]
    crank_angle : float
        Angle of the crank at the start. [rad]
    torque : callable, optional
        Torque on the crank [N m] as a function of time [s] and crank angle [rad]. Default: the
        torque that holds the speed.
    crank_inertia : float
        Moment of inertia of the crank about its pivot. [kg m2]
    contact : ContactLaw, optional
        Contact of the general joint.
    eccentricity : (float, float), optional
        Pin centre from bushing centre at the start, along and across the line of the slider, in a
        general joint that turns with the rod. Default: the pin lies on the bushing under the force
        of the perfect joint, so that the first cycle is nearly free of a transient. [m]
    samples : int
        Number of times in the result, from 0 to `duration`.
    worn : xarray.Dataset, optional
        Worn profiles of the general joint: `depth` and `pin_depth` [m] over `angle`, one number of
        cycles of `erlif.joint.models.slider_wear.wear_slider_crank`. Bushing and pin then touch
        over an arc, by springs whose law in the unworn bore is that of `contact` for shallow
        penetrations.
    tolerance : float
        Relative error allowed in a step of the integration. [1]

    Returns
    -------
    xarray.Dataset
        Over `time` [s]: the motion, the force of the pin on the rod, energies and work, each with
        its unit; the number of touches is the attribute `touches`.

    Raises
    ------
    ModelError
        A value that is not one number or outside its range, a contact without normal motion (no
        bodies), or a simulation that does not reach its end.

    Warns
    -----
    RangeWarning
        Where the rod is in compression although the simplified joint presumes tension.

    Examples
    --------
    The linkage of the source at half a turn per second. The work of the drive in a turn is nothing
    without friction:

    >>> from erlif.models.mechanism import SliderCrank
    >>> from erlif.joint.models.reaction import SliderCrankBodies
    >>> bodies = SliderCrankBodies(0.8175, 5.5e-3, 5.5487, 525.4)
    >>> linkage = SliderCrank(crank=0.0762, coupler=0.2032)
    >>> turn = simulate_slider_crank(linkage, bodies=bodies, crank_speed=np.pi, duration=2.0)
    >>> print(f"{abs(turn.drive_work[-1]):.6f} J, {float(turn.force.max()):.1f} N")
    0.000000 J, 77.0 N
    """
    require_single(**vars(bodies))
    require_known(**vars(bodies))
    if eccentricity is not None and not np.all(np.isfinite(eccentricity)):
        raise ModelError(f"eccentricity must be two finite numbers, got {eccentricity}.")
    require_positive(rod_mass=bodies.rod_mass, slider_mass=bodies.slider_mass)

    model: _Model
    if contact is None and worn is not None:
        raise ModelError("contact must be given where worn profiles are: they touch by its law.")
    links = linkage, bodies, torque, crank_inertia
    if contact is None:
        model = SimplifiedJoint(*links)
        start = [crank_angle, crank_speed]
    else:
        model = GeneralJoint(contact, worn, *links)
        start = model.rest(crank_angle, crank_speed, eccentricity)
    times = np.linspace(0.0, duration, int(samples))
    states, impact_speeds, touches = _integrate(model, start, times, crank_speed, tolerance)

    rows = [model.describe(*one) for one in zip(times, states, impact_speeds, strict=True)]
    result = describe(
        {
            name: ("time", np.array([row[name] for row in rows]), unit, text)
            for name, (unit, text) in _VARIABLES.items()
        },
        {"time": ("time", times, "s", "time")},
    )
    if contact is None and linkage.clearance > 0:
        phi = result.rod_angle
        pull = -result.force_x * np.cos(phi) - result.force_y * np.sin(phi)
        warn_of_compression(result.crank_angle.values, pull=pull.values)
    return result.assign_attrs(touches=touches)


def _integrate(
    model: _Model, start: list[float], times: Array, crank_speed: float, tolerance: float
) -> tuple[Array, Array, int]:
    """States and speeds of the last touch at the times, and the number of touches.

    The law of contact needs the speed of each touch, so the integration stops at touches and losses
    of contact and goes on from there. An impact speed of zero stands for free flight.
    """
    from scipy.integrate import solve_ivp  # at use, as all solvers of the theories

    solve: Any = solve_ivp
    longest = times[-1] / _FEWEST_STEPS
    if crank_speed:
        longest = min(longest, 2 * np.pi / (_STEPS_PER_TURN * abs(crank_speed)))

    state = np.array([*start, *[0.0] * len(QUADRATURES)])
    impact_speed = model.slowest_impact if model.gap(state) >= 0 else 0.0
    time, touches = 0.0, 0
    kept, speeds = [state], [impact_speed]
    while len(kept) < times.size:
        solution = solve(
            lambda time, state, model, speed: model.rates(time, state, speed),
            (time, times[-1]),
            state,
            method="DOP853",
            t_eval=times[len(kept) :],
            events=_end_of_contact if impact_speed else _touch,
            args=(model, impact_speed),
            rtol=tolerance,
            atol=_ABSOLUTE * tolerance,
            max_step=longest,
        )
        if solution.status < 0 or touches > _MOST_TOUCHES:
            raise ModelError(
                f"The motion could not be followed to {times[-1]:g} s, {touches} touches were: "
                f"{solution.message} Check torque, stiffness and inertia."
            )
        kept.extend(np.reshape(solution.y, (state.size, -1)).T)
        speeds.extend([impact_speed] * (len(kept) - len(speeds)))
        if solution.status == 0:
            break

        # a touch begins with the speed at which the gap closes
        time, state = float(solution.t_events[0][0]), solution.y_events[0][0]
        touches += not impact_speed
        impact_speed = 0.0 if impact_speed else max(model.approach(state), model.slowest_impact)
    return np.array(kept), np.array(speeds), touches


def _touch(_time: float, state: Array, model: _Model, _speed: float) -> float:
    """Negative before a touch, positive after it.

    A flight begins at the gap zero, which rounding makes one or the other, and may be shorter than
    a step: what counts as touched is closed and closing.
    """
    gap = model.gap(state)
    return -gap - _SHUT if gap >= 0 and model.approach(state) <= 0 else gap


def _end_of_contact(_time: float, state: Array, model: _Model, _speed: float) -> float:
    """Positive before the end of a contact, negative after it: open and opening."""
    gap = model.gap(state)
    return -gap + _SHUT if gap <= 0 and model.approach(state) >= 0 else gap


_touch.terminal, _touch.direction = True, 1.0  # type: ignore[attr-defined]
_end_of_contact.terminal, _end_of_contact.direction = True, -1.0  # type: ignore[attr-defined]
