"""Steady journal bearings against published tables."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest

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


with (Path(__file__).parents[2] / "reference" / "journal_charts.csv").open() as file:
    CHARTS = [(row.pop("source"), *map(float, row.values())) for row in csv.DictReader(file)]

# of each source: cells round the joint, width of its two axial grooves, relative error of the
# eccentricity and error of the attitude in degrees
HELD = {
    "Raimondi and Boyd (1958)": (180, None, None, 0.5),
    "Lund and Thomsen (1978)": (216, 20, 0.01, 0.5),
    # pages 14 and 17; grooves of 10 degrees, to which its friction points
    "Someya (1989)": (252, 10, 5e-3, 0.7),
}


@pytest.mark.parametrize(
    ("source", "slenderness", "sommerfeld", "eccentricity", "attitude"), CHARTS
)
def test_published_charts(source, slenderness, sommerfeld, eccentricity, attitude):
    """Without grooves the load is held within 2 %, so that the eccentricity lies between."""
    around, groove, close, degrees = HELD[source]
    joint = bearing(None if np.isinf(slenderness) else slenderness)
    case = {"cells": (around, 8), "speed": SPEED}
    if groove is None:
        found = [
            steady_journal(joint, load=load_of(joint, share * sommerfeld), **case)
            for share in (1.02, 0.98)
        ]
        assert float(found[0].eccentricity) < eccentricity < float(found[1].eccentricity)
    else:
        case["grooves"] = [Groove(sign * np.pi / 2, np.radians(groove)) for sign in (1, -1)]
        found = [steady_journal(joint, load=load_of(joint, sommerfeld), **case)]
        npt.assert_allclose(found[0].eccentricity, eccentricity, rtol=close)
    between = np.degrees(np.mean([float(one.attitude) for one in found]))
    npt.assert_allclose(between, attitude, atol=degrees)


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
    full = replace(bearing(None), cavitation_pressure=-1e12)
    factor = 12 * np.pi * 0.5 / ((2 + 0.25) * np.sqrt(0.75))
    size = 0.05 * SPEED * full.radius * full.length * (full.radius / full.clearance) ** 2
    found = steady_journal(full, speed=SPEED, load=factor * size, cells=(240, 1))
    npt.assert_allclose(found.eccentricity, 0.5, rtol=1e-4)
    npt.assert_allclose(found.attitude, np.pi / 2, atol=1e-6)
    npt.assert_allclose(found.reaction_load, factor * size, rtol=1e-6)
