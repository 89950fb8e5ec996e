"""Mechanism, encoder and joint from the settings of a run, in SI."""

import math
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.film import run_settings

from erlif.pipeline.physics.joint import describe_joint, locate_run
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
