"""The linkages that move the joint: encoder angle to position, speed, acceleration and back."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, require_positive

TURN = 2 * np.pi


@dataclass(frozen=True)
class CrankRocker:
    """Four-bar linkage whose crank turns fully while its rocker swings. Farzaneh (2002), appendix A.2.

    With the crank pivot at the origin and the rocker pivot at (ground, 0), the crank pin is at
    crank (cos t, sin t) and the rocker pin at (ground - rocker cos psi, rocker sin psi), joined by the coupler.
    The crank angle t is 0 where the crank points at the rocker pivot and grows towards the side on which the rocker
    stands; the rocker angle psi is the interior angle at the rocker pivot from the ground link; the coupler angle phi
    is the direction from crank pin to rocker pin against the ground link, in the sense of t.

    Parameters
    ----------
    crank, coupler, rocker, ground : float
        Lengths between joint centres. [m]

    Raises
    ------
    ModelError
        A length that is not positive, or a linkage in which the crank cannot turn fully while the rocker swings
        (Grashof: the crank is the shortest link, and shortest plus longest is less than the sum of the other two).
    """

    crank: float
    coupler: float
    rocker: float
    ground: float

    def __post_init__(self) -> None:
        require_positive(
            crank=self.crank, coupler=self.coupler, rocker=self.rocker, ground=self.ground
        )
        others = sorted((self.coupler, self.rocker, self.ground))
        if not (self.crank < others[0] and self.crank + others[2] < others[0] + others[1]):
            raise ModelError(
                f"crank, coupler, rocker and ground of {self.crank:g}, {self.coupler:g}, {self.rocker:g} and "
                f"{self.ground:g} m are no crank-rocker: the crank must be the shortest link, and crank plus longest "
                f"link ({self.crank + others[2]:g} m) less than the other two ({others[0] + others[1]:g} m)."
            )

    def rocker_angle(self, crank_angle: Values) -> Values:
        """Rocker angle [rad] at a crank angle [rad], on the branch where the linkage is open."""
        a, b, c, d = self.crank, self.coupler, self.rocker, self.ground
        diagonal = self._diagonal(crank_angle)
        to_crank_pin = np.arctan2(a * np.sin(crank_angle), d - a * np.cos(crank_angle))
        return to_crank_pin + np.arccos((c**2 + diagonal**2 - b**2) / (2 * c * diagonal))

    def coupler_angle(self, crank_angle: Values) -> Values:
        """Coupler angle [rad] at a crank angle [rad]."""
        psi = self.rocker_angle(crank_angle)
        return np.arctan2(
            self.rocker * np.sin(psi) - self.crank * np.sin(crank_angle),
            self.ground - self.rocker * np.cos(psi) - self.crank * np.cos(crank_angle),
        )

    def transmission_angle(self, crank_angle: Values) -> Values:
        """Angle [rad] between coupler and rocker; at 90 degrees the coupler force turns the rocker best."""
        b, c = self.coupler, self.rocker
        return np.arccos((b**2 + c**2 - self._diagonal(crank_angle) ** 2) / (2 * b * c))

    def rocker_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the rocker angle [rad/s] for a crank speed [rad/s], exact.

        The rule of Farzaneh (2002), appendix A.2, crank speed times crank over rocker, is 0.6 to 1.1 % low on that rig.
        """
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        return (
            crank_speed * self.crank * np.sin(phi - crank_angle) / (self.rocker * np.sin(psi + phi))
        )

    def coupler_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the coupler angle [rad/s] for a crank speed [rad/s]."""
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        return (
            -crank_speed
            * self.crank
            * np.sin(crank_angle + psi)
            / (self.coupler * np.sin(psi + phi))
        )

    def rocker_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Second rate of the rocker angle [rad/s2] for a crank speed [rad/s] and a crank acceleration [rad/s2]."""
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        psi_rate = self.rocker_speed(crank_angle, crank_speed=crank_speed)
        # the rate of: rocker psi_rate sin(psi + phi) = crank crank_speed sin(phi - t)
        driven = crank_acceleration * np.sin(phi - crank_angle)
        driven = driven + crank_speed * np.cos(phi - crank_angle) * (phi_rate - crank_speed)
        turning = psi_rate * np.cos(psi + phi) * (psi_rate + phi_rate)
        return (self.crank * driven / self.rocker - turning) / np.sin(psi + phi)

    def limits(self) -> tuple[float, float]:
        """Smallest and largest rocker angle [rad]; Farzaneh (2002), eq. A.1.

        Note: the thesis prints a swing of 26 degrees for 5.5, 44, 26 and 51 cm; its own equation gives 24.43.
        """
        return self._rocker_angle_at(self.coupler - self.crank), self._rocker_angle_at(
            self.coupler + self.crank
        )

    def coupler_limits(self) -> tuple[float, float]:
        """Smallest and largest coupler angle [rad], where the crank is parallel to the rocker."""
        b, d = self.coupler, self.ground
        shortest, longest = self.rocker - self.crank, self.rocker + self.crank
        return (
            float(np.arccos((b**2 + d**2 - shortest**2) / (2 * b * d))),
            float(np.arccos((b**2 + d**2 - longest**2) / (2 * b * d))),
        )

    def dead_points(self) -> tuple[float, float]:
        """Crank angles [rad, 0 to 2 pi] at which the rocker angle is smallest and largest."""
        smallest, largest = self.limits()
        return float(self._direction_of_rocker_pin(smallest) + np.pi), float(
            self._direction_of_rocker_pin(largest)
        )

    def time_ratio(self) -> float:
        """Time of the slower stroke of the rocker over the time of the quicker one, at constant crank speed."""
        at_smallest, at_largest = self.dead_points()
        falling = at_smallest - at_largest
        return max(falling, TURN - falling) / min(falling, TURN - falling)

    def speed_limits(self, *, crank_speed: float) -> tuple[float, float]:
        """Smallest (negative) and largest rocker speed [rad/s] of a cycle at constant crank speed [rad/s]."""
        require_positive(crank_speed=crank_speed)
        at_smallest, at_largest = self.dead_points()

        def acceleration(crank_angle: float) -> float:
            return float(self.rocker_acceleration(crank_angle, crank_speed=crank_speed))

        at_fastest_fall = brentq(acceleration, at_largest, at_smallest, xtol=1e-14)
        at_fastest_rise = brentq(acceleration, at_smallest, at_largest + TURN, xtol=1e-14)
        return (
            float(self.rocker_speed(at_fastest_fall, crank_speed=crank_speed)),
            float(self.rocker_speed(at_fastest_rise, crank_speed=crank_speed)),
        )

    def crank_angle(
        self, rocker_angle: Values, *, rising: Values, tolerance: float = 1e-9
    ) -> Values:
        """Find the crank angle that gives a rocker angle: the map of an encoder that sits on the rocker.

        Parameters
        ----------
        rocker_angle : float or array
            Interior angle at the rocker pivot. [rad]
        rising : bool or array of bool
            Whether the rocker angle grows while the crank turns in its positive sense.
        tolerance : float
            How far beyond a dead point an angle may lie and still be taken as the dead point. [rad]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            An angle beyond the reach of the rocker.
        """
        psi = _within_reach(rocker_angle, self.limits(), tolerance, "rocker_angle")
        reach = np.sqrt(
            self.rocker**2 + self.ground**2 - 2 * self.rocker * self.ground * np.cos(psi)
        )
        apart = self._angle_off_the_line(reach, self.coupler)
        return (self._direction_of_rocker_pin(psi) - _sign(rising) * apart) % TURN

    def crank_angle_from_coupler(
        self, coupler_angle: Values, *, rising: Values, tolerance: float = 1e-9
    ) -> Values:
        """Find the crank angle that gives a coupler angle: the map of an encoder that sits on the intermediate link.

        Parameters, result and errors as in `crank_angle`, with the coupler in the place of the rocker.
        """
        phi = _within_reach(coupler_angle, self.coupler_limits(), tolerance, "coupler_angle")
        b, d = self.coupler, self.ground
        reach = np.sqrt(b**2 + d**2 - 2 * b * d * np.cos(phi))
        apart = self._angle_off_the_line(reach, self.rocker)
        return (np.arctan2(-b * np.sin(phi), d - b * np.cos(phi)) - _sign(rising) * apart) % TURN

    def _diagonal(self, crank_angle: Values) -> Values:
        """Distance [m] from the crank pin to the rocker pivot."""
        a, d = self.crank, self.ground
        return np.sqrt(a**2 + d**2 - 2 * a * d * np.cos(crank_angle))

    def _rocker_angle_at(self, reach: float) -> float:
        """Rocker angle at which the rocker pin is `reach` from the crank pivot."""
        c, d = self.rocker, self.ground
        return float(np.arccos((c**2 + d**2 - reach**2) / (2 * c * d)))

    def _direction_of_rocker_pin(self, rocker_angle: Values) -> Values:
        """Direction of the rocker pin seen from the crank pivot."""
        return np.arctan2(
            self.rocker * np.sin(rocker_angle), self.ground - self.rocker * np.cos(rocker_angle)
        )

    def _angle_off_the_line(self, reach: Values, closing_link: float) -> Values:
        """Angle at the crank pivot in the triangle of crank, `closing_link` and `reach`."""
        # the half-angle form stays exact at the dead points, where the cosine is flat
        beyond = np.maximum(closing_link**2 - (reach - self.crank) ** 2, 0.0)
        short = np.maximum((reach + self.crank) ** 2 - closing_link**2, 0.0)
        return 2 * np.arctan2(np.sqrt(beyond), np.sqrt(short))


@dataclass(frozen=True)
class SliderCrank:
    """Crank, connecting rod and slider on a line through the crank pivot. Mukras et al. (2008), eqs. 6 and 16 to 19.

    The slider runs along x. The crank angle t is 0 at the outer dead centre and grows anticlockwise; the coupler angle
    phi is the direction of the connecting rod from crank pin to slider, 0 at both dead centres and negative while the
    crank pin is above the line.

    With a `clearance` the crank-pin joint is in continuous contact with the rod in tension: pin centre, bushing centre
    and contact point stay on one line, and the rod acts as if it were longer by the clearance.

    Parameters
    ----------
    crank, coupler : float
        Lengths of crank and connecting rod between joint centres. [m]
    clearance : float
        Bushing radius less pin radius at the crank pin, wear included. [m]

    Raises
    ------
    ModelError
        A length that is not positive, a negative clearance, or a rod not longer than the crank.

    Notes
    -----
    The constraints of the source count half lengths, so its Table 1 lengths are halves: its crank is 76.2 mm and its
    rod 203.2 mm (as full lengths the printed moments of inertia would exceed those of any rod of that mass). Eq. 18 has
    two roots; the physical one, phi1 + alpha = phi2 + pi, lengthens the rod. Row 1 of eq. 19 lacks the index of phi1.
    """

    crank: float
    coupler: float
    clearance: float = 0.0

    def __post_init__(self) -> None:
        require_positive(crank=self.crank, coupler=self.coupler)
        if not self.clearance >= 0:
            raise ModelError(f"clearance must not be negative, got {self.clearance:g} m.")
        if not self.coupler > self.crank:
            raise ModelError(
                f"coupler must be longer than the crank for the crank to turn fully, got coupler {self.coupler:g} m "
                f"and crank {self.crank:g} m."
            )

    @property
    def rod(self) -> float:
        """Distance from crank-pin centre to slider pin [m]: the coupler, lengthened by the clearance."""
        return self.coupler + self.clearance

    def coupler_angle(self, crank_angle: Values) -> Values:
        """Coupler angle [rad] at a crank angle [rad]."""
        return np.arcsin(-self.crank * np.sin(crank_angle) / self.rod)

    def coupler_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the coupler angle [rad/s] for a crank speed [rad/s]."""
        phi = self.coupler_angle(crank_angle)
        return -crank_speed * self.crank * np.cos(crank_angle) / (self.rod * np.cos(phi))

    def coupler_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Second rate of the coupler angle [rad/s2] for a crank speed [rad/s] and a crank acceleration [rad/s2]."""
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        pin = crank_speed**2 * np.sin(crank_angle) - crank_acceleration * np.cos(crank_angle)
        return self.crank * pin / (self.rod * np.cos(phi)) + phi_rate**2 * np.tan(phi)

    def slider_position(self, crank_angle: Values) -> Values:
        """Distance [m] from crank pivot to slider pin at a crank angle [rad]."""
        return self.crank * np.cos(crank_angle) + self.rod * np.cos(self.coupler_angle(crank_angle))

    def slider_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Speed of the slider [m/s], away from the crank pivot, for a crank speed [rad/s]."""
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        return -self.crank * crank_speed * np.sin(crank_angle) - self.rod * phi_rate * np.sin(phi)

    def slider_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Acceleration of the slider [m/s2] for a crank speed [rad/s] and a crank acceleration [rad/s2]."""
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        phi_second = self.coupler_acceleration(
            crank_angle, crank_speed=crank_speed, crank_acceleration=crank_acceleration
        )
        pin = crank_acceleration * np.sin(crank_angle) + crank_speed**2 * np.cos(crank_angle)
        return -self.crank * pin - self.rod * (phi_second * np.sin(phi) + phi_rate**2 * np.cos(phi))

    def joint_angle(self, crank_angle: Values) -> Values:
        """Angle [rad] by which the crank pin has turned in the bushing of the connecting rod: t - phi."""
        return crank_angle - self.coupler_angle(crank_angle)

    def joint_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate [rad/s] at which the crank pin turns in the bushing of the connecting rod."""
        return crank_speed - self.coupler_speed(crank_angle, crank_speed=crank_speed)

    def limits(self) -> tuple[float, float]:
        """Smallest and largest coupler angle [rad]."""
        swing = float(np.arcsin(self.crank / self.rod))
        return -swing, swing

    def slider_limits(self) -> tuple[float, float]:
        """Smallest and largest slider position [m]."""
        return self.rod - self.crank, self.rod + self.crank

    def dead_points(self) -> tuple[float, float]:
        """Crank angles [rad, 0 to 2 pi] at which the coupler angle is smallest and largest."""
        return np.pi / 2, 3 * np.pi / 2

    def crank_angle(
        self, coupler_angle: Values, *, rising: Values, tolerance: float = 1e-9
    ) -> Values:
        """Find the crank angle [rad, 0 to 2 pi] that gives a coupler angle: the map of an encoder on the rod.

        `rising` says whether the coupler angle grows while the crank turns in its positive sense; an angle at most
        `tolerance` beyond a dead point is taken as the dead point, one further out raises ModelError.
        """
        phi = _within_reach(coupler_angle, self.limits(), tolerance, "coupler_angle")
        height = np.clip(-self.rod * np.sin(phi) / self.crank, -1.0, 1.0)
        falling_side = np.arcsin(height)  # cos t > 0, where phi falls
        return (np.pi / 2 + _sign(rising) * (np.pi / 2 - falling_side)) % TURN

    def crank_angle_from_slider(
        self, slider_position: Values, *, rising: Values, tolerance: float = 1e-9
    ) -> Values:
        """Find the crank angle [rad, 0 to 2 pi] that gives a slider position [m]; `rising`: the slider moves out."""
        x = _within_reach(slider_position, self.slider_limits(), tolerance, "slider_position")
        beyond = np.maximum(self.rod**2 - (x - self.crank) ** 2, 0.0)
        short = np.maximum((x + self.crank) ** 2 - self.rod**2, 0.0)
        return (-_sign(rising) * 2 * np.arctan2(np.sqrt(beyond), np.sqrt(short))) % TURN


def crank_for_swing(swing: float, *, coupler: float, rocker: float, ground: float) -> float:
    """Find the crank length [m] of a crank-rocker that swings its rocker through an angle: eq. A.1 solved for r1.

    Parameters
    ----------
    swing : float
        Largest less smallest rocker angle. [rad]
    coupler, rocker, ground : float
        The other three lengths. [m]

    Raises
    ------
    ModelError
        A length that is not positive, or a swing that no crank gives with these links.

    Notes
    -----
    Farzaneh (2002), eq. A.1. The swing grows with the crank until the linkage stops being a crank-rocker.
    """
    require_positive(swing=swing, coupler=coupler, rocker=rocker, ground=ground)
    shortest, middle, longest = sorted((coupler, rocker, ground))
    longest_crank = min(shortest, shortest + middle - longest)
    if longest_crank <= 0:
        raise ModelError(
            f"coupler, rocker and ground of {coupler:g}, {rocker:g} and {ground:g} m close no triangle."
        )

    def swing_of(crank: float) -> float:
        cosines = [
            (rocker**2 + ground**2 - (coupler + s * crank) ** 2) / (2 * rocker * ground)
            for s in (-1, 1)
        ]
        smallest, largest = np.arccos(np.clip(cosines, -1.0, 1.0))
        return float(largest - smallest)

    if swing >= swing_of(longest_crank):
        raise ModelError(
            f"swing must be less than {np.degrees(swing_of(longest_crank)):.3f} degrees with coupler {coupler:g} m, "
            f"rocker {rocker:g} m and ground {ground:g} m, got {np.degrees(swing):.3f} degrees."
        )
    return float(brentq(lambda crank: swing_of(crank) - swing, 0.0, longest_crank, xtol=1e-15))


def _sign(rising: Values) -> Values:
    """1 where rising, -1 where falling, of the type of `rising`."""
    return 2 * (rising * 1) - 1


def _within_reach(
    value: Values, limits: tuple[float, float], tolerance: float, name: str
) -> Values:
    """`value` clipped to `limits`, refused where it lies further out than `tolerance`."""
    low, high = limits
    outside = np.less(value, low - tolerance) | np.greater(value, high + tolerance)
    if np.any(outside):
        worst = np.asarray(value)[np.asarray(outside)].flat[0]
        raise ModelError(
            f"{name} must lie in the reach of the linkage, {_told(low, name)} to {_told(high, name)}, "
            f"got {_told(float(worst), name)}."
        )
    return np.clip(value, low, high)


def _told(value: float, name: str) -> str:
    return (
        f"{value:.6g} rad ({np.degrees(value):.4f} degrees)"
        if name.endswith("angle")
        else f"{value:.6g} m"
    )
