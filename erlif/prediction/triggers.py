"""The predicted position of the pin and the predicted film, by frame and by trigger.

Of the gap, what the camera sees is summarised.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.described import describe_by
from erlif.core.errors import ModelError
from erlif.core.variables import FILM, FRAMES
from erlif.models.reynolds import Journal, solve_journal
from erlif.models.reynolds.balance import THINNEST_FILM
from erlif.models.reynolds.full_film import follow_full_film
from erlif.models.reynolds.transient import UNITS
from erlif.prediction.band import find_band
from erlif.prediction.given import GivenErrors
from erlif.prediction.motion import FrameMotion
from erlif.prediction.orbits import FreeOrbits, peak_yield
from erlif.prediction.start import find_start_film, log_weights

# Cells round the joint and along half of its length; the film of half as many is within 0.7 %.
CELLS = (256, 8)

# The same where the search of the start film begins, and for the standard deviation of the film of
# a free pin, within 1 % of its largest. Where cavities form, theirs jump with the cells.
_FEWER_CELLS = (96, 4)

# Pressure times pressure viscosity up to which a film is that of a constant viscosity, within
# 0.15 %, less than what the cells make (docs/prediction.md).
_CONSTANT_VISCOSITY = 0.005

_MICRO = 1e6

_Cells: TypeAlias = tuple[int, int] | None


def predict_frames(
    journal: Journal,
    motion: FrameMotion,
    *,
    start_film: float,
    sideways: str | float = "free",
    cells: _Cells = CELLS,
) -> xr.Dataset:
    """Predict the position of the pin at every frame.

    The pin starts at rest in the frame that turns with half the bushing angle where it is free, for
    there it stays while the film is squeezed; else on the load line.

    Parameters
    ----------
    journal : Journal
        The joint, with any viscosity: that of `motion` takes its place.
    motion : FrameMotion
    start_film : float
        Minimum film thickness at the first frame. [m]
    sideways : str or float
        "free", "guided", or a stiffness. [N/m]
    cells : (int, int), optional
        Cells round the joint, and along half of its length; a long one has one along, one with an
        axial shape twice as many. None follows a free pin in a full film, which has no cells.

    Returns
    -------
    xarray.Dataset
        displacement_load and displacement_side [m], on dim frame; of a joint with a foundation also
        deflection, by which it yields to the highest pressure [m].

    Raises
    ------
    ModelError
        If no film carries the load, or a step does not converge.

    Examples
    --------
    A joint that is at rest under its load sinks:

    >>> from erlif.models.reynolds import Motion
    >>> time = np.linspace(0.0, 1.0, 51)
    >>> rest = FrameMotion(Motion(time, 0 * time, 222.4), np.array([0, 50]), time, 0.12)
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> found = predict_frames(joint, rest, start_film=20e-6)
    >>> (1e6 * (joint.clearance - found.displacement_load.values)).round()
    array([20., 16.])
    """
    eccentric = journal.least_clearance - start_film
    toward = motion.motion.angle[0] / 2 if sideways == "free" else 0.0
    start = eccentric * np.cos(toward), eccentric * np.sin(toward)
    joint = replace(journal, viscosity=motion.viscosity)
    if cells is None:
        orbit = follow_full_film(joint, motion.motion, start=np.array([start]))[0, motion.steps]
        load, side = (("frame", column) for column in orbit.T)
        return describe_by(UNITS, {"displacement_load": load, "displacement_side": side})
    solved = solve_journal(
        joint,
        motion.motion,
        start=start,
        sideways=sideways,
        cells=(cells[0], 1 if journal.long else cells[1] * (1 + (journal.axial_shape is not None))),
    )
    names = ["displacement_load", "displacement_side"]
    far = np.hypot(solved.displacement_load, solved.displacement_side)
    if journal.foundation is None and journal.least_clearance <= far.max():
        raise ModelError(
            "No film carries the load: the pin touches the crest of the bore between the cells "
            "along the axis. Check load and viscosity, and the bore in [joint]."
        )
    if journal.foundation is not None:
        solved["deflection"] = "time", peak_yield(solved, journal.foundation)
        names.append("deflection")
    return xr.Dataset(
        {name: ("frame", solved[name].values[motion.steps], solved[name].attrs) for name in names}
    )


def average_triggers(
    frames: xr.Dataset,
    trigger: npt.NDArray[np.integer[Any]],
    *,
    used: npt.NDArray[np.bool_] | None = None,
) -> xr.Dataset:
    """Average what is predicted for the frames of each trigger.

    The gap is linear in the displacements: the mean of the maps is the map of the mean.

    Parameters
    ----------
    frames : xarray.Dataset
        From `predict_frames`.
    trigger : array, (frame,)
        Trigger of each frame, from 0 without gaps.
    used : array of bool, (frame,), optional
        Frames that were measured; a trigger without any is that of all its frames. Default: all.

    Returns
    -------
    xarray.Dataset
        The same variables on dim trigger.

    Examples
    --------
    >>> frames = xr.Dataset({"displacement_load": ("frame", [1.0, 3.0, 5.0])})
    >>> average_triggers(frames, np.array([0, 1, 1])).displacement_load.values
    array([1., 4.])
    """
    taken = np.ones(trigger.shape, bool) if used is None else used
    weight = np.where(np.bincount(trigger, taken)[trigger] > 0, taken, 1.0)
    count = np.bincount(trigger, weight)
    return xr.Dataset(
        {
            name: ("trigger", np.bincount(trigger, weight * column.values) / count, column.attrs)
            for name, column in frames.items()
        }
    )


def predict_triggers(
    film: xr.Dataset,
    journal: Journal,
    motion: FrameMotion,
    *,
    trigger: npt.NDArray[np.integer[Any]],
    view: ImageLine,
    used: npt.NDArray[np.bool_] | None = None,
    sideways: str | float = "free",
    start_film: float | None = None,
    given: GivenErrors | None = None,
    cells: tuple[int, int] = CELLS,
) -> xr.Dataset:
    """Predict the film of every trigger.

    Parameters
    ----------
    film : xarray.Dataset
        film_min and film_min_std [um], dim trigger, to find the start film; not used otherwise.
    journal : Journal
        The joint, with any viscosity: that of `motion` takes its place.
    motion : FrameMotion
    trigger : array, (frame,)
        Trigger of each frame.
    view : ImageLine
        Where the image and its region of interest lie.
    used : array of bool, (frame,), optional
        As for `average_triggers`.
    sideways : str or float
        "free", "guided", or a stiffness. [N/m]
    start_film : float, optional
        Minimum film thickness at the first frame; default: that of the least squares. A pin that is
        held then goes through the lead of `motion` first, in which its cavities form. [m]
    given : GivenErrors, optional
        Of viscosity, load and clearance. Default: no standard deviation is predicted.
    cells : (int, int)
        As for `predict_frames`, where the film is not full.

    Returns
    -------
    xarray.Dataset
        On dim trigger: film_predicted_min and film_predicted_mean over the region of interest [um],
        eccentricity [1] and attitude [degree], and with `given` film_predicted_min_std [um]; on dim
        frame the same with the ending _frame, and elapsed_cycles [1]. Attributes of
        film_predicted_min: start_film [um] and start_film_fitted.

    Raises
    ------
    ModelError
        If no film carries the load, a step does not converge, or nothing was measured.

    Examples
    --------
    >>> from erlif.models.reynolds import Motion
    >>> time = np.linspace(0.0, 1.0, 51)
    >>> rest = FrameMotion(Motion(time, 0 * time, 222.4), np.array([0, 50]), time, 0.12)
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> view = ImageLine(np.linspace(-0.01, 0.01, 501), slice(501))
    >>> found = predict_triggers(xr.Dataset(), joint, rest, trigger=np.array([0, 1]), view=view,
    ...                          start_film=20e-6)
    >>> found.film_predicted_min.values.round()
    array([20., 16.])
    """

    @cache
    def positions(
        start: float,
        grid: _Cells,
        viscosity: float = 1.0,
        load: float = 1.0,
        clearance: float = 1.0,
    ) -> tuple[xr.Dataset, xr.Dataset]:
        path = replace(motion.motion, load=load * motion.motion.load)
        moved = replace(motion, motion=path, viscosity=viscosity * motion.viscosity)
        joint = journal.with_clearance(clearance)
        frames = predict_frames(joint, moved, start_film=start, sideways=sideways, cells=grid)
        return average_triggers(frames, trigger, used=used), frames

    def minima(start: float, grid: _Cells, **times: float) -> Array:
        joint = journal.with_clearance(times.get("clearance", 1.0))
        both = positions(start, grid, **times)
        return np.concatenate([_summarise_positions(one, joint, view)[0] for one in both])

    fitted = start_film is None
    if fitted and sideways != "free" and motion.lead is not None:
        motion = motion.with_lead()
    free = sideways == "free" and journal.foundation is None and journal.axial_shape is None
    rough: _Cells = None if free else _FEWER_CELLS
    best: _Cells = cells

    def search(grid: _Cells) -> float:
        """The start film of the least squares, from that of the rough film."""
        follow, begin = (
            lambda start, used=used: minima(start, used)[: measured.size] for used in (grid, rough)
        )
        clearance = journal.least_clearance
        return find_start_film(follow, measured, std, clearance=clearance, rough=begin)

    # a free pin is followed without cells where its film is full
    weight = None
    if start_film is None:
        measured, std = film["film_min"].values / _MICRO, film["film_min_std"].values / _MICRO
        weight = np.append(log_weights(measured, std), np.zeros(len(trigger)))
        start_film = search(rough if free else cells)
    if free and _is_full(journal, motion, start_film):
        best = None
    elif free and fitted:
        start_film = search(cells)
    triggers, frames = positions(start_film, best)  # as `minima` calls it: it is kept
    predicted = _describe_positions(triggers, journal, view, "trigger")
    each = _describe_positions(frames, journal, view, "frame")
    if given is not None:
        full, own = sideways == "free", journal.clearance
        follow = partial(minima, grid=_FEWER_CELLS if full and best else best)
        band = _MICRO * find_band(
            follow, start_film, given, clearance=own, full=full, weight=weight
        )
        count, name = triggers.sizes["trigger"], "film_predicted_min_std"
        predicted[name] = FILM[name].fill(band[:count])
        each[name] = FRAMES[name].fill(band[count:])
    predicted = predicted.merge(each.rename({name: f"{name}_frame" for name in each}))
    turns = motion.cycles
    predicted["elapsed_cycles"] = FRAMES["elapsed_cycles"].fill(turns - turns.min())

    # after a lead the film at the first frame is no longer that of the start
    first = int(np.argmin(motion.steps))
    reached = np.hypot(frames.displacement_load, frames.displacement_side).values[first]
    begun = _MICRO * (journal.least_clearance - float(reached))
    predicted["film_predicted_min"].attrs.update(start_film=begun, start_film_fitted=int(fitted))
    if "deflection" in frames:
        predicted["film_predicted_min"].attrs["deflection"] = _MICRO * float(
            frames.deflection.max()
        )
    return predicted


def _is_full(journal: Journal, motion: FrameMotion, start_film: float) -> bool:
    """Whether the film of a free pin neither ruptures nor thickens under its pressure."""
    orbits = FreeOrbits(replace(journal, viscosity=motion.viscosity), motion.motion)
    start = {"start_film": np.log(start_film), "start_attitude": motion.motion.angle[0] / 2}
    alone = {name: np.array([value]) for name, value in {"fluidity": 1.0, **start}.items()}
    (orbit,) = orbits.follow(alone)
    film = journal.clearance - (far := np.hypot(*orbit.T))
    if film.min() < THINNEST_FILM or orbits.lowest_pressure(orbit) < journal.cavitation_pressure:
        return False

    # highest pressure of a long film between circles
    mean = motion.motion.load / (np.pi * journal.radius * journal.length)
    highest = float((mean * np.sqrt(2 * far / film)).max())
    return journal.pressure_viscosity * highest <= _CONSTANT_VISCOSITY


def _summarise_positions(
    positions: xr.Dataset, journal: Journal, view: ImageLine
) -> tuple[Array, Array]:
    """Minimum and mean of the film in the region; the deflection is that of the minimum. [m]"""
    load, side = positions.displacement_load.values, positions.displacement_side.values
    minimum, mean = summarise_gap(load, side, journal, view)
    return minimum + positions["deflection"].values if "deflection" in positions else minimum, mean


def _describe_positions(
    positions: xr.Dataset, journal: Journal, view: ImageLine, dim: str
) -> xr.Dataset:
    """The predicted film of positions of the pin."""
    load, side = positions.displacement_load.values, positions.displacement_side.values
    minimum, mean = _summarise_positions(positions, journal, view)
    columns = {
        "film_predicted_min": _MICRO * minimum,
        "film_predicted_mean": _MICRO * mean,
        "eccentricity": np.hypot(load, side) / journal.clearance,
        "attitude": np.degrees(np.arctan2(side, load)),
    }
    table = {"trigger": FILM, "frame": FRAMES}[dim]
    return xr.Dataset({name: table[name].fill(values) for name, values in columns.items()})


@dataclass(frozen=True)
class ImageLine:
    """Places of the image along the sliding direction.

    Attributes
    ----------
    place : Array
        Distance of each pixel from the load line, along sliding. (pixel,) [m]
    region : slice
        Pixels of the region of interest.
    shape : Array or float
        Height that the bore adds to the gap at the pixels across sliding of the region; 0 where it
        is straight. [m]
    """

    place: Array
    region: slice
    shape: Array | float = 0.0


def gap_in_view(
    displacement_load: Array, displacement_side: Array, journal: Journal, place: Array
) -> Array:
    """Film thickness between round bodies with parallel axes.

    Parameters
    ----------
    displacement_load, displacement_side : array, (...)
        Displacement of the pin along the load line and sideways. [m]
    journal : Journal
        Radii of pin and bushing.
    place : array, (pixel,)
        Distance from the load line along sliding. [m]

    Returns
    -------
    array, (..., pixel)
        c - ex cos(phi) - ey sin(phi), with phi the distance over the radius of the film. [m]

    Examples
    --------
    A pin 5 um from the bushing: 10 mm from the load line the gap is wider by 10 um:

    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> gap_in_view(np.array(225e-6), np.array(0.0), joint, np.array([0.0, 0.01])).round(6)
    array([5.0e-06, 1.5e-05])
    """
    phi = place / journal.radius
    load, side = np.asarray(displacement_load), np.asarray(displacement_side)
    along = load[..., np.newaxis] * np.cos(phi) + side[..., np.newaxis] * np.sin(phi)
    return np.asarray(journal.clearance - along)


def summarise_gap(
    displacement_load: Array, displacement_side: Array, journal: Journal, view: ImageLine
) -> tuple[Array, Array]:
    """Minimum and mean of the gap over the region of interest.

    Parameters
    ----------
    displacement_load, displacement_side, journal
        As for `gap_in_view`.
    view : ImageLine
        Where the image lies.

    Returns
    -------
    minimum, mean : array, (...)
        The minimum is that of the gap, not of its pixels. [m]

    Examples
    --------
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12)
    >>> view = ImageLine(np.linspace(-0.01, 0.01, 501), slice(501))
    >>> minimum, mean = summarise_gap(np.array([225e-6]), np.array([0.0]), joint, view)
    >>> minimum.round(8), mean.round(8)
    (array([5.e-06]), array([8.34e-06]))
    """
    phi = view.place[view.region] / journal.radius
    load, side = np.asarray(displacement_load), np.asarray(displacement_side)
    thinnest = np.clip(np.arctan2(side, load), phi.min(), phi.max())
    minimum = journal.clearance - load * np.cos(thinnest) - side * np.sin(thinnest)
    mean = journal.clearance - load * np.cos(phi).mean() - side * np.sin(phi).mean()
    return np.asarray(minimum + np.min(view.shape)), np.asarray(mean + np.mean(view.shape))
