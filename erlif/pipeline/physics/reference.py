"""A patch of known film, watched over the run, and the scale of the ratio that it shows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from erlif.calibration import RatioCurve, RunCurve
from erlif.core.arrays import Array
from erlif.core.notes import Note, remark, warn
from erlif.core.variables import FILM
from erlif.io.settings import ReferenceSettings
from erlif.pipeline.engines.results import FrameResult, TriggerResult, share_passed, shares_passed
from erlif.ratio import PairRatio
from erlif.thickness import flag_beyond_maximum
from erlif.trend import Region, Texture

# Standard deviations from which on a deviation is reported.
_DEVIANT = 3.0


# Frames whose patch is valid, for the scale of the ratio at least.
_FEWEST = 6


def flag_thick_films(pair: PairRatio, calibration: RatioCurve, patch: Region | None) -> None:
    """Flag films beyond the maximum of the ratio, but the known one of a reference patch.

    Parameters
    ----------
    pair : PairRatio
        Its flags receive `Flag.ABOVE_RANGE`.
    calibration : RatioCurve
    patch : Region or None
    """
    at = (slice(0), slice(0)) if patch is None else (patch.rows, patch.columns)
    known = pair.flags[at].copy()
    flag_beyond_maximum(pair.log_ratio, pair.flags, calibration)
    pair.flags[at] = known


@dataclass(frozen=True)
class PatchScale:
    """Logarithm of the ratio on a patch, less that of its film by the calibration.

    Attributes
    ----------
    course : Array
        At the first frame, and what is added until the last, (2,). [1]
    covariance : Array
        Its covariance by the scatter of the frames, (2, 2).
    film : float
        Film of the patch. [um]
    film_std : float
        Its standard deviation. [um]
    place : tuple[float, float] | None
        Column and row of its middle; None for a patch anywhere in the picture. [px]
    """

    course: Array
    covariance: Array
    film: float
    film_std: float
    place: tuple[float, float] | None = None


def fit_patch_scale(
    lights: Mapping[int, FrameResult],
    calibration: RunCurve,
    reference: ReferenceSettings,
    *,
    pairs: int,
    patch: Region | None = None,
    texture: Texture | None = None,
) -> PatchScale | None:
    """Line through the ratio of a patch over the frames, less that of its film.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    calibration : RunCurve
    reference : ReferenceSettings
    pairs : int
        Frame pairs of the run.
    patch : Region, optional
        Its rows and columns.
    texture : Texture, optional
        What stands still in the image: on the patch it looks like another film.

    Returns
    -------
    PatchScale or None
        None without a patch, or where fewer than six frames show it.
    """
    if reference.thickness is None:
        return None
    film, film_std = 1e6 * reference.thickness, 1e6 * (reference.uncertainty or 0.0)
    frames = sorted(lights)
    means = np.array([lights[frame].patch[1:] for frame in frames], float).reshape(-1, 2)
    table = np.column_stack([shares_passed(frames, pairs), means])
    table = table[np.isfinite(table).all(axis=1)]
    if len(table) < _FEWEST:
        return None

    passed, measured, variance = table.T
    off = measured - [float(calibration.at(share).predict_log(film)) for share in passed]
    design = np.column_stack([np.ones_like(passed), passed]) / np.sqrt(variance)[:, None]
    off = off / np.sqrt(variance)
    course = np.linalg.lstsq(design, off)[0]
    scatter = float(((off - design @ course) ** 2).sum()) / (len(off) - 2)
    covariance = max(1.0, scatter) * np.linalg.inv(design.T @ design)
    place = None
    if patch is not None:
        column, row = (0.5 * (part.start + part.stop - 1) for part in (patch.columns, patch.rows))
        place = column, row
        if texture is not None:
            film_std = math.hypot(
                film_std,
                texture.over(patch, film, calibration.at(0.5)) / float(calibration.slope(film)),
            )
    return PatchScale(course, covariance, film, film_std, place)


def describe_scale(scale: PatchScale | None) -> list[Note]:
    """Note about what was taken out of the ratio; empty where nothing was."""
    if scale is None:
        return []
    first, last = scale.course[0], scale.course.sum()
    std = float(np.sqrt(scale.covariance[0, 0]))
    text = (
        f"the ratio on the patch is {100 * first:+.2f} ± {100 * std:.2f} % from that of its film "
        f"at the first frame and {100 * last:+.2f} % at the last; taken out of the films"
    )
    return [remark("reference", text)]


def describe_reference(
    results: Sequence[TriggerResult],
    reference: ReferenceSettings,
    calibration: RunCurve,
    *,
    pairs: int = 1,
) -> tuple[dict[str, Any], list[Note]]:
    """Film of the patch at each trigger, and whether it deviates from the known one.

    Parameters
    ----------
    results : sequence of TriggerResult
        In the order of the triggers.
    reference : ReferenceSettings
    calibration : RunCurve
    pairs : int
        Frame pairs of the run.

    Returns
    -------
    variables : dict of str to variable
        reference_film and reference_film_std (trigger), random and shared errors together; none
        without a patch. [um]
    notes : list of Note
    """
    if reference.thickness is None:
        return {}, []
    known = 1e6 * reference.thickness
    uncertainty = 0.0 if reference.uncertainty is None else 1e6 * reference.uncertainty
    passed = [share_passed([one.frame for one in result.frames], pairs) for result in results]
    film, random = np.array(
        [
            _average_patch(result, calibration.at(share))
            for result, share in zip(results, passed, strict=True)
        ]
    ).T.reshape(2, -1)
    shared = np.asarray(calibration.thickness_std(np.where(np.isfinite(film), film, known)))
    variables = {
        "reference_film": FILM["reference_film"].fill(
            film, thickness=known, uncertainty=uncertainty
        ),
        "reference_film_std": FILM["reference_film_std"].fill(np.hypot(random, shared)),
    }
    return variables, _note_deviation(film, random, known, uncertainty, calibration)


def _average_patch(result: TriggerResult, calibration: RunCurve) -> tuple[float, float]:
    """Film of the patch over the frames of a trigger, and its random standard deviation. [um]"""
    means = np.array([one.patch for one in result.frames]).reshape(-1, 3)
    means = means[np.isfinite(means).all(axis=1)]
    if not len(means):
        return float("nan"), float("nan")
    weight = 1 / means[:, 2]
    ratio = float((weight * means[:, 1]).sum() / weight.sum())
    table = calibration.inverse
    place = (ratio - table.start) / table.step
    if not 0 <= place <= table.thickness.size - 1:
        return float("nan"), float("nan")
    film = float(np.interp(place, np.arange(table.thickness.size), table.thickness))
    return film, float(weight.sum() ** -0.5 / calibration.slope(film))


def _note_deviation(
    film: np.ndarray[Any, Any],
    random: np.ndarray[Any, Any],
    known: float,
    uncertainty: float,
    calibration: RunCurve,
) -> list[Note]:
    """Deviation of the mean, in units of its error.

    That of `systematics` does not count: the patch is there to show it.
    """
    valid = np.isfinite(film) & (random > 0)
    if not valid.any():
        text = "the patch has no valid pixels, or its ratio lies outside the calibrated range"
        return [warn("reference", text)]
    weight = random[valid] ** -2.0
    mean = float((weight * film[valid]).sum() / weight.sum())
    of_fixture = float(calibration.calibration.thickness_std(known))
    std = float(np.sqrt(1 / weight.sum() + uncertainty**2 + of_fixture**2))
    off = mean - known
    stated = f"{mean:.3f} um measured, {known:.3f} um known, difference {off:+.3f} um"
    if abs(off) <= _DEVIANT * std:
        return [remark("reference", f"{stated} with a standard deviation of {std:.3f}")]
    text = (
        f"{stated}, {abs(off) / std:.1f} standard deviations of {std:.3f} um. Dyes, filters or "
        "light have changed since the fixture was photographed, or the patch is not as thick. "
        "Calibrate again, and look for light that is not film"
    )
    return [warn("reference", text)]
