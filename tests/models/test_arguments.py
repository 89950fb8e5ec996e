"""Checks of arguments: the caller's name, what is refused, what passes, what warns."""

import re
import warnings
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr

from erlif.core.errors import ModelError, UnitWarning
from erlif.models.arguments import (
    QUANTITIES,
    formula,
    require_between,
    require_finite,
    require_increasing,
    require_not_negative,
    require_poisson,
    require_positive,
    require_single,
    warn_of_units,
)

LOADS = xr.DataArray([1.0, 2.0], dims="load", coords={"load": [50, 100]})


@formula()
def half(value):
    return value / 2


@pytest.mark.parametrize("value", [1, 1.0, np.float64(1), np.int32(1), np.array(1), np.array(1.0)])
def test_scalar_gives_python_float(value):
    assert type(half(value)) is float
    assert half(value) == 0.5


@pytest.mark.parametrize("value", [[1, 2], (1, 2), range(1, 3), np.array([1, 2])])
def test_sequence_gives_array(value):
    result = half(value)
    assert isinstance(result, np.ndarray)
    np.testing.assert_array_equal(result, [0.5, 1.0])


def test_keyword_list_and_data_array_broadcast():
    @formula()
    def product(one, *, other):
        return one * other

    np.testing.assert_array_equal(product([[1], [2]], other=[3, 4]), [[3, 4], [6, 8]])
    assert product(LOADS, other=2).dims == ("load",)


def test_flags_and_objects_reach_the_formula_unchanged():
    @formula()
    def received(*, rising, linkage, stroke=None):
        return [rising, linkage, stroke]

    flags = np.array([True, False])
    rising, linkage, stroke = received(rising=flags, linkage=LOADS.name)
    assert rising is flags
    assert linkage is None
    assert stroke is None
    assert received(rising=True, linkage=None)[0] is True
    assert received(rising=[True, False], linkage=None)[0].dtype == bool


def test_scalars_in_tuples_and_dataclasses_become_floats():
    class Pair(NamedTuple):
        one: float
        two: float

    @dataclass(frozen=True)
    class Contact:
        width: float
        name: str

    @formula()
    def all_kinds(value):
        value = np.float64(value)
        return Pair(value, value), (value, 1), Contact(value, np.str_("wide"))

    pair, plain, contact = all_kinds(1)
    assert isinstance(pair, Pair)
    assert {type(v) for v in (*pair, plain[0], contact.width)} == {float}
    assert type(contact.name) is str


@pytest.mark.parametrize(
    ("check", "message"),
    [
        (lambda: require_finite(speed=[1.0, -np.inf]), "speed must be finite, got -inf"),
        (lambda: require_finite(speed=None), "speed must be a number in SI units, got None"),
        (lambda: require_positive(load={}), "load must be a number in SI units, got {}"),
        (lambda: require_positive(load=np.inf), "load must be finite, got inf"),
        (lambda: require_positive(load=[1.0, 0.0]), "load must be positive, got 0"),
        (lambda: require_positive(load=LOADS - 3), "load must be positive, got -2"),
        (lambda: require_not_negative(force=np.inf), "force must be finite, got inf"),
        (lambda: require_not_negative(force=-1), "force must not be negative, got -1"),
        (lambda: require_between(0, 1, share=1.5), "share must lie in 0 to 1, got 1.5"),
        (lambda: require_between(0, 1, share=[-2, 0.5]), "share must lie in 0 to 1, got -2"),
        (lambda: require_poisson(nu=-1.0), "nu must lie above -1, got -1"),
        (lambda: require_poisson(nu=[0.3, 0.6]), "nu must be at most 0.5, got 0.6"),
        (lambda: require_increasing(pin=2, bore=2), "bore must exceed pin, got 2 and 2"),
        (lambda: require_increasing(a=1, b=2, c=[3, 1]), "c must exceed b, got 1 and 2"),
        (lambda: require_increasing(a=LOADS, b=1.5), "b must exceed a, got 1.5 and 2"),
        (lambda: require_single(crank=[1, 2]), "crank must be one number, .* shape \\(2,\\)"),
    ],
)
def test_refused_value_is_named(check, message):
    with pytest.raises(ModelError, match=message):
        check()


@formula(turns="number", angle="arc")
def declared(width, *, play=0.0, friction=0.1, turns: float = 1.0, restitution=0.5, angle=1.0,
             poisson=0.3, stroke=None, cells: int = 3):  # fmt: skip
    """Width and play."""
    return width + play, cells


def test_declared_arguments_are_refused_by_name():
    for name, value, message in (
        ("width", 0.0, "must be positive, got 0"),
        ("width", None, "must be a number in SI units, got None"),
        ("play", -np.inf, "must be finite"),
        ("friction", [0.1, -0.1], "must not be negative"),
        ("turns", [1.0, 2.0], "must be one number"),
        ("turns", np.nan, "must be a number, got NaN"),
        ("cells", 2.5, "must be a whole number"),
        ("restitution", 1.1, "must lie in 0 to 1, got 1.1"),
        ("angle", 0.0, "must lie between 0 and 3.14159"),
        ("poisson", 0.6, "must be at most 0.5"),
    ):
        with pytest.raises(ModelError, match=f"^{name} {message}"):
            declared(**{"width": 1.0, name: value})
    assert "`width`, `turns`, `cells` not positive" in declared.__doc__


def test_declared_arguments_pass_warn_and_keep_integers():
    assert declared(1, play=-0.5, friction=0, poisson=0.5, angle=np.nan) == (0.5, 3)
    assert type(declared(1.0, cells=4)[1]) is int
    with pytest.warns(UnitWarning, match=r"^play = -66\.7 m is implausible"):
        declared(1.0, play=-66.7)


def test_missing_values_pass():
    for require in (require_finite, require_positive, require_not_negative, require_poisson):
        require(load=[np.nan, 0.25])
    require_between(0, 1, share=np.nan)
    require_increasing(pin=1.0, bore=[np.nan, 2.0])
    warn_of_units("modulus", youngs_modulus=[np.nan, 2e11])


PLAUSIBLE = {  # extremes of machines, materials and oils in use
    "conductivity": [0.13, 400.0, 2000.0],  # oil, copper, diamond
    "density": [700.0, 857.1, 19300.0],  # light oil, gear oil, tungsten
    "expansion": [-1e-6, 5e-7, 7e-4],  # carbon fibre, quartz, mineral oil
    "film": [0.0, 1e-12, 5.4e-7, 1e-3],
    "kinematic_viscosity": [1e-6, 1.4e-4, 1e-2],
    "length": [1e-6, 0.0667, 5.0],
    "line_load": [0.0, 938.0, 1.9e6],
    "load": [0.0, 222.4, 444.8e3, 1e8],
    "modulus": [5e5, 2.7e9, 2e11, 1.2e12],  # silicone, acrylic, steel, diamond
    "pressure_viscosity": [0.0, 5e-10, 2e-8, 5e-8],
    "reduced_radius": [0.005, 4.872, 1e4],
    "specific_wear": [0.0, 1e-20, 5.05e-13, 1e-10],
    "speed": [-0.0842, 0.0, 150.0],
    "strength": [1e6, 6e8, 1e11],  # PTFE, steel, diamond's hardness
    "swing": [0.0, 0.2132, 3.0],
    "temperature": [213.15, 298.15, 1500.0],
    "viscosity": [1.8e-5, 0.12, 25.0],  # air, gear oil, ISO VG 1000 at freezing point
}

SLIPS = {  # the gear oil, the steel and the joint of Farzaneh (2002) in the units of a data sheet
    "conductivity": [5e4],
    "density": [0.857],
    "expansion": [12.0],
    "film": [0.54],
    "kinematic_viscosity": [140.0],
    "length": [66.7],
    "line_load": [1e11],
    "load": [np.float64(1e10)],
    "modulus": [200.0, 2e5, 2.7, 2700.0],
    "pressure_viscosity": [20.0, 0.02],
    "reduced_radius": [4.872e6],
    "specific_wear": [5.05e-4],
    "speed": [1e4],
    "strength": [600.0, 187.0],
    "swing": [12.2, 90.0],
    "temperature": [25.0, 100.0],
    "viscosity": [120.0, 140.0],
}


def test_every_scale_has_plausible_values_and_slips():
    assert set(PLAUSIBLE) == set(SLIPS) == {name for name, kind in QUANTITIES.items() if kind[1]}


def test_slip_of_units_warns_with_name_value_and_unit():
    for name, slips in SLIPS.items():
        for value in slips:
            with pytest.warns(UnitWarning, match=re.escape(f"number = {value:g} ")) as caught:
                warn_of_units(name, number=[value, PLAUSIBLE[name][-1]])
            assert len(caught) == 1


def test_warning_names_expected_range_and_likely_unit():
    message = r"E = 200 Pa is implausible \(300000 to 1e\+13 Pa expected\): in GPa or MPa\?"
    with pytest.warns(UnitWarning, match=message):
        warn_of_units("modulus", E=200.0)
    with pytest.warns(UnitWarning, match=r"E_1 = 200 Pa, E_2 = 2\.7 Pa are implausible"):
        warn_of_units("modulus", E_1=200.0, nothing=0.0, E_2=[2.7, 2e11])
    with pytest.warns(UnitWarning, match=r"eta = 120 Pa s .* mPa s \(cP\)"):
        warn_of_units("viscosity", eta=120.0)
    with pytest.warns(UnitWarning, match=r"T = 40 K .* degrees Celsius"):
        warn_of_units("temperature", T=xr.DataArray([313.0, 40.0]))


def test_warning_points_at_the_line_outside_the_models():
    from erlif.models.contact import contact_modulus

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warn_of_units("modulus", E=200.0)
        contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
    assert caught[0].filename == __file__
