"""Forces in the linkages: joint reactions of the slider-crank by inverse dynamics, the coupler of the crank-rocker."""

from dataclasses import dataclass

import numpy as np

from erlif.models.arguments import Values, require_not_negative, require_positive
from erlif.models.mechanism import CrankRocker, SliderCrank


@dataclass(frozen=True)
class SliderCrankBodies:
    """Masses, spring and friction of a slider-crank. Mukras et al. (2008), Tables 1 to 3.

    The spring pulls the slider outward; its pull is `spring_preload` at the outer dead centre of the unworn linkage and
    grows as the slider moves in. The centre of mass of the rod is in its middle. Slider and outer joint are frictionless.

    Notes
    -----
    The source does not state the preload. With none, its inputs give 35 % of its worn mass; 68.35 N gives all of it.
    """

    rod_mass: float
    """[kg]"""
    rod_inertia: float
    """Moment of inertia about the centre of mass. [kg m2]"""
    slider_mass: float
    """[kg]"""
    spring_stiffness: float = 0.0
    """[N/m]"""
    spring_preload: float = 0.0
    """[N]"""
    friction: float = 0.0
    """Friction coefficient of the crank-pin joint. [1]"""
    pin_radius: float = 0.0
    """Lever of that friction. [m]"""

    def __post_init__(self) -> None:
        require_not_negative(**vars(self))


@dataclass(frozen=True)
class JointReaction:
    """Force of the crank pin on the connecting rod, over a cycle or at a point of it."""

    force_x: Values
    """Along the slider's line, away from the crank pivot. [N]"""
    force_y: Values
    """Across it. [N]"""
    force: Values
    """Magnitude. [N]"""
    normal: Values
    """Share of the force normal to the contact, the rest being friction. [N]"""
    crank_torque: Values
    """Torque that drives the crank. [N m]"""


def joint_reaction(
    linkage: SliderCrank, *, crank_angle: Values, crank_speed: Values, bodies: SliderCrankBodies
) -> JointReaction:
    """Force in the crank-pin joint at constant crank speed, by inverse dynamics. Mukras et al. (2008), eqs. 6 to 9, 14, 19.

    With the clearance of `linkage` above zero the joint is the continuous-contact joint of the source, else the perfect
    one. No gravity: the linkage lies flat.

    Parameters
    ----------
    linkage : SliderCrank
        Lengths and clearance; x is measured from the crank pivot.
    crank_angle : float or array
        [rad]
    crank_speed : float or array
        [rad/s]
    bodies : SliderCrankBodies
        Masses, spring and friction.

    Returns
    -------
    JointReaction
        Force on the rod and driving torque.

    Notes
    -----
    Friction acts where pin and bushing touch, so it is a couple mu N r on both links and makes the force sqrt(1 + mu^2)
    times its normal share. The right side of eq. 10 must hold gamma = -(Phi_q q')_q q' - 2 Phi_qt q' - Phi_tt.
    """
    half, to_pin = (
        linkage.coupler / 2,
        linkage.coupler / 2 + linkage.clearance,
    )  # from the centre of mass
    phi = linkage.coupler_angle(crank_angle)
    phi_rate = linkage.coupler_speed(crank_angle, crank_speed=crank_speed)
    phi_second = linkage.coupler_acceleration(crank_angle, crank_speed=crank_speed)
    ux, uy = np.cos(phi), np.sin(phi)
    slider = linkage.slider_acceleration(crank_angle, crank_speed=crank_speed)
    rod_x = slider + half * (phi_second * uy + phi_rate**2 * ux)
    rod_y = -half * (phi_second * ux - phi_rate**2 * uy)
    stretched = linkage.crank + linkage.coupler - linkage.slider_position(crank_angle)
    spring = bodies.spring_preload + bodies.spring_stiffness * stretched

    on_slider_x = bodies.slider_mass * slider - spring
    force_x = bodies.rod_mass * rod_x + on_slider_x
    inertia = bodies.rod_inertia * phi_second + to_pin * ux * bodies.rod_mass * rod_y
    moment = to_pin * uy * force_x + half * uy * on_slider_x - inertia
    sense = np.sign(linkage.joint_speed(crank_angle, crank_speed=crank_speed))
    normal_share = 1 / np.sqrt(1 + bodies.friction**2)

    couple = 0.0 * force_x
    for _ in range(
        12
    ):  # the couple changes the force by some mu r / rod of itself: each pass gains two digits
        force_y = bodies.rod_mass * rod_y + (moment + couple) / ((half + to_pin) * ux)
        force = np.sqrt(force_x**2 + force_y**2)
        couple = sense * bodies.friction * normal_share * force * bodies.pin_radius
    lever = linkage.crank * (np.cos(crank_angle) * force_y - np.sin(crank_angle) * force_x)
    return JointReaction(force_x, force_y, force, normal_share * force, lever + couple)


def coupler_force(linkage: CrankRocker, *, crank_angle: Values, rocker_torque: Values) -> Values:
    """Force [N] in the coupler of a crank-rocker that turns its rocker with a torque [N m], without inertia.

    F = T / (rocker sin(transmission angle)). Farzaneh (2002), appendix A.3, takes the sine for 1.
    """
    return rocker_torque / (linkage.rocker * np.sin(linkage.transmission_angle(crank_angle)))


def rolling_bearing_life(
    load: Values, *, rating: Values, speed: Values, exponent: float = 3.0
) -> Values:
    """Time [s] that 90 % of rolling bearings live: L10 = 10^6 (2 pi / omega) (C/P)^p. Farzaneh (2002), appendix A.4.1.

    Parameters
    ----------
    load, rating : float or array
        Radial load P and dynamic load rating C. [N]
    speed : float or array
        [rad/s]
    exponent : float
        3 for ball bearings, 10/3 for roller bearings.

    Notes
    -----
    The source writes 16667/n hours, n in turns per minute, which is the same. It uses 10/3 for its ball bearings and finds 52,000 and 5,200 hours; with 3 they are 29,000 and 3,600.
    """
    require_positive(load=load, rating=rating, speed=speed, exponent=exponent)
    return 1e6 * 2 * np.pi / speed * (rating / load) ** exponent


def rod_stress(force: Values, *, diameter: Values) -> Values:
    """Axial stress [Pa] in a round rod: 4F / (pi d^2). Farzaneh (2002), appendix A.4.1.

    Note: the source finds 16 MPa under 8.2 kN in its half-inch rod, with the diameter in the place of the radius; it is
    64.7 MPa, above the 50 MPa fatigue strength it gives.
    """
    require_positive(diameter=diameter)
    return 4 * force / (np.pi * diameter**2)
