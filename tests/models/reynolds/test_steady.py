"""Steady journal bearings against published tables."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.reynolds import Groove, Journal, steady_journal

SPEED = 100.0  # rad/s


def bearing(slenderness, **changes):
    """A bearing of unit proportions; slenderness is length over diameter, None for infinite."""
    values = {"length": 0.1 * (slenderness or 1.0), "viscosity": 0.05, "long": slenderness is None}
    return Journal(0.05 - 2.5e-5, 0.05 + 2.5e-5, cavitation_pressure=0.0, **values, **changes)


def load_of(joint, sommerfeld):
    """W = eta N L D / S (R/c)^2."""
    speed = joint.viscosity * SPEED / (2 * np.pi)
    area = 2 * joint.radius * joint.length
    return speed * area * (joint.radius / joint.clearance) ** 2 / sommerfeld


@pytest.mark.parametrize(
    ("slenderness", "sommerfeld", "eccentricity", "attitude"),
    [
        (None, 0.123, 0.2, 67.26),
        (None, 0.0389, 0.6, 54.31),
        (None, 0.0115, 0.9, 31.62),
        (1.0, 0.631, 0.2, 74.02),
        (1.0, 0.121, 0.6, 50.58),
        (1.0, 0.0188, 0.9, 26.45),
        (0.5, 2.03, 0.2, 74.94),
        (0.5, 0.319, 0.6, 48.14),
        (0.5, 0.0313, 0.9, 23.66),
        (0.25, 7.57, 0.2, 75.18),
        (0.25, 1.07, 0.6, 46.72),
        (0.25, 0.0736, 0.9, 21.85),
    ],
)
def test_charts_of_raimondi_and_boyd(slenderness, sommerfeld, eccentricity, attitude):
    """Raimondi and Boyd (1958): the load within 2 %, the attitude within half a degree."""
    joint = bearing(slenderness)
    low, high = (
        steady_journal(joint, speed=SPEED, load=load_of(joint, s * sommerfeld), cells=(180, 8))
        for s in (1.02, 0.98)
    )
    assert float(low.eccentricity) < eccentricity < float(high.eccentricity)
    between = np.degrees((low.attitude + high.attitude) / 2)
    npt.assert_allclose(between, attitude, atol=0.5)


@pytest.mark.parametrize(
    ("slenderness", "sommerfeld", "eccentricity", "attitude"),
    [
        (0.5, 1.656, 0.244, 65.85),
        (0.5, 0.580, 0.477, 51.01),
        (0.5, 0.244, 0.655, 40.25),
        (1.0, 0.991, 0.150, 70.58),
        (1.0, 0.235, 0.460, 49.27),
        (1.0, 0.108, 0.650, 39.72),
    ],
)
def test_two_axial_grooves_of_lund_and_thomsen(slenderness, sommerfeld, eccentricity, attitude):
    """Lund and Thomsen (1978): two grooves of 20 degrees beside the load."""
    joint = bearing(slenderness)
    grooves = [Groove(sign * np.pi / 2, np.radians(20)) for sign in (1, -1)]
    case = {"grooves": grooves, "cells": (216, 8), "speed": SPEED}
    found = steady_journal(joint, load=load_of(joint, sommerfeld), **case)
    npt.assert_allclose(found.eccentricity, eccentricity, rtol=0.01)
    npt.assert_allclose(np.degrees(found.attitude), attitude, atol=0.5)


@pytest.mark.parametrize(
    ("slenderness", "sommerfeld", "eccentricity", "attitude"),
    [
        (0.5, 2.07, 0.2, 71.6),
        (0.5, 0.517, 0.5, 51.1),
        (0.5, 0.0926, 0.8, 31.2),
        (1.0, 0.284, 0.4, 54.6),
        (1.0, 0.131, 0.6, 43.8),
        (1.0, 0.0469, 0.8, 32.1),
    ],
)
def test_two_axial_grooves_of_the_databook(slenderness, sommerfeld, eccentricity, attitude):
    """Someya (1989), pages 14 and 17; grooves of 10 degrees, to which its friction points."""
    joint = bearing(slenderness)
    grooves = [Groove(sign * np.pi / 2, np.radians(10)) for sign in (1, -1)]
    case = {"grooves": grooves, "cells": (252, 8), "speed": SPEED}
    found = steady_journal(joint, load=load_of(joint, sommerfeld), **case)
    npt.assert_allclose(found.eccentricity, eccentricity, rtol=5e-3)
    npt.assert_allclose(np.degrees(found.attitude), attitude, atol=0.7)


@pytest.mark.parametrize("eccentricity", [0.1, 0.4, 0.8])
def test_short_bearing_of_ocvirk(eccentricity):
    """W = eta R om L^3 / (4 c^2) eps / (1 - eps^2)^2 sqrt(16 eps^2 + pi^2 (1 - eps^2))."""
    joint, rest = bearing(0.02), 1 - eccentricity**2
    load = joint.viscosity * joint.radius * SPEED * joint.length**3 / (4 * joint.clearance**2)
    load *= eccentricity / rest**2 * np.sqrt(16 * eccentricity**2 + np.pi**2 * rest)
    found = steady_journal(joint, speed=SPEED, load=load)
    npt.assert_allclose(found.eccentricity, eccentricity, rtol=5e-4)
    npt.assert_allclose(
        found.attitude, np.arctan(np.pi * np.sqrt(rest) / (4 * eccentricity)), atol=5e-4
    )


def test_full_sommerfeld_bearing():
    """F = 12 pi eps / ((2 + eps^2) sqrt(1 - eps^2)) eta omega R L (R/c)^2, normal to e."""
    full = Journal(
        0.05 - 2.5e-5,
        0.05 + 2.5e-5,
        length=0.1,
        viscosity=0.05,
        long=True,
        cavitation_pressure=-1e12,
    )
    factor = 12 * np.pi * 0.5 / ((2 + 0.25) * np.sqrt(0.75))
    size = 0.05 * SPEED * full.radius * full.length * (full.radius / full.clearance) ** 2
    found = steady_journal(full, speed=SPEED, load=factor * size, cells=(240, 1))
    npt.assert_allclose(found.eccentricity, 0.5, rtol=1e-4)
    npt.assert_allclose(found.attitude, np.pi / 2, atol=1e-6)
    npt.assert_allclose(found.reaction_load, factor * size, rtol=1e-6)


def test_unusable_rotation_or_load_is_refused():
    joint = bearing(1.0)
    with pytest.raises(ModelError, match="speed must not be zero"):
        steady_journal(joint, speed=0.0, load=1.0)
    with pytest.raises(ModelError, match="No film carries"):
        steady_journal(joint, speed=1.0, load=1e9, cells=(64, 2))
