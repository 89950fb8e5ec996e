"""Mechanism, encoder and joint from the settings of a run, in SI."""

import math
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import run_settings

from erlif.pipeline.physics.joint import describe_contact, describe_joint, locate_run
from erlif.trend import Solid, VogelLaw


def test_joint_is_in_si_units():
    joint = describe_joint(run_settings())
    npt.assert_allclose(
        [joint.pin_radius, joint.bushing_radius, joint.length], [33.36e-3, 33.59e-3, 0.237]
    )
    npt.assert_allclose(joint.radius, 4.872010, rtol=1e-6)  # m, Farzaneh (2002)
    assert joint.pin == joint.bushing == Solid(2.7e9, 0.37, 0.2e-6)
    npt.assert_allclose([joint.viscosity, joint.pressure_viscosity], [0.12, 20e-9])


def test_vogels_law_reaches_the_joint():
    vogel = {"a": "0.1 mPa s", "b": "900 K", "c": "-100 degC"}
    oil = describe_joint(run_settings(oil={"vogel": vogel, "viscosity": None})).viscosity
    assert isinstance(oil, VogelLaw)
    npt.assert_allclose([oil.a, oil.b, oil.c], [1e-4, 900.0, -100.0])


@pytest.mark.parametrize(
    ("mechanism", "travel"),
    [
        ({"kind": "rotation", "radius": "33.36 mm", "speed": "60 rpm"}, math.inf),
        ({"kind": "sinusoidal", "stroke": "10 mm", "frequency": "5 Hz"}, 5e-3),
    ],
)
def test_entrained_oil_moves_at_half_the_speed_of_the_moving_surface(mechanism, travel):
    """A shaft never turns back; a slider of 10 mm stroke carries the oil over 5 mm."""
    joint = describe_joint(run_settings(mechanism=mechanism))
    assert joint.stroke == travel
    npt.assert_allclose(joint.radius, 4.872010, rtol=1e-6)


def test_a_logged_speed_stands_in_place_of_that_of_the_linkage(run):
    logged = np.linspace(-0.1, 0.1, run.log.sizes["frame"])
    log = run.log.assign(sliding_speed=("frame", logged))
    found = locate_run(replace(run, log=log))
    npt.assert_allclose(found.sliding_speed, np.abs(logged))
    npt.assert_allclose(found.rocker_speed, locate_run(run).rocker_speed)
    assert found.sliding_speed.attrs["source"] == "log"
    assert "source" not in locate_run(run).sliding_speed.attrs


STEEL = {"youngs_modulus": "206 GPa", "poissons_ratio": 0.3}
GLASS = {"youngs_modulus": "75 GPa", "poissons_ratio": 0.22}
TURNING = {"kind": "rotation", "radius": "20 mm", "speed": "60 rpm"}


BARREL = {"radius_along": "10 mm", "radius_across": "20 mm"}


@pytest.mark.parametrize(
    ("body", "counterbody", "more", "along", "across"),
    [
        ({"radius": "9.5 mm"}, {}, {}, 9.5e-3, 9.5e-3),
        # 1/10 - 1/50 along and 1/20 across, of a barrel in a ring
        (BARREL, {"radius_along": "-50 mm"}, {}, 12.5e-3, 20e-3),
        ({"radius_along": "8 mm"}, {}, {"length": "12 mm"}, 8e-3, None),
    ],
)
def test_radii_of_a_contact(body, counterbody, more, along, across):
    contact = {"body": STEEL | body, "counterbody": GLASS | counterbody, **more}
    found = describe_contact(run_settings(joint=None, contact=contact, mechanism=TURNING))
    npt.assert_allclose(found.radius, along)
    assert found.radius_across is None if across is None else found.radius_across == across
    assert (found.length, found.stroke, found.entrainment) == (
        0.012 if across is None else None,
        math.inf,
        0.5,
    )


def test_rolling_entrains_more_oil():
    """At a slide-to-roll ratio of 0.5 the speeds are as 1.25 to 0.75, at 0 both are the same."""
    contact = {"body": STEEL | {"radius": "9.5 mm"}, "counterbody": GLASS}
    for ratio, share in ((0.5, 0.8), (0.0, 1.0)):
        slider = {"kind": "sinusoidal", "stroke": "10 mm", "frequency": "5 Hz"}
        rolling = contact | {"slide_to_roll": ratio}
        found = describe_contact(run_settings(joint=None, contact=rolling, mechanism=slider))
        npt.assert_allclose([found.entrainment, found.stroke], [share, share * 10e-3])


def test_slider_of_a_crank_slides_at_its_own_speed(run):
    """Its speed is the rate of the position, over a thousandth of a turn."""
    links = {"kind": "slider-crank", "crank": "76 mm", "coupler": "203 mm", "crank_speed": "30 rpm"}
    contact = {"body": STEEL | {"radius": "9.5 mm"}, "counterbody": GLASS}
    encoder = {"file": "encoder.csv", "mounted_on": "crank", "zero": "0 deg"}
    settings = run_settings(joint=None, contact=contact, mechanism=links, encoder=encoder)
    found = locate_run(replace(run, settings=settings))
    angle, step = np.radians(found.crank_angle.values), 2 * np.pi / 1000

    def position(angle):
        return 0.076 * np.cos(angle) + np.sqrt(0.203**2 - (0.076 * np.sin(angle)) ** 2)

    rate = (position(angle + step) - position(angle - step)) / (2 * step) * np.pi
    npt.assert_allclose(found.sliding_speed, np.abs(rate), rtol=1e-4, atol=1e-6)
    npt.assert_allclose(describe_contact(settings).stroke, 0.076)
