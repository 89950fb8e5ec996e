"""A patch of known film, watched over the run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.errors import ConfigError
from erlif.core.notes import Level, Note
from erlif.core.variables import FILM
from erlif.io.settings import ReferenceSettings
from erlif.pipeline.engines.results import TriggerResult
from erlif.trend import Region

_SMALLEST = 8
"""Rows and columns of a patch, at least. [px]"""

_DEVIANT = 3.0
"""Standard deviations from which on a deviation is reported."""


def find_patch(
    reference: ReferenceSettings, *, pitch: float, shape: tuple[int, int]
) -> Region | None:
    """Rows and columns of the patch.

    Parameters
    ----------
    reference : ReferenceSettings
    pitch : float
        Size of a pixel. [mm]
    shape : tuple of int
        Rows and columns of a frame.

    Returns
    -------
    Region or None
        None where the settings name no patch.

    Raises
    ------
    ConfigError
        If fewer than 8 x 8 pixels of the image lie in it.
    """
    region = reference.region
    if region is None:
        return None
    columns, rows = (
        slice(max(int(np.ceil(low / pitch)), 0), min(int(high / pitch) + 1, size))
        for (low, high), size in ((region.x, shape[1]), (region.y, shape[0]))
    )
    if min(columns.stop - columns.start, rows.stop - rows.start) < _SMALLEST:
        raise ConfigError(
            f"Expected a reference patch of at least {_SMALLEST} x {_SMALLEST} pixels within the "
            f"image, x 0 to {(shape[1] - 1) * pitch:.2f} mm and y 0 to "
            f"{(shape[0] - 1) * pitch:.2f} mm; region of [reference] is x = {list(region.x)}, "
            f"y = {list(region.y)}. Correct it in run.toml."
        )
    return Region(rows, columns)


def describe_reference(
    results: Sequence[TriggerResult], reference: ReferenceSettings, calibration: Calibration
) -> tuple[dict[str, Any], list[Note]]:
    """Film of the patch at each trigger, and whether it deviates from the known one.

    Parameters
    ----------
    results : sequence of TriggerResult
        In the order of the triggers.
    reference : ReferenceSettings
    calibration : Calibration

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
    film, random = np.array([_average(result, calibration) for result in results]).T.reshape(2, -1)
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
    """Deviation of the mean, in units of its error."""
    seen = np.isfinite(film) & (random > 0)
    if not seen.any():
        text = "the patch has no valid pixels, or its ratio lies outside the calibrated range"
        return [Note(Level.WARNING, "reference", text)]
    weight = random[seen] ** -2.0
    mean = float((weight * film[seen]).sum() / weight.sum())
    std = float(
        np.sqrt(1 / weight.sum() + uncertainty**2 + float(calibration.thickness_std(known)) ** 2)
    )
    stated = f"{mean:.3f} um measured, {known:.3f} um known, difference {mean - known:+.3f} um"
    if abs(mean - known) <= _DEVIANT * std:
        return [Note(Level.NOTE, "reference", f"{stated} with a standard deviation of {std:.3f}")]
    return [
        Note(
            Level.WARNING,
            "reference",
            f"{stated}, {abs(mean - known) / std:.1f} standard deviations of {std:.3f} um: dyes, "
            "filters or light have changed since the fixture was photographed, or the patch is "
            "not as thick. Calibrate again, and look for light that is not film",
        )
    ]
