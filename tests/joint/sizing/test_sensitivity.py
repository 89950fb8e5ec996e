"""Derivatives of the weakest margin against finite changes, and other bushings."""

from dataclasses import replace

import pytest

from erlif.joint.sizing import (
    example_joint,
    read_materials,
    sensitivities,
    substitutes,
    walk_guide,
)


def changes(joint):
    walk = walk_guide(joint)
    return walk.weakest, {one.name: one.change for one in sensitivities(walk)}


def test_a_stress_in_bending_changes_by_the_powers_of_its_equation():
    """Eq. 2: allowed over present value is sigma_y d^3 / (F L eta)."""
    joint = replace(example_joint(), lock=None, pin_diameter=0.025, lateral_play=0.0)
    weakest, found = changes(replace(joint, wall=0.02))
    assert weakest.key == "pin_bending"
    whole = 1 + weakest.margin
    expected = {
        "load": -1,
        "safety factor": -1,
        "bushing width": -1,
        "pin diameter": 3,
        "yield stress of the pin": 1,
    }
    assert found == pytest.approx(
        {name: 0.01 * n * whole for name, n in expected.items()}, rel=1e-6
    )


def test_a_temperature_is_changed_by_1_kelvin():
    joint = replace(example_joint(), outside_temperature=119.9)
    weakest, found = changes(joint)
    assert weakest.key == "temperature"
    # (120 - T) / rise - 1, with a rise of 0.7292 K
    assert found["temperature outside"] == pytest.approx(-1 / 0.7292, rel=1e-3)
    assert found["temperature of the grease"] == pytest.approx(1 / 0.7292, rel=1e-3)


def test_first_order_changes_are_those_of_a_small_finite_one():
    joint = example_joint()
    weakest, found = changes(joint)
    for name, changed in (
        ("pin diameter", replace(joint, pin_diameter=0.08 * 1.0001)),
        ("lever of the lock", replace(joint, lock=replace(joint.lock, lever=0.08 * 1.0001))),
    ):
        finite = walk_guide(changed).step(weakest.key).margin - weakest.margin
        assert found[name] == pytest.approx(100 * finite, rel=1e-3)


def test_an_incompressible_bushing_has_its_sensitivities():
    joint = example_joint()
    rubber = replace(joint.bushing, poissons_ratio=0.5)
    assert "load" in changes(replace(joint, bushing=rubber))[1]


def test_a_joint_without_limits_has_no_sensitivity():
    joint = replace(example_joint(), lock=None)
    bare = replace(
        joint.pin,
        yield_stress=None,
        ultimate_stress=None,
        hardness_low=None,
        hardness_high=None,
        youngs_modulus=None,
    )
    nothing = replace(joint, pin=bare, bushing=bare, seat=bare, housing=bare, period=None)
    walk = walk_guide(nothing)
    assert walk.weakest is None
    assert sensitivities(walk) == ()


def test_of_other_bushings_the_best_known_come_first():
    materials = read_materials()
    found = substitutes(example_joint(), materials.values())
    names = {one.name for one in materials.values() if one.use == "bushing"} - {"CuAl10Ni5Fe4"}
    assert {one.material.name for one in found} == names

    # those that hold, then the number of limits that are not known, then the margin
    order = [(not one.weakest.holds, len(one.unknown), -one.weakest.margin) for one in found]
    assert order == sorted(order)
    # the table has all but a wear rate of C95400; of steel neither pressure, pv nor wear
    assert [step.key for step in found[0].unknown] == ["wear"]
    steel = next(one for one in found if one.material.name == "steel case-hardened")
    assert [step.key for step in steel.unknown] == ["pressure_limit", "pv", "wear"]
    assert steel.weakest.margin > found[0].weakest.margin
