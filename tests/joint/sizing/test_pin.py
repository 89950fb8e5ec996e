"""The pin: the published numbers of the guide, and limits."""

import math
from dataclasses import replace

import pytest

from erlif.joint.sizing import example_joint, walk_guide
from erlif.joint.sizing.pin import bending_factor


def gold(**changes):
    """100 kN, 600 MPa, safety 2, 120 mm free length."""
    joint = example_joint()
    pin = replace(joint.pin, yield_stress=600e6)
    return replace(joint, pin=pin, bushing_width=0.12, lateral_play=0.0, **changes)


def step(joint, key):
    return walk_guide(joint).step(key)


@pytest.mark.parametrize(
    ("key", "diameter"), [("pin_shear", 19.17166e-3), ("pin_bending", 37.06722e-3)]
)
def test_the_margin_vanishes_at_the_least_diameter(key, diameter):
    found = step(gold(pin_diameter=diameter), key)
    assert found.margin == pytest.approx(0, abs=1e-6)
    assert found.number("least diameter") == pytest.approx(diameter * 1e3, rel=1e-6)


def test_a_hole_thickens_the_pin_by_40_to_45_per_cent():
    """The source has 34 to 44 % for holes up to 0.2 d, with 8/(3 pi) for 16/(3 pi)."""
    growth = []
    for ratio in (1e-9, 0.05, 0.1, 0.15, 0.2):
        concentration, remaining = bending_factor(ratio)
        growth.append((concentration / remaining) ** (1 / 3))
    assert 1.39 < min(growth) < 1.41
    assert 1.44 < max(growth) < 1.455


@pytest.mark.parametrize("hole", [1e-3, 4e-3, 12e-3, 30e-3])
def test_the_least_diameter_keeps_the_hole(hole):
    """Just enough with the hole as it is, from a pin of another diameter."""
    least = step(gold(pin_diameter=0.06, hole_diameter=hole), "pin_bending").number(
        "least diameter"
    )
    for diameter, holds in ((1.0001 * least, True), (0.9999 * least, False)):
        found = step(gold(pin_diameter=diameter * 1e-3, hole_diameter=hole), "pin_bending")
        assert found.holds == holds


def test_a_hole_beyond_the_fit_is_marked_and_one_as_wide_as_the_pin_leaves_nothing():
    wide = step(gold(pin_diameter=0.08, hole_diameter=0.024), "pin_bending")
    assert (wide.valid, wide.number("stress concentration")) == (False, 3.0)
    through = step(gold(pin_diameter=0.08, hole_diameter=0.07), "pin_bending")
    assert (through.present, through.margin) == (math.inf, -1.0)


def test_bending_is_marked_where_the_pin_is_thicker_than_its_free_length():
    assert step(gold(pin_diameter=0.11), "pin_bending").valid
    assert not step(gold(pin_diameter=0.13), "pin_bending").valid


def test_hardness_from_the_strength_is_marked_above_400_brinell():
    joint = gold(pin_diameter=0.08)
    for ultimate, valid in ((1300e6, True), (1400e6, False)):
        seat = replace(joint.seat, hardness_low=None, ultimate_stress=ultimate)
        found = step(replace(joint, seat=seat), "seat_edge")
        assert (found.equation, found.valid) == ("eqs. 12 and 13", valid)


def test_a_pin_that_would_fold_is_reported():
    soft = replace(example_joint().pin, youngs_modulus=5e6)
    found = step(replace(example_joint(), pin=soft), "lateral_force")
    assert found.margin < 0
    assert found.number("lateral shift") == pytest.approx(180e3)  # the whole length, um
