"""Friction and stiffness from bushings of several clearances."""

import numpy as np
import numpy.testing as npt
import pytest

from conftest import FULL
from erlif.joint.models.clearance_fit import fit_clearances
from erlif.models.contact import winkler_contact

WALL = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
CLEARANCE = np.array([200e-6, 100e-6, 50e-6, 25e-6, 15e-6])
ERRORS = {"friction_std": 0.002, "clearance_std": 3e-6}
SIZE = 300 if FULL else 100
"""Number of simulated series."""


def torques(clearance, friction=0.12, modulus=1e9):
    """By the exact integrals of the source, not by those of the thin wall."""
    contact = winkler_contact(
        4e4, shaft_radius=5e-3, bushing_radius=5e-3 + clearance, thickness=3e-3, modulus=modulus
    )
    return friction * contact.torque_ratio


def test_exact_torques_give_friction_and_modulus():
    errors = {"friction_std": 1e-4, "clearance_std": 1e-7}
    found = fit_clearances(CLEARANCE, friction=torques(CLEARANCE), **errors, **WALL)
    npt.assert_allclose(found.friction, 0.12, rtol=2e-3)  # thin against the radius: c/R of 4 %
    npt.assert_allclose(found.modulus, 1e9, rtol=0.05)


def held(scatter, place, known=None, load=0.0, modulus=1e9):
    """Shares of series whose 68 and 95 % intervals hold the friction.

    Errors of torques, clearances and of the load that all bushings share, and of a known modulus.
    """
    rng = np.random.default_rng(11)
    told = CLEARANCE + 4 * max(place - 3e-6, 0.0)  # no error makes an interference
    series = torques(told + place * rng.normal(size=(SIZE, told.size)), modulus=modulus)
    series *= 1 + load * rng.normal(size=(SIZE, 1))
    series += scatter * rng.normal(size=series.shape)
    inside = []
    for measured in series:
        guess = known and (modulus * np.exp(known * rng.normal()), known)
        found = fit_clearances(
            told,
            friction=measured,
            friction_std=scatter,
            clearance_std=place,
            load_std=load,
            known_modulus=guess,
            **WALL,
        )
        low, high = found.friction_interval
        inside.append([abs(found.friction - 0.12) < found.friction_std, low < 0.12 < high])
    return np.mean(inside, axis=0)


SHARES = np.array([0.683, 0.95])
BOUNDS = 3 * np.sqrt(SHARES * (1 - SHARES) / SIZE)  # standard deviations of a binomial share


@pytest.mark.parametrize(
    ("scatter", "place", "known", "load", "modulus"),
    [
        (2e-4, 1e-6, None, 0.01, 1e9),
        (2e-4, 1e-5, None, 0.0, 3e9),
        (2e-3, 1e-5, 0.1, 0.0, 1e9),
    ],
)
def test_intervals_hold_the_friction(scatter, place, known, load, modulus):
    shares = held(scatter, place, known, load, modulus)
    assert np.all(np.abs(shares - SHARES) < BOUNDS)


@pytest.mark.parametrize("place", [1e-6, 1e-5])
def test_intervals_are_not_too_short_where_stiff_and_soft_walls_fit(place):
    assert np.all(held(2e-3, place) > SHARES - BOUNDS)


def test_the_budget_adds_up():
    found = fit_clearances(
        CLEARANCE, friction=torques(CLEARANCE), load_std=0.01, radius_std=0.002, **ERRORS, **WALL
    )
    assert list(found.budget) == ["torque", "clearance", "load", "shaft radius"]
    npt.assert_allclose(
        np.sqrt(np.sum(np.square(list(found.budget.values())))), found.friction_std, rtol=1e-12
    )
    npt.assert_allclose(found.budget["load"], 0.01 * found.friction)
