"""Winkler's bushing: the chart of Colbert et al. (2009), inverses, limits."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scipy.integrate import quad

from erlif.models.contact import winkler_contact, winkler_load, winkler_modulus

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


def test_winkler_inverts_and_scales():
    fit, half_angle = np.geomspace(1.0, 1000.0, 41)[:, None], np.linspace(0.01, 1.5, 50)
    case = {"shaft_radius": 0.01, "bushing_radius": 0.01 * (1 + 1 / fit), "thickness": 0.003}
    load = winkler_load(half_angle, **case, modulus=1e9)
    found = winkler_contact(load, **case, modulus=1e9)
    npt.assert_allclose(found.half_angle, 0 * fit + half_angle, rtol=1e-5)
    assert np.all((found.torque_ratio >= 1) & (found.torque_ratio <= np.pi / 2))
    npt.assert_allclose(winkler_load(half_angle, **case, modulus=5e8), load / 2)


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
