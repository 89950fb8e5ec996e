"""Derivatives of the weakest margin against finite changes, and other bushings."""

import pytest
from scenes.joints import altered, assessed

from erlif.joint.sizing import read_materials, sensitivities, substitutes
from erlif.joint.sizing.design import example_joint


def changes(joint):
    assessment = assessed(joint)
    return assessment.weakest, {one.name: one.change for one in sensitivities(assessment)}


def test_a_stress_in_bending_changes_by_the_powers_of_its_equation():
    """Eq. 2: allowed over present value is sigma_y d^3 / (F L eta)."""
    weakest, by_name = changes(altered(lock=None, pin_diameter=0.025, lateral_play=0.0, wall=0.02))
    assert weakest.key == "pin_bending"
    powers = {
        "load": -1,
        "safety factor": -1,
        "bushing width": -1,
        "pin diameter": 3,
        "yield stress of the pin": 1,
    }
    expected = {name: 0.01 * n * (1 + weakest.margin) for name, n in powers.items()}
    assert by_name == pytest.approx(expected, rel=1e-6)


def test_a_temperature_is_changed_by_1_kelvin():
    weakest, by_name = changes(altered(outside_temperature=119.9))
    assert weakest.key == "temperature"
    # (120 - T) / rise - 1, with a rise of 0.7292 K
    assert by_name["temperature outside"] == pytest.approx(-1 / 0.7292, rel=1e-3)
    assert by_name["temperature of the grease"] == pytest.approx(1 / 0.7292, rel=1e-3)


def test_an_incompressible_bushing_has_sensitivities_and_a_joint_without_limits_none():
    assert "load" in changes(altered(bushing={"poissons_ratio": 0.5}))[1]
    unknown = ("yield_stress", "ultimate_stress", "hardness_low", "hardness_high", "youngs_modulus")
    bare = altered(example_joint().pin, **dict.fromkeys(unknown))
    nothing = dict.fromkeys(("pin", "bushing", "seat", "housing"), bare)
    assert changes(altered(**nothing, lock=None, period=None)) == (None, {})


def test_of_other_bushings_the_best_known_come_first():
    materials = read_materials()
    ranked = substitutes(example_joint(), materials.values())
    names = {one.name for one in materials.values() if one.use == "bushing"} - {"CuAl10Ni5Fe4"}
    assert {one.material.name for one in ranked} == names

    # those that hold, then the number of limits that are not known, then the margin
    order = [(not one.weakest.holds, len(one.unknown), -one.weakest.margin) for one in ranked]
    assert order == sorted(order)
    # the table has all but a wear rate of C95400; of steel neither pressure, pv nor wear
    assert [step.key for step in ranked[0].unknown] == ["wear"]
    steel = next(one for one in ranked if one.material.name == "steel case-hardened")
    assert [step.key for step in steel.unknown] == ["pressure_limit", "pv", "wear"]
    assert steel.weakest.margin > ranked[0].weakest.margin
