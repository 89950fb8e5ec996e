"""The ring of cells against a dense matrix of the same equations."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.reynolds.band import Stencil, solve_ring


def dense(stencil):
    """The same equations as a full matrix."""
    columns, axial = stencil.centre.shape
    cell = np.arange(columns * axial).reshape(columns, axial)
    matrix = np.zeros((columns * axial,) * 2)
    for i in range(columns):
        for k in range(axial):
            row = cell[i, k]
            matrix[row, row] += stencil.centre[i, k]
            matrix[row, cell[i - 1, k]] += stencil.previous[i, k]
            matrix[row, cell[(i + 1) % columns, k]] += stencil.following[i, k]
            if k > 0:
                matrix[row, cell[i, k - 1]] += stencil.lower[i, k]
            if k < axial - 1:
                matrix[row, cell[i, k + 1]] += stencil.upper[i, k]
    return matrix


@pytest.mark.parametrize("shape", [(8, 3), (6, 1), (10, 2)])
@pytest.mark.parametrize("cut", [None, 0, 3])
def test_ring_is_solved_as_the_full_matrix_is(shape, cut):
    rng = np.random.default_rng(5)
    links = [rng.normal(size=shape) for _ in range(5)]
    links[0] += 6.0
    if cut is not None:
        links[1][cut] = links[2][cut - 1] = 0.0
    stencil = Stencil(*links)
    right = rng.normal(size=(3, *shape))
    wanted = np.linalg.solve(dense(stencil), right.reshape(3, -1).T).T.reshape(right.shape)
    npt.assert_allclose(solve_ring(stencil, right), wanted, atol=1e-12)


def test_closed_film_without_a_known_pressure_is_refused():
    none = np.zeros((8, 1))
    with pytest.raises(ModelError, match="open to a known pressure"):
        solve_ring(Stencil(none, none, none, none, none), np.ones((1, 8, 1)))
