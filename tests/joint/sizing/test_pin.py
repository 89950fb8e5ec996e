"""The pin: the published numbers of the guide, and limits."""

import math

import pytest
from scenes.joints import altered, assessed

# 100 kN, 600 MPa, safety 2, 120 mm free length
GOLD = altered(pin={"yield_stress": 600e6}, bushing_width=0.12, lateral_play=0.0)


def bent(**changes):
    return assessed(GOLD, **changes).step("pin_bending")


@pytest.mark.parametrize("hole", [1e-3, 30e-3])
def test_the_least_diameter_keeps_the_hole(hole):
    """Just enough with the hole as it is, from a pin of another diameter."""
    least = bent(pin_diameter=0.06, hole_diameter=hole).number("least diameter") * 1e-3
    for factor, holds in ((1.0001, True), (0.9999, False)):
        assert bent(pin_diameter=factor * least, hole_diameter=hole).holds == holds


def test_holes_and_pins_beyond_the_equation_are_marked():
    wide = bent(pin_diameter=0.08, hole_diameter=0.024)
    assert (wide.valid, wide.number("stress concentration")) == (False, 3.0)
    through = bent(pin_diameter=0.08, hole_diameter=0.07)
    assert (through.present, through.margin) == (math.inf, -1.0)
    # thicker than its free length
    assert bent(pin_diameter=0.11).valid
    assert not bent(pin_diameter=0.13).valid


def test_hardness_from_the_strength_is_marked_above_400_brinell():
    for ultimate, valid in ((1300e6, True), (1400e6, False)):
        seat = {"hardness_low": None, "ultimate_stress": ultimate}
        step = assessed(GOLD, pin_diameter=0.08, seat=seat).step("seat_edge")
        assert (step.equation, step.valid) == ("eqs. 12 and 13", valid)


def test_a_pin_that_would_fold_is_reported():
    step = assessed(pin={"youngs_modulus": 5e6}).step("lateral_force")
    assert step.margin < 0
    assert step.number("lateral shift") == pytest.approx(180e3)  # the whole length, um
