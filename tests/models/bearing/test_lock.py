"""The lock plate: screw, weld, prongs and closed end. Strand (2005), chapter 2."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.models.bearing import (
    end_force_of_closed_lock,
    largest_internal_weld_diameter,
    least_closed_end_width,
    least_closed_prong_height,
    least_open_prong_height,
    least_weld_diameter,
    lock_force,
)

CASE = {"yield_stress": 600e6, "safety": 2.0}
LOCK = {**CASE, "thickness": 0.01, "length": 0.03}

WORKED = [  # equation of Strand (2005), value, expected, relative tolerance
    (
        "16",
        lambda: least_weld_diameter(1e5, pin_diameter=0.08, throat=0.003, **CASE),
        70.00501e-3 - 3e-3 * np.sqrt(2),
        1e-6,
    ),
    ("18", lambda: least_open_prong_height(1e4, **LOCK), 24.83743e-3, 1e-6),
    ("19", lambda: end_force_of_closed_lock(1.0), 0.15625, 1e-9),
    (
        "20 as printed",
        lambda: least_closed_prong_height(1e4, **LOCK, root_shear=0.5),
        20.41293e-3,
        1e-6,
    ),
]


@pytest.mark.parametrize(
    ("equation", "call", "expected", "tolerance"), WORKED, ids=[row[0] for row in WORKED]
)
def test_worked_case(equation, call, expected, tolerance):
    npt.assert_allclose(call(), expected, rtol=tolerance)


@given(st.floats(1e2, 1e5), st.floats(0.003, 0.02), st.floats(0.005, 0.1), st.floats(0.1, 1.0))
def test_prongs_just_yield_at_the_root(load, thickness, length, shear):
    def von_mises(height, moment, share):
        bending = 6 * moment * load * length / (thickness * height**2)
        return np.sqrt(bending**2 + 3 * (share * load / (thickness * height)) ** 2)

    plate = {"thickness": thickness, "length": length, **CASE}
    npt.assert_allclose(von_mises(least_open_prong_height(load, **plate), 1, 1), 300e6, rtol=1e-9)
    closed = least_closed_prong_height(load, **plate, root_shear=shear)
    npt.assert_allclose(von_mises(closed, 11 / 16, shear), 300e6, rtol=1e-9)


def test_closed_lock_plate_in_equilibrium():
    """Equal deflection of both prongs: end force 5/32 F at twice the lever, Strand, eq. 19."""
    end = end_force_of_closed_lock(1.0)
    bent_by_load = 1 / 3 + 1 / 2  # deflection at 2L of a cantilever with F at L, in F L^3 / (E I)
    bent_by_end = 2**3 / 3
    npt.assert_allclose(bent_by_load - end * bent_by_end, end * bent_by_end)
    npt.assert_allclose([1 - 2 * end, 1 - end], [11 / 16, 27 / 32])
    width = least_closed_end_width(1e4, thickness=0.01, **CASE)
    npt.assert_allclose(end * 1e4 / (width * 0.01), 300e6)


def test_lock_force_and_weld_carry_the_same_torque():  # Strand (2005), eqs. 15 and 16
    force = lock_force(1e5, diameter=0.08, lever=0.06)
    npt.assert_allclose(force * 0.06, 1e5 * 0.04)
    npt.assert_allclose(
        lock_force(1e5, diameter=0.08, lever=0.06, friction_bushing=0.3, friction_seat=0.1),
        0.2 * force,
    )
    inner = least_weld_diameter(1e5, pin_diameter=0.08, throat=0.003, **CASE)
    # legs of sqrt(2) a, at whose mean radius the shear force acts
    mean_radius = inner / 2 + np.sqrt(2) * 0.003 / 2
    shear = 1e5 * 0.04 / mean_radius / (2 * np.pi * mean_radius * 0.003)
    npt.assert_allclose(np.sqrt(3) * shear, 300e6)
    npt.assert_allclose(
        largest_internal_weld_diameter(0.08, throat=0.003), 0.08 - 0.006 * (1 + np.sqrt(2))
    )
