"""The linkages that move the joint: encoder angle to position, speed, acceleration and back.

The crank-rocker is the rig of Farzaneh (2002), appendix A.2, the slider-crank that of Mukras et al.
(2008); the positions, their time derivatives and the inverse maps are exact.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, check_fields, formula
from erlif.models.four_bar import measures

# A full turn. [rad]
TURN = 2 * np.pi

# How far beyond a dead point an encoder angle may lie by rounding alone. [rad, m]
DEAD_POINT_TOLERANCE = 1e-9


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
        worst = float(np.asarray(value)[np.asarray(outside)].flat[0])
        least, most, found = (_with_unit(number, name) for number in (low, high, worst))
        raise ModelError(
            f"{name} must lie in the reach of the linkage, {least} to {most}, got {found}."
        )
    return np.clip(value, low, high)


def _with_unit(value: float, name: str) -> str:
    """Text of an angle in both of its usual units, or of a length."""
    return (
        f"{value:.6g} rad ({np.degrees(value):.4f} degrees)"
        if name.endswith("angle")
        else f"{value:.6g} m"
    )


def _sight(link: Values, ground: Values, angle: Values) -> tuple[Values, Values]:
    """Distance and direction of the end of a link, seen from the other end of the ground."""
    distance = np.sqrt(link**2 + ground**2 - 2 * link * ground * np.cos(angle))
    return distance, np.arctan2(link * np.sin(angle), ground - link * np.cos(angle))


@dataclass(frozen=True)
class CrankRocker:
    """Four-bar linkage whose crank turns fully while its rocker swings. Farzaneh (2002), app. A.2.

    With the crank pivot at the origin and the rocker pivot at (ground, 0), the crank pin is at
    crank (cos t, sin t) and the rocker pin at (ground - rocker cos psi, rocker sin psi), joined by
    the coupler. The crank angle t is 0 where the crank points at the rocker pivot and grows towards
    the side on which the rocker stands; the rocker angle psi is the interior angle at the rocker
    pivot from the ground link; the coupler angle phi is the direction from crank pin to rocker pin
    against the ground link, in the sense of t. All lengths are distances of joint centres in m,
    all angles in rad.

    Raises
    ------
    ModelError
        A length that is not one positive number, or a linkage in which the crank cannot turn fully
        while the rocker swings (Grashof: the crank is the shortest link, and shortest plus longest
        is less than the sum of the other two).

    Attributes
    ----------
    crank, coupler, rocker, ground : float
        Lengths from crank pivot to crank pin, on to the rocker pin, from rocker pivot to rocker
        pin, and from pivot to pivot. [m]

    Examples
    --------
    The rig swings by 24.43 degrees; the source prints 26:

    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> smallest, largest = np.degrees(rig.limits())
    >>> print(f"{largest - smallest:.2f}")
    24.43
    """

    crank: float
    coupler: float
    rocker: float
    ground: float

    def __post_init__(self) -> None:
        check_fields(self)

        # Grashof's condition
        others = sorted((self.coupler, self.rocker, self.ground))
        long, rest = self.crank + others[2], others[0] + others[1]
        if not (self.crank < others[0] and long < rest):
            raise ModelError(
                f"crank, coupler, rocker and ground of {self.crank:g}, {self.coupler:g}, "
                f"{self.rocker:g} and {self.ground:g} m are no crank-rocker: the crank must be the "
                f"shortest link, and crank plus longest link ({long:g} m) less than the other two "
                f"({rest:g} m)."
            )

    @property
    def links(self) -> measures.Links:
        """The four lengths, as the measures of a linkage take them. [m]"""
        return measures.Links(self.crank, self.coupler, self.rocker, self.ground)

    @formula()
    def rocker_angle(self, crank_angle: Values) -> Values:
        """Rocker angle at a crank angle, on the branch where the linkage is open.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Interior angle psi at the rocker pivot. [rad]
        """
        # law of cosines in the triangle of coupler, rocker and diagonal
        a, b, c, d = self.links
        diagonal, to_crank_pin = _sight(a, d, crank_angle)
        return to_crank_pin + np.arccos((c**2 + diagonal**2 - b**2) / (2 * c * diagonal))

    @formula()
    def coupler_angle(self, crank_angle: Values) -> Values:
        """Coupler angle at a crank angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Direction phi of the coupler against the ground link. [rad]
        """
        psi = self.rocker_angle(crank_angle)
        return np.arctan2(
            self.rocker * np.sin(psi) - self.crank * np.sin(crank_angle),
            self.ground - self.rocker * np.cos(psi) - self.crank * np.cos(crank_angle),
        )

    @formula()
    def transmission_angle(self, crank_angle: Values) -> Values:
        """Angle between coupler and rocker; at 90 degrees the coupler has its longest lever.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Angle at the rocker pin. [rad]
        """
        # the same triangle, at the rocker pin
        a, b, c, d = self.links
        diagonal, _ = _sight(a, d, crank_angle)
        return np.arccos((b**2 + c**2 - diagonal**2) / (2 * b * c))

    @formula()
    def rocker_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the rocker angle, exact.

        The rule of Farzaneh (2002), appendix A.2, crank speed times crank over rocker, is 0.6 to
        1.1 % low on that rig.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]

        Returns
        -------
        float or array
            Rate of psi. [rad/s]
        """
        # both pins move at one speed along the coupler
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        return (
            crank_speed * self.crank * np.sin(phi - crank_angle) / (self.rocker * np.sin(psi + phi))
        )

    @formula()
    def coupler_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the coupler angle, exact.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]

        Returns
        -------
        float or array
            Rate of phi. [rad/s]
        """
        # the rocker pin does not move along the rocker
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        return (
            -crank_speed
            * self.crank
            * np.sin(crank_angle + psi)
            / (self.coupler * np.sin(psi + phi))
        )

    @formula()
    def rocker_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Second time derivative of the rocker angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]
        crank_acceleration : float or array
            Rate of the crank speed. [rad/s2]

        Returns
        -------
        float or array
            Second rate of psi. [rad/s2]
        """
        phi, psi = self.coupler_angle(crank_angle), self.rocker_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        psi_rate = self.rocker_speed(crank_angle, crank_speed=crank_speed)

        # the rate of: rocker psi_rate sin(psi + phi) = crank crank_speed sin(phi - t)
        driven = crank_acceleration * np.sin(phi - crank_angle)
        driven = driven + crank_speed * np.cos(phi - crank_angle) * (phi_rate - crank_speed)
        turning = psi_rate * np.cos(psi + phi) * (psi_rate + phi_rate)
        return (self.crank * driven / self.rocker - turning) / np.sin(psi + phi)

    def limits(self) -> tuple[float, float]:
        """Range of the rocker angle. Farzaneh (2002), eq. A.1.

        Returns
        -------
        (float, float)
            Smallest and largest rocker angle. [rad]

        Notes
        -----
        The source prints a swing of 26 degrees for 5.5, 44, 26 and 51 cm; its own equation gives
        24.43.
        """
        smallest, largest = measures.rocker_limits(self.links)
        return float(smallest), float(largest)

    def coupler_limits(self) -> tuple[float, float]:
        """Range of the coupler angle, at whose ends the crank is parallel to the rocker.

        Returns
        -------
        (float, float)
            Smallest and largest coupler angle. [rad]
        """
        a, b, c, d = self.links
        smallest, largest = (measures.angle_opposite(c + s * a, b, d) for s in (-1, 1))
        return float(smallest), float(largest)

    def dead_points(self) -> tuple[float, float]:
        """Crank angles at which the rocker reverses.

        Returns
        -------
        (float, float)
            Crank angle of the smallest and of the largest rocker angle, 0 to 2 pi. [rad]
        """
        at_smallest, at_largest = measures.dead_points(self.links)
        return float(at_smallest), float(at_largest)

    def time_ratio(self) -> float:
        """Duration of the slower stroke of the rocker over that of the quicker one.

        Returns
        -------
        float
            Ratio at constant crank speed, at least 1. [1]
        """
        excess = abs(float(measures.stroke_excess(self.links)))
        return (np.pi + excess) / (np.pi - excess)

    @formula(crank_speed="number")
    def speed_limits(self, *, crank_speed: float) -> tuple[float, float]:
        """Range of the rocker speed over a cycle at constant crank speed.

        Parameters
        ----------
        crank_speed : float
            Rate of the crank angle, positive. [rad/s]

        Returns
        -------
        (float, float)
            Smallest, negative, and largest rocker speed. [rad/s]

        Examples
        --------
        The rig at 114 turns per minute; the source has 2.5 rad/s both ways:

        >>> from erlif.models.mechanism import TURN, CrankRocker
        >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
        >>> print("{:.4f} {:.4f}".format(*rig.speed_limits(crank_speed=114 * TURN / 60)))
        -2.5405 2.5521
        """
        falling, rising = (measures.speed_ratio(self.links, rising=up) for up in (False, True))
        return -float(falling) * crank_speed, float(rising) * crank_speed

    @formula()
    def crank_angle(
        self, rocker_angle: Values, *, rising: Values, tolerance: float = DEAD_POINT_TOLERANCE
    ) -> Values:
        """Find the crank angle that gives a rocker angle: the map of an encoder on the rocker.

        Parameters
        ----------
        rising : bool or array of bool
            Whether the given angle or position grows while the crank turns in its positive sense.
        tolerance : float
            How far beyond the end of its range a value may lie and still count as that end. [rad]
        rocker_angle : float or array
            Interior angle at the rocker pivot. [rad]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            An angle beyond the reach of the rocker.

        Examples
        --------
        >>> from erlif.models.mechanism import CrankRocker
        >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
        >>> rising = rig.rocker_speed(4.0, crank_speed=1.0) > 0
        >>> round(rig.crank_angle(rig.rocker_angle(4.0), rising=rising), 9)
        4.0
        """
        # the triangle of crank, coupler and reach stands on either side of the reach
        psi = _within_reach(rocker_angle, self.limits(), tolerance, "rocker_angle")
        reach, to_rocker_pin = _sight(self.rocker, self.ground, psi)
        apart = measures.angle_opposite(self.coupler, reach, self.crank)
        return (to_rocker_pin - _sign(rising) * apart) % TURN

    @formula()
    def crank_angle_from_coupler(
        self, coupler_angle: Values, *, rising: Values, tolerance: float = DEAD_POINT_TOLERANCE
    ) -> Values:
        """Find the crank angle that gives a coupler angle: the map of an encoder on the coupler.

        Parameters
        ----------
        rising : bool or array of bool
            Whether the given angle or position grows while the crank turns in its positive sense.
        tolerance : float
            How far beyond the end of its range a value may lie and still count as that end. [rad]
        coupler_angle : float or array
            Direction of the coupler against the ground link. [rad]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            An angle beyond the reach of the coupler.
        """
        phi = _within_reach(coupler_angle, self.coupler_limits(), tolerance, "coupler_angle")
        reach, to_rocker_pivot = _sight(self.coupler, self.ground, -phi)
        apart = measures.angle_opposite(self.rocker, reach, self.crank)
        return (to_rocker_pivot - _sign(rising) * apart) % TURN


@formula()
def crank_for_swing(swing: float, *, coupler: float, rocker: float, ground: float) -> float:
    """Find the crank length of a crank-rocker that swings its rocker through an angle.

    Farzaneh (2002), eq. A.1 solved for r1.

    Parameters
    ----------
    swing : float
        Largest less smallest rocker angle, positive. [rad]
    coupler, rocker, ground : float
        The other three lengths, positive. [m]

    Returns
    -------
    float
        Length of the crank. [m]

    Raises
    ------
    ModelError
        A value that is not one positive number, or a swing that no crank gives with these links.

    Notes
    -----
    The swing grows with the crank until the linkage stops being a crank-rocker.

    Examples
    --------
    The 26 degrees that the source prints need 5.85 cm in place of 5.5 cm:

    >>> crank = crank_for_swing(np.radians(26), coupler=0.44, rocker=0.26, ground=0.51)
    >>> round(100 * crank, 2)
    5.85
    """
    # Grashof's condition bounds the crank
    shortest, middle, longest = sorted((coupler, rocker, ground))
    longest_crank = min(shortest, shortest + middle - longest)
    if longest_crank <= 0:
        raise ModelError(
            f"coupler, rocker and ground of {coupler:g}, {rocker:g} and {ground:g} m close no "
            "triangle."
        )

    def swing_of(crank: float) -> float:
        return float(measures.swing(measures.Links(crank, coupler, rocker, ground)))

    if swing >= swing_of(longest_crank):
        widest, wanted = np.degrees(swing_of(longest_crank)), np.degrees(swing)
        links = (coupler, rocker, ground)
        raise ModelError(
            f"swing must be less than {widest:.3f} degrees with coupler {links[0]:g} m, rocker "
            f"{links[1]:g} m and ground {links[2]:g} m, got {wanted:.3f} degrees."
        )
    return float(
        scipy.optimize.brentq(lambda crank: swing_of(crank) - swing, 0.0, longest_crank, xtol=1e-15)
    )


@dataclass(frozen=True)
class SliderCrank:
    """Crank, connecting rod and slider on a line through the crank pivot. Mukras et al. (2008).

    Eqs. 6 and 16 to 19 of the source. The slider runs along x. The crank angle t is 0 at the outer
    dead centre and grows anticlockwise; the coupler angle phi is the direction of the connecting
    rod from crank pin to slider, 0 at both dead centres and negative while the crank pin is above
    the line.

    With a clearance the crank-pin joint is in continuous contact with the rod in tension: pin
    centre, bushing centre and contact point stay on one line, and the rod acts as if it were longer
    by the clearance. All lengths are in m, all angles in rad.

    Raises
    ------
    ModelError
        A length that is not one positive number, a negative clearance, or a rod not longer than the
        crank.

    Attributes
    ----------
    crank : float
        Length from crank pivot to crank pin. [m]
    coupler : float
        Length of the connecting rod between joint centres. [m]
    clearance : float
        Bushing radius less pin radius at the crank pin, wear included. [m]

    Notes
    -----
    The constraints of the source count half lengths, so its Table 1 lengths are halves: its crank
    is 76.2 mm and its rod 203.2 mm (as full lengths the printed moments of inertia would exceed
    those of any rod of that mass). Eq. 18 has two roots; the physical one,
    phi1 + alpha = phi2 + pi, lengthens the rod. Row 1 of eq. 19 lacks the index of phi1.

    Examples
    --------
    The stroke of the slider is twice the crank:

    >>> smallest, largest = SliderCrank(crank=0.0762, coupler=0.2032).slider_limits()
    >>> round(largest - smallest, 4)
    0.1524
    """

    crank: float
    coupler: float
    clearance: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self, clearance="number or zero")
        if not self.coupler > self.crank:
            raise ModelError(
                "coupler must be longer than the crank for the crank to turn fully, got coupler "
                f"{self.coupler:g} m and crank {self.crank:g} m."
            )

    @property
    def rod(self) -> float:
        """Distance from crank-pin centre to slider pin: coupler plus clearance. [m]"""
        return self.coupler + self.clearance

    @formula()
    def coupler_angle(self, crank_angle: Values) -> Values:
        """Coupler angle at a crank angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Direction phi of the rod from crank pin to slider. [rad]
        """
        # the slider pin stays on the line: crank sin t + rod sin phi = 0
        return np.arcsin(-self.crank * np.sin(crank_angle) / self.rod)

    @formula()
    def coupler_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate of the coupler angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]

        Returns
        -------
        float or array
            Rate of phi. [rad/s]
        """
        # the rate of: crank sin t + rod sin phi = 0
        phi = self.coupler_angle(crank_angle)
        return -crank_speed * self.crank * np.cos(crank_angle) / (self.rod * np.cos(phi))

    @formula()
    def coupler_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Second time derivative of the coupler angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]
        crank_acceleration : float or array
            Rate of the crank speed. [rad/s2]

        Returns
        -------
        float or array
            Second rate of phi. [rad/s2]
        """
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        pin = crank_speed**2 * np.sin(crank_angle) - crank_acceleration * np.cos(crank_angle)
        return self.crank * pin / (self.rod * np.cos(phi)) + phi_rate**2 * np.tan(phi)

    @formula()
    def slider_position(self, crank_angle: Values) -> Values:
        """Distance from crank pivot to slider pin at a crank angle.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Position of the slider pin along x. [m]
        """
        phi = self.coupler_angle(crank_angle)
        return self.crank * np.cos(crank_angle) + self.rod * np.cos(phi)

    @formula()
    def slider_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Speed of the slider, positive away from the crank pivot.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]

        Returns
        -------
        float or array
            Rate of the slider position. [m/s]
        """
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        return -self.crank * crank_speed * np.sin(crank_angle) - self.rod * phi_rate * np.sin(phi)

    @formula()
    def slider_acceleration(
        self, crank_angle: Values, *, crank_speed: Values, crank_acceleration: Values = 0.0
    ) -> Values:
        """Acceleration of the slider, positive away from the crank pivot.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]
        crank_acceleration : float or array
            Rate of the crank speed. [rad/s2]

        Returns
        -------
        float or array
            Second rate of the slider position. [m/s2]
        """
        phi = self.coupler_angle(crank_angle)
        phi_rate = self.coupler_speed(crank_angle, crank_speed=crank_speed)
        phi_second = self.coupler_acceleration(
            crank_angle, crank_speed=crank_speed, crank_acceleration=crank_acceleration
        )
        pin = crank_acceleration * np.sin(crank_angle) + crank_speed**2 * np.cos(crank_angle)
        return -self.crank * pin - self.rod * (phi_second * np.sin(phi) + phi_rate**2 * np.cos(phi))

    @formula()
    def joint_angle(self, crank_angle: Values) -> Values:
        """Angle by which the crank pin has turned in the bushing of the connecting rod: t - phi.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]

        Returns
        -------
        float or array
            Angle of the pin against the rod. [rad]
        """
        return crank_angle - self.coupler_angle(crank_angle)

    @formula()
    def joint_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate at which the crank pin turns in the bushing of the connecting rod.

        Parameters
        ----------
        crank_angle : float or array
            Crank angle t. [rad]
        crank_speed : float or array
            Rate of the crank angle. [rad/s]

        Returns
        -------
        float or array
            Rate of the angle of the pin against the rod. [rad/s]
        """
        return crank_speed - self.coupler_speed(crank_angle, crank_speed=crank_speed)

    def limits(self) -> tuple[float, float]:
        """Range of the coupler angle.

        Returns
        -------
        (float, float)
            Smallest and largest coupler angle. [rad]
        """
        swing = float(np.arcsin(self.crank / self.rod))
        return -swing, swing

    def slider_limits(self) -> tuple[float, float]:
        """Range of the slider position.

        Returns
        -------
        (float, float)
            Smallest and largest distance from the crank pivot. [m]
        """
        return self.rod - self.crank, self.rod + self.crank

    def dead_points(self) -> tuple[float, float]:
        """Crank angles at which the coupler reverses.

        Returns
        -------
        (float, float)
            Crank angle of the smallest and of the largest coupler angle, 0 to 2 pi. [rad]
        """
        return np.pi / 2, 3 * np.pi / 2

    @formula()
    def crank_angle(
        self, coupler_angle: Values, *, rising: Values, tolerance: float = DEAD_POINT_TOLERANCE
    ) -> Values:
        """Find the crank angle that gives a coupler angle: the map of an encoder on the rod.

        Parameters
        ----------
        rising : bool or array of bool
            Whether the given angle or position grows while the crank turns in its positive sense.
        tolerance : float
            How far beyond the end of its range a value may lie and still count as that end. [rad]
        coupler_angle : float or array
            Direction of the rod from crank pin to slider. [rad]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            An angle beyond the reach of the rod.
        """
        phi = _within_reach(coupler_angle, self.limits(), tolerance, "coupler_angle")
        height = np.clip(-self.rod * np.sin(phi) / self.crank, -1.0, 1.0)
        falling_side = np.arcsin(height)  # cos t > 0, where phi falls
        return (np.pi / 2 + _sign(rising) * (np.pi / 2 - falling_side)) % TURN

    @formula()
    def crank_angle_from_slider(
        self, slider_position: Values, *, rising: Values, tolerance: float = DEAD_POINT_TOLERANCE
    ) -> Values:
        """Find the crank angle that gives a slider position.

        Parameters
        ----------
        rising : bool or array of bool
            Whether the given angle or position grows while the crank turns in its positive sense.
        slider_position : float or array
            Distance from crank pivot to slider pin. [m]
        tolerance : float
            How far beyond a dead centre a position may lie and still count as its end. [m]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            A position beyond the reach of the slider.
        """
        x = _within_reach(slider_position, self.slider_limits(), tolerance, "slider_position")
        apart = measures.angle_opposite(self.rod, x, self.crank)
        return (-_sign(rising) * apart) % TURN
