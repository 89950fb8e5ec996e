"""Displacement of camera 2 and the sensor's noise against what the settings state."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.rig import RigSettings
from erlif.rig.camera import (
    Camera,
    build_camera,
    displacement,
    expose,
    seen_from_camera_2,
    vibrate,
    vignetting,
)

# displacement


def test_object_points_of_camera_2_undo_displacement_and_drift():
    rig = RigSettings()
    y, x = np.indices((256, 320), dtype=float)
    object_x, object_y = seen_from_camera_2(x, y, (0.3, -0.2), rig)
    dx, dy = displacement(object_x, object_y, rig)
    npt.assert_allclose(object_x + dx + 0.3, x, atol=1e-10, rtol=0)
    npt.assert_allclose(object_y + dy - 0.2, y, atol=1e-10, rtol=0)


def test_displacement_is_shift_scale_rotation_and_half_a_pixel_of_distortion():
    rig = RigSettings(distortion=0.0)
    corner_x, corner_y = np.array([[0.0, 319.0]]), np.array([[0.0, 255.0]])
    dx, dy = displacement(corner_x, corner_y, rig)
    away = np.stack([corner_x[0] - 159.5, corner_y[0] - 127.5])
    cos, sin = np.cos(np.radians(0.4)), np.sin(np.radians(0.4))
    turn = np.array([[cos, -sin], [sin, cos]])
    expected = np.diag([1.004, 0.997]) @ turn @ away - away + np.array([[4.0], [-3.0]])
    npt.assert_allclose([dx[0], dy[0]], expected, atol=1e-12)
    bent_x, bent_y = displacement(corner_x, corner_y, RigSettings(distortion=0.5))
    bend = np.hypot(bent_x - dx, bent_y - dy)
    assert 0.3 < bend.min() <= bend.max() < 0.7


# sensor


def test_counts_of_an_exposure_have_the_noise_of_emva_1288():
    """Variance = mean signal / gain + read noise^2 + 1/12, in DN, over 200 x 200 equal pixels."""
    ones = np.ones((200, 200))
    camera = Camera(0.5 * ones, 20.0 * ones, 64.0 * ones, gain=4.0, read_noise=8.0)
    counts = expose(4000.0, camera, np.random.default_rng(1)).astype(float)
    electrons = 0.5 * 4000 + 20
    variance = electrons / 16 + (8 / 4) ** 2 + 1 / 12
    npt.assert_allclose(counts.mean(), 64 + electrons / 4, atol=4 * np.sqrt(variance) / 200)
    npt.assert_allclose(counts.var(), variance, rtol=4 * np.sqrt(2) / 200)


@pytest.mark.parametrize(
    ("light", "level", "full_well", "count"),
    [(1e6, 64.0, np.inf, 4095), (0.0, -500.0, np.inf, 0), (1e5, 64.0, 8000.0, 8000 / 4 + 64)],
)
def test_counts_are_clipped_to_twelve_bits_and_by_the_full_well(light, level, full_well, count):
    ones = np.ones((10, 10))
    camera = Camera(ones, 0 * ones, level * ones, 4.0, read_noise=0.0, full_well=full_well)
    assert np.all(expose(light, camera, np.random.default_rng(2)) == count)


def test_a_sensor_has_its_dead_and_hot_pixels():
    rig = RigSettings(dead_pixels=5, hot_fraction=1e-3, dust=0)
    camera = build_camera(1, rig, np.random.default_rng(3))
    dead, hot = camera.sensitivity == 0, camera.dark_signal > 0
    assert dead.sum() == 5
    assert hot.sum() == round(1e-3 * 320 * 256)
    assert not np.any(dead & hot)
    assert 500 <= camera.dark_signal[hot].min() < camera.dark_signal.max() <= 3000
    columns = camera.dark_level[0]
    npt.assert_array_equal(camera.dark_level, np.broadcast_to(columns, (256, 320)))
    npt.assert_allclose(columns.std(), rig.column_pattern, rtol=4 / np.sqrt(2 * 320))


def test_response_scatters_about_the_vignetting():
    rig = RigSettings(dead_pixels=0, dust=0, response_spread=0.02)
    y, x = np.indices((256, 320), dtype=float)
    response = build_camera(2, rig, np.random.default_rng(4)).sensitivity / vignetting(x, y, 2, rig)
    npt.assert_allclose(response.std(), 0.02, rtol=0.02)
    npt.assert_allclose(response.mean(), 1, atol=4 * 0.02 / np.sqrt(x.size))


def test_vignetting_is_cos4_with_the_stated_loss_at_a_corner():
    rig = RigSettings(vignetting=(0.8, 0.9))
    for number, loss, side in ((1, 0.8, 1), (2, 0.9, -1)):
        centre_x = rig.centre[0] + side * 0.02 * rig.width
        centre_y = rig.centre[1] + 0.015 * rig.height
        away = rig.half_diagonal * np.array([0, 0.5, 1])
        found = vignetting(centre_x + away, np.full(3, centre_y), number, rig)
        tan = np.sqrt(loss**-0.5 - 1) * np.array([0, 0.5, 1])
        npt.assert_allclose(found, np.cos(np.arctan(tan)) ** 4, rtol=1e-12)
        npt.assert_allclose(found[-1], loss, rtol=1e-12)


def test_vibration_has_zero_mean_and_its_spread():
    drift = vibrate(2000, RigSettings(vibration=0.3), np.random.default_rng(5))
    npt.assert_allclose(drift.mean(axis=0), 0, atol=1e-14)
    npt.assert_allclose(drift.std(axis=0), 0.3, rtol=4 / np.sqrt(4000))
