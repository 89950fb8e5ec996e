"""Margins at their limits."""

import math

import pytest

from erlif.joint.sizing.steps import make_step, margin_below, margin_between, missing_step


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
    def state(kind, present, **more):
        return make_step("a", "b", "c", kind, "d", "MPa", present, most=1.0, **more).state

    assert state("limit", 1.0) == "holds"
    assert state("limit", 1.0 + 1e-12) == "holds"  # rounding
    assert state("limit", 1.1) == "fails"
    assert state("limit", 0.5, valid=False) == "holds, not valid"
    assert state("recommendation", 1.1) == "outside"
    assert make_step("a", "b", "c", "result", "d", "MPa", 1.0).state == "result"


def test_a_step_without_its_values_names_them_and_governs_nothing():
    step = missing_step("pv", "pv", "2.1.13", "limit", "[motion]")
    assert (step.state, step.holds, step.governs) == ("not computed", True, False)
