"""Line contact of Hertz: the joints of Farzaneh (2002)."""

import numpy.testing as npt
import pytest

from erlif.models.contact import conformal_radius, contact_modulus, hertz_line

LBF = 4.4482216152605
STEEL = contact_modulus(200e9, poisson_1=0.3, youngs_2=200e9, poisson_2=0.3)
RADIUS = conformal_radius(0.03336, bushing_radius=0.03359)


@pytest.mark.parametrize(
    ("load", "half_width", "pressure"), [(1e5, 10.2932e-3, 116.083e6), (1e4, 3.25498e-3, 36.7087e6)]
)
def test_straight_bushing_of_the_thesis(load, half_width, pressure):  # line contact over 237 mm
    found = hertz_line(load * LBF / 0.237, radius=RADIUS, contact_modulus=STEEL)
    npt.assert_allclose(found, (half_width, pressure), rtol=1e-5)


def test_acrylic_joint_at_50_lbf():  # the optical test of Farzaneh (2002), section 5.2
    acrylic = contact_modulus(2.7e9, poisson_1=0.37, youngs_2=2.7e9, poisson_2=0.37)
    half_width, pressure = hertz_line(50 * LBF / 0.237, radius=RADIUS, contact_modulus=acrylic)
    npt.assert_allclose(half_width, 1.93e-3, atol=5e-6)
    npt.assert_allclose(pressure, 0.31e6, atol=5e3)
