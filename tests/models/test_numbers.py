"""Every formula of the models takes floats, lists, arrays and DataArrays, or is listed as other.

All tables FORMULAS of the tests of the models are walked together.
"""

import ast
import importlib
import inspect
import warnings
from contextlib import suppress
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
from scenes.formulas import (
    assert_broadcasts,
    assert_infinity_is_named,
    assert_missing_values_pass,
    evaluate,
    numeric,
)

from erlif import models
from erlif.core.errors import ModelError
from erlif.models import (
    contact,
    edges,
    film,
    fluorescence,
    linkage,
    oil,
    reynolds,
    running_in,
)

SIGNED = {
    "band_signal": "brightness thickness",
    "barus_viscosity": "pressure",
    "beam_bending_stress": "force",
    "coupler_force": "crank_angle rocker_torque",
    "density_at_temperature": "expansion",
    "dowson_higginson_film": "entrainment_speed",
    "end_force_of_closed_lock": "load",
    "friction_coefficient": "torque",
    "friction_heat": "speed",
    "hamrock_dowson_film": "entrainment_speed",
    "hole_stress": "force",
    "impact_force": "penetration rate",
    "isoviscous_elastic_film": "entrainment_speed",
    "isoviscous_rigid_film": "entrainment_speed",
    "joint_reaction": "crank_angle crank_speed",
    "lateral_force": "load",
    "lateral_shift": "load",
    "log_band_ratio": "thickness",
    "log_band_ratio_slope": "thickness",
    "lundberg_profile": "axial",
    "mean_transmission": "depth",
    "mean_transmission_log_slope": "depth",
    "persson_load": "play",
    "persson_pressure": "angle load_per_length",
    "piezoviscous_rigid_film": "entrainment_speed",
    "pin_shape": "x z",
    "press_fit_displacement": "interference",
    "pressure_velocity": "load speed",
    "projected_pressure": "load_per_length",
    "relative_radii": "angle radius_1 radius_1_across radius_2 radius_2_across",
    "rod_stress": "force",
    "roelands_viscosity": "pressure",
    "roller_shape": "x",
    "scale_load": "load",
    "scale_stress": "stress",
    "sinusoidal_pressure": "load_per_length",
    "surface_temperature": "heat",
    "thermal_growth": "expansion temperature_change",
    "thesis_film": "sliding_speed",
    "thin_wall_torque_ratio": "clearance",
    "vogel_viscosity": "b c",
}
"""Arguments that may be negative; the ratios of Poisson may be so too."""

SLIPS = {  # in GPa, mm, mPa s, 1/GPa, degrees Celsius, g/cm3, 1e-6/K, degrees, mm3/(N m), mN
    **dict.fromkeys(["contact_modulus", "youngs_modulus", "youngs_1", "youngs_2"], 110.0),
    **dict.fromkeys(["modulus", "model_youngs_modulus"], 2.7),
    **dict.fromkeys(["hardness", "fatigue_strength", "yield_stress"], 600.0),
    **dict.fromkeys(["pin_radius", "shaft_radius", "bushing_radius", "wall", "thickness"], 33.0),
    **dict.fromkeys(["pin_diameter", "diameter", "width", "half_width", "length"], 66.7),
    **dict.fromkeys(["free_length", "bore", "lever", "throat", "fit_diameter"], 66.7),
    **dict.fromkeys(["youngs_bushing", "youngs_housing"], 206.0),
    **dict.fromkeys(["film", "roughness_a", "roughness_b"], 0.54),
    **dict.fromkeys(["load", "force", "rating"], 1e10),
    **dict.fromkeys(["entrainment_speed", "sliding_speed", "impact_speed"], 1e5),
    **dict.fromkeys(["conductivity", "pin_conductivity", "bushing_conductivity"], 5e4),
    **dict.fromkeys(["measured_temperature", "reference_temperature"], 27.0),
    "load_per_length": 1e12,
    "viscosity": 120.0,
    "pressure_viscosity": 20.0,
    "density": 0.857,
    "expansion": 700.0,
    "half_swing": 12.2,
    "specific_wear": 5.05e-4,
}  # fmt: skip

SCREEN = {"load_per_length": 1e5, "viscosity": 0.1, "radius": 1.0}
SOFT = {"entrainment_speed": 0.05, **SCREEN, "contact_modulus": 1e9}

FORMULAS = {
    contact.closed_contact_pressure: {
        "load_per_length": 1e6, "interference": 1e-3, "pin_diameter": 0.05,
        "youngs_modulus": 2e11,
    },
    edges.edge_exponent: {"angle": 1.8},  # its ratio may be infinite; test_ends.py has arrays of it
    edges.lundberg_profile: {
        "axial": 0.005, "load": 1e4, "length": 0.02, "contact_modulus": 1e11,
    },
    film.film_parameter: {"film": 1e-6, "roughness_a": 2e-7, "roughness_b": 3e-7},
    film.dowson_higginson_film: SOFT | {"pressure_viscosity": 2e-8},
    film.thesis_film: {
        "sliding_speed": 0.08, **SCREEN, "contact_modulus": 1e9, "pressure_viscosity": 2e-8,
    },
    film.hamrock_dowson_film: {
        "entrainment_speed": 1.0, "load": 100.0, "viscosity": 0.1, "pressure_viscosity": 2e-8,
        "radius_along": 0.01, "radius_across": 0.02, "contact_modulus": 1e11,
    },
    film.isoviscous_elastic_film: SOFT,
    film.isoviscous_rigid_film: {"entrainment_speed": 0.05, **SCREEN},
    film.piezoviscous_rigid_film: {
        "entrainment_speed": 0.05, "viscosity": 0.1, "pressure_viscosity": 2e-8, "radius": 1.0,
    },
    film.squeeze_time: {
        "film": 1e-6, "half_width": 1e-3, "load_per_length": 1e5, "viscosity": 0.1,
    },
    fluorescence.band_signal: {"thickness": 2e-6, "attenuation": 1e5, "brightness": 3.0},
    fluorescence.log_band_ratio: {
        "thickness": 2e-6, "ratio_at_zero": 1.5, "attenuation_camera1": 1e5,
        "attenuation_camera2": 4e5,
    },
    fluorescence.mean_transmission: {"depth": 0.7},
    fluorescence.mean_transmission_log_slope: {"depth": 0.7},
    fluorescence.log_band_ratio_slope: {
        "thickness": 2e-6, "attenuation_camera1": 1e5, "attenuation_camera2": 4e5,
    },
    linkage.beam_bending_stress: {"force": 8e3, "arm": 0.26, "thickness": 0.02, "depth": 0.06},
    linkage.fatigue_safety: {
        "amplitude": 2e7, "fatigue_strength": 5e7, "mean": 1e7, "tensile_strength": 3e8,
    },
    linkage.hole_stress: {
        "force": 8e3, "width": 0.045, "thickness": 0.02, "hole": 0.02, "concentration": 2.5,
    },
    linkage.open_hole_concentration: {"hole_ratio": 0.4},
    linkage.pin_hole_concentration: {"hole_ratio": 0.4},
    linkage.thread_stress_area: {"diameter": 0.012, "pitch": 1.75e-3},
    oil.barus_viscosity: {"pressure": 1e8, "viscosity": 0.1, "pressure_viscosity": 2e-8},
    oil.roelands_viscosity: {"pressure": 1e8, "viscosity": 0.1, "pressure_viscosity": 2e-8},
    oil.density_at_pressure: {"pressure": 1e8, "density": 870.0},
    oil.density_at_temperature: {
        "temperature": 330.0, "density": 870.0, "reference_temperature": 288.0,
        "expansion": 7e-4,
    },
    oil.kinematic_viscosity: {"viscosity": 0.1, "density": 870.0},
    oil.vogel_viscosity: {"temperature": 330.0, "a": 1e-4, "b": 900.0, "c": 170.0},
    oil.walther_viscosity: {
        "temperature": 330.0, "viscosity_1": 1e-4, "temperature_1": 313.15,
        "viscosity_2": 1e-5, "temperature_2": 373.15,
    },
    reynolds.roller_shape: {"x": 0.002, "radius": 1.0},
    reynolds.pin_shape: {"x": 0.002, "z": 0.003, "radius": 1.0, "cross_radius": 2.0},
    running_in.thin_wall_torque_ratio: {
        "load_per_length": 1e4, "clearance": 5e-5, "shaft_radius": 0.01, "thickness": 1e-3,
        "modulus": 2e9,
    },
}  # fmt: skip

OTHERS = {
    "clearance_fit.fit_clearances": "a fit to a series of measurements",
    "edges.prepare_joint": "finite elements of one joint",
    "edges.search_undercut": "a table over three lengths",
    "edges.section_stress": "fields of one solved contact",
    "edges.solve_contact": "a grid of gaps",
    "edges.solve_joint": "one solved joint",
    "edges.subsurface_stress": "fields of one solved contact",
    "film.line_contact_film": "text among its results; tests/models/test_film.py has its arrays",
    "film.lubrication_regimes": "text; a tuple of names for one number",
    "fluorescence.log_band_ratio_gradient": "a gradient; test_fluorescence.py has its arrays",
    "friction.average_reversals": "a time series",
    "friction.torque_ratio": "an integral over the last axis",
    "linkage.choose_motor": "one rating of a series",
    "linkage.drive_power": "a turn of one linkage",
    "linkage.grashof_class": "text for one linkage",
    "linkage.link_sensitivity": "one linkage",
    "linkage.measure_linkage": "one linkage",
    "linkage.synthesise_crank_rocker": "one synthesis",
    "mechanism.crank_for_swing": "one root for each call",
    "oil.fit_vogel": "a fit to three measurements",
    "oil_fit.fit_viscosity": "a fit to a series of measurements",
    "oil_fit.iso_vg_viscosity": "a grade of a standard",
    "oil_fit.sae_oil": "a grade of a standard",
    "reaction.warn_of_compression": "a warning about a turn",
    "reynolds.crank_motion": "a time series",
    "reynolds.journal_coefficients": "one bearing",
    "reynolds.lobe_shape": "a sequence of centres; tests/models/reynolds has its arrays",
    "reynolds.solve_film": "a grid of films",
    "reynolds.solve_journal": "a time series of one bearing",
    "reynolds.steady_journal": "one bearing",
    "running_in.run_in_bushing": "a time series of one bushing",
    "slider_dynamics.simulate_slider_crank": "a time series of one mechanism",
    "slider_wear.bound_extrapolation": "two simulations",
    "slider_wear.wear_slider_crank": "a time series of one mechanism",
    "wear.coupled_wear": "a time series of one mechanism",
    "winkler_arc.arc_of_load": "arrays of one shape, for the functions of friction",
    "winkler_arc.eccentricity_of_arc": "arrays of one shape, for the functions of friction",
    "winkler_arc.indentation_of_arc": "arrays of one shape, for the functions of friction",
    "winkler_arc.rubbed_by_arc": "arrays of one shape, for the functions of friction",
    "winkler_arc.supported_by_arc": "arrays of one shape, for the functions of friction",
}
"""Public functions that are no formulas of numbers that broadcast, with the reason."""

NOT_THEORY = {"arguments", "sources"}

STRAIGHT = dict.fromkeys(["radius_1", "radius_1_across", "radius_2", "radius_2_across"], np.inf)
"""Radii that may be infinite."""


@cache
def all_formulas():
    """Every formula with the case of its own table, from all tests of the models."""
    tables = [module_of(path).FORMULAS for path in paths_of_tables()]
    return {formula: case for table in tables for formula, case in table.items()}


def module_of(path):
    """Test module of a path below tests/."""
    parts = path.relative_to(Path(__file__).parents[2]).with_suffix("").parts
    return importlib.import_module(".".join(parts))


def paths_of_tables():
    """Test files that hold a table FORMULAS."""
    for path in sorted(Path(__file__).parent.rglob("test_*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            table = isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "")
            if table == "FORMULAS" and isinstance(node.value, ast.Dict):
                yield path


def failing(check):
    """Formulas for which a check fails, with the reason."""
    found = {}
    for formula, case in all_formulas().items():
        try:
            check(formula, case)
        except (Exception, pytest.fail.Exception) as error:
            found[formula.__name__] = str(error)
    return found


def test_scalars_give_floats_and_arrays_broadcast():
    assert not failing(assert_broadcasts)


def test_infinite_argument_is_refused_by_name():
    assert not failing(partial(assert_infinity_is_named, allowed=STRAIGHT))


def test_missing_value_gives_a_missing_result():
    assert not failing(assert_missing_values_pass)


def assert_negative_is_named(formula, case):
    signed = SIGNED.get(formula.__name__, "").split()
    for name in numeric(case):
        if name not in signed and not name.startswith("poisson"):
            with pytest.raises(ModelError, match=rf"^{name}\b"):
                evaluate(formula, case | {name: -abs(case[name])})


def test_negative_argument_is_refused_by_name():
    assert not failing(assert_negative_is_named)


def assert_slip_warns(formula, case):
    if formula.__module__ == fluorescence.__name__:  # in any unit of length
        return
    for name in set(SLIPS) & set(numeric(case)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with suppress(ModelError):
                evaluate(formula, case | {name: SLIPS[name]})
        assert any(str(one.message).startswith(f"{name} = ") for one in caught), name


def test_slip_of_units_warns():
    assert not failing(assert_slip_warns)


def public_functions():
    """Public functions of the models, by module and name."""
    found = set()
    modules = {name for name in models.__all__ if inspect.ismodule(getattr(models, name))}
    for name in modules - NOT_THEORY:
        module = importlib.import_module(f"erlif.models.{name}")
        own = [
            key
            for key, value in vars(module).items()
            if getattr(value, "__module__", "") == module.__name__ and not key.startswith("_")
        ]
        found |= {
            f"{name}.{key}"
            for key in getattr(module, "__all__", own)
            if inspect.isfunction(getattr(module, key))
        }
    return found


def test_every_public_function_is_tested_with_arrays_or_listed():
    tested = {formula.__name__ for formula in all_formulas()}
    untested = {name for name in public_functions() if name.rpartition(".")[2] not in tested}
    assert untested == set(OTHERS)
