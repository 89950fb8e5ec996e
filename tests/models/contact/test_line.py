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
