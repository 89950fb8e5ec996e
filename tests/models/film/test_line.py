"""Films of a line contact against worked examples, solutions and the laws of scaling."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.line_contact import solve_line
from scenes.pin_joint import ACRYLIC, LBF, MAP, RADIUS, thesis_case

from erlif.models.film import (
    BLOK_CONSTANT,
    CENTRAL_OVER_MINIMUM,
    dowson_higginson_film,
    isoviscous_rigid_film,
    line_contact_film,
    squeeze_time,
    thesis_film,
)


@pytest.mark.parametrize(
    ("form", "speed", "load", "micrometre", "alpha"),
    [
        (thesis_film, 0.084, 222.5e3, 0.7007, 1.2345e-8),
        (thesis_film, 0.084, 444.8e3, 0.6404, 1.4585e-8),
        (dowson_higginson_film, 0.042, 222.5e3, 0.6863, 1.2830e-8),
        (dowson_higginson_film, 0.042, 444.8e3, 0.6272, 1.5158e-8),
    ],
)
def test_eq_2_8_as_printed_and_in_the_standard_form(form, speed, load, micrometre, alpha):
    """Farzaneh (2002), eq. 2.8; Dowson and Higginson (1966); alphas of the printed 0.54 um."""
    npt.assert_allclose(form(speed, **thesis_case(load)) * 1e6, micrometre, rtol=1e-4)
    printed = form(speed, **thesis_case(load, pressure_viscosity=alpha))
    npt.assert_allclose(printed, 0.54e-6, rtol=1e-4)


@pytest.mark.parametrize(("modulus", "load", "gE", "gV", "films", "regime"), MAP)
def test_curve_of_moes_against_reynolds_equation(modulus, load, gE, gV, films, regime):
    """Film of the flow within 3 %, minimum within 8 %; the largest asymptote is up to 33 % low."""
    case = thesis_case(load * LBF, contact_modulus=modulus)
    found = line_contact_film(0.0421, **case)
    stiffness = 2 * modulus * RADIUS
    U, W = 0.12 * 0.0421 / stiffness, case["load_per_length"] / stiffness
    solved = solve_line(U, W, 2e-8 * 2 * modulus)
    npt.assert_allclose(found.central / RADIUS, solved.flow, rtol=0.03)
    npt.assert_allclose(found.film / RADIUS, solved.minimum, rtol=0.08)
    assert 0.67 < 1e-6 * max(films) / (RADIUS * solved.minimum) < 1.005


def test_film_of_the_flow_over_the_minimum_of_rigid_cylinders():
    """1 + c*^2 at the exit c* of Martin, and the constants of Moes over Martin's and Blok's."""
    npt.assert_allclose(CENTRAL_OVER_MINIMUM, 1 + martin_constant()[1] ** 2, rtol=1e-6)
    npt.assert_allclose(3.0 / (martin_constant()[0] / 2), CENTRAL_OVER_MINIMUM, rtol=1e-4)
    npt.assert_allclose(1.287 / (BLOK_CONSTANT / 2 ** (2 / 3)), CENTRAL_OVER_MINIMUM, rtol=1e-3)


def test_dowson_higginson_is_67_times_too_small_for_the_optical_joint():
    found = line_contact_film(0.0421, **thesis_case(50 * LBF, contact_modulus=ACRYLIC))
    npt.assert_allclose(found.film / found.piezoviscous_elastic, 67, atol=0.5)
    assert any(
        "Hamrock-Dowson, line contact (2.65)" in note and "does not hold" in note
        for note in found.notes
    )


scale = st.floats(0.1, 10.0)


@pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")  # other units on purpose
@given(scale, scale, scale, st.floats(0.001, 1.0), st.floats(1e2, 1e7))
def test_films_obey_dimensional_analysis(length, mass, time, speed, load):
    """In other units of length, mass and time every film changes as a length."""
    case = thesis_case(1.0, load_per_length=load)
    pressure = mass / (length * time**2)
    scaled = {
        "load_per_length": load * mass / time**2,
        "viscosity": case["viscosity"] * pressure * time,
        "pressure_viscosity": case["pressure_viscosity"] / pressure,
        "radius": case["radius"] * length,
        "contact_modulus": case["contact_modulus"] * pressure,
    }
    before = line_contact_film(speed, **case)
    after = line_contact_film(speed * length / time, **scaled)
    npt.assert_allclose(after.film, before.film * length, rtol=1e-9)
    npt.assert_allclose([after.gE, after.gV], [before.gE, before.gV], rtol=1e-9)


def martin_constant():
    """h/R over U/W of a rigid parabola with Reynolds' exit, from the Reynolds equation."""
    from scipy.integrate import quad
    from scipy.optimize import brentq

    def gradient(x, exit_):  # of p sqrt(...) in units in which h = 1 + x^2
        return (x**2 - exit_**2) / (1 + x**2) ** 3

    def pressure(exit_):
        return quad(gradient, -np.inf, exit_, args=(exit_,), epsabs=1e-13)[0]

    exit_ = brentq(pressure, 0.3, 0.7)
    # integration by parts: the load is minus the moment of the gradient
    load = -quad(lambda x: x * gradient(x, exit_), -np.inf, exit_, epsabs=1e-13)[0]
    # p' = 12 eta u (h - h_exit) / h^3 in x = sqrt(2 R h0) X gives q = 24 eta u (R / h0) * load
    return 24 * load, exit_


def test_the_constant_of_martin():
    constant, exit_ = martin_constant()
    npt.assert_allclose(exit_, 0.475129920, atol=1e-7)
    film = isoviscous_rigid_film(1.0, load_per_length=1.0, viscosity=1.0, radius=1.0)
    npt.assert_allclose(film, constant, rtol=1e-6)


def test_squeeze_time_solves_reynolds_equation():
    """Parabolic pressure p = 6 eta v (b^2 - x^2) / h^3 between parallel plates that close at v."""
    from scipy.integrate import quad, solve_ivp

    b, load, viscosity = 0.01, 2e4, 0.1

    def closing(_, h):
        per_speed = quad(lambda x: 6 * viscosity * (b**2 - x**2) / h[0] ** 3, -b, b)[0]
        return [-load / per_speed]

    # from 1 mm, which takes 1e-4 of the time that 10 um takes
    end = squeeze_time(1e-5, half_width=b, load_per_length=load, viscosity=viscosity)
    start = squeeze_time(1e-3, half_width=b, load_per_length=load, viscosity=viscosity)
    film = solve_ivp(closing, (start, end), [1e-3], rtol=1e-9, atol=1e-14, method="LSODA").y[0, -1]
    npt.assert_allclose(film, 1e-5, rtol=1e-5)
