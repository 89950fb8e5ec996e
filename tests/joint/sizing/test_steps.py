"""Margins at their limits."""

import math

import pytest

from erlif.core.tables import read_table
from erlif.joint.sizing.assessment import EQUATIONS
from erlif.joint.sizing.steps import Result, make_step, margin_below, margin_between


def test_a_margin_is_zero_at_the_limit_and_that_of_the_nearer_end():
    assert margin_below(300.0, 300.0) == 0
    assert margin_below(math.inf, 300.0) == margin_below(1.0, -5.0) == -1
    assert margin_below(-1.0, 0.0) == math.inf
    assert margin_between(1.4, (0.5, 1.5)) == pytest.approx(1.5 / 1.4 - 1)
    assert margin_between(0.6, (0.5, 1.5)) == pytest.approx(0.2)
    assert margin_between(-0.6, (0.5, 1.5)) == pytest.approx(-2.2)


@pytest.mark.parametrize(
    ("key", "present", "valid", "state"),
    [
        ("pv", 1.0 + 1e-12, True, "holds"),  # but for rounding
        ("pv", 1.1, True, "fails"),
        ("pv", 0.5, False, "holds, not valid"),
        ("slenderness", 1.1, True, "outside"),
        ("pv", math.nan, True, "not computed"),
    ],
)
def test_the_state_of_a_step(key, present, valid, state):
    step = make_step(key, Result(present, most=1.0, valid=valid))
    assert step.state == state
    assert step.governs == (key == "pv" and state != "not computed")
    assert bool(step.missing) == (state == "not computed")
    assert make_step(key, Result(1.0)).state == "result"


def test_each_step_of_the_table_has_an_equation_and_words_for_it():
    table = read_table("erlif.joint.sizing", "steps.toml")
    assert set(table) == set(EQUATIONS)
    words = {"title", "equation", "quantity", "validity", "reason"}
    assert all(words <= {*texts, *table.get(texts.get("like"), ())} for texts in table.values())


@pytest.mark.parametrize(
    ("key", "unit", "kind", "quantity"),
    [
        ("pressure_cosine", "MPa", "comparison", "pressure"),
        ("press_housing", "MPa", "limit", "von Mises stress at the bore of the housing"),
        ("press_bushing", "MPa", "limit", "von Mises stress at the bore of the bushing"),
        ("friction", "kN", "result", "friction force"),
    ],
)
def test_a_step_has_the_words_of_the_one_that_it_is_like_and_a_unit(key, unit, kind, quantity):
    values = dict.fromkeys(("angle", "from_angle", "interference", "stress"), 1.0)
    values |= dict.fromkeys(("low", "high", "friction", "moment", "pressure", "hoop"), 1.0)
    step = make_step(key, Result(0.1, most=1.0, values=values))
    assert (step.unit, step.kind, step.quantity) == (unit, kind, quantity)
