"""Forward dynamics of the slider-crank: perfect, simplified and general joint at the crank pin.

The joints are those of Mukras et al. (2008). The equations of motion are Lagrange's in the fewest
coordinates, integrated with the work of every force beside them, so that the balance of energy of
a result can be checked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import asin, atan, atan2, cos, hypot, sin, sqrt, tan, tanh
from typing import TYPE_CHECKING, Any

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_single,
)
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import SliderCrankBodies, warn_of_compression

if TYPE_CHECKING:
    import xarray as xr

Torque = Callable[[float, float], float]
"""Torque on the crank [N m] at a time [s] and a crank angle [rad]."""

_RELATIVE = 1e-10
"""Relative error allowed in a step."""

_ABSOLUTE = 1e-14
"""Absolute error allowed in a step; the shortest length of interest is a penetration. [m]"""

_STEPS_PER_TURN = 60
"""Steps per turn at least, so that no touch of the pin is overlooked in free flight."""

_FEWEST_STEPS = 10
"""Steps in a simulation at least."""

_STEEPEST = 0.999999
"""Sine of the rod angle at most."""

_MOST_TOUCHES = 100_000
"""Touches and losses of contact after which a simulation is given up."""

_FRICTION_PASSES = 8
"""The friction couple changes the force by mu r / rod of itself: a pass gains two digits."""

_VARIABLES = {
    "crank_angle": ("rad", "angle of the crank from the line of the slider"),
    "crank_speed": ("rad/s", "speed of the crank"),
    "slider_position": ("m", "distance from crank pivot to slider pin"),
    "slider_speed": ("m/s", "speed of the slider, outward"),
    "rod_angle": ("rad", "direction of the rod from crank pin to slider"),
    "rod_speed": ("rad/s", "rate of the rod angle"),
    "eccentricity_x": ("m", "pin centre from bushing centre, along the line of the slider"),
    "eccentricity_y": ("m", "pin centre from bushing centre, across the line of the slider"),
    "penetration": ("m", "penetration of the pin into the bushing, negative while apart"),
    "force_x": ("N", "force of the pin on the rod, along the line of the slider"),
    "force_y": ("N", "force of the pin on the rod, across the line of the slider"),
    "force": ("N", "magnitude of the joint force"),
    "normal": ("N", "share of the joint force normal to the contact"),
    "contact_angle": ("rad", "place of contact on the bushing; 0 with the rod in tension"),
    "slip_speed": ("m/s", "speed of the pin surface against the bushing"),
    "crank_torque": ("N m", "torque that drives the crank"),
    "kinetic_energy": ("J", "energy of motion of crank, rod and slider"),
    "spring_energy": ("J", "work stored in the spring since the outer dead centre"),
    "contact_energy": ("J", "elastic energy of the contact"),
    "drive_work": ("J", "work of the drive since the start"),
    "friction_loss": ("J", "work lost to friction since the start"),
    "impact_loss": ("J", "work lost to the damping of the contact since the start"),
    "rubbing": ("N m", "integral of normal force over sliding distance since the start"),
}
"""Units and descriptions of the variables of a simulation."""


@dataclass(frozen=True)
class ContactLaw:
    """Contact of pin and bushing in the general joint. Mukras et al. (2008), eqs. 12 and 13.

    The force is that of `erlif.models.contact.impact_force`, with a rate of penetration of the
    speed of the touch at most.

    Attributes
    ----------
    stiffness : float
        K, see `erlif.models.contact.impact_stiffness`. [N/m^1.5]
    restitution : float
        Coefficient of restitution, 0 to 1. [1]
    slowest_impact : float
        Speed below which a touch is damped as one of this speed. [m/s]

    Raises
    ------
    ModelError
        A stiffness or speed that is not one positive number, or a restitution outside 0 to 1.

    Notes
    -----
    The damping of the law is divided by the speed of the touch, so a pin laid down at no speed
    would stand still: `slowest_impact` ends the law there. A pin that strikes the bore without
    having left it penetrates faster than at its last touch, and the force of the law would be many
    times the elastic one: the rate counts as the speed of the touch at most. In an impact of a free
    body it never is more. The source does not state what was done.
    """

    stiffness: float
    restitution: float = 0.8
    slowest_impact: float = 0.01

    def __post_init__(self) -> None:
        _require_numbers(**vars(self))
        require_positive(stiffness=self.stiffness, slowest_impact=self.slowest_impact)
        require_between(0.0, 1.0, restitution=self.restitution)


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
    slowest_slip: float = 1e-3,
    samples: int = 361,
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
    slowest_slip : float
        Sliding speed below which friction falls to zero, as a hyperbolic tangent. [m/s]
    samples : int
        Number of times in the result, from 0 to `duration`.

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

    >>> bodies = SliderCrankBodies(
    ...     rod_mass=0.8175, rod_inertia=5.5e-3, slider_mass=5.5487, spring_stiffness=525.4
    ... )
    >>> linkage = SliderCrank(crank=0.0762, coupler=0.2032)
    >>> turn = simulate_slider_crank(linkage, bodies=bodies, crank_speed=np.pi, duration=2.0)
    >>> print(f"{abs(turn.drive_work[-1]):.6f} J, {float(turn.force.max()):.1f} N")
    0.000000 J, 77.0 N
    """
    _require_numbers(
        crank_speed=crank_speed,
        duration=duration,
        crank_angle=crank_angle,
        crank_inertia=crank_inertia,
        slowest_slip=slowest_slip,
        samples=samples,
        **vars(bodies),
    )
    require_finite(
        crank_speed=crank_speed, crank_angle=crank_angle, duration=duration, samples=samples
    )
    require_positive(duration=duration, slowest_slip=slowest_slip)
    if samples < 1:
        raise ModelError(f"samples must be 1 or more, got {samples}.")
    if eccentricity is not None and not np.all(np.isfinite(eccentricity)):
        raise ModelError(f"eccentricity must be two finite numbers, got {eccentricity}.")
    require_positive(rod_mass=bodies.rod_mass, slider_mass=bodies.slider_mass)
    require_not_negative(crank_inertia=crank_inertia)

    model: _Simplified | _General
    if contact is None:
        model = _Simplified(linkage, bodies, torque, crank_inertia, slowest_slip)
        start = [crank_angle, crank_speed]
    else:
        model = _General(linkage, bodies, torque, crank_inertia, slowest_slip, contact)
        start = model.rest(crank_angle, crank_speed, eccentricity)
    times = np.linspace(0.0, duration, int(samples))
    states, impact_speeds, touches = _integrate(model, start, times, crank_speed)

    rows = [model.describe(*one) for one in zip(times, states, impact_speeds, strict=True)]
    found = _dataset(times, {name: np.array([row[name] for row in rows]) for name in rows[0]})
    if contact is None and linkage.clearance > 0:
        pull = -found.force_x * np.cos(found.rod_angle) - found.force_y * np.sin(found.rod_angle)
        warn_of_compression(found.crank_angle.values, pull=pull.values)
    return found.assign_attrs(touches=touches)


class _Linkage:
    """What both joints share: lengths, bodies, drive and spring, as plain numbers."""

    def __init__(
        self,
        linkage: SliderCrank,
        bodies: SliderCrankBodies,
        torque: Torque | None,
        crank_inertia: float,
        slowest_slip: float,
    ) -> None:
        self.crank, self.clearance = linkage.crank, linkage.clearance
        self.half, self.coupler = linkage.coupler / 2, linkage.coupler
        self.rod_mass, self.rod_inertia = float(bodies.rod_mass), float(bodies.rod_inertia)
        self.slider_mass, self.friction = float(bodies.slider_mass), float(bodies.friction)
        self.spring, self.preload = float(bodies.spring_stiffness), float(bodies.spring_preload)
        self.pin_radius = float(bodies.pin_radius)
        self.bushing_radius = self.pin_radius + linkage.clearance
        self.torque, self.crank_inertia, self.slowest = torque, crank_inertia, slowest_slip

    def pull(self, position: float) -> float:
        """Force of the spring on the slider, outward."""
        return self.preload + self.spring * (self.crank + self.coupler - position)

    def spring_energy(self, position: float) -> float:
        stretch = self.crank + self.coupler - position
        return self.preload * stretch + self.spring * stretch**2 / 2

    def kinetic_energy(self, crank_speed: float, speed: float, phi: float, rate: float) -> float:
        rod_x = speed + self.half * sin(phi) * rate
        rod_y = -self.half * cos(phi) * rate
        return (
            self.crank_inertia * crank_speed**2
            + self.rod_mass * (rod_x**2 + rod_y**2)
            + self.rod_inertia * rate**2
            + self.slider_mass * speed**2
        ) / 2


class _Simplified(_Linkage):
    """Rod with a fixed lever to the pin centre: perfect joint, or lengthened by the clearance."""

    slowest_impact = 1.0  # not used: the joint has no law of contact

    def gap(self, _state: Array) -> float:
        """A positive number: the pin never leaves its place."""
        return 1.0

    def approach(self, _state: Array) -> float:
        return 0.0

    def rates(self, time: float, state: Array, _impact_speed: float) -> list[float]:
        speed = state[1]
        now = self.solve(float(state[0]), float(speed), time)
        slip = abs(now["slip_speed"])
        return [
            speed,
            now["acceleration"],
            now["crank_torque"] * speed,
            now["friction_force"] * slip,
            0.0,
            now["normal"] * slip,
        ]

    def solve(self, angle: float, speed: float, time: float = 0.0) -> dict[str, float]:
        """Motion, acceleration and force at an angle and speed of the crank."""
        rod = self.coupler + self.clearance
        s, c = sin(angle), cos(angle)
        phi = asin(-self.crank * s / rod)
        sp, cp = sin(phi), cos(phi)

        # derivatives by the crank angle: rod angle, slider, centre of the rod
        phi_1 = -self.crank * c / (rod * cp)
        phi_2 = self.crank * s / (rod * cp) + phi_1**2 * tan(phi)
        x_1 = -self.crank * s - rod * phi_1 * sp
        x_2 = -self.crank * c - rod * (phi_2 * sp + phi_1**2 * cp)
        gx_1, gy_1 = x_1 + self.half * phi_1 * sp, -self.half * phi_1 * cp
        gx_2 = x_2 + self.half * (phi_2 * sp + phi_1**2 * cp)
        gy_2 = -self.half * (phi_2 * cp - phi_1**2 * sp)
        position = self.crank * c + rod * cp
        spring = self.pull(position)

        # Lagrange: J t'' + J' t'^2 / 2 = torque of drive, spring and friction on the crank
        inertia = (
            self.crank_inertia
            + self.slider_mass * x_1**2
            + self.rod_mass * (gx_1**2 + gy_1**2)
            + self.rod_inertia * phi_1**2
        )
        change = (
            self.slider_mass * x_1 * x_2
            + self.rod_mass * (gx_1 * gx_2 + gy_1 * gy_2)
            + self.rod_inertia * phi_1 * phi_2
        )
        slip = self.pin_radius * (1 - phi_1) * speed
        sense = tanh(slip / self.slowest)
        share = 1 / sqrt(1 + self.friction**2)
        drive = self.torque(time, angle) if self.torque else 0.0
        acceleration = couple = 0.0
        for _ in range(_FRICTION_PASSES if self.friction else 1):
            if self.torque:
                free = drive + spring * x_1 - couple * (1 - phi_1)
                acceleration = (free - change * speed**2) / inertia

            # forces along the line, then moments of the rod about the slider pin
            x_tt = x_1 * acceleration + x_2 * speed**2
            gx_tt = gx_1 * acceleration + gx_2 * speed**2
            gy_tt = gy_1 * acceleration + gy_2 * speed**2
            phi_tt = phi_1 * acceleration + phi_2 * speed**2
            force_x = self.rod_mass * gx_tt + self.slider_mass * x_tt - spring
            spin = self.rod_inertia * phi_tt - self.half * self.rod_mass * (cp * gy_tt - sp * gx_tt)
            force_y = (sp * force_x - (spin - couple) / rod) / cp
            force = hypot(force_x, force_y)
            normal = share * force
            couple = sense * self.friction * normal * self.pin_radius
        if not self.torque:
            drive = (
                self.crank_inertia * acceleration
                + self.crank * (c * force_y - s * force_x)
                + couple
            )
        return {
            "acceleration": acceleration,
            "slider_position": position,
            "slider_speed": x_1 * speed,
            "rod_angle": phi,
            "rod_speed": phi_1 * speed,
            "force_x": force_x,
            "force_y": force_y,
            "force": force,
            "normal": normal,
            "friction_angle": atan(sense * self.friction),
            "friction_force": self.friction * normal * abs(sense),
            "slip_speed": slip,
            "crank_torque": drive,
        }

    def describe(self, time: float, state: Array, _impact_speed: float) -> dict[str, float]:
        now = self.solve(float(state[0]), float(state[1]), time)
        sp, cp = sin(now["rod_angle"]), cos(now["rod_angle"])
        along = now["force_x"] * cp + now["force_y"] * sp
        across = now["force_y"] * cp - now["force_x"] * sp
        now |= {
            "crank_angle": state[0],
            "crank_speed": state[1],
            "eccentricity_x": -self.clearance * cp,
            "eccentricity_y": -self.clearance * sp,
            "penetration": 0.0,
            "contact_angle": atan2(-across, -along) - now["friction_angle"],
            "kinetic_energy": self.kinetic_energy(
                state[1], now["slider_speed"], now["rod_angle"], now["rod_speed"]
            ),
            "spring_energy": self.spring_energy(now["slider_position"]),
            "contact_energy": 0.0,
        }
        return now | dict(zip(_QUADRATURES, state[2:], strict=True))


class _General(_Linkage):
    """Pin that moves in its bushing and touches it by a law of contact.

    The coordinates are the crank angle and the eccentricity, pin centre less bushing centre: a
    penetration is far smaller than the lengths of the links.
    """

    def __init__(
        self,
        linkage: SliderCrank,
        bodies: SliderCrankBodies,
        torque: Torque | None,
        crank_inertia: float,
        slowest_slip: float,
        law: ContactLaw,
    ) -> None:
        super().__init__(linkage, bodies, torque, crank_inertia, slowest_slip)
        self.perfect = _Simplified(
            SliderCrank(linkage.crank, linkage.coupler), bodies, None, crank_inertia, slowest_slip
        )
        self.stiffness, self.restitution = law.stiffness, law.restitution
        self.slowest_impact = law.slowest_impact
        self.full_inertia = self.rod_mass * self.half**2 + self.rod_inertia
        if torque is not None and not crank_inertia > 0:
            raise ModelError("crank_inertia must be positive where a torque drives the crank.")

    def rest(
        self, angle: float, speed: float, eccentricity: tuple[float, float] | None
    ) -> list[float]:
        """Pin that turns with the rod, by default on the bushing as the perfect joint loads it."""
        perfect = self.perfect.solve(angle, speed)
        reach = self.clearance + (perfect["force"] / self.stiffness) ** (2 / 3)
        size = perfect["force"] or 1.0
        ex, ey = eccentricity or (
            reach * perfect["force_x"] / size,
            reach * perfect["force_y"] / size,
        )
        rate = perfect["rod_speed"]
        return [angle, speed, ex, ey, -rate * ey, rate * ex]

    def gap(self, state: Array) -> float:
        """Penetration, negative while apart."""
        return hypot(state[2], state[3]) - self.clearance

    def approach(self, state: Array) -> float:
        """Rate of the penetration."""
        _, _, ex, ey, vx, vy = state[:6]
        return float((ex * vx + ey * vy) / (hypot(ex, ey) or 1.0))

    def solve(self, time: float, state: Array, impact_speed: float) -> dict[str, float]:
        angle, speed, ex, ey, vx, vy = (float(value) for value in state[:6])
        s, c = sin(angle), cos(angle)

        # the bushing centre follows from the pin, rod and slider from the bushing
        # a trial step may lie beyond the reach of the rod; its error refuses it
        height = (self.crank * s - ey) / self.coupler
        phi = -asin(max(-_STEEPEST, min(_STEEPEST, height)))
        sp, cp = sin(phi), cos(phi)
        by_t, bx_t = self.crank * c * speed - vy, -self.crank * s * speed - vx
        rate = -by_t / (self.coupler * cp)
        position = self.crank * c - ex + self.coupler * cp
        x_t = bx_t - self.coupler * sp * rate

        # normal force by the law of contact, along the line of centres; friction across it
        reach = hypot(ex, ey)
        nx, ny = (ex / reach, ey / reach) if reach else (1.0, 0.0)
        penetration = reach - self.clearance
        depth_rate = vx * nx + vy * ny
        elastic = normal = slip = rubbed = 0.0
        if impact_speed and penetration > 0:
            elastic = self.stiffness * penetration * sqrt(penetration)
            share = max(-1.0, min(1.0, depth_rate / impact_speed))
            normal = elastic * (1 + 0.75 * (1 - self.restitution**2) * share)
        lever = self.pin_radius - penetration
        slip = vy * nx - vx * ny + lever * speed - self.bushing_radius * rate
        if self.friction:
            rubbed = self.friction * normal * tanh(slip / self.slowest)
        force_x, force_y = normal * nx - rubbed * ny, normal * ny + rubbed * nx

        # Lagrange for slider and rod, with the contact at the surface of the bushing
        mixed = self.rod_mass * self.half * sp
        mass = self.rod_mass + self.slider_mass
        spring = self.pull(position)
        on_x = force_x + spring - self.rod_mass * self.half * cp * rate**2
        on_phi = self.coupler * (sp * force_x - cp * force_y) + self.bushing_radius * rubbed
        determinant = mass * self.full_inertia - mixed**2
        x_tt = (self.full_inertia * on_x - mixed * on_phi) / determinant
        phi_tt = (mass * on_phi - mixed * on_x) / determinant

        # the crank has the opposite force at the same place
        pull = self.crank * (c * force_y - s * force_x) + lever * rubbed
        acceleration = 0.0
        drive = pull
        if self.torque:
            drive = self.torque(time, angle)
            acceleration = (drive - pull) / self.crank_inertia
        pin_x = -self.crank * (s * acceleration + c * speed**2)
        pin_y = self.crank * (c * acceleration - s * speed**2)
        return {
            "acceleration": acceleration,
            "ex_tt": pin_x - x_tt - self.coupler * (phi_tt * sp + rate**2 * cp),
            "ey_tt": pin_y + self.coupler * (phi_tt * cp - rate**2 * sp),
            "crank_angle": angle,
            "crank_speed": speed,
            "slider_position": position,
            "slider_speed": x_t,
            "rod_angle": phi,
            "rod_speed": rate,
            "eccentricity_x": ex,
            "eccentricity_y": ey,
            "penetration": penetration,
            "force_x": force_x,
            "force_y": force_y,
            "force": hypot(force_x, force_y),
            "normal": normal,
            "contact_angle": atan2(-(ny * cp - nx * sp), -(nx * cp + ny * sp)),
            "slip_speed": slip,
            "crank_torque": drive,
            "friction_power": rubbed * slip,
            "impact_power": (normal - elastic) * depth_rate,
        }

    def rates(self, time: float, state: Array, impact_speed: float) -> list[float]:
        now = self.solve(time, state, impact_speed)
        return [
            state[1],
            now["acceleration"],
            state[4],
            state[5],
            now["ex_tt"],
            now["ey_tt"],
            now["crank_torque"] * now["crank_speed"],
            now["friction_power"],
            now["impact_power"],
            now["normal"] * abs(now["slip_speed"]),
        ]

    def describe(self, time: float, state: Array, impact_speed: float) -> dict[str, float]:
        now = self.solve(time, state, impact_speed)
        now["kinetic_energy"] = self.kinetic_energy(
            now["crank_speed"], now["slider_speed"], now["rod_angle"], now["rod_speed"]
        )
        now["spring_energy"] = self.spring_energy(now["slider_position"])
        now["contact_energy"] = 0.4 * self.stiffness * max(now["penetration"], 0.0) ** 2.5
        return now | dict(zip(_QUADRATURES, state[6:], strict=True))


_QUADRATURES = ("drive_work", "friction_loss", "impact_loss", "rubbing")
"""Integrals over time, at the end of each state."""


def _integrate(
    model: _Simplified | _General, start: list[float], times: Array, crank_speed: float
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

    state = np.array([*start, *[0.0] * len(_QUADRATURES)])
    impact_speed = model.slowest_impact if model.gap(state) >= 0 else 0.0
    time, touches = 0.0, 0
    kept, speeds = [state], [impact_speed]
    while len(kept) < times.size:
        found = solve(
            _rates,
            (time, times[-1]),
            state,
            method="DOP853",
            t_eval=times[len(kept) :],
            events=_end_of_contact if impact_speed else _touch,
            args=(model, impact_speed),
            rtol=_RELATIVE,
            atol=_ABSOLUTE,
            max_step=longest,
        )
        if found.status < 0 or touches > _MOST_TOUCHES:
            raise ModelError(
                f"The motion could not be followed to {times[-1]:g} s, {touches} touches were: "
                f"{found.message} Check torque, stiffness and inertia."
            )
        kept.extend(np.reshape(found.y, (state.size, -1)).T)
        speeds.extend([impact_speed] * (len(kept) - len(speeds)))
        if found.status == 0:
            break

        # a touch begins with the speed at which the gap closes
        time, state = float(found.t_events[0][0]), found.y_events[0][0]
        touches += not impact_speed
        impact_speed = 0.0 if impact_speed else max(model.approach(state), model.slowest_impact)
    return np.array(kept), np.array(speeds), touches


def _rates(
    time: float, state: Array, model: _Simplified | _General, impact_speed: float
) -> list[float]:
    return model.rates(time, state, impact_speed)


def _touch(_time: float, state: Array, model: _Simplified | _General, _speed: float) -> float:
    """Negative before a touch, positive after it.

    A flight begins at the gap zero, which rounding makes one or the other, and may be shorter than
    a step: what counts as touched is closed and closing.
    """
    gap = model.gap(state)
    return -gap - _ABSOLUTE if gap >= 0 and model.approach(state) <= 0 else gap


def _end_of_contact(
    _time: float, state: Array, model: _Simplified | _General, _speed: float
) -> float:
    """Positive before the end of a contact, negative after it: open and opening."""
    gap = model.gap(state)
    return -gap + _ABSOLUTE if gap <= 0 and model.approach(state) >= 0 else gap


_touch.terminal, _touch.direction = True, 1.0  # type: ignore[attr-defined]
_end_of_contact.terminal, _end_of_contact.direction = True, -1.0  # type: ignore[attr-defined]


def _dataset(times: Array, columns: dict[str, Array]) -> xr.Dataset:
    import xarray as xr

    variables = {
        name: ("time", columns[name], {"units": unit, "long_name": text})
        for name, (unit, text) in _VARIABLES.items()
    }
    return xr.Dataset(variables, {"time": ("time", times, {"units": "s", "long_name": "time"})})


def _require_numbers(**arguments: Values) -> None:
    """Refuse arrays and NaN: an integration of NaN would not end."""
    require_single(**arguments)
    for name, value in arguments.items():
        if np.isnan(value):
            raise ModelError(f"{name} must be a number, got NaN.")
