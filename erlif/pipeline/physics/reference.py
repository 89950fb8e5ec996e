"""A patch of known film, watched over the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.notes import Note, note_writer
from erlif.core.tables import read_table
from erlif.core.variables import FILM
from erlif.io.settings import ReferenceSettings
from erlif.pipeline.engines.results import TriggerResult, share_passed

_note = note_writer("erlif.pipeline")

_TEXTS = read_table("erlif.pipeline", "words.toml")["reference"]

# Standard deviations from which on a deviation is reported.
_DEVIANT = 3.0


def describe_reference(
    results: Sequence[TriggerResult],
    reference: ReferenceSettings,
    calibration: Calibration,
    *,
    pairs: int = 1,
) -> tuple[dict[str, Any], list[Note]]:
    """Film of the patch at each trigger, and whether it deviates from the known one.

    Parameters
    ----------
    results : sequence of TriggerResult
        In the order of the triggers.
    reference : ReferenceSettings
    calibration : Calibration
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
            _average(result, calibration.at(share))
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
    return variables, _compare(film, random, known, uncertainty, calibration)


def _average(result: TriggerResult, calibration: Calibration) -> tuple[float, float]:
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


def _compare(
    film: np.ndarray[Any, Any],
    random: np.ndarray[Any, Any],
    known: float,
    uncertainty: float,
    calibration: Calibration,
) -> list[Note]:
    """Deviation of the mean, in units of its error.

    That of `systematics` does not count: the patch is there to show it.
    """
    valid = np.isfinite(film) & (random > 0)
    if not valid.any():
        return [_note("patch_absent")]
    weight = random[valid] ** -2.0
    mean = float((weight * film[valid]).sum() / weight.sum())
    of_fixture = float(replace(calibration, systematics=None).thickness_std(known))
    std = float(np.sqrt(1 / weight.sum() + uncertainty**2 + of_fixture**2))
    off = mean - known
    stated = _TEXTS["stated"].format(mean=mean, known=known, off=off)
    if abs(off) <= _DEVIANT * std:
        return [_note("patch_agrees", stated=stated, std=std)]
    return [_note("patch_deviates", stated=stated, times=abs(off) / std, std=std)]
