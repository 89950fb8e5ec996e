"""Wear after Archard, worn bushings, and the heat and pv of a sliding joint."""

from dataclasses import dataclass, replace

import numpy as np

from erlif.core.errors import ModelError
from erlif.models.arguments import Values, require_not_negative, require_positive
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import SliderCrankBodies, joint_reaction


def adhesive_wear(
    load: Values, *, sliding_distance: Values, hardness: Values, coefficient: Values
) -> Values:
    """Volume [m3] worn by adhesion: V = K F s / H. Archard; Farzaneh (2002), eq. 2.1; Strand (2005), eq. 31.

    Parameters
    ----------
    load : float or array
        F. [N]
    sliding_distance : float or array
        s. [m]
    hardness : float or array
        H of the softer body. [Pa]
    coefficient : float or array
        K, from a test of the very pair and lubricant. [1]
    """
    require_positive(hardness=hardness)
    require_not_negative(load=load, sliding_distance=sliding_distance, coefficient=coefficient)
    return coefficient * load * sliding_distance / hardness


def abrasive_wear(
    load: Values, *, sliding_distance: Values, hardness: Values, asperity_slope: Values
) -> Values:
    """Volume [m3] worn by abrasion: V = (2/pi) tan(Theta) F s / H. Farzaneh (2002), eq. 2.2.

    Parameters as in `adhesive_wear`, with the angle Theta of the hard asperities to the surface [rad].
    """
    slope = np.tan(asperity_slope)
    require_not_negative(asperity_slope=slope)
    return adhesive_wear(
        load, sliding_distance=sliding_distance, hardness=hardness, coefficient=2 / np.pi * slope
    )


def fatigue_wear(
    load: Values,
    *,
    sliding_distance: Values,
    hardness: Values,
    asperity_distribution: Values,
    particle_size: Values,
    failure_strain: Values,
    coefficient: Values,
) -> Values:
    """Volume [m3] worn by fatigue: V = C eta gamma F s / (eps^2 H). Farzaneh (2002), eq. 2.3.

    Parameters as in `adhesive_wear`, with the distribution of asperity heights eta, the particle-size constant gamma and
    the strain to failure in one cycle eps. [1]
    """
    require_positive(failure_strain=failure_strain)
    share = coefficient * asperity_distribution * particle_size / failure_strain**2
    return adhesive_wear(
        load, sliding_distance=sliding_distance, hardness=hardness, coefficient=share
    )


def wear_depth(pressure: Values, *, sliding_distance: Values, specific_wear: Values) -> Values:
    """Depth [m] worn under a pressure: h = k p s. Strand (2005), eq. 32; Mukras et al. (2008), eqs. 2 and 4.

    Parameters
    ----------
    pressure : float or array
        p. [Pa]
    sliding_distance : float or array
        s, speed times time. [m]
    specific_wear : float or array
        k = K/H of `adhesive_wear`. [1/Pa]
    """
    require_not_negative(
        pressure=pressure, sliding_distance=sliding_distance, specific_wear=specific_wear
    )
    return specific_wear * pressure * sliding_distance


@dataclass(frozen=True)
class WornBushing:
    """A bushing into which the shaft has worn to its steady state."""

    depth: Values
    """On the line of load; it falls off as the cosine. [m]"""
    pressure: Values
    """On the line of load; it falls off as the cosine. [Pa]"""
    volume: Values
    """[m3]"""


def steady_bushing_wear(
    load: Values,
    *,
    shaft_radius: Values,
    width: Values,
    sliding_distance: Values,
    specific_wear: Values,
) -> WornBushing:
    """Wear of a bushing whose rigid shaft sinks straight in: depth and pressure are cosines. Colbert et al. (2009), app. A.

    P0 = 2F / (pi R w), depth0 = k P0 s, V = 2 R w depth0; the torque ratio is `erlif.models.friction.cosine_torque_ratio`
    at 90 degrees.

    Parameters
    ----------
    load : float or array
        F. [N]
    shaft_radius, width : float or array
        R and w. [m]
    sliding_distance : float or array
        s. [m]
    specific_wear : float or array
        k. [1/Pa]

    Notes
    -----
    The middle of eq. A4 should read k P0 D cos(theta); the text that inserts "(A1)" means (A5).
    """
    require_positive(shaft_radius=shaft_radius, width=width)
    require_not_negative(load=load)
    pressure = 2 * load / (np.pi * shaft_radius * width)
    depth = wear_depth(pressure, sliding_distance=sliding_distance, specific_wear=specific_wear)
    return WornBushing(depth, pressure, 2 * shaft_radius * width * depth)


@dataclass(frozen=True)
class CoupledWear:
    """Wear of a slider-crank joint over its cycles; arrays of one length, from the unworn joint on."""

    cycles: Values
    volume: Values
    """[m3]"""
    depth: Values
    """Deepest. [m]"""
    greatest_force: Values
    """Of the cycle computed with that wear. [N]"""


def coupled_wear(
    linkage: SliderCrank,
    *,
    crank_speed: float,
    bodies: SliderCrankBodies,
    bushing_radius: float,
    bushing_width: float,
    specific_wear: float,
    cycles: int,
    extrapolation: int = 500,
    coupled: bool = True,
    steps_per_cycle: int = 360,
) -> CoupledWear:
    """Wear of the crank-pin bushing while its own wear changes the forces. Mukras et al. (2008), eqs. 5 and 20.

    One cycle of `erlif.models.reaction.joint_reaction` gives V = k R2 int N |d(phi1 - phi2)|; it stands for the next
    `extrapolation` cycles; the depth V / (2 R2 w) then lengthens the rod as a clearance.

    Parameters
    ----------
    linkage : SliderCrank
        Unworn.
    crank_speed : float
        [rad/s]
    bodies : SliderCrankBodies
        Masses, spring and friction.
    bushing_radius, bushing_width : float
        R2 and w. [m]
    specific_wear : float
        k. [1/Pa]
    cycles : int
        To the end of the test.
    extrapolation : int
        Cycles for which one computed cycle stands, A_E of eq. 5.
    coupled : bool
        False keeps the joint unworn in the dynamics: the source's prediction from initial dynamics.
    steps_per_cycle : int
        Crank angles per computed cycle.

    Raises
    ------
    ModelError
        A value not positive, or an extrapolation that wears more than a tenth of the bushing radius in one step.

    Notes
    -----
    The depth takes the worn bushing for a cosine (`steady_bushing_wear`) in place of the source's finite elements; the
    source does not state the width, and about 8.4 mm agrees with its worn mass and depth. Its speed "0.5 RPM" is 0.5 turns
    per second by its own cycles and hours.
    """
    require_positive(
        crank_speed=crank_speed, bushing_radius=bushing_radius, bushing_width=bushing_width
    )
    require_positive(cycles=cycles, extrapolation=extrapolation, steps_per_cycle=steps_per_cycle)
    require_not_negative(specific_wear=specific_wear)
    crank_angle = np.linspace(0, 2 * np.pi, steps_per_cycle, endpoint=False)
    at, volume, force = [0], [0.0], []
    while True:
        clearance = linkage.clearance + coupled * volume[-1] / (2 * bushing_radius * bushing_width)
        worn = replace(linkage, clearance=clearance)
        reaction = joint_reaction(
            worn, crank_angle=crank_angle, crank_speed=crank_speed, bodies=bodies
        )
        force.append(float(np.max(reaction.force)))
        if at[-1] == cycles:
            break
        turning = np.abs(worn.joint_speed(crank_angle, crank_speed=crank_speed)) / crank_speed
        # the mean over equal steps of a periodic function is its integral to the last digit
        per_cycle = (
            specific_wear * bushing_radius * float(np.mean(reaction.normal * turning)) * 2 * np.pi
        )
        step = min(extrapolation, cycles - at[-1])
        if step * per_cycle / (2 * bushing_radius * bushing_width) > 0.1 * bushing_radius:
            raise ModelError(
                f"extrapolation must be smaller: {step} cycles wear more than a tenth of the bushing radius."
            )
        at.append(at[-1] + step)
        volume.append(volume[-1] + step * per_cycle)
    depth = np.array(volume) / (2 * bushing_radius * bushing_width)
    return CoupledWear(np.array(at), np.array(volume), depth, np.array(force))


def mean_sliding_speed(half_swing: Values, *, diameter: Values, period: Values) -> Values:
    """Mean sliding speed [m/s] of a swinging joint: v = 2 d beta / t. Strand (2005), eq. 26.

    Parameters
    ----------
    half_swing : float or array
        beta, half of the angle from end to end. [rad]
    diameter : float or array
        d. [m]
    period : float or array
        Time t of a swing forth and back. [s]

    Note: the nomenclature of the source lists beta in degrees; the equation needs radians.
    """
    require_positive(diameter=diameter, period=period)
    return 2 * diameter * half_swing / period


def pressure_velocity(load: Values, *, diameter: Values, width: Values, speed: Values) -> Values:
    """Product pv [W/m2] of projected pressure and sliding speed: F v / (d w). Strand (2005), section 2.1.13."""
    require_positive(diameter=diameter, width=width)
    return load * speed / (diameter * width)


def friction_heat(load: Values, *, friction: Values, speed: Values) -> Values:
    """Heat [W] of a sliding joint: Q = mu F v. Strand (2005), eqs. 27 and 28."""
    require_not_negative(load=load, friction=friction)
    return friction * load * np.abs(speed)


def bushing_heat_share(pin_conductivity: Values, *, bushing_conductivity: Values) -> Values:
    """Share [1] of the friction heat that enters the bushing: 1 / (1 + lambda_pin / lambda_bush). Strand (2005), eq. 28.

    Conductivities in W/(m K). Slow sliding: both bodies count as at rest.
    """
    require_positive(pin_conductivity=pin_conductivity, bushing_conductivity=bushing_conductivity)
    return 1 / (1 + pin_conductivity / bushing_conductivity)


def surface_temperature(
    measured_temperature: Values,
    *,
    heat: Values,
    pin_diameter: Values,
    wall: Values,
    width: Values,
    conductivity: Values,
    arc: float = 2 * np.pi,
) -> Values:
    """Temperature [K] of the sliding surface from one measured behind the bushing. Strand (2005), eq. 29.

    T_s = T_m + Q ln((d + 2t)/d) / (arc w lambda).

    Parameters
    ----------
    measured_temperature : float or array
        T_m on the outside of the bushing. [K]
    heat : float or array
        Q into the bushing. [W]
    pin_diameter, wall, width : float or array
        d, t, w. [m]
    conductivity : float or array
        lambda of the bushing. [W/(m K)]
    arc : float
        Angle through which the heat flows, 2 pi for the whole ring. [rad]

    Notes
    -----
    The source has pi in the place of the arc: heat through half of the ring, twice the rise of the whole one.
    """
    require_positive(
        pin_diameter=pin_diameter, wall=wall, width=width, conductivity=conductivity, arc=arc
    )
    return measured_temperature + heat * np.log((pin_diameter + 2 * wall) / pin_diameter) / (
        arc * width * conductivity
    )


def thermal_growth(diameter: Values, *, expansion: Values, temperature_change: Values) -> Values:
    """Change [m] of a diameter: d alpha dT. Strand (2005), eq. 30; expansion in 1/K."""
    require_positive(diameter=diameter)
    return diameter * expansion * temperature_change
