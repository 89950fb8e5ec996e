"""Joint forces: balance of energy and of every body, the worked numbers of the sources."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes.slider_crank import SPRUNG as BODIES

from erlif.core.errors import ModelError, RangeWarning, UnitWarning
from erlif.joint.models.reaction import (
    SliderCrankBodies,
    coupler_force,
    joint_reaction,
    rolling_bearing_life,
    warn_of_compression,
)
from erlif.models.mechanism import CrankRocker, SliderCrank

MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)
TURN = np.linspace(0, 2 * np.pi, 721)
IN_COMPRESSION = pytest.mark.filterwarnings("ignore::erlif.core.errors.RangeWarning")
"""Balances hold for a pin that pushes its rod as well."""


@IN_COMPRESSION
@given(
    st.floats(0.2, 20.0),
    st.floats(0, 100.0),
    st.floats(0, 0.4),
    st.floats(0, 2e-3),
    st.floats(0, 2 * np.pi),
)
def test_the_crank_supplies_what_bodies_spring_and_friction_take(
    speed, preload, friction, clearance, angle
):
    linkage = SliderCrank(0.0762, 0.2032, clearance)
    bodies = SliderCrankBodies(
        **BODIES, spring_preload=preload, friction=friction, pin_radius=9.525e-3
    )

    def energy(t):
        phi = linkage.coupler_angle(t)
        phi_rate = linkage.coupler_speed(t, crank_speed=speed)
        slider = linkage.slider_speed(t, crank_speed=speed)
        rod_x, rod_y = slider + 0.1016 * phi_rate * np.sin(phi), -0.1016 * phi_rate * np.cos(phi)
        kinetic = (bodies.rod_mass * (rod_x**2 + rod_y**2) + bodies.rod_inertia * phi_rate**2) / 2
        kinetic += bodies.slider_mass * slider**2 / 2
        stretch = 0.0762 + 0.2032 - linkage.slider_position(t)
        return kinetic + preload * stretch + bodies.spring_stiffness * stretch**2 / 2

    step = 1e-5
    stored = speed * (energy(angle + step) - energy(angle - step)) / (2 * step)
    reaction = joint_reaction(linkage, crank_angle=angle, crank_speed=speed, bodies=bodies)
    lost = (
        friction * reaction.normal * 9.525e-3 * abs(linkage.joint_speed(angle, crank_speed=speed))
    )
    scale = speed * (abs(reaction.crank_torque) + reaction.force * 0.0762) + 1e-9
    npt.assert_allclose(speed * reaction.crank_torque, stored + lost, atol=1e-6 * scale)


def lagrange(angle, *, speed, preload):
    """Joint force and driving torque from multipliers, l1 and l2 half lengths.

    Mukras et al. (2008), eqs. 6, 7 and 10.
    """
    l1, l2 = 0.0381, 0.1016
    mass = np.diag([0.4045, 0.4045, 204e-6, 0.8175, 0.8175, 5500e-6, 5.5487, 5.5487, 1.0])
    phi1, phi2 = angle, np.arcsin(-l1 * np.sin(angle) / l2)
    s1, c1, s2, c2 = np.sin(phi1), np.cos(phi1), np.sin(phi2), np.cos(phi2)
    jacobian = np.zeros((9, 9))
    jacobian[[0, 1], [0, 1]] = jacobian[[2, 3], [3, 4]] = jacobian[[4, 5], [6, 7]] = 1
    jacobian[6, 7] = jacobian[7, 8] = jacobian[8, 2] = 1
    jacobian[:6, 2] = [l1 * s1, -l1 * c1, 2 * l1 * s1, -2 * l1 * c1, 2 * l1 * s1, -2 * l1 * c1]
    jacobian[2:6, 5] = [l2 * s2, -l2 * c2, 2 * l2 * s2, -2 * l2 * c2]
    rate2 = np.linalg.solve(jacobian, [0, 0, 0, 0, 0, 0, 0, 0, speed])[5]
    gamma = (
        -np.array([l1 * c1, l1 * s1, 2 * l1 * c1, 2 * l1 * s1, 2 * l1 * c1, 2 * l1 * s1, 0, 0, 0])
        * speed**2
    )
    gamma[2:6] -= np.array([l2 * c2, l2 * s2, 2 * l2 * c2, 2 * l2 * s2]) * rate2**2
    applied = np.zeros(9)
    applied[6] = preload + 525.4 * (2 * l1 + 2 * l2 - 2 * l1 * c1 - 2 * l2 * c2)
    system = np.block([[mass, jacobian.T], [jacobian, np.zeros((9, 9))]])
    multiplier = np.linalg.solve(system, np.concatenate([applied, gamma]))[9:]
    return -(multiplier[2] + multiplier[4]), -(multiplier[3] + multiplier[5]), -multiplier[8]


@given(st.floats(0, 2 * np.pi), st.floats(0.1, 30.0), st.floats(0, 100.0))
def test_joint_force_is_that_of_the_lagrange_multipliers(angle, speed, preload):
    """Mukras et al. (2008), eq. 10."""
    bodies = SliderCrankBodies(**BODIES, spring_preload=preload)
    found = joint_reaction(MUKRAS, crank_angle=angle, crank_speed=speed, bodies=bodies)
    expected = lagrange(angle, speed=speed, preload=preload)
    npt.assert_allclose(
        [found.force_x, found.force_y, found.crank_torque], expected, atol=1e-9 * (100 + speed**2)
    )


def test_compression_of_the_worn_joint_is_reported_by_its_crank_angles():
    bodies = SliderCrankBodies(**BODIES)
    case = {"crank_angle": TURN, "crank_speed": 25.0, "bodies": bodies}
    with pytest.warns(RangeWarning, match="angles of 77 to 283 degrees, by up to 15"):
        joint_reaction(SliderCrank(0.0762, 0.2032, 1e-4), **case)
    with pytest.warns(RangeWarning, match="angles of 0 to 30 and 200 degrees, by up to 3 N"):
        warn_of_compression(np.radians([0, 10, 30, 40, 200, 210]), pull=[-1, -1, -3, 1, -1, 0])


def test_link_force_of_the_thesis():  # Farzaneh (2002), appendix A.3: 8.2 kN
    rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    force = coupler_force(rig, crank_angle=TURN, rocker_torque=2118.5)
    # virtual work: coupler force times the pull-in of the crank pin is torque times rocker speed
    torque = force * 0.055 * np.sin(rig.coupler_angle(TURN) - TURN)
    npt.assert_allclose(torque * 3.0, 2118.5 * rig.rocker_speed(TURN, crank_speed=3.0), atol=1e-6)


def test_bodies_refuse_infinity_and_warn_of_units():
    for name in BODIES:
        for value, refusal in ((np.inf, "be finite"), (-1.0, "not be negative")):
            with pytest.raises(ModelError, match=rf"^{name} must {refusal}"):
                SliderCrankBodies(**BODIES | {name: value})
    with pytest.warns(UnitWarning, match=r"pin_radius = 95.25 m .* mm"):
        SliderCrankBodies(**BODIES, pin_radius=95.25)


def test_several_friction_coefficients_give_the_reaction_of_each():
    friction = np.array([0.0, 0.15, 0.3])
    case = {"crank_angle": TURN[:, None], "crank_speed": 3.0}
    several = SliderCrankBodies(**BODIES, friction=friction, pin_radius=9.525e-3)
    found = joint_reaction(MUKRAS, bodies=several, **case)
    assert found.force.shape == (721, 3)
    for k, one in enumerate(friction):
        bodies = SliderCrankBodies(**BODIES, friction=float(one), pin_radius=9.525e-3)
        alone = joint_reaction(MUKRAS, bodies=bodies, **case)
        npt.assert_allclose(found.crank_torque[:, k], alone.crank_torque[:, 0], rtol=1e-12)


def test_bearing_life_of_the_thesis():  # Farzaneh (2002), appendix A.4.1
    case = {"rating": 23.9e3, "speed": 114 * 2 * np.pi / 60}
    for exponent, hours in ((10 / 3, [52119, 5171]), (3, [28960, 3620])):
        life = rolling_bearing_life([4.1e3, 8.2e3], exponent=exponent, **case)
        npt.assert_allclose(life / 3600, hours, rtol=5e-5)
