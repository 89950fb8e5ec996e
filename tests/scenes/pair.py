"""Light of one frame pair and a map between its cameras, with every kind of doubtful pixel."""

import numpy as np
import xarray as xr

from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import CorrectedFrames
from erlif.passes.light import PairLight
from erlif.registration import CameraMap, MapKind, RegistrationSettings

EPS = float(np.finfo(np.float32).eps)
"""A single operation in single precision is rounded by at most half of this."""


def scene(shape, seed=2, dark=0.0):
    """Light with noise, variances, and random bits on a part of the pixels."""
    rng = np.random.default_rng(seed)
    size = (2, *shape)
    light = PairLight.empty(shape)
    light.light[:] = rng.uniform(200, 3000, size)
    light.light[rng.uniform(size=size) < dark] = -5.0  # below the dark
    light.variance[:] = rng.uniform(100, 900, size)
    light.variance_fixed[:] = rng.uniform(1, 9, size)
    light.flags[:] = np.where(rng.uniform(size=size) < 0.01, rng.choice([1, 2, 4], size), 0)
    return light


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


def as_corrected(light):
    dims = ("camera", "frame", "y", "x")
    names = ("signal", "signal_var", "signal_var_fixed")
    images = (light.light, light.variance, light.variance_fixed)
    variables = {name: (dims, image[:, None]) for name, image in zip(names, images, strict=True)}
    flags = (dims, light.flags[:, None], FLAG_ATTRS)
    return CorrectedFrames(xr.Dataset({**variables, "flags": flags}))
