"""Camera 2 onto the pixel grid of camera 1, with its noise and its flags."""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, CorrectedFrames, require
from erlif.registration.camera_map import CameraMap
from erlif.registration.interpolation import interpolation_variance_factor, warp
from erlif.registration.settings import orient

_OUTSIDE, _POOR = int(Flag.OUTSIDE_OVERLAP), int(Flag.POOR_REGISTRATION)


def align_frames(
    frames: CorrectedFrames, camera_map: CameraMap, *, drift: Array | None = None
) -> AlignedFrames:
    """Sample camera 2 where camera 1 has its pixels.

    The signal is interpolated by a cubic B-spline; its variance is that of the neighbourhood times the factor by which the
    spline averages noise at this sub-pixel position. A pixel inherits the flags of the sixteen it is made from.

    Parameters
    ----------
    frames : CorrectedFrames
        signal, signal_var and flags (camera, frame, y, x).
    camera_map : CameraMap
        The fixed map from camera 1 to camera 2.
    drift : array, (frame, 2), optional
        Translation (x, y) of camera 2 in each frame, on top of the map; NaN where it is not known, which flags the frame
        poor_registration. [px]

    Returns
    -------
    AlignedFrames
        As `frames`, with displacement_std (y, x), the standard deviation of one component of the map [px], and interpolation (frame), the
        mean factor by which the interpolation lowers the variance of a pixel of camera 2.
    """
    names = ("signal", "signal_var", "signal_var_fixed", "flags")
    require(frames, *names)
    signal, variance, fixed, flags = (np.empty_like(frames[name].values) for name in names)
    for out, name in zip((signal, variance, fixed, flags), names, strict=True):
        out[0] = frames[name].values[0]
    turn = camera_map.settings.orientation
    offsets = np.zeros((signal.shape[1], 2)) if drift is None else np.asarray(drift, float)
    dx, dy = camera_map.displacement_x, camera_map.displacement_y
    averaging = np.ones(signal.shape[1])
    for n, (x, y) in enumerate(offsets.tolist()):
        moving, *noise, moving_flags = (
            np.ascontiguousarray(orient(frames[name].values[1, n], turn)) for name in names
        )
        signal[1, n] = warp(moving, dx, dy, (x, y))
        factor = interpolation_variance_factor(dx, dy, (x, y))
        _gather_flags(moving_flags, dx, dy, x, y, flags[1, n])
        for own, out in zip(noise, (variance, fixed), strict=True):
            _gather(own, dx, dy, x, y, factor, out[1, n])
        averaging[n] = np.nanmean(factor) if np.isfinite(factor).any() else 1.0
        flags[1, n][~camera_map.overlap] |= _OUTSIDE
        flags[1, n][camera_map.poor | np.isnan(x)] |= _POOR
    dims = ("camera", "frame", "y", "x")
    return AlignedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal, frames.signal.attrs),
                "signal_var": (dims, variance, frames.signal_var.attrs),
                "signal_var_fixed": (dims, fixed, frames.signal_var_fixed.attrs),
                "flags": (dims, flags, FLAG_ATTRS),
                "displacement_std": (("y", "x"), camera_map.displacement_std, {"units": "px"}),
                "interpolation": ("frame", averaging, {"units": "1"}),
            },
            frames.coords,
        )
    )


@numba.njit(nogil=True, cache=True)
def _flags_of_four(flags, out):  # type: ignore[no-untyped-def]
    """All flags of the 4 x 4 pixels whose second row and second column is this pixel."""
    height, width = flags.shape
    along = np.empty((height, width), flags.dtype)
    for i in range(height):
        for j in range(width):
            before, after, far = max(j - 1, 0), min(j + 1, width - 1), min(j + 2, width - 1)
            along[i, j] = flags[i, before] | flags[i, j] | flags[i, after] | flags[i, far]
    for i in range(height):
        before, after, far = max(i - 1, 0), min(i + 1, height - 1), min(i + 2, height - 1)
        for j in range(width):
            out[i, j] = along[before, j] | along[i, j] | along[after, j] | along[far, j]


@numba.njit(nogil=True, cache=True)
def _gather_flags(flags, displacement_x, displacement_y, drift_x, drift_y, out):  # type: ignore[no-untyped-def]
    """All flags of the 4 x 4 pixels about each point."""
    height, width = flags.shape
    spread = np.empty((height, width), flags.dtype)
    _flags_of_four(flags, spread)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            x = j + displacement_x[i, j] + drift_x
            y = i + displacement_y[i, j] + drift_y
            if x >= 0.0 and y >= 0.0 and x <= width - 1 and y <= height - 1:
                out[i, j] = spread[min(int(y), height - 2), min(int(x), width - 2)]
            else:
                out[i, j] = _OUTSIDE


@numba.njit(nogil=True, cache=True)
def _gather(variance, displacement_x, displacement_y, drift_x, drift_y, factor, out):  # type: ignore[no-untyped-def]
    """Variance about each point by bilinear interpolation, times `factor`."""
    height, width = variance.shape
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            x = j + displacement_x[i, j] + drift_x
            y = i + displacement_y[i, j] + drift_y
            if not (x >= 0.0 and y >= 0.0 and x <= width - 1 and y <= height - 1):
                out[i, j] = np.nan
                continue
            k, m = min(int(y), height - 2), min(int(x), width - 2)
            v, u = y - k, x - m
            top = variance[k, m] + u * (variance[k, m + 1] - variance[k, m])
            bottom = variance[k + 1, m] + u * (variance[k + 1, m + 1] - variance[k + 1, m])
            out[i, j] = (top + v * (bottom - top)) * factor[i, j]
