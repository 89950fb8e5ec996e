"""Equations of motion of the slider-crank: a rod with a fixed lever, and a pin that moves freely.

Mukras et al. (2008), eqs. 6 to 19, in the fewest coordinates. Each joint gives the rates of its
state, with the work of every force as further states.
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, atan, atan2, cos, hypot, sin, sqrt, tan, tanh
from typing import TYPE_CHECKING, Any

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.slider.contact import ContactLaw, RoundBore, WornBore
from erlif.models.mechanism import SliderCrank

if TYPE_CHECKING:
    import xarray as xr

# Torque on the crank [N m] at a time [s] and a crank angle [rad].
Torque = Callable[[float, float], float]

# Sine of the rod angle at most.
_STEEPEST = 0.999999

# The friction couple changes the force by mu r / rod of itself: a pass gains two digits.
_FRICTION_PASSES = 8

# Each pass gains the digits of clearance over rod.
_REST_PASSES = 3

# Sliding speed below which friction falls to zero, as a hyperbolic tangent. [m/s]
_SLOWEST_SLIP = 1e-3

# Integrals over time, at the end of each state.
QUADRATURES = ("drive_work", "friction_loss", "impact_loss", "rubbing")


class SliderLinks:
    """Data of both kinds of joint: lengths, bodies, drive and spring, as plain numbers."""

    def __init__(
        self,
        linkage: SliderCrank,
        bodies: SliderCrankBodies,
        torque: Torque | None,
        crank_inertia: float,
    ) -> None:
        self.crank, self.clearance = linkage.crank, linkage.clearance
        self.half, self.coupler = linkage.coupler / 2, linkage.coupler
        self.rod_mass, self.rod_inertia = float(bodies.rod_mass), float(bodies.rod_inertia)
        self.slider_mass, self.friction = float(bodies.slider_mass), float(bodies.friction)
        self.spring, self.preload = float(bodies.spring_stiffness), float(bodies.spring_preload)
        self.pin_radius = float(bodies.pin_radius)
        self.torque, self.crank_inertia = torque, crank_inertia

    def pull(self, position: float) -> float:
        """Force of the spring on the slider, outward."""
        return self.preload + self.spring * (self.crank + self.coupler - position)

    def with_energies(self, now: dict[str, float], integrals: Array) -> dict[str, float]:
        """The motion and forces of a moment, with its energies and the integrals so far."""
        speed, phi, rate = now["slider_speed"], now["rod_angle"], now["rod_speed"]
        rod_x = speed + self.half * sin(phi) * rate
        rod_y = -self.half * cos(phi) * rate
        now["kinetic_energy"] = (
            self.crank_inertia * now["crank_speed"] ** 2
            + self.rod_mass * (rod_x**2 + rod_y**2)
            + self.rod_inertia * rate**2
            + self.slider_mass * speed**2
        ) / 2
        stretch = self.crank + self.coupler - now["slider_position"]
        now["spring_energy"] = self.preload * stretch + self.spring * stretch**2 / 2
        return now | dict(zip(QUADRATURES, integrals, strict=True))


class SimplifiedJoint(SliderLinks):
    """Rod with a fixed lever to the pin centre: perfect joint, or lengthened by the clearance."""

    slowest_impact = 1.0  # not used: the joint has no law of contact

    def gap(self, _state: Array) -> float:
        """Return a positive number: the pin of this joint never separates."""
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
        sense = tanh(slip / _SLOWEST_SLIP)
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
            "contact_energy": 0.0,
        }
        return self.with_energies(now, state[2:])


class GeneralJoint(SliderLinks):
    """Pin that moves in its bushing and touches it by a law of contact.

    The coordinates are the crank angle and the eccentricity, pin centre less bushing centre: a
    penetration is far smaller than the lengths of the links.
    """

    def __init__(self, law: ContactLaw, worn: xr.Dataset | None, *links: Any) -> None:
        super().__init__(*links)
        linkage, bodies, torque, crank_inertia = links
        self.perfect = SimplifiedJoint(
            SliderCrank(linkage.crank, linkage.coupler), bodies, None, crank_inertia
        )
        self.bore: RoundBore | WornBore = (
            RoundBore(law, self.clearance) if worn is None else WornBore(law, self.clearance, worn)
        )
        self.damping, self.slowest_impact = 0.75 * (1 - law.restitution**2), law.slowest_impact
        self.full_inertia = self.rod_mass * self.half**2 + self.rod_inertia
        if torque is not None and not crank_inertia > 0:
            raise ModelError("crank_inertia must be positive where a torque drives the crank.")

    def rest(
        self, angle: float, speed: float, eccentricity: tuple[float, float] | None
    ) -> list[float]:
        """Pin that turns with the rod, by default on the bushing as the joint loads it."""
        self.perfect.clearance = 0.0
        for _ in range(1 if eccentricity else _REST_PASSES):
            now = self.perfect.solve(angle, speed)
            phi = now["rod_angle"]
            ex, ey = eccentricity or self.bore.rest(
                now["force_x"], now["force_y"], cos(phi), sin(phi), angle - phi
            )
            # the pin lengthens the rod in tension and shortens it in compression
            self.perfect.clearance = -(ex * cos(phi) + ey * sin(phi))
        rate = now["rod_speed"]
        return [angle, speed, ex, ey, -rate * ey, rate * ex]

    def gap(self, state: Array) -> float:
        """Penetration, negative while apart."""
        return self._closing(state)[0]

    def approach(self, state: Array) -> float:
        """Rate of the penetration."""
        return self._closing(state)[1]

    def _closing(self, state: Array) -> tuple[float, float]:
        angle, speed, ex, ey, vx, vy = (float(value) for value in state[:6])
        phi, sp, cp, rate = self._rod(angle, speed, ey, vy)
        press = self.bore.press(ex, ey, cp, sp, angle - phi)
        across = ex * press.y - ey * press.x + press.twist
        closing = vx * press.x + vy * press.y - rate * across + press.twist * speed
        return press.penetration, closing

    def _rod(
        self, angle: float, speed: float, ey: float, vy: float
    ) -> tuple[float, float, float, float]:
        """Rod angle, its sine and cosine, and its rate: they follow from crank and eccentricity."""
        # a trial step may lie beyond the reach of the rod; its error refuses it
        height = (self.crank * sin(angle) - ey) / self.coupler
        phi = -asin(max(-_STEEPEST, min(_STEEPEST, height)))
        sp, cp = sin(phi), cos(phi)
        return phi, sp, cp, (vy - self.crank * cos(angle) * speed) / (self.coupler * cp)

    def solve(self, time: float, state: Array, impact_speed: float) -> dict[str, float]:
        angle, speed, ex, ey, vx, vy = (float(value) for value in state[:6])
        s, c = sin(angle), cos(angle)

        # the bushing centre follows from the pin, rod and slider from the bushing
        phi, sp, cp, rate = self._rod(angle, speed, ey, vy)
        position = self.crank * c - ex + self.coupler * cp
        x_t = -self.crank * s * speed - vx - self.coupler * sp * rate

        # normal force by the law of contact; friction across it
        press = self.bore.press(ex, ey, cp, sp, angle - phi)
        penetration, nx, ny, twist = press.penetration, press.x, press.y, press.twist
        offset = ex * ny - ey * nx  # a worn bushing does not press towards its centre
        depth_rate = vx * nx + vy * ny - rate * (offset + twist) + twist * speed
        elastic = normal = rubbed = 0.0
        if impact_speed:
            elastic = press.force
            share = max(-1.0, min(1.0, depth_rate / impact_speed))
            normal = elastic * (1 + self.damping * share)
        lever = self.pin_radius - self.bore.sunk * penetration
        arm = lever + ex * nx + ey * ny
        slip = vy * nx - vx * ny + lever * speed - arm * rate
        if self.friction:
            rubbed = self.friction * normal * tanh(slip / _SLOWEST_SLIP)
        force_x, force_y = normal * nx - rubbed * ny, normal * ny + rubbed * nx

        # Lagrange for slider and rod, with the contact at the surface of the bushing
        mixed = self.rod_mass * self.half * sp
        mass = self.rod_mass + self.slider_mass
        spring = self.pull(position)
        on_x = force_x + spring - self.rod_mass * self.half * cp * rate**2
        couple = normal * (offset + twist) + arm * rubbed
        on_phi = self.coupler * (sp * force_x - cp * force_y) + couple
        determinant = mass * self.full_inertia - mixed**2
        x_tt = (self.full_inertia * on_x - mixed * on_phi) / determinant
        phi_tt = (mass * on_phi - mixed * on_x) / determinant

        # the crank has the opposite force at the same place
        pull = self.crank * (c * force_y - s * force_x) + lever * rubbed + normal * twist
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
            "contact_energy": press.energy,
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
        return self.with_energies(self.solve(time, state, impact_speed), state[6:])
