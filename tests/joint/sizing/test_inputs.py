"""Numbers of a joint that are refused, and those that are in a wrong unit."""

from dataclasses import fields, replace

import pytest

from erlif.core.errors import ModelError, UnitWarning
from erlif.joint.sizing import Joint, Lock, Material, example_joint, size_joint, walk_guide

JOINT = example_joint()


def numbers(kind):
    return [field.name for field in fields(kind) if "float" in str(field.type)]


@pytest.mark.parametrize("name", numbers(Joint))
def test_what_is_not_a_number_is_named(name):
    for value in (float("nan"), float("inf"), [1.0, 2.0]):
        with pytest.raises(ModelError, match=name):
            replace(JOINT, **{name: value})


@pytest.mark.parametrize(
    ("table", "names", "any_sign"),
    [
        (JOINT, numbers(Joint), {"play"} | {n for n in numbers(Joint) if "temperature" in n}),
        (JOINT.lock, numbers(Lock), set()),
        (JOINT.pin, numbers(Material), {"temperature"}),
    ],
    ids=["joint", "lock", "material"],
)
def test_negative_numbers_are_named_where_they_have_no_meaning(table, names, any_sign):
    for name in names:
        if name in any_sign:
            replace(table, **{name: -1e-3})
            continue
        with pytest.raises(ModelError, match=name):
            replace(table, **{name: -1e-3})


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"force": 1e11}, "force = 1e"),
        ({"half_swing": 30.0}, "half_swing = 30 rad"),
        ({"bushing_width": 100.0}, "bushing_width = 100 m"),
        ({"play": 160.0}, "play = 160 m .* mm or um"),
        ({"pin": replace(JOINT.pin, yield_stress=650.0)}, r"pin\.yield_stress = 650 Pa"),
        ({"pin": replace(JOINT.pin, youngs_modulus=210.0)}, r"pin\.youngs_modulus = 210 Pa"),
        ({"bushing": replace(JOINT.bushing, wear=5e-8)}, r"bushing\.wear = 5e-08 1/Pa"),
        ({"housing": replace(JOINT.housing, expansion=12.0)}, r"housing\.expansion = 12 1/K"),
        ({"lock": replace(JOINT.lock, lever=80.0)}, r"lock\.lever = 80 m"),
    ],
)
def test_a_slip_of_units_is_named(changed, named):
    with pytest.warns(UnitWarning, match=named) as caught:
        size_joint(replace(JOINT, **changed))
    assert caught[0].filename == __file__


def test_strengths_and_loads_are_looked_at_in_a_check_too():
    with pytest.warns(UnitWarning, match=r"seat\.yield_stress = 335 Pa"):
        walk_guide(replace(JOINT, seat=replace(JOINT.seat, yield_stress=335.0)))


def test_the_wanted_eye_lies_within_what_is_recommended():
    with pytest.raises(ModelError, match="eye_ratio must lie in 2 to 4"):
        replace(JOINT, eye_ratio=1.5)
