"""Flow through the faces of cells."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.reynolds.cells import Faces, Grid, Stencil, average_walls, solve_ring
from erlif.models.reynolds.flow import Fluid

WIDTHS = np.full(6, 2e-3)
OPEN = Grid(8, 1e-3, WIDTHS, False, (True, True, True, True))
CLOSED = Grid(8, 1e-3, WIDTHS * [1, 1, 1, 0.8, 0.5, 0.2], True, (False, False, False, True))
FLUID = Fluid(0.1)
FULL = np.random.default_rng(2).random((8, 6)) > 0.3


def film(grid):
    rng = np.random.default_rng(3)
    return average_walls(1e-5 * (1 + rng.random((grid.along, grid.across))), grid)


def test_flow_between_plates_under_a_linear_pressure():
    """Poiseuille: h^3 / (12 eta) times gradient times width."""
    walls = average_walls(np.full((8, 6), 1e-5), OPEN)
    faces = Faces(OPEN, FLUID, walls, FULL)
    pressure = np.repeat(np.arange(8)[:, np.newaxis] * 1e5, 6, axis=1)
    steps = faces.steps(pressure)
    flow = (1e-5) ** 3 / (12 * 0.1) * (1e5 / 1e-3) * 2e-3
    npt.assert_allclose((faces.along * steps[0])[1:-1], flow)


def test_stencil_holds_the_derivatives_of_the_inflow():
    pressure = np.random.default_rng(4).random((8, 6)) * 1e5
    for grid in (OPEN, CLOSED):
        faces = Faces(grid, FLUID, film(grid), FULL)
        links = faces.stencil()
        rows = links.centre * pressure
        rows += links.previous * np.roll(pressure, 1, axis=0)
        rows += links.following * np.roll(pressure, -1, axis=0)
        rows[:, 1:] += links.lower[:, 1:] * pressure[:, :-1]
        rows[:, :-1] += links.upper[:, :-1] * pressure[:, 1:]
        npt.assert_allclose(rows, faces.inflow(faces.steps(pressure)), atol=1e-22)


def test_parabola_between_two_ends_is_exact():
    """p'' constant, as in a short bearing: mean pressures and flow out of the ends."""
    grid = Grid(2, 1e-3, np.full(4, 0.5e-3), True, (False, False, True, True))
    faces = Faces(grid, FLUID, average_walls(np.full((2, 4), 1e-5), grid), np.ones((2, 4), bool))
    edges = np.linspace(0.0, 2e-3, 5)
    mean = np.diff(edges**2 * (1e-3 - edges / 3)) / 0.5e-3  # of z (2 mm - z)
    inflow = faces.inflow(faces.steps(np.tile(1e9 * mean, (2, 1))))
    npt.assert_allclose(inflow, -2e9 * 1e-15 / 1.2 * 1e-3 * 0.5e-3, rtol=1e-10)


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
