"""Counts to light: dark, flat, bad pixels and saturation, with the variance of every pixel."""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.core.detector import QUANTISATION_VAR
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import CorrectedFrames, Frames, References, require

_SATURATED, _DIM, _BAD_PIXEL = int(Flag.SATURATED), int(Flag.DIM), int(Flag.BAD_PIXEL)

_FARTHEST = 5
"""Rings of neighbours searched for good pixels: larger defects stay as they were read. [px]"""


def correct_frames(
    frames: Frames, references: References, *, least_signal: float = 100.0
) -> CorrectedFrames:
    """Subtract the dark, divide by the flat, and give every pixel its variance and flags.

    Bad pixels are filled from their neighbours, because interpolation would ring about them; they
    stay flagged.

    Parameters
    ----------
    frames : Frames
        counts (camera, frame, y, x). [DN]
    references : References
        As `make_references` returns them.
    least_signal : float
        Pixels with less light than this are flagged dim. [electron]

    Returns
    -------
    CorrectedFrames
        signal [DN]; signal_var, shot noise, read noise and rounding [DN2]; signal_var_fixed, noise
        of dark and flat, the same in every frame [DN2]; flags; each (camera, frame, y, x).

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    >>> images = {name: (("camera", "y", "x"), np.full((2, 2, 2), value, np.float32))
    ...           for name, value in {"dark": 64, "dark_var": 0, "flat": 1, "flat_var": 0}.items()}
    >>> scalars = {name: ("camera", np.full(2, value))
    ...            for name, value in {"gain": 4.0, "read_noise": 0.0, "full_scale": 4095}.items()}
    >>> bad = (("camera", "y", "x"), np.zeros((2, 2, 2), bool))
    >>> references = References(xr.Dataset({**images, **scalars, "bad": bad}))
    >>> counts = np.full((2, 1, 2, 2), 1064, np.uint16)
    >>> frames = Frames(xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts)}))
    >>> light = correct_frames(frames, references)
    >>> float(light.signal[0, 0, 0, 0]), round(float(light.signal_var[0, 0, 0, 0]), 2)
    (1000.0, 250.08)
    """
    require(frames, "counts")
    require(references, "dark", "flat", "bad", "gain", "read_noise", "full_scale")
    counts = frames.counts.values

    # single precision: relative rounding of 6e-8 against a noise of 1e-2
    signal = np.empty(counts.shape, np.float32)
    variance = np.empty(counts.shape, np.float32)
    fixed = np.empty(counts.shape, np.float32)
    flags = np.empty(counts.shape, np.uint8)

    for camera in range(counts.shape[0]):
        reference = references.isel(camera=camera)
        bad = reference.bad.values
        rows, columns = np.nonzero(bad)
        for n in range(counts.shape[1]):
            _correct(
                counts[camera, n],
                reference.dark.values,
                reference.dark_var.values,
                reference.flat.values,
                reference.flat_var.values,
                bad,
                float(reference.gain),
                float(reference.read_noise),
                int(reference.full_scale),
                least_signal,
                signal[camera, n],
                variance[camera, n],
                fixed[camera, n],
                flags[camera, n],
            )
            fill_from_neighbours(signal[camera, n], bad, rows, columns)

    dims = ("camera", "frame", "y", "x")
    light = {"units": "DN", "ancillary_variables": "signal_var signal_var_fixed flags"}
    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal, light),
                "signal_var": (dims, variance, {"units": "DN2"}),
                "signal_var_fixed": (dims, fixed, {"units": "DN2"}),
                "flags": (dims, flags, FLAG_ATTRS),
            },
            frames.coords,
        )
    )


@numba.njit(nogil=True, cache=True)
def _correct(  # type: ignore[no-untyped-def]
    counts,
    dark,
    dark_var,
    flat,
    flat_var,
    bad,
    gain,
    read_noise,
    full_scale,
    least_signal,
    signal,
    variance,
    fixed,
    flags,
):
    # read noise and threshold are given in electrons, the image is in counts
    read_var = (read_noise / gain) ** 2 + QUANTISATION_VAR
    least = least_signal / gain
    for i in range(counts.shape[0]):
        for j in range(counts.shape[1]):
            light = counts[i, j] - dark[i, j]
            per_flat = 1.0 / flat[i, j]
            value = light * per_flat
            square = per_flat * per_flat

            # shot noise of light below dark is zero, and the flat scales every part alike
            signal[i, j] = value
            variance[i, j] = (max(light, 0.0) / gain + read_var) * square
            fixed[i, j] = (dark_var[i, j] + value * value * flat_var[i, j]) * square

            flag = 0
            if counts[i, j] >= full_scale:
                flag |= _SATURATED
            if light < least:
                flag |= _DIM
            if bad[i, j]:
                flag |= _BAD_PIXEL
            flags[i, j] = flag


@numba.njit(nogil=True, cache=True)
def fill_from_neighbours(signal, bad, rows, columns):  # type: ignore[no-untyped-def]
    """Replace each bad pixel by the mean of the good pixels of the smallest ring that has some."""
    height, width = signal.shape
    for n in range(rows.size):
        i, j = rows[n], columns[n]
        for reach in range(1, _FARTHEST + 1):
            total = 0.0
            count = 0
            for k in range(max(i - reach, 0), min(i + reach + 1, height)):
                for m in range(max(j - reach, 0), min(j + reach + 1, width)):
                    if not bad[k, m]:
                        total += signal[k, m]
                        count += 1

            if count > 0:
                signal[i, j] = total / count
                break
