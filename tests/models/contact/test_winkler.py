"""Winkler's bushing: the chart of Colbert et al. (2009), inverses, limits."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import quad
from scipy.optimize import brentq

from erlif.models.contact import winkler_contact, winkler_load, winkler_modulus
from erlif.models.contact.winkler import rubbed_by_arc, supported_by_arc

# groups of lengths and moduli near 1, or radii beyond those of machines, are no slips of units
DIMENSIONLESS = pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")

WINKLER = [  # Colbert et al. (2009), B1 to B10: Rs/c, F* t*, mu*
    (30, 1e-3, 1.013255),
    (100, 1e-3, 1.027534),
    (100, 1e-2, 1.106521),
    (300, 1e-3, 1.053614),
    (1000, 1e-3, 1.104256),
    (1000, 1e-2, 1.227618),
]


@DIMENSIONLESS
@pytest.mark.parametrize(("fit", "group", "ratio"), WINKLER)
def test_winkler_chart(fit, group, ratio):
    shaft = fit / (1 + fit)
    found = winkler_contact(
        group, shaft_radius=shaft, bushing_radius=1.0, thickness=1.0, modulus=1.0
    )
    npt.assert_allclose(found.torque_ratio, ratio, rtol=1e-6)

    def pressure(theta):  # eq. B1 from the eccentricity that was found
        return (
            shaft
            - np.sqrt(1 - found.eccentricity**2 * np.sin(theta) ** 2)
            + found.eccentricity * np.cos(theta)
        )

    npt.assert_allclose(pressure(found.half_angle), 0, atol=1e-12)
    npt.assert_allclose(pressure(0.0), found.pressure, rtol=1e-9)
    arc = (-found.half_angle, found.half_angle)
    carried = quad(lambda t: pressure(t) * np.cos(t) * shaft, *arc, epsrel=1e-10)[0]
    rubbed = quad(lambda t: pressure(t) * shaft, *arc, epsrel=1e-10)[0]
    npt.assert_allclose(carried, group, rtol=1e-7)
    npt.assert_allclose(rubbed / carried, ratio, rtol=1e-6)


@DIMENSIONLESS
def test_winkler_model_ends_at_a_wrap_of_90_degrees():
    case = {"shaft_radius": 1000 / 1001, "bushing_radius": 1.0, "thickness": 1.0, "modulus": 1.0}
    npt.assert_allclose(winkler_load(np.pi / 2, **case), 0.0688, atol=5e-5)


def test_winkler_modulus_is_the_confined_one():
    """Colbert et al. (2009), B3: the constrained modulus lambda + 2 mu."""
    E, nu = 1.1e9, 0.46
    lame, shear = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    npt.assert_allclose(winkler_modulus(E, poisson=nu), lame + 2 * shear)


def test_coordinates_of_several_arguments_cross():
    load = xr.DataArray([1e4, 1e5, 2e5], dims="stage")
    shaft = xr.DataArray([0.0098, 0.01], dims="fit")
    case = {"bushing_radius": 0.0102, "thickness": 0.01, "modulus": 1e12}
    crossed = winkler_contact(load, shaft_radius=shaft, **case)
    assert crossed.torque_ratio.dims == ("stage", "fit")
    alone = winkler_contact(2e5, shaft_radius=0.0098, **case)
    for name in ("half_angle", "eccentricity", "pressure", "torque_ratio"):
        npt.assert_allclose(getattr(crossed, name)[2, 0], getattr(alone, name))
    back = winkler_load(crossed.half_angle, shaft_radius=shaft, **case)
    npt.assert_allclose(
        back.transpose("stage", "fit"), np.broadcast_to(load.values[:, None], (3, 2)), rtol=1e-6
    )


CASES = [(0.3, 0.99), (0.9, 0.9), (1.2, 0.5), (np.pi / 2, 0.3), (np.pi / 2, 0.999)]


def indentation(angle, eccentricity, fit):
    """Of the shaft, over the bushing radius; Colbert et al. (2009), B6."""
    return fit - np.sqrt(1 - (eccentricity * np.sin(angle)) ** 2) + eccentricity * np.cos(angle)


@pytest.mark.parametrize(("half_angle", "fit"), CASES)
def test_integrals_are_those_of_the_indentation(half_angle, fit):
    e = brentq(lambda trial: indentation(half_angle, trial, fit), 0.0, 1.0, xtol=1e-15)
    options = {"epsabs": 0, "epsrel": 1e-12}
    for found, weight in ((supported_by_arc, np.cos), (rubbed_by_arc, np.ones_like)):

        def weighed(angle, weight=weight):
            return indentation(angle, e, fit) * weight(angle)

        true = 2 * fit * quad(weighed, 0, half_angle, **options)[0]
        npt.assert_allclose(found(np.array([half_angle]), fit=np.array([fit])), true, rtol=1e-9)


@pytest.mark.parametrize("clearance", [1e-6, 1e-3, 0.1])
def test_narrow_arcs_have_the_parabola_of_hertz(clearance):
    """For a narrow arc the indentation is e (A^2 - t^2)(1 - e)/2 with e = 1 - fit."""
    half_angle = 1e-4
    fit, e = 1 - clearance, clearance
    both = 2 * fit * e * (1 - e) * half_angle**3 / 3
    for found in (supported_by_arc, rubbed_by_arc):
        npt.assert_allclose(found(np.array([half_angle]), fit=np.array([fit])), both, rtol=2e-8)


def test_contacts_are_found_again():
    rng = np.random.default_rng(0)
    half_angle = rng.uniform(1e-3, np.pi / 2, 10**5)
    shaft = 0.01 * (1 - 10 ** rng.uniform(-6, -0.3, half_angle.size))
    case = {"shaft_radius": shaft, "bushing_radius": 0.01, "thickness": 1e-3, "modulus": 1e9}
    load = winkler_load(half_angle, **case)
    found = winkler_contact(load, **case)
    npt.assert_allclose(found.half_angle, half_angle, rtol=1e-12)
    assert np.all((found.torque_ratio >= 1) & (found.torque_ratio <= np.pi / 2))
    npt.assert_allclose(winkler_load(half_angle, **case | {"modulus": 5e8}), load / 2)
