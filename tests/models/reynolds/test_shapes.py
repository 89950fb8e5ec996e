"""Gaps of rigid bodies."""

import numpy as np
import numpy.testing as npt

from erlif.models.reynolds.shapes import lobe_shape, pin_shape, relief_shape, roller_shape


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


def test_relief_has_its_depth_at_the_ends_and_the_radius_of_its_parabola():
    z = np.linspace(-0.05, 0.05, 100_001)
    shape = relief_shape(z, length=0.1, edge=0.01, depth=2e-5)
    npt.assert_allclose(shape[[0, -1]], 2e-5, rtol=1e-12)
    assert not shape[np.abs(z) < 0.04].any()
    bend = np.gradient(np.gradient(shape, z), z)
    npt.assert_allclose(bend[z > 0.041][:-3], 2 * 2e-5 / 0.01**2, rtol=1e-4)
