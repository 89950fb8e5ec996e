"""Prescribed pressures: both carry the load (Strand, 2005, eqs. 6 and 7)."""

import numpy as np
import numpy.testing as npt
from scipy.integrate import quad

from erlif.models.contact import projected_pressure, sinusoidal_pressure


def test_sinusoidal_pressure_over_half_the_pin_carries_the_load():
    peak = sinusoidal_pressure(3e5, pin_diameter=0.08)
    carried = quad(lambda angle: peak * np.cos(angle) ** 2 * 0.04, -np.pi / 2, np.pi / 2)[0]
    npt.assert_allclose(carried, 3e5, rtol=1e-12)


def test_projected_pressure_over_the_diameter_carries_the_load():
    npt.assert_allclose(projected_pressure(3e5, pin_diameter=0.08) * 0.08, 3e5, rtol=1e-15)
