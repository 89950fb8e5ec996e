"""Errors of a run that the known gap of its joint shows: found, reported, taken out on request."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.calibration import Calibration
from erlif.core.notes import Level, Note, note_writer
from erlif.pipeline.engines.results import FrameResult, shares_passed
from erlif.pipeline.physics.position import clearance_std
from erlif.pipeline.plane import ObjectPlane
from erlif.ratio import LightCells, cell_centres
from erlif.trend import ErrorEstimate, estimate_errors

_note = note_writer("erlif.pipeline")

# Shift over its standard deviation from which a note is a warning.
_SIGNIFICANT = 3.0


def find_errors(
    lights: dict[int, FrameResult], calibration: Calibration, plane: ObjectPlane, *, pairs: int
) -> ErrorEstimate | None:
    """Errors of the calibration and of its systematics, from the gap of all frames.

    Parameters
    ----------
    lights : dict of int to FrameResult
        By frame.
    calibration : Calibration
        With the systematics of the settings.
    plane : ObjectPlane
    pairs : int
        Frame pairs of the run.

    Returns
    -------
    ErrorEstimate or None
        None without a joint, where the settings exclude all errors of the run, between two
        fixtures, and where the run does not determine them.
    """
    systematics = calibration.systematics
    if systematics is None or not systematics.covariance.any() or calibration.later is not None:
        return None
    joint = plane.settings.joint
    if plane.view is None or joint is None:
        return None
    frames = np.array(sorted(lights))
    parts = np.array([lights[frame].cells for frame in frames], float).reshape(frames.size, 4, -1)
    if not np.isfinite(parts).any():
        return None

    # beside the region of interest there may be a patch, or no joint
    x, y = centres = cell_centres(plane.shape)
    rows, columns = plane.region.rows, plane.region.columns
    inside = (rows.start <= y) & (y < rows.stop) & (columns.start <= x) & (x < columns.stop)
    parts[:, :, ~inside] = np.nan
    return estimate_errors(
        LightCells(*parts.transpose(1, 0, 2)),
        centres,
        calibration,
        plane.view,
        passed=shares_passed(frames, pairs),
        clearance_std=clearance_std(joint),
    )


def with_errors(calibration: Calibration, errors: ErrorEstimate, *, corrected: bool) -> Calibration:
    """The calibration with the errors that a run leaves.

    Parameters
    ----------
    calibration : Calibration
        With the systematics from which the errors were estimated.
    errors : ErrorEstimate
    corrected : bool
        Whether they are taken out of the curve; otherwise their second moment is its error.

    Returns
    -------
    Calibration
    """
    assert calibration.systematics is not None
    covariance = errors.covariance if corrected else errors.second_moment
    value = errors.value if corrected else None
    return replace(calibration, systematics=calibration.systematics.with_errors(covariance, value))


def describe_gap(
    errors: ErrorEstimate | None, calibration: Calibration, *, corrected: bool
) -> list[Note]:
    """Notes about the errors that the gap shows.

    Parameters
    ----------
    errors : ErrorEstimate or None
    calibration : Calibration
        From which they were estimated.
    corrected : bool
        Whether they were to be taken out.

    Returns
    -------
    list of Note
    """
    if errors is None:
        return (
            [
                Note(
                    Level.WARNING,
                    "systematics",
                    "the gap of this run does not determine the errors of [systematics], and "
                    "nothing was taken out. It needs [joint], a dozen frames, one calibration, "
                    "the right dark, and a ratio that neither drifts nor steps",
                )
            ]
            if corrected
            else []
        )
    middle, film = calibration.at(0.5), np.array(errors.film)
    shift = 1e3 * float(errors.film_shift(film, middle))
    std, prior = (1e3 * float(errors.film_std(film, middle, before=n)) for n in (False, True))
    large = abs(shift) > _SIGNIFICANT * std
    key = "gap_significant" if large else "gap_agrees"
    if corrected:
        key = "gap_corrected"
    elif errors.exceeds_widths(calibration):
        key = "gap_exceeds"
    thick = "thick" if shift > 0 else "thin"
    return [_note(key, film=errors.film, shift=abs(shift), thick=thick, std=std, prior=prior)]
