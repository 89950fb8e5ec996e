"""Play and press fit. Strand (2005), chapter 2."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from erlif.models.bearing import (
    press_fit_displacement,
    relative_play,
)

FIT = {
    "bore": 0.07,
    "fit_diameter": 0.08,
    "housing_diameter": 0.16,
    "youngs_housing": 206e9,
    "poisson_housing": 0.3,
}
STEEL = {"youngs_bushing": 206e9, "poisson_bushing": 0.3}
BRONZE = {"youngs_bushing": 110e9, "poisson_bushing": 0.34}

WORKED = [  # equation of Strand (2005), value, expected, relative tolerance
    ("24", lambda: press_fit_displacement(60e-6, **FIT, **STEEL), -24.34783e-6, 1e-6),
    ("25", lambda: press_fit_displacement(60e-6, **FIT, **BRONZE), -27.17294e-6, 1e-6),
    ("23 of the thesis rig", lambda: 1e3 * relative_play(0.06672, bore=0.06718), 6.894, 1e-3),
]


@pytest.mark.parametrize(
    ("equation", "call", "expected", "tolerance"), WORKED, ids=[row[0] for row in WORKED]
)
def test_worked_case(equation, call, expected, tolerance):
    npt.assert_allclose(call(), expected, rtol=tolerance)


def lame(rings, interference):
    """Radial displacement of the innermost surface of two rings, from u = A r + B / r."""
    (a, b, E1, nu1), (_, c, E2, nu2) = rings

    def stress(r, E, nu):  # coefficients of A and B in the radial stress, plane stress
        return [E / (1 - nu), -E / ((1 + nu) * r**2)]

    matrix = [
        [*stress(a, E1, nu1), 0, 0],
        [0, 0, *stress(c, E2, nu2)],
        [*stress(b, E1, nu1), *[-x for x in stress(b, E2, nu2)]],
        [-b, -1 / b, b, 1 / b],
    ]
    A, B, _, _ = np.linalg.solve(np.array(matrix), [0, 0, 0, interference])
    return A * a + B / a


@given(st.floats(0.5, 0.95), st.floats(1.1, 5.0), st.floats(50e9, 220e9), st.floats(0.2, 0.4))
def test_press_fit_is_lames(bore_ratio, housing_ratio, youngs, poisson):
    """Strand (2005), eqs. 24 and 25."""
    found = press_fit_displacement(
        60e-6,
        bore=0.08 * bore_ratio,
        fit_diameter=0.08,
        housing_diameter=0.08 * housing_ratio,
        youngs_bushing=youngs,
        poisson_bushing=poisson,
        youngs_housing=206e9,
        poisson_housing=0.3,
    )
    rings = ((0.04 * bore_ratio, 0.04, youngs, poisson), (0.04, 0.04 * housing_ratio, 206e9, 0.3))
    npt.assert_allclose(found, lame(rings, 30e-6), rtol=1e-6)


def test_press_fit_of_one_material_is_eq_24():
    db, D, Dh, fit = 0.07, 0.08, 0.16, 60e-6
    eq_24 = -fit / 2 * db / D * (D**2 - Dh**2) / (db**2 - Dh**2)
    npt.assert_allclose(press_fit_displacement(fit, **FIT, **STEEL), eq_24)
