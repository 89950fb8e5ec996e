"""Camera 2 on the grid of camera 1: values, noise and flags."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.products import CorrectedFrames
from erlif.registration import (
    CameraMap,
    MapKind,
    RegistrationSettings,
    align_frames,
    interpolation_variance_factor,
)

SHAPE = (64, 80)


def camera_map(dx, dy, orientation="normal"):
    field = np.ones(SHAPE, np.float32)
    return CameraMap(
        dx * field,
        dy * field,
        0.01 * field,
        np.ones(SHAPE, bool),
        np.zeros(SHAPE, bool),
        1.0,
        MapKind.SURFACE,
        settings=RegistrationSettings(orientation=orientation),
    )


def corrected(images, variance=1.0, flags=None):
    """The same images (frame, y, x) for both cameras."""
    signal = np.stack([images, images]).astype(np.float32)
    dims = ("camera", "frame", "y", "x")
    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal),
                "signal_var": (dims, np.full(signal.shape, variance, np.float32)),
                "signal_var_fixed": (dims, np.zeros(signal.shape, np.float32)),
                "flags": (
                    dims,
                    np.zeros(signal.shape, np.uint8)
                    if flags is None
                    else np.stack([flags * 0, flags]),
                ),
            },
            {"camera": [1, 2]},
        )
    )


def smooth(y, x):
    """A scene that can be evaluated anywhere."""
    return 1000 + 100 * np.sin(0.21 * x + 0.1) * np.cos(0.17 * y)


def test_camera_2_is_sampled_at_the_points_of_camera_1():
    y, x = np.indices(SHAPE, dtype=float)
    aligned = align_frames(corrected(smooth(y, x)[None]), camera_map(3.3, -2.7))
    inside = (slice(8, -8), slice(8, -8))
    npt.assert_allclose(
        aligned.signal.values[1, 0][inside], smooth(y - 2.7, x + 3.3)[inside], atol=0.03
    )
    npt.assert_array_equal(aligned.signal.values[0, 0], smooth(y, x).astype(np.float32))


def test_drift_moves_a_frame_on_top_of_the_map():
    y, x = np.indices(SHAPE, dtype=float)
    images = np.stack([smooth(y, x)] * 2)
    aligned = align_frames(
        corrected(images), camera_map(1.0, 1.0), drift=np.array([[0.0, 0.0], [0.4, -0.6]])
    )
    inside = (slice(8, -8), slice(8, -8))
    npt.assert_allclose(
        aligned.signal.values[1, 1][inside], smooth(y + 0.4, x + 1.4)[inside], atol=0.03
    )


def test_variance_is_the_scatter_of_interpolated_noise():
    rng = np.random.default_rng(6)
    noise = rng.normal(0, 2.0, (800, *SHAPE)) + 100
    for shift in ((0.0, 0.0), (0.5, 0.5), (0.3, 0.8)):
        aligned = align_frames(corrected(noise, variance=4.0), camera_map(*shift))
        inside = (slice(8, -8), slice(8, -8))
        scatter = aligned.signal.values[1].var(axis=0)[inside]
        # 800 draws of 3,000 pixels: the mean is good to about 0.2 %
        npt.assert_allclose(
            aligned.signal_var.values[1, 0][inside].mean(), scatter.mean(), rtol=0.006
        )


def test_variance_is_interpolated_and_averaged():
    """A variance that changes linearly, times the factor of the spline at this position."""
    y, x = np.indices(SHAPE, dtype=float)
    frames = corrected(np.full((1, *SHAPE), 100.0))
    frames.signal_var.values[1, 0] = 5 + 0.1 * x + 0.3 * y
    frames.signal_var_fixed.values[1, 0] = 2 + 0.2 * x
    aligned = align_frames(frames, camera_map(2.3, -1.6))
    inside = (slice(2, None), slice(None, -3))
    factor = interpolation_variance_factor(np.array([[2.3]]), np.array([[-1.6]]))[0, 0]
    npt.assert_allclose(
        aligned.signal_var.values[1, 0][inside],
        factor * (5 + 0.1 * (x + 2.3) + 0.3 * (y - 1.6))[inside],
        rtol=1e-5,
    )
    npt.assert_allclose(
        aligned.signal_var_fixed.values[1, 0][inside],
        factor * (2 + 0.2 * (x + 2.3))[inside],
        rtol=1e-5,
    )
    npt.assert_allclose(aligned.interpolation, [factor], rtol=1e-6)


def test_variance_is_known_exactly_where_the_signal_is():
    y, x = np.indices(SHAPE)
    noise = np.random.default_rng(7).uniform(1, 2, SHAPE)
    frames = corrected(np.full((1, *SHAPE), 100.0))
    frames.signal_var.values[1, 0] = noise
    aligned = align_frames(frames, camera_map(4.0, -3.0))
    seen = (x + 4 <= SHAPE[1] - 1) & (y - 3 >= 0)
    for name in ("signal", "signal_var", "signal_var_fixed"):
        npt.assert_array_equal(np.isfinite(aligned[name].values[1, 0]), seen)
    # on whole pixels, the outermost included, the variance is that of the pixel
    npt.assert_allclose(aligned.signal_var.values[1, 0][3:, :-4], noise[:-3, 4:], rtol=1e-6)


def test_frame_without_drift_is_flagged():
    images = np.full((2, *SHAPE), 100.0)
    drift = np.array([[np.nan, np.nan], [0.5, 0.0]])
    aligned = align_frames(corrected(images), camera_map(0.0, 0.0), drift=drift)
    lost, found = aligned.flags.values[1]
    assert (lost & Flag.POOR_REGISTRATION > 0).all()
    assert not (found & Flag.POOR_REGISTRATION).any()
    assert np.isnan(aligned.signal.values[1, 0]).all()
    half = interpolation_variance_factor(np.array([[0.5]]), np.array([[0.0]]))[0, 0]
    npt.assert_allclose(aligned.interpolation, [1.0, half], rtol=1e-6)


def test_flags_of_the_map_are_added():
    found = camera_map(0.0, 0.0)
    found.poor[10:20, 30:40] = True
    found.overlap[50:, 60:] = False
    aligned = align_frames(corrected(np.full((1, *SHAPE), 100.0)), found)
    flags = aligned.flags.values[1, 0]
    npt.assert_array_equal(flags & Flag.POOR_REGISTRATION > 0, found.poor)
    npt.assert_array_equal(flags & Flag.OUTSIDE_OVERLAP > 0, ~found.overlap)
    assert not aligned.flags.values[0].any()


@pytest.mark.parametrize("shift", [(0.5, 0.5), (0.0, 0.0), (-2.75, 3.2), (1.0, -4.4)])
def test_flags_come_from_the_sixteen_contributing_pixels(shift):
    """Random bits everywhere, the edges included; the sixteen begin one pixel before the point."""
    rng = np.random.default_rng(8)
    flags = (rng.uniform(size=SHAPE) < 0.02) * rng.choice([1, 2, 4, 128], SHAPE)
    flags[-1, -1] = flags[0, 0] = 128
    dx, dy = shift
    aligned = align_frames(
        corrected(np.full((1, *SHAPE), 100.0), flags=flags.astype(np.uint8)[None]),
        camera_map(dx, dy),
    )
    h, w = SHAPE
    expected = np.zeros(SHAPE, int)
    for i, j in np.ndindex(*SHAPE):
        y, x = i + dy, j + dx
        if not (0 <= x <= w - 1 and 0 <= y <= h - 1):
            expected[i, j] = Flag.OUTSIDE_OVERLAP
            continue
        top, left = min(int(y), h - 2), min(int(x), w - 2)
        taps = flags[max(top - 1, 0) : top + 3, max(left - 1, 0) : left + 3]
        expected[i, j] = np.bitwise_or.reduce(taps, axis=None)
    npt.assert_array_equal(aligned.flags.values[1, 0], expected)


def test_pixel_inherits_the_flags_it_is_made_from():
    flags = np.zeros((1, *SHAPE), np.uint8)
    flags[0, 30, 40] = Flag.BAD_PIXEL
    aligned = align_frames(
        corrected(np.full((1, *SHAPE), 100.0), flags=flags), camera_map(0.5, 0.5)
    )
    hit = np.argwhere(aligned.flags.values[1, 0] & Flag.BAD_PIXEL)
    assert {tuple(place) for place in hit} == {(y, x) for y in range(28, 32) for x in range(38, 42)}
    assert not aligned.flags.values[0].any()


def test_point_that_camera_2_does_not_see_is_flagged():
    aligned = align_frames(corrected(np.full((1, *SHAPE), 100.0)), camera_map(10.0, -6.0))
    outside = aligned.flags.values[1, 0] & Flag.OUTSIDE_OVERLAP > 0
    y, x = np.indices(SHAPE)
    npt.assert_array_equal(outside, (x + 10 > SHAPE[1] - 1) | (y - 6 < 0))
    assert np.isnan(aligned.signal.values[1, 0][outside]).all()


def test_mirrored_camera_is_turned_first():
    y, x = np.indices(SHAPE, dtype=float)
    scene = smooth(y, x)
    frames = corrected(scene[None])
    frames.signal.values[1, 0] = scene[:, ::-1]
    aligned = align_frames(frames, camera_map(0.0, 0.0, orientation="mirrored_x"))
    npt.assert_allclose(aligned.signal.values[1, 0], scene, atol=1e-3)


def test_turned_camera_has_its_noise_and_flags_turned_too():
    """A square frame, mounted a quarter turn clockwise."""
    rng = np.random.default_rng(9)
    square = (32, 32)
    variance = rng.uniform(1, 2, square).astype(np.float32)
    flags = np.zeros(square, np.uint8)
    flags[4, 20] = Flag.SATURATED
    frames = CorrectedFrames(
        corrected(np.full((1, *SHAPE), 100.0)).isel(y=slice(32), x=slice(32)).copy(deep=True)
    )
    frames.signal_var.values[1, 0] = np.rot90(variance, -1)
    frames.flags.values[1, 0] = np.rot90(flags, -1)
    flat = np.zeros(square, np.float32)
    turned = CameraMap(
        flat,
        flat,
        flat,
        flat == 0,
        flat > 0,
        1.0,
        MapKind.SURFACE,
        settings=RegistrationSettings(orientation="rotated_90"),
    )
    aligned = align_frames(frames, turned)
    npt.assert_allclose(aligned.signal_var.values[1, 0], variance, rtol=1e-6)
    hit = np.argwhere(aligned.flags.values[1, 0] & Flag.SATURATED)
    assert {tuple(place) for place in hit} == {(y, x) for y in range(2, 6) for x in range(18, 22)}


def test_camera_1_and_the_coordinates_are_kept():
    rng = np.random.default_rng(10)
    frames = CorrectedFrames(
        corrected(rng.uniform(50, 100, (3, *SHAPE))).assign_coords(frame=[4, 7, 9])
    )
    frames.flags.values[0, 1, 5, 5] = Flag.DIM
    before = frames.copy(deep=True)
    aligned = align_frames(frames, camera_map(0.4, 0.3))
    for name in ("signal", "signal_var", "signal_var_fixed", "flags"):
        npt.assert_array_equal(aligned[name].values[0], before[name].values[0])
    npt.assert_array_equal(aligned.frame, [4, 7, 9])
    npt.assert_allclose(aligned.displacement_std, 0.01)
    xr.testing.assert_identical(frames, before)


def test_missing_variable_is_named():
    frames = CorrectedFrames(corrected(np.ones((1, *SHAPE))).drop_vars("signal_var_fixed"))
    with pytest.raises(ErlifError, match="signal_var_fixed is missing"):
        align_frames(frames, camera_map(0.0, 0.0))
