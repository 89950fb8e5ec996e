"""Counts to light: dark, flat, bad pixels and saturation, with the variance of every pixel."""

from __future__ import annotations

import numba
import numpy as np
import xarray as xr

from erlif.core.arrays import Array, FlagImage, Image
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

    A background, where the references hold one, is scaled by the pulse energy and subtracted
    between dark and flat. Bad pixels are filled from their neighbours, because interpolation would
    ring about them; they stay flagged.

    Parameters
    ----------
    frames : Frames
        counts (camera, frame, y, x) [DN]; the coordinate pulse_energy (frame), relative to the
        mean of the run, scales the background; 1 where it is absent.
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
            if "background" in reference:
                energy = float(frames.pulse_energy[n]) if "pulse_energy" in frames.coords else 1.0
                subtract_background(
                    signal[camera, n],
                    fixed[camera, n],
                    flags[camera, n],
                    background=reference.background.values,
                    background_var=reference.background_var.values,
                    per_flat=1.0 / reference.flat.values.astype(float),
                    dark_var=reference.dark_var.values,
                    flat_var=reference.flat_var.values,
                    energy=energy,
                    recorded=float(reference.background_recorded),
                    least=least_signal / float(reference.gain),
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


def subtract_background(
    signal: Image,
    fixed: Image,
    flags: FlagImage,
    *,
    background: Image,
    background_var: Image,
    per_flat: Array,
    dark_var: Image,
    flat_var: Image,
    energy: float,
    recorded: float,
    least: float,
) -> None:
    """Take the light of the dry joint from a corrected frame of one camera, in place.

    Light is (counts - dark - energy (page - dark))/flat, where page is the mean of the dry joint:
    the error of the dark remains with the factor 1 - energy, that of the page with energy. Where
    no pages were recorded, the dark enters once and in full.

    Parameters
    ----------
    signal : array, (y, x)
        Light above the dark over the flat. [DN]
    fixed : array, (y, x)
        Its variance that repeats from frame to frame; it is made anew. [DN2]
    flags : array, (y, x)
        The bit of dim pixels is made anew.
    background, background_var : array, (y, x)
        Light of the dry joint and the variance of its mean page. [DN, DN2]
    per_flat : array, (y, x)
        One over the flat. [1]
    dark_var, flat_var : array, (y, x)
        Variances of dark and flat. [DN2, 1]
    energy : float
        Pulse energy relative to that of the dry joint. [1]
    recorded : float
        1 where pages were recorded above the same dark, else 0.
    least : float
        Light below which a pixel is dim. [DN]

    Examples
    --------
    >>> signal, one = np.full((1, 1), 1000.0, np.float32), np.ones((1, 1), np.float32)
    >>> subtract_background(
    ...     signal, 0 * one, np.zeros((1, 1), np.uint8), background=10 * one, background_var=one,
    ...     per_flat=np.ones((1, 1)), dark_var=one, flat_var=0 * one, energy=1.1,
    ...     recorded=1.0, least=20.0
    ... )
    >>> float(signal[0, 0])
    989.0
    """
    signal -= (energy * background) * per_flat
    of_dark = (1 - energy * recorded) ** 2 * dark_var + energy**2 * background_var
    fixed[:] = (of_dark + np.square(signal, dtype=float) * flat_var) * per_flat**2
    dim = signal < least * per_flat
    flags[dim] |= np.uint8(_DIM)
    flags[~dim] &= np.uint8(0xFF ^ _DIM)


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
