"""What all contacts share: kinds of arrays, missing and bad values, slips of units."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ModelError
from erlif.models.contact import (
    contact_modulus,
    hertz_ellipse,
    impact_force,
    persson_group,
    persson_load,
    relative_radii,
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


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: persson_group(np.pi), "half_angle"),
        (
            lambda: persson_load(2.0, play=1e-4, youngs_modulus=2e11),
            "half_angle must be below 84.8",
        ),
        (
            lambda: hertz_ellipse(1.0, radius=1.0, radius_across=2.0, contact_modulus=1e11),
            "larger reduced radius",
        ),
        (
            lambda: winkler_contact(
                1.0, shaft_radius=0.011, bushing_radius=0.01, thickness=1e-3, modulus=1e9
            ),
            "bushing_radius must exceed shaft_radius",
        ),
        (
            lambda: winkler_load(
                1.6, shaft_radius=0.009, bushing_radius=0.01, thickness=1e-3, modulus=1e9
            ),
            "half_angle must lie in 0 to 1.5708",
        ),
        (
            lambda: relative_radii(0.0, radius_1_across=1.0, radius_2=1.0, radius_2_across=1.0),
            "must not be zero",
        ),
        (
            lambda: impact_force(1.0, rate=1.0, impact_speed=1.0, stiffness=1.0, restitution=1.2),
            "restitution",
        ),
    ],
)
def test_bad_values_are_named(call, named):
    with pytest.raises(ModelError, match=named):
        call()
