"""Persson's contact: the table of the source, equilibrium, limits, inverses."""

from pathlib import Path

import numpy as np
import numpy.testing as npt
import pytest
from scipy.constants import lbf
from scipy.integrate import quad

from erlif.models.contact import (
    persson_contact,
    persson_group,
    persson_half_angle,
    persson_load,
    persson_peak_group,
    persson_pressure,
    projected_pressure,
    sinusoidal_pressure,
)

TABLE = [
    line.split(",")
    for line in (Path(__file__).parents[2] / "reference" / "persson_table_strand_2005.csv")
    .read_text()
    .splitlines()[5:]
]
FINITE = TABLE[:-1]


def test_sinusoidal_pressure_over_half_the_pin_carries_the_load():
    peak = sinusoidal_pressure(3e5, pin_diameter=0.08)
    carried = quad(lambda angle: peak * np.cos(angle) ** 2 * 0.04, -np.pi / 2, np.pi / 2)[0]
    npt.assert_allclose(carried, 3e5, rtol=1e-12)


def test_projected_pressure_over_the_diameter_carries_the_load():
    npt.assert_allclose(projected_pressure(3e5, pin_diameter=0.08) * 0.08, 3e5, rtol=1e-15)


def half_unit(printed):
    """Half a unit of the last printed digit."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


@pytest.mark.parametrize("row", FINITE, ids=[row[0] for row in FINITE])
def test_table_of_eq_9(row):  # Strand (2005), appendix: 105 rows, to the last printed digit
    tangent, alpha, group, peak = row
    half_angle = 2 * np.arctan(float(tangent))
    assert abs(np.degrees(half_angle) - float(alpha)) <= half_unit(alpha)
    assert abs(persson_group(half_angle) - float(group)) <= half_unit(group)
    assert abs(persson_peak_group(half_angle) - float(peak)) <= half_unit(peak)


def test_the_table_has_105_finite_rows_and_a_last_one():
    assert len(FINITE) == 105
    assert TABLE[-1] == ["inf", "180.0", "-2/pi", "-2/pi"]
    npt.assert_allclose(persson_group(np.pi - 1e-6), -2 / np.pi, rtol=1e-9)
    npt.assert_allclose(
        persson_peak_group(np.pi - 1e-6), 2 / np.pi, rtol=1e-9
    )  # the print has the wrong sign


def test_persson_pressure_carries_the_load():
    half_angle = np.concatenate([np.linspace(1e-3, np.pi - 1e-3, 300), [3.14]])[:, None]
    case = {"half_angle": half_angle, "load_per_length": 3.0, "pin_diameter": 0.5}
    # sin(t) in place of the angle takes the square root out of the ends
    nodes, weights = np.polynomial.legendre.leggauss(600)
    t = np.pi / 2 * nodes
    angle = half_angle * np.sin(t)
    carried = persson_pressure(angle, **case) * np.cos(angle) * np.cos(t) @ weights * np.pi / 2
    npt.assert_allclose(carried * half_angle[:, 0] * 0.25, 3.0, rtol=1e-8)
    npt.assert_allclose(
        persson_pressure(0.0, **case), persson_peak_group(half_angle) * 2 * 3.0 / 0.5, rtol=1e-9
    )


@pytest.mark.parametrize(
    ("alpha", "percent", "digit"),
    [(5, -0.30, 0.005), (10, -1.2, 0.05), (20, -4.8, 0.05), (40, -19, 0.5)],
)
def test_hertz_is_low_in_a_conformal_joint(alpha, percent, digit):
    # Hertz in the groups of eq. 9: d p / 2q = sqrt(2 E Delta / (2q) / pi)
    half_angle = np.radians(alpha)
    hertz = np.sqrt(persson_group(half_angle) / (2 * np.pi))
    deviation = 100 * (hertz / persson_peak_group(half_angle) - 1)
    npt.assert_allclose(deviation, percent, atol=digit)


def test_landmarks_of_persson():
    half_angle = np.linspace(0.1, 3.1, 300_001)
    peak = persson_peak_group(half_angle)
    npt.assert_allclose(peak.min(), 0.580093, atol=5e-7)
    npt.assert_allclose(np.degrees(half_angle[peak.argmin()]), 105.6, atol=0.05)
    npt.assert_allclose(np.tan(persson_half_angle(0.0) / 2), 0.9136, atol=5e-5)
    # what the cosine and twice the projected pressure lack at the printed angles
    npt.assert_allclose(2 * persson_peak_group(np.radians(72)) / (4 / np.pi) - 1, 0.006, atol=5e-4)
    npt.assert_allclose(2 * persson_peak_group(np.radians(38)) / 2 - 1, 0.018, atol=5e-4)


def test_thesis_joint_under_100_klbf():
    half_angle, pressure = persson_contact(
        1e5 * lbf / 0.237, play=0.46e-3, pin_diameter=0.06672, youngs_modulus=200e9
    )
    npt.assert_allclose(np.degrees(half_angle), 17.974, atol=5e-4)
    npt.assert_allclose(pressure / 1e6, 115.612, atol=5e-4)


def test_persson_inverts():
    half_angle = np.linspace(1e-6, np.pi - 1e-5, 2001)
    group = persson_group(half_angle)
    npt.assert_allclose(persson_half_angle(group), half_angle, rtol=1e-6)
    half_angle, group = half_angle[np.abs(group) > 1e-3], group[np.abs(group) > 1e-3]
    play = np.sign(group) * 1e-4
    load = persson_load(half_angle, play=play, youngs_modulus=2e11)
    found, _ = persson_contact(load, play=play, pin_diameter=0.1, youngs_modulus=2e11)
    npt.assert_allclose(found, half_angle, rtol=1e-6)
