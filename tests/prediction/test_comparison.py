"""Which physics carries the film, on orbits of the virtual rig and on films of other laws."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes import orbits
from scenes.orbits import CRANK, FRAMES, MOVED, RIG, SPEED, STATED, STEPS, free_orbit, measure

from erlif.models.reynolds import Journal
from erlif.prediction import compare_models, measured_minima

LONG = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
SWEPT = np.abs(np.asarray(RIG.rocker_speed(CRANK[STEPS], crank_speed=SPEED)))
STEADY = {"film_theory": 52e-6 * SWEPT, "film_hamrock_dowson": 1e-6 * SWEPT**0.7}
START = 205e-6, 20e-6


def compare(measured, joint, **options):
    return compare_models(measured, joint, MOVED, **options)


def test_free_pin_is_recognised_by_its_positions():
    found = compare(
        measure(free_orbit(START), 1),
        STATED,
        steady=STEADY,
        sideways=["free", "guided", "any guided"],
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


def test_bound_of_any_guided_pin_is_above_the_fitted_one(guided):
    found = compare(guided, LONG, sideways=["guided", "any guided"])
    names = [one.name for one in found.candidates]
    assert names.index("any guided pin") < names.index("a guided pin")


def test_guided_pin_is_recognised(guided):
    found = compare(guided, LONG, steady=STEADY)
    assert found.candidates[0].name == "a guided pin"
    assert found.candidates[1].bic > 10


def test_steady_film_is_recognised_and_has_any_viscosity():
    film = 3.0 * STEADY["film_theory"]
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    found = compare(measure(orbit, 5), STATED, steady=STEADY, sideways=["free"])
    assert found.candidates[0].name == "the steady film of the regime map"


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
    assert found.verdict.startswith("None of the models describes this film: the best of 5, ")
    assert "times the stated errors" in found.verdict
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


def test_trend_in_the_residuals_reduces_the_evidence():
    """A film of no model: neighbours depart together along the load, and not sideways."""
    film = 20e-6 + 2e-6 * np.sin(np.linspace(0, 6, FRAMES))
    orbit = np.stack([STATED.clearance - film, 0 * film], axis=1)
    found = compare(measure(orbit, 7), STATED, sideways=["free"])
    assert found.independent < 0.6
