"""What all contacts share: kinds of arrays, missing and bad values, slips of units."""

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.models.contact import (
    contact_modulus,
    hertz_ellipse,
    winkler_contact,
    winkler_load,
)

STEEL = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)


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
    radius = xr.DataArray([1.0, 4.0], dims="lobe")
    ellipse = hertz_ellipse(load, radius=radius, radius_across=0.5, contact_modulus=STEEL)
    one = hertz_ellipse(1e5, radius=4.0, radius_across=0.5, contact_modulus=STEEL)
    npt.assert_allclose(ellipse.a.transpose("stage", "lobe")[1, 1], one.a)
    npt.assert_allclose(ellipse.pressure.transpose("stage", "lobe")[1, 1], one.pressure)
