"""Camera 2 onto the pixel grid of camera 1, with its noise and its flags.

The light is interpolated by cubic B-splines (`erlif.registration.interpolation`), the variance
bilinearly, and every flag reaches all pixels that depend on the flagged one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import AlignedFrames, CorrectedFrames, require
from erlif.core.speed.kernels import njit
from erlif.registration.camera_map import CameraMap
from erlif.registration.interpolation import NOTHING_BAD, sample_rows, spline_coefficients
from erlif.registration.settings import orient

_OUTSIDE, _POOR = int(Flag.OUTSIDE_OVERLAP), int(Flag.POOR_REGISTRATION)
_LIGHT = ("signal", "signal_var", "signal_var_fixed")
_at = np.uint64  # an index that cannot count from the end, as in `interpolation`


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
    >>> flags = (dims, np.zeros(light.shape, np.uint16))
    >>> frames = xr.Dataset({"signal": (dims, light), **noise, "flags": flags})
    >>> aligned = align_frames(CorrectedFrames(frames), camera_map)
    >>> aligned.signal.values[1, 0, 2].round(3)
    array([ 1.,  1.,  9.,  1.,  1., nan], dtype=float32)
    >>> [Flag(int(bits)).name for bits in aligned.flags.values[1, 0, 2, [4, 5]]]
    [None, 'OUTSIDE_OVERLAP']
    """
    return align_bands(frames, camera_map, [slice(0, frames.sizes["y"])], drift=drift)[0]


def align_bands(
    frames: CorrectedFrames,
    camera_map: CameraMap,
    bands: Sequence[slice],
    *,
    drift: Array | None = None,
) -> tuple[AlignedFrames, ...]:
    """Some rows of camera 1, with camera 2 at the points where it has its pixels.

    Parameters
    ----------
    frames, camera_map, drift
        As for `align_frames`.
    bands : sequence of slice
        The rows, start and stop. [px]

    Returns
    -------
    tuple of AlignedFrames
        One for each band, as `align_frames` returns them for all rows; the mean factor
        interpolation is that of the band.

    Raises
    ------
    ErlifError
        If a variable of the frames is missing.

    Examples
    --------
    >>> from erlif.registration import CameraMap, MapKind
    >>> flat = np.zeros((5, 6), np.float32)
    >>> camera_map = CameraMap(flat + 1, flat, flat, flat == 0, flat > 0, 1.0, MapKind.SURFACE)
    >>> dims = ("camera", "frame", "y", "x")
    >>> none = (dims, np.zeros((2, 1, 5, 6)))
    >>> light = np.broadcast_to(np.arange(5.0)[:, None], (2, 1, 5, 6))
    >>> flags = (dims, np.zeros(light.shape, np.uint16))
    >>> frames = xr.Dataset({"signal": (dims, light), "signal_var": none,
    ...     "signal_var_fixed": none, "flags": flags})
    >>> (band,) = align_bands(CorrectedFrames(frames), camera_map, [slice(2, 4)])
    >>> band.signal.values[1, 0, :, 0].round(3)
    array([2., 3.], dtype=float32)
    """
    names = (*_LIGHT, "flags")
    require(frames, *names)

    count, width = frames.sizes["frame"], frames.sizes["x"]
    turn = camera_map.settings.orientation
    offsets = np.zeros((count, 2)) if drift is None else np.asarray(drift, float)
    dx, dy = (
        np.ascontiguousarray(field, np.float32)
        for field in (camera_map.displacement_x, camera_map.displacement_y)
    )

    aligned: list[dict[str, AnyArray]] = []
    for band in bands:
        shape = (2, count, band.stop - band.start, width)
        of_band: dict[str, AnyArray] = {name: np.empty(shape, np.float32) for name in _LIGHT}
        of_band["flags"] = np.empty(shape, np.uint16)
        for name, out in of_band.items():
            out[0] = frames[name].values[0, :, band]  # camera 1 keeps its pixels
        aligned.append(of_band | {"interpolation": np.ones(count)})

    moved = np.empty(dx.shape, np.float32)
    for n, (x, y) in enumerate(offsets.astype(np.float32)):
        light, variance, fixed, flags = (
            np.ascontiguousarray(orient(frames[name].values[1, n], turn)) for name in names
        )
        spread = np.empty(flags.shape, np.uint16)
        spread_flags(flags, spread)
        noise = np.asarray(variance, np.float32), np.asarray(fixed, np.float32), spread
        spline = spline_coefficients(light)

        for band, of_band in zip(bands, aligned, strict=True):
            outs = tuple(of_band[name][1, n] for name in names)
            rows = band.start, band.start, band.stop
            total, points = sample_rows(
                spline, dx, dy, x, y, NOTHING_BAD, *noise, moved, *outs[1:], *rows
            )
            outs[0][:] = moved[band]
            of_band["interpolation"][n] = total / points if points else 1.0

            # NaN drift leaves no pixel valid, and the reason belongs in the flags
            outs[3][~camera_map.overlap[band]] |= _OUTSIDE
            outs[3][camera_map.poor[band] | np.isnan(x)] |= _POOR

    return tuple(
        _as_frames(frames, camera_map, band, of_band)
        for band, of_band in zip(bands, aligned, strict=True)
    )


def _as_frames(
    frames: CorrectedFrames, camera_map: CameraMap, band: slice, of_band: dict[str, AnyArray]
) -> AlignedFrames:
    """The images of a band with names, units and coordinates."""
    dims = ("camera", "frame", "y", "x")
    std = camera_map.displacement_std[band]
    return AlignedFrames(
        xr.Dataset(
            {
                **{name: (dims, of_band[name], frames[name].attrs) for name in _LIGHT},
                "flags": (dims, of_band["flags"], FLAG_ATTRS),
                "displacement_std": (("y", "x"), std, {"units": "px"}),
                "interpolation": ("frame", of_band["interpolation"], {"units": "1"}),
            },
            frames.isel(y=band).coords,
        )
    )


@njit(nogil=True, cache=True)
def spread_flags(flags, out):  # type: ignore[no-untyped-def]
    """All flags of the 4 x 4 pixels whose second row and second column is this pixel.

    Parameters
    ----------
    flags : array, (y, x)
    out : array, (y, x)
        Filled.
    """
    height, width = flags.shape
    near = np.empty(width + 3, np.uint16)
    for i in range(height):
        above, below = max(i - 1, 0), min(i + 1, height - 1)
        last = min(i + 2, height - 1)
        for t in range(width):
            x = _at(t)
            near[_at(t + 1)] = flags[above, x] | flags[i, x] | flags[below, x] | flags[last, x]
        near[0], near[width + 1], near[width + 2] = near[1], near[width], near[width]
        for t in range(width):
            along = near[_at(t)] | near[_at(t + 1)] | near[_at(t + 2)] | near[_at(t + 3)]
            out[i, _at(t)] = along
