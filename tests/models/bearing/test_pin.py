"""The pin: shear, bending, holes, and its lateral movement. Strand (2005), chapter 2."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from erlif.models.bearing import (
    hole_stress_concentration,
    lateral_force,
    lateral_shift,
    pin_diameter_in_bending,
    pin_diameter_in_shear,
    pin_diameter_with_hole,
)

CASE = {"yield_stress": 600e6, "safety": 2.0}

WORKED = [  # equation of Strand (2005), value, expected, relative tolerance
    ("1", lambda: pin_diameter_in_shear(1e5, **CASE), 19.17166e-3, 1e-6),
    ("2", lambda: pin_diameter_in_bending(1e5, free_length=0.12, **CASE), 37.06722e-3, 1e-6),
    (
        "21b",
        lambda: lateral_shift(1e5, length=0.18, diameter=0.08, youngs_modulus=206e9),
        9.561e-9,
        1e-4,
    ),
]


@pytest.mark.parametrize(
    ("equation", "call", "expected", "tolerance"), WORKED, ids=[row[0] for row in WORKED]
)
def test_worked_case(equation, call, expected, tolerance):
    npt.assert_allclose(call(), expected, rtol=tolerance)


def test_lubrication_hole_thickens_the_pin_by_40_to_45_percent():
    """Strand (2005), eq. 4, prints 34 to 44 %."""
    x = np.linspace(0, 0.2, 2001)
    plain = pin_diameter_in_bending(1e5, free_length=0.12, **CASE)
    factor = pin_diameter_with_hole(1e5, free_length=0.12, hole_ratio=x, **CASE) / plain
    npt.assert_allclose([factor.min(), factor.max()], [1.3995, 1.4490], atol=5e-5)
    as_printed = (hole_stress_concentration(x) / (1 - 8 * x / (3 * np.pi))) ** (1 / 3)
    npt.assert_allclose([as_printed.min(), as_printed.max()], [1.3424, 1.4422], atol=5e-5)


def test_section_modulus_of_the_drilled_pin():
    """16/(3 pi): second moment of the circle less that of a narrow slot, over the radius."""
    d, hole = 1.0, 1e-3
    circle = quad(lambda y: y**2 * 2 * np.sqrt(d**2 / 4 - y**2), -d / 2, d / 2)[0]
    slot = quad(lambda y: y**2 * hole, -d / 2, d / 2)[0]
    left = (circle - slot) / circle
    npt.assert_allclose(left, 1 - 16 * hole / (3 * np.pi), rtol=1e-9)


@given(st.floats(1e3, 1e6), st.floats(0.02, 0.3), st.floats(1.0, 5.0))
def test_pins_are_just_strong_enough(load, length, safety):
    d = pin_diameter_in_shear(load, yield_stress=600e6, safety=safety)
    shear = load / (2 * np.pi * d**2 / 4)
    npt.assert_allclose(np.sqrt(3) * shear, 600e6 / safety)
    d = pin_diameter_in_bending(load, free_length=length, yield_stress=600e6, safety=safety)
    npt.assert_allclose(load * length / 8 / (np.pi * d**3 / 32), 600e6 / safety)


def test_lateral_force_stretches_the_pin_by_its_shift():  # Strand (2005), eq. 22
    pin = {"length": 0.18, "diameter": 0.08, "youngs_modulus": 206e9}
    strain = lateral_shift(1e5, **pin) / 0.18
    npt.assert_allclose(lateral_force(1e5, **pin), 206e9 * np.pi * 0.08**2 / 4 * strain)
    printed = (
        206e9
        * np.pi
        * 0.08**2
        / 4
        * (1 - np.sqrt(1 - 64 / 9 * (1e5 * 0.18**2 / (206e9 * np.pi * 0.08**4)) ** 2))
    )
    npt.assert_allclose(lateral_force(1e5, **pin), printed, rtol=1e-6)


def test_straight_halves_shorten_by_five_sixths_of_the_bent_line():
    def slope(x):  # of a simply supported pin, F = E I = L = 1, x from an end
        return x**2 / 4 - 1 / 16

    bent = 2 * quad(lambda x: slope(x) ** 2 / 2, 0, 0.5)[0]
    chord = (1 / 48) ** 2 * 2  # two halves of length 1/2 with a rise of 1/48
    npt.assert_allclose(chord / bent, 5 / 6)
    inertia = np.pi * 0.05**4 / 64
    shift = lateral_shift(1e4, length=1.0, diameter=0.05, youngs_modulus=1e6 / inertia)
    npt.assert_allclose(shift, chord * 1e-4, rtol=1e-4)
