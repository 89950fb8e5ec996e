"""Notes of practice."""

import math
from dataclasses import replace

import numpy as np
import pytest

from erlif.joint.sizing import round_up, size_joint
from erlif.joint.sizing.design import example_joint
from erlif.joint.sizing.practice import practice_notes, tolerance_grade_7, unchecked


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
    assert "Fatigue is not checked at 1.8e+07 cycles" in note


@pytest.mark.parametrize(
    ("life", "names"), [(9e4, ()), (1.1e5, ("fatigue",)), (None, ("fatigue",))]
)
def test_fatigue_is_unchecked_unless_the_cycles_are_known_to_be_few(life, names):
    assert unchecked(replace(example_joint(), period=1.0, life=life)) == names


def test_a_small_swing_is_named_as_fretting_and_a_large_one_is_not():
    (note,) = notes(half_swing=math.radians(1.5), pin_diameter=0.04)
    assert "Fretting is not checked" in note
    assert "1 mm each way" in note  # 40 mm times 0.0262
    assert notes(half_swing=math.radians(20.0)) == ()


def test_no_seat_is_proposed_that_cannot_be_made():
    """2 kN on a pin of 20 mm would need a seat of less than a tenth of a millimetre."""
    light = replace(example_joint(), force=2e3, pin_diameter=0.02, seat_width=None)
    sized = size_joint(light)
    assert sized.seat_width == pytest.approx(1e-3)
    assert any(
        "least that is made" in note for note in practice_notes(sized, chosen=("seat_width",))
    )


def test_unusual_sizes_have_a_note_with_a_reason():
    assert "ISO 4379" in notes(pin_diameter=2.0)[0]
    assert "3.15 m" in notes(bushing_width=47.0)[0]
    assert "5099 t" in notes(force=50e6)[0]
    (tight,) = notes(pin_diameter=0.036, play=10e-6, interference=0.0)
    assert "10 um is below a tolerance of ISO 286-1, grade 7 (24 um)" in tight
    thin, narrow = notes(seat_width=55e-6, chosen=("seat_width",))
    assert "seat width of 0.055 mm" in thin
    assert "narrower than a quarter" in narrow
    assert notes(seat_width=55e-6) == (narrow,)
    assert notes(seat_width=0.02) == ()  # a quarter of 80 mm


def test_the_series_hold_the_numbers_of_iso_3():
    """A number of each series between 10 and 100 mm is kept; a little more goes to the next.

    R40 is 10^(1/40) but for rounding by at most 1.3 %.
    """
    r20 = [10, 11.2, 12.5, 14, 16, 18, 20, 22.4, 25, 28, 31.5, 35.5, 40, 45, 50, 56, 63, 71, 80, 90]
    for number, following in zip(r20, [*r20[1:], 100], strict=True):
        assert round_up(number * 1e-3, "R20") == pytest.approx(number * 1e-3, rel=1e-12)
        assert round_up(number * 1.0001e-3, "R20") == pytest.approx(following * 1e-3, rel=1e-12)
    assert round_up(95.1e-3, "R40") == 0.1
    assert round_up(33.0e-3, "R40") == 33.5e-3
    assert round_up(0.0085e-3, "R10") == 0.01e-3
    for root in 1e-3 * 10 ** (np.arange(40) / 40):
        assert round_up(0.98 * root, "R40") == pytest.approx(root, rel=0.013)

    assert round_up(37.067e-3, "none") == 37.067e-3
    assert round_up(math.inf, "R20") == math.inf
