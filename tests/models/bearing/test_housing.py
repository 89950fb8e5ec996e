"""The eye of the housing. Strand (2005), chapter 2."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.models.bearing import (
    least_eyebar_diameter,
)

CASE = {"yield_stress": 600e6, "safety": 2.0}

WORKED = [
    ("14", lambda: least_eyebar_diameter(1e5, bore=0.08, width=0.04, **CASE), 96.97623e-3, 1e-6),
]  # equation of Strand (2005), value, expected, relative tolerance


@pytest.mark.parametrize(
    ("equation", "call", "expected", "tolerance"), WORKED, ids=[row[0] for row in WORKED]
)
def test_worked_case(equation, call, expected, tolerance):
    npt.assert_allclose(call(), expected, rtol=tolerance)


@given(st.floats(1e3, 2e5), st.floats(0.02, 0.1), st.floats(0.01, 0.1))
def test_eye_is_just_strong_enough(load, bore, width):
    if load > 0.95 * 300e6 * width * bore:
        return
    outer = least_eyebar_diameter(load, bore=bore, width=width, **CASE)
    assert outer > bore
    nominal = load / (width * (outer - bore))
    npt.assert_allclose(nominal * (outer / bore + bore / outer), 300e6, rtol=1e-9)


def test_no_eye_carries_an_overload():
    """From sigma_y s d / eta on, 960 kN here; just below it the eye is very large."""
    loads = np.array([0.959e6, 0.96e6, 2e6])
    outer = least_eyebar_diameter(loads, bore=0.08, width=0.04, **CASE)
    assert 50 < outer[0] < 100
    npt.assert_array_equal(outer[1:], np.inf)
    assert least_eyebar_diameter(2e6, bore=0.08, width=0.04, **CASE) == np.inf
