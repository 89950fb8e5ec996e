"""Pin, bushing, housing, lock plate and fit of Strand (2005), chapter 2."""

import numpy as np
import numpy.testing as npt
from hypothesis import given
from hypothesis import strategies as st

from erlif.joint.models import bearing

CASE = {"yield_stress": 600e6, "safety": 2.0}
LOCK = {**CASE, "thickness": 0.01, "length": 0.03}
SEAT = {"diameter": 0.08, "hardness": 1.2e9, "safety": 2.0}
PIN = {"length": 0.18, "diameter": 0.08, "youngs_modulus": 206e9}
FIT = {
    "bore": 0.07,
    "fit_diameter": 0.08,
    "housing_diameter": 0.16,
    "youngs_housing": 206e9,
    "poisson_housing": 0.3,
}
STEEL = {"youngs_bushing": 206e9, "poisson_bushing": 0.3}
BRONZE = {"youngs_bushing": 110e9, "poisson_bushing": 0.34}
WELD = {"pin_diameter": 0.08, "throat": 0.003, **CASE}
WELD_INNER = 70.00501e-3 - 3e-3 * np.sqrt(2)

WORKED = {  # equation of Strand (2005): function, first argument, others, value by hand
    "1": (bearing.pin_diameter_in_shear, 1e5, CASE, 19.17166e-3),
    "2": (bearing.pin_diameter_in_bending, 1e5, CASE | {"free_length": 0.12}, 37.06722e-3),
    "5": (bearing.least_projected_area, 1e5, {"yield_stress": 600e6}, 1e-3 / 3),
    "10": (bearing.least_bushing_width, 1e5, SEAT, 5.305165e-3),
    "12": (bearing.least_seat_width, 1e5, SEAT, 2.652582e-3),
    "13": (bearing.hardness_from_strength, 1e9, {}, 2.941995e9),
    "14": (bearing.least_eyebar_diameter, 1e5, CASE | {"bore": 0.08, "width": 0.04}, 96.97623e-3),
    "15": (bearing.lock_force, 1e5, {"diameter": 0.08, "lever": 0.06}, 66.66667e3),
    "16": (bearing.least_weld_diameter, 1e5, WELD, WELD_INNER),
    "17": (bearing.largest_internal_weld_diameter, 0.08, {"throat": 0.003}, 65.51472e-3),
    "18": (bearing.least_open_prong_height, 1e4, LOCK, 24.83743e-3),
    "19": (bearing.end_force_of_closed_lock, 1.0, {}, 0.15625),
    # h^2 = (s + sqrt(s^2 + 4 a b^2)) / 2a with b = 6 x 11/16 x 30e3, s = 3 x (27/32 x 1e3)^2
    # and a = 300^2, in N and mm
    "20": (bearing.least_closed_prong_height, 1e4, LOCK, 20.60427e-3),
    "21a": (bearing.least_closed_end_width, 1e4, {**CASE, "thickness": 0.01}, 0.5208333e-3),
    "21b": (bearing.lateral_shift, 1e5, PIN, 9.561277e-9),
    "23": (bearing.relative_play, 0.06672, {"bore": 0.06718}, 6.894484e-3),
    "24": (bearing.press_fit_displacement, 60e-6, FIT | STEEL, -24.34783e-6),
    "25": (bearing.press_fit_displacement, 60e-6, FIT | BRONZE, -27.17294e-6),
}


def test_worked_cases():
    found = {name: function(first, **rest) for name, (function, first, rest, _) in WORKED.items()}
    npt.assert_allclose(list(found.values()), [row[-1] for row in WORKED.values()], rtol=1e-6)


def test_lubrication_hole_thickens_the_pin_by_40_to_45_percent():
    """Strand (2005), eq. 4, prints 34 to 44 %."""
    x = np.linspace(0, 0.2, 2001)
    pin = {"free_length": 0.12, **CASE}
    plain = bearing.pin_diameter_in_bending(1e5, **pin)
    factor = bearing.pin_diameter_with_hole(1e5, hole_ratio=x, **pin) / plain
    npt.assert_allclose([factor.min(), factor.max()], [1.3995, 1.4490], atol=5e-5)
    as_printed = (bearing.hole_stress_concentration(x) / (1 - 8 * x / (3 * np.pi))) ** (1 / 3)
    npt.assert_allclose([as_printed.min(), as_printed.max()], [1.3424, 1.4422], atol=5e-5)


def test_lateral_force_stretches_the_pin_by_its_shift():
    """Strand (2005), eq. 22."""
    strain = bearing.lateral_shift(1e5, **PIN) / 0.18
    area = np.pi * 0.08**2 / 4
    npt.assert_allclose(bearing.lateral_force(1e5, **PIN), 206e9 * area * strain)
    slope = 8 / 3 * 1e5 * 0.18**2 / (206e9 * np.pi * 0.08**4)
    printed = 206e9 * area * (1 - np.sqrt(1 - slope**2))
    npt.assert_allclose(bearing.lateral_force(1e5, **PIN), printed, rtol=1e-6)


@given(st.floats(1e3, 2e5), st.floats(0.02, 0.1), st.floats(0.01, 0.1))
def test_eye_is_just_strong_enough(load, bore, width):
    if load > 0.95 * 300e6 * width * bore:
        return
    outer = bearing.least_eyebar_diameter(load, bore=bore, width=width, **CASE)
    nominal = load / (width * (outer - bore))
    npt.assert_allclose(nominal * (outer / bore + bore / outer), 300e6, rtol=1e-9)


def test_no_eye_carries_an_overload():
    """From sigma_y s d / eta on, 960 kN here; just below it the eye is very large."""
    loads = np.array([0.959e6, 0.96e6, 2e6])
    outer = bearing.least_eyebar_diameter(loads, bore=0.08, width=0.04, **CASE)
    assert 50 < outer[0] < 100
    npt.assert_array_equal(outer[1:], np.inf)


@given(st.floats(1e2, 1e5), st.floats(0.003, 0.02), st.floats(0.005, 0.1))
def test_prongs_just_yield_at_the_root(load, thickness, length):
    def von_mises(height, moment, share):
        bending = 6 * moment * load * length / (thickness * height**2)
        return np.sqrt(bending**2 + 3 * (share * load / (thickness * height)) ** 2)

    plate = {"thickness": thickness, "length": length, **CASE}
    opened = bearing.least_open_prong_height(load, **plate)
    npt.assert_allclose(von_mises(opened, 1, 1), 300e6, rtol=1e-9)
    closed = bearing.least_closed_prong_height(load, **plate)
    npt.assert_allclose(von_mises(closed, 11 / 16, 27 / 32), 300e6, rtol=1e-9)
