"""Loads and stresses of a model in another material."""

import numpy as np
import numpy.testing as npt

from erlif.models.contact import persson_contact, scale_load, scale_stress


def test_scaling_of_the_acrylic_joint():  # Farzaneh (2002), section 5.2: modulus 1/75 of steel
    down = {"youngs_modulus": 75 * 2.7e9, "model_youngs_modulus": 2.7e9}
    up = {"youngs_modulus": 2.7e9, "model_youngs_modulus": 75 * 2.7e9}
    npt.assert_allclose(scale_load(100e3, **down), 1333, atol=0.5)
    npt.assert_allclose(scale_load(50.0, **up), 3750)
    npt.assert_allclose(scale_stress(7.5e6, **down), 1e5)


def test_scaled_loads_strain_alike():
    """Farzaneh (2002), eq. 3.13, checked with Persson's contact."""
    stiffer, larger = np.geomspace(0.01, 100, 21)[:, None], np.geomspace(0.01, 100, 20)
    load = scale_load(
        1e5, youngs_modulus=1e11, model_youngs_modulus=1e11 * stiffer, length_ratio=larger
    )
    full = persson_contact(1e5 / 0.2, play=4e-4, pin_diameter=0.07, youngs_modulus=1e11)
    model = persson_contact(
        load / (0.2 * larger),
        play=4e-4 * larger,
        pin_diameter=0.07 * larger,
        youngs_modulus=1e11 * stiffer,
    )
    npt.assert_allclose(model[0], np.full((21, 20), full[0]), rtol=1e-9)
    npt.assert_allclose(
        model[1],
        scale_stress(full[1], youngs_modulus=1e11, model_youngs_modulus=1e11 * stiffer)
        + 0 * larger,
        rtol=1e-9,
    )
