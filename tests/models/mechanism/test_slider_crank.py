"""The slider-crank: closed loops, published numbers, derivatives."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.core.errors import ModelError
from erlif.models.mechanism import SliderCrank

MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)  # Mukras et al. (2008), Table 1 doubled
TURN = np.linspace(0, 2 * np.pi, 721)
angles = st.floats(0, 2 * np.pi)


@given(st.floats(0.01, 0.5), st.floats(1.05, 10.0), st.floats(0, 0.1), angles)
def test_slider_crank_closes_and_its_rates_are_derivatives(crank, ratio, clearance, crank_angle):
    linkage, step, speed = SliderCrank(crank, ratio * crank, clearance * crank), 1e-5, 3.0
    phi = linkage.coupler_angle(crank_angle)
    end = crank * np.exp(1j * crank_angle) + (ratio + clearance) * crank * np.exp(1j * phi)
    npt.assert_allclose([end.real, end.imag], [linkage.slider_position(crank_angle), 0], atol=1e-12)

    def slope(function):
        return speed * (function(crank_angle + step) - function(crank_angle - step)) / (2 * step)

    bound = 1e-4 * speed * (1 + 1 / np.cos(phi) ** 4)
    npt.assert_allclose(
        linkage.slider_speed(crank_angle, crank_speed=speed),
        slope(linkage.slider_position),
        atol=bound,
    )
    npt.assert_allclose(
        linkage.coupler_speed(crank_angle, crank_speed=speed),
        slope(linkage.coupler_angle),
        atol=bound,
    )
    npt.assert_allclose(
        linkage.joint_speed(crank_angle, crank_speed=speed), slope(linkage.joint_angle), atol=bound
    )
    for rate, second in (
        (linkage.slider_speed, linkage.slider_acceleration),
        (linkage.coupler_speed, linkage.coupler_acceleration),
    ):
        npt.assert_allclose(
            second(crank_angle, crank_speed=speed),
            slope(lambda t, rate=rate: rate(t, crank_speed=speed)),
            atol=3 * speed * bound,
        )
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


@pytest.mark.parametrize(
    ("links", "named"),
    [((0.2, 0.1), "coupler must be longer"), ((0.1, 0.2, -1e-5), "clearance"), ((0, 1), "crank")],
)
def test_slider_crank_refuses_bad_links(links, named):
    with pytest.raises(ModelError, match=named):
        SliderCrank(*links)
    with pytest.raises(ModelError, match="slider_position must lie in the reach"):
        MUKRAS.crank_angle_from_slider(0.3, rising=True)
