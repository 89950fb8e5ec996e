"""Flow through the faces of cells."""

import numpy as np
import numpy.testing as npt

from erlif.models.reynolds.cells import Faces, Grid, average_walls
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
