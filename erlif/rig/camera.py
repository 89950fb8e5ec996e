"""The cameras: the object point of each pixel, the sensor's noise, and 12-bit counts.

Noise follows EMVA 1288: shot noise of the electrons, read noise, and an offset of the converter.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from erlif.core.arrays import Array, Counts
from erlif.core.speed.kernels import njit
from erlif.rig.settings import RigSettings

# Largest count of a 12-bit camera. [DN]
FULL_SCALE = 4095

_BEND = np.array([[0.6, 0.4, -0.2], [-0.3, 0.5, 0.5]])  # shares of u^2, u v, v^2 in x and y
_CONVERGED = 1e-11  # pixel: step at which the search for an object point ends
_LENS_CENTRE = (0.02, 0.015)  # of width and height: offset of the lens from the middle
_DUST_DEPTH = (0.05, 0.2)  # least and largest loss of light behind a speck
_DUST_WIDTH = (2, 5)  # pixel: standard deviation of its shadow
_HOT_SIGNAL = (500, 3000)  # electron: dark signal of hot pixels


# object points of camera 2


def map_coefficients(rig: RigSettings) -> Array:
    """Displacement (axis x y, term) as a polynomial of the terms 1, u, v, u^2, u v, v^2. [pixel]

    u and v run from -1 to 1 over the columns and rows of camera 1. The affine part scales and
    turns about the middle.
    """
    cos, sin = np.cos(np.radians(rig.rotation)), np.sin(np.radians(rig.rotation))
    (half_width, half_height), (wide, high) = rig.centre, rig.scale
    along_x = [rig.shift[0], (wide * cos - 1) * half_width, -wide * sin * half_height]
    along_y = [rig.shift[1], high * sin * half_width, (high * cos - 1) * half_height]
    return np.hstack([[along_x, along_y], rig.distortion * _BEND])


def displacement(x: Array, y: Array, rig: RigSettings) -> tuple[Array, Array]:
    """Camera-2 pixel minus camera-1 pixel (x, y) of the same object point at zero drift. [pixel]"""
    dx, dy = _displace(x, y, *rig.centre, map_coefficients(rig))
    return dx, dy


def seen_from_camera_2(
    x: Array, y: Array, drift: tuple[float, float], rig: RigSettings
) -> tuple[Array, Array]:
    """Object points [pixel of camera 1] that the pixels (x, y) of camera 2 show, to 1e-10 pixel.

    Fixed point of ``X = P - drift - d(X)``. The displacement changes by about 0.01 per pixel, so
    each turn adds two digits.
    """
    object_x, object_y = _look_back(x - drift[0], y - drift[1], *rig.centre, map_coefficients(rig))
    return object_x, object_y


@njit(cache=True, nogil=True)
def _displace(x: Any, y: Any, centre_x: float, centre_y: float, terms: Array) -> tuple[Any, Any]:
    """Value of the polynomial, for numbers or arrays."""
    u, v = x / centre_x - 1, y / centre_y - 1
    return _quadratic(u, v, terms[0]), _quadratic(u, v, terms[1])


@njit(cache=True, nogil=True)
def _quadratic(u: Any, v: Any, of: Array) -> Any:
    """Sum of the terms 1, u, v, u^2, u v, v^2."""
    return of[0] + of[1] * u + of[2] * v + of[3] * u * u + of[4] * u * v + of[5] * v * v


@njit(cache=True, nogil=True)
def _look_back(
    x: Array, y: Array, centre_x: float, centre_y: float, terms: Array
) -> tuple[Array, Array]:
    """Fixed-point iteration of `seen_from_camera_2`, pixel by pixel."""
    object_x, object_y = x.copy(), y.copy()
    for j in range(x.shape[0]):
        for i in range(x.shape[1]):
            step = 1.0
            while step > _CONVERGED:
                dx, dy = _displace(object_x[j, i], object_y[j, i], centre_x, centre_y, terms)
                step = abs(x[j, i] - dx - object_x[j, i]) + abs(y[j, i] - dy - object_y[j, i])
                object_x[j, i], object_y[j, i] = x[j, i] - dx, y[j, i] - dy
    return object_x, object_y


def vibrate(frames: int, rig: RigSettings, rng: np.random.Generator) -> Array:
    """Draw the extra shift of camera 2, (frame, axis x y); its mean is zero. [pixel]"""
    drift = rng.normal(0, rig.vibration, (frames, 2))
    return np.asarray(drift - drift.mean(axis=0))


# what the sensor adds


@dataclass(frozen=True)
class Camera:
    """Fixed properties of one camera; arrays are (y, x).

    Attributes
    ----------
    sensitivity : Array
        Vignetting, dust and pixel response together; 0 for a dead pixel. [1]
    dark_signal : Array
        Dark signal of hot pixels. [electron]
    dark_level : Array
        Offset of the converter, with its column pattern. [DN]
    gain : float
        Electrons of one count. [electron/DN]
    read_noise : float
        Standard deviation of the read noise. [electron]
    full_well : float
        Largest signal of a pixel. [electron]
    compression : float
        Share of the light that is lost at full scale. [1]
    """

    sensitivity: Array
    dark_signal: Array
    dark_level: Array
    gain: float
    read_noise: float
    full_well: float = np.inf
    compression: float = 0.0


def vignetting(x: Array, y: Array, number: int, rig: RigSettings) -> Array:
    """Transmission of the lens of camera `number`: cos^4 of the field angle.

    The two lenses are centred a little off the middle, on opposite sides of it.
    """
    side = 1 if number == 1 else -1
    off_x, off_y = (
        x - rig.centre[0] - side * _LENS_CENTRE[0] * rig.width,
        y - rig.centre[1] - _LENS_CENTRE[1] * rig.height,
    )
    tan2 = (rig.vignetting[number - 1] ** -0.5 - 1) * (off_x**2 + off_y**2) / rig.half_diagonal**2
    return np.asarray((1 + tan2) ** -2)


def build_camera(number: int, rig: RigSettings, rng: np.random.Generator) -> Camera:
    """Draw the sensor of camera 1 or 2: response, dust, dead and hot pixels, dark columns."""
    shape = (rig.height, rig.width)
    y, x = np.indices(shape, dtype=np.float64)
    sensitivity = vignetting(x, y, number, rig) * (1 + rng.normal(0, rig.response_spread, shape))

    for _ in range(rig.dust):
        at_x, at_y = rng.uniform(0, rig.width), rng.uniform(0, rig.height)
        depth, width = rng.uniform(*_DUST_DEPTH), rng.uniform(*_DUST_WIDTH)
        sensitivity *= 1 - depth * np.exp(-((x - at_x) ** 2 + (y - at_y) ** 2) / (2 * width**2))

    # no pixel is dead and hot at once
    odd = rng.permutation(sensitivity.size)
    dead, hot = np.split(
        odd[: rig.dead_pixels + round(rig.hot_fraction * odd.size)], [rig.dead_pixels]
    )
    sensitivity.flat[dead] = 0.0

    dark_signal = np.zeros(shape)
    dark_signal.flat[hot] = rng.uniform(*_HOT_SIGNAL, hot.size)
    dark_level = np.broadcast_to(rig.offset + rng.normal(0, rig.column_pattern, rig.width), shape)
    full_well = np.inf if rig.full_well is None else rig.full_well
    return Camera(sensitivity, dark_signal, dark_level, rig.gain, rig.read_noise, full_well)


def alter_camera(camera: Camera, number: int, rig: RigSettings) -> Camera:
    """A camera in the run: brighter, shaded, compressed, or with another dark level than before."""
    n, shade = number - 1, np.ones(1)
    if number == 2:
        y, x = np.meshgrid(
            *(np.linspace(-1, 1, size) for size in camera.sensitivity.shape), indexing="ij"
        )
        shade = 1 + np.tensordot(rig.shading, [x, y, x**2, x * y, y**2], axes=1)
    return replace(
        camera,
        sensitivity=camera.sensitivity * rig.brightness[n] * shade,
        dark_level=camera.dark_level + rig.dark_drift[n],
        compression=rig.compression[n],
    )


def expose(light: Array | float, camera: Camera, rng: np.random.Generator) -> Counts:
    """Return the counts of one exposure to `light` [electron at sensitivity 1].

    They hold shot and read noise and are clipped at full well and full scale.
    """
    electrons = rng.poisson(camera.sensitivity * light + camera.dark_signal)
    electrons = np.minimum(electrons, camera.full_well)
    if camera.compression:
        electrons = electrons * (1 - camera.compression * electrons / (FULL_SCALE * camera.gain))
    noisy = electrons + rng.normal(0, camera.read_noise, electrons.shape)
    counts = np.rint(noisy / camera.gain + camera.dark_level)
    return np.clip(counts, 0, FULL_SCALE).astype(np.uint16)
