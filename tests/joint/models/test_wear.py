"""Wear by hand and by its balances, heat of a sliding joint, the tables of Mukras et al. (2008)."""

import numpy as np
import numpy.testing as npt
from hypothesis import given
from hypothesis import strategies as st
from scenes.slider_crank import SPRUNG
from scipy.integrate import quad

from erlif.joint.models.reaction import SliderCrankBodies
from erlif.joint.models.wear import (
    abrasive_wear,
    adhesive_wear,
    bushing_heat_share,
    coupled_wear,
    fatigue_wear,
    friction_heat,
    mean_sliding_speed,
    pressure_velocity,
    steady_bushing_wear,
    surface_temperature,
    thermal_growth,
    wear_depth,
)
from erlif.models.mechanism import CrankRocker, SliderCrank


def test_archard_by_load_and_by_pressure_agree():
    volume = adhesive_wear(1e3, sliding_distance=50.0, hardness=2e9, coefficient=1e-4)
    depth = wear_depth(1e3 / 4e-4, sliding_distance=50.0, specific_wear=1e-4 / 2e9)
    npt.assert_allclose(volume, depth * 4e-4)


def test_volumes_by_hand():  # Farzaneh (2002), eqs. 2.1 to 2.3
    case = {"sliding_distance": 50.0, "hardness": 2e9}
    npt.assert_allclose(adhesive_wear(1e3, coefficient=1e-4, **case), 2.5e-9)
    slope = np.arctan(0.3)
    npt.assert_allclose(abrasive_wear(1e3, asperity_slope=slope, **case), 4.7746483e-6, rtol=1e-7)
    shape = {"asperity_distribution": 2.0, "particle_size": 3.0, "failure_strain": 0.5}
    npt.assert_allclose(fatigue_wear(1e3, coefficient=0.1, **shape, **case), 6e-5)


@given(
    st.floats(1.0, 1e5),
    st.floats(1e-3, 0.1),
    st.floats(1e-3, 0.2),
    st.floats(1e-3, 1e4),
    st.floats(1e-16, 1e-12),
)
def test_steady_bushing_conserves_load_and_volume(load, radius, width, distance, specific):
    found = steady_bushing_wear(
        load, shaft_radius=radius, width=width, sliding_distance=distance, specific_wear=specific
    )
    carried = quad(
        lambda t: found.pressure * np.cos(t) * np.cos(t) * radius * width, -np.pi / 2, np.pi / 2
    )[0]
    removed = quad(lambda t: found.depth * np.cos(t) * radius * width, -np.pi / 2, np.pi / 2)[0]
    npt.assert_allclose(carried, load, rtol=1e-9)
    npt.assert_allclose(removed, found.volume, rtol=1e-9)
    # Archard for the whole: the friction path carries int P dA = T* F with T* = 4/pi
    npt.assert_allclose(found.volume, specific * 4 / np.pi * load * distance, rtol=1e-9)


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


def mukras_wear(*, cycles=32_000, **options):
    return coupled_wear(
        SliderCrank(crank=0.0762, coupler=0.2032),
        crank_speed=np.pi,
        bodies=SliderCrankBodies(**SPRUNG, spring_preload=68.354),
        bushing_radius=9.535e-3,
        bushing_width=8.468e-3,
        specific_wear=5.05e-13,
        cycles=cycles,
        **options,
    )


def test_wear_relaxes_the_spring():
    """To first order the force falls by the stiffness times the clearance."""
    coupled, alone = (
        mukras_wear(cycles=95_000, extrapolation=100),
        mukras_wear(cycles=95_000, coupled=False),
    )
    loss = 1 - coupled.volume[-1] / alone.volume[-1]
    mean_force = alone.volume[-1] / (5.05e-13 * 9.535e-3 * 2 * np.pi * 95_000)
    npt.assert_allclose(loss, 525.4 * alone.depth[-1] / 2 / mean_force, rtol=0.1)
    assert np.all(np.diff(coupled.greatest_force) < 0)
    assert np.ptp(alone.greatest_force) == 0
    npt.assert_allclose(
        coupled.greatest_force[0] - coupled.greatest_force[-1], 525.4 * coupled.depth[-1], rtol=0.02
    )


def test_extrapolation_converges_to_first_order():
    exact = mukras_wear(extrapolation=50).volume[-1]
    errors = [mukras_wear(extrapolation=n).volume[-1] - exact for n in (2000, 4000, 8000)]
    npt.assert_allclose(np.divide(errors[1:], errors[:-1]), 2, rtol=0.1)
    found = mukras_wear(cycles=1001, extrapolation=500)
    npt.assert_array_equal(found.cycles, [0, 500, 1000, 1001])
