"""The cameras: where each pixel looks, what its sensor adds, and how photons become 12-bit counts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from erlif.rig.settings import RigSettings

Array = NDArray[np.float64]
Counts = NDArray[np.uint16]

FULL_SCALE = 4095
"""Largest count of a 12-bit camera. [DN]"""


# where camera 2 looks


def displacement(x: Array, y: Array, rig: RigSettings) -> tuple[Array, Array]:
    """Camera-2 pixel minus camera-1 pixel (x, y) of the same object point at zero drift: affine and quadratic. [pixel]"""
    from_x, from_y = x - rig.centre[0], y - rig.centre[1]
    cos, sin = np.cos(np.radians(rig.rotation)), np.sin(np.radians(rig.rotation))
    turned_x = rig.scale[0] * (cos * from_x - sin * from_y)
    turned_y = rig.scale[1] * (sin * from_x + cos * from_y)
    u, v = from_x / rig.centre[0], from_y / rig.centre[1]
    bent_x = rig.distortion * (0.6 * u**2 + 0.4 * u * v - 0.2 * v**2)
    bent_y = rig.distortion * (-0.3 * u**2 + 0.5 * u * v + 0.5 * v**2)
    return turned_x - from_x + rig.shift[0] + bent_x, turned_y - from_y + rig.shift[1] + bent_y


def seen_from_camera_2(x: Array, y: Array, drift: tuple[float, float], rig: RigSettings) -> tuple[Array, Array]:
    """Object points [pixel of camera 1] that the pixels (x, y) of camera 2 look at, to 1e-10 pixel.

    Fixed point of ``X = P - drift - d(X)``; a displacement that changes by about 0.01 per pixel converges two digits
    a turn.
    """
    goal_x, goal_y = x - drift[0], y - drift[1]
    object_x, object_y = goal_x, goal_y
    step = np.inf
    while step > 1e-11:
        dx, dy = displacement(object_x, object_y, rig)
        next_x, next_y = goal_x - dx, goal_y - dy
        step = max(float(np.abs(next_x - object_x).max()), float(np.abs(next_y - object_y).max()))
        object_x, object_y = next_x, next_y
    return object_x, object_y


def vibrate(frames: int, rig: RigSettings, rng: np.random.Generator) -> Array:
    """Draw the extra shift (frame, axis x y) of camera 2 in each frame; its mean is zero. [pixel]"""
    drift = rng.normal(0, rig.vibration, (frames, 2))
    return np.asarray(drift - drift.mean(axis=0))


# what the sensor adds


@dataclass(frozen=True)
class Camera:
    """Everything that is fixed in one camera; arrays are (y, x)."""

    sensitivity: Array
    """Vignetting, dust and pixel response together; 0 for a dead pixel. [1]"""
    dark_signal: Array
    """Dark signal of hot pixels. [electron]"""
    dark_level: Array
    """Offset of the converter, with its column pattern. [DN]"""
    gain: float
    """[electron/DN]"""
    read_noise: float
    """[electron]"""


def vignetting(x: Array, y: Array, number: int, rig: RigSettings) -> Array:
    """Transmission of the lens of camera `number`: cos^4 of the field angle, centred a little off the middle."""
    side = 1 if number == 1 else -1
    off_x, off_y = x - rig.centre[0] - side * 0.02 * rig.width, y - rig.centre[1] - 0.015 * rig.height
    tan2 = (rig.vignetting[number - 1] ** -0.5 - 1) * (off_x**2 + off_y**2) / rig.half_diagonal**2
    return np.asarray((1 + tan2) ** -2)


def build_camera(number: int, rig: RigSettings, rng: np.random.Generator) -> Camera:
    """Draw the sensor of camera 1 or 2: response, dust, dead and hot pixels, dark columns."""
    shape = (rig.height, rig.width)
    y, x = np.indices(shape, dtype=np.float64)
    sensitivity = vignetting(x, y, number, rig) * (1 + rng.normal(0, rig.response_spread, shape))
    for _ in range(rig.dust):
        at_x, at_y = rng.uniform(0, rig.width), rng.uniform(0, rig.height)
        depth, width = rng.uniform(0.05, 0.2), rng.uniform(2, 5)
        sensitivity *= 1 - depth * np.exp(-((x - at_x) ** 2 + (y - at_y) ** 2) / (2 * width**2))
    odd = rng.permutation(sensitivity.size)
    dead, hot = np.split(odd[: rig.dead_pixels + round(rig.hot_fraction * odd.size)], [rig.dead_pixels])
    sensitivity.flat[dead] = 0.0
    dark_signal = np.zeros(shape)
    dark_signal.flat[hot] = rng.uniform(500, 3000, hot.size)
    dark_level = np.broadcast_to(rig.offset + rng.normal(0, rig.column_pattern, rig.width), shape)
    return Camera(sensitivity, dark_signal, dark_level, rig.gain, rig.read_noise)


def expose(light: Array | float, camera: Camera, rng: np.random.Generator) -> Counts:
    """Return the counts of one exposure to `light` [electron at sensitivity 1]: shot and read noise, 12 bits."""
    electrons = rng.poisson(camera.sensitivity * light + camera.dark_signal)
    noisy = electrons + rng.normal(0, camera.read_noise, electrons.shape)
    counts = np.rint(noisy / camera.gain + camera.dark_level)
    return np.clip(counts, 0, FULL_SCALE).astype(np.uint16)
