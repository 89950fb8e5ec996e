"""The profile of a fixture as a coordinate measuring machine wrote it."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from erlif.core.errors import CalibrationError

Array = npt.NDArray[np.float64]

LEAST_POINTS = 8
"""Points below which a profile says too little."""


@dataclass(frozen=True)
class Profile:
    """Thickness of a fixture as the coordinate measuring machine saw it.

    Attributes
    ----------
    position : array, (point,) or (point, 2)
        Place along the profile, or on the surface. [mm]
    thickness : array, (point,)
        [um]
    uncertainty : array, (point,) or None
        Standard deviation of each thickness; None where the file gives none. [um]
    notes : tuple of str
        What had to be mended.
    """

    position: Array
    thickness: Array
    uncertainty: Array | None
    notes: tuple[str, ...] = ()


def read_profile(path: Path) -> Profile:
    """Read a CMM profile, ``x_mm,thickness_um[,uncertainty_um]`` or with ``y_mm`` after ``x_mm``.

    Points out of order are sorted and repeated ones averaged, and the notes say so.

    Raises
    ------
    CalibrationError
        If the file is missing, its header is another, a value is no number, or fewer than eight points are left.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            table = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError) as error:
        raise CalibrationError(
            f"Expected the profile {path.name} as a CSV file; it cannot be read: {error}."
        ) from error
    header = [cell.strip() for cell in table[0]] if table else []
    surface = "y_mm" in header
    required = ["x_mm", "y_mm", "thickness_um"] if surface else ["x_mm", "thickness_um"]
    if header not in (required, [*required, "uncertainty_um"]):
        raise CalibrationError(
            f"Expected the header x_mm,thickness_um[,uncertainty_um] or x_mm,y_mm,thickness_um[,uncertainty_um] in {path.name}; "
            f"got {','.join(header) or 'nothing'}."
        )
    values = np.empty((len(table) - 1, len(header)))
    for n, row in enumerate(table[1:]):
        for m, name in enumerate(header):
            try:
                values[n, m] = float(row[m])
            except (ValueError, IndexError):
                values[n, m] = math.nan
            if not math.isfinite(values[n, m]):
                raise CalibrationError(
                    f"Expected a number in row {n + 2}, column {name} of {path.name}; got {row[m] if m < len(row) else 'nothing'!r}."
                )
    notes: list[str] = []
    axes = 2 if surface else 1
    order = np.lexsort(values[:, :axes].T[::-1])
    if np.any(order != np.arange(len(order))) and not surface:
        notes.append(f"{path.name}: the points are not in the order of x_mm; they were sorted")
        values = values[order]
    places, group = np.unique(values[:, :axes], axis=0, return_inverse=True)
    if len(places) < len(values):
        notes.append(f"{path.name}: {len(values) - len(places)} points repeat a place; repeated ones were averaged")
        count = np.bincount(group)
        merged = np.stack([np.bincount(group, column) / count for column in values.T], axis=1)
        if header[-1] == "uncertainty_um":
            merged[:, -1] /= np.sqrt(count)
        values = merged
    if len(values) < LEAST_POINTS:
        raise CalibrationError(
            f"Expected at least {LEAST_POINTS} points in {path.name}; got {len(values)}. Measure the profile more closely."
        )
    uncertainty = values[:, -1] if header[-1] == "uncertainty_um" else None
    if uncertainty is not None and np.any(uncertainty <= 0):
        raise CalibrationError(
            f"Expected positive values of uncertainty_um in {path.name}; row {int(np.argmax(uncertainty <= 0)) + 2} has none. "
            "Leave the column out if the uncertainty is not known."
        )
    position = values[:, :2] if surface else values[:, 0]
    return Profile(position, values[:, axes], uncertainty, tuple(notes))
