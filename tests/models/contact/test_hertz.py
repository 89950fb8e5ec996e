"""Contacts of Hertz: the joints of Farzaneh (2002), limits, integrals."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.special import ellipe, ellipk

from erlif.models.contact import (
    conformal_radius,
    contact_modulus,
    hertz_ellipse,
    hertz_line,
    relative_radii,
    thesis_ellipse,
)

STEEL = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
RADIUS = conformal_radius(0.03336, bushing_radius=0.03359)
LOBE = relative_radii(-0.03359, radius_1_across=0.2, radius_2=0.03336, radius_2_across=np.inf)

# groups of lengths and moduli near 1, or radii beyond those of machines, are no slips of units
DIMENSIONLESS = pytest.mark.filterwarnings("ignore::erlif.core.errors.UnitWarning")


@pytest.mark.parametrize(
    ("load", "half_width", "pressure"), [(1e5, 10.2932e-3, 116.083e6), (1e4, 3.25498e-3, 36.7087e6)]
)
def test_straight_bushing_of_the_thesis(load, half_width, pressure):  # line contact over 237 mm
    found = hertz_line(load * 4.4482216152605 / 0.237, radius=RADIUS, contact_modulus=STEEL)
    npt.assert_allclose(found, (half_width, pressure), rtol=1e-5)


@pytest.mark.parametrize(
    ("form", "pressure", "a", "b", "approach"),
    [
        (thesis_ellipse, 1023.84, 29.523, 3.5132, 0.116734),
        (hertz_ellipse, 1019.31, 28.541, 3.6502, 0.116911),
    ],
)
def test_lobed_bushing_of_the_thesis(form, pressure, a, b, approach):
    """Farzaneh (2002), eqs. B.7 to B.11, and the exact integrals."""
    found = form(222.41e3, radius=LOBE[0], radius_across=LOBE[1], contact_modulus=STEEL)
    npt.assert_allclose(found.pressure / 1e6, pressure, rtol=1e-5)
    npt.assert_allclose([found.a * 1e3, found.b * 1e3], [a, b], rtol=2e-5)
    npt.assert_allclose(found.approach * 1e3, approach, rtol=1e-5)


@DIMENSIONLESS
def test_elliptical_contact_solves_hertz():
    """Classical form with complete elliptic integrals; load under the semi-ellipsoid."""
    ratio, radius = np.geomspace(1.0, 1e4, 201)[:, None], np.geomspace(1e-3, 10.0, 10)
    load, modulus = 100.0, 1e11
    found = hertz_ellipse(
        load, radius=radius, radius_across=radius / ratio, contact_modulus=modulus
    )
    shares = 2 / 3 * np.pi * found.a * found.b * found.pressure / load
    npt.assert_allclose(shares, 1.0, rtol=1e-9)

    a, b, pressure = found.a[1:], found.b[1:], found.pressure[1:]  # K - E cancels in a circle
    m = 1 - (b / a) ** 2
    K, E = ellipk(m), ellipe(m)
    radii = ((a / b) ** 2 * E - K) / (K - E)
    npt.assert_allclose(radii, ratio[1:] + 0 * radius, rtol=1e-6)
    # Johnson (1985), 4.26: 1/(2 R'') = p0 b [(a/b)^2 E - K] / (E* e^2 a^2)
    across = pressure * b / (modulus * m * a**2) * ((a / b) ** 2 * E - K)
    npt.assert_allclose(across, ratio[1:] / (2 * radius), rtol=1e-6)
    npt.assert_allclose(found.approach[1:], pressure * b * K / modulus, rtol=1e-6)


def test_relative_radii_turn_with_the_bodies():  # Farzaneh (2002), eqs. B.3 and B.4
    # crossed cylinders touch like a sphere
    straight = {"radius_1_across": np.inf, "radius_2": 0.1, "radius_2_across": np.inf}
    npt.assert_allclose(relative_radii(0.1, **straight, angle=np.pi / 2), (0.1, 0.1))
    npt.assert_allclose(LOBE, (RADIUS, 0.2))
    turned = [
        relative_radii(0.1, radius_1_across=0.3, radius_2=0.2, radius_2_across=0.5, angle=t)
        for t in (0.3, -0.3)
    ]
    assert turned[0] == turned[1]
    # the sum of the curvatures does not depend on the angle
    npt.assert_allclose(sum(1 / r for r in turned[0]), 1 / 0.1 + 1 / 0.3 + 1 / 0.2 + 1 / 0.5)
