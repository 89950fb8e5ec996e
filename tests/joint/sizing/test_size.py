"""Chosen dimensions: just enough, and no smaller ones would do."""

import numpy as np
import pytest
from scenes.joints import altered, assessed, random_joint

from erlif.core.errors import ConfigError
from erlif.joint.sizing import DIMENSIONS, assess_joint, round_up, size_joint

OPEN = dict.fromkeys(DIMENSIONS) | {"lock": None}


def wanted(**changes):
    return altered(**(OPEN | changes))


def test_the_chosen_joint_holds_and_its_weakest_margin_is_used_up():
    sized = size_joint(wanted())
    assessment = assess_joint(sized)
    assert assessment.sound
    assert not assessment.unusual
    assert assessment.weakest.margin == pytest.approx(0, abs=1e-9)

    # a thinner pin has no width that is enough
    thinner = size_joint(wanted(pin_diameter=0.995 * sized.pin_diameter))
    assert not assess_joint(thinner).sound or thinner.bushing_width > 1.5 * thinner.pin_diameter


def test_a_narrower_bushing_seat_or_eye_fails():
    sized = size_joint(wanted(pin_diameter=0.05, play=200e-6))
    assert assess_joint(sized).sound
    for name in ("bushing_width", "seat_width", "housing_diameter"):
        smaller = assessed(sized, **{name: 0.995 * getattr(sized, name)})
        assert not smaller.sound or smaller.unusual, name


@pytest.mark.parametrize("series", ["R10", "R20", "R40"])
def test_preferred_numbers_hold_too(series):
    sized = size_joint(wanted(), series=series)
    assert assess_joint(sized).sound
    for name in DIMENSIONS[:-1]:
        # a width stays at the end of what is recommended rather than leave it
        if name == "bushing_width" and sized.bushing_width == pytest.approx(
            1.5 * sized.pin_diameter, rel=1e-12
        ):
            continue
        assert getattr(sized, name) == round_up(getattr(sized, name), series)


@pytest.mark.parametrize("series", ["R10", "R20", "R40"])
def test_what_a_series_proposes_is_practical(series):
    """Within the proportions of eq. 11, a seat of a quarter, a play of IT7 of ISO 286-1."""
    for force in np.geomspace(2e3, 500e3, 9):
        sized = size_joint(wanted(force=force, mean_force=force / 2), series=series)
        assessment = assess_joint(sized)
        assert assessment.step("width_ratio").holds
        assert sized.seat_width >= sized.pin_diameter / 4
        millimetres = sized.pin_diameter * 1e3
        tolerance = 16 * (0.45 * millimetres ** (1 / 3) + 0.001 * millimetres)
        assert assessment.step("press_fit").number("play assembled") >= tolerance - 1e-6


def test_a_width_that_would_be_rounded_out_of_its_range_stays_inside():
    """20 mm with 30 mm is 1.5; the next number of R20 is 31.5 mm."""
    # pv in proportion to 1 over the width, and used up at 29.5 mm
    joint = wanted(pin_diameter=0.02, force=1e3, mean_force=1e3, largest_wear=None)
    pv = joint.moving_force / (0.02 * 0.0295) * joint.speed(0.02)
    sized = size_joint(altered(joint, bushing={"pv": pv}), series="R20")
    assert sized.bushing_width == pytest.approx(0.03, rel=1e-12)
    assert assess_joint(sized).sound


def test_no_pin_is_thicker_than_the_largest_diameter():
    free = size_joint(wanted()).pin_diameter
    for series in ("none", "R20"):
        held = size_joint(wanted(largest_diameter=free * 1.001), series=series)
        assert 0.999999 * free <= held.pin_diameter <= free * 1.001
        thin = size_joint(wanted(largest_diameter=0.7 * free), series=series)
        assert thin.pin_diameter <= 0.7 * free
        assert not assess_joint(thin).sound


def test_a_large_play_needs_a_wider_bushing():
    """Eq. 9: a narrow contact has a high peak."""
    soft = altered(wanted(pin_diameter=0.06, interference=0.0), bushing={"hardness_low": 90.0})
    tight, loose = (size_joint(altered(soft, play=play)) for play in (50e-6, 20e-3))
    assert loose.bushing_width > 1.2 * tight.bushing_width
    assert assess_joint(loose).step("pressure_peak").margin == pytest.approx(0, abs=1e-9)


def test_given_dimensions_stay():
    given = {"pin_diameter": 0.03, "bushing_width": 0.02, "wall": 0.004, "play": 0.0}
    sized = size_joint(wanted(**given), series="R20")
    assert {name: getattr(sized, name) for name in given} == given


@pytest.mark.parametrize(
    "given", [{"bushing_width": 0.02}, {"housing_diameter": 0.12, "force": 400e3}]
)
@pytest.mark.parametrize("series", ["none", "R40"])
def test_a_pin_is_found_where_a_much_thicker_one_is_not_enough(given, series):
    """A thick pin heats a bushing of given width, and leaves no eye in a given housing."""
    joint = wanted(**given, largest_wear=None)
    assert assess_joint(size_joint(joint, series=series)).sound
    assert not assess_joint(size_joint(altered(joint, pin_diameter=5.0))).sound
    if "force" in given:  # pins of 50 to 57 mm; R10 has 50 and 63 mm
        assert size_joint(joint, series="R10").pin_diameter == 0.063


@pytest.mark.parametrize("temperature", [130.0, 119.999])
def test_a_joint_that_no_size_saves_is_sized_and_reported(temperature):
    joint = wanted(outside_temperature=temperature, friction=1.0)
    assessment = assess_joint(size_joint(joint, series="R20"))
    assert assessment.joint.pin_diameter > 0
    assert assessment.weakest is not None


def test_random_joints_are_sized_soundly_where_a_size_exists():
    """Limits that a size can meet are met: all but those of materials, temperature and fit."""
    rng = np.random.default_rng(3)
    free = {"temperature", "warm_play", "speed", "lateral_force"}
    free |= {"press_bushing", "press_housing"}  # of the interference, which is given
    for _ in range(60):
        joint = altered(random_joint(rng), **OPEN, hole_diameter=0.0, lateral_play=0.0)
        if joint.pin.yield_stress is not None:
            assert {step.key for step in assess_joint(size_joint(joint)).failed} <= free


def test_a_pin_of_unknown_strength_cannot_be_sized():
    with pytest.raises(ConfigError, match="Expected the yield stress of the pin"):
        size_joint(wanted(pin={"yield_stress": None}))
