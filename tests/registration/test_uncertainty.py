"""Standard deviation of a fitted surface: closed forms, and the scatter of repeated fits."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import texture_sums

from erlif.registration.matching import BX, BY
from erlif.registration.selection import Model, moved_to
from erlif.registration.surface import Cells, equations, solve_surface
from erlif.registration.uncertainty import surface_covariance, surface_std

STEP = 8
SHAPE = (64, 80)
BOX = (-0.5, 639.5, -0.5, 511.5)
X, Y = np.linspace(10, 629, 9), np.linspace(10, 501, 7)


def cells_with(scores, *, step=STEP, seed=5):
    """Cells of one texture at no displacement, with these scores (row, column, 2)."""
    shape = scores.shape[:2]
    sums = texture_sums(shape, np.random.default_rng(seed))
    sums[..., [BX, BY]] = scores
    y, x = (np.arange(n) * step + (step - 1) / 2 for n in shape)
    flat = np.zeros(shape)
    return Cells(sums, x, y, flat, flat, np.full(shape, 0.5))


def fit(cells, model):
    surface = solve_surface(equations(cells, model.elements, box=BOX), basis=model.basis)
    covariance = surface_covariance(moved_to(cells, surface), model, BOX)
    return surface.evaluate(X, Y), surface_std(covariance, model, BOX, X, Y)


@pytest.mark.parametrize(
    "model", [Model((1, 1), 1), Model((1, 1), 3), Model((2, 2))], ids=["plane", "cubic", "spline"]
)
def test_standard_deviation_is_the_scatter_of_repeated_fits(model):
    """Independent scores whose noise differs by a factor of four across the field."""
    rng = np.random.default_rng(6)
    size = np.linspace(1, 4, SHAPE[1])[None, :, None] * np.array([1.0, 2.0])
    fields, stds = [], []
    for _ in range(60):
        field, std = fit(cells_with(size * rng.normal(size=(*SHAPE, 2))), model)
        fields.append(field)
        stds.append(std)
    ratio = np.sqrt(np.mean(np.square(stds), axis=0) / np.mean(np.square(fields), axis=(0, 1)))
    # 60 fits of two components know their scatter to 6 % at one point
    assert ratio.min() > 0.8
    assert np.mean(ratio[2:-2, 2:-2]) == pytest.approx(1, abs=0.1)
    # the corners, which the fit follows, have a somewhat large standard deviation
    assert ratio.mean() < 1.2


def test_noise_that_neighbouring_cells_share_widens_the_standard_deviation():
    """The same noise in 2 by 2 cells of 8 px has twice the effect; the blocks of 32 px hold it."""
    rng = np.random.default_rng(7)
    model = Model((1, 1), 2)
    found = {"shared": [], "own": []}
    for _ in range(20):
        coarse = rng.normal(size=(32, 40, 2))
        shared = np.repeat(np.repeat(coarse, 2, axis=0), 2, axis=1)
        found["shared"].append(fit(cells_with(shared), model)[1])
        found["own"].append(fit(cells_with(rng.normal(size=(*SHAPE, 2))), model)[1])
    ratio = np.sqrt(np.mean(np.square(found["shared"])) / np.mean(np.square(found["own"])))
    assert ratio == pytest.approx(2, rel=0.12)


@pytest.mark.parametrize(("component", "variance"), [(0, 4.0), (1, 9.0)])
def test_standard_deviation_is_the_rms_of_both_components(component, variance):
    """Independent coefficients at a knot, where the B-splines are 1/6, 4/6 and 1/6: 1/2 is the sum
    of their squares along an axis, and half the variance of one component that of the mean."""
    model = Model((2, 2))
    covariance = np.zeros((50, 50))
    half = slice(25 * component, 25 * (component + 1))
    covariance[half, half] = variance * np.eye(25)
    knot_x, knot_y = np.array([319.5]), np.array([255.5])
    std = surface_std(covariance, model, BOX, knot_x, knot_y)
    npt.assert_allclose(std, np.sqrt(0.5 * variance) * 0.5, rtol=1e-12)
