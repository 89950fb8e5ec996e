"""Housing, play, press fit and growth."""

import math

import pytest
from scenes.joints import altered, assessed

from erlif.joint.sizing import JointState


def gold(**changes):
    """Bronze of 110 GPa and 0.34 in steel, 70/80/160 mm, 60 um: -27.17294 um."""
    rings = {"pin_diameter": 0.07, "wall": 0.005, "housing_diameter": 0.16, "play": 100e-6}
    bronze = {"youngs_modulus": 110e9, "poissons_ratio": 0.34}
    steel = {"youngs_modulus": 206e9, "poissons_ratio": 0.3}
    return altered(altered(bushing=bronze, housing=steel, **rings), **changes)


@pytest.mark.parametrize("expansion", [12e-6, 100e-6])
def test_a_bushing_grows_into_its_bore_and_the_least_play_allows_for_it(expansion):
    """A wall of 10 mm, held by its housing, at 40 K: none for steel, 40 um a side for nylon."""
    joint = altered(bushing={"expansion": expansion})
    taken = 80e-3 * 12e-6 * 40 - (100e-3 * 12e-6 * 40 - 2 * 10e-3 * expansion * 40)
    loss = JointState(altered(joint, half_swing=0.0)).growth_loss
    assert loss == pytest.approx(taken, rel=1e-9, abs=1e-15)
    assessment = assessed(joint, play=JointState(joint).least_play)
    margins = [assessment.step(key).margin for key in ("relative_play", "warm_play")]
    assert min(margins) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("interference", [0.0, 60e-6])
def test_play_is_marked_where_the_loss_by_the_press_fit_is_not_known(interference):
    assessment = assessed(bushing={"poissons_ratio": None}, interference=interference)
    for key in ("relative_play", "warm_play"):
        assert assessment.step(key).valid == (interference == 0)
        assert ("press fit" in assessment.step(key).validity) == (interference > 0)


def test_a_joint_that_moves_and_is_tight_when_warm_fails():
    """80 um of play in the bore, 78 um taken by the press fit."""
    joint = altered(wall=8e-3, play=80e-6, interference=90e-6)
    for play in (80e-6, -100e-6):
        assessment = assessed(joint, play=play)
        assert assessment.step("warm_play").present < 0
        assert "warm_play" in {step.key for step in assessment.failed}

    # a joint that does not move may be tight; one of unknown growth may not
    still = assessed(joint, play=-100e-6, half_swing=0.0)
    assert still.sound
    assert "warm_play" in {step.key for step in still.unusual}
    assert not assessed(joint, play=-100e-6, bushing={"conductivity": None}).sound
    unknown = assessed(joint, play=200e-6, bushing={"conductivity": None})
    assert unknown.step("warm_play").missing


def test_the_press_fit_of_one_material_has_the_stresses_of_its_closed_form():
    """Radial interference delta: p = E delta (b2 - a2)(c2 - b2) / (2 b^3 (c2 - a2)), Lame."""
    joint = gold(bushing={"youngs_modulus": 206e9, "poissons_ratio": 0.3, "yield_stress": 200e6})
    a, b, c = 0.035, 0.04, 0.08
    pressure = 206e9 * 30e-6 * (b**2 - a**2) * (c**2 - b**2) / (2 * b**3 * (c**2 - a**2))
    hoop = pressure * (c**2 + b**2) / (c**2 - b**2)
    mises = (((hoop + pressure) ** 2 + hoop**2 + pressure**2) / 2) ** 0.5  # in plane stress
    expected = {"press_bushing": 2 * pressure * b**2 / (b**2 - a**2), "press_housing": mises}
    for key, stress in expected.items():
        assert assessed(joint).step(key).present == pytest.approx(stress / 1e6)
    push_out = assessed(joint).step("press_fit").number("push-out force at a friction of 0.1")
    assert push_out == pytest.approx(0.1 * pressure * math.pi * 0.08 * joint.bushing_width / 1e3)


def test_a_bushing_that_yields_in_its_housing_is_reported():
    """1 mm on 96 mm of bronze: more than 1 GPa in elastic rings, of 330 MPa."""
    joint = altered(wall=8e-3, interference=1e-3, play=2e-3)
    step = assessed(joint).step("press_bushing")
    assert step.present > 1000
    assert step.state == "fails"
    most = 1e-6 * float(step.alternatives[0].split()[-2])
    margin = assessed(joint, interference=most).step("press_bushing").margin
    assert margin == pytest.approx(0, abs=1e-3)
    # a fit that flows takes another play than an elastic one
    for key in ("relative_play", "warm_play"):
        assert not assessed(joint).step(key).valid
        assert assessed(joint, interference=60e-6).step(key).valid


def test_a_load_that_no_eye_carries_and_an_eye_without_room_are_reported():
    eye = assessed(force=3e6).step("housing_eye")
    assert eye.margin < 0
    assert eye.number("least outer diameter") == math.inf
    assert "wider than 179.1 mm" in eye.alternatives[0]

    small = assessed(housing_diameter=0.09)
    eye = small.step("housing_eye")
    assert eye.margin == -1.0
    assert "the bushing of 100 mm does not fit" in eye.alternatives[0]
    assert "inf" not in "".join(eye.alternatives)
    assert small.step("press_fit").missing == "a housing larger than the bushing"


def test_the_press_fit_loosens_in_the_cold_where_bronze_shrinks_more():
    """Diameter of the fit, 100 mm, times the difference of the expansions and of temperature."""
    parts = {"bushing": {"expansion": 18e-6}, "housing": {"expansion": 12e-6}}
    name = "interference at the outside temperature"
    for outside, expected in ((0.0, 60 - 100e3 * 6e-6 * 20), (50.0, 60 + 100e3 * 6e-6 * 30)):
        step = assessed(outside_temperature=outside, **parts).step("press_fit")
        assert step.number(name) == pytest.approx(expected)
    unknown = assessed(bushing={"expansion": None}).step("press_fit")
    assert name not in {title for title, *_ in unknown.numbers}
