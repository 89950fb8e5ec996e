"""Steady journal bearings and their coefficients against published tables."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from erlif.models.reynolds import Groove, Journal, journal_coefficients, steady_journal
from erlif.models.reynolds.steady import Rotation
from erlif.models.reynolds.transient import Bearing, losses

REFERENCE = Path(__file__).parents[2] / "reference"
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


with (REFERENCE / "journal_charts.csv").open() as file:
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


def friction_at(joint, eccentricity, cells):
    """Torque [N m], what oil in the void would add, and the load [N]."""
    case = Rotation(Bearing.of(joint, cells, [Groove(np.pi)]), SPEED)
    state, medium = case.held_at(eccentricity * joint.clearance), case.bearing.medium
    slide, gap = SPEED * joint.radius, state.walls.centre
    lacking = (state.void.clip(0.0, gap) / gap**2) @ medium.grid.area
    lacking = medium.images * joint.viscosity * slide * joint.radius * float(lacking.sum())
    torque = losses(medium, state, slide, joint.radius)["friction_torque"]
    return torque, lacking, float(np.hypot(*case.force(state)))


@pytest.mark.parametrize(
    ("eccentricity", "variable", "less"),
    [(0.1, 26.4, 0.04), (0.2, 12.8, 0.07), (0.4, 5.79, 0.12), (0.8, 1.70, 0.17), (0.9, 1.05, 0.18)],
)
def test_friction_with_shear_in_the_voids_is_that_of_the_charts(eccentricity, variable, less):
    """(R/c) f of Raimondi and Boyd (1958), L/D = 1, who take the shear of the whole gap.

    Read as quoted at mathworks.com/matlabcentral/answers/707318; the void lowers the friction.
    """
    joint = bearing(1.0)
    torque, lacking, load = friction_at(joint, eccentricity, (180, 8))
    npt.assert_allclose((torque + lacking) / (load * joint.clearance), variable, rtol=5e-3)
    npt.assert_allclose(lacking / (torque + lacking), less, atol=0.01)


@pytest.mark.parametrize("eccentricity", [0.2, 0.6, 0.9])
def test_void_of_a_long_bearing_has_the_shear_of_the_oil_that_passed(eccentricity):
    """Behind the rupture at a the oil that passes is h(a): its share of the shear is h(a) / h^2.

    From the widest gap, p = 0 and dp/dx = 0 at a, so that (h - h(a)) / h^3 has no integral to a;
    the moving surface has the integrals of 1/h and of 3 (h - h(a)) / h^2 to a.
    """

    def gap(angle):
        return 1 + eccentricity * np.cos(angle)

    def flow(end):
        return quad(lambda at: (gap(at) - gap(end)) / gap(at) ** 3, 0, end)[0]

    end = brentq(flow, np.pi + 1e-6, 2 * np.pi - 1e-6)
    shear = quad(lambda at: 1 / gap(at) + 3 * (gap(at) - gap(end)) / gap(at) ** 2, 0, end)[0]
    shear += quad(lambda at: gap(end) / gap(at) ** 2, end, 2 * np.pi)[0]
    joint = bearing(None)
    unit = joint.viscosity * SPEED * joint.radius**3 * joint.length / joint.clearance
    npt.assert_allclose(friction_at(joint, eccentricity, (1024, 1))[0] / unit, shear, rtol=2e-3)


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


TABLE = np.loadtxt(REFERENCE / "lund_thomsen_1978.csv", delimiter=",", skiprows=5)
RADIUS, CLEARANCE, VISCOSITY, TURNS = 0.05, 1e-4, 0.02, 50.0
PAIR = [Groove(side * np.pi / 2, np.radians(20)) for side in (-1, 1)]


def coefficients(row, cells=(180, 6)):
    slenderness, sommerfeld = row[:2]
    length = 2 * RADIUS * slenderness
    joint = Journal(
        RADIUS - CLEARANCE / 2,
        RADIUS + CLEARANCE / 2,
        length=length,
        viscosity=VISCOSITY,
        cavitation_pressure=0.0,
    )
    load = VISCOSITY * TURNS * length * 2 * RADIUS * (RADIUS / CLEARANCE) ** 2 / sommerfeld
    return journal_coefficients(
        joint, speed=2 * np.pi * TURNS, load=load, grooves=PAIR, cells=cells
    )


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"L/D {row[0]:g}, S {row[1]:g}")
def test_coefficients_are_those_of_lund_and_thomsen(row):
    found = coefficients(row)
    npt.assert_allclose(found.eccentricity, row[2], atol=2e-3)
    npt.assert_allclose(np.degrees(found.attitude), row[3], atol=0.3)
    npt.assert_allclose(found.stiffness_number.values.ravel(), row[4:8], rtol=0.02, atol=0.02)

    # sideways damping is up to 4.5 % below the table, which takes cavities without a memory
    b = found.damping_number.values
    npt.assert_allclose([b[0, 0], b[0, 1], b[1, 1]], row[8:], rtol=0.045, atol=0.005)


def test_line_of_supply_stays_where_it_is():
    joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, cavitation_pressure=0.0)
    found = journal_coefficients(joint, speed=2.5, load=222.4, cells=(128, 4))
    given = journal_coefficients(
        joint,
        speed=2.5,
        load=222.4,
        cells=(128, 4),
        grooves=[Groove(float(found.attitude) + np.pi)],
    )
    npt.assert_allclose(found.stiffness, given.stiffness, rtol=0.02)
