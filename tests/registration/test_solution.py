"""The dense displacement and its camera map: overlap, poor pixels, windows or surface."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.registration import Blobs, inverse, map_views, texture_sums, translation

from erlif.core.errors import RegistrationError
from erlif.registration import MapKind
from erlif.registration.matching import BX, BY, GXX
from erlif.registration.selection import Model, moved_to
from erlif.registration.solution import (
    Solution,
    find_overlap,
    finish_map,
    fits_better,
    solve_local,
    surface_covariance,
    surface_std,
)
from erlif.registration.surface import Cells, equations, solve_surface
from erlif.registration.views import expected_rms

SHAPE = (128, 160)


def even(value, shape=SHAPE):
    return np.full(shape, value, np.float32)


def solution(dx=0.0, dy=0.0, std=0.01, kind=MapKind.LOCAL):
    return Solution(even(dx), even(dy), even(std), kind, "32 px")


def ripple(amplitude, wavelength):
    """A displacement along x that varies along y."""
    return lambda x, y: (amplitude * np.sin(2 * np.pi * y / wavelength), 0 * x)


def views_of(field, *, noise=5.0):
    """One pair of an analytic texture; camera 2 is displaced by a small field."""
    blobs = Blobs(SHAPE, 1.5, np.random.default_rng(2))
    rng = np.random.default_rng(3)
    y, x = np.indices(SHAPE, dtype=float)
    frames = [
        1000 * (1 + 0.15 * blobs(*place)) + rng.normal(0, noise, SHAPE)
        for place in ((x, y), inverse(field, x, y))
    ]
    return map_views([(*frames, None, None)])


def fitted(views, surface, model):
    """Cells on the surface that fits the frames, and that surface."""
    for _ in range(2):
        sums, surface = views.look(surface)
        cells = views.cells(sums, surface, 1.0)
        surface = solve_surface(equations(cells, model.elements), basis=model.basis)
    return moved_to(cells, surface), surface


@pytest.fixture(scope="module")
def still():
    """Cameras that differ by a translation of (0.4, -0.3) px."""
    return views_of(lambda x, y: (0 * x + 0.4, 0 * x - 0.3))


@pytest.mark.parametrize(
    ("dx", "dy", "columns", "rows"),
    [(3, 0, (0, 157), (0, 128)), (-3, 0, (3, 160), (0, 128)), (0, 2.5, (0, 160), (0, 125))],
)
def test_overlap_ends_where_the_point_leaves_camera_2(dx, dy, columns, rows):
    overlap = find_overlap(even(dx), even(dy), even(0), *SHAPE)
    expected = np.zeros(SHAPE, bool)
    expected[slice(*rows), slice(*columns)] = True
    npt.assert_array_equal(overlap, expected)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_displacement_is_given_eight_pixels_beyond_camera_2(axis, sign):
    """For frames that drift; by 12 px, four rows or columns of camera 1 lie further out."""
    fields = [even(0), even(0)]
    fields[1 - axis][:] = sign * 12
    std = even(0.1)
    overlap = find_overlap(*fields, std, *SHAPE)
    unknown = np.isnan(fields[0])
    expected = np.zeros(SHAPE, bool)
    np.moveaxis(expected, axis, 0)[slice(-4, None) if sign > 0 else slice(0, 4)] = True
    npt.assert_array_equal(unknown, expected)
    npt.assert_array_equal(np.isnan(fields[1]), expected)
    npt.assert_array_equal(np.isnan(std), expected)
    assert not overlap[unknown].any()


def test_windows_follow_a_ripple_that_a_plane_misses():
    views = views_of(ripple(0.5, 64.0))
    surface = translation()
    scale = expected_rms(views.look(surface)[0])
    windows = solve_local(views, surface, 1.0, 10 * scale)
    y, x = np.indices(SHAPE, dtype=float)
    inner = (slice(16, -16), slice(16, -16))
    error = (windows.dx - ripple(0.5, 64.0)(x, y)[0])[inner]
    assert np.sqrt(np.mean(error**2)) < 0.12  # the ripple has 0.35
    plane = replace(windows, dx=even(0), dy=even(0))
    assert fits_better(views, windows, plane)
    assert not fits_better(views, plane, windows)


@pytest.fixture(scope="module")
def cells(still):
    return fitted(still, translation(0.4, -0.3), Model((1, 1), 1))[0]


def test_pixels_above_a_quarter_pixel_are_poor(still, cells):
    given = solution()
    given.std[20:30] = 0.26
    given.std[40:50] = 0.24
    npt.assert_array_equal(
        np.unique(np.nonzero(finish_map(given, still, cells, 1).poor)[0]), range(20, 30)
    )


def test_a_map_that_is_mostly_poor_is_refused(still, cells):
    given = solution()
    given.std[:63] = 1.0
    assert finish_map(given, still, cells, 1.0).poor.sum() == 63 * 160
    given.std[:66] = 1.0
    with pytest.raises(RegistrationError, match="52% of their common field is uncertain by"):
        finish_map(given, still, cells, 1.0)


def test_a_surface_is_poor_where_its_cells_ask_for_another_displacement(still, cells):
    """By 0.5 px in one corner; windows, which follow their cells, are not judged by them."""
    asking = replace(cells, sums=cells.sums.copy())
    asking.sums[:7, :7, BX] += 0.5 * asking.sums[:7, :7, GXX]
    surface = finish_map(solution(kind=MapKind.SURFACE), still, asking, 1.0)
    assert surface.poor[8:32, 8:32].all()
    assert not surface.poor[90:, 90:].any()
    assert not finish_map(solution(kind=MapKind.LOCAL), still, asking, 1.0).poor.any()
    assert not finish_map(solution(kind=MapKind.SURFACE), still, cells, 1.0).poor.any()


STEP = 8
SHAPE_OF_UNCERTAINTY = (64, 80)
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
    size = np.linspace(1, 4, SHAPE_OF_UNCERTAINTY[1])[None, :, None] * np.array([1.0, 2.0])
    fields, stds = [], []
    for _ in range(60):
        field, std = fit(cells_with(size * rng.normal(size=(*SHAPE_OF_UNCERTAINTY, 2))), model)
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
        found["own"].append(fit(cells_with(rng.normal(size=(*SHAPE_OF_UNCERTAINTY, 2))), model)[1])
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
