"""Notes of practice."""

from dataclasses import replace

import pytest

from erlif.joint.sizing.design import example_joint
from erlif.joint.sizing.practice import practice_notes, tolerance_grade_7


def notes(*, chosen=(), **changed):
    quiet = {"life": 3600.0, **changed}
    return practice_notes(replace(example_joint(), **quiet), chosen=chosen)


@pytest.mark.parametrize(("low", "high", "table"), [(18, 30, 21), (50, 80, 30), (120, 180, 40)])
def test_the_tolerance_is_that_of_the_table(low, high, table):
    """ISO 286-1, IT7, at the geometric mean of the range."""
    assert tolerance_grade_7((low * high) ** 0.5 * 1e-3) * 1e6 == pytest.approx(table, rel=0.03)


def test_fatigue_is_stated_where_there_are_many_swings():
    assert notes() == ()
    (note,) = notes(life=1e4 * 3600, period=2.0)
    assert "Fatigue is not checked at 1.8e+07 swings" in note


def test_unusual_sizes_have_a_note_with_a_reason():
    assert "ISO 4379" in notes(pin_diameter=2.0)[0]
    assert "3.15 m" in notes(bushing_width=47.0)[0]
    assert "5099 t" in notes(force=50e6)[0]
    (tight,) = notes(pin_diameter=0.036, play=10e-6, interference=0.0)
    assert "10 um is below a tolerance of ISO 286-1, grade 7 (24 um)" in tight
    (thin,) = notes(seat_width=55e-6, chosen=("seat_width",))
    assert "seat width of 0.055 mm" in thin
    assert notes(seat_width=55e-6) == ()
