"""Wear and heat: conservation of volume, the worked tests of the sources, limits."""

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes.formulas import (
    assert_broadcasts,
    assert_infinity_is_named,
    assert_missing_values_pass,
    evaluate,
)
from scipy.integrate import quad

from erlif.core.errors import ModelError, UnitWarning
from erlif.models.mechanism import CrankRocker, SliderCrank
from erlif.models.reaction import SliderCrankBodies
from erlif.models.wear import (
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

PTFE = 2200.0  # kg/m3, assumed by no source but needed to turn worn mass into volume
MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)


def mukras_wear(*, preload=68.354, cycles=32_000, width=8.468e-3, **options):
    bodies = SliderCrankBodies(
        rod_mass=0.8175,
        rod_inertia=5500e-6,
        slider_mass=5.5487,
        spring_stiffness=525.4,
        spring_preload=preload,
    )
    return coupled_wear(
        options.pop("linkage", MUKRAS),
        crank_speed=np.pi,
        bodies=bodies,
        bushing_radius=9.535e-3,
        bushing_width=width,
        specific_wear=5.05e-13,
        cycles=cycles,
        **options,
    )


def grams(wear):
    return wear.volume[-1] * PTFE * 1e3


def test_worn_mass_and_depth_of_mukras():
    """Mukras et al. (2008), Table 4: 0.2336 g, 0.6575 mm, with preload and width fitted."""
    found = mukras_wear(coupled=False)
    npt.assert_allclose(grams(found), 0.2336, rtol=1e-4)
    npt.assert_allclose(found.depth[-1] * 1e3, 0.6575, rtol=1e-4)


def test_the_same_preload_predicts_the_second_test():
    """Mukras et al. (2008), Table 5: 0.1589 g, 0.4524 mm."""
    found = mukras_wear(coupled=False, cycles=21_400)
    npt.assert_allclose(grams(found), 0.15622, atol=5e-6)
    npt.assert_allclose(found.depth[-1] * 1e3, 0.4397, atol=5e-5)
    npt.assert_allclose(
        [grams(found) / 0.1589 - 1, found.depth[-1] * 1e3 / 0.4524 - 1], [-0.017, -0.028], atol=5e-4
    )


def test_without_preload_the_printed_inputs_give_a_third_of_the_mass():
    npt.assert_allclose(grams(mukras_wear(preload=0.0, coupled=False)), 0.0824, atol=5e-5)
    npt.assert_allclose(0.0824 / 0.2336, 0.35, atol=5e-3)


def test_half_lengths_taken_as_full_ones_need_another_preload():
    full = SliderCrank(0.0381, 0.1016)
    npt.assert_allclose(
        grams(mukras_wear(preload=87.0, linkage=full, coupled=False)), 0.2336, rtol=2e-3
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


def test_sliding_distance_per_cycle():  # Mukras et al. (2008), eq. 20: 59.910 mm
    npt.assert_allclose(2 * np.pi * 9.535, 59.910, atol=5e-4)
    turning = MUKRAS.joint_speed(np.linspace(0, 2 * np.pi, 720, endpoint=False), crank_speed=1.0)
    npt.assert_allclose(np.mean(np.abs(turning)) * 2 * np.pi * 9.535, 59.910, atol=5e-4)


def test_too_long_a_step_is_refused():
    with pytest.raises(ModelError, match="extrapolation must be smaller"):
        mukras_wear(cycles=10**7, extrapolation=10**6)


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


def test_abrasive_and_fatigue_wear_are_archards_law():
    case = {"sliding_distance": 10.0, "hardness": 1e9}
    npt.assert_allclose(
        abrasive_wear(5.0, asperity_slope=np.pi / 4, **case),
        adhesive_wear(5.0, coefficient=2 / np.pi, **case),
    )
    npt.assert_allclose(
        fatigue_wear(
            5.0,
            asperity_distribution=2.0,
            particle_size=3.0,
            failure_strain=0.5,
            coefficient=0.1,
            **case,
        ),
        adhesive_wear(5.0, coefficient=0.1 * 2 * 3 / 0.25, **case),
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


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (
            lambda: adhesive_wear(1.0, sliding_distance=1.0, hardness=0.0, coefficient=1.0),
            "hardness",
        ),
        (lambda: adhesive_wear(-1.0, sliding_distance=1.0, hardness=1.0, coefficient=1.0), "load"),
        (lambda: wear_depth(1.0, sliding_distance=-1.0, specific_wear=1.0), "sliding_distance"),
        (lambda: mukras_wear(width=0.0), "bushing_width"),
        (lambda: mukras_wear(cycles=np.inf), "^cycles must be finite"),
        (lambda: mukras_wear(cycles=np.nan), "^cycles must be a number"),
        (lambda: mukras_wear(width=np.ones(2)), "^bushing_width must be one number"),
        (
            lambda: abrasive_wear(1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=2.0),
            "^asperity_slope must lie from 0 to below pi/2, got 2 rad",
        ),
        (
            lambda: abrasive_wear(1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=-0.1),
            "^asperity_slope must lie from 0 to below pi/2, got -0.1 rad",
        ),
        (
            lambda: fatigue_wear(**FORMULAS[fatigue_wear] | {"particle_size": -1.0}),
            "^particle_size must not be negative",
        ),
        (
            lambda: fatigue_wear(**FORMULAS[fatigue_wear] | {"asperity_distribution": -1.0}),
            "^asperity_distribution must not be negative",
        ),
        (lambda: mean_sliding_speed(-0.2, diameter=0.1, period=1.0), "^half_swing must not be"),
        (lambda: mean_sliding_speed(0.2, diameter=0.1, period=0.0), "period"),
        (lambda: bushing_heat_share(-1.0, bushing_conductivity=1.0), "pin_conductivity"),
    ],
)
def test_bad_values_are_named(call, named):
    with pytest.raises(ModelError, match=named):
        call()


FORMULAS = {
    adhesive_wear: {"load": 1e3, "sliding_distance": 50.0, "hardness": 2e9, "coefficient": 1e-4},
    abrasive_wear: {"load": 1e3, "sliding_distance": 50.0, "hardness": 2e9, "asperity_slope": 0.1},
    fatigue_wear: {
        "load": 1e3,
        "sliding_distance": 50.0,
        "hardness": 2e9,
        "asperity_distribution": 2.0,
        "particle_size": 3.0,
        "failure_strain": 0.5,
        "coefficient": 1e-4,
    },
    wear_depth: {"pressure": 1e7, "sliding_distance": 90.0, "specific_wear": 5e-13},
    steady_bushing_wear: {
        "load": 400.0,
        "shaft_radius": 0.005,
        "width": 0.01,
        "sliding_distance": 1e3,
        "specific_wear": 5e-13,
    },
    mean_sliding_speed: {"half_swing": 0.2, "diameter": 0.08, "period": 0.5},
    pressure_velocity: {"load": 1e5, "diameter": 0.08, "width": 0.1, "speed": 0.05},
    friction_heat: {"load": 1e5, "friction": 0.1, "speed": -0.05},
    bushing_heat_share: {"pin_conductivity": 45.0, "bushing_conductivity": 60.0},
    surface_temperature: {
        "measured_temperature": 300.0,
        "heat": 500.0,
        "pin_diameter": 0.08,
        "wall": 0.01,
        "width": 0.1,
        "conductivity": 60.0,
        "arc": 3.0,
    },
    thermal_growth: {"diameter": 0.08, "expansion": 12e-6, "temperature_change": 50.0},
}
EVERY_FORMULA = pytest.mark.parametrize(
    ("formula", "case"), FORMULAS.items(), ids=[formula.__name__ for formula in FORMULAS]
)


@EVERY_FORMULA
def test_scalars_give_floats_and_arrays_broadcast(formula, case):
    assert_broadcasts(formula, case)


@EVERY_FORMULA
def test_infinite_argument_is_refused_by_name(formula, case):
    assert_infinity_is_named(formula, case)


@EVERY_FORMULA
def test_missing_value_gives_a_missing_result(formula, case):
    assert_missing_values_pass(formula, case)


@pytest.mark.parametrize(
    ("formula", "slip", "message"),
    [
        (adhesive_wear, {"hardness": 200.0}, "hardness = 200 Pa .*Brinell"),
        (abrasive_wear, {"hardness": 200.0}, "hardness = 200 Pa"),
        (fatigue_wear, {"hardness": 200.0}, "hardness = 200 Pa"),
        (wear_depth, {"specific_wear": 0.000505}, "specific_wear = 0.000505 1/Pa .* mm3/"),
        (steady_bushing_wear, {"shaft_radius": 33.36}, "shaft_radius = 33.36 m"),
        (mean_sliding_speed, {"diameter": 66.72}, "diameter = 66.72 m"),
        (mean_sliding_speed, {"half_swing": 12.2}, "half_swing = 12.2 rad .* degrees"),
        (pressure_velocity, {"width": 100.0}, "width = 100 m"),
        (friction_heat, {"speed": 50000.0}, "speed = 50000 m/s"),
        (bushing_heat_share, {"pin_conductivity": 45000.0}, "pin_conductivity = 45000 W"),
        (
            surface_temperature,
            {"measured_temperature": 27.0},
            "measured_temperature = 27 K .* Celsius",
        ),
        (thermal_growth, {"expansion": 12.0}, "expansion = 12 1/K"),
    ],
)
def test_slip_of_units_warns(formula, slip, message):
    with pytest.warns(UnitWarning, match=message):
        evaluate(formula, FORMULAS[formula] | slip)


def test_slip_of_units_in_coupled_wear_warns():
    with pytest.warns(UnitWarning, match=r"bushing_width = 84.68 m .* mm"):
        mukras_wear(width=84.68, cycles=1)
