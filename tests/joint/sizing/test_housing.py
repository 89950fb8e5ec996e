"""The eye of the housing."""

import math
from dataclasses import replace

import pytest

from erlif.joint.sizing import example_joint, walk_guide


def test_the_margin_vanishes_at_the_least_eye():
    """100 kN, bore 80 mm, width 40 mm, 300 MPa: 96.97623 mm."""
    joint = example_joint()
    joint = replace(
        joint,
        housing=replace(joint.housing, yield_stress=600e6),
        wall=0.005,
        pin_diameter=0.07,
        bushing_width=0.04,
        housing_diameter=96.97623e-3,
    )
    assert walk_guide(joint).step("housing_eye").margin == pytest.approx(0, abs=1e-6)


def test_a_load_that_no_eye_carries_is_reported():
    found = walk_guide(replace(example_joint(), force=3e6)).step("housing_eye")
    assert found.margin < 0
    assert found.number("least outer diameter") == math.inf
    assert found.alternatives[0] == (
        "no outer diameter is enough; the eye must be wider than 179.1 mm"
    )


def test_an_eye_smaller_than_its_bore_is_reported():
    walk = walk_guide(replace(example_joint(), housing_diameter=0.09))
    eye = walk.step("housing_eye")
    assert eye.margin == -1.0
    assert eye.alternatives[0] == "the bushing of 100 mm does not fit into a housing of 90 mm"
    assert "inf" not in "".join(eye.alternatives)
    assert walk.step("press_fit").missing == "a housing larger than the bushing"
