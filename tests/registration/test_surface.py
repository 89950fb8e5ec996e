"""Spline surfaces: against scipy's splines, polynomials and dense least squares."""

import numpy as np
import numpy.testing as npt
import pytest
from scipy.interpolate import BSpline

from erlif.registration.matching import BX, BY, EE, GXX, GXY, GYY, SUMS, WEIGHT
from erlif.registration.surface import (
    Cells,
    Surface,
    affine_surface,
    cell_weights,
    degree_basis,
    equations,
    solve_surface,
    spline_weights,
)

BOX = (-4.0, 156.0, 2.0, 98.0)
X, Y = np.linspace(0, 150, 16), np.linspace(4, 94, 10)


def basis_functions(start, stop, elements):
    """The cubic B-splines on equidistant knots, as scipy evaluates them."""
    width = (stop - start) / elements
    knots = start + width * np.arange(-3, elements + 4)
    return BSpline(knots, np.eye(elements + 3), 3, extrapolate=True)


def field_of(box, seed=1, elements=(3, 2)):
    nx, ny = elements
    rng = np.random.default_rng(seed)
    return Surface(box, rng.normal(size=(2, ny + 3, nx + 3)))


def make_cells(surface, *, here=(0.0, 0.0), shape=(12, 20), step=8, seed=2, noise=0.0):
    """Cell sums of a scene with that displacement and random gradients, summed at ``here``."""
    rng = np.random.default_rng(seed)
    y, x = (np.arange(n) * step + (step - 1) / 2 for n in shape)
    dx, dy = surface.evaluate(x, y)
    sums = np.zeros((*shape, SUMS))
    gx, gy = rng.normal(size=(2, 30, *shape))
    sums[..., GXX], sums[..., GYY] = (gx * gx).sum(0), (gy * gy).sum(0)
    sums[..., GXY] = (gx * gy).sum(0)
    # the score of residuals of that standard deviation
    e = noise * rng.normal(size=gx.shape)
    rest_x, rest_y = dx - here[0], dy - here[1]
    sums[..., BX] = sums[..., GXX] * rest_x + sums[..., GXY] * rest_y + (gx * e).sum(0)
    sums[..., BY] = sums[..., GXY] * rest_x + sums[..., GYY] * rest_y + (gy * e).sum(0)
    weight = rng.uniform(0.5, 2, shape)
    level = np.ones(shape)
    return Cells(sums, x, y, here[0] * level, here[1] * level, weight)


@pytest.mark.parametrize("elements", [1, 2, 5])
def test_design_is_the_b_spline_basis_of_scipy(elements):
    """Beyond the interval the outer elements are continued as polynomials."""
    places = np.linspace(-44, 199, 301)
    found = spline_weights(places, -4.0, 156.0, elements)
    npt.assert_allclose(
        found, basis_functions(-4.0, 156.0, elements)(places), rtol=1e-9, atol=1e-12
    )


@pytest.mark.parametrize("binning", [1, 2, 4])
def test_binned_pixels_have_the_displacement_at_their_centre(binning):
    surface = field_of(BOX)
    shape = (100 // binning, 163 // binning)
    found = surface.on_pixels(shape, binning=binning)
    y, x = (binning * np.arange(n) + (binning - 1) / 2 for n in shape)
    for plane, truth in zip(found, surface.evaluate(x, y), strict=True):
        assert plane.dtype == np.float32
        npt.assert_allclose(plane, truth / binning, atol=1e-5)


def test_affine_surface_is_exact_inside_and_outside_its_box():
    surface = affine_surface(BOX, np.array([[0.01, -0.02], [0.03, -0.04]]), np.array([5.0, -6.0]))
    assert surface.elements == (1, 1)
    x, y = np.linspace(-50, 250, 13), np.linspace(-40, 160, 11)
    dx, dy = surface.evaluate(x, y)
    npt.assert_allclose(dx, 0.01 * x - 0.02 * y[:, None] + 5, atol=1e-12)
    npt.assert_allclose(dy, 0.03 * x - 0.04 * y[:, None] - 6, atol=1e-12)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_basis_of_a_degree_holds_its_polynomials_only(degree):
    basis = degree_basis(degree)
    assert basis.shape == (16, (degree + 1) * (degree + 2) // 2)
    npt.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-12)
    # coefficients of x^i y^j on the unit square, by interpolation
    t = np.linspace(0, 1, 4)
    matrix = np.kron(spline_weights(t, 0, 1, 1), spline_weights(t, 0, 1, 1))
    for j, i in np.ndindex(4, 4):
        values = np.outer(t**j, t**i).ravel()
        coefficients = np.linalg.solve(matrix, values)
        left = coefficients - basis @ (basis.T @ coefficients)
        assert (np.abs(left).max() < 1e-10) == (i + j <= degree)


def test_weight_is_the_reciprocal_of_the_larger_variance():
    """Residuals of variance 2 everywhere, but one cell of variance 20 and one of 0.02."""
    sums = np.zeros((8, 9, SUMS))
    sums[..., WEIGHT] = 64
    sums[..., EE] = 128
    sums[2, 2, EE], sums[5, 6, EE] = 1280, 1.28
    weight = cell_weights(sums)
    npt.assert_allclose(weight[0, 7], 1 / 2)
    npt.assert_allclose(weight[2, 2], 1 / 20)
    npt.assert_allclose(weight[2, 3], 9 / (8 * 2 + 20))  # its surroundings hold the bad cell
    npt.assert_allclose(weight[5, 6], 9 / (8 * 2 + 0.02))  # not 50: it may match by chance
    npt.assert_allclose(weight[5, 7], 1 / 2)  # its own exceeds that of its surroundings


def test_normal_equations_are_those_of_dense_least_squares():
    surface = field_of(BOX, elements=(2, 3))
    cells = make_cells(surface, here=(0.4, -0.7), noise=0.5)
    cells.weight[3:5, 7:11] = 0
    system = equations(cells, (2, 3), box=BOX)
    across = basis_functions(BOX[0], BOX[1], 2)(cells.x)
    down = basis_functions(BOX[2], BOX[3], 3)(cells.y)
    phi = np.einsum("rj,ci->rcji", down, across).reshape(12, 20, -1)
    p = phi.shape[-1]
    matrix, right = np.zeros((2 * p, 2 * p)), np.zeros(2 * p)
    for r, c in np.ndindex(12, 20):
        g = cells.sums[r, c]
        normal = np.array([[g[GXX], g[GXY]], [g[GXY], g[GYY]]])
        score = np.array([g[BX], g[BY]]) + normal @ [0.4, -0.7]
        matrix += cells.weight[r, c] * np.kron(normal, np.outer(phi[r, c], phi[r, c]))
        right += cells.weight[r, c] * np.kron(score, phi[r, c])
    npt.assert_allclose(system.matrix, matrix, atol=1e-9 * np.abs(matrix).max())
    npt.assert_allclose(system.right, right, atol=1e-9 * np.abs(right).max())


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_polynomial_is_found_in_its_own_space(degree):
    """A surface that is a polynomial of that degree: the restricted fit is exact and smoother."""
    basis = degree_basis(degree)
    rng = np.random.default_rng(4)
    coefficients = (rng.normal(size=(2, basis.shape[1])) @ basis.T).reshape(2, 4, 4)
    surface = Surface(BOX, coefficients)
    exact = solve_surface(equations(make_cells(surface), (1, 1), box=BOX), basis=basis)
    npt.assert_allclose(exact.coefficients, coefficients, atol=1e-5)

    system = equations(make_cells(surface, noise=3.0), (1, 1), box=BOX)
    errors = [
        np.abs(np.subtract(found.evaluate(X, Y), surface.evaluate(X, Y))).mean()
        for found in (solve_surface(system, basis=basis), solve_surface(system))
    ]
    assert errors[0] < 0.9 * errors[1]


def test_coefficients_without_data_fall_back_to_the_plane_of_the_start():
    """Half of the frame is dark; the sums of the other half stand at a plane that fits."""
    plane = affine_surface(BOX, np.array([[0.02, 0.0], [0.01, -0.03]]), np.array([1.0, 2.0]))
    cells = make_cells(plane)
    here_x, here_y = plane.evaluate(cells.x, cells.y)
    cells.weight[:, 8:] = 0
    cells.sums[..., [BX, BY]] = 0
    there = Cells(cells.sums, cells.x, cells.y, here_x, here_y, cells.weight)
    found = solve_surface(equations(there, (6, 4), box=BOX))
    for component, truth in zip(found.evaluate(X, Y), plane.evaluate(X, Y), strict=True):
        npt.assert_allclose(component, truth, atol=1e-4)
