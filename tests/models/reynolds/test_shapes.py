"""Gaps of rigid bodies."""

import numpy as np
import numpy.testing as npt

from erlif.models.reynolds.shapes import lobe_shape, pin_shape, roller_shape


def test_parabola_is_the_circle_near_the_contact():
    x = np.linspace(-1e-3, 1e-3, 11)
    npt.assert_allclose(roller_shape(x, radius=0.1), 0.1 - np.sqrt(0.01 - x**2), rtol=1e-4)
    npt.assert_allclose(
        pin_shape(x, 0.0, radius=0.1, cross_radius=0.3), roller_shape(x, radius=0.1)
    )


def test_lobe_of_the_source_ends_where_its_circle_meets_the_bore():
    """Half of the chord of a segment 0.24 mm high on a circle of 200 mm, Farzaneh (2002)."""
    axial = np.linspace(-0.02, 0.02, 40001)
    inside = axial[lobe_shape(axial, centres=[0.0], radius=0.2, height=2.4e-4) < 0]
    npt.assert_allclose(np.ptp(inside), 2 * np.sqrt(0.2**2 - (0.2 - 2.4e-4) ** 2), rtol=1e-3)
