"""Speed, heat, temperature and wear."""

import math

import numpy as np
import pytest
from scenes.joints import altered, assessed
from scipy.integrate import trapezoid

from erlif.joint.models.wear import steady_bushing_wear
from erlif.joint.sizing import read_materials


def test_a_hot_outside_and_a_bushing_that_hardly_conducts_are_reported():
    hot = assessed(outside_temperature=200.0).step("temperature")
    assert (hot.margin, hot.holds) == (-1.0, False)
    assert hot.alternatives[0] == "a grease for more than 200 degC"
    assert "width" not in "".join(hot.alternatives)
    hot = assessed(outside_temperature=110.0, bushing={"temperature": 100.0}).step("temperature")
    assert hot.alternatives[0].startswith("a bushing material")

    # POM, 0.2 W/(m K) beside 42.6: 0.5 % of the heat, and 40 degC where pv is exceeded
    assessment = assessed(bushing=read_materials()["POM"], friction=0.25, outside_temperature=40.0)
    assert not assessment.step("temperature").valid
    assert not assessment.step("warm_play").valid
    assert "pv" in {step.key for step in assessment.failed}


def test_wear_is_the_steady_wear_of_colbert():
    """The pin sinks by h, so the wall loses h cos(phi) over the loaded half of the bore."""
    joint = altered(bushing={"wear": 5.05e-13})
    step = assessed(joint).step("wear")
    expected = steady_bushing_wear(
        60e3, shaft_radius=0.04, width=0.1, sliding_distance=1e3, specific_wear=5.05e-13
    )
    assert step.present == pytest.approx(step.number("sliding distance") * expected.depth * 1e3)
    angle = np.linspace(-math.pi / 2, math.pi / 2, 2001)
    volume = trapezoid(step.present * np.cos(angle), angle) * 40 * 100  # mm3
    assert step.number("worn volume") == pytest.approx(volume, rel=1e-5)

    hours = step.number("life to the largest wear")
    at_end = assessed(joint, life=hours * 3600).step("wear")
    assert at_end.margin == pytest.approx(0, abs=1e-9)


def test_only_what_is_missing_is_asked_for():
    step = assessed(bushing={"wear": None}).step("wear")
    assert step.missing == "wear of [bushing], from a test of the pair"
    assert assessed(life=None).step("wear").missing == "[life] time"
    assert assessed(pin={"conductivity": None}).step("temperature").missing.endswith("of [pin]")


def test_the_friction_moment_is_force_times_radius():
    step = assessed().step("friction_moment")
    assert (step.unit, step.present) == ("N m", pytest.approx(0.1 * 100e3 * 0.04))
    assert not assessed(friction=0.05).step("friction").valid  # below the range of the guide
