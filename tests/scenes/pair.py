"""Light of one frame pair and a map between its cameras, with every kind of doubtful pixel.

The variances of the light are here in double precision, by the equations of docs/uncertainty.md.
"""

import numpy as np
import xarray as xr

from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages, References
from erlif.correction import NoiseTables, PairLight
from erlif.ratio import NoiseUnknowns
from erlif.registration import CameraMap, MapKind, RegistrationSettings

EPS = float(np.finfo(np.float32).eps)
"""A single operation in single precision is rounded by at most half of this."""


def scene(shape, seed=2, dark=0.0):
    """Light with noise, and random bits on a part of the pixels."""
    rng = np.random.default_rng(seed)
    size = (2, *shape)
    light = PairLight.empty(shape, with_noise=False)
    light.light[:] = rng.uniform(200, 3000, size)
    light.light[rng.uniform(size=size) < dark] = -5.0  # below the dark
    light.flags[:] = np.where(rng.uniform(size=size) < 0.01, rng.choice([1, 2, 4], size), 0)
    return light


def camera_noise(shape, *, seed=6):
    """What the variances of both cameras need besides the light; camera 2 has one dark_var."""
    rng = np.random.default_rng(seed)
    noise = []
    for camera in range(2):
        per_flat, flat_var = rng.uniform(0.8, 1.25, shape), rng.uniform(1e-6, 2e-6, shape)
        dark_var = rng.uniform(0.5, 1, (1, 1) if camera else shape) * np.ones((1, shape[1]))
        images = (image.astype(np.float32) for image in (per_flat, dark_var, flat_var))
        # reading 100 DN2, so that variances of neighbours differ by less than a factor of ten
        none, numbers = np.zeros((0, 0), np.float32), np.array([0.23, 100, 0], np.float32)
        noise.append(NoiseTables(*images, none, none, numbers))
    return tuple(noise)


def variances(light, noise):
    """Shot noise, reading and rounding of each camera; then dark and flat."""
    new, fixed = [], []
    for image, one in zip(light.light.astype(float), noise, strict=True):
        per_gain, read_var, _ = one.numbers.astype(float)
        scale, dark_var, flat_var = (
            table.astype(float) for table in (one.per_flat, one.dark_var, one.flat_var)
        )
        new.append((np.maximum(image / scale, 0) * per_gain + read_var) * scale**2)
        fixed.append(dark_var * scale**2 + image**2 * flat_var)
    return np.array(new, np.float32), np.array(fixed, np.float32)


def camera_map(shape, *, rough=False, orientation="normal"):
    """A rotation with a magnification; `rough` adds a random displacement of each pixel."""
    rng = np.random.default_rng(3)
    y, x = np.indices(shape)
    dx = 1.3 + 0.02 * x - 0.013 * y + rough * rng.normal(0, 1, shape)
    dy = -2.6 + 0.011 * x + 0.017 * y + rough * rng.normal(0, 1, shape)
    if min(shape) > 8:
        dx[3, 5] = dy[4, 6] = np.nan
    return CameraMap(
        dx.astype(np.float32),
        dy.astype(np.float32),
        rng.uniform(0.01, 0.02, shape).astype(np.float32),
        rng.uniform(size=shape) < 0.99,
        rng.uniform(size=shape) < 0.01,
        1.0,
        MapKind.SURFACE,
        settings=RegistrationSettings(orientation=orientation),
    )


def map_with(dx, dy, shape, *, std=0.01, overlap=True, **settings):
    """The map of a displacement that is known, everywhere well."""

    def image(values, kind=np.float32):
        return np.broadcast_to(values, shape).astype(kind)

    images = image(dx), image(dy), image(std), image(overlap, bool), image(False, bool)
    return CameraMap(*images, 0.9, MapKind.SURFACE, settings=RegistrationSettings(**settings))


def ratio_images(log_ratio, variance=1e-4, *, fixed=0.0, shared=0.0, flags=0):
    """Images (y, x) or (frame, y, x) of the log ratio with its variances."""
    dims = ("frame", "y", "x")[-np.ndim(log_ratio) :]
    values = {"": log_ratio, "_var": variance, "_var_fixed": fixed, "_var_shared": shared}

    def image(values, kind=np.float32):
        return dims, np.broadcast_to(values, np.shape(log_ratio)).astype(kind)

    variables = {f"log_ratio{name}": image(given) for name, given in values.items()}
    return RatioImages(xr.Dataset({**variables, "flags": image(flags, np.uint16)}))


def aligned_frames(light, variance, displacement_std=0.0):
    """Light (camera, frame, y, x) on one grid with the variance that is new in every frame."""
    dims = ("camera", "frame", "y", "x")
    images = {"signal": light, "signal_var": variance, "signal_var_fixed": 0 * light}
    variables = {name: (dims, image.astype(np.float32)) for name, image in images.items()}
    flags = dims, np.zeros(light.shape, np.uint16)
    std = ("y", "x"), np.full(light.shape[-2:], displacement_std, np.float32)
    coords = {"camera": [1, 2]}
    return AlignedFrames(xr.Dataset({**variables, "flags": flags, "displacement_std": std}, coords))


def references_of(shape, *, bad=(), **changes):
    """References of ideal cameras, with images or pairs of numbers replaced by name."""
    values = {"dark": 64.0, "dark_var": 0.0, "flat": 1.0, "flat_var": 0.0}
    values |= {"gain": (4.4, 4.4), "read_noise": (9.0, 9.0), "full_scale": (4095, 4095)} | changes
    dims, mask = ("camera", "y", "x"), np.zeros((2, *shape), bool)
    for pixel in bad:
        mask[(slice(None), *pixel)] = True
    data = {"bad": (dims, mask)}
    for name, value in values.items():
        if name in ("gain", "read_noise", "full_scale", "background_recorded"):
            data[name] = ("camera", np.array(value))
        else:
            data[name] = (dims, np.broadcast_to(value, (2, *shape)).astype(np.float32))
    return References(xr.Dataset(data, {"camera": [1, 2]}))


def unknown(gain=(False, False), read_noise=(False, False), response=(False, False)):
    """What is to be found of the noise of both cameras."""
    return NoiseUnknowns(np.array(gain), np.array(read_noise), np.array(response))


def as_corrected(light, noise):
    dims = ("camera", "frame", "y", "x")
    names = ("signal", "signal_var", "signal_var_fixed")
    images = (light.light, *variances(light, noise))
    variables = {name: (dims, image[:, None]) for name, image in zip(names, images, strict=True)}
    flags = (dims, light.flags[:, None], FLAG_ATTRS)
    return CorrectedFrames(xr.Dataset({**variables, "flags": flags}))
