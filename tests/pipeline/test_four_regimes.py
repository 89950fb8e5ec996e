"""Ball on a disc photographed in each of the four regimes, with films of Reynolds' equation."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from oracles.point_contact import rigid_film, solve_point

from conftest import SMALL, Laboratory

# speeds of a slider over pi f s at its four pictures: two, each on both strokes
SPEED = np.round(np.abs(np.cos(2 * np.pi * (np.arange(4) + 0.37) / 4)), 12)
TOP = SPEED.max() * np.pi * 5 * 0.01  # the higher one [m/s]

# U at the higher speed, W, G, the modulus E' in Pa and the radius in m
GROUPS = {
    "isoviscous-rigid": (4.0e-13, 5.5e-10, 300.0, 2e11, 0.06),
    "piezoviscous-rigid": (3e-12, 8e-9, 1e5, 1e12, 0.1),
    "isoviscous-elastic": (5e-9, 3e-5, 0.2, 1e7, 0.06),
    "piezoviscous-elastic": (5e-11, 2e-7, 2310.0, 1.15e11, 0.1),
}


def true_film(regime, U):
    """Minimum over the radius by the solutions of tests/oracles."""
    _, W, G, *_ = GROUPS[regime]
    if regime.endswith("elastic"):
        return solve_point(U, W, G, cells=(24, 10) if G < 1 else (30, 12)).minimum
    gV = G * W**3 / U**2
    if regime == "isoviscous-rigid":
        near, film = rigid_film(1.0, 1e-3, cells=100, far=300.0)
        assert gV < near
        return film * (U / W) ** 2
    # beyond the load at which the pressure is unbounded the film depends on it no more
    limit, film = rigid_film(1.0, 1 - 1e-9, cells=100)
    assert gV > limit
    return film * (G * U / limit) ** (2 / 3)


@pytest.mark.slow
@pytest.mark.parametrize("regime", GROUPS)
def test_a_ball_of_each_regime_has_its_name_and_its_factor(regime, tmp_path):
    """The rig takes the gap of undeformed bodies: its minimum is that of the solution, the form of
    the gap is not.
    """
    U, W, G, modulus, radius = GROUPS[regime]
    speeds, place = np.unique(SPEED, return_inverse=True)
    films = [1e6 * radius * true_film(regime, U * one / SPEED.max()) for one in speeds]
    true = np.array(films)[place]
    rig = replace(
        SMALL,
        mechanism="sinusoidal",
        contact="ball",
        ball_radius=1e3 * radius,
        pictures=4,
        load=W * modulus * radius**2,
        load_swing=0.0,
        thin_line=0.1,
        film_table=tuple(true),
        field_width=3.0 * (radius / 0.1) ** 0.5,
    )
    solid = f'youngs_modulus = "{modulus:.9g} Pa", poissons_ratio = 0'
    contact = f"""
[contact]
body = {{ radius = "{radius} m", {solid} }}
counterbody = {{ {solid} }}

[oil]
viscosity = "{U * modulus * radius / (TOP / 2):.9g} Pa s"
pressure_viscosity = "{1e9 * G / modulus:.9g} 1/GPa"
"""
    film = Laboratory.simulated(tmp_path, seed=8, rig=rig).process_copy("theory", add=contact)
    assert set(film.film_regime.values) == {regime}

    # the measured film is that of the solution, and the formula is off by what it states
    found = film.film_over_theory.attrs
    measured = np.hypot(found["factor_std_random"], found["factor_std_shared"])
    exact = np.median(true / film.film_theory.values)
    assert abs(found["factor"] - exact) < 3 * measured
    assert abs(found["factor"] - 1) < 2 * np.hypot(
        measured, found["factor"] * found["formula_error"]
    )
    given = found["viscosity_given"]
    std = np.hypot(found["viscosity_std"], found["viscosity_std_formula"])
    assert abs(found["viscosity"] - given) < 2 * std
    formula = film.film_over_hamrock_dowson.attrs
    assert np.isfinite(formula["formula_error"]) == (regime == "piezoviscous-elastic")

    # film by film, and what is new at every trigger: two pairs of one speed, 99.9 %
    npt.assert_array_less(np.abs(film.film_min - true), 3 * film.film_min_std)
    apart = film.film_min.values[:2] - film.film_min.values[2:]
    random = film.film_min_std_random.values.reshape(2, 2)
    assert (apart**2 / (random**2).sum(axis=0)).sum() < 13.8
    assert (random < 0.02 * true.reshape(2, 2)).all()
