"""Checks of arguments: the caller's name, what is refused, what passes, what warns."""

import re
import warnings

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
    require_poisson,
    require_positive,
    require_single,
    warn_of_units,
)

LOADS = xr.DataArray([1.0, 2.0], dims="load", coords={"load": [50, 100]})


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


@pytest.mark.parametrize(
    ("check", "message"),
    [
        (lambda: require_finite(speed=[1.0, -np.inf]), "speed must be finite, got -inf"),
        (lambda: require_finite(speed=None), "speed must be a number in SI units, got None"),
        (lambda: require_positive(load=[1.0, 0.0]), "load must be positive, got 0"),
        (lambda: require_positive(load=LOADS - 3), "load must be positive, got -2"),
        (lambda: require_between(0, 1, share=1.5), "share must lie in 0 to 1, got 1.5"),
        (lambda: require_between(0, 1, share=[-2, 0.5]), "share must lie in 0 to 1, got -2"),
        (lambda: require_poisson(nu=-1.0), "nu must lie above -1, got -1"),
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


def test_declared_arguments_pass_warn_and_keep_integers():
    assert declared(1, play=-0.5, friction=0, poisson=0.5, angle=np.nan) == (0.5, 3)
    assert type(declared(1.0, cells=4)[1]) is int
    with pytest.warns(UnitWarning, match=r"^play = -66\.7 m is implausible"):
        declared(1.0, play=-66.7)


def test_values_beyond_the_sizes_of_machines_warn_with_name_value_and_unit():
    scales = {name: scale for name, scale in QUANTITIES.items() if scale.unit}
    assert len(scales) == 17
    for name, scale in scales.items():
        warn_of_units(name, quantity=[scale.lowest, scale.highest, 0.0, np.nan, np.inf])
        for value in (2 * scale.highest, scale.lowest / 2 or 2 * scale.highest):
            text = re.escape(f"number = {value:g} {scale.unit}")
            with pytest.warns(UnitWarning, match=text) as caught:
                warn_of_units(name, number=[value, scale.highest])
            assert len(caught) == 1


def test_warning_names_expected_range_and_likely_unit():
    message = r"E_1 = 200 Pa, E_2 = 2\.7 Pa are .*\(300000 to 1e\+13 Pa expected\): in GPa or MPa\?"
    with pytest.warns(UnitWarning, match=message):
        warn_of_units("modulus", E_1=200.0, nothing=0.0, E_2=[2.7, 2e11])


def test_warning_points_at_the_line_outside_the_models():
    from erlif.models.contact import contact_modulus

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warn_of_units("modulus", E=200.0)
        contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
    assert caught[0].filename == __file__
