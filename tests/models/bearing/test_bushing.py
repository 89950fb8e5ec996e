"""Widths of bushing and seats, and the hardness they rest on. Strand (2005), chapter 2."""

import numpy.testing as npt
import pytest
from scenes.formulas import (
    assert_broadcasts,
    assert_infinity_is_named,
    assert_missing_values_pass,
    evaluate,
)

from erlif.core.errors import ModelError, UnitWarning
from erlif.models.bearing import (
    hardness_from_strength,
    least_bushing_width,
    least_projected_area,
    least_seat_width,
)

WORKED = [  # equation of Strand (2005), value, expected, relative tolerance
    ("5", lambda: least_projected_area(1e5, yield_stress=600e6), 333.33e-6, 2e-5),
    (
        "10",
        lambda: least_bushing_width(1e5, diameter=0.08, hardness=1.2e9, safety=2.0),
        5.305165e-3,
        1e-6,
    ),
    (
        "12",
        lambda: least_seat_width(1e5, diameter=0.08, hardness=1.2e9, safety=2.0),
        2.652582e-3,
        1e-6,
    ),
    ("13", lambda: hardness_from_strength(1e9) / 1e9, 2.941995, 1e-6),
]


@pytest.mark.parametrize(
    ("equation", "call", "expected", "tolerance"), WORKED, ids=[row[0] for row in WORKED]
)
def test_worked_case(equation, call, expected, tolerance):
    npt.assert_allclose(call(), expected, rtol=tolerance)


FORMULAS = {
    least_projected_area: {"load": 1e5, "yield_stress": 600e6},
    least_bushing_width: {"load": 1e5, "diameter": 0.08, "hardness": 1.2e9, "safety": 2.0},
    least_seat_width: {"load": 1e5, "diameter": 0.08, "hardness": 1.2e9, "safety": 2.0},
    hardness_from_strength: {"ultimate_stress": 8e8},
}
EVERY_FORMULA = pytest.mark.parametrize(
    ("formula", "case"), FORMULAS.items(), ids=[formula.__name__ for formula in FORMULAS]
)


@EVERY_FORMULA
def test_scalars_give_floats_and_arrays_broadcast(formula, case):
    assert_broadcasts(formula, case)


@EVERY_FORMULA
def test_infinite_argument_is_refused_by_name(formula, case):
    assert_infinity_is_named(formula, case)


@EVERY_FORMULA
def test_missing_value_gives_a_missing_result(formula, case):
    assert_missing_values_pass(formula, case)


@pytest.mark.parametrize(
    ("formula", "slip", "message"),
    [
        (least_projected_area, {"yield_stress": 600.0}, "yield_stress = 600 Pa"),
        (least_bushing_width, {"hardness": 380.0}, "hardness = 380 Pa .*Brinell"),
        (least_seat_width, {"diameter": 80.0}, "diameter = 80 m"),
        (hardness_from_strength, {"ultimate_stress": 800.0}, "ultimate_stress = 800 Pa"),
    ],
)
def test_slip_of_units_warns(formula, slip, message):
    with pytest.warns(UnitWarning, match=message):
        evaluate(formula, FORMULAS[formula] | slip)


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (
            lambda: least_seat_width(-1.0, diameter=0.08, hardness=1.2e9, safety=2.0),
            "^load must be positive, got -1",
        ),
    ],
)
def test_bad_values_are_named(call, named):
    with pytest.raises(ModelError, match=named):
        call()
