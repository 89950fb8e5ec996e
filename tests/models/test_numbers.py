"""Every formula of the models takes floats, lists, arrays and DataArrays, or is listed as other.

A case of each stands in tests/reference/formulas.toml.
"""

import inspect
import tomllib
import warnings
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scenes.formulas import (
    MODULES,
    assert_broadcasts,
    assert_infinity_is_named,
    assert_missing_values_pass,
    evaluate,
    numeric,
    public_names,
)

from erlif.core.errors import ModelError
from erlif.joint.models.reaction import SliderCrankBodies
from erlif.models import fluorescence
from erlif.models.mechanism import CrankRocker, SliderCrank

TABLE = tomllib.loads(
    (Path(__file__).parents[1] / "reference" / "formulas.toml").read_text(encoding="utf-8")
)
SLIPS, OTHERS = TABLE.pop("slips"), TABLE.pop("others")

OBJECTS = {
    "joint_reaction": {
        "linkage": SliderCrank(crank=0.0762, coupler=0.2032, clearance=1e-4),
        "bodies": SliderCrankBodies(
            0.8175, 5.5e-3, 5.5487, 525.4, 68.354, friction=0.15, pin_radius=9.525e-3
        ),
    },
    "coupler_force": {"linkage": CrankRocker(0.055, 0.44, 0.26, 0.51)},
}
"""Arguments that are no numbers."""

CASES = {
    getattr(MODULES[module], name): OBJECTS.get(name, {}) | case
    for module, formulas in TABLE.items()
    for name, case in formulas.items()
}
SIGNED = {formula: case.pop("signed", []) for formula, case in CASES.items()}
"""Arguments that may be negative; the ratios of Poisson may be so too."""

STRAIGHT = dict.fromkeys(["radius_1", "radius_1_across", "radius_2", "radius_2_across"], np.inf)
"""Radii that may be infinite."""


def failing(check):
    """Formulas for which a check fails, with the reason."""
    found = {}
    for formula, case in CASES.items():
        try:
            check(formula, case)
        except (Exception, pytest.fail.Exception) as error:
            found[formula.__name__] = str(error)
    return found


def assert_negative_is_named(formula, case):
    for name in numeric(case):
        if name not in SIGNED[formula] and not name.startswith("poisson"):
            with pytest.raises(ModelError, match=rf"^{name}\b"):
                evaluate(formula, case | {name: -abs(case[name])})


def assert_slip_warns(formula, case):
    if formula.__module__ == fluorescence.__name__:  # in any unit of length
        return
    for name in set(SLIPS) & set(numeric(case)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with suppress(ModelError):
                evaluate(formula, case | {name: SLIPS[name]})
        assert any(str(one.message).startswith(f"{name} = ") for one in caught), name


@pytest.mark.parametrize(
    "check",
    [
        assert_broadcasts,
        assert_missing_values_pass,
        assert_negative_is_named,
        assert_slip_warns,
        partial(assert_infinity_is_named, allowed=STRAIGHT),
    ],
    ids=["arrays", "missing", "negative", "slips", "infinite"],
)
def test_every_formula_takes_and_refuses_alike(check):
    assert not failing(check)


def test_every_public_function_is_tested_with_arrays_or_listed():
    public = {name for name, value in public_names() if inspect.isfunction(value)}
    public = {name for name in public if name.count(".") == 1}
    tested = {f"{module}.{name}" for module, formulas in TABLE.items() for name in formulas}
    assert public - tested == set(OTHERS)
