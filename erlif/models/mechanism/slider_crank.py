"""Crank, connecting rod and slider, with a clearance at the crank pin. Mukras et al. (2008)."""

from dataclasses import dataclass

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import (
    Values,
    check_fields,
    formula,
)
from erlif.models.mechanism.reach import DEAD_POINT_TOLERANCE, TURN, sign, within_reach


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
                f"coupler must be longer than the crank for the crank to turn fully, got coupler "
                f"{self.coupler:g} m and crank {self.crank:g} m."
            )

    @property
    def rod(self) -> float:
        """Distance from crank-pin centre to slider pin: coupler plus clearance. [m]"""
        return self.coupler + self.clearance

    @formula()
    def coupler_angle(self, crank_angle: Values) -> Values:
        """Coupler angle at a crank angle.

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

        Returns
        -------
        float or array
            Angle of the pin against the rod. [rad]
        """
        return crank_angle - self.coupler_angle(crank_angle)

    @formula()
    def joint_speed(self, crank_angle: Values, *, crank_speed: Values) -> Values:
        """Rate at which the crank pin turns in the bushing of the connecting rod.

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
        coupler_angle : float or array
            Direction of the rod from crank pin to slider. [rad]
        rising : bool or array of bool
            Whether the coupler angle grows while the crank turns in its positive sense.
        tolerance : float
            How far beyond a dead point an angle may lie and still be taken as the dead point. [rad]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            An angle beyond the reach of the rod.
        """
        phi = within_reach(coupler_angle, self.limits(), tolerance, "coupler_angle")
        height = np.clip(-self.rod * np.sin(phi) / self.crank, -1.0, 1.0)
        falling_side = np.arcsin(height)  # cos t > 0, where phi falls
        return (np.pi / 2 + sign(rising) * (np.pi / 2 - falling_side)) % TURN

    @formula()
    def crank_angle_from_slider(
        self, slider_position: Values, *, rising: Values, tolerance: float = DEAD_POINT_TOLERANCE
    ) -> Values:
        """Find the crank angle that gives a slider position.

        Parameters
        ----------
        slider_position : float or array
            Distance from crank pivot to slider pin. [m]
        rising : bool or array of bool
            Whether the slider moves away from the crank pivot while the crank turns in its positive
            sense.
        tolerance : float
            How far beyond a dead centre a position may lie and still be taken as its end. [m]

        Returns
        -------
        float or array
            Crank angle, 0 to 2 pi. [rad]

        Raises
        ------
        ModelError
            A position beyond the reach of the slider.
        """
        x = within_reach(slider_position, self.slider_limits(), tolerance, "slider_position")
        # the half-angle form stays exact at the dead centres, where the cosine is flat
        beyond = np.maximum(self.rod**2 - (x - self.crank) ** 2, 0.0)
        short = np.maximum((x + self.crank) ** 2 - self.rod**2, 0.0)
        return (-sign(rising) * 2 * np.arctan2(np.sqrt(beyond), np.sqrt(short))) % TURN
