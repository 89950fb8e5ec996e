"""Two cameras on one analytic scene: frames whose displacement is known exactly.

The scene is a function of continuous coordinates, those of camera 1: Gaussian blobs of random
height on a jittered lattice, and scratches of Gaussian profile. Camera 1 samples it at its pixels.
Camera 2 samples it at the inverse of x -> x + d(x), found by fixed-point iteration, so that no
interpolator takes part in the truth. The tests and the benchmark use the same scenes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from erlif.registration import RegistrationSettings, views
from erlif.registration.matching import GXX, GXY, GYY, SUMS
from erlif.registration.pairs import Pairs, open_series
from erlif.registration.surface import Surface, affine_surface

Array = NDArray[Any]
Field = Callable[[Array, Array], tuple[Array, Array]]


@njit(cache=True, nogil=True)
def _sum_blobs(
    x: Array,
    y: Array,
    left: float,
    top: float,
    pitch: float,
    sigma: float,
    blobs: Array,
    out: Array,
) -> None:
    rows, cols, _ = blobs.shape
    reach = int(np.ceil(4.2 * sigma / pitch))
    for k in range(x.size):
        i0 = int(np.floor((x[k] - left) / pitch))
        j0 = int(np.floor((y[k] - top) / pitch))
        total = 0.0
        for j in range(max(j0 - reach, 0), min(j0 + reach + 1, rows)):
            for i in range(max(i0 - reach, 0), min(i0 + reach + 1, cols)):
                d = (x[k] - blobs[j, i, 0]) ** 2 + (y[k] - blobs[j, i, 1]) ** 2
                if d < 17.6 * sigma * sigma:
                    total += blobs[j, i, 2] * np.exp(-d / (2 * sigma * sigma))
        out[k] = total


class Blobs:
    """A random field of unit variance whose correlation falls to 1/e at twice ``sigma``."""

    def __init__(
        self, shape: tuple[int, int], sigma: float, rng: np.random.Generator, *, margin: float = 0.6
    ) -> None:
        h, w = shape
        self.sigma, self.pitch = sigma, 1.5 * sigma
        self.left, self.top = -margin * w, -margin * h
        cols = int((1 + 2 * margin) * w / self.pitch) + 2
        rows = int((1 + 2 * margin) * h / self.pitch) + 2
        i, j = np.meshgrid(np.arange(cols), np.arange(rows))
        self.blobs = np.empty((rows, cols, 3))
        self.blobs[..., 0] = self.left + (i + rng.uniform(size=i.shape)) * self.pitch
        self.blobs[..., 1] = self.top + (j + rng.uniform(size=i.shape)) * self.pitch
        # one blob on each pitch^2 of area, the integral of its square being pi sigma^2
        self.blobs[..., 2] = rng.normal(size=i.shape) * self.pitch / (np.sqrt(np.pi) * sigma)

    def __call__(self, x: Array, y: Array) -> Array:
        """Value at any points."""
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        out = np.empty(x.size)
        _sum_blobs(
            x.ravel(), y.ravel(), self.left, self.top, self.pitch, self.sigma, self.blobs, out
        )
        return out.reshape(x.shape)


class Scratches:
    """Straight lines of Gaussian profile with soft ends."""

    def __init__(
        self, shape: tuple[int, int], per_megapixel: float, rng: np.random.Generator
    ) -> None:
        h, w = shape
        n = int(rng.poisson(per_megapixel * h * w / 1e6))
        angle = rng.uniform(0, np.pi, n)
        self.x, self.y = rng.uniform(0, w, n), rng.uniform(0, h, n)
        self.cos, self.sin = np.cos(angle), np.sin(angle)
        self.half, self.width = rng.uniform(40, 250, n), rng.uniform(0.9, 1.6, n)
        self.height = rng.choice([-1, 1], n) * rng.uniform(1, 3, n)

    def __call__(self, x: Array, y: Array) -> Array:
        total = np.zeros(np.shape(x))
        for k in range(len(self.x)):
            across = (x - self.x[k]) * self.sin[k] - (y - self.y[k]) * self.cos[k]
            near = np.abs(across) < 6 * self.width[k]
            along = ((x - self.x[k]) * self.cos[k] + (y - self.y[k]) * self.sin[k])[near]
            ends = 1 / (1 + np.exp((np.abs(along) - self.half[k]) / 3))
            total[near] += (
                self.height[k] * ends * np.exp(-(across[near] ** 2) / (2 * self.width[k] ** 2))
            )
        return total


def smooth_map(
    shape: tuple[int, int],
    *,
    offset: tuple[float, float] = (4.0, -3.0),
    rotation: float = 0.3,
    scale: float = 1.01,
    cubic: float = 0.45,
    quadratic: float = 0.25,
) -> Field:
    """Displacement of a camera that is shifted, turned, scaled and slightly distorted.

    ``offset`` is in px; ``rotation``, in degrees, is about the centre of the frame. ``quadratic``
    and ``cubic`` are the distortions at half the longer side. [px]
    """
    h, w = shape
    half = max(h, w) / 2
    angle = np.radians(rotation)
    c, s = scale * np.cos(angle), scale * np.sin(angle)

    def displacement(x: Array, y: Array) -> tuple[Array, Array]:
        x, y = x - (w - 1) / 2, y - (h - 1) / 2
        u, v = x / half, y / half
        r2 = u * u + v * v
        dx = (c - 1) * x - s * y + offset[0] + cubic * u * r2 + quadratic * (u * u - 0.8 * u * v)
        dy = s * x + (c - 1) * y + offset[1] + cubic * v * r2 - quadratic * (v * v - 1.2 * u * v)
        return dx, dy

    return displacement


def inverse(field: Field, x: Array, y: Array) -> tuple[Array, Array]:
    """Points of camera 1 that camera 2 sees at x, y."""
    px, py = x.astype(float), y.astype(float)
    for _ in range(200):
        dx, dy = field(px, py)
        nx, ny = x - dx, y - dy
        step = max(float(np.abs(nx - px).max()), float(np.abs(ny - py).max()))
        px, py = nx, ny
        if step < 1e-10:
            return px, py
    raise ValueError("The displacement has no inverse here; its gradient must stay below 1.")


@dataclass(frozen=True)
class Views:
    """Frames of the two cameras and the truth, all (y, x)."""

    reference: Array
    """Camera 1. [counts]"""

    moving: Array
    """Camera 2. [counts]"""

    dx: Array
    """True displacement along x: camera-2 pixel minus camera-1 pixel. [px]"""

    dy: Array
    """True displacement along y. [px]"""

    clean_reference: Array
    """Camera 1 without noise. [counts]"""

    clean_moving: Array
    """Camera 2 without noise. [counts]"""

    def inside(self, margin: int = 16) -> Array:
        """Pixels of camera 1 that both cameras see, at least so far from the edges."""
        h, w = self.dx.shape
        y, x = np.mgrid[:h, :w]
        qx, qy = x + self.dx, y + self.dy
        near = (x >= margin) & (x < w - margin) & (y >= margin) & (y < h - margin)
        return (
            near
            & (qx >= margin / 4)
            & (qx <= w - 1 - margin / 4)
            & (qy >= margin / 4)
            & (qy <= h - 1 - margin / 4)
        )


def expose(
    clean: Array, rng: np.random.Generator, *, gain: float = 4.0, read: float = 8.0
) -> Array:
    """Counts of a 12-bit camera: shot noise, read noise [electrons], rounding and clipping.

    ``gain`` is in electrons per count.
    """
    electrons = rng.poisson(np.maximum(clean, 0) * gain) + rng.normal(0, read, clean.shape)
    return np.clip(np.rint(electrons / gain), 0, 4095).astype(np.uint16)


class Scene:
    """A wall under two cameras.

    Both see its texture; camera 2 sees some texture of its own. Light and ratio are uneven.
    """

    def __init__(
        self,
        shape: tuple[int, int],
        seed: int,
        *,
        contrast: float = 0.15,
        sigma: float = 1.5,
        private: float = 0.05,
        scratches: float = 60,
    ) -> None:
        rng = np.random.default_rng(seed)
        self.shape, self.contrast, self.private = shape, contrast, private
        self.common = Blobs(shape, sigma, rng)
        self.alone = Blobs(shape, sigma, rng)
        self.scratches = Scratches(shape, scratches, rng)
        self.rng = rng

    def _place(self, x: Array, y: Array) -> tuple[Array, Array]:
        h, w = self.shape
        half = max(h, w) / 2
        return (x - (w - 1) / 2) / half, (y - (h - 1) / 2) / half

    def brightness(self, x: Array, y: Array) -> Array:
        """Camera 1 without noise, arbitrary units."""
        u, v = self._place(x, y)
        light = 0.45 + 0.55 * np.exp(-((u - 0.1) ** 2 + (v + 0.05) ** 2) / 0.72)
        return light * np.exp(self.contrast * (self.common(x, y) + self.scratches(x, y)))

    def second(self, x: Array, y: Array) -> Array:
        """Camera 2 without noise as a function of the object point."""
        u, v = self._place(x, y)
        ratio = 1 + 0.4 * np.sin(2.5 * u + 0.4) * np.cos(3 * v - 0.3)
        return self.brightness(x, y) * ratio * np.exp(self.private * self.alone(x, y))

    def light(self, field: Field, peak: float) -> tuple[Array, Array]:
        """Counts of both cameras without noise, camera 2 displaced by ``field``.

        The brightest thousandth of the pixels reaches ``peak`` counts.
        """
        y, x = np.indices(self.shape, dtype=float)
        both = self.brightness(x, y), self.second(*inverse(field, x, y))
        first, second = (image * (peak / np.percentile(image, 99.9)) for image in both)
        return first, second

    def photograph(self, field: Field, *, peak: float = 2500.0) -> Views:
        """One exposure by both cameras, see `light`."""
        first, second = self.light(field, peak)
        y, x = np.indices(self.shape, dtype=float)
        dx, dy = field(x, y)
        return Views(expose(first, self.rng), expose(second, self.rng), dx, dy, first, second)


def vector_rms(camera_map: Any, views: Views, inside: Array | None = None) -> float:
    """Rms length of the displacement error over the pixels that both cameras see. [px]"""
    inside = views.inside() if inside is None else inside
    error = np.hypot(camera_map.displacement_x - views.dx, camera_map.displacement_y - views.dy)[
        inside
    ]
    return float(np.sqrt(np.mean(error**2)))


def translation(
    dx: float = 0.0, dy: float = 0.0, *, shape: tuple[int, int] = (128, 160)
) -> Surface:
    """The surface of a translation over a frame."""
    h, w = shape
    return affine_surface((0.0, float(w), 0.0, float(h)), np.zeros((2, 2)), np.array([dx, dy]))


def map_views(pairs: Pairs) -> views.TextureViews:
    """Frames from which a map is made, on one thread; the first one is that of the start."""
    frames = open_series(pairs, RegistrationSettings(threads=1))
    return views.TextureViews(frames, next(iter(frames.pick([0]))))


def texture_sums(shape: tuple[int, int], rng: np.random.Generator) -> Array:
    """Cell sums of random texture, with normal matrices and without scores."""
    sums = np.zeros((*shape, SUMS))
    sums[..., GXX], sums[..., GYY] = rng.uniform(8, 12, shape), rng.uniform(18, 22, shape)
    sums[..., GXY] = rng.uniform(-5, 5, shape)
    return sums


def drifting_frames(
    shape: tuple[int, int],
    count: int,
    *,
    contrast: float = 0.04,
    peak: float = 1250.0,
    seed: int = 11,
    rms: float = 0.3,
) -> tuple[list[tuple[Array, Array, None, None]], Array, Array, Array]:
    """Frame pairs of one map with a drift of camera 2 in each, as `register_frames` takes them.

    Returns the frames, the drift (frame, 2) about its mean, and the displacement (dx, dy) with the
    mean drift in it. [px]
    """
    scene = Scene(shape, seed, contrast=contrast, private=0.0)
    smooth = smooth_map(shape)
    rng = np.random.default_rng(seed)
    drift = rng.normal(0, rms, (count, 2))
    frames = []
    for step in drift[:, :, None, None]:
        both = scene.light(lambda x, y, step=step: np.add(smooth(x, y), step), peak)
        frames.append((*(expose(light, rng) for light in both), None, None))
    y, x = np.indices(shape, dtype=float)
    dx, dy = smooth(x, y)
    mean = drift.mean(0)
    return frames, drift - mean, dx + mean[0], dy + mean[1]
