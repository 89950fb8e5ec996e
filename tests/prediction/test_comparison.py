"""Which physics carries the film, on orbits of the virtual rig and on films of other laws."""

import re
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes import orbits
from scenes.orbits import (
    CRANK,
    FRAMES,
    MOVED,
    RIG,
    SPEED,
    STATED,
    STD,
    STEPS,
    free_orbit,
    measure,
)

from erlif.core.errors import ConfigError
from erlif.models.reynolds import Journal
from erlif.prediction import (
    MeasuredMotion,
    SteadyFilm,
    compare_films,
    compare_models,
    fit_motion,
    measured_minima,
)

LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
SPEEDS = np.asarray(RIG.rocker_speed(CRANK[STEPS], crank_speed=SPEED))
SWEPT = np.abs(SPEEDS)
MAP = SteadyFilm("the steady film of the regime map", 52e-6 * SWEPT, power=1.0)
FORMULA = SteadyFilm("Hamrock-Dowson, line contact (2.65)", 1e-6 * SWEPT**0.7, power=0.7)
STEADY = (MAP, FORMULA)
START = 205e-6, 20e-6


def compare(measured, joint, **options):
    return compare_models(measured, joint, MOVED, **options)


def test_free_pin_is_recognised_by_its_positions():
    found = compare(
        measure(free_orbit(START), 1),
        STATED,
        steady=STEADY,
        sideways=["free"],
    )
    assert found.candidates[0].name == "a pin that is free sideways"
    assert found.candidates[1].bic > 10
    assert found.verdict.startswith("Squeeze carries the film of a pin that is free sideways")
    assert "very strong" in found.verdict
    assert found.fit.sideways == "free"


def test_free_pin_is_recognised_by_its_minima():
    film = STATED.clearance - np.hypot(*free_orbit(START).T)
    noisy = film + np.random.default_rng(3).normal(0, 5e-9, FRAMES)
    measured = measured_minima(noisy, np.full(FRAMES, 5e-9), clearance=STATED.clearance)
    found = compare(measured, STATED, steady=STEADY)
    names = [one.name for one in found.candidates]
    assert names.index("a pin that is free sideways") < names.index("a guided pin")


@pytest.fixture(scope="module")
def guided():
    return measure(orbits.held_orbit(), 4)


def test_a_guided_pin_is_left_to_fit_where_the_pin_stays_on_one_line(guided):
    found = compare(guided, LONG, sideways=["any guided"])
    assert found.carrier is None
    assert found.verdict.startswith("No model fits: the best, ")
    assert "a guided pin is left to fit. " in found.verdict
    assert "erlif predict FILM --fit" in found.verdict
    swinging = measure(free_orbit(START), 1)
    assert "guided" not in compare(swinging, LONG, sideways=["any guided"]).verdict


def test_guided_pin_whose_line_is_unknown_is_at_least_as_likely_as_one_whose_line_is_known(guided):
    fits = [
        fit_motion(guided, LONG, MOVED, sideways="guided", load_line_std=std, profiles=False)
        for std in (0.0, 5e-3)
    ]
    known, unknown = (one.minimum.log_likelihood for one in fits)
    assert unknown > known - 0.1


def test_guided_pin_is_recognised(guided):
    found = compare(guided, LONG, steady=STEADY)
    assert found.candidates[0].name == "a guided pin"
    assert found.candidates[1].bic > 10


def test_steady_film_is_recognised_and_has_any_viscosity():
    film = 3.0 * MAP.film
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    found = compare(measure(orbit, 5), STATED, steady=STEADY, sideways=["free"])
    assert found.candidates[0].name == "the steady film of the regime map"
    assert found.carrier is None
    factor, viscosity = (found.candidates[0].estimates[n] for n in ("factor", "viscosity"))
    assert abs(factor.value - 3.0) < 3 * factor.std
    npt.assert_allclose(viscosity.value, 0.12 * factor.value, rtol=1e-12)  # h over eta u
    assert "the viscosity not: " in found.verdict
    assert f": {factor} times it" in found.verdict


def test_the_error_of_a_steady_formula_is_part_of_its_viscosity():
    """1.8 times the film is no other oil where the formula is known to a third, h over eta u."""
    film = 1.8 * MAP.film
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    given = {"sideways": ["free"], "viscosity_std": 0.012}
    exact, known = (
        compare(measure(orbit, 5), STATED, steady=[replace(MAP, error=error), FORMULA], **given)
        for error in (0.0, 0.33)
    )
    assert (exact.carrier, known.carrier) == (None, "the steady film of the regime map")
    viscosity = known.candidates[0].estimates["viscosity"]
    npt.assert_allclose(viscosity.parts["formula"], 0.33 * viscosity.value, rtol=1e-12)


def walking(rng):
    return 210e-6 + 50e-9 * np.cumsum(rng.normal(size=FRAMES))


def rising(rng):
    """Under a load that a film can but sink under."""
    return 215e-6 - np.linspace(0.0, 2e-6, FRAMES)


def sprung(rng):
    """As a pin that hangs on a spring in no oil."""
    return 210e-6 + 2e-6 * np.sin(CRANK[STEPS])


@pytest.mark.parametrize("course", [walking, rising, sprung])
def test_a_film_of_no_model_is_not_named_after_the_best_of_them(course):
    rng = np.random.default_rng(6)
    orbit = np.stack([course(rng), 0 * STEPS], axis=1)
    found = compare(measure(orbit, 6), STATED, steady=STEADY, sideways=["free"])
    assert found.carrier is None
    assert re.match(
        r"No model fits: the best, .+, is off by \d.* times its errors\.", found.verdict
    )
    assert "strong" not in found.verdict


@pytest.mark.parametrize("known", ["positions", "minima"])
def test_a_film_at_rest_is_of_any_model_that_holds_still(known):
    """Squeeze of an infinite viscosity, a guided pin in it, a steady film: nothing decides."""
    measured = measure(np.full((FRAMES, 2), [215e-6, 1e-6]), 7)
    if known == "minima":
        std = np.full(FRAMES, 5e-9)
        film = STATED.clearance - measured.value[:, 0]
        measured = measured_minima(film, std, clearance=STATED.clearance, std_shared=std)
    found = compare(measured, STATED, steady=STEADY, sideways=["free"])
    assert found.carrier is None
    assert found.verdict.startswith("The film is constant within its errors")


def test_squeeze_lets_no_film_rise():
    """Of films that rise the closed form has the one at rest, of an infinite viscosity."""
    orbit = np.stack([rising(None), 0 * STEPS], axis=1)
    found = compare(measure(orbit, 6), STATED, sideways=["free"])
    residual = {one.name: one.residual for one in found.candidates}
    npt.assert_allclose(residual["squeeze in closed form"], residual["a constant gap"], rtol=1e-3)


def test_power_law_of_the_speed_is_told_from_the_formulas():
    """Of 4 um + 8 um (v/top)^0.4; the prefactor and the exponent of no formula."""
    film = 4e-6 + 8e-6 * (SWEPT / SWEPT.max()) ** 0.4
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    found = compare(measure(orbit, 5), STATED, steady=STEADY, drive=SPEEDS, sideways=["free"])
    assert found.carrier is None
    assert found.verdict.startswith("The film follows speed over load to the power 0.")
    power, offset = (found.candidates[0].estimates[name] for name in ("power", "offset"))
    assert abs(power.value - 0.4) < 3 * power.std < 0.02
    assert abs(offset.value - 4e-6) < 3 * offset.std < 0.2e-6


def test_neighbours_that_depart_together_widen_the_errors():
    """A first-order correlation of 0.8: (1 + 0.8)/(1 - 0.8) = 9 values are as good as one."""
    rng, noise = np.random.default_rng(8), np.zeros((FRAMES, 2))
    for k in range(FRAMES):
        noise[k] = 0.8 * noise[k - 1] + 0.6 * rng.normal(size=2)
    film = 8e-6 + 4e-6 * SWEPT / SWEPT.max()
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    cov = np.diag(STD**2) * np.ones((FRAMES, 1, 1))
    stds = [
        compare(
            MeasuredMotion(orbit + STD * one, cov, np.zeros((FRAMES, 2, 0))),
            STATED,
            steady=[replace(MAP, film=film)],
            sideways=["free"],
        )
        .candidates[0]
        .estimates["factor"]
        .std
        for one in (noise, rng.normal(size=(FRAMES, 2)))
    ]
    assert 2 < stds[0] / stds[1] < 4.5


def test_viscosity_that_falls_within_the_run_is_fitted():
    """By 12 % over two cycles, which no number of the run states."""
    last = MOVED.motion.time[-1]
    orbit = free_orbit(START, thicker=lambda time: np.exp(-0.12 * (max(time, 0.0) / last - 0.5)))
    found = compare(measure(orbit, 1), STATED, sideways=["free"])
    drift, viscosity = (found.candidates[0].estimates[name] for name in ("drift", "viscosity"))
    assert abs(drift.value + 0.12) < 3 * drift.std < 0.03
    assert abs(viscosity.value - orbits.VISCOSITY) < 3 * viscosity.std
    assert f"The viscosity changes by {drift.times(100, '%')} within the run." in found.verdict


def test_a_formula_outside_its_regime_gives_a_shape_and_no_viscosity():
    film = 1.8 * FORMULA.film
    found = compare(
        measure(np.stack([STATED.clearance - film, 0 * film], axis=1), 5),
        STATED,
        steady=[MAP, replace(FORMULA, error=np.inf)],
        sideways=["free"],
    )
    assert found.carrier is None
    assert set(found.candidates[0].estimates) == {"factor"}
    shape = "The shape is that of Hamrock-Dowson, line contact (2.65) (very strong), outside its"
    assert found.verdict.startswith(f"{shape} regime: 1.8")


SLIDER = np.abs(np.cos(np.linspace(0.0, 2 * np.pi, 60) + 0.05)) + 0.1
SAW = (7 * np.arange(60) / 60) % 1
CONTACTS = {
    "The film follows Hamrock-Dowson, ": (1.05 * SLIDER**0.68, "factor", 1.05),
    "The shape is that of Hamrock-Dowson, elliptical, the visc": (5 * SLIDER**0.68, "factor", 5.0),
    "The film follows speed over load to the power 0.": (2 * SLIDER**0.4, "power", 0.4),
    "The film is constant within its errors": (np.full(60, 3.0), None, None),
    "No model fits: ": (3 + SAW, None, None),
}


@pytest.mark.parametrize("begins", CONTACTS)
def test_what_carries_the_film_of_a_contact_without_a_pin(begins):
    """Films of 0.1 to 5 um with noise, a scale error of 0.5 % and a shift that all share."""
    film, name, truth = CONTACTS[begins]
    pulls = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        shared = np.stack([0.005 * film, np.full(60, 0.02)], axis=1)
        seen = film + shared @ rng.normal(size=2) + 0.01 * rng.normal(size=60)
        found = compare_films(
            1e-6 * seen,
            np.full(60, 1e-8),
            1e-6 * shared,
            viscosity=0.1,
            steady=[
                SteadyFilm("Hamrock-Dowson, elliptical", 1e-6 * SLIDER**0.68, power=0.68),
                SteadyFilm("the map", 2e-6 * SLIDER, power=1.0),
            ],
            drive=SLIDER,
        )
        assert found.verdict.startswith(begins)
        assert "squeeze" not in {one.name for one in found.candidates}
        if name:
            best = found.candidates[0].estimates
            pulls.append((best[name].value - truth) / best[name].std)
            if name == "factor":  # of a film in proportion to viscosity^0.68
                expected = 0.1 * best[name].value ** (1 / 0.68)
                npt.assert_allclose(best["viscosity"].value, expected, rtol=1e-6)
    assert all(abs(one) < 3 for one in pulls)


def test_three_minima_are_too_few_for_a_comparison():
    film = np.where(np.arange(60) < 3, 1e-6 * SLIDER, np.nan)
    with pytest.raises(
        ConfigError, match="Expected 4 or more minimum films for a comparison, got 3 of 60"
    ):
        compare_films(film, np.full(60, 1e-8), np.zeros(60), viscosity=0.1)
