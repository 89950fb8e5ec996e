"""Ball on a disc in each of the four regimes, against Reynolds' equation and the half-space."""

import functools

import numpy as np
import pytest
import xarray as xr
from oracles.point_contact import rigid_film, solve_point

from erlif.models.film import elliptical_contact_film
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
        ("piezoviscous-rigid", (0.99, 1.01), (0.99, 1.01)),
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
    ratio = found.film_theory.item() / (1e6 * RADIUS * solved(regime)[0])
    assert low < ratio < high
    assert abs(ratio - 1) < 2 * found.film_theory.attrs["formula_error"] < 0.3
    low, high = central
    assert low < found.film_theory_central.item() / (1e6 * RADIUS * solved(regime)[1]) < high
    assert found.film_hamrock_dowson.attrs["long_name"] == "Hamrock-Dowson, elliptical"
    own = found.film_hamrock_dowson.attrs["formula_error"]
    known = found.film_theory.attrs["formula_error"]
    assert own == (known if regime == "piezoviscous-elastic" else np.inf)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("U", "W", "G", "regime"),
    [
        (5e-11, 2.07e-7, 5630.0, "piezoviscous-elastic"),  # thinner than that of rigid bodies
        (5e-11, 1.06e-7, 8460.0, "piezoviscous-rigid"),
        (5e-9, 5e-5, 60.0, "isoviscous-elastic"),
        (5e-9, 5e-6, 1e-3, "isoviscous-elastic"),
    ],
)
def test_film_near_a_border_is_within_the_error_of_the_formula(U, W, G, regime):
    modulus, speed = (2.3e11 if G > 100 else 1e8), 0.2
    solid = Solid(modulus, 0.0)
    oil = U * modulus * RADIUS / (speed / 2), G / modulus
    load = W * modulus * RADIUS**2
    at = {"sliding_speed": ("trigger", [speed]), "joint_load": ("trigger", [load])}
    ball = LubricatedContact(RADIUS, RADIUS, None, solid, solid, *oil)
    found = predict_film(xr.Dataset(at), ball)
    assert found.film_theory.attrs["regime"] == regime
    true = 1e6 * RADIUS * solve_point(U, W, G, cells=(30, 12)).minimum
    off = found.film_theory.item() / true - 1
    assert abs(off) < 2 * found.film_theory.attrs["formula_error"] < 0.6


@pytest.mark.filterwarnings("error")
def test_a_contact_at_rest_has_no_error_of_a_formula():
    ball = LubricatedContact(0.01, 0.01, None, Solid(2e11, 0.3), Solid(2e11, 0.3), 0.1, 2e-8)
    at = {"sliding_speed": ("trigger", [0.0]), "joint_load": ("trigger", [5.0])}
    assert np.isnan(predict_film(xr.Dataset(at), ball).film_theory.attrs["formula_error"])


@pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")  # groups alone count
@pytest.mark.parametrize("across", [0.2, 1.0, 10.0])
@pytest.mark.parametrize("share", [1e-3, 0.6, 0.97, 1 - 1e-9])
def test_rigid_film_between_two_regimes_is_within_the_error_of_the_formula(across, share):
    """From constant viscosity to the load at which the reduced pressure is exhausted."""
    gV, number = rigid_film(across, share, cells=80, far=200.0)
    U = 1e-12
    W = (1e-3 * U**2) ** 0.375  # gE
    found = elliptical_contact_film(
        1.0,
        load=2 * W,
        viscosity=2 * U,
        pressure_viscosity=gV * U**2 / W**3 / 2,
        radius_along=1.0,
        radius_across=across,
        contact_modulus=1.0,
    )
    assert found.regime.endswith("rigid")
    off = found.film / (number * (U / W) ** 2) - 1
    assert abs(off) < 2 * found.error
    if share > 0.999:
        assert found.regime == "piezoviscous-rigid"
        assert abs(off) < 0.01
