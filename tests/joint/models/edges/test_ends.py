"""Ends of bodies against published exponents and an integral."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from erlif.joint.models.edges import edge_exponent, lundberg_profile


@pytest.mark.parametrize("angle", [60, 90, 135])
def test_rigid_edge_of_any_angle_has_one_half(angle):
    npt.assert_allclose(edge_exponent(np.radians(angle), modulus_ratio=np.inf), 0.5, atol=1e-9)


def test_right_angle_of_equal_material():
    """Dundurs and Lee (1972): 0.226 for a quarter plane on a half plane."""
    npt.assert_allclose(edge_exponent(np.pi / 2), 0.226, atol=5e-4)


@pytest.mark.parametrize(("angle", "ratio"), [(1.8, 0.4), (2.5, 5.0), (1.57, 1.0)])
def test_both_bodies_fit_at_the_exponent(angle, ratio):
    """The stress functions of both wedges, solved as linear systems, have one displacement.

    F = A cos((m + 1) t) + B sin((m + 1) t) + C cos((m - 1) t) + D sin((m - 1) t) with F(0) = 1,
    F'(0) = 0 and a free face at the angle, F = F' = 0; D / E* is the slope of the surface.
    """
    m = 1 - edge_exponent(angle, modulus_ratio=ratio)

    def surface_slope(wedge):
        def row(t):
            plus, minus = (m + 1) * t, (m - 1) * t
            return [np.cos(plus), np.sin(plus), np.cos(minus), np.sin(minus)]

        def slopes(t):
            plus, minus = row(t)[:2], row(t)[2:]
            return [
                -(m + 1) * plus[1], (m + 1) * plus[0], -(m - 1) * minus[1], (m - 1) * minus[0],
            ]  # fmt: skip

        rows = [row(0), slopes(0), row(wedge), slopes(wedge)]
        return np.linalg.solve(rows, [1.0, 0, 0, 0])[3]

    assert 0 < m < 1
    npt.assert_allclose(surface_slope(angle) / ratio, -surface_slope(np.pi), rtol=1e-9)


def test_edges_of_equal_material_are_singular_from_77_degrees():
    """The exponent vanishes where tan a = a + pi, the limit of the equation for m near 1."""
    limit = brentq(lambda a: np.tan(a) - a - np.pi, 1.2, 1.5)
    below, above = edge_exponent([limit - 1e-3, limit + 1e-3])
    assert below == 0
    assert 0 < above < 2e-3


def test_profile_of_lundberg_is_the_drop_of_a_narrow_strip():
    """Deflection of a strip of even line load q on its axis: q / (pi E*) int ds / |z - s|."""
    length, load, modulus, width = 0.02, 2e4, 110e9, 1e-5

    def deflection(z):
        near = quad(lambda s: 1 / np.hypot(z - s, width), -length / 2, length / 2, points=[z])[0]
        return load / length / (np.pi * modulus) * near

    for z in (0.004, 0.008):
        drop = lundberg_profile(z, load=load, length=length, contact_modulus=modulus)
        npt.assert_allclose(drop, deflection(0.0) - deflection(z), rtol=1e-3)
