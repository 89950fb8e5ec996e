"""Light of a run that is not film: found, reported, and subtracted where that is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import Calibration
from erlif.core.arrays import Array
from erlif.core.notes import Level, Note
from erlif.core.products import References
from erlif.ingest import FramePairs
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines import Threads
from erlif.pipeline.results import FrameResult
from erlif.ratio import LightCells, cell_places, sample_cells
from erlif.trend import BackgroundEstimate, LightRecord, estimate_background

_MOST_FRAMES = 400
"""Frames of an estimate, spread over the run: their number bounds memory and time."""


def choose_frames(pairs: FramePairs) -> frozenset[int]:
    """Frames whose light is kept for the estimate of a background.

    Parameters
    ----------
    pairs : FramePairs

    Returns
    -------
    frozenset of int
    """
    return frozenset(pairs.spread(_MOST_FRAMES))


def measure_cells(chain: FrameChain, *, workers: int | None = None) -> dict[int, LightCells]:
    """Light and ratio in the cells of the frames that `choose_frames` names.

    Parameters
    ----------
    chain : FrameChain
    workers : int, optional
        Threads; default: one per processor.

    Returns
    -------
    dict of int to LightCells
    """

    def measure(frame: int) -> LightCells:
        pair = chain.measure(frame)
        return sample_cells(pair.light_one, pair.log_ratio, pair.variance, pair.flags)

    cells: dict[int, LightCells] = {}
    Threads(workers).compute(measure, sorted(choose_frames(chain.pairs)), cells.__setitem__)
    return cells


def kept_cells(frames: Sequence[FrameResult], pairs: FramePairs) -> dict[int, LightCells]:
    """The same from what was kept while the films were measured."""
    chosen = choose_frames(pairs)
    return {one.frame: one.cells for one in frames if one.frame in chosen}


def find_background(
    cells: dict[int, LightCells], calibration: Calibration, energies: Array | None
) -> BackgroundEstimate | None:
    """Estimate the background of a run.

    Parameters
    ----------
    cells : dict of int to LightCells
        By frame.
    calibration : Calibration
    energies : array, (frame,), optional
        Relative pulse energies of all frames of the run, from the log. [1]

    Returns
    -------
    BackgroundEstimate or None
        None where the run does not determine it.
    """
    frames = sorted(cells)
    if not frames:
        return None
    parts = np.array([cells[frame] for frame in frames], float).transpose(1, 0, 2)
    found = estimate_background(
        LightRecord(*parts),
        cell_places(),
        calibration,
        energies=None if energies is None else energies[frames],
    )
    return found if found is not None and found.determined else None


def describe_background(
    estimate: BackgroundEstimate | None, calibration: Calibration, *, corrected: bool
) -> tuple[dict[str, Any], list[Note]]:
    """Variables of the film and notes about a background.

    Parameters
    ----------
    estimate : BackgroundEstimate or None
    calibration : Calibration
    corrected : bool
        Whether it was to be subtracted.

    Returns
    -------
    variables : dict of str to variable
        background and background_std on dim camera; none where the run does not determine them.
    notes : list of Note
    """
    if estimate is None:
        level, more = Level.NOTE, ""
        if corrected:
            level, more = Level.WARNING, "; nothing was subtracted"
        text = (
            "light and films of this run do not determine light that is not film: it needs a dozen "
            f"frames and films that differ{more}. Frames of the dry joint (background in [camera1] "
            "and [camera2]) measure it"
        )
        return {}, [Note(level, "background", text)]

    attrs = {
        "units": "1",
        "long_name": "light that is not film over the median light of the camera",
        "comment": "even over the image; estimated from light and films of the run",
        "subtracted": str(corrected).lower(),
        "chi_square": estimate.chi_square,
        "detectable": estimate.detectable,
    }
    std = {"units": "1", "long_name": "its standard deviation, calibration included"}
    variables = {
        "background": ("camera", estimate.share, attrs),
        "background_std": ("camera", estimate.std, std),
    }
    return variables, [_describe(estimate, calibration, corrected=corrected)]


def _describe(estimate: BackgroundEstimate, calibration: Calibration, *, corrected: bool) -> Note:
    """What was found, in one line."""
    one, two = (
        f"camera {n} {100 * share:.1f} ± {100 * std:.1f} %"
        for n, (share, std) in enumerate(zip(estimate.share, estimate.std, strict=True), 1)
    )
    shares = f"{one}, {two} of the median light"
    if corrected:
        return Note(Level.NOTE, "background", f"light that is not film subtracted: {shares}")
    if not estimate.significant:
        return Note(
            Level.NOTE,
            "background",
            f"no light that is not film was found; {100 * estimate.detectable:.1f} % of the median "
            "light in both cameras would have been significant",
        )

    film = 0.5 * estimate.film  # thinner than the median, where the joint carries its load
    low = max(film, calibration.thickness_range[0])
    shift, std = (
        1e3 * float(value(np.array(low), calibration))
        for value in (estimate.film_shift, estimate.film_shift_std)
    )
    return Note(
        Level.WARNING,
        "background",
        f"light and films of the run do not agree without light that is not film: {shares}. Films "
        f"of {low:.1f} um then read {shift:+.0f} ± {std:.0f} nm too thick; film_mean_std and "
        "film_min_std include this shift, the maps do not. Photograph the dry joint (background in "
        '[camera1] and [camera2]), or set background = "correct" in [light]',
    )


def widen_statistics(
    film: xr.Dataset, estimate: BackgroundEstimate | None, calibration: Calibration
) -> xr.Dataset:
    """Add the shift by a background that was not subtracted to the errors of mean and minimum.

    Parameters
    ----------
    film : xarray.Dataset
        film_mean and film_min with their standard deviations. [um]
    estimate : BackgroundEstimate or None
        What is not significant changes nothing.
    calibration : Calibration

    Returns
    -------
    xarray.Dataset
    """
    if estimate is None or not estimate.significant:
        return film
    low, high = calibration.thickness_range
    for name in ("film_mean", "film_min"):
        values = np.clip(np.nan_to_num(film[name].values, nan=high), low, high)
        shift = estimate.film_shift(values, calibration)
        std = film[f"{name}_std"]
        film[f"{name}_std"] = std.copy(data=np.hypot(std.values, shift))
    return film


def subtract(chain: FrameChain, estimate: BackgroundEstimate) -> FrameChain:
    """The chain with an even background subtracted from every frame.

    Parameters
    ----------
    chain : FrameChain
        With its references.
    estimate : BackgroundEstimate

    Returns
    -------
    FrameChain
    """
    references = chain.references
    level = np.array(estimate.share * np.array(estimate.unit))
    even = level[:, None, None] * references.flat.values
    before = references.get("background", xr.zeros_like(references.flat))
    variance = references.get("background_var", xr.zeros_like(references.flat))
    recorded = references.get("background_recorded", xr.zeros_like(references.gain, dtype=bool))
    added = references.assign(
        background=before.copy(data=(before.values + even).astype(np.float32)),
        background_var=variance,
        background_recorded=recorded,
    )
    return replace(chain, correct=replace(chain.correct, references=References(added)))
