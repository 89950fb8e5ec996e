"""Ends of bodies against published exponents and an integral."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad

from erlif.core.errors import ModelError
from erlif.models.edges import edge_exponent, lundberg_profile


@pytest.mark.parametrize("angle", [60, 90, 135])
def test_rigid_edge_of_any_angle_has_one_half(angle):
    npt.assert_allclose(edge_exponent(np.radians(angle), modulus_ratio=np.inf), 0.5, atol=1e-9)


def test_flat_end_of_two_half_planes_has_one_half():
    npt.assert_allclose(edge_exponent(np.pi), 0.5, atol=1e-9)


def test_right_angle_of_equal_material():
    """Dundurs and Lee (1972): 0.226 for a quarter plane on a half plane."""
    npt.assert_allclose(edge_exponent(np.pi / 2), 0.226, atol=5e-4)


def test_acute_edges_of_equal_material_are_not_singular():
    assert edge_exponent(np.radians(60)) == 0.0


def test_exponent_grows_with_the_modulus_of_the_edge():
    ratios = [0.1, 0.3, 1.0, 3.0, 10.0, np.inf]
    found = [edge_exponent(np.pi / 2, modulus_ratio=ratio) for ratio in ratios]
    assert np.all(np.diff(found) > 0)


def test_profile_of_lundberg_is_the_drop_of_a_narrow_strip():
    """Deflection of a strip of even line load q on its axis: q / (pi E*) int ds / |z - s|."""
    length, load, modulus, width = 0.02, 2e4, 110e9, 1e-5

    def deflection(z):
        near = quad(lambda s: 1 / np.hypot(z - s, width), -length / 2, length / 2, points=[z])[0]
        return load / length / (np.pi * modulus) * near

    for z in (0.004, 0.008):
        drop = lundberg_profile(z, load=load, length=length, contact_modulus=modulus)
        npt.assert_allclose(drop, deflection(0.0) - deflection(z), rtol=1e-3)


def test_places_beyond_the_ends_are_refused():
    with pytest.raises(ModelError, match="infinite"):
        lundberg_profile(0.01, load=1.0, length=0.02, contact_modulus=1e11)
    with pytest.raises(ModelError, match="modulus_ratio"):
        edge_exponent(1.0, modulus_ratio=0.0)
