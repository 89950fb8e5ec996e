"""Margins at their limits."""

import math

import pytest

from erlif.joint.sizing.steps import (
    Result,
    make_step,
    margin_below,
    margin_between,
    table_of_steps,
)
from erlif.joint.sizing.walk import EQUATIONS


def test_a_margin_is_zero_at_the_limit_and_falls_beyond_it():
    assert margin_below(300.0, 300.0) == 0
    assert margin_below(600.0, 300.0) == -0.5
    assert margin_below(math.inf, 300.0) == -1
    assert margin_below(-1.0, 0.0) == math.inf
    assert margin_below(1.0, -5.0) == -1


def test_the_nearer_end_of_a_range_counts():
    assert margin_between(1.4, (0.5, 1.5)) == pytest.approx(1.5 / 1.4 - 1)
    assert margin_between(0.6, (0.5, 1.5)) == pytest.approx(0.2)
    assert margin_between(-0.6, (0.5, 1.5)) == pytest.approx(-2.2)


def test_the_state_of_a_step():
    def state(key, present, **more):
        return make_step(key, Result(present, most=1.0, **more)).state

    assert state("pv", 1.0) == "holds"
    assert state("pv", 1.0 + 1e-12) == "holds"  # rounding
    assert state("pv", 1.1) == "fails"
    assert state("pv", 0.5, valid=False) == "holds, not valid"
    assert state("slenderness", 1.1) == "outside"
    assert make_step("pv", Result(1.0)).state == "result"


def test_a_step_without_its_values_names_them_and_governs_nothing():
    step = make_step("pv", Result())
    assert (step.state, step.holds, step.governs) == ("not computed", True, False)
    assert step.missing == "[motion] half_swing and period"


def test_each_step_of_the_table_has_an_equation_and_words_for_it():
    table = table_of_steps()
    assert set(table) == set(EQUATIONS)
    for key, texts in table.items():
        words = {"title", "equation", "kind", "quantity", "unit", "validity", "reason"}
        assert words <= set(texts), key
