"""The profile of a fixture as a coordinate measuring machine wrote it."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre

from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError

LEAST_POINTS = 8
"""Points below which a profile says too little."""

_HIGHEST_DEGREES = (40, 16)  # of the polynomial that follows the form of a line and of a surface
_LINE = 1e-3  # extent across by extent along: below it a scan is a line, whose axes the machine kept to its own error


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

    @cached_property
    def surface_gradient(self) -> Array:
        """Gradient of a surface along its axes at each point, (point, 2), see `gradient_of_thickness`. [um/mm]"""
        return gradient_of_thickness(self.position, self.thickness, self.uncertainty)


def read_profile(path: Path) -> Profile:
    """Read a CMM profile, ``x_mm,thickness_um[,uncertainty_um]`` or with ``y_mm`` after ``x_mm``.

    Points out of order are sorted and repeated ones averaged, and the notes say so.

    A scan along x at one y (to a thousandth of its length) is a line: its position is x alone, its y is left out, and as for a file
    without y_mm the film is taken to be the same across the profile, so that every pixel across it counts.

    Raises
    ------
    CalibrationError
        If the file is missing, its header is another, a value is no number, fewer than eight points are left, or x does not change
        along the profile.
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
    if len(values) >= LEAST_POINTS:  # fewer are refused below
        along, across = float(np.ptp(values[:, 0])), float(np.ptp(values[:, 1])) if surface else 0.0
        if along <= _LINE * across:
            raise CalibrationError(
                f"Expected x_mm to change along the profile in {path.name}; it is {values[0, 0]:g} at all points. A scan along y is given "
                "with y_mm as x_mm, and direction in fixture.toml turned by 90 deg."
            )
        if surface and across <= _LINE * along:
            notes.append(
                f"{path.name}: a line profile along x_mm, at y_mm {values[:, 1].mean():.4g}; y_mm was left out, and the film taken to be the "
                "same across the profile"
            )
            values, surface = np.delete(values, 1, axis=1), False
    axes = 2 if surface else 1
    order = np.lexsort(values[:, :axes].T[::-1])
    if np.any(order != np.arange(len(order))) and not surface:
        notes.append(f"{path.name}: the points are not in the order of x_mm; they were sorted")
        values = values[order]
    places, group = np.unique(values[:, :axes], axis=0, return_inverse=True)
    if len(places) < len(values):
        notes.append(
            f"{path.name}: {len(values) - len(places)} points repeat a place; repeated ones were averaged"
        )
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


def gradient_of_thickness(position: Array, thickness: Array, uncertainty: Array | None) -> Array:
    """Gradient of the thickness along the axes of the profile at each point, the noise smoothed away. [um/mm]

    It is that of the polynomial whose degree the Bayesian information criterion (Schwarz 1978) prefers. A straight wedge is found to be one:
    no form is made of the noise, from which a pose could seem to be told.

    Raises
    ------
    CalibrationError
        If the profile has no extent along an axis.
    """
    middle, reach = (position.max(axis=0) + position.min(axis=0)) / 2, np.ptp(position, axis=0) / 2
    if not reach.all():
        raise CalibrationError(
            "Expected a profile with extent along each of its axes; all points lie at one place of an axis. Give a line by its places "
            "along it alone."
        )
    scaled = (position - middle) / reach
    known = uncertainty is not None and bool(np.isfinite(uncertainty).all())
    weight = 1 / uncertainty if uncertainty is not None and known else np.ones(thickness.size)
    if position.shape[1] == 1:
        powers: list[tuple[int, ...]] = [(n,) for n in range(_HIGHEST_DEGREES[0] + 1)]
        terms = np.arange(2, len(powers) + 1)
    else:
        powers = [
            (n, total - n) for total in range(_HIGHEST_DEGREES[1] + 1) for n in range(total + 1)
        ]
        terms = np.array(
            [(degree + 1) * (degree + 2) // 2 for degree in range(1, _HIGHEST_DEGREES[1] + 1)]
        )
    terms = terms[terms <= max(thickness.size // 3, terms[0])]
    powers = powers[: int(terms[-1])]
    functions = [legendre.legvander(axis, max(max(power) for power in powers)) for axis in scaled.T]
    design = np.ones((thickness.size, len(powers)))
    for axis, values in enumerate(functions):
        design *= values[:, [power[axis] for power in powers]]
    # orthogonal directions, lower degrees first: what each explains does not depend on those above it
    directions = np.linalg.qr(design * weight[:, None])[0]
    left = float(((thickness * weight) ** 2).sum()) - np.cumsum(
        (directions.T @ (thickness * weight)) ** 2
    )
    criterion = thickness.size * np.log(np.maximum(left[terms - 1], 1e-9)) + terms * math.log(
        thickness.size
    )
    used = int(terms[np.argmin(criterion)])
    found = np.linalg.lstsq(design[:, :used] * weight[:, None], thickness * weight, rcond=None)[0]
    series = np.zeros([values.shape[1] for values in functions])
    series[tuple(np.transpose(powers[:used]))] = found
    if position.shape[1] == 1:
        slopes = [legendre.legval(scaled[:, 0], legendre.legder(series))]
    else:
        u, v = scaled.T
        slopes = [legendre.legval2d(u, v, legendre.legder(series, axis=axis)) for axis in (0, 1)]
    return np.asarray(np.stack(slopes, axis=1) / reach)
