"""Ball on a disc in each of the four regimes, against Reynolds' equation and the half-space."""

import functools

import pytest
import xarray as xr
from oracles.point_contact import rigid_film, solve_point

from erlif.trend import LubricatedContact, Solid, predict_film

RADIUS = 0.01

# U, W, G and the modulus E' in Pa of a ball of 10 mm; the third that of rubber
GROUPS = {
    "isoviscous-rigid": (1e-12, 1e-9, 4500.0, 2.3e11),
    "piezoviscous-rigid": (1e-12, 1e-9, 1e7, 1e13),
    "isoviscous-elastic": (5e-9, 5e-5, 1e-3, 1e7),
    "piezoviscous-elastic": (5e-11, 2e-7, 2310.0, 2.3e11),
}


@functools.cache
def solved(regime):
    """Minimum and central film over Rx."""
    U, W, G, _ = GROUPS[regime]
    if regime.endswith("elastic"):
        return solve_point(U, W, G, cells=(36, 14))
    gV = G * W**3 / U**2
    if regime == "isoviscous-rigid":
        near, film = rigid_film(1.0, 0.00324, cells=120, far=300.0)
        assert abs(near - gV) < 0.1
        film *= (U / W) ** 2
    else:
        # beyond the load at which the pressure is unbounded the film depends on it no more
        limit, film = rigid_film(1.0, 1 - 1e-9, cells=120)
        assert gV > limit
        film *= (G * U / limit) ** (2 / 3)
    return film, film


# film of the formula over the solution: minimum, centre
@pytest.mark.parametrize(
    ("regime", "minimum", "central"),
    [
        ("isoviscous-rigid", (0.98, 1.01), (0.98, 1.01)),
        # the coefficient of the source is low for a ball, docs/theory/film.md
        ("piezoviscous-rigid", (0.72, 0.76), (0.72, 0.76)),
        ("isoviscous-elastic", (0.95, 1.05), (1.05, 1.20)),
        ("piezoviscous-elastic", (0.80, 0.95), (0.95, 1.10)),
    ],
)
def test_ball_on_a_disc(regime, minimum, central):
    U, W, G, modulus = GROUPS[regime]
    speed = 0.2  # the oil is entrained at half of it
    ball = LubricatedContact(
        radius=RADIUS,
        radius_across=RADIUS,
        length=None,
        body=Solid(modulus, 0.0),
        counterbody=Solid(modulus, 0.0),
        viscosity=U * modulus * RADIUS / (speed / 2),
        pressure_viscosity=G / modulus,
    )
    load = W * modulus * RADIUS**2
    at = {"sliding_speed": ("trigger", [speed]), "joint_load": ("trigger", [load])}
    found = predict_film(xr.Dataset(at), ball)
    assert found.film_regime.values.tolist() == [regime]
    assert found.film_theory.attrs["regime"] == regime
    low, high = minimum
    assert low < found.film_theory.item() / (1e6 * RADIUS * solved(regime)[0]) < high
    low, high = central
    assert low < found.film_theory_central.item() / (1e6 * RADIUS * solved(regime)[1]) < high
    assert found.film_hamrock_dowson.attrs["long_name"] == "Hamrock-Dowson, elliptical"
