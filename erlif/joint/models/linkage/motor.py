"""Torque and power that drive a crank-rocker against friction, and the motor for them.

Farzaneh (2002), appendix A.4.2. The friction of the joint
(`erlif.joint.models.friction.friction_torque`) opposes the rocker and changes its sign with it; the
power passes the exact linkage.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.tables import read_table
from erlif.models.arguments import formula
from erlif.models.four_bar.measures import dead_points, rocker_rates
from erlif.models.mechanism import CrankRocker

# Watts of a horsepower of 550 ft lbf/s.
HORSEPOWER = 745.7

# Standard ratings of motors: NEMA MG 1 in horsepower, IEC 60072-1 in kilowatts. [W]
RATINGS = {
    series: [{"hp": HORSEPOWER, "kW": 1e3}[series] * rating for rating in ratings]
    for series, ratings in read_table("erlif.joint.models.linkage", "motors.toml").items()
}


@dataclass(frozen=True)
class DrivePower:
    """Torque and power at the crank over a turn at constant speed.

    Attributes
    ----------
    crank_angle : array, (n,)
        Crank angle, with both dead points. [rad]
    rocker_torque : array, (n,)
        Torque that turns the rocker, positive towards larger rocker angles. At a dead point, where
        the friction changes its sign, it is that of the stroke that ends. [N m]
    crank_torque : array, (n,)
        Torque that drives the crank. [N m]
    power : array, (n,)
        Power at the crank. [W]
    peak_power : float
        Greatest power. [W]
    mean_power : float
        Mean over a turn. [W]
    rms_power : float
        Root mean square over a turn. [W]
    peak_torque : float
        Greatest size of the crank torque. [N m]
    rms_torque : float
        Root mean square of the crank torque, by which windings heat. [N m]
    """

    crank_angle: Array
    rocker_torque: Array
    crank_torque: Array
    power: Array
    peak_power: float
    mean_power: float
    rms_power: float
    peak_torque: float
    rms_torque: float


@formula(crank_speed="number", torque="number or zero")
def drive_power(
    linkage: CrankRocker,
    *,
    crank_speed: float,
    torque: float,
    inertia: float = 0.0,
    efficiency: float = 1.0,
    points: int = 720,
) -> DrivePower:
    """Compute torque and power at the crank of a linkage whose rocker turns against friction.

    Parameters
    ----------
    linkage : CrankRocker
        Lengths of the linkage between its joints. [m]
    crank_speed : float
        Speed of the crank, constant and positive. [rad/s]
    torque : float
        Friction torque on the rocker, which opposes its motion. [N m]
    inertia : float
        Moment of inertia of all that turns with the rocker. [kg m2]
    efficiency : float
        Of linkage and gear, above 0 up to 1; power that comes back is reduced likewise. [1]
    points : int
        Points over a turn.

    Returns
    -------
    DrivePower
        Torques and power over a turn; the extremes are those of the points.

    Raises
    ------
    ModelError
        A value out of its range.

    Examples
    --------
    The machine of Farzaneh (2002), who has 7.1 hp at 24 rpm of the rocker:

    >>> from erlif.models.mechanism import CrankRocker
    >>> from erlif.joint.models.linkage.motor import HORSEPOWER
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> found = drive_power(rig, crank_speed=114 * np.pi / 30, torque=2118.5)
    >>> peak, mean = found.peak_power / HORSEPOWER, found.mean_power / HORSEPOWER
    >>> print(f"{peak:.2f} hp, mean {mean:.2f} hp")
    7.25 hp, mean 4.60 hp
    """
    if efficiency > 1:
        raise ModelError(f"efficiency must be at most 1, got {efficiency:g}.")
    if points < 8:
        raise ModelError(f"points must be 8 at least, got {points}.")

    # both dead points are ends of strokes, so that the friction changes its sign at a point
    links = linkage.links
    at_smallest, at_largest = (float(angle) for angle in dead_points(links))
    half = points // 2
    rising = np.linspace(at_smallest, at_largest + 2 * np.pi, half + 1)
    falling = np.linspace(at_largest + 2 * np.pi, at_smallest + 2 * np.pi, points - half + 1)
    angle = np.append(rising, falling[1:])
    rate, second = rocker_rates(links, angle)
    sense = np.where(np.arange(angle.size) <= half, 1.0, -1.0)
    rocker = torque * sense + inertia * second * crank_speed**2
    power = rocker * rate * crank_speed
    power = np.where(power > 0, power / efficiency, power * efficiency)
    crank = power / crank_speed

    def mean(values: Array) -> float:
        return float(scipy.integrate.simpson(values, x=angle) / (2 * np.pi))

    return DrivePower(
        crank_angle=angle,
        rocker_torque=rocker,
        crank_torque=crank,
        power=power,
        peak_power=float(power.max()),
        mean_power=mean(power),
        rms_power=float(np.sqrt(mean(power**2))),
        peak_torque=float(np.abs(crank).max()),
        rms_torque=float(np.sqrt(mean(crank**2))),
    )


@formula()
def choose_motor(power: float, *, series: Literal["hp", "kW"] = "kW") -> float:
    """Choose the next standard rating of a motor.

    Parameters
    ----------
    power : float
        Power that it must give. [W]
    series : str
        "hp" for the ratings of NEMA, "kW" for those of IEC.

    Returns
    -------
    float
        Rating of the smallest motor that gives it. [W]

    Raises
    ------
    ModelError
        A power not positive or above the largest rating, or another series.

    Examples
    --------
    >>> from erlif.joint.models.linkage.motor import HORSEPOWER
    >>> round(choose_motor(5407, series="hp") / HORSEPOWER, 2)
    7.5
    >>> choose_motor(5407)
    5500.0
    """
    if series not in RATINGS:
        raise ModelError(f"series must be hp or kW, got {series!r}.")
    for rating in RATINGS[series]:
        if rating >= power:
            return float(rating)
    largest = RATINGS[series][-1]
    raise ModelError(f"power must be at most {largest:g} W, the largest rating, got {power:g} W.")
