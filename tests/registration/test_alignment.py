"""Camera 2 on the grid of camera 1: values, noise and flags."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

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
