"""The eye of the housing."""

import math
from dataclasses import replace

import pytest

from erlif.models.bearing import least_eyebar_diameter
from erlif.sizing import example_joint, walk_guide
from erlif.sizing.housing import least_eye


def test_the_eye_is_that_of_the_models():
    case = {"bore": 0.08, "width": 0.04}
    expected = least_eyebar_diameter(100e3, yield_stress=600e6, safety=2.0, **case)
    assert least_eye(100e3, allowed=300e6, **case) == pytest.approx(expected, rel=1e-12)
    assert least_eye(100e3, allowed=300e6, **case) == pytest.approx(96.97623e-3, rel=1e-6)


def test_a_load_that_no_eye_carries_is_reported():
    found = walk_guide(replace(example_joint(), force=3e6)).step("housing_eye")
    assert found.margin < 0
    assert found.number("least outer diameter") == math.inf
    assert found.alternatives[0] == (
        "no outer diameter is enough; the eye must be wider than 179.1 mm"
    )


def test_an_eye_smaller_than_its_bore_is_reported():
    walk = walk_guide(replace(example_joint(), housing_diameter=0.09))
    assert walk.step("housing_eye").margin == -1.0
    assert walk.step("press_fit").missing == "a housing larger than the bushing"
