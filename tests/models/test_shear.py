"""Shear of journals, against closed forms of the literature and the sum over the gap."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models import shear
from erlif.models.reynolds import Journal, Motion, solve_journal, steady_journal

PIN = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
R, L, C, U = PIN.radius, PIN.length, PIN.clearance, 0.0842


def couette(distance, speed):
    return shear.journal_shear_torque(distance / C, PIN, viscosity=0.12, speed=speed)


def test_concentric_journal_has_the_torque_of_petroff():
    """Petroff: 4 pi^2 eta N R^3 L / c with N turns in a second."""
    petroff = 4 * np.pi**2 * 0.12 * U / (2 * np.pi * R) * R**3 * L / C
    npt.assert_allclose(couette(0.0, U), petroff, rtol=1e-9)


@pytest.mark.parametrize("eps", [0.1, 0.6, 0.95])
def test_shear_is_the_sum_over_the_gap(eps):
    angle = np.linspace(0, 2 * np.pi, 20001)
    thin = np.trapezoid(1 / (C * (1 - eps * np.cos(angle))), angle)
    npt.assert_allclose(couette(eps * C, U), 0.12 * U * R**2 * L * thin, rtol=1e-6)


@pytest.mark.parametrize("eps", [0.1, 0.6, 0.95])
def test_full_film_of_a_long_journal_has_the_torque_of_sommerfeld(eps):
    """Both torques of Sommerfeld (1904), over eta U R^2 L / c; the load is across the centres."""
    load = 12 * np.pi * eps / ((2 + eps**2) * np.sqrt(1 - eps**2))
    sheared = couette(eps * C, U) / (0.12 * U * R**2 * L / C)
    pressure = shear.journal_pressure_torque(0.0, eps, load=load)
    whole = (2 + eps**2) * np.sqrt(1 - eps**2)
    npt.assert_allclose(sheared + pressure, 4 * np.pi * (1 + 2 * eps**2) / whole, rtol=1e-9)
    npt.assert_allclose(sheared - pressure, 4 * np.pi * (1 - eps**2) / whole, rtol=1e-9)


@pytest.mark.parametrize("speed", [2.54, -2.54])
def test_moment_of_the_load_is_the_pressure_part_of_the_solved_film(speed):
    """222 N leave a full film, whose shear stress the solver integrates over the bushing."""
    found = steady_journal(PIN, speed=speed, load=222.4)
    ex, ey = float(found.displacement_load), float(found.displacement_side)
    sense = np.sign(speed)
    expected = couette(np.hypot(ex, ey), abs(speed) * R)
    expected += sense * shear.journal_pressure_torque(ex, ey, load=222.4)
    npt.assert_allclose(sense * float(found.friction_torque), expected, rtol=1e-3)


def test_sideways_force_of_a_guided_pin_counts_in_the_pressure_part():
    time = np.linspace(0, 0.5263, 101)
    angle = 0.106 * np.sin(2 * np.pi * time / 0.5263)
    start = (C - 20e-6, 0.0)
    found = solve_journal(PIN, Motion(time, angle, 222.4), start=start, sideways="guided")
    speed = np.diff(angle) / np.diff(time)
    ex = found.displacement_load.values
    middle, sense = (ex[1:] + ex[:-1]) / 2, np.sign(speed)
    expected = couette(middle, np.abs(speed) * R)
    side = found.reaction_side.values[1:]
    pressure = shear.journal_pressure_torque(middle, 0.0, load=222.4, side=sense * side)
    torque = sense * found.friction_torque.values[1:]
    fast = np.abs(speed) > 0.3
    assert np.abs(pressure[fast] / expected[fast]).min() > 0.2
    npt.assert_allclose(torque[fast], (expected + pressure)[fast], rtol=5e-3)


def test_cavities_take_off_no_more_than_the_bound():
    """5 kN on the turning joint: the solver conserves the oil between cavities."""
    for load in (2e3, 5e3, 2e4):
        found = steady_journal(PIN, speed=2.54, load=load)
        ex, ey = float(found.displacement_load), float(found.displacement_side)
        distance = np.hypot(ex, ey)
        full = couette(distance, 2.54 * R)
        pressure = shear.journal_pressure_torque(ex, ey, load=load)
        lost = 1 - (float(found.friction_torque) - pressure) / full
        bound = shear.void_share(distance / C)
        assert 0.02 < lost < bound


def test_tilt_is_the_mean_over_the_axis():
    film, tilt, length = 5e-6, 4e-5, 0.237
    z = (np.arange(20000) + 0.5) / 20000 - 0.5
    gap = film + tilt * length * z
    mean = np.sqrt(film) * np.mean(1 / np.sqrt(gap))
    npt.assert_allclose(shear.tilt_factor(tilt, length=length, film=film), mean, rtol=1e-4)
    npt.assert_allclose(shear.tilt_factor(1e-3, length=length, film=film), np.sqrt(2), rtol=1e-9)
    npt.assert_allclose(shear.tilt_factor(0.0, length=length, film=film), 1.0, rtol=1e-9)


def test_heating_is_that_of_a_parabola_between_walls():
    """k T'' = -eta (U/h)^2 with T = 0 at both walls."""
    z = np.linspace(0, 1, 101)
    rise = shear.shear_heating(2.0, viscosity=0.1, conductivity=0.13)
    second = np.diff(4 * rise * z * (1 - z), 2) / (z[1] - z[0]) ** 2
    npt.assert_allclose(0.13 * second, -0.1 * 2.0**2, rtol=1e-6)
