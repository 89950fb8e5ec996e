"""Registration against analytic scenes whose displacement is known exactly."""

import weakref

import numpy as np
import numpy.testing as npt
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scenes.registration import Scene, drifting_frames, expose, smooth_map, vector_rms

from erlif.core.errors import RegistrationError
from erlif.registration import MapKind, RegistrationSettings, register, register_frames
from erlif.registration.estimate import (
    check_correlation,
    choose_solution,
    fit_surface,
    start_with_any,
)
from erlif.registration.matching import AA, AB, BB, SUMS, WEIGHT
from erlif.registration.pairs import open_series
from erlif.registration.selection import Model
from erlif.registration.surface import equations, solve_surface
from erlif.registration.views import TextureViews

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


def test_a_smooth_map_is_found_within_hundredths_of_a_pixel(views, camera_map):
    assert vector_rms(camera_map, views) < 0.03
    assert camera_map.kind is MapKind.SURFACE
    assert not camera_map.poor[camera_map.overlap].any()
    assert 0.8 < camera_map.quality < 1


@pytest.mark.parametrize("shape", [(128, 128), (130, 203), (300, 160)])
def test_small_and_odd_frames_work(shape):
    truth = Scene(shape, 3).photograph(smooth_map(shape, cubic=0.1, quadratic=0.1))
    assert vector_rms(register(truth.reference, truth.moving), truth) < 0.1


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


def test_local_distortion_is_followed():
    shape = (384, 512)

    def ripple(x, y):
        (dx, dy), k = smooth_map(shape)(x, y), 2 * np.pi / 130.0
        dx = dx + 0.3 * np.sin(k * x + 0.3) * np.cos(0.8 * k * y)
        return dx, dy + 0.3 * np.cos(k * y + 1) * np.sin(0.9 * k * x)

    truth = Scene(shape, 5).photograph(ripple)
    found = register(truth.reference, truth.moving)
    assert vector_rms(found, truth) < 0.1  # the ripple alone has 0.2
    windows = register(truth.reference, truth.moving, settings=RegistrationSettings(model="local"))
    assert windows.model == "local windows, 32 px"
    assert vector_rms(windows, truth) < 0.1
    assert 0.55 < within_one_std(windows, truth).mean() < 0.78  # 0.68 if normal


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


@pytest.mark.slow
def test_two_thirds_of_the_errors_lie_within_one_standard_deviation():
    textures = ({}, {"private": 0.0}, {"contrast": 0.04, "private": 0.0})
    hits = []
    for texture in textures:
        for seed in range(4):
            truth = Scene(SHAPE, 100 + seed, **texture).photograph(smooth_map(SHAPE))
            hits.append(within_one_std(register(truth.reference, truth.moving), truth).mean())
    assert 0.6 < np.mean(hits) < 0.76  # 12 maps: their mean scatters by 0.03


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


def test_frames_are_read_when_they_are_needed_and_not_kept():
    alive: list[weakref.ref[np.ndarray]] = []
    seen = []

    class Reading(list):
        def __getitem__(self, number):
            reference, *others = super().__getitem__(number)
            copy = reference.copy()
            alive.append(weakref.ref(copy))
            seen.append(sum(ref() is not None for ref in alive))
            return copy, *others

    frames, *_ = drifting_frames((128, 160), 5, contrast=0.1)
    once, drift = register_frames(Reading(frames))
    again, same = register_frames(frames)
    npt.assert_array_equal(once.displacement_x, again.displacement_x)
    npt.assert_array_equal(drift, same)
    assert max(seen) <= 3  # the first pair, the one before, this one


def test_a_misfired_pulse_has_no_drift_and_does_no_harm(run):
    frames, *_ = run
    rng = np.random.default_rng(12)
    blank = tuple(expose(np.full(SHAPE, 300.0), rng) for _ in range(2))
    found, drift = register_frames([(*blank, None, None), *frames[:4]])
    alone, expected = register_frames(frames[:4])
    assert np.isnan(drift[0]).all()
    npt.assert_allclose(drift[1:], expected, atol=0.01)
    npt.assert_allclose(found.displacement_x, alone.displacement_x, atol=0.01)


def test_only_so_many_frames_make_the_map_but_all_get_a_drift(run):
    frames, drift, *_ = run
    _, measured = register_frames(frames, settings=RegistrationSettings(frames_for_map=4))
    assert measured.shape == drift.shape
    assert np.sqrt(np.mean((measured - drift) ** 2)) < 0.03


def surface_error(surface, truth):
    """Rms length of the error of a surface over the inner field. [px]"""
    dx, dy = surface.on_pixels(truth.dx.shape)
    return np.sqrt(np.mean(((dx - truth.dx) ** 2 + (dy - truth.dy) ** 2)[truth.inside()]))


def test_coefficients_eight_standard_errors_above_zero_are_common_texture():
    """400 cells whose coefficients scatter by 0.1: the standard error is 1/200, the limit 0.04."""
    sums = np.zeros((20, 20, SUMS))
    sums[..., WEIGHT], sums[..., AA], sums[..., BB] = 64, 4, 1
    scatter = 0.2 * np.random.default_rng(1).standard_normal((20, 20))
    sums[..., AB] = 0.1 + scatter
    npt.assert_allclose(check_correlation(sums), sums[..., AB].mean() / np.sqrt(4 * 1))
    for product in (0.06, 0.0, -0.4):
        sums[..., AB] = product + scatter
        with pytest.raises(RegistrationError, match="no more than chance gives"):
            check_correlation(sums)


def fit_of(truth, **chosen):
    pair = truth.reference, truth.moving, None, None
    frames = open_series([pair], RegistrationSettings(**chosen))
    number, pair, surface = start_with_any(frames)
    views = TextureViews(frames, pair, number=number)
    return views, fit_surface(views, surface)


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
    assert choose_solution(seen, fit._replace(unresolved=unresolved)).kind is kind


def test_a_fine_surface_is_kept_if_windows_leave_no_less(views):
    seen, fit = fit_of(views)
    surface = solve_surface(equations(fit.cells, (16, 12)))
    fine = fit._replace(model=Model((16, 12)), surface=surface)
    assert choose_solution(seen, fine).kind is MapKind.SURFACE


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
@settings(max_examples=8, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
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
