"""The formulas of the guide with a case of each, for the walk of all formulas, and their ranges."""

import pytest

from erlif.core.errors import ModelError
from erlif.models import bearing
from erlif.models.bearing import (
    end_force_of_closed_lock,
    hardness_from_strength,
    hole_stress_concentration,
    largest_internal_weld_diameter,
    lateral_force,
    lateral_shift,
    least_bushing_width,
    least_closed_end_width,
    least_closed_prong_height,
    least_eyebar_diameter,
    least_open_prong_height,
    least_projected_area,
    least_seat_width,
    least_weld_diameter,
    lock_force,
    pin_diameter_in_bending,
    pin_diameter_in_shear,
    pin_diameter_with_hole,
    press_fit_displacement,
    relative_play,
)

CASE = {"yield_stress": 600e6, "safety": 2.0}
LOCK = {**CASE, "thickness": 0.01, "length": 0.03}
FIT = {
    "bore": 0.07,
    "fit_diameter": 0.08,
    "housing_diameter": 0.16,
    "youngs_housing": 206e9,
    "poisson_housing": 0.3,
}
STEEL = {"youngs_bushing": 206e9, "poisson_bushing": 0.3}

FORMULAS = {
    pin_diameter_in_shear: {"load": 1e5, **CASE},
    pin_diameter_in_bending: {"load": 1e5, "free_length": 0.12, **CASE},
    hole_stress_concentration: {"hole_ratio": 0.1},
    pin_diameter_with_hole: {"load": 1e5, "free_length": 0.12, "hole_ratio": 0.1, **CASE},
    lateral_shift: {"load": 1e5, "length": 0.18, "diameter": 0.08, "youngs_modulus": 206e9},
    lateral_force: {"load": 1e5, "length": 0.18, "diameter": 0.08, "youngs_modulus": 206e9},
    least_projected_area: {"load": 1e5, "yield_stress": 600e6},
    least_bushing_width: {"load": 1e5, "diameter": 0.08, "hardness": 1.2e9, "safety": 2.0},
    least_seat_width: {"load": 1e5, "diameter": 0.08, "hardness": 1.2e9, "safety": 2.0},
    hardness_from_strength: {"ultimate_stress": 8e8},
    least_eyebar_diameter: {"load": 1e5, "bore": 0.08, "width": 0.04, **CASE},
    lock_force: {
        "load": 1e5,
        "diameter": 0.08,
        "lever": 0.06,
        "friction_bushing": 0.9,
        "friction_seat": 0.1,
    },
    least_weld_diameter: {"load": 1e5, "pin_diameter": 0.08, "throat": 0.003, **CASE},
    largest_internal_weld_diameter: {"pin_diameter": 0.08, "throat": 0.003},
    least_open_prong_height: {"load": 1e4, **LOCK},
    end_force_of_closed_lock: {"load": 1e4},
    least_closed_prong_height: {"load": 1e4, **LOCK, "root_shear": 0.5},
    least_closed_end_width: {"load": 1e4, "thickness": 0.01, **CASE},
    relative_play: {"pin_diameter": 0.08, "bore": 0.0802},
    press_fit_displacement: {"interference": 6e-5, **FIT, **STEEL},
}

OUT_OF_RANGE = [
    (lambda: hole_stress_concentration(0.3), "hole_ratio"),
    (
        lambda: lateral_shift(1e9, length=1.0, diameter=0.01, youngs_modulus=2e11),
        "^load must stay below 24 E I",
    ),
    (
        lambda: lateral_force(-1e9, length=1.0, diameter=0.01, youngs_modulus=2e11),
        "^load must stay below 24 E I",
    ),
    (
        lambda: press_fit_displacement(6e-5, **FIT | {"bore": 0.09}, **STEEL),
        "^fit_diameter must exceed bore, got 0.08 and 0.09",
    ),
    (
        lambda: press_fit_displacement(6e-5, **FIT | {"housing_diameter": 0.08}, **STEEL),
        "^housing_diameter must exceed fit_diameter",
    ),
]


def test_all_formulas_are_here():
    functions = {getattr(bearing, name) for name in bearing.__all__ if name.islower()}
    assert functions == set(FORMULAS)


def test_values_out_of_range_are_named():
    for call, named in OUT_OF_RANGE:
        with pytest.raises(ModelError, match=named):
            call()
