"""Camera 2 on the grid of camera 1: values, noise and flags."""

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.core.flags import Flag
from erlif.core.products import CorrectedFrames
from erlif.registration import CameraMap, MapKind, RegistrationSettings, align_frames

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


def test_camera_2_is_sampled_where_camera_1_looks():
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


def test_pixel_inherits_the_flags_it_is_made_from():
    flags = np.zeros((1, *SHAPE), np.uint8)
    flags[0, 30, 40] = Flag.BAD_PIXEL
    aligned = align_frames(
        corrected(np.full((1, *SHAPE), 100.0), flags=flags), camera_map(0.5, 0.5)
    )
    hit = np.argwhere(aligned.flags.values[1, 0] & Flag.BAD_PIXEL)
    assert {tuple(place) for place in hit} == {(y, x) for y in range(28, 32) for x in range(38, 42)}
    assert not aligned.flags.values[0].any()


def test_what_camera_2_does_not_see_is_flagged():
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
