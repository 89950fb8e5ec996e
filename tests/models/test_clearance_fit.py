"""Friction and stiffness from bushings of several clearances."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.clearance_fit import fit_clearances
from erlif.models.contact import winkler_contact

WALL = {"load_per_length": 4e4, "shaft_radius": 5e-3, "thickness": 3e-3}
CLEARANCE = np.array([200e-6, 100e-6, 50e-6, 25e-6, 15e-6])
ERRORS = {"friction_std": 0.002, "clearance_std": 3e-6}


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


@pytest.mark.parametrize(
    ("scatter", "known"), [(2e-4, None), (2e-3, (1e9, 0.1)), (2e-3, None)], ids=str
)
def test_standard_deviation_covers_the_friction(scatter, known):
    """Errors of torques, clearances and of the load that all bushings share; 150 series.

    The bounds are three standard deviations of a binomial share. The last case leaves a stiff and a
    soft wall open.
    """
    rng = np.random.default_rng(11)
    pulls = []
    size = (150, CLEARANCE.size)
    series = torques(CLEARANCE + 1e-6 * rng.normal(size=size))
    series *= 1 + 0.01 * rng.normal(size=(150, 1))
    series += scatter * rng.normal(size=size)
    for measured in series:
        found = fit_clearances(
            CLEARANCE,
            friction=measured,
            friction_std=scatter,
            clearance_std=1e-6,
            load_std=0.01,
            known_modulus=known,
            **WALL,
        )
        pulls.append((found.friction - 0.12) / found.friction_std)
    for width, share in ((1.0, 0.683), (1.96, 0.95)):
        bound = 3 * np.sqrt(share * (1 - share) / len(pulls))
        assert abs(np.mean(np.abs(pulls) < width) - share) < bound


def test_the_budget_adds_up():
    found = fit_clearances(
        CLEARANCE, friction=torques(CLEARANCE), load_std=0.01, radius_std=0.002, **ERRORS, **WALL
    )
    assert list(found.budget) == ["torque", "clearance", "load", "shaft radius"]
    npt.assert_allclose(
        np.sqrt(np.sum(np.square(list(found.budget.values())))), found.friction_std, rtol=1e-12
    )
    npt.assert_allclose(found.budget["load"], 0.01 * found.friction)
