"""Speed, heat, temperature and wear."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from erlif.joint.sizing import JointState, example_joint, read_materials, walk_guide
from erlif.models.wear import steady_bushing_wear, surface_temperature


def test_heat_divides_as_the_bodies_conduct():
    """4/7 of it into a bushing of 60 W/(m K) on a pin of 45."""
    joint = example_joint()
    joint = replace(
        joint,
        pin=replace(joint.pin, conductivity=45.0),
        bushing=replace(joint.bushing, conductivity=60.0),
    )
    whole = 0.1 * 60e3 * joint.speed(0.08)
    assert JointState(joint).heat == pytest.approx(whole * 4 / 7)


def test_the_rise_is_that_of_the_models_through_half_of_the_ring():
    joint = example_joint()
    expected = surface_temperature(
        300.0,
        heat=JointState(joint).heat,
        pin_diameter=0.08,
        wall=0.01,
        width=0.1,
        conductivity=39.0,
        arc=math.pi,
    )
    assert JointState(joint).rise == pytest.approx(expected - 300.0, rel=1e-9)


def test_grease_that_is_cooler_than_the_outside_is_reported():
    walk = walk_guide(replace(example_joint(), outside_temperature=130.0))
    assert walk.step("temperature").margin == -1.0
    assert not walk.sound


def test_wear_is_the_steady_wear_of_colbert():
    joint = example_joint()
    joint = replace(joint, bushing=replace(joint.bushing, wear=5.05e-13))
    expected = steady_bushing_wear(
        60e3, shaft_radius=0.04, width=0.1, sliding_distance=1e3, specific_wear=5.05e-13
    )
    step = walk_guide(joint).step("wear")
    kilometres = step.number("sliding distance")
    assert step.present == pytest.approx(kilometres * expected.depth * 1e3)


def test_the_worn_volume_is_that_of_the_worn_depth():
    """The pin sinks by h, so the wall loses h cos(phi) over the loaded half of the bore."""
    step = walk_guide(example_joint()).step("wear")
    angle = np.linspace(-math.pi / 2, math.pi / 2, 2001)
    volume = trapezoid(step.present * np.cos(angle), angle) * 40 * 100  # mm3
    assert step.number("worn volume") == pytest.approx(volume, rel=1e-5)


def test_the_life_ends_where_the_largest_wear_is_reached():
    joint = example_joint()
    joint = replace(joint, bushing=replace(joint.bushing, wear=1e-17))
    step = walk_guide(joint).step("wear")
    hours = step.number("life to the largest wear")
    at_end = replace(joint, life=hours * 3600)
    assert walk_guide(at_end).step("wear").margin == pytest.approx(0, abs=1e-9)


def test_limits_of_the_bushing_govern_where_they_are_known():
    joint = example_joint()
    slow = replace(joint.bushing, speed=0.01, pv=0.05e6)
    walk = walk_guide(replace(joint, bushing=slow))
    assert walk.step("speed").state == walk.step("pv").state == "fails"
    unknown = replace(joint, bushing=replace(joint.bushing, pv=None))
    assert walk_guide(unknown).step("pv").state == "result"


def test_friction_outside_of_the_range_of_the_guide_is_marked():
    assert not walk_guide(replace(example_joint(), friction=0.05)).step("friction").valid


def test_a_bushing_that_hardly_conducts_has_no_valid_temperature():
    """POM, 0.2 W/(m K) beside 42.6: 0.5 % of the heat, and 40 degC where pv is exceeded."""
    joint = example_joint()
    joint = replace(joint, bushing=read_materials()["POM"], friction=0.25, outside_temperature=40.0)
    walk = walk_guide(joint)
    assert not walk.step("temperature").valid
    assert "pv governs" in walk.step("temperature").validity
    assert not walk.step("warm_play").valid
    assert "pv" in {step.key for step in walk.failed}


def test_what_helps_against_a_hot_outside_is_proposed():
    hot = walk_guide(replace(example_joint(), outside_temperature=200.0)).step("temperature")
    assert hot.alternatives[0] == "a grease for more than 200 degC"
    assert "width" not in "".join(hot.alternatives)
    softer = replace(example_joint().bushing, temperature=100.0)
    hot = walk_guide(replace(example_joint(), outside_temperature=110.0, bushing=softer))
    assert hot.step("temperature").alternatives[0].startswith("a bushing material")


def test_the_friction_moment_is_force_times_radius():
    step = walk_guide(example_joint()).step("friction_moment")
    assert (step.unit, step.present) == ("N m", pytest.approx(0.1 * 100e3 * 0.04))
