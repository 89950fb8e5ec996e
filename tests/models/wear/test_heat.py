"""Speed, heat and temperature of a sliding joint."""

import numpy as np
import numpy.testing as npt
from scipy.integrate import quad

from erlif.models.mechanism import CrankRocker
from erlif.models.wear import (
    bushing_heat_share,
    friction_heat,
    mean_sliding_speed,
    pressure_velocity,
    surface_temperature,
    thermal_growth,
)


def test_mean_speed_of_the_rig():  # Strand (2005), eq. 26 on the joint of Farzaneh (2002)
    rig = CrankRocker(0.055, 0.44, 0.26, 0.51)
    half_swing = np.ptp(rig.limits()) / 2
    found = mean_sliding_speed(half_swing, diameter=0.06672, period=60 / 114)
    npt.assert_allclose(found * 1e3, 54.043, rtol=1e-4)
    crank_angle = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
    speed = np.abs(rig.rocker_speed(crank_angle, crank_speed=114 * 2 * np.pi / 60)) * 0.03336
    npt.assert_allclose(found, speed.mean(), rtol=1e-6)


def test_heat_of_strand():  # Strand (2005), eqs. 28 to 30
    npt.assert_allclose(bushing_heat_share(45.0, bushing_conductivity=60.0), 0.571429, atol=5e-7)
    assert bushing_heat_share(50.0, bushing_conductivity=50.0) == 0.5
    npt.assert_allclose(thermal_growth(0.08, expansion=12e-6, temperature_change=50.0), 48e-6)
    npt.assert_allclose(friction_heat(1e5, friction=0.1, speed=-0.05), 500.0)
    npt.assert_allclose(pressure_velocity(1e5, diameter=0.08, width=0.1, speed=0.05), 12.5e6 * 0.05)


def test_surface_temperature_solves_conduction_through_the_ring():  # Strand (2005), eq. 29
    case = {"heat": 500.0, "pin_diameter": 0.08, "wall": 0.01, "width": 0.1, "conductivity": 60.0}
    rise = surface_temperature(300.0, **case) - 300.0
    # Fourier: Q = -lambda 2 pi r w dT/dr
    fall = quad(lambda r: 500.0 / (60.0 * 2 * np.pi * r * 0.1), 0.04, 0.05)[0]
    npt.assert_allclose(rise, fall, rtol=1e-9)
    npt.assert_allclose(
        surface_temperature(300.0, **case, arc=np.pi) - 300.0, 2 * rise
    )  # as printed
