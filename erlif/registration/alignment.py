"""Camera 2 onto the pixel grid of camera 1, with its noise and its flags.

The light is interpolated by cubic B-splines (`erlif.registration.interpolation`), the variance
bilinearly, and every flag reaches all pixels that depend on the flagged one.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, FlagImage
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, CorrectedFrames, require
from erlif.registration.camera_map import CameraMap
from erlif.registration.interpolation import NOTHING_BAD, sample_rows, spline_coefficients
from erlif.registration.settings import orient

_OUTSIDE, _POOR = int(Flag.OUTSIDE_OVERLAP), int(Flag.POOR_REGISTRATION)


def align_frames(
    frames: CorrectedFrames, camera_map: CameraMap, *, drift: Array | None = None
) -> AlignedFrames:
    """Sample camera 2 at the points where camera 1 has its pixels.

    The signal is interpolated by a cubic B-spline; its variance is that of the neighbourhood times
    the factor by which the spline averages noise at this sub-pixel position. A pixel inherits the
    flags of the sixteen pixels that it is interpolated from.

    Parameters
    ----------
    frames : CorrectedFrames
        signal, signal_var, signal_var_fixed and flags (camera, frame, y, x).
    camera_map : CameraMap
        The fixed map from camera 1 to camera 2.
    drift : array, (frame, 2), optional
        Translation (x, y) of camera 2 in each frame, on top of the map; NaN where it is not known,
        which flags the frame poor_registration. [px]

    Returns
    -------
    AlignedFrames
        As `frames`, with displacement_std (y, x), the standard deviation of one component of the
        map [px], and interpolation (frame), the mean factor by which the interpolation lowers the
        variance of a pixel of camera 2, over all pixels that it sees.

    Raises
    ------
    ErlifError
        If a variable of the frames is missing.

    Examples
    --------
    Camera 2 has a bright point one column to the right of camera 1.

    >>> from erlif.registration import CameraMap, MapKind
    >>> flat = np.zeros((5, 6), np.float32)
    >>> camera_map = CameraMap(flat + 1, flat, flat, flat == 0, flat > 0, 1.0, MapKind.SURFACE)
    >>> light = np.ones((2, 1, 5, 6), np.float32)
    >>> light[1, 0, 2, 3] = 9.0
    >>> dims = ("camera", "frame", "y", "x")
    >>> noise = {name: (dims, light * 0) for name in ("signal_var", "signal_var_fixed")}
    >>> flags = (dims, np.zeros(light.shape, np.uint8))
    >>> frames = xr.Dataset({"signal": (dims, light), **noise, "flags": flags})
    >>> aligned = align_frames(CorrectedFrames(frames), camera_map)
    >>> aligned.signal.values[1, 0, 2].round(3)
    array([ 1.,  1.,  9.,  1.,  1., nan], dtype=float32)
    >>> [Flag(int(bits)).name for bits in aligned.flags.values[1, 0, 2, [4, 5]]]
    [None, 'OUTSIDE_OVERLAP']
    """
    names = ("signal", "signal_var", "signal_var_fixed", "flags")
    require(frames, *names)
    shape = frames.signal.shape
    aligned = {name: np.empty(shape, np.float32) for name in names[:3]}
    aligned["flags"] = np.empty(shape, np.uint8)
    for name, out in aligned.items():
        out[0] = frames[name].values[0]  # camera 1 keeps its pixels

    turn = camera_map.settings.orientation
    count = aligned["signal"].shape[1]
    offsets = np.zeros((count, 2)) if drift is None else np.asarray(drift, float)
    dx, dy = (
        np.ascontiguousarray(field, np.float32)
        for field in (camera_map.displacement_x, camera_map.displacement_y)
    )
    averaging = np.ones(count)

    for n, (x, y) in enumerate(offsets.astype(np.float32)):
        light, variance, fixed, flags = (
            np.ascontiguousarray(orient(frames[name].values[1, n], turn)) for name in names
        )
        spread = np.empty(flags.shape, np.uint8)
        spread_flags(flags, spread)
        moved = tuple(aligned[name][1, n] for name in names)
        noise = np.asarray(variance, np.float32), np.asarray(fixed, np.float32), spread
        total, points = sample_rows(  # type: ignore[call-arg]
            spline_coefficients(light), dx, dy, x, y, NOTHING_BAD, *noise, *moved, 0, 0, len(dx)
        )
        averaging[n] = total / points if points else 1.0

        # NaN drift leaves no pixel valid, and the reason belongs in the flags
        aligned["flags"][1, n][~camera_map.overlap] |= _OUTSIDE
        aligned["flags"][1, n][camera_map.poor | np.isnan(x)] |= _POOR

    dims = ("camera", "frame", "y", "x")
    described = {name: (dims, aligned[name], frames[name].attrs) for name in names[:3]}
    return AlignedFrames(
        xr.Dataset(
            {
                **described,
                "flags": (dims, aligned["flags"], FLAG_ATTRS),
                "displacement_std": (("y", "x"), camera_map.displacement_std, {"units": "px"}),
                "interpolation": ("frame", averaging, {"units": "1"}),
            },
            frames.coords,
        )
    )


def spread_flags(flags: FlagImage, out: FlagImage) -> None:
    """All flags of the 4 x 4 pixels whose second row and second column is this pixel."""
    height, width = flags.shape
    near = np.pad(flags, (1, 2), mode="edge")
    along = near[:, :width] | near[:, 1 : width + 1] | near[:, 2 : width + 2] | near[:, 3:]
    out[:] = along[:height] | along[1 : height + 1] | along[2 : height + 2] | along[3:]
