"""Chosen dimensions: just enough, and no smaller ones would do."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.joints import random_joint

from erlif.core.errors import ConfigError
from erlif.joint.sizing import DIMENSIONS, example_joint, round_up, size_joint, walk_guide

OPEN = dict.fromkeys(DIMENSIONS)


def wanted(**changes):
    return replace(example_joint(), **(OPEN | changes))


def test_the_chosen_joint_holds_and_its_weakest_margin_is_used_up():
    walk = walk_guide(size_joint(replace(wanted(), lock=None)))
    assert walk.sound
    assert not walk.unusual
    assert walk.weakest.margin == pytest.approx(0, abs=1e-9)


def test_a_thinner_pin_with_its_own_least_width_fails():
    """The least diameter: half a per cent less has no width that is enough."""
    joint = replace(wanted(), lock=None)
    least = size_joint(joint).pin_diameter
    thinner = size_joint(replace(joint, pin_diameter=0.995 * least))
    assert not walk_guide(thinner).sound or thinner.bushing_width > 1.5 * thinner.pin_diameter


def test_a_narrower_bushing_or_seat_fails():
    joint = replace(wanted(pin_diameter=0.05, play=200e-6), lock=None)
    sized = size_joint(joint)
    assert walk_guide(sized).sound
    for name in ("bushing_width", "seat_width", "housing_diameter"):
        smaller = walk_guide(replace(sized, **{name: 0.995 * getattr(sized, name)}))
        assert not smaller.sound or smaller.unusual, name


def test_preferred_numbers_hold_too():
    for series in ("R10", "R20", "R40"):
        sized = size_joint(replace(wanted(), lock=None), series=series)
        assert walk_guide(sized).sound
        for name in ("pin_diameter", "bushing_width", "wall", "seat_width", "housing_diameter"):
            assert getattr(sized, name) == round_up(getattr(sized, name), series)


def test_a_large_play_needs_a_wider_bushing():
    """Eq. 9: a narrow contact has a high peak."""
    soft = replace(example_joint().bushing, hardness_low=90.0)
    tight, loose = (
        size_joint(wanted(pin_diameter=0.06, play=play, bushing=soft, interference=0.0))
        for play in (50e-6, 20e-3)
    )
    assert loose.bushing_width > 1.2 * tight.bushing_width
    assert walk_guide(loose).step("pressure_peak").margin == pytest.approx(0, abs=1e-9)


def test_given_dimensions_stay():
    joint = wanted(pin_diameter=0.03, bushing_width=0.02, wall=0.004, play=0.0)
    sized = size_joint(joint, series="R20")
    assert [getattr(sized, name) for name in ("pin_diameter", "bushing_width", "wall", "play")] == [
        0.03,
        0.02,
        0.004,
        0.0,
    ]


@pytest.mark.parametrize(
    "given", [{"bushing_width": 0.02}, {"housing_diameter": 0.12, "force": 400e3}]
)
@pytest.mark.parametrize("series", ["none", "R40"])
def test_a_pin_is_found_where_a_much_thicker_one_is_not_enough(given, series):
    """A thick pin heats a bushing of given width, and leaves no eye in a given housing."""
    joint = replace(wanted(**given), lock=None, largest_wear=None)
    sized = size_joint(joint, series=series)
    assert walk_guide(sized).sound
    thick = size_joint(replace(joint, pin_diameter=5.0))
    assert not walk_guide(thick).sound


def test_a_pin_that_no_preferred_number_satisfies_has_the_next_one():
    """An eye of 120 mm around pins of 50 to 57 mm: R10 has 50 and 63 mm."""
    joint = wanted(housing_diameter=0.12, force=400e3, largest_wear=None)
    sized = size_joint(replace(joint, lock=None), series="R10")
    assert sized.pin_diameter == 0.063


@pytest.mark.parametrize("temperature", [130.0, 119.999])
def test_a_joint_that_no_size_saves_is_sized_and_reported(temperature):
    joint = replace(wanted(), outside_temperature=temperature, friction=1.0)
    walk = walk_guide(size_joint(joint, series="R20"))
    assert walk.joint.pin_diameter > 0
    assert walk.weakest is not None


def test_random_joints_are_sized_soundly_where_a_size_exists():
    """Limits that a size can meet are met: all but those of materials, temperature and fit."""
    rng = np.random.default_rng(3)
    free = {"temperature", "warm_play", "speed", "lateral_force"}
    free |= {"press_bushing", "press_housing"}  # of the interference, which is given
    for _ in range(60):
        joint = replace(random_joint(rng), **OPEN, lock=None, hole_diameter=0.0, lateral_play=0.0)
        if joint.pin.yield_stress is None:
            continue
        failed = {step.key for step in walk_guide(size_joint(joint)).failed}
        assert failed <= free


def test_a_pin_of_unknown_strength_cannot_be_sized():
    pin = replace(example_joint().pin, yield_stress=None)
    with pytest.raises(ConfigError, match="Expected the yield stress of the pin"):
        size_joint(wanted(pin=pin))
