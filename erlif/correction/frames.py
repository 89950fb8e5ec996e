"""Counts to light: dark, flat, bad pixels and saturation, with the variance of every pixel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray
from erlif.core.flags import FLAG_ATTRS
from erlif.core.products import CorrectedFrames, Frames, References, require
from erlif.correction.light import PairLight, measure_light, tabulate


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

    # one over the flat, and what else every frame needs of the references
    tables = tabulate(references, least_signal=least_signal)
    counts = frames.counts.values
    energies = np.ones(counts.shape[1])
    if "pulse_energy" in frames.coords:
        energies = frames.pulse_energy.values
    pairs = [
        measure_light(counts[:, n], tables, energy=float(energies[n]))
        for n in range(counts.shape[1])
    ]
    return CorrectedFrames(gather_light(pairs).assign_coords(frames.coords))


def gather_light(pairs: Sequence[PairLight]) -> CorrectedFrames:
    """Light of frame pairs as a dataset.

    Parameters
    ----------
    pairs : sequence of PairLight
        With their variances.

    Returns
    -------
    CorrectedFrames
        On dims camera, frame, y, x; the coordinates peak_camera1 and peak_camera2 (frame) are the
        highest counts [DN].

    Examples
    --------
    >>> gather_light([PairLight.empty((2, 3))]).signal.shape
    (2, 1, 2, 3)
    """
    dims = ("camera", "frame", "y", "x")
    ancillary = {"units": "DN", "ancillary_variables": "signal_var signal_var_fixed flags"}
    peaks = np.array([pair.peaks for pair in pairs], int).reshape(-1, 2)

    def joined(name: str) -> AnyArray:
        """All frames along the second axis; a single one is not copied."""
        images = [getattr(pair, name)[:, None] for pair in pairs]
        return images[0] if len(images) == 1 else np.concatenate(images, axis=1)

    return CorrectedFrames(
        xr.Dataset(
            {
                "signal": (dims, joined("light"), ancillary),
                "signal_var": (dims, joined("variance"), {"units": "DN2"}),
                "signal_var_fixed": (dims, joined("variance_fixed"), {"units": "DN2"}),
                "flags": (dims, joined("flags"), FLAG_ATTRS),
            },
            {
                "camera": [1, 2],
                "peak_camera1": ("frame", peaks[:, 0]),
                "peak_camera2": ("frame", peaks[:, 1]),
            },
        )
    )
