"""Ball on a disc photographed in each of the four regimes, with films of Reynolds' equation."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from oracles.point_contact import rigid_film, solve_point
from scenes.measured import statistics_of

from conftest import SMALL, Laboratory

# speeds of a slider over pi f s at its four pictures: two, each on both strokes
SPEED = np.round(np.abs(np.cos(2 * np.pi * (np.arange(4) + 0.37) / 4)), 12)
TOP = SPEED.max() * np.pi * 5 * 0.01  # the higher one [m/s]

# U at the higher speed, W, G, the modulus E' in Pa and the radius in m
GROUPS = {
    "isoviscous-rigid": (4.0e-13, 5.5e-10, 300.0, 2e11, 0.06),
    "piezoviscous-rigid": (3e-12, 8e-9, 1e5, 1e12, 0.1),
    "isoviscous-elastic": (5e-9, 3e-5, 0.2, 1e7, 0.02),
    "piezoviscous-elastic": (5e-11, 2e-7, 2310.0, 1.15e11, 0.1),
}


def true_film(regime, U):
    """Minimum and central film over the radius by the solutions of tests/oracles."""
    _, W, G, *_ = GROUPS[regime]
    if regime.endswith("elastic"):
        return solve_point(U, W, G, cells=(36, 14))[:2]
    gV = G * W**3 / U**2
    if regime == "isoviscous-rigid":
        near, film = rigid_film(1.0, 1e-3, cells=100, far=300.0)
        assert gV < near
        return (film * (U / W) ** 2,) * 2
    # beyond the load at which the pressure is unbounded the film depends on it no more
    limit, film = rigid_film(1.0, 1 - 1e-9, cells=100)
    assert gV > limit
    return (film * (G * U / limit) ** (2 / 3),) * 2


@pytest.mark.slow
@pytest.mark.parametrize("regime", GROUPS)
def test_a_ball_of_each_regime_has_its_name_and_its_factor(regime, tmp_path):
    """Minimum and, at the higher speed, central film of the rig are those of the solution.

    Rigid bodies have the gap of undeformed ones, elastic ones a plateau of the radius of Hertz,
    (3 w R/(2 E'))^(1/3).
    """
    U, W, G, modulus, radius = GROUPS[regime]
    speeds, place = np.unique(SPEED, return_inverse=True)
    films = np.array([true_film(regime, U * one / SPEED.max()) for one in speeds])
    true = 1e6 * radius * films[place, 0]
    over = films[-1, 1] / films[-1, 0]
    hertz = 1e3 * radius * (1.5 * W) ** (1 / 3)
    elastic = regime.endswith("elastic")
    pixels = 50 if G < 1 else 32  # of that radius: a light contact is wider
    shown = {"width": 256, "height": 224, "field_width": 256 / pixels * hertz, "marks": 0.02}
    shown |= {"plateau": (hertz, over)}
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
        **(shown if elastic else {"field_width": 3.0 * (radius / 0.1) ** 0.5}),
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
    lab = Laboratory.simulated(tmp_path, seed=8, rig=rig)
    film = statistics_of(lab.copy_run("theory", add=contact), theory=True)
    assert set(film.film_regime.values) == {regime}
    assert film.attrs["contact"] == ("plateau" if elastic else "point")

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

    # so is the central film
    centre, central = film.film_central_over_theory.attrs, over * true
    of_film = np.hypot(centre["factor_std_random"], centre["factor_std_shared"])
    exact = np.median(central / film.film_theory_central.values)
    assert abs(centre["factor"] - exact) < 3 * of_film
    assert abs(centre["factor"] - 1) < 2 * np.hypot(
        of_film, centre["factor"] * centre["formula_error"]
    )
    npt.assert_array_less(np.abs(film.film_central - central), 3 * film.film_central_std)
    formula = film.film_over_hamrock_dowson.attrs
    assert np.isfinite(formula["formula_error"]) == (regime == "piezoviscous-elastic")

    # film by film, and what is new at every trigger: two pairs of one speed, 99.9 %
    npt.assert_array_less(np.abs(film.film_min - true), 3 * film.film_min_std)
    apart = film.film_min.values[:2] - film.film_min.values[2:]
    random = film.film_min_std_random.values.reshape(2, 2)
    assert (apart**2 / (random**2).sum(axis=0)).sum() < 13.8
    assert (random < (0.04 if elastic else 0.02) * true.reshape(2, 2)).all()
