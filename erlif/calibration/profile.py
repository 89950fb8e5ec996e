"""The profile of a fixture as a coordinate measuring machine (CMM) wrote it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.core.notes import Note, remark, warn
from erlif.io.ingest.logs.profiles import find_columns, read_columns
from erlif.io.ingest.logs.table import LogUse
from erlif.io.ingest.logs.text import read_log_table

# Fewest points of a profile: beside K, p and q, five degrees of freedom remain.
MINIMUM_POINTS = 8

# Largest film of a calibration; published ranges of the method end at 400 um. [um]
THICKEST = 1000.0

# Largest film of a fixture that has none to measure: a pixel needs some tenths. [um]
THINNEST = 0.1

# Longest profile: no field of two cameras is as wide. [mm]
LONGEST = 1000.0

# Largest value of a profile: 100 m along it, or a film of 10 cm. [mm, um]
LARGEST_VALUE = 1e5

_LINE_DEGREE = 40  # highest of the polynomial that follows the form of a line
_SURFACE_DEGREE = 16  # the same for a surface, in both axes together
_POINTS_PER_TERM = 3
_SMALLEST_RESIDUAL = 1e-9  # of chi-square, so that exact data keep a finite logarithm
_LINE = 1e-3  # extent across by extent along, below which a scan is a line


# Columns without which there is no profile.
_NEEDED = ("x_mm", "thickness_um")

_USE = LogUse(
    CalibrationError,
    column="call it {quantity}, or by a usual name with its unit, as Gap [um]",
    unit="write it behind the name, as x_mm, thickness_um or Gap [um]",
    bad_rows="Correct the cell, or leave the row out.",
    name="profile in fixture.toml",
)


@dataclass(frozen=True)
class Profile:
    """Thickness of a fixture by a coordinate measuring machine.

    Attributes
    ----------
    position : Array
        Position along the profile, (point,), or on the surface, (point, 2). [mm]
    thickness : Array
        Film thickness, (point,). [um]
    uncertainty : Array | None
        Standard deviation of each thickness, (point,); None where the file states none. [um]
    notes : tuple[Note, ...]
        What was corrected when the file was read.
    """

    position: Array
    thickness: Array
    uncertainty: Array | None
    notes: tuple[Note, ...] = ()

    @cached_property
    def surface_gradient(self) -> Array:
        """Gradient of a surface along its axes at each point, (point, 2). [um/mm]"""
        return gradient_of_thickness(self.position, self.thickness, self.uncertainty)


def read_profile(path: Path) -> Profile:
    """Read a CMM profile, ``x_mm,thickness_um[,uncertainty_um]`` or with ``y_mm`` after ``x_mm``.

    The file may have any form that a log may have, with names and units of its own.

    Points out of order are sorted and repeated ones averaged; the notes report it.

    A scan along x at one y (to a thousandth of its length) is a line: its position is x alone and
    its y is left out. As for a file without y_mm, the film is assumed constant across the
    profile, so that all pixels across it are used.

    Parameters
    ----------
    path : path
        Text file with a header.

    Returns
    -------
    Profile
        At least eight points: position [mm], thickness [um], uncertainty [um] where stated.

    Raises
    ------
    CalibrationError
        If the file is missing, its header differs, a value is no number, fewer than eight points
        remain, or x does not change along the profile.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     path = Path(directory) / "wedge.csv"
    ...     lines = ["x_mm,thickness_um", *(f"{x},{0.5 * x}" for x in range(8))]
    ...     _ = path.write_text("\\n".join(lines))
    ...     profile = read_profile(path)
    >>> profile.thickness[[0, -1]]
    array([0. , 3.5])
    """
    notes: list[Note] = []
    header, values, rows = _read_table(path, notes)
    stated = header[-1] == "uncertainty_um"
    _check_table(header, values, rows, path.name, stated=stated)
    values, axes = _find_axes(header, values, path.name, notes)
    values = _sort_and_merge(values, axes, path.name, notes, stated=stated)

    if len(values) < MINIMUM_POINTS:
        raise CalibrationError(
            f"Expected at least {MINIMUM_POINTS} points in {path.name}; got {len(values)}. Measure "
            "the profile more closely."
        )
    uncertainty = values[:, -1] if stated else None
    position = values[:, :2] if axes == 2 else values[:, 0]
    return Profile(position, values[:, axes], uncertainty, tuple(notes))


def _check_table(
    header: list[str], values: Array, rows: Sequence[int], name: str, *, stated: bool
) -> None:
    """Refuse uncertainties that are none, thicknesses in another unit, and heights."""
    if stated and np.any(values[:, -1] <= 0):
        raise CalibrationError(
            f"Expected positive values of uncertainty_um in {name}; row "
            f"{rows[int(np.argmax(values[:, -1] <= 0))]} has none. Leave the column out if the "
            "uncertainty is not known."
        )
    thickness = values[:, header.index("thickness_um")]
    if thickness.size and np.median(thickness) > THICKEST:
        raise CalibrationError(
            f"Expected films of at most {THICKEST:g} um in {name}; half of them are thicker than "
            f"{np.median(thickness):g} um, as numbers in nm would be. Give thickness_um in um."
        )
    if np.median(thickness) < 0:
        raise CalibrationError(
            f"Expected film thicknesses in {name}; half of them are below {np.median(thickness):g} "
            "um, as heights of a surface are. Write the distance to the window."
        )
    if thickness.max() < THINNEST:
        raise CalibrationError(
            f"Expected films above {THINNEST:g} um in {name}; the thickest has {thickness.max():g} "
            "um, as numbers in mm would have. Give thickness_um in um."
        )


def _find_axes(header: list[str], values: Array, name: str, notes: list[Note]) -> tuple[Array, int]:
    """Columns without a constant y, and the number of axes: one for a line, two for a surface."""
    surface = "y_mm" in header
    if len(values) < MINIMUM_POINTS:
        return values, 1 + surface  # refused later, with the count that remains after averaging

    along, across = float(np.ptp(values[:, 0])), float(np.ptp(values[:, 1])) if surface else 0.0
    if along <= _LINE * across:
        raise CalibrationError(
            f"Expected x_mm to change along the profile in {name}; it is {values[0, 0]:g} at all "
            "points. Give a scan along y with y_mm as x_mm, and direction in fixture.toml turned "
            "by 90 deg."
        )
    if along > LONGEST:
        raise CalibrationError(
            f"Expected a profile of at most {LONGEST:g} mm in {name}; x_mm spans {along:g} mm, as "
            "numbers in um would. Give x_mm in mm."
        )
    if not surface:
        return values, 1
    if across > _LINE * along:
        return values, 2

    # a CMM keeps y of a line scan to its own error only
    text = (
        f"a line profile along x_mm, at y_mm {values[:, 1].mean():.4g}; y_mm was left out and the "
        "film assumed constant across the profile"
    )
    notes.append(remark(name, text))
    return np.delete(values, 1, axis=1), 1


def _sort_and_merge(
    values: Array, axes: int, name: str, notes: list[Note], *, stated: bool
) -> Array:
    """Rows in the order of x_mm, repeated positions averaged."""
    order = np.lexsort(values[:, :axes].T[::-1])
    if np.any(order != np.arange(len(order))) and axes == 1:
        text = "the points are not in the order of x_mm; they were sorted"
        notes.append(warn(name, text))
        values = values[order]

    places, group = np.unique(values[:, :axes], axis=0, return_inverse=True)
    if len(places) == len(values):
        return values
    text = f"{len(values) - len(places)} points repeat a position; repeated points were averaged"
    notes.append(warn(name, text))
    count = np.bincount(group)
    merged = np.stack([np.bincount(group, column) / count for column in values.T], axis=1)
    if stated:
        merged[:, -1] /= np.sqrt(count)
    return merged


def _read_table(path: Path, notes: list[Note]) -> tuple[list[str], Array, Sequence[int]]:
    """Names of the columns, the numbers (row, column) under them, and the numbers of the rows."""
    table = read_log_table(path, _NEEDED, _USE)
    found = find_columns(table, "profile")
    heights = found.pop("height")
    if heights and not found["thickness_um"]:
        raise CalibrationError(
            f"Expected the film thickness of the fixture in {path.name}; column "
            f"{heights[0].name!r} is a height of its surface. Write the distance to the window, as "
            "thickness_um or Gap [um]."
        )
    columns, remarks = read_columns(table, found, _NEEDED)
    if remarks:
        notes.append(remark(path.name, "; ".join(remarks)))

    values = np.column_stack(list(columns.values()))
    large = np.argwhere(np.abs(values) > LARGEST_VALUE)
    if large.size:
        row, place = large[0]
        raise CalibrationError(
            f"Expected a number up to {LARGEST_VALUE:g} in row {table.rows[row]}, column "
            f"{list(columns)[place]} of {path.name}; got {values[row, place]:g}. Correct the cell, "
            "or leave the row out."
        )
    return list(columns), values, table.rows


def gradient_of_thickness(position: Array, thickness: Array, uncertainty: Array | None) -> Array:
    """Gradient of the thickness along the axes of the profile at each point, noise smoothed away.

    It is that of the polynomial whose degree the Bayesian information criterion (Schwarz 1978)
    prefers. A straight wedge gives a straight line: noise of the CMM does not become form, which
    could be mistaken for a change of pose.

    Parameters
    ----------
    position : array, (point, axis)
        Position on the profile. [mm]
    thickness : array, (point,)
        Film thickness. [um]
    uncertainty : array, (point,), or None
        Standard deviation of each thickness; equal weights where it is not known. [um]

    Returns
    -------
    array, (point, axis)
        Gradient. [um/mm]

    Raises
    ------
    CalibrationError
        If the profile has no extent along an axis.

    Examples
    --------
    The slope of a parabola:

    >>> x = np.linspace(0, 4, 21)
    >>> slope = gradient_of_thickness(x[:, None], x**2, None)
    >>> bool(np.allclose(slope[:, 0], 2 * x))
    True
    """
    middle, reach = (position.max(axis=0) + position.min(axis=0)) / 2, np.ptp(position, axis=0) / 2
    if not reach.all():
        raise CalibrationError(
            "Expected a profile with extent along each of its axes; all points lie at one position "
            "of an axis. Give a line by its positions along it alone."
        )
    scaled = (position - middle) / reach
    known = uncertainty is not None and bool(np.isfinite(uncertainty).all())
    weight = 1 / uncertainty if uncertainty is not None and known else np.ones(thickness.size)

    # products of Legendre polynomials, ordered by total degree
    powers, terms = _list_terms(position.shape[1], thickness.size)
    functions = [legendre.legvander(axis, max(max(power) for power in powers)) for axis in scaled.T]
    design = np.ones((thickness.size, len(powers)))
    for axis, values in enumerate(functions):
        design *= values[:, [power[axis] for power in powers]]

    # Orthogonal directions, lower degrees first: the share that each explains does not depend on
    # those above it, so one decomposition serves all degrees.
    directions = np.linalg.qr(design * weight[:, None])[0]
    left = float(((thickness * weight) ** 2).sum()) - np.cumsum(
        (directions.T @ (thickness * weight)) ** 2
    )
    criterion = thickness.size * np.log(
        np.maximum(left[terms - 1], _SMALLEST_RESIDUAL)
    ) + terms * math.log(thickness.size)
    used = int(terms[np.argmin(criterion)])

    slope = np.linalg.lstsq(design[:, :used] * weight[:, None], thickness * weight, rcond=None)[0]
    coefficients = np.zeros([values.shape[1] for values in functions])
    coefficients[tuple(np.transpose(powers[:used]))] = slope
    if position.shape[1] == 1:
        slopes = [legendre.legval(scaled[:, 0], legendre.legder(coefficients))]
    else:
        u, v = scaled.T
        slopes = [
            legendre.legval2d(u, v, legendre.legder(coefficients, axis=axis)) for axis in (0, 1)
        ]
    return np.asarray(np.stack(slopes, axis=1) / reach)


def _list_terms(axes: int, points: int) -> tuple[list[tuple[int, ...]], npt.NDArray[np.int_]]:
    """Terms of a polynomial in one or two axes, as many as the points can support.

    The degree of each term in each axis, and the number of terms up to each total degree from 1 on.
    """
    if axes == 1:
        powers: list[tuple[int, ...]] = [(n,) for n in range(_LINE_DEGREE + 1)]
        counts = np.arange(2, len(powers) + 1)
    else:
        powers = [(n, total - n) for total in range(_SURFACE_DEGREE + 1) for n in range(total + 1)]
        counts = np.array(
            [(degree + 1) * (degree + 2) // 2 for degree in range(1, _SURFACE_DEGREE + 1)]
        )
    counts = counts[counts <= max(points // _POINTS_PER_TERM, counts[0])]
    return powers[: int(counts[-1])], counts
