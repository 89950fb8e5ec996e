"""The linkages: closed loops, published numbers, derivatives, refusals."""

from functools import partial

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from erlif.core.errors import ModelError
from erlif.models.mechanism import CrankRocker, SliderCrank, crank_for_swing

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)  # Farzaneh (2002), A.2
MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)  # Mukras et al. (2008), Table 1 doubled
TURN = np.linspace(0, 2 * np.pi, 721)
lengths = st.floats(0.05, 1.0)
angles = st.floats(0, 2 * np.pi)


@st.composite
def crank_rockers(draw):
    coupler, rocker, ground = draw(lengths), draw(lengths), draw(lengths)
    shortest, middle, longest = sorted((coupler, rocker, ground))
    room = min(shortest, shortest + middle - longest)
    assume(room > 0.02)
    return CrankRocker(draw(st.floats(0.1, 0.9)) * room, coupler, rocker, ground)


def pins(linkage, crank_angle):
    """Crank pin and rocker pin from the angles alone, as complex numbers."""
    psi = linkage.rocker_angle(crank_angle)
    return linkage.crank * np.exp(1j * crank_angle), linkage.ground - linkage.rocker * np.exp(
        -1j * psi
    )


@given(crank_rockers(), angles)
def test_the_loop_closes(linkage, crank_angle):
    crank_pin, rocker_pin = pins(linkage, crank_angle)
    coupler = linkage.coupler * np.exp(1j * linkage.coupler_angle(crank_angle))
    npt.assert_allclose(rocker_pin - crank_pin, coupler, atol=1e-9)


def assert_rates(crank_angle, pairs, bound, speed=3.0):
    """Rates at a constant crank speed are central differences of what they are the rates of."""
    step = 1e-5
    for rate, function in pairs:
        rise = function(crank_angle + step) - function(crank_angle - step)
        slope = speed * rise / (2 * step)
        npt.assert_allclose(rate(crank_angle, crank_speed=speed), slope, atol=bound)


@given(crank_rockers(), angles)
def test_rates_are_the_derivatives(linkage, crank_angle):
    scale = 3.0 * linkage.crank / min(linkage.rocker, linkage.coupler)
    bound = 1e-4 * scale * (1 + 1 / np.sin(linkage.transmission_angle(crank_angle)) ** 4)
    first = [
        (linkage.rocker_speed, linkage.rocker_angle),
        (linkage.coupler_speed, linkage.coupler_angle),
    ]
    assert_rates(crank_angle, first, bound)
    second = [(linkage.rocker_acceleration, partial(linkage.rocker_speed, crank_speed=3.0))]
    assert_rates(crank_angle, second, 3.0 * bound)


def test_crank_acceleration_adds_its_own_share():
    extra = RIG.rocker_acceleration(
        TURN, crank_speed=2.0, crank_acceleration=5.0
    ) - RIG.rocker_acceleration(TURN, crank_speed=2.0)
    npt.assert_allclose(extra, RIG.rocker_speed(TURN, crank_speed=5.0), atol=1e-12)


@given(crank_rockers(), angles)
def test_an_encoder_on_rocker_or_coupler_gives_the_crank_back(linkage, crank_angle):
    rising = linkage.rocker_speed(crank_angle, crank_speed=1.0) > 0
    psi = linkage.rocker_angle(crank_angle)
    found = linkage.crank_angle(psi, rising=rising)
    npt.assert_allclose(linkage.rocker_angle(found), psi, atol=1e-9)
    assert (linkage.rocker_speed(found, crank_speed=1.0) > -1e-6) if rising else True
    npt.assert_allclose(np.cos(found - crank_angle), 1, atol=1e-6)
    rising = linkage.coupler_speed(crank_angle, crank_speed=1.0) > 0
    found = linkage.crank_angle_from_coupler(linkage.coupler_angle(crank_angle), rising=rising)
    npt.assert_allclose(np.cos(found - crank_angle), 1, atol=1e-6)


@given(crank_rockers())
def test_limits_bound_the_motion_and_are_reached_at_the_dead_points(linkage):
    psi, phi = linkage.rocker_angle(TURN), linkage.coupler_angle(TURN)
    for (low, high), angle in ((linkage.limits(), psi), (linkage.coupler_limits(), phi)):
        assert low <= angle.min() + 1e-9
        assert angle.max() - 1e-9 <= high
    at_low, at_high = linkage.dead_points()
    npt.assert_allclose(
        linkage.rocker_angle(np.array([at_low, at_high])), linkage.limits(), atol=1e-7
    )
    npt.assert_allclose(
        linkage.rocker_speed(np.array([at_low, at_high]), crank_speed=1.0), 0, atol=1e-6
    )


def test_speed_limits_of_the_rig_are_those_of_its_turn():
    speed = RIG.rocker_speed(TURN, crank_speed=11.9)
    npt.assert_allclose([speed.min(), speed.max()], RIG.speed_limits(crank_speed=11.9), rtol=1e-5)


def test_dead_points_of_the_rig_lie_where_crank_and_coupler_line_up():
    at_low, at_high = RIG.dead_points()
    # law of cosines in the triangles of sides coupler -+ crank, rocker, ground
    stretched = np.arccos((0.51**2 + 0.495**2 - 0.26**2) / (2 * 0.51 * 0.495))
    folded = np.arccos((0.51**2 + 0.385**2 - 0.26**2) / (2 * 0.51 * 0.385))
    npt.assert_allclose([at_low, at_high], [folded + np.pi, stretched], atol=1e-12)
    npt.assert_allclose(RIG.time_ratio(), 1.0014, atol=5e-5)


def test_transmission_and_coupler_swing_of_the_rig():
    transmission = np.degrees(RIG.transmission_angle(np.array([0.0, np.pi])))
    npt.assert_allclose(transmission, [76.30, 104.69], atol=5e-3)
    npt.assert_allclose(np.degrees(np.ptp(RIG.coupler_limits())), 14.362, atol=5e-4)


@given(crank_rockers())
def test_synthesis_inverts_the_limits(linkage):
    swing = float(np.ptp(linkage.limits()))
    found = crank_for_swing(
        swing, coupler=linkage.coupler, rocker=linkage.rocker, ground=linkage.ground
    )
    npt.assert_allclose(found, linkage.crank, rtol=1e-7)


def test_angle_beyond_reach_is_refused_with_the_reach():
    low, high = RIG.limits()
    with pytest.raises(
        ModelError, match=r"rocker_angle must lie in the reach .*71\.8355 degrees\), got .*72\.0"
    ):
        RIG.crank_angle(np.radians([60.0, 72.0]), rising=True)
    npt.assert_allclose(RIG.crank_angle(high + 5e-10, rising=True), RIG.dead_points()[1], atol=1e-6)
    npt.assert_allclose(
        RIG.crank_angle(low - 1e-3, rising=False, tolerance=2e-3), RIG.dead_points()[0], atol=1e-6
    )


def test_missing_angles_stay_missing():
    crank_angle = RIG.crank_angle(np.array([np.nan, 1.0]), rising=True)
    npt.assert_array_equal(np.isnan(crank_angle), [True, False])


@given(st.floats(0.01, 0.5), st.floats(1.05, 10.0), st.floats(0, 0.1), angles)
def test_slider_crank_closes_and_its_rates_are_derivatives(crank, ratio, clearance, crank_angle):
    linkage, speed = SliderCrank(crank, ratio * crank, clearance * crank), 3.0
    phi = linkage.coupler_angle(crank_angle)
    end = crank * np.exp(1j * crank_angle) + (ratio + clearance) * crank * np.exp(1j * phi)
    npt.assert_allclose([end.real, end.imag], [linkage.slider_position(crank_angle), 0], atol=1e-12)

    bound = 1e-4 * speed * (1 + 1 / np.cos(phi) ** 4)
    first = [
        (linkage.slider_speed, linkage.slider_position),
        (linkage.coupler_speed, linkage.coupler_angle),
        (linkage.joint_speed, linkage.joint_angle),
    ]
    assert_rates(crank_angle, first, bound)
    for rate, second in (
        (linkage.slider_speed, linkage.slider_acceleration),
        (linkage.coupler_speed, linkage.coupler_acceleration),
    ):
        assert_rates(crank_angle, [(second, partial(rate, crank_speed=speed))], 3 * speed * bound)
        extra = second(crank_angle, crank_speed=speed, crank_acceleration=2.0) - second(
            crank_angle, crank_speed=speed
        )
        npt.assert_allclose(extra, rate(crank_angle, crank_speed=2.0), atol=1e-9)


def test_slider_crank_of_mukras():  # Mukras et al. (2008), Table 1 as half lengths: stroke 152.4 mm
    low, high = MUKRAS.slider_limits()
    npt.assert_allclose(high - low, 0.1524)
    npt.assert_allclose(MUKRAS.slider_position(np.array([np.pi, 0.0])), [low, high])
    npt.assert_allclose(MUKRAS.coupler_angle(np.array(MUKRAS.dead_points())), MUKRAS.limits())
    # sliding distance at the joint: each turn of the crank turns the pin once in its bushing
    npt.assert_allclose(
        9.535 * (MUKRAS.joint_angle(2 * np.pi) - MUKRAS.joint_angle(0.0)), 59.910, atol=5e-4
    )


@given(angles)
def test_slider_crank_encoders_give_the_crank_back(crank_angle):
    rising = MUKRAS.coupler_speed(crank_angle, crank_speed=1.0) > 0
    found = MUKRAS.crank_angle(MUKRAS.coupler_angle(crank_angle), rising=rising)
    npt.assert_allclose(np.cos(found - crank_angle), 1, atol=1e-9)
    rising = MUKRAS.slider_speed(crank_angle, crank_speed=1.0) > 0
    found = MUKRAS.crank_angle_from_slider(MUKRAS.slider_position(crank_angle), rising=rising)
    npt.assert_allclose(np.cos(found - crank_angle), 1, atol=1e-9)


def test_clearance_lengthens_the_rod():
    # Mukras et al. (2008), eq. 18, root phi1 + alpha = phi2 + pi
    worn = SliderCrank(0.0762, 0.2032, clearance=1e-4)
    npt.assert_allclose(
        worn.slider_position(TURN), SliderCrank(0.0762, 0.2033).slider_position(TURN)
    )
