"""What all formulas of wear and heat share: kinds of arguments, units, bad values."""

import pytest
from scenes.formulas import (
    assert_broadcasts,
    assert_infinity_is_named,
    assert_missing_values_pass,
    evaluate,
)

from erlif.core.errors import ModelError, UnitWarning
from erlif.models.wear import (
    abrasive_wear,
    adhesive_wear,
    bushing_heat_share,
    fatigue_wear,
    friction_heat,
    mean_sliding_speed,
    pressure_velocity,
    steady_bushing_wear,
    surface_temperature,
    thermal_growth,
    wear_depth,
)

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


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (
            lambda: adhesive_wear(1.0, sliding_distance=1.0, hardness=0.0, coefficient=1.0),
            "hardness",
        ),
        (lambda: adhesive_wear(-1.0, sliding_distance=1.0, hardness=1.0, coefficient=1.0), "load"),
        (lambda: wear_depth(1.0, sliding_distance=-1.0, specific_wear=1.0), "sliding_distance"),
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
