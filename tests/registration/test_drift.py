"""The drift of single frames and the check of a stored map, on scenes of known displacement."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from scenes.pair import map_with
from scenes.registration import Scene, drifting_frames, expose, smooth_map, texture_sums
from scipy.ndimage import gaussian_filter

from erlif.core.errors import RegistrationError
from erlif.registration import check_map, estimate_drift, orient
from erlif.registration.drift import FARTHEST, DriftSearch, fold_quarters, shift_std, whole_pixels
from erlif.registration.matching import (
    AA,
    AB,
    BB,
    BX,
    BY,
    GXX,
    GXY,
    GYY,
    SUMS,
    WEIGHT,
    beyond_chance,
    coefficients_of,
)
from erlif.registration.pairs import Textures

SHAPE = (160, 192)


def known_map(truth, **settings):
    return map_with(
        truth.dx, truth.dy, truth.dx.shape, overlap=truth.inside(0), threads=1, **settings
    )


@pytest.fixture(scope="module")
def truth():
    return Scene(SHAPE, 1).photograph(smooth_map(SHAPE))


@pytest.fixture(scope="module")
def run():
    """Four weak frame pairs of one map, and the map itself."""
    frames, _, dx, dy = drifting_frames(SHAPE, 4, contrast=0.08)
    return frames, map_with(dx, dy, SHAPE)


def test_error_of_the_drift_agrees_with_its_standard_deviation():
    """Over scenes: part of the error belongs to the texture and is the same in all exposures."""
    pull = []
    for seed in range(12):
        shape = (416, 448) if seed < 2 else SHAPE  # large frames are binned
        truth = Scene(shape, 200 + seed).photograph(smooth_map(shape, offset=(1.3, -0.6)))
        found = estimate_drift(known_map(truth), truth.reference, truth.moving)
        pull += [found.dx / found.std_dx, found.dy / found.std_dy]
    assert 0.6 < np.sqrt(np.mean(np.square(pull))) < 1.4  # 24 values know their rms to 14 %


def test_drift_scatters_no_less_than_the_bound_and_little_more():
    """The Cramer-Rao variance of two noisy samplings of one scene is 1 / sum(g^2 / (v1 + v2))."""
    truth = Scene(SHAPE, 9, private=0.0, scratches=0).photograph(
        smooth_map(SHAPE, offset=(1.3, -0.6))
    )
    rng = np.random.default_rng(10)
    shots = [
        estimate_drift(
            known_map(truth), expose(truth.clean_reference, rng), expose(truth.clean_moving, rng)
        ).dx
        for _ in range(60)
    ]
    gradient = np.gradient(np.log(truth.clean_reference), axis=1)
    # 4 electrons per count, 8 electrons of read noise, rounding
    v1 = (truth.clean_reference / 4 + 4 + 1 / 12) / truth.clean_reference**2
    v2 = (truth.clean_moving / 4 + 4 + 1 / 12) / truth.clean_moving**2
    bound = 1 / np.sqrt((gradient**2 / (v1 + v2)).sum())
    assert 0.8 < np.std(shots, ddof=1) / bound < 1.6  # 60 shots know their scatter to 9 %


def test_orientation_of_the_map_is_applied_to_camera_2(truth):
    mounted = np.ascontiguousarray(orient(truth.moving, "mirrored_x"))
    found = estimate_drift(
        known_map(truth, orientation="mirrored_x"), truth.reference, np.roll(mounted, 3, axis=1)
    )
    npt.assert_allclose((found.dx, found.dy), (-3, 0), atol=0.03)  # mirrored like the image


def test_pixels_without_weight_do_not_move_the_drift(truth):
    """A drop that stays in place on both windows pulls the drift towards the map's displacement."""
    moved = np.roll(truth.moving, (2, 3), (0, 1))
    drop = np.zeros(SHAPE, bool)
    drop[40:120, 60:130] = True
    rng = np.random.default_rng(3)
    pattern = rng.integers(100, 4000, SHAPE)
    frames = [
        np.where(drop, pattern, image).astype(np.uint16) for image in (truth.reference, moved)
    ]
    weight = (~drop).astype(np.float32)
    found = estimate_drift(known_map(truth), *frames, weight_reference=weight, weight_moving=weight)
    npt.assert_allclose((found.dx, found.dy), (3, 2), atol=0.05)


def test_frame_that_does_not_fit_is_refused(truth):
    camera_map = known_map(truth)
    stranger = Scene(SHAPE, 77).photograph(smooth_map(SHAPE))
    with pytest.raises(RegistrationError, match="does not fit the camera map"):
        estimate_drift(camera_map, truth.reference, stranger.moving)
    with pytest.raises(RegistrationError, match=r"made for frames of \(160, 192\).* \(120, 192\)"):
        estimate_drift(camera_map, truth.reference[:120], truth.moving[:120])


def test_map_of_a_turned_camera_is_refused(run):
    """Camera 2 has turned by half a degree since: up to 0.8 px at the edges."""
    frames, camera_map = run
    y, x = np.indices(SHAPE)
    turn = np.radians(0.5)
    dx, dy = camera_map.displacement_x, camera_map.displacement_y
    turned = map_with(dx - turn * (y - 79.5), dy + turn * (x - 95.5), SHAPE)
    with pytest.raises(RegistrationError, match=r"fits no longer: \d\d% .* more than 0\.1 px"):
        check_map(turned, frames)


def test_drift_does_not_depend_on_where_the_search_begins():
    """Maps that are wrong by up to 1.7 px leave the same displacement in all."""
    shape = (416, 448)
    truth = Scene(shape, 12).photograph(smooth_map(shape))
    total = []
    for offset in (0.0, 0.6, 1.1, 1.7):
        short = known_map(replace(truth, dx=truth.dx - offset))
        found = estimate_drift(short, truth.reference, truth.moving)
        total.append((found.dx - offset, found.dy))
    npt.assert_allclose(total, [total[0]] * 4, atol=2e-4)


@pytest.mark.parametrize("move", [(0, 0), (3, -5), (-FARTHEST, FARTHEST)])
def test_whole_pixels_are_found_in_the_sum_of_the_quarters(move):
    """Noise of twice the texture: a correlation of 0.45 over a quarter of the pixels."""
    rng = np.random.default_rng(14)
    wall = rng.normal(size=(241, 262))
    dx, dy = move
    a = wall[10:-10, 10:-10]
    b = wall[10 - dy : 231 - dy, 10 - dx : 252 - dx]
    b = (b + 2 * rng.normal(size=b.shape)).astype(np.float32)
    b[:30, 7] = np.nan
    folded = fold_quarters(a.astype(np.float32)), fold_quarters(b)
    assert folded[0].shape == folded[1].shape == (110, 121)
    npt.assert_array_equal(whole_pixels(*folded), move)


def test_opposite_edges_of_the_frame_are_kept_apart():
    """A bright point at each edge is no translation by 3 px; a faint one has moved by 1."""
    left, right, first, second = np.zeros((4, 64, 64), np.float32)
    left[3, 1] = right[3, 62] = 1.0
    left[30, 30] = right[30, 31] = 0.5
    first[20, 61] = second[20, 63] = 1.0  # the last columns count too
    for a, b, move in ((left, right, 1), (first, second, 2)):
        npt.assert_array_equal(whole_pixels(a, b), (move, 0))
        npt.assert_array_equal(whole_pixels(a.T, b.T), (0, move))


def test_mean_coefficient_of_seven_standard_errors_is_beyond_chance():
    rng = np.random.default_rng(6)
    scatter = rng.normal(size=400)
    scatter = 0.1 * (scatter - scatter.mean()) / scatter.std()
    assert beyond_chance(scatter + 0.7 / 20, 6)
    assert not beyond_chance(scatter + 0.5 / 20, 6)
    assert not beyond_chance(scatter - 0.7 / 20, 6)
    assert not beyond_chance(np.ones(15), 6)


def test_common_texture_is_recognised_beside_a_few_outshining_cells():
    """The rim of a bubble in 2 % of the cells hides the rest from a mean product of textures."""
    rng = np.random.default_rng(7)
    sums = np.zeros((20, 20, SUMS))
    sums[..., WEIGHT], sums[..., AA], sums[..., BB] = 256, 1, 1
    sums[..., AB] = 0.3 + 0.3 * rng.uniform(-1, 1, (20, 20))
    sums[0, :8, [AA, BB]], sums[0, :8, AB] = 100, -60.0
    assert sums[..., AB].mean() < 0
    assert beyond_chance(coefficients_of(sums), 6)
    sums[..., [AA, AB]] = 0.0  # no texture at all
    assert not beyond_chance(coefficients_of(sums), 6)


@pytest.mark.parametrize("contrast", [1.0, 8.0], ids=["even", "strong in a fifth of the field"])
def test_textures_of_two_scenes_are_never_common(contrast):
    """Of 200 pairs of scenes, laid over each other where they agree best."""
    rng = np.random.default_rng(9)
    weight, level = np.ones((96, 128), np.float32), np.ones((96, 128), np.float32)
    level[:, :26] = contrast
    flat = np.zeros((96, 128), np.float32)
    search = DriftSearch.of(flat, flat)
    found = []
    for _ in range(200):
        a, b = (gaussian_filter(rng.normal(size=(96, 128)), 1.2) for _ in range(2))
        a, b = (np.asarray(one / one.std() * level, np.float32) for one in (a, b))
        found.append(search.find(Textures(a, weight, b, weight)).dx)
    assert np.isnan(found).all()


def test_standard_deviation_of_a_translation_is_its_scatter():
    """Sums of cells with known gradient products, and scores drawn with an unequal noise."""
    rng = np.random.default_rng(8)
    cells = (20, 30)
    sums = texture_sums(cells, rng)
    noise = rng.uniform(0.2, 3, cells)
    matrix = sums[..., [GXX, GXY, GXY, GYY]].sum((0, 1)).reshape(2, 2)
    found, shifts = [], []
    for _ in range(300):
        sums[..., BX] = noise * rng.normal(size=cells)
        sums[..., BY] = 2 * noise * rng.normal(size=cells)
        found.append(shift_std(sums))
        shifts.append(np.linalg.solve(matrix, sums[..., [BX, BY]].sum((0, 1))))
    # 300 draws know a standard deviation to 4 %
    npt.assert_allclose(np.mean(found, axis=0), np.std(shifts, axis=0), rtol=0.13)


def test_standard_deviation_is_not_known_without_gradients_in_two_directions():
    sums = np.zeros((4, 5, SUMS))
    assert np.isnan(shift_std(sums)).all()
    sums[..., GXX] = 1.0
    assert np.isnan(shift_std(sums)).all()
