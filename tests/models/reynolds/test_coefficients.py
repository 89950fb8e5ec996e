"""Linear coefficients against the table of Lund and Thomsen (1978)."""

from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.reynolds import Groove, Journal, journal_coefficients

TABLE = np.loadtxt(
    Path(__file__).parents[2] / "reference/lund_thomsen_1978.csv", delimiter=",", skiprows=5
)
RADIUS, CLEARANCE, VISCOSITY, TURNS = 0.05, 1e-4, 0.02, 50.0
GROOVES = [Groove(side * np.pi / 2, np.radians(20)) for side in (-1, 1)]


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
        joint, speed=2 * np.pi * TURNS, load=load, grooves=GROOVES, cells=cells
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
