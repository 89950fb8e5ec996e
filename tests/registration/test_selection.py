"""How fine a surface may be, on cell sums made by hand: known displacement, known noise."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.registration.matching import BX, BY, EE, GXX, GXY, GYY, SUMS, WEIGHT
from erlif.registration.selection import (
    FINE_LADDER,
    Model,
    attainable_gain,
    choose_model,
    disagreement,
    excesses,
    is_unresolved,
    left_over,
    moved_to,
    noise_of_scores,
)
from erlif.registration.surface import Cells, affine_surface, equations, solve_surface

PITCH = 8
BOX = (0.0, 320.0, 0.0, 256.0)


def grid(rows=32, cols=40):
    x, y = (PITCH * np.arange(n) + 3.5 for n in (cols, rows))
    return np.meshgrid(x, y)


def cells_of(dx, dy, *, noise=1.0, seed=0):
    """Cells that ask for the displacement (dx, dy), with scores that scatter by ``noise``.

    The normal matrices are random; the scatter of the scores is theirs, as it is for white noise of
    unit variance, so that all cells have weight 1.
    """
    rng = np.random.default_rng(seed)
    rows, cols = np.shape(dx)
    factor = 0.5 * rng.normal(size=(rows, cols, 2, 2)) + 3 * np.eye(2)
    matrix = 10 * factor @ np.swapaxes(factor, -1, -2)
    scatter = np.linalg.cholesky(matrix) @ rng.normal(size=(rows, cols, 2, 1))
    asked = np.stack([dx, dy], axis=-1)[..., None]
    score = (matrix @ asked + noise * scatter)[..., 0]

    sums = np.zeros((rows, cols, SUMS))
    sums[..., GXX], sums[..., GXY] = matrix[..., 0, 0], matrix[..., 0, 1]
    sums[..., GYY] = matrix[..., 1, 1]
    sums[..., BX], sums[..., BY] = score[..., 0], score[..., 1]
    sums[..., EE], sums[..., WEIGHT] = 1e4, 64
    x, y = grid(rows, cols)
    zero = np.zeros((rows, cols))
    return Cells(sums, x[0], y[:, 0], zero, zero, np.ones((rows, cols)))


def noise_only(seed=0, **options):
    x, _ = grid(**options)
    return cells_of(0 * x, 0 * x, seed=seed)


def test_cells_moved_to_the_true_surface_ask_for_nothing():
    matrix, offset = np.array([[0.01, -0.02], [0.03, 0.005]]), np.array([1.5, -2.0])
    dx, dy = np.tensordot(matrix, grid(), 1) + offset[:, None, None]
    cells = cells_of(dx, dy, noise=0)
    moved = moved_to(cells, affine_surface(BOX, matrix, offset))
    npt.assert_allclose(moved.sums[..., [BX, BY]], 0, atol=1e-8)
    npt.assert_allclose(moved.here_x, dx)
    again = moved_to(moved, affine_surface(BOX, 0 * matrix, 0 * offset))
    npt.assert_allclose(again.sums[..., [BX, BY, EE]], cells.sums[..., [BX, BY, EE]], atol=1e-6)


def test_tiles_without_texture_or_with_one_direction_only_are_left_out():
    cells = noise_only()
    cells.sums[0, :5, [GXX, GXY, GYY]] *= 0.02
    cells.sums[1, :3, GXY] = np.sqrt(cells.sums[1, :3, GXX] * cells.sums[1, :3, GYY])
    assert len(disagreement(cells, 1)) == 32 * 40 - 8
    cells.sums[..., GXX : GYY + 1] = 0
    assert len(disagreement(cells, 1)) == 0


@pytest.mark.parametrize("wavelength", [64.0, 150.0])
def test_a_missed_ripple_is_noticed(wavelength):
    """0.15 px against a standard deviation of a cell of about 0.1 px."""
    x, y = grid()
    ripple = 0.15 * np.sin(2 * np.pi * x / wavelength)
    assert left_over(cells_of(ripple, 0 * x)) > 1
    assert left_over(cells_of(0 * x, 0.15 * np.sin(2 * np.pi * y / wavelength))) > 1


def test_distortion_of_two_cells_shows_in_tiles_of_two():
    """Neighbours that move together reach an excess of 3, five times the limit of 0.6."""
    x, y = grid()
    sign = np.where((x // 16 + y // 16) % 2, 1.0, -1.0)
    cells = cells_of(0.5 * sign, 0 * y, noise=0)
    npt.assert_allclose(left_over(cells), 3 / 0.6, rtol=0.02)


def test_small_frames_and_frames_without_texture_leave_nothing():
    assert left_over(noise_only(rows=4, cols=4)) == 0
    empty = noise_only()
    empty.sums[:] = 0
    assert left_over(empty) == 0


def test_a_displacement_in_all_of_a_tile_has_an_excess_in_proportion_to_its_area():
    """Cells of standard deviation 0.1 px in each component: 0.1 px along x give each 1 in 2."""
    sign = np.random.default_rng(4).choice([-1.0, 1.0], (32, 32)).repeat(4, 0).repeat(4, 1)
    found = [excesses(cells_of(0.1 * sign, 0 * sign, seed=seed))[:2] for seed in range(4)]
    two, four = np.mean([[excess.value for excess in one] for one in found], axis=0)
    npt.assert_allclose((1 + four) / (1 + two), (1 + 16 / 2) / (1 + 4 / 2), rtol=0.1)


@pytest.mark.parametrize(("displacement", "unresolved"), [(0.02, False), (0.12, True)])
def test_windows_are_worth_it_where_the_displacement_left_exceeds_their_noise(
    displacement, unresolved
):
    """Windows of 2 cells have 0.05 px of noise in each component; 32 px squares move as one."""
    x, y = grid(64, 64)
    sign = np.where((x // 32 + y // 32) % 2, 1.0, -1.0)
    cells = cells_of(displacement * sign, -displacement * sign)
    assert left_over(cells) > 1
    assert is_unresolved(cells, window=2 * PITCH) is unresolved


def test_noise_that_reaches_over_cells_counts_as_it_adds_up():
    x, _ = grid()
    rough = cells_of(0 * x, 0 * x)
    pairs = rough.sums[::2, ::2].repeat(2, 0).repeat(2, 1)
    same = Cells(pairs, rough.x, rough.y, rough.here_x, rough.here_y, rough.weight)
    npt.assert_allclose(noise_of_scores(same, 0), 4 * disagreement(rough, 1).mean() / 2, rtol=0.15)


def test_a_ripple_gets_elements_of_its_own_scale():
    """All models are tried: up to two elements a wave of 128 px is missed altogether."""
    x, y = grid()
    k = 2 * np.pi / 128
    ripple = np.sin(k * x) * np.cos(k * y)
    chosen = choose_model(cells_of(ripple, -ripple))
    assert chosen.degree is None
    assert max(chosen.elements) >= 4


def test_a_given_model_is_kept_unless_a_finer_one_gains():
    start = Model((8, 6))
    assert choose_model(noise_only(rows=64, cols=80), FINE_LADDER, start) == start
    x, y = grid(64, 80)
    k = 2 * np.pi / 100
    ripple = 0.6 * np.sin(k * x) * np.cos(k * y)
    found = choose_model(cells_of(ripple, ripple), FINE_LADDER, start)
    assert max(found.elements) > 8


def test_no_surface_gains_more_than_is_attainable():
    """The gain of 22 x 18 elements on a ripple of six cells, from the plane."""
    x, y = grid(64, 80)
    k = 2 * np.pi / 48
    ripple = 0.1 * np.sin(k * x) * np.cos(k * y)
    for amplitude in (0.0, 0.5, 1.0):
        cells = cells_of(amplitude * ripple, -amplitude * ripple)
        left = [
            moved_to(cells, solve_surface(equations(cells, elements)))
            for elements in ((1, 1), (22, 18))
        ]
        gain = (left[0].sums[..., EE] - left[1].sums[..., EE]).sum()
        chance = 2 * (25 * 21 - 16)
        assert gain - chance < attainable_gain(left[0])


def test_a_model_is_not_finer_than_the_cells_support():
    """Each coefficient needs four cells: 8 x 8 of them hold a spline of one element at most."""
    x, y = grid(8, 8)
    wild = 5 * np.sin(x * y)
    assert choose_model(cells_of(wild, wild)).coefficients <= 16
