"""Stresses below the surface against the closed forms of Hertz's contacts."""

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.models.edges import subsurface_stress


def hertz_pressure(count=64):
    """The exact pressure of a circular contact of unit radius, averaged over cells."""
    fine = (np.arange(8 * count) - (8 * count - 1) / 2) * 2.3 / (8 * count)
    values = np.sqrt(np.maximum(1 - fine[:, None] ** 2 - fine**2, 0))
    cells = values.reshape(count, 8, count, 8).mean((1, 3))
    x = fine.reshape(count, 8).mean(1)
    return xr.Dataset({"pressure": (("x", "z"), cells)}, {"x": x, "z": x})


def test_stress_on_the_axis_of_a_round_contact():
    """Johnson (1985), eqs. 3.45: closed forms on the axis."""
    contact = hertz_pressure(65)
    depth = np.linspace(0.1, 2.0, 20)
    found = subsurface_stress(contact, depth=depth, poisson=0.3).sel(x=0, z=0, method="nearest")
    along = -1 / (1 + depth**2)
    across = -1.3 * (1 - depth * np.arctan(1 / depth)) + 0.5 / (1 + depth**2)
    npt.assert_allclose(found.stress_yy, along, atol=5e-4)
    npt.assert_allclose(found.stress_xx, across, atol=5e-4)
    npt.assert_allclose(found.stress_zz, across, atol=5e-4)
    npt.assert_allclose(found.von_mises, across - along, atol=1e-3)


def test_each_depth_carries_the_load():
    """A narrow contact on a wide grid: the stress along the depth sums to the load."""
    pressure = np.zeros((161, 161))
    pressure[78:83, 78:83] = 1.0
    axis = np.arange(161.0) - 80
    contact = xr.Dataset({"pressure": (("x", "z"), pressure)}, {"x": axis, "z": axis})
    found = subsurface_stress(contact, depth=3.0)
    npt.assert_allclose(-found.stress_yy.sum(), 25.0, rtol=2e-3)


def test_far_stress_is_that_of_boussinesq():
    """s_yy = -3 F y^3 / (2 pi r^5) and the other components, Johnson (1985), eqs. 3.19."""
    pressure = np.zeros((41, 41))
    pressure[20, 20] = 1.0
    axis = (np.arange(41) - 20) * 0.1
    contact = xr.Dataset({"pressure": (("x", "z"), pressure)}, {"x": axis, "z": axis})
    nu, force, depth = 0.25, 0.01, 1.5
    found = subsurface_stress(contact, depth=depth, poisson=nu).isel(depth=0)
    x, z, y = axis[:, None], axis[None, :], depth
    r = np.sqrt(x**2 + z**2 + y**2)
    flat = x**2 + z**2
    unit = force / (2 * np.pi)
    npt.assert_allclose(found.stress_yy, unit * -3 * y**3 / r**5, atol=1e-5)
    npt.assert_allclose(found.stress_xy, unit * -3 * x * y**2 / r**5, atol=1e-5)
    npt.assert_allclose(found.stress_zy, unit * -3 * z * y**2 / r**5, atol=1e-5)
    total = found.stress_xx + found.stress_zz + found.stress_yy
    npt.assert_allclose(total, unit * -2 * (1 + nu) * y / r**3, atol=1e-5)
    far = np.where(flat > 0, flat, np.nan)
    radial = (1 - 2 * nu) / far
    xx = radial * ((1 - y / r) * (x**2 - z**2) / far + y * z**2 / r**3) - 3 * y * x**2 / r**5
    xz = radial * ((1 - y / r) * 2 * x * z / far - x * y * z / r**3) - 3 * x * y * z / r**5
    known = flat > 0
    npt.assert_allclose(found.stress_xx.to_numpy()[known], (unit * xx)[known], atol=1e-5)
    npt.assert_allclose(found.stress_xz.to_numpy()[known], (unit * xz)[known], atol=1e-5)
