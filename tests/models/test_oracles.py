"""The linkages and Hertz's ellipse against solvers that others wrote, where they are installed."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.orbits import RIG, SPEED

from erlif.models.mechanism import SliderCrank


def test_rocker_angle_against_pylinkage():
    pylinkage = pytest.importorskip("pylinkage")
    steps = 360
    near, far = pylinkage.Ground(0.0, 0.0), pylinkage.Ground(RIG.ground, 0.0)
    crank = pylinkage.Crank(near, RIG.crank, angular_velocity=2 * np.pi / steps)
    pin = pylinkage.RRRDyad(crank.output, far, RIG.coupler, RIG.rocker, x=0.4, y=0.3)
    linkage = pylinkage.Linkage([near, far, crank, pin])
    places = [(frame[2], frame[3]) for frame in linkage.step(iterations=steps)]
    crank_pin, rocker_pin = np.array([p[0] for p in places]), np.array([p[1] for p in places])
    crank_angle = np.arctan2(crank_pin[:, 1], crank_pin[:, 0])
    rocker_angle = np.arctan2(rocker_pin[:, 1], RIG.ground - rocker_pin[:, 0])
    assert np.ptp(np.unwrap(crank_angle)) > 6.2
    npt.assert_allclose(RIG.rocker_angle(crank_angle), rocker_angle, atol=1e-9)


def four_bar_of(mechanism, crank_angle):
    """The rig as vectors a + b = d + c from the crank pivot, solved for coupler b and rocker c."""
    o, a, b, c = (mechanism.Joint(name) for name in "OABC")
    crank = mechanism.Vector((o, a), r=RIG.crank)
    coupler = mechanism.Vector((a, b), r=RIG.coupler)
    rocker = mechanism.Vector((c, b), r=RIG.rocker)
    ground = mechanism.Vector((o, c), r=RIG.ground, theta=0)

    def loop(unknown, driven):
        return crank(driven) + coupler(unknown[0]) - rocker(unknown[1]) - ground()

    solved = mechanism.Mechanism(
        vectors=(crank, coupler, rocker, ground),
        origin=o,
        loops=loop,
        pos=crank_angle,
        vel=np.full(crank_angle.size, SPEED),
        acc=np.zeros(crank_angle.size),
        guess=(np.array([0.5, 2.0]), np.array([0.0, 0.0]), np.array([0.0, 0.0])),
    )
    solved.iterate()
    return coupler, rocker


def test_speed_and_acceleration_against_mechanism():
    mechanism = pytest.importorskip("mechanism")
    crank_angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    coupler, rocker = four_bar_of(mechanism, crank_angle)
    # the package counts the rocker from the x axis: pi minus the interior angle
    npt.assert_allclose(RIG.rocker_angle(crank_angle), np.pi - rocker.pos.thetas, atol=1e-8)
    npt.assert_allclose(RIG.coupler_angle(crank_angle), coupler.pos.thetas, atol=1e-8)
    npt.assert_allclose(
        RIG.rocker_speed(crank_angle, crank_speed=SPEED), -rocker.vel.omegas, atol=1e-7
    )
    npt.assert_allclose(
        RIG.coupler_speed(crank_angle, crank_speed=SPEED), coupler.vel.omegas, atol=1e-7
    )
    npt.assert_allclose(
        RIG.rocker_acceleration(crank_angle, crank_speed=SPEED), -rocker.acc.alphas, atol=1e-6
    )


def test_slider_crank_against_mechanism():
    mechanism = pytest.importorskip("mechanism")
    linkage = SliderCrank(0.0762, 0.2032)
    crank_angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    o, a, b = (mechanism.Joint(name) for name in "OAB")
    crank = mechanism.Vector((o, a), r=linkage.crank)
    coupler = mechanism.Vector((a, b), r=linkage.coupler)
    slide = mechanism.Vector((o, b), theta=0)
    solved = mechanism.Mechanism(
        vectors=(crank, coupler, slide),
        origin=o,
        loops=lambda unknown, driven: crank(driven) + coupler(unknown[0]) - slide(unknown[1]),
        pos=crank_angle,
        vel=np.full(crank_angle.size, 3.0),
        acc=np.zeros(crank_angle.size),
        guess=(np.array([0.0, 0.28]), np.array([0.0, 0.0]), np.array([0.0, 0.0])),
    )
    solved.iterate()
    npt.assert_allclose(linkage.slider_position(crank_angle), slide.pos.rs, atol=1e-8)
    npt.assert_allclose(
        linkage.slider_speed(crank_angle, crank_speed=3.0), slide.vel.r_dots, atol=1e-7
    )
    npt.assert_allclose(
        linkage.slider_acceleration(crank_angle, crank_speed=3.0), slide.acc.r_ddots, atol=1e-6
    )
    npt.assert_allclose(
        linkage.coupler_acceleration(crank_angle, crank_speed=3.0), coupler.acc.alphas, atol=1e-6
    )
