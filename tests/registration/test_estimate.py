"""Registration against analytic scenes whose displacement is known exactly."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scenes.registration import Scene, drifting_frames, expose, smooth_map, vector_rms

from erlif.core.errors import RegistrationError
from erlif.registration import (
    MapKind,
    RegistrationSettings,
    orient,
    register,
    register_frames,
    warp,
)
from erlif.registration.coarse import find_start
from erlif.registration.estimate import (
    align_small,
    check_correlation,
    choose_solution,
    fit_surface,
    measure_drift,
    start_with_any,
)
from erlif.registration.matching import AA, AB, BB, SUMS, WEIGHT
from erlif.registration.pairs import open_frames
from erlif.registration.selection import Model
from erlif.registration.settings import ORIENTATIONS
from erlif.registration.surface import affine_surface, equations, solve_surface
from erlif.registration.views import Views

SHAPE = (256, 320)


@pytest.fixture(scope="module")
def views():
    return Scene(SHAPE, 1).photograph(smooth_map(SHAPE))


@pytest.fixture(scope="module")
def camera_map(views):
    return register(views.reference, views.moving)


def within_one_std(found, truth):
    inside = truth.inside()
    errors = np.concatenate(
        [(found.displacement_x - truth.dx)[inside], (found.displacement_y - truth.dy)[inside]]
    )
    return np.abs(errors) < np.tile(found.displacement_std[inside], 2)


# the map ------------------------------------------------------------------------------------------


def test_a_smooth_map_is_found_within_hundredths_of_a_pixel(views, camera_map):
    assert vector_rms(camera_map, views) < 0.03
    assert camera_map.kind is MapKind.SURFACE
    assert not camera_map.poor[camera_map.overlap].any()
    assert 0.8 < camera_map.quality < 1


def test_error_bars_are_of_the_size_of_the_error(views, camera_map):
    inside = views.inside()
    announced = np.sqrt(2 * np.mean(camera_map.displacement_std[inside] ** 2))
    assert 0.4 < vector_rms(camera_map, views) / announced < 2.5


def test_overlap_is_where_camera_2_sees_the_point(views, camera_map):
    h, w = SHAPE
    y, x = np.mgrid[:h, :w]
    seen = (
        (x + views.dx >= 0)
        & (x + views.dx <= w - 1)
        & (y + views.dy >= 0)
        & (y + views.dy <= h - 1)
    )
    assert (camera_map.overlap != seen).mean() < 1e-3  # pixels whose point falls on the very edge
    assert np.isfinite(camera_map.displacement_x[camera_map.overlap]).all()


def test_nothing_is_extrapolated_far_beyond_camera_2():
    truth = Scene(SHAPE, 2).photograph(smooth_map(SHAPE, offset=(60.0, 0.0)))
    found = register(truth.reference, truth.moving)
    assert np.isnan(found.displacement_x[:, -40:]).all()
    assert np.isnan(found.displacement_std[:, -40:]).all()
    assert not found.overlap[:, -40:].any()


def test_the_map_lays_camera_2_over_camera_1(views, camera_map):
    """The sign and the frame of the displacement, without using the known map."""
    moved = warp(views.clean_moving, camera_map.displacement_x, camera_map.displacement_y)
    inside = np.isfinite(moved) & views.inside()
    ratio = np.log(moved / views.clean_reference)[inside]
    shifted = np.log(views.clean_moving / views.clean_reference)[inside]
    assert ratio.std() < 0.3  # what is left is the ratio field and the texture of camera 2 alone
    assert shifted.std() > 1.1 * ratio.std()


@pytest.mark.parametrize("shape", [(128, 128), (130, 203), (300, 160)])
def test_small_and_odd_frames_work(shape):
    truth = Scene(shape, 3).photograph(smooth_map(shape, cubic=0.1, quadratic=0.1))
    assert vector_rms(register(truth.reference, truth.moving), truth) < 0.1


def test_undistorted_frames_give_nothing_to_correct(views):
    found = register(views.reference, views.reference)
    npt.assert_allclose(found.displacement_x, 0, atol=1e-3)
    npt.assert_allclose(found.displacement_y, 0, atol=1e-3)


def test_camera_gain_and_dark_corrected_types_change_nothing(views, camera_map):
    other = register(
        views.reference.astype(np.float32) * 0.25, views.moving.astype(np.float64) * 3.0
    )
    npt.assert_allclose(other.displacement_x, camera_map.displacement_x, atol=2e-3)


def test_the_number_of_threads_changes_nothing(views, camera_map):
    for threads in (1, 3):
        other = register(
            views.reference, views.moving, settings=RegistrationSettings(threads=threads)
        )
        npt.assert_array_equal(other.displacement_x, camera_map.displacement_x)
        npt.assert_array_equal(other.displacement_std, camera_map.displacement_std)


def test_masked_pixels_do_not_count(views, camera_map):
    rng = np.random.default_rng(6)
    frames, weights = [], []
    for image in (views.reference, views.moving):
        bad = rng.uniform(size=image.shape) < 0.01
        bad[100:140, 60:110] = True  # a drop on the window
        frames.append(np.where(bad, 4095, image).astype(np.uint16))
        weights.append((~bad).astype(np.float32))
    found = register(*frames, weight_reference=weights[0], weight_moving=weights[1])
    assert vector_rms(found, views) < 0.05

    # the drop is at one place on both sensors and pulls the map towards no displacement
    blind = register(*frames)
    assert vector_rms(found, views) < vector_rms(blind, views)


def test_dust_on_one_camera_is_recognised():
    rng = np.random.default_rng(7)
    truth = Scene((384, 448), 4).photograph(smooth_map((384, 448)))
    y, x = np.mgrid[:384, :448]
    frames = []
    for image in (truth.reference, truth.moving):
        shade = np.ones(image.shape)
        for _ in range(25):
            cx, cy, r = rng.uniform(0, 448), rng.uniform(0, 384), rng.uniform(2, 9)
            shade = np.where(
                (x - cx) ** 2 + (y - cy) ** 2 < r * r, rng.choice([0.25, 0.5, 1.6]), shade
            )
        frames.append((image * shade).astype(np.float32))
    assert vector_rms(register(*frames), truth) < 0.05


def ripple(shape, amplitude, wavelength):
    smooth = smooth_map(shape)

    def field(x, y):
        dx, dy = smooth(x, y)
        k = 2 * np.pi / wavelength
        return dx + amplitude * np.sin(k * x + 0.3) * np.cos(0.8 * k * y), dy + amplitude * np.cos(
            k * y + 1
        ) * np.sin(0.9 * k * x)

    return field


def test_local_distortion_is_followed():
    shape = (384, 512)
    truth = Scene(shape, 5).photograph(ripple(shape, 0.3, 130.0))
    found = register(truth.reference, truth.moving)
    assert vector_rms(found, truth) < 0.1  # the ripple alone has 0.2
    windows = register(truth.reference, truth.moving, settings=RegistrationSettings(model="local"))
    assert windows.model == "local windows, 32 px"
    assert vector_rms(windows, truth) < 0.1
    assert 0.55 < within_one_std(windows, truth).mean() < 0.78  # 0.68 if normal


def test_distortion_that_no_surface_resolves_falls_back_to_windows():
    shape = (384, 512)
    truth = Scene(shape, 8, private=0.0, contrast=0.25).photograph(ripple(shape, 0.6, 55.0))
    found = register(truth.reference, truth.moving)
    assert found.kind is MapKind.LOCAL
    assert vector_rms(found, truth) < 0.25  # the ripple alone has 0.42


def test_waves_that_grow_finer_across_the_field_are_followed_by_windows():
    """A star: no surface has elements for all of it; over 64 px its finest waves average out."""
    shape = (384, 512)

    def star(x, y):
        return 0 * x, 0.5 * np.cos(2 * np.pi * (y - 190) / (25 + 0.1 * x))

    truth = Scene(shape, 4, private=0.0).photograph(star)
    found = register(truth.reference, truth.moving)
    assert found.kind is MapKind.LOCAL
    broad = (slice(32, -32), slice(330, -32))  # periods of 58 px and more
    assert np.sqrt(np.mean((found.displacement_y - truth.dy)[broad] ** 2)) < 0.07


# uncertainty --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_two_thirds_of_the_errors_lie_within_one_standard_deviation():
    textures = ({}, {"private": 0.0}, {"contrast": 0.04, "private": 0.0})
    hits = []
    for texture in textures:
        for seed in range(20):
            truth = Scene(SHAPE, 100 + seed, **texture).photograph(smooth_map(SHAPE))
            hits.append(within_one_std(register(truth.reference, truth.moving), truth).mean())
    assert 0.63 < np.mean(hits) < 0.73


# many frames --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run():
    return drifting_frames(SHAPE, 16)


def test_many_weak_frames_give_one_map_and_the_drift_of_each(run):
    frames, drift, dx, dy = run
    found, measured = register_frames(frames)
    error = np.hypot(found.displacement_x - dx, found.displacement_y - dy)[16:-16, 16:-16]
    assert np.sqrt(np.nanmean(error**2)) < 0.02
    assert np.sqrt(np.mean((measured - drift) ** 2)) < 0.03
    npt.assert_allclose(measured.mean(0), 0, atol=1e-9)


def test_frames_may_come_from_a_callable_and_are_not_kept(run):
    frames, *_ = run
    alive: list[weakref.ref[np.ndarray]] = []
    most = 0

    def read():
        nonlocal most
        for reference, moving, *weights in frames[:5]:
            copy = reference.copy()
            alive.append(weakref.ref(copy))
            gc.collect()
            most = max(most, sum(ref() is not None for ref in alive))
            yield copy, moving, *weights
            del copy

    once, drift = register_frames(read)
    again, same = register_frames(frames[:5])
    npt.assert_array_equal(once.displacement_x, again.displacement_x)
    npt.assert_array_equal(drift, same)
    assert most <= 3  # the first pair, the one before, this one


def test_a_misfired_pulse_has_no_drift_and_does_no_harm(run):
    frames, *_ = run
    rng = np.random.default_rng(12)
    blank = tuple(expose(np.full(SHAPE, 300.0), rng) for _ in range(2))
    found, drift = register_frames([(*blank, None, None), *frames[:6]])
    alone, expected = register_frames(frames[:6])
    assert np.isnan(drift[0]).all()
    npt.assert_allclose(drift[1:], expected, atol=0.01)
    npt.assert_allclose(found.displacement_x, alone.displacement_x, atol=0.01)


def test_only_so_many_frames_make_the_map_but_all_get_a_drift(run):
    frames, drift, *_ = run
    _, measured = register_frames(frames, settings=RegistrationSettings(frames_for_map=4))
    assert measured.shape == drift.shape
    assert np.sqrt(np.mean((measured - drift) ** 2)) < 0.03


# loud failure -------------------------------------------------------------------------------------


@pytest.mark.parametrize("orientation", ORIENTATIONS[1:])
def test_a_turned_camera_is_recognised_and_the_advice_works(views, camera_map, orientation):
    back = {"rotated_90": "rotated_270", "rotated_270": "rotated_90"}.get(orientation, orientation)
    mounted = np.ascontiguousarray(orient(views.moving, back))
    with pytest.raises(RegistrationError, match=f'orientation = "{orientation}"'):
        register(views.reference, mounted)
    found = register(
        views.reference, mounted, settings=RegistrationSettings(orientation=orientation)
    )
    npt.assert_array_equal(found.displacement_x, camera_map.displacement_x)


def test_frames_without_common_texture_are_refused():
    shape = (96, 112)
    one, other = (Scene(shape, seed).photograph(smooth_map(shape)) for seed in (1, 78))
    with pytest.raises(RegistrationError, match="No common texture"):
        register(one.reference, other.moving)
    rng = np.random.default_rng(13)
    light = Scene(shape, 79, contrast=0.0, private=0.0, scratches=0).photograph(smooth_map(shape))
    with pytest.raises(RegistrationError, match="No common texture"):
        register(light.reference, expose(light.clean_moving, rng))


def test_a_dark_camera_is_named(views):
    with pytest.raises(RegistrationError, match="camera 2 is both lit and sound"):
        register(views.reference, np.zeros(SHAPE, np.uint16))
    with pytest.raises(RegistrationError, match="camera 1 is both lit and sound"):
        register(views.reference, views.moving, weight_reference=np.zeros(SHAPE, np.float32))


def test_wrong_arrays_are_refused(views):
    with pytest.raises(RegistrationError, match="grey images"):
        register(views.reference[:40, :40], views.moving)
    with pytest.raises(RegistrationError, match="weight of camera 2"):
        register(views.reference, views.moving, weight_moving=np.ones((3, 3)))
    with pytest.raises(RegistrationError, match="at least one pair"):
        register_frames([])


# the steps ----------------------------------------------------------------------------------------


def frames_of(*pairs, **chosen):
    return open_frames([(*pair, None, None) for pair in pairs], RegistrationSettings(**chosen))


def first_of(frames):
    return next(iter(frames.pick([0])))


def surface_error(surface, truth):
    """Rms length of the error of a surface over the inner field. [px]"""
    dx, dy = surface.on_pixels(truth.dx.shape)
    return np.sqrt(np.mean(((dx - truth.dx) ** 2 + (dy - truth.dy) ** 2)[truth.inside()]))


@pytest.mark.parametrize("shape", [(128, 160), SHAPE, (416, 512)])
def test_small_frames_give_a_cubic_surface_to_a_tenth_of_a_pixel(shape):
    """From the coarse affine map, which the distortion of half a pixel does not fit."""
    truth = Scene(shape, 5).photograph(smooth_map(shape))
    pair = first_of(frames_of((truth.reference, truth.moving)))
    start = find_start(pair.reference, pair.moving, None, None, RegistrationSettings())
    box = (0.0, float(shape[1]), 0.0, float(shape[0]))
    found = align_small(pair, start, RegistrationSettings())
    assert found.box == box
    assert surface_error(found, truth) < 0.1
    affine = affine_surface(box, start.matrix, start.offset)
    assert surface_error(found, truth) < 0.7 * surface_error(affine, truth)


def test_a_blank_first_frame_leaves_the_start_to_the_next(views):
    blank = np.full(SHAPE, 300, np.uint16)
    frames = frames_of((blank, blank), (views.reference, views.moving))
    begun = start_with_any(frames)
    assert begun.number == 1
    npt.assert_array_equal(begun.pair.reference, views.reference)
    assert surface_error(begun.surface, views) < 0.1


def test_the_error_of_the_first_frame_is_raised_if_none_of_four_can_be_aligned(views):
    """The dark camera 2 of the first frame, not the dark camera 1 of the others."""
    dark = np.zeros(SHAPE, np.uint16)
    frames = frames_of(
        (views.reference, dark), *[(dark, views.moving)] * 3, (views.reference, views.moving)
    )
    with pytest.raises(RegistrationError, match="camera 2 is both lit"):
        start_with_any(frames)


def sums_of(product, cells=400, seed=1):
    """Cell sums whose texture products scatter by 1 about a mean."""
    sums = np.zeros((20, cells // 20, SUMS))
    rng = np.random.default_rng(seed)
    sums[..., AB] = product + rng.standard_normal(sums.shape[:2])
    sums[..., WEIGHT], sums[..., AA], sums[..., BB] = 64, 4, 1
    return sums


def test_products_eight_standard_errors_above_zero_are_common_texture():
    """400 cells: the standard error is 1/20, the limit 0.4."""
    common = sums_of(0.5)
    npt.assert_allclose(check_correlation(common), common[..., AB].mean() / np.sqrt(4 * 1))
    for product in (0.3, 0.0, -2.0):
        with pytest.raises(RegistrationError, match="no more than chance gives"):
            check_correlation(sums_of(product))


@pytest.mark.parametrize("cells", [0, 15])
def test_a_few_cells_are_no_evidence(cells):
    sums = sums_of(100.0)
    sums.reshape(-1, SUMS)[cells:, WEIGHT] = 0
    with pytest.raises(RegistrationError, match="No common texture"):
        check_correlation(sums)


def fit_of(truth, **chosen):
    frames = frames_of((truth.reference, truth.moving), **chosen)
    begun = start_with_any(frames)
    views = Views(frames, begun.pair, frames.settings, number=begun.number)
    return views, fit_surface(views, begun.surface)


@pytest.mark.parametrize("whiten", [True, False])
def test_the_fit_has_a_cubic_for_a_cubic_distortion(views, whiten):
    _, fit = fit_of(views, whiten=whiten)
    assert fit.model == Model((1, 1), 3)
    assert not fit.unresolved
    assert surface_error(fit.surface, views) < 0.03
    assert fit.quality > 0.8
    assert fit.slope > 1
    here_x, _ = fit.surface.evaluate(fit.cells.x, fit.cells.y)
    npt.assert_allclose(fit.cells.here_x, here_x)


def test_whitening_lowers_the_error_where_camera_2_has_texture_of_its_own():
    shape = (192, 224)
    errors = []
    for seed in range(4):
        truth = Scene(shape, 60 + seed, private=0.08).photograph(smooth_map(shape))
        errors.append(
            [surface_error(fit_of(truth, whiten=on)[1].surface, truth) for on in (True, False)]
        )
    with_filter, without = np.sqrt(np.mean(np.square(errors), axis=0))
    assert with_filter < 0.8 * without


@pytest.mark.parametrize(
    ("model", "unresolved", "kind"),
    [
        ("auto", False, MapKind.SURFACE),
        ("auto", True, MapKind.LOCAL),
        ("surface", True, MapKind.SURFACE),
        ("local", False, MapKind.LOCAL),
    ],
)
def test_the_settings_choose_between_surface_and_windows(views, model, unresolved, kind):
    """Left to choose, windows are taken where the surface leaves distortion."""
    seen, fit = fit_of(views, model=model)
    assert choose_solution(seen, replace(fit, unresolved=unresolved)).kind is kind


def test_a_fine_surface_is_kept_if_windows_leave_no_less(views):
    seen, fit = fit_of(views)
    fine = replace(fit, model=Model((16, 12)))
    cells, surface = fit.cells, solve_surface(equations(fit.cells, (16, 12)))
    fine = replace(fine, surface=surface, cells=cells)
    assert choose_solution(seen, fine).kind is MapKind.SURFACE


def test_drift_is_measured_against_the_map(views, camera_map):
    """Frames moved by whole pixels; a blank one has none."""
    moved = [np.roll(views.moving, shift, (0, 1)) for shift in ((0, 0), (2, -1), (-3, 4))]
    blank = np.random.default_rng(3).integers(290, 310, SHAPE).astype(np.uint16)
    frames = frames_of(*[(views.reference, image) for image in moved], (blank, blank))
    drift = measure_drift(frames, camera_map)
    npt.assert_allclose(drift[:3], [(0, 0), (-1, 2), (4, -3)], atol=0.02)


# property -----------------------------------------------------------------------------------------

_SCENES = {
    name: Scene(SHAPE, 20 + number, scratches=0, **texture)
    for number, (name, texture) in enumerate(
        {
            "wall": {},
            "weak": {"contrast": 0.05, "private": 0.0},
            "fine": {"sigma": 0.9},
            "broad": {"sigma": 2.5},
        }.items()
    )
}


@pytest.mark.slow
@settings(
    max_examples=70, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
@given(
    st.sampled_from(sorted(_SCENES)),
    st.tuples(st.floats(-80, 80), st.floats(-64, 64)),
    st.floats(-5, 5),
    st.floats(0.95, 1.05),
    st.floats(-0.6, 0.6),
    st.floats(-0.6, 0.6),
)
def test_any_admissible_map_is_found_or_refused(texture, offset, rotation, scale, cubic, quadratic):
    field = smooth_map(
        SHAPE, offset=offset, rotation=rotation, scale=scale, cubic=cubic, quadratic=quadratic
    )
    truth = _SCENES[texture].photograph(field)
    try:
        found = register(truth.reference, truth.moving)
    except RegistrationError:
        return
    assert vector_rms(found, truth, truth.inside() & found.overlap) < 0.1
