"""Play, press fit and growth."""

from dataclasses import replace

import pytest

from erlif.sizing import example_joint, walk_guide
from erlif.sizing.fit import assembled_play, bore_displacement, growth_loss, least_play


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
    assert bore_displacement(gold()) == pytest.approx(-27.17294e-6, rel=1e-6)
    assert assembled_play(gold()) == pytest.approx(100e-6 - 2 * 27.17294e-6, rel=1e-6)


def test_a_loose_bushing_takes_none():
    assert assembled_play(replace(gold(), interference=0.0)) == 100e-6


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
    assert growth_loss(replace(joint, bushing=steel)) == pytest.approx(0, abs=1e-15)


def test_a_polymer_grows_into_its_bore():
    """Nylon, 100e-6/K (section 2.1.15): the wall of 10 mm grows by 40 um at 40 K on each side."""
    joint = replace(example_joint(), half_swing=0.0)
    nylon = replace(joint.bushing, expansion=100e-6)
    expected = 80e-3 * 12e-6 * 40 - (100e-3 * 12e-6 * 40 - 2 * 10e-3 * 100e-6 * 40)
    assert growth_loss(replace(joint, bushing=nylon)) == pytest.approx(expected, rel=1e-9)


def test_the_least_play_meets_both_recommendations():
    for expansion in (12e-6, 100e-6):
        joint = example_joint()
        joint = replace(joint, bushing=replace(joint.bushing, expansion=expansion))
        walk = walk_guide(replace(joint, play=least_play(joint)))
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
