"""Bound of the error of an extrapolation, against runs with far smaller factors."""

from dataclasses import replace
from functools import cache

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ModelError
from erlif.models.contact import winkler_modulus
from erlif.models.mechanism import SliderCrank
from erlif.models.reaction import SliderCrankBodies
from erlif.models.slider.extrapolation import bound_extrapolation
from erlif.models.slider_wear import WearingJoint, wear_slider_crank

LINKAGE = SliderCrank(crank=0.0762, coupler=0.2032, clearance=10e-6)
BODIES = SliderCrankBodies(
    rod_mass=0.8175,
    rod_inertia=5500e-6,
    slider_mass=5.5487,
    spring_stiffness=525.4,
    spring_preload=47.248,
    friction=0.15,
    pin_radius=9.525e-3,
)
PTFE = WearingJoint(
    width=8.551e-3,
    thickness=3e-3,
    modulus=winkler_modulus(0.139e9, poisson=0.38),
    specific_wear=5.05e-13,
)
LOOSE = {"linkage": replace(LINKAGE, clearance=1e-4), "joint": replace(PTFE, thickness=1e-3)}


@pytest.mark.parametrize(
    ("changes", "first_order"),
    [
        ({}, True),
        (LOOSE | {"bodies": replace(BODIES, spring_preload=0.0, friction=0.0)}, False),
        (LOOSE | {"bodies": replace(BODIES, spring_preload=0.0)}, False),
        ({"joint": replace(PTFE, pin_specific_wear=5.05e-13)}, True),
    ],
    ids=["test 1", "loose", "loose with friction", "pin as bushing"],
)
def test_error_is_within_its_bound(changes, first_order):
    """Against the limit of two factors that are 4 and 2 times smaller than the smallest one."""
    case = {"crank_speed": np.pi, "bodies": BODIES, "joint": PTFE, "cycles": 32_000} | changes

    @cache
    def wear(factor):
        return wear_slider_crank(
            case.get("linkage", LINKAGE),
            **{name: value for name, value in case.items() if name != "linkage"},
            extrapolation=factor,
            steps_per_cycle=24,
            cells=90,
        )

    found = bound_extrapolation(4000, wear=wear)
    fine = 2 * wear(250).isel(cycle=-1) - wear(500).isel(cycle=-1)
    for name in ("worn_volume", "greatest_depth"):
        error = abs(found[name] - fine[name])
        assert np.all(np.diff(error) < 0)
        assert np.all(error <= found[f"{name}_bound"])
        assert np.all(found[f"{name}_bound"] < 0.03 * fine[name])
    orders = np.array([found.worn_volume_order, found.greatest_depth_order])
    assert np.all(abs(orders - 1) <= 0.05) == first_order


def test_bound_is_cautious_without_an_order():
    def wear(factor):
        value = ("cycle", [0.0, {8: 1.0, 4: 2.0, 2: 1.5}[factor]])
        return xr.Dataset({"worn_volume": value, "greatest_depth": value})

    found = bound_extrapolation(8, wear=wear)
    assert np.isnan(found.worn_volume_order)
    npt.assert_allclose(found.worn_volume_bound, [3 * 0.5, 3 * 1.0, 3 * 0.5])
    with pytest.raises(ModelError, match="halvings must be 2 or more"):
        bound_extrapolation(2, wear=wear)


@pytest.mark.parametrize(("order", "factor"), [(1.0, 1.25), (1.04, 1.25), (0.9, 3.0), (1.1, 3.0)])
def test_factor_is_that_of_the_observed_order(order, factor):
    """Roache (1994, 2011): 1.25 with an order as expected, within 5 %, else 3."""

    def wear(step):
        value = ("cycle", [0.0, 1.0 + 1e-3 * (step / 4) ** order])
        return xr.Dataset({"worn_volume": value, "greatest_depth": value})

    found = bound_extrapolation(4, wear=wear)
    npt.assert_allclose(found.worn_volume_order, order)
    last = found.worn_volume[1] - found.worn_volume[2]
    npt.assert_allclose(found.worn_volume_bound[-1], factor * last)
