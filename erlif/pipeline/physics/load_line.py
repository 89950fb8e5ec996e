"""The load line of a swinging joint: found in the orbit of its pin, and where the angles begin."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.errors import ErlifError
from erlif.core.notes import Note, remark
from erlif.pipeline.physics.prediction import build_journal, build_motion, swings
from erlif.pipeline.plane import ObjectPlane
from erlif.prediction import FrameMotion, MeasuredMotion, fit_motion, measured_positions
from erlif.prediction.comparison import DESCRIBED
from erlif.prediction.fit import FEWEST_TRIGGERS, LOAD_LINE_STD
from erlif.trend import load_line_covariance

_MILLI = 1e3

# A line that the fit knows less well is the middle of the swing: of a given one, an error as large
# is assumed.
_LOOSEST = 0.1 * LOAD_LINE_STD


class LoadLine(NamedTuple):
    """Position of the load line in the image, its error and its source.

    Attributes
    ----------
    place : float
        Along sliding, from the first pixel. [mm]
    std : float or None
        None where it is not known. [mm]
    source : str
        "given", "fitted" to the orbit of a free pin, middle of the "swing", or "middle" of the
        image.
    """

    place: float
    std: float | None
    source: str


def find_load_line(plane: ObjectPlane, film: xr.Dataset, frames: xr.Dataset) -> LoadLine:
    """The load line of the settings, else that of the orbit of the pin, else the middle.

    The orbit of a free pin is squeezed towards the load: line, start and viscosity are fitted
    together. Where the fit does not describe the orbit or hardly determines the line, and for a
    pin that is held, it is the middle of the swing.

    Parameters
    ----------
    plane : ObjectPlane
        With the settings of the run, and a view.
    film : xarray.Dataset
        The position of the pin about the load line of the view, with the calibration of the film.
    frames : xarray.Dataset
        As `erlif.pipeline.physics.prediction.frames_of_run` returns them.

    Returns
    -------
    LoadLine
    """
    options, view = plane.settings.prediction, plane.view
    assert view is not None  # without one there are no positions
    if options.load_line is not None:
        std = options.load_line_std
        return LoadLine(view.load_line, None if std is None else _MILLI * float(std), "given")
    middle = LoadLine(view.load_line, None, "middle")
    if not swings(plane.settings) or not {"joint_load", "crank_angle"} <= set(frames):
        return middle

    # the film is complete without a line, whatever is wrong with log or positions
    try:
        motion = build_motion(plane.settings, frames)
        measured = measured_positions(film, calibration_of(film).full_covariance)
        free = options.sideways == "free"
        swing = middle_of_swing(measured, motion, view.radius, free=free)
        if swing is None:
            return middle
        place, std = view.load_line + swing, None
        if free and measured.known.sum() >= FEWEST_TRIGGERS:
            found = _fit_load_line(plane, measured, motion, frames)
            if found is not None and found[1] <= _MILLI * _LOOSEST:
                return LoadLine(view.load_line + found[0], found[1], "fitted")
            std = None if found is None else found[1]
    except (ErlifError, ArithmeticError, ValueError, np.linalg.LinAlgError):
        return middle
    return LoadLine(place, std, "swing")


def middle_of_swing(
    measured: MeasuredMotion, motion: FrameMotion, radius: float, *, free: bool
) -> float | None:
    """Middle of the swing of the measured pin, from the line of the displacements. [mm]

    A free pin keeps its place in the frame that turns with half the bushing angle; one that is held
    stays on the load line. The mean of the measured directions is that of these, less the line.

    Parameters
    ----------
    measured : MeasuredMotion
        Positions.
    motion : FrameMotion
    radius : float
        Over which places are angles. [mm]
    free : bool
        Whether the pin is free sideways.

    Returns
    -------
    float or None
        None without a measured position. [mm]
    """
    known = np.isfinite(measured.value).all(axis=1)
    if not known.any():
        return None
    load, side = measured.value[known].T

    # of the median, so that a trigger without a sound fit does not count
    expected = float(np.median(motion.motion.angle[motion.steps])) / 2 if free else 0.0
    return radius * (float(np.median(np.arctan2(side, load))) - expected)


def _fit_load_line(
    plane: ObjectPlane, measured: MeasuredMotion, motion: FrameMotion, frames: xr.Dataset
) -> tuple[float, float] | None:
    """Deviation of the line from that of the view and its standard deviation [mm]; None without."""
    journal = build_journal(plane.settings, motion.viscosity)
    if journal.foundation is not None:
        return None  # its yield is part of the measured positions
    fit = fit_motion(
        measured,
        journal,
        motion,
        trigger=np.where(frames.used.values, frames.trigger.values, -1),
        profiles=False,
    )
    line = fit.estimates["load_line"]
    if fit.inflation > DESCRIBED or not np.isfinite(line.std):
        return None
    return _MILLI * line.value, _MILLI * line.std


def place_positions(
    plane: ObjectPlane, film: xr.Dataset, frames: xr.Dataset
) -> tuple[xr.Dataset, list[Note]]:
    """Refer the positions of the pin to the load line found in them, and note its source.

    Parameters
    ----------
    plane : ObjectPlane
    film : xarray.Dataset
        With the variables of `describe_positions`, and settings and calibration as attributes.
    frames : xarray.Dataset
        As for `find_load_line`.

    Returns
    -------
    film : xarray.Dataset
        Unchanged without positions.
    notes : list of Note
    """
    view = plane.view
    if view is None or "pin_displacement" not in film:
        return film, []
    line = find_load_line(plane, film, frames)
    variables = {str(name): one.variable.copy(deep=False) for name, one in film.items()}
    turned = film.assign(turn_positions(variables, line, view.radius))
    if line.source not in ("fitted", "swing"):
        return turned, []

    error = "" if line.std is None else f" ± {line.std:.2f}"
    fitted = line.source == "fitted"
    source = (
        "fitted to the orbit of a free pin;"
        if fitted
        else "the middle of the swing: the orbit does not determine it better;"
    )
    text = (
        f"displacements are about the load line at {line.place:.2f}{error} mm along sliding, "
        f"{source} 0.1 mm is {0.1 * view.clearance / view.radius:.2g} um sideways. "
    )
    text += (
        "load_line in [prediction] gives another" if fitted else "Give load_line in [prediction]"
    )
    return turned, [remark("pin", text)]


def turn_positions(
    variables: Mapping[str, xr.Variable], line: LoadLine, radius: float
) -> dict[str, xr.Variable]:
    """The positions of the pin about another load line.

    Parameters
    ----------
    variables : mapping of str to variable
        The positions, as `describe_positions` returns them; others are passed on.
    line : LoadLine
        Its error is added to `pin_position_cov`.
    radius : float
        Over which places are angles. [mm]

    Returns
    -------
    dict of str to variable
    """
    turned = dict(variables)
    angle = (line.place - float(turned["pin_displacement"].attrs["load_line"])) / radius
    if angle:
        cosine, sine = np.cos(angle), np.sin(angle)
        turn = np.array([[cosine, sine], [-sine, cosine]])
        both = np.kron(np.eye(2), turn)
        for name in ("pin_displacement", "pin_tilt"):
            turned[name] = turned[name].copy(data=turned[name].values @ turn.T)
        for name in ("pin_position_cov", "pin_position_cov_random"):
            turned[name] = turned[name].copy(data=both @ turned[name].values @ both.T)
        gradient = turned["pin_position_gradient"]
        turned["pin_position_gradient"] = gradient.copy(data=both @ gradient.values)

    about: dict[str, Any] = {"load_line": line.place, "load_line_source": line.source}
    if line.std is not None:
        about |= {"load_line_std": line.std, "radius": radius}
    for name in ("pin_displacement", "pin_tilt"):
        turned[name].attrs = turned[name].attrs | about
    cov, by_line = turned["pin_position_cov"], load_line_covariance(xr.Dataset(turned))
    turned["pin_position_cov"] = cov.copy(data=cov.values + by_line)
    return turned
