"""Preferred numbers against the table of ISO 3."""

import math

import pytest

from erlif.joint.sizing import round_up


def test_r20_and_r40_hold_the_numbers_of_iso_3():
    """A number of each series between 10 and 100 mm is kept; a little more goes to the next."""
    r20 = [10, 11.2, 12.5, 14, 16, 18, 20, 22.4, 25, 28, 31.5, 35.5, 40, 45, 50, 56, 63, 71, 80, 90]
    for number, following in zip(r20, [*r20[1:], 100], strict=True):
        assert round_up(number * 1e-3, "R20") == pytest.approx(number * 1e-3, rel=1e-12)
        assert round_up(number * 1.0001e-3, "R20") == pytest.approx(following * 1e-3, rel=1e-12)
    assert round_up(95.1e-3, "R40") == 0.1
    assert round_up(33.0e-3, "R40") == 33.5e-3
    assert round_up(0.0085e-3, "R10") == 0.01e-3


def test_numbers_lie_near_the_powers_of_the_root():
    """R40 is 10^(1/40) but for rounding by at most 1.3 %."""
    for n in range(40):
        assert round_up(0.98e-3 * 10 ** (n / 40), "R40") == pytest.approx(
            1e-3 * 10 ** (n / 40), rel=0.013
        )


def test_no_series_and_no_length_stay():
    assert round_up(37.067e-3, "none") == 37.067e-3
    assert round_up(math.inf, "R20") == math.inf
