"""Errors of a run that the known gap of its joint shows: found, reported, taken out on request."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from erlif.calibration import RunCurve
from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, remark, warn
from erlif.correction.light import BLOCK
from erlif.io.settings import JointSettings
from erlif.models.contact import contact_modulus
from erlif.pipeline.engines.results import FrameResult, shares_passed
from erlif.pipeline.physics.position import clearance_std
from erlif.pipeline.plane import ObjectPlane
from erlif.ratio import NO_CELLS, LightCells, cell_centres
from erlif.ratio.cells import CELLS
from erlif.trend import ErrorEstimate, Texture, estimate_errors

# Shift over its standard deviation from which a note is a warning.
_SIGNIFICANT = 3.0


def shows_errors(calibration: RunCurve, plane: ObjectPlane) -> bool:
    """Whether the gap of a run can show errors of its calibration and systematics.

    It cannot without a joint, where the settings exclude all errors, and between two fixtures.
    """
    if not calibration.systematics.covariance.any() or calibration.later is not None:
        return False
    # the cells of a lobe hold many films
    return plane.view is not None and plane.settings.joint is not None and plane.bore is None


def cells_of_region(
    cells: Sequence[LightCells], plane: ObjectPlane, *, count: tuple[int, int] = CELLS
) -> tuple[LightCells, tuple[Array, Array]] | None:
    """Cells of frames within the region of interest, and their middles; None without light.

    `count` are the rows and columns of the cells.
    """
    parts = np.array(list(cells) or [NO_CELLS], float)
    if not np.isfinite(parts).any():
        return None

    # beside the region of interest there may be no joint, and the film of a patch is another one
    x, y = centres = cell_centres(plane.shape, cells=count)
    rows, columns = plane.region.rows, plane.region.columns
    inside = (rows.start <= y) & (y < rows.stop) & (columns.start <= x) & (x < columns.stop)
    if plane.patch is not None:
        # half of a cell of whole blocks, which may have one more than others
        down, along = (
            0.5 * size / number + BLOCK for size, number in zip(plane.shape, count, strict=True)
        )
        rows, columns = plane.patch.rows, plane.patch.columns
        beside = (y < rows.start - down) | (y > rows.stop + down)
        beside |= (x < columns.start - along) | (x > columns.stop + along)
        inside &= beside
    parts[:, :, ~inside] = np.nan
    return LightCells(*parts.transpose(1, 0, 2)), centres


class MeasuredCells(NamedTuple):
    """Cells of frames that were measured for them.

    Attributes
    ----------
    frames : AnyArray
        (frame,)
    record : LightCells
        Within the region of interest, (frame, cell).
    centres : tuple[Array, Array]
        Columns and rows of their middles, (cell,). [px]
    """

    frames: AnyArray
    record: LightCells
    centres: tuple[Array, Array]


def find_errors(
    lights: Mapping[int, FrameResult],
    calibration: RunCurve,
    plane: ObjectPlane,
    *,
    pairs: int,
    texture: Texture | None = None,
    cells: MeasuredCells | None = None,
) -> ErrorEstimate | None:
    """Errors of the calibration and of its systematics, from the gap of all frames.

    Parameters
    ----------
    lights : mapping of int to FrameResult
        By frame.
    calibration : RunCurve
        With the systematics of the settings.
    plane : ObjectPlane
    pairs : int
        Frame pairs of the run.
    texture : Texture, optional
        What stands still in the image.
    cells : MeasuredCells, optional
        In place of those of the lights.

    Returns
    -------
    ErrorEstimate or None
        None where `shows_errors` is false, and where the run does not determine them.
    """
    if not shows_errors(calibration, plane):
        return None
    if cells is None:
        frames = np.array(sorted(lights))
        found = cells_of_region([lights[frame].cells for frame in frames], plane)
        if found is None:
            return None
        cells = MeasuredCells(frames, *found)
    joint, view = plane.settings.joint, plane.view
    assert joint is not None
    assert view is not None
    return estimate_errors(
        cells.record,
        cells.centres,
        calibration,
        view,
        passed=shares_passed(cells.frames, pairs),
        clearance_std=clearance_std(joint),
        flattening=_flattening(joint),
        texture=texture,
    )


def _flattening(joint: JointSettings) -> float:
    """Depth by which the load flattens pin and bore, without the logarithm of its width. [um]

    Load per length over pi and the contact modulus; Johnson (1985), section 4.2.
    """
    if joint.load is None:
        return 0.0
    one, two = joint.pin, joint.bushing
    modulus = contact_modulus(
        one.youngs_modulus,
        poisson_1=one.poissons_ratio,
        youngs_2=two.youngs_modulus,
        poisson_2=two.poissons_ratio,
    )
    return 1e6 * joint.load / joint.length / (math.pi * float(modulus))


def with_errors(calibration: RunCurve, errors: ErrorEstimate, *, corrected: bool) -> RunCurve:
    """Return the calibration with the errors that remain after a run.

    Parameters
    ----------
    calibration : RunCurve
        With the systematics from which the errors were estimated.
    errors : ErrorEstimate
    corrected : bool
        Whether they are taken out of the curve; otherwise their second moment is its error.

    Returns
    -------
    RunCurve
    """
    covariance = errors.covariance if corrected else errors.second_moment
    value = errors.value if corrected else None
    before, scatter, known = errors.prior, errors.scatter, calibration.systematics
    if known.value is not None and known.before is not None:  # by a patch
        value = known.value if value is None else known.value + value
        before = known.before
        scatter = scatter if known.scatter is None else scatter + known.scatter
    found = known.with_errors(covariance, value, before=before, scatter=scatter)
    curve = replace(calibration, systematics=found)
    return curve.where_it_rises() if corrected else curve


def describe_gap(
    errors: ErrorEstimate | None, calibration: RunCurve, *, corrected: bool
) -> list[Note]:
    """Notes about the errors that the gap shows.

    Parameters
    ----------
    errors : ErrorEstimate or None
    calibration : RunCurve
        From which they were estimated.
    corrected : bool
        Whether they were to be taken out.

    Returns
    -------
    list of Note
    """
    if errors is None:
        text = (
            "the gap of this run does not determine the errors of [systematics], and nothing was "
            "taken out. It needs [joint], a dozen frames, one calibration, the right dark, and a "
            "ratio that neither drifts nor steps"
        )
        return [warn("systematics", text)] if corrected else []
    middle, film = calibration.at(0.5), np.array(errors.film)
    shift = 1e3 * float(errors.film_shift(film, middle))
    std, prior = (1e3 * float(errors.film_std(film, middle, before=n)) for n in (False, True))
    films, gap = f"films of {errors.film:.1f} um", "the gap that pin and bore must have"
    off = f"{abs(shift):.0f} ± {std:.0f} nm too {'thick' if shift > 0 else 'thin'}"
    before, key = f"({prior:.0f} nm before)", 'errors = "report" in [light]'
    if corrected:
        note = remark("systematics", f"{gap} shows {films} {off} {before}; taken out of the films")
    elif errors.exceeds_widths(calibration):
        note = warn(
            "systematics",
            f"{films} are {off} by {gap}, more than [systematics] allows. Its room is {prior:.0f} "
            "nm; film_mean_std and film_min_std include this shift, the maps do not. Check the "
            "radii in [joint], and light, filters and wall of fixture and run",
        )
    elif abs(shift) > _SIGNIFICANT * std:
        note = warn(
            "systematics",
            f"{films} are {off} by {gap} {before}. This is within the error bars. Without "
            f"{key} it is taken out of the films",
        )
    else:
        text = f"{gap} shows {films} {off} {before}; without {key} this is taken out of the films"
        note = remark("systematics", text)
    return [note]
