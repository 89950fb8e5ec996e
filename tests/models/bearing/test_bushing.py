"""Widths of bushing and seats, and the hardness they rest on. Strand (2005), chapter 2."""

import numpy.testing as npt
import pytest

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
