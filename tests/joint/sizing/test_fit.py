"""Play, press fit and growth."""

from dataclasses import replace

import pytest

from erlif.joint.sizing import JointState, example_joint, walk_guide


def gold():
    """Bronze of 110 GPa and 0.34 in steel, 70/80/160 mm, 60 um: -27.17294 um."""
    joint = example_joint()
    bronze = replace(joint.bushing, youngs_modulus=110e9, poissons_ratio=0.34)
    steel = replace(joint.housing, youngs_modulus=206e9, poissons_ratio=0.3)
    return replace(
        joint,
        bushing=bronze,
        housing=steel,
        pin_diameter=0.07,
        wall=0.005,
        housing_diameter=0.16,
        interference=60e-6,
        play=100e-6,
    )


def test_the_press_fit_takes_its_share_of_the_play():
    assert JointState(gold()).displacement == pytest.approx(-27.17294e-6, rel=1e-6)
    assert JointState(gold()).play == pytest.approx(100e-6 - 2 * 27.17294e-6, rel=1e-6)


def test_a_loose_bushing_takes_none():
    assert JointState(replace(gold(), interference=0.0)).play == 100e-6


@pytest.mark.parametrize("play", [0.0, -30e-6])
def test_no_play_and_interference_are_reported_as_outside(play):
    walk = walk_guide(replace(example_joint(), play=play, interference=0.0))
    found = walk.step("relative_play")
    assert found.state == "outside"
    assert found.present == pytest.approx(1e3 * play / 0.08)
    assert walk.step("pressure_peak").holds


def test_growth_of_parts_of_equal_temperature_and_material_takes_nothing():
    joint = replace(example_joint(), half_swing=0.0)
    steel = replace(joint.bushing, expansion=12e-6)
    assert JointState(replace(joint, bushing=steel)).growth_loss == pytest.approx(0, abs=1e-15)


def test_a_polymer_grows_into_its_bore():
    """Nylon, 100e-6/K (section 2.1.15): the wall of 10 mm grows by 40 um at 40 K on each side."""
    joint = replace(example_joint(), half_swing=0.0)
    nylon = replace(joint.bushing, expansion=100e-6)
    expected = 80e-3 * 12e-6 * 40 - (100e-3 * 12e-6 * 40 - 2 * 10e-3 * 100e-6 * 40)
    assert JointState(replace(joint, bushing=nylon)).growth_loss == pytest.approx(
        expected, rel=1e-9
    )


def test_the_least_play_meets_both_recommendations():
    for expansion in (12e-6, 100e-6):
        joint = example_joint()
        joint = replace(joint, bushing=replace(joint.bushing, expansion=expansion))
        walk = walk_guide(replace(joint, play=JointState(joint).least_play))
        margins = [walk.step(key).margin for key in ("relative_play", "warm_play")]
        assert min(margins) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("interference", [0.0, 60e-6])
def test_play_is_marked_where_the_loss_by_the_press_fit_is_not_known(interference):
    joint = example_joint()
    unknown = replace(joint.bushing, poissons_ratio=None)
    walk = walk_guide(replace(joint, bushing=unknown, interference=interference))
    for key in ("relative_play", "warm_play"):
        assert walk.step(key).valid == (interference == 0)
        assert ("press fit" in walk.step(key).validity) == (interference > 0)


def test_a_joint_that_moves_and_is_tight_when_warm_fails():
    """80 um of play in the bore, 78 um taken by the press fit."""
    joint = replace(example_joint(), wall=8e-3, play=80e-6, interference=90e-6)
    for play in (80e-6, -100e-6):
        walk = walk_guide(replace(joint, play=play))
        assert walk.step("warm_play").present < 0
        assert "warm_play" in {step.key for step in walk.failed}
    assert "seizes" in walk.step("warm_play").reason

    # a joint that does not move may be tight; one of unknown growth may not
    still = walk_guide(replace(joint, play=-100e-6, half_swing=0.0))
    assert still.sound
    assert "warm_play" in {step.key for step in still.unusual}
    unknown = replace(joint.bushing, conductivity=None)
    assert not walk_guide(replace(joint, play=-100e-6, bushing=unknown)).sound
    assert walk_guide(replace(joint, play=200e-6, bushing=unknown)).step("warm_play").missing


def test_the_press_fit_of_one_material_has_the_stresses_of_its_closed_form():
    """Radial interference delta: p = E delta (b2 - a2)(c2 - b2) / (2 b^3 (c2 - a2)), Lame."""
    joint = replace(gold(), bushing=replace(gold().housing, yield_stress=200e6))
    a, b, c = 0.035, 0.04, 0.08
    pressure = 206e9 * 30e-6 * (b**2 - a**2) * (c**2 - b**2) / (2 * b**3 * (c**2 - a**2))
    hoop = pressure * (c**2 + b**2) / (c**2 - b**2)
    walk = walk_guide(joint)
    assert walk.step("press_bushing").present == pytest.approx(
        2e-6 * pressure * b**2 / (b**2 - a**2)
    )
    assert walk.step("press_housing").number("hoop stress") == pytest.approx(hoop / 1e6)
    mises = (((hoop + pressure) ** 2 + hoop**2 + pressure**2) / 2) ** 0.5  # in plane stress
    assert walk.step("press_housing").present == pytest.approx(mises / 1e6)
    area = 3.14159265 * 0.08 * joint.bushing_width
    push_out = walk.step("press_fit").number("push-out force at a friction of 0.1")
    assert push_out == pytest.approx(0.1 * pressure * area / 1e3)


def test_a_bushing_that_yields_in_its_housing_is_reported():
    """1 mm on 96 mm of bronze: more than 1 GPa in elastic rings, of 330 MPa."""
    joint = replace(example_joint(), wall=8e-3, interference=1e-3, play=2e-3)
    step = walk_guide(joint).step("press_bushing")
    assert step.present > 1000
    assert step.state == "fails"
    most = float(step.alternatives[0].split()[-2])
    least = walk_guide(replace(joint, interference=most * 1e-6)).step("press_bushing")
    assert least.margin == pytest.approx(0, abs=1e-3)
    # a fit that flows takes another play than an elastic one
    for key in ("relative_play", "warm_play"):
        assert not walk_guide(joint).step(key).valid
        assert walk_guide(replace(joint, interference=60e-6)).step(key).valid
