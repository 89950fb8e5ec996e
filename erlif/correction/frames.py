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
    ring about them; they stay flagged, and have the variances of the light they are given.

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
    energies = np.ones(counts.shape[1])
    if "pulse_energy" in frames.coords:
        energies = frames.pulse_energy.values

    for camera in range(counts.shape[0]):
        reference = references.isel(camera=camera)
        bad = reference.bad.values
        rows, columns = np.nonzero(bad)
        per_flat = 1.0 / reference.flat.values.astype(float)
        for n in range(counts.shape[1]):
            energy = float(energies[n])
            light, bits = signal[camera, n], flags[camera, n]
            _correct(
                counts[camera, n],
                reference.dark.values,
                reference.flat.values,
                bad,
                float(reference.gain),
                int(reference.full_scale),
                least_signal,
                light,
                bits,
            )
            if "background" in reference:
                subtract_background(
                    light,
                    bits,
                    background=reference.background.values,
                    per_flat=per_flat,
                    energy=energy,
                    least=least_signal / float(reference.gain),
                )
            fill_from_neighbours(light, bad, rows, columns)
            variance[camera, n], fixed[camera, n] = _measure_noise(
                light, reference, per_flat=per_flat, energy=energy
            )

    dims = ("camera", "frame", "y", "x")
    units = {"units": "DN", "ancillary_variables": "signal_var signal_var_fixed flags"}
    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, signal, units),
                "signal_var": (dims, variance, {"units": "DN2"}),
                "signal_var_fixed": (dims, fixed, {"units": "DN2"}),
                "flags": (dims, flags, FLAG_ATTRS),
            },
            frames.coords,
        )
    )


@numba.njit(nogil=True, cache=True)
def _correct(  # type: ignore[no-untyped-def]
    counts, dark, flat, bad, gain, full_scale, least_signal, signal, flags
):
    # the threshold is given in electrons, the image is in counts
    least = least_signal / gain
    for i in range(counts.shape[0]):
        for j in range(counts.shape[1]):
            light = counts[i, j] - dark[i, j]
            signal[i, j] = light / flat[i, j]

            flag = 0
            if counts[i, j] >= full_scale:
                flag |= _SATURATED
            if light < least:
                flag |= _DIM
            if bad[i, j]:
                flag |= _BAD_PIXEL
            flags[i, j] = flag


def _measure_noise(
    signal: Image, reference: xr.Dataset, *, per_flat: Array, energy: float
) -> tuple[Array, Array]:
    """Variances of the light of one camera, new in every frame and the same in every frame.

    The error of the dark remains with the factor 1 - energy where a background is subtracted that
    was recorded above the same dark, that of the background with energy.
    """
    # read noise is given in electrons, the image is in counts
    gain, square = float(reference.gain), per_flat**2
    read_var = (float(reference.read_noise) / gain) ** 2 + QUANTISATION_VAR
    light, of_dark = signal / per_flat, np.asarray(reference.dark_var.values, float)
    if "background" in reference:
        light = light + energy * reference.background.values
        of_dark = (1 - energy * float(reference.background_recorded)) ** 2 * of_dark
        of_dark = of_dark + energy**2 * reference.background_var.values

    # shot noise of light below dark is zero, and the flat scales every part alike
    variance = (np.maximum(light, 0.0) / gain + read_var) * square
    of_flat = np.square(signal, dtype=float) * reference.flat_var.values
    return variance, (of_dark + of_flat) * square


def subtract_background(
    signal: Image,
    flags: FlagImage,
    *,
    background: Image,
    per_flat: Array,
    energy: float,
    least: float,
) -> None:
    """Take the light of the dry joint from a corrected frame of one camera, in place.

    Light is (counts - dark - energy (page - dark))/flat, where page is the mean of the dry joint.

    Parameters
    ----------
    signal : array, (y, x)
        Light above the dark over the flat. [DN]
    flags : array, (y, x)
        The bit of dim pixels is made anew.
    background : array, (y, x)
        Light of the dry joint. [DN]
    per_flat : array, (y, x)
        One over the flat. [1]
    energy : float
        Pulse energy relative to that of the dry joint. [1]
    least : float
        Light below which a pixel is dim. [DN]

    Examples
    --------
    >>> signal, one = np.full((1, 1), 1000.0, np.float32), np.ones((1, 1), np.float32)
    >>> subtract_background(
    ...     signal, np.zeros((1, 1), np.uint8), background=10 * one, per_flat=np.ones((1, 1)),
    ...     energy=1.1, least=20.0
    ... )
    >>> float(signal[0, 0])
    989.0
    """
    signal -= (energy * background) * per_flat
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
