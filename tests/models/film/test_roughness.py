"""The film parameter and its regimes."""

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.models.film import film_parameter, lubrication_regimes


def test_overlapping_regimes_of_the_thesis():
    """Farzaneh (2002), section 2.2.2: one tuple for each element."""
    lambdas = xr.DataArray([0.5, 1.0, 4.0, 7.0, 50.0, 100.0, np.nan], dims="trigger")
    assert lubrication_regimes(lambdas).values.tolist() == [
        ("boundary",),
        ("partial",),
        ("elastohydrodynamic", "partial"),
        ("hydrodynamic", "elastohydrodynamic"),
        ("hydrodynamic",),
        (),
        (),
    ]
    assert lubrication_regimes(1) == ("partial",)


def test_film_parameter_of_the_thesis():  # Farzaneh (2002), eq. 2.7, prints 1.52
    ratio = film_parameter(0.54e-6, roughness_a=0.25e-6, roughness_b=0.25e-6)
    npt.assert_allclose(ratio, 1.527, atol=5e-4)
