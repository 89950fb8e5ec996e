"""Influence coefficients against integrals, and the convolution against the sum."""

import numpy as np
import numpy.testing as npt
from scipy.integrate import dblquad

from erlif.joint.models.edges.influence import (
    Convolution,
    displacement_of_cells,
    displacement_of_strips,
)


def test_displacement_is_the_integral_of_boussinesq():
    """u = int p / (pi E* r) over a cell."""
    found = displacement_of_cells((4, 3), (0.5, 0.8), 2.0)
    assert found.shape == (7, 5)
    for i, j in ((1, 1), (3, 0), (2, 2)):
        far, _ = dblquad(
            lambda z, x: 1 / np.hypot(x, z),
            (i - 0.5) * 0.5, (i + 0.5) * 0.5, (j - 0.5) * 0.8, (j + 0.5) * 0.8,
        )  # fmt: skip
        npt.assert_allclose(found[3 + i, 2 + j], far / (2 * np.pi), rtol=1e-6)
    # a square under even pressure, in its middle: 4 a ln(1 + sqrt 2) / pi E*, Johnson (1985), 3.27
    square = displacement_of_cells((1, 1), (1.0, 1.0), 1.0)
    npt.assert_allclose(square[0, 0], 4 * np.log(1 + np.sqrt(2)) / np.pi, rtol=1e-12)


def test_rows_of_cells_are_a_strip():
    """A long row of cells deflects like a strip, up to a constant."""
    rows = displacement_of_cells((6, 4000), (1.0, 1.0), 1.0)[5:].sum(axis=1)
    strip = displacement_of_strips(6, 1.0, 1.0)[5:]
    npt.assert_allclose(rows - rows[0], strip - strip[0], rtol=1e-5)


def test_convolution_is_the_sum_over_cells():
    pressure = np.random.default_rng(1).random((5, 4))
    influence = displacement_of_cells((5, 4), (1.0, 0.7), 1.0)
    total = np.zeros((5, 4))
    for i in range(5):
        for j in range(4):
            total[i, j] = sum(
                influence[4 + i - k, 3 + j - m] * pressure[k, m] for k in range(5) for m in range(4)
            )
    npt.assert_allclose(Convolution.of(influence)(pressure), total, rtol=1e-12)
