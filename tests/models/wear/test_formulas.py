"""What all formulas of wear and heat share: kinds of arguments, units, bad values."""

import pytest

from erlif.core.errors import ModelError
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


def test_slope_of_an_asperity_lies_below_a_right_angle():
    for slope in (-0.1, 2.0):
        with pytest.raises(ModelError, match=rf"^asperity_slope must lie .* got {slope:g} rad"):
            abrasive_wear(1.0, sliding_distance=1.0, hardness=1e9, asperity_slope=slope)
