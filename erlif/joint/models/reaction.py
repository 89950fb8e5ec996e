"""Forces in the linkages of the joint rigs.

Joint reactions of the slider-crank by inverse dynamics after Mukras et al. (2008), and the strength
of the machine of Farzaneh (2002), appendix A: coupler, rolling bearings and threaded rod. Arguments
that are off by orders of magnitude raise `erlif.core.errors.UnitWarning`.
"""

import warnings
from dataclasses import dataclass

import numpy as np

from erlif.core.errors import RangeWarning
from erlif.models.arguments import Values, check_fields, depth_of_caller, formula
from erlif.models.mechanism import CrankRocker, SliderCrank

# The friction couple changes the force by about mu r / rod of itself: a pass gains two digits.
_FRICTION_PASSES = 12


@dataclass(frozen=True)
class SliderCrankBodies:
    """Masses, spring and friction of a slider-crank. Mukras et al. (2008), Tables 1 to 3.

    The spring pulls the slider outward. Its pull is `spring_preload` at the outer dead centre of
    the unworn linkage and grows as the slider moves in. The centre of mass of the rod is in its
    middle. Slider and outer joint are frictionless. A negative or infinite value raises
    `erlif.core.errors.ModelError`.

    Attributes
    ----------
    rod_mass, slider_mass : Values
        Masses of connecting rod and slider. [kg]
    rod_inertia : Values
        Moment of inertia of the rod about its centre of mass. [kg m2]
    spring_stiffness, spring_preload : Values
        Stiffness of the spring on the slider [N/m], and its pull at the outer dead centre [N].
    friction, pin_radius : Values
        Friction coefficient of the crank-pin joint [1], and lever of that friction [m].

    Notes
    -----
    The source does not state the preload. Without any, its other inputs give 35 % of its worn mass
    by `erlif.joint.models.wear.coupled_wear` (Archard's law of the load, eq. 1) and 44 % by
    `erlif.joint.models.slider_wear.wear_slider_crank` (the local law of the pressure, eqs. 2 to 5,
    which is the procedure of the source). All of it takes 68.35 N by the first and 46.32 N by the
    second.
    """

    rod_mass: Values
    rod_inertia: Values
    slider_mass: Values
    spring_stiffness: Values = 0.0
    spring_preload: Values = 0.0
    friction: Values = 0.0
    pin_radius: Values = 0.0

    def __post_init__(self) -> None:
        kinds = dict.fromkeys(vars(self), "number or zero")
        check_fields(self, **kinds | {"pin_radius": "length or zero"})


@dataclass(frozen=True)
class JointReaction:
    """Force of the crank pin on the connecting rod, over a cycle or at a point of it.

    Attributes
    ----------
    force_x, force_y : Values
        Forces along the line of the slider, positive away from the crank pivot, and across it. [N]
    force, normal : Values
        Magnitude of the force, and its share normal to the contact; the rest is friction. [N]
    crank_torque : Values
        Torque that drives the crank. [N m]
    """

    force_x: Values
    force_y: Values
    force: Values
    normal: Values
    crank_torque: Values


@formula()
def joint_reaction(
    linkage: SliderCrank, *, crank_angle: Values, crank_speed: Values, bodies: SliderCrankBodies
) -> JointReaction:
    """Compute the force in the crank-pin joint at constant crank speed, by inverse dynamics.

    Mukras et al. (2008), eqs. 6 to 9, 14 and 19. With the clearance of `linkage` above zero the
    joint is the continuous-contact joint of the source, else the perfect one. The linkage lies
    flat, so gravity does no work.

    Parameters
    ----------
    linkage : SliderCrank
        Lengths and clearance; x is measured from the crank pivot. [m]
    crank_angle, crank_speed : float or array
        Angle of the crank from the line of the slider [rad], speed of the crank [rad/s].
    bodies : SliderCrankBodies
        Masses, spring and friction.

    Returns
    -------
    JointReaction
        Force on the rod [N] and driving torque [N m].

    Warns
    -----
    RangeWarning
        Where the rod is in compression although the continuous-contact joint presumes tension.

    Notes
    -----
    Friction acts where pin and bushing touch, so it is a couple mu N r on both links and makes the
    force sqrt(1 + mu^2) times its normal share. The right side of eq. 10 must hold
    gamma = -(Phi_q q')_q q' - 2 Phi_qt q' - Phi_tt.

    Examples
    --------
    A crank at rest at the outer dead centre carries the preload of the spring alone:

    >>> from erlif.models.mechanism import SliderCrank
    >>> from erlif.joint.models.reaction import SliderCrankBodies
    >>> bodies = SliderCrankBodies(0.8175, 5.5e-3, 5.5487, spring_preload=68.354)
    >>> found = joint_reaction(
    ...     SliderCrank(crank=0.0762, coupler=0.2032),
    ...     crank_angle=0.0,
    ...     crank_speed=0.0,
    ...     bodies=bodies,
    ... )
    >>> print(f"{found.force:.3f} N")
    68.354 N
    """

    # distances of the two joints from the centre of mass of the rod
    half, to_pin = linkage.coupler / 2, linkage.coupler / 2 + linkage.clearance
    phi = linkage.coupler_angle(crank_angle)
    phi_rate = linkage.coupler_speed(crank_angle, crank_speed=crank_speed)
    phi_second = linkage.coupler_acceleration(crank_angle, crank_speed=crank_speed)
    ux, uy = np.cos(phi), np.sin(phi)
    slider = linkage.slider_acceleration(crank_angle, crank_speed=crank_speed)
    rod_x = slider + half * (phi_second * uy + phi_rate**2 * ux)
    rod_y = -half * (phi_second * ux - phi_rate**2 * uy)
    stretched = linkage.crank + linkage.coupler - linkage.slider_position(crank_angle)
    spring = bodies.spring_preload + bodies.spring_stiffness * stretched

    # forces along the line of the slider are known; moments about the pin give the force across it
    on_slider_x = bodies.slider_mass * slider - spring
    force_x = bodies.rod_mass * rod_x + on_slider_x
    inertia = bodies.rod_inertia * phi_second + to_pin * ux * bodies.rod_mass * rod_y
    moment = to_pin * uy * force_x + half * uy * on_slider_x - inertia
    sense = np.sign(linkage.joint_speed(crank_angle, crank_speed=crank_speed))
    normal_share = 1 / np.sqrt(1 + bodies.friction**2)

    # the couple of friction depends on the force that it changes
    couple = 0.0 * force_x
    for _ in range(_FRICTION_PASSES):
        force_y = bodies.rod_mass * rod_y + (moment + couple) / ((half + to_pin) * ux)
        force = np.sqrt(force_x**2 + force_y**2)
        couple = sense * bodies.friction * normal_share * force * bodies.pin_radius

    # a clearance lengthens the rod only while the pin pulls it
    if linkage.clearance > 0:
        warn_of_compression(crank_angle, pull=-(force_x * ux + force_y * uy))

    # the torque balances the pin force on the crank and the couple of friction
    lever = linkage.crank * (np.cos(crank_angle) * force_y - np.sin(crank_angle) * force_x)
    return JointReaction(force_x, force_y, force, normal_share * force, lever + couple)


def warn_of_compression(crank_angle: Values, *, pull: Values) -> None:
    """Warn where a pin that is presumed to pull its rod pushes it.

    The continuous-contact joint of Mukras et al. (2008), eqs. 15 to 19, holds the pin at the end of
    the bushing that carries tension.

    Parameters
    ----------
    crank_angle : float or array
        Angle of the crank. [rad]
    pull : float or array
        Force of the pin along the rod, positive in tension. [N]

    Returns
    -------
    None

    Warns
    -----
    RangeWarning
        With the crank angles in compression.

    Examples
    --------
    >>> warn_of_compression([0.0, 1.0], pull=[10.0, 5.0])
    """
    angle, along = np.broadcast_arrays(np.asarray(crank_angle, float), np.asarray(pull, float))
    pushed = along < 0
    if not np.any(pushed):
        return
    warnings.warn(
        "The joint with continuous contact presumes a rod in tension; it is in compression at "
        f"crank angles of {_ranges(angle, pushed)}, by up to {-float(along[pushed].min()):.3g} "
        "N. Use erlif.joint.models.slider_dynamics.simulate_slider_crank with a ContactLaw there.",
        RangeWarning,
        stacklevel=depth_of_caller(),
    )


def _ranges(angle: Values, chosen: Values) -> str:
    """Text of the chosen angles in degrees, neighbours among the given ones as one range."""
    degrees = np.round(np.degrees(angle) % 360, 6).ravel() % 360
    every, inverse = np.unique(degrees, return_inverse=True)
    among = np.zeros(every.size, bool)
    among[inverse[chosen.ravel()]] = True
    starts = np.flatnonzero(among & ~np.concatenate([[False], among[:-1]]))
    ends = np.flatnonzero(among & ~np.concatenate([among[1:], [False]]))
    parts = [
        f"{every[start]:.4g}" + (f" to {every[end]:.4g}" if end > start else "")
        for start, end in zip(starts, ends, strict=True)
    ]
    return " and ".join(parts) + " degrees"


@formula()
def coupler_force(linkage: CrankRocker, *, crank_angle: Values, rocker_torque: Values) -> Values:
    """Compute the force in the coupler of a crank-rocker. Farzaneh (2002), appendix A.3.

    F = T / (rocker sin(transmission angle)), without inertia; the source takes the sine for 1.

    Parameters
    ----------
    linkage : CrankRocker
        Lengths of the linkage between its joints. [m]
    crank_angle : float or array
        Crank angle t. [rad]
    rocker_torque : float or array
        Torque T on the rocker. [N m]

    Returns
    -------
    float or array
        Force in the coupler, of the sign of the torque. [N]

    Examples
    --------
    At half a turn the transmission angle of the rig is 104.69 degrees, its worst:

    >>> from erlif.models.mechanism import CrankRocker
    >>> rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    >>> force = coupler_force(rig, crank_angle=np.pi, rocker_torque=2118.5)
    >>> print(f"{force:.0f} N, {2118.5 / 0.26 / np.sin(np.radians(104.691)):.0f} N")
    8423 N, 8423 N
    """
    # only the component of the coupler force across the rocker turns it
    return rocker_torque / (linkage.rocker * np.sin(linkage.transmission_angle(crank_angle)))


@formula(speed="number")
def rolling_bearing_life(
    load: Values, *, rating: Values, speed: Values, exponent: Values = 3.0
) -> Values:
    """Compute the time that 90 % of rolling bearings survive. Farzaneh (2002), appendix A.4.1.

    L10 = 10^6 (2 pi / omega) (C/P)^p.

    Parameters
    ----------
    load, rating, speed : float or array
        Radial load P [N], dynamic load rating C [N], speed omega [rad/s].
    exponent : float or array
        p: 3 for ball bearings, 10/3 for roller bearings. [1]

    Returns
    -------
    float or array
        Life L10. [s]

    Notes
    -----
    The source writes 16667/n hours, n in turns per minute, which is the same. It uses 10/3 for its
    ball bearings and finds 52,000 and 5,200 hours; with 3 they are 29,000 and 3,600.

    Examples
    --------
    The machine at 8.2 kN, with the exponent of the source and with that of ball bearings:

    >>> case = {"rating": 23.9e3, "speed": 114 * 2 * np.pi / 60}
    >>> print(f"{rolling_bearing_life(8.2e3, exponent=10 / 3, **case) / 3600:.0f} h")
    5171 h
    >>> print(f"{rolling_bearing_life(8.2e3, **case) / 3600:.0f} h")
    3620 h
    """
    return 1e6 * 2 * np.pi / speed * (rating / load) ** exponent


@formula()
def rod_stress(force: Values, *, diameter: Values) -> Values:
    """Compute the axial stress in a round rod: 4F / (pi d^2). Farzaneh (2002), appendix A.4.1.

    Parameters
    ----------
    force, diameter : float or array
        Axial force F [N], diameter d [m].

    Returns
    -------
    float or array
        Stress, of the sign of the force. [Pa]

    Notes
    -----
    The source finds 16 MPa under 8.2 kN in its half-inch rod, with the diameter in the place of the
    radius; it is 64.7 MPa, above the 50 MPa fatigue strength it gives.

    Examples
    --------
    >>> print(f"{rod_stress(8.2e3, diameter=0.0127) / 1e6:.1f} MPa")
    64.7 MPa
    """
    return 4 * force / (np.pi * diameter**2)
