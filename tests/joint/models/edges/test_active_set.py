"""The search for the pressure, against a quadratic programme solved by another library."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.optimize import nnls

from erlif.core.errors import ModelError
from erlif.joint.models.edges.active_set import solve_active_set


@pytest.fixture
def problem():
    """A positive matrix and a gap of which about half closes."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(30, 30))
    return root @ root.T / 30 + np.eye(30), rng.random(30) * 2


def test_given_motion_against_nonnegative_least_squares(problem):
    """min p K p / 2 + p (gap - d), p >= 0, is a least-squares problem in the root of K."""
    matrix, gap = problem
    root = np.linalg.cholesky(matrix).T
    expected, _ = nnls(root, np.linalg.solve(root.T, 1.0 - gap))
    found = solve_active_set(
        lambda p: matrix @ p, gap, diagonal=np.diag(matrix), modes=np.ones((1, 30)),
        motion=np.array([1.0]), tolerance=1e-10,
    )  # fmt: skip
    assert 0 < np.count_nonzero(expected) < 30
    npt.assert_allclose(found.pressure, expected, atol=1e-8)


def test_cells_of_any_size_carry_forces_in_equilibrium(problem):
    """The forces of the cells, area times pressure, minimise the same energy."""
    matrix, gap = problem
    area = np.logspace(-2, 1, 30)
    root = np.linalg.cholesky(matrix).T
    forces, _ = nnls(root, np.linalg.solve(root.T, 1.0 - gap))
    found = solve_active_set(
        lambda p: matrix @ (area * p), gap, diagonal=np.diag(matrix) * area, area=area,
        modes=np.ones((1, 30)), targets=[forces.sum()], tolerance=1e-10,
    )  # fmt: skip
    npt.assert_allclose(area * found.pressure, forces, atol=1e-7)
    npt.assert_allclose(found.motion, 1.0, rtol=1e-7)


def test_a_matrix_that_pulls_is_refused(problem):
    with pytest.raises(ModelError, match="not positive"):
        solve_active_set(
            lambda p: -p, np.linspace(0, 1, 5), diagonal=1.0, modes=np.ones((1, 5)), targets=[1.0]
        )


def test_too_few_iterations_are_reported(problem, monkeypatch):
    matrix, gap = problem
    case = {"diagonal": 1.0, "modes": np.ones((1, 30)), "targets": [2.0], "tolerance": 1e-12}
    monkeypatch.setattr("erlif.joint.models.edges.active_set.MOST_ITERATIONS", 2)
    with pytest.raises(ModelError, match="has not settled after 2 iterations"):
        solve_active_set(lambda p: matrix @ p, gap, **case)


def test_a_contact_that_begins_in_one_cell_spreads():
    """Every cell but the highest leaves the contact at first; the load then needs more of them."""
    gap = np.full(9, 1.0)
    gap[4] = 0.0
    found = solve_active_set(
        lambda p: p, gap, diagonal=1.0, modes=np.ones((1, 9)), targets=[10.0], tolerance=1e-12
    )
    npt.assert_allclose(found.pressure, np.where(gap > 0, 1.0, 2.0))
