"""The pressure that carries the pin, from its measured positions and their rates.

The gap round the whole joint continues that of the image, as its circles do. The Reynolds equation
is solved on this gap and its rate. No load enters: the load that follows is a check.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.progress import Progress, silent
from erlif.models.reynolds import Journal
from erlif.prediction.gaps import LARGEST_GAP
from erlif.prediction.pin_film import (
    CELLS,
    OverlapError,
    follow_cavities,
    solve_pin_motion,
)
from erlif.prediction.pin_motion import NUMBERS, PinMotion

# Cells for the derivatives with position and rate, of which a few per cent are enough.
SLOPE_CELLS = (192, 8)

# Change of the cavities from the trigger before to the one after, over their sum, above which they
# close or open too quickly for a smooth path.
CHANGING = 0.4

# Displacement of the pin over the turn before the recorded one, over that of the recorded turn,
# whose cavities are compared with those of 1: shortly after loading a pin sinks from turn to turn,
# and in the turn before it sank further.
OTHER_TURN = 2.0

# Relative error of peak and load by `CELLS`, for films of 2 to 100 um, by comparison with the
# series of the virtual rig. Of coarser cells it grows with the square of their width: 1.4 % of the
# load was found with 12 cells over the length, 0.6 % of the peak with 192 round the joint.
GRID_ERROR = 0.005

# Error of the place of the peak over the width of a cell, by the parabola through three cells.
PLACE_ERROR = 0.1

# Standard deviation of a peak over the peak up to which the pressure counts as measured: of such a
# peak it is known with 95 % certainty that it is there, and errors are still nearly linear.
CLEAR = 0.5

# Standard deviations within which all rates of a film at rest are zero.
RESTING = 3.0
_SHAPED = 3  # times as many cells over the length of a bore that is not straight

_STEP = 0.02  # largest relative change of the film for a derivative


# What the pressure is computed with, and of which a relative change is carried to it.
SETTINGS = ("viscosity", "clearance")

_NUDGE = np.array([0.01, 1e-3])  # relative changes of the settings for the derivatives


def find_pressures(
    journal: Journal,
    motion: PinMotion,
    *,
    viscosity: Array,
    place: Array,
    axial: Array,
    settings_std: tuple[float, float] = (0.0, 0.0),
    load_line_std: float = 0.0,
    fill: Callable[[], PinMotion | None] | None = None,
    cells: tuple[int, int] = CELLS,
    progress: Progress = silent,
) -> xr.Dataset:
    """Find the pressure in the image at every trigger, with its standard deviation.

    Errors of position, rate, viscosity and clearance are carried to the pressure by its
    derivatives. With another clearance the pin is displaced so that the film in the image stays as
    it was measured. Where the film in the image is ruptured, three errors of its cavities are
    added: half the change that the cavities of both neighbours make, what coarser cells make, as
    its mean square over five triggers, and the change by a turn before the recorded one over which
    the pin sinks twice as far. Cavities that are older than the recording have the last one.

    Where the standard deviation of the peak is above half the peak, the pressure is not known: all
    is NaN there but the standard deviations. So it is where the gap closes outside the image, where
    cavities close or open so quickly that the path of the pin has a kink, where the Reynolds
    equation has no solution (`pressure_solved` is 0 there), and at all triggers of a film with
    cavities that leave out more than `LARGEST_GAP` of a turn, unless a predicted motion fills the
    gap. The change by cavities on the path without the prediction is then an error as well. A film
    at rest with such a gap is not solved: it closes nowhere, and its wedge has cavities.

    Parameters
    ----------
    journal : Journal
        With any viscosity.
    motion : PinMotion
    viscosity : array, (trigger,)
        [Pa s]
    place : array, (place,)
        Where the pressure is given, from the load line along sliding. [m]
    axial : array, (axial,)
        And from the middle of the length along the axis. [m]
    settings_std : (float, float)
        Standard deviations of viscosity and clearance over their values, in the order of
        `SETTINGS`. [1]
    load_line_std : float
        Standard deviation of the place of the load line, which divides the force of the pressure
        into load and side. [m]
    fill : callable, optional
        Gives the motion with its gaps filled (`erlif.prediction.gaps`), or None; called where
        cavities need it.
    cells : (int, int)
        As for `solve_pin_motion`; a bore that is not straight has thrice as many over its length,
        and what coarser cells make in its errors.
    progress : callable
        Receives the name of the step, the triggers that are finished, and their number.

    Returns
    -------
    xarray.Dataset
        pressure and pressure_std (trigger, axial, place), pressure_profile and
        pressure_profile_std (trigger, place) at the axial place 0 [Pa]; by trigger peak_pressure
        [Pa], peak_place [m], load_from_pressure and side_from_pressure [N], each with _std;
        peak_std_random, peak_std_shared and peak_std_settings, the parts of peak_pressure_std that
        noise, shared errors, and viscosity and clearance make [Pa]; peak_by_viscosity and
        peak_by_clearance, relative changes of the peak over those of the settings [1]; load_cov
        (trigger, trigger_other), covariance of load_from_pressure [N2]; pressure_measured and
        pressure_solved, 1 or 0; cavity, the share of the image without a full film, cavity_change,
        how much cavities change about the trigger, and cavity_history, the relative change of the
        peak by another turn before the recorded one [1].

    Examples
    --------
    >>> joint = Journal(0.0333, 0.0335, length=0.2, viscosity=0.1, long=True)
    >>> still = np.diag([5e-9, 5e-9, 0, 0, 5e-7, 5e-7, 0, 0])[None]
    >>> motion = PinMotion(np.zeros(1), np.zeros(1), np.array([[1e-4, 0, 0, 0]]),
    ...                    np.array([[1e-4, 0, 0, 0]]), np.zeros(1), still, 0 * still, np.ones(4))
    >>> found = find_pressures(joint, motion, viscosity=np.array([0.1]),
    ...                        place=np.linspace(-0.01, 0.01, 9), axial=np.zeros(1))
    >>> float((found.peak_pressure_std / found.peak_pressure).item()) < 0.01
    True
    """
    view, shaped = _View(journal.radius, place, axial), journal.axial_shape is not None
    cells = (cells[0], _SHAPED * cells[1]) if shaped else cells
    search = _Search(journal, viscosity, motion, view, cells, np.array(settings_std), load_line_std)
    # known before anything is solved
    if _rests(motion) and not _covers_turn(motion):
        return _collect([_hide({}, np.nan, np.inf) for _ in viscosity], view)
    rows = [_judge(row) for row in search.find_all(progress)]
    if shaped:
        rows = _add_error_of_cells(rows)
    # a cavity at a trigger without a pressure may be one of the noise
    if any(row["pressure_measured"] > 0 and row["cavity"] > 0 for row in rows):
        mean = replace(journal, viscosity=float(np.mean(viscosity)))
        if not _covers_turn(motion):
            filled = None if fill is None else fill()
            if filled is None or not _covers_turn(filled):
                return _collect([_hide(row, np.nan, np.inf) for row in rows], view)
            motion = filled
        try:
            cavities = _Cavities.of(mean, motion, {cells, _coarser(cells)})
        except ModelError:
            rows = [_judge(_nothing(solved=False)) for _ in rows]
        else:
            search = replace(search, motion=motion, cavities=cavities)
            change = _change_of_cavities(cavities.own[cells])[search.triggers]
            found = _add_error_of_cells(search.find_all(progress))
            rows = [
                row | {"cavity_change": moved} if moved <= CHANGING else _hide(row, moved)
                for row, moved in zip(found, change, strict=True)
            ]
    return _collect(rows, view)


# What is found at a trigger, with a standard deviation, and the change by coarser cells.
_SINGLE = ("peak_pressure", "peak_place", "load_from_pressure", "side_from_pressure")
_FOUND = ("pressure", "pressure_profile", *_SINGLE)
_CELLS = "_by_cells"

# Dimensions besides the trigger.
_DIMS = {"pressure": ("axial", "place"), "pressure_profile": ("place",)}

_PARTS = ("peak_std_random", "peak_std_shared", "peak_std_settings")
_SENSITIVITIES = tuple(f"peak_by_{name}" for name in SETTINGS)
_STATES = ("pressure_measured", "pressure_solved", "cavity", "cavity_change", "cavity_history")


def _collect(rows: list[dict[str, Array]], view: _View) -> xr.Dataset:
    """Collect the rows of all triggers in a dataset; NaN where a row has no value."""
    between: tuple[str, ...] = ("trigger", "trigger_other")
    columns = {"load_cov": (between, _load_covariance(rows))}
    for name in (*_FOUND, *(f"{name}_std" for name in _FOUND), *_PARTS, *_SENSITIVITIES, *_STATES):
        dims = _DIMS.get(name.removesuffix("_std"), ())
        unknown = np.full([getattr(view, dim).size for dim in dims], np.nan)
        columns[name] = ("trigger", *dims), np.array([row.get(name, unknown) for row in rows])
    return xr.Dataset(columns, {"place": view.place, "axial": view.axial})


def _add_error_of_cells(rows: list[dict[str, Array]]) -> list[dict[str, Array]]:
    """Add the error by the size of the cells to the rows, and judge each row.

    The edge of a cavity moves through cells, so that the change alternates from one trigger to the
    next: its mean square over five is the measure.
    """
    done = [dict(row) for row in rows]
    solved = [row for row in rows if "peak_pressure" in row]
    for name in _FOUND if solved else ():
        unknown = np.full_like(solved[0][name], np.nan)
        square = np.array([row.get(name + _CELLS, unknown) for row in rows], float) ** 2
        near = np.stack([np.roll(square, off, axis=0) for off in (-2, -1, 0, 1, 2)])
        known = np.isfinite(near)
        mean = np.where(known, near, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        stds = [f"{name}_std"] + (["load_own"] if name == "load_from_pressure" else [])
        for row, more in zip(done, mean, strict=True):
            row.update({std: np.sqrt(row[std] ** 2 + more) for std in stds if std in row})
    return [_judge(row) for row in done]


def _coarser(cells: tuple[int, int]) -> tuple[int, int]:
    """Cells for the derivatives, and for the error by the size of the cells."""
    return min(cells, (SLOPE_CELLS[0], max(SLOPE_CELLS[1], cells[1] // _SHAPED)))


def _nothing(*, solved: bool) -> dict[str, Array]:
    """A trigger without a solution, or without a gap all over the joint."""
    return {"pressure_solved": np.array(int(solved))}


def _judge(row: dict[str, Array]) -> dict[str, Array]:
    """Mark a row as measured, or leave out its pressure if the peak is not significant."""
    peak, std = (row.get(name, np.nan) for name in ("peak_pressure", "peak_pressure_std"))
    measured = bool(std <= CLEAR * peak)
    hidden = () if measured else (*_FOUND, *_SENSITIVITIES)
    kept = {name: value for name, value in row.items() if name not in hidden}
    return kept | {"pressure_measured": np.array(int(measured))}


def _load_covariance(rows: list[dict[str, Array]]) -> Array:
    """Covariance of the loads of all triggers, (trigger, trigger); NaN where one is not known."""
    causes = [row["load_root"].size for row in rows if "load_root" in row]
    unknown = np.full(max(causes, default=1), np.nan)
    root = np.array([row.get("load_root", unknown) for row in rows])
    own = np.array([row.get("load_own", np.nan) for row in rows])
    return np.asarray(root @ root.T + np.diag(own**2))


def _change_of_cavities(void: Array) -> Array:
    """Change of the cavities about each trigger over their sum; a turn is closed. (trigger,)"""
    around = np.concatenate([void[-1:], void, void[:1]])
    change = np.abs(around[2:] - around[:-2]).sum(axis=(1, 2))
    total = (around[2:] + around[:-2]).sum(axis=(1, 2))
    return np.asarray(np.divide(change, total, out=np.zeros_like(total), where=total > 0))


def _covers_turn(motion: PinMotion) -> bool:
    """Whether the bushing is back where it was, a step after the last trigger, without a gap."""
    step = motion.turn - (motion.time[-1] - motion.time[0])
    back = motion.angle[-1] + step / 2 * (motion.turning[-1] + motion.turning[0])
    returns = np.abs(back - motion.angle[0]) <= step * np.abs(motion.turning).max()
    return bool(returns and motion.widest_gap <= LARGEST_GAP)


def _rests(motion: PinMotion) -> bool:
    """Whether no rate of the pin exceeds its errors."""
    variance = np.diagonal(motion.random_cov + motion.shared_cov, axis1=1, axis2=2)
    rates = slice(NUMBERS, NUMBERS + 2)
    return bool((np.abs(motion.rate[:, :2]) < RESTING * np.sqrt(variance)[:, rates]).all())


def _hide(row: dict[str, Array], change: float, history: float = np.nan) -> dict[str, Array]:
    """Leave out the pressure of a trigger whose cavities are not known."""
    kept = {name: row[name] for name in ("cavity", "pressure_solved", *_PARTS) if name in row}
    return kept | {
        "pressure_measured": np.array(0),
        "cavity_change": np.array(change),
        "cavity_history": np.array(history),
    }


@dataclass(frozen=True)
class _View:
    """Part of the joint that the camera sees.

    Attributes
    ----------
    radius : float
        Over which places along sliding are angles. [m]
    place : Array
        From the load line along sliding. [m]
    axial : Array
        From the middle of the length. [m]
    """

    radius: float
    place: Array
    axial: Array

    def cut(self, grid: xr.DataArray) -> Array:
        """Values of a grid in the image, (axial, place)."""
        across = _at(grid.axial.values, grid.values.T, self.axial)
        return _at(grid.angle.values, across.T, self.place / self.radius).T

    def look(self, solved: xr.Dataset) -> dict[str, Array]:
        """Extract the pressure in the image, its peak, and the loads from a solution."""
        grid = solved.pressure
        middle = _at(solved.axial.values, grid.values.T, np.zeros(1))[0]
        seen = np.abs(solved.angle.values - self.place.mean() / self.radius)
        seen = np.flatnonzero(seen <= np.ptp(self.place) / (2 * self.radius))
        peak, angle = _peak(solved.angle.values, middle, seen)
        return {
            "pressure": self.cut(grid),
            "pressure_profile": np.interp(self.place / self.radius, solved.angle.values, middle),
            "peak_pressure": np.array(peak),
            "peak_place": np.array(angle * self.radius),
            "load_from_pressure": solved.reaction_load.values,
            "side_from_pressure": solved.reaction_side.values,
        }

    def lift(self) -> Array:
        """Change of a position with the clearance that leaves the film in the image, (number,)."""
        angle = self.place / self.radius
        shapes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        found = np.linalg.lstsq(shapes, np.ones_like(angle), rcond=None)[0]
        return np.concatenate([found, np.zeros(NUMBERS - 2)])


def _at(nodes: Array, values: Array, places: Array) -> Array:
    """Linear interpolation over the first axis; constant beyond the nodes. (place, other)"""
    if nodes.size == 1:
        return np.repeat(values, places.size, axis=0)
    right = np.clip(np.searchsorted(nodes, places), 1, nodes.size - 1)
    share = np.clip((places - nodes[right - 1]) / (nodes[right] - nodes[right - 1]), 0.0, 1.0)
    return np.asarray(values[right - 1] + share[:, None] * (values[right] - values[right - 1]))


def _peak(angle: Array, pressure: Array, seen: npt.NDArray[np.intp]) -> tuple[float, float]:
    """Highest pressure of the cells that are seen, and its angle, by a parabola of three cells."""
    top = int(seen[pressure[seen].argmax()])
    if not 0 < top < angle.size - 1:
        return float(pressure[top]), float(angle[top])
    before, here, after = pressure[top - 1 : top + 2]
    bend = before - 2 * here + after
    if bend >= 0:
        return float(here), float(angle[top])
    off = float(np.clip(0.5 * (before - after) / bend, -1.0, 1.0))
    step = float(angle[top] - angle[top - 1])
    return float(here - 0.25 * (before - after) * off), float(angle[top]) + off * step


@dataclass(frozen=True)
class _Cavities:
    """Cavities along a motion, each (trigger, angle, axial).

    Attributes
    ----------
    own : dict
        By the cells on which they are followed: those of the pressure and of its derivatives.
    older : Array
        After another turn before the recorded one, on the cells of the derivatives.
    alone : Array or None
        The same on the path without the prediction that fills its gaps.
    """

    own: dict[tuple[int, int], Array]
    older: Array
    alone: Array | None = None

    @classmethod
    def of(cls, journal: Journal, motion: PinMotion, grids: set[tuple[int, int]]) -> _Cavities:
        """Follow the cavities of a motion."""
        own = {grid: follow_cavities(journal, motion, cells=grid) for grid in grids}
        coarse = min(grids)
        try:
            older = follow_cavities(journal, motion, sinking=OTHER_TURN, cells=coarse)
        except OverlapError:  # a film that rises was thicker a turn earlier
            older = follow_cavities(journal, motion, sinking=0.0, cells=coarse)
        if motion.otherwise is None:
            return cls(own, older)
        return cls(own, older, follow_cavities(journal, motion.otherwise, cells=coarse))


@dataclass(frozen=True)
class _Search:
    """What the pressure of each trigger follows from.

    Attributes
    ----------
    journal : Journal
        With any viscosity.
    viscosity : Array
        (trigger,) [Pa s]
    motion : PinMotion
    view : _View
    cells : (int, int)
    settings_std : Array
        Standard deviations over the values, in the order of `SETTINGS`.
    load_line_std : float
        Of the place of the load line. [m]
    cavities : _Cavities or None
        None: as if they were older than the film.
    """

    journal: Journal
    viscosity: Array
    motion: PinMotion
    view: _View
    cells: tuple[int, int]
    settings_std: Array
    load_line_std: float
    cavities: _Cavities | None = None

    @property
    def triggers(self) -> npt.NDArray[np.intp]:
        """Numbers of the times of the motion that are triggers."""
        recorded = self.motion.recorded
        return np.arange(self.viscosity.size) if recorded is None else np.flatnonzero(recorded)

    def find_all(self, progress: Progress) -> list[dict[str, Array]]:
        """Pressure of all triggers."""
        what = "pressure" if self.cavities is None else "pressure with cavities"
        rows = []
        for done, k in enumerate(self.triggers):
            try:
                journal = replace(self.journal, viscosity=float(self.viscosity[done]))
                rows.append(self._find(journal, k))
            except ModelError as error:
                rows.append(_nothing(solved=isinstance(error, OverlapError)))
            progress(what, done + 1, self.viscosity.size)
        return rows

    def _solve(
        self,
        journal: Journal,
        k: int,
        at: Array,
        cells: tuple[int, int],
        void: Array | None = None,
    ) -> xr.Dataset:
        """The film at position, rate and relative changes of the settings."""
        viscosity, clearance = at[2 * NUMBERS :]
        wider = clearance * journal.clearance
        if void is None and self.cavities is not None:
            void = self.cavities.own[cells][k]
        return solve_pin_motion(
            replace(
                journal,
                viscosity=journal.viscosity * (1 + viscosity),
                bushing_radius=journal.bushing_radius + wider,
            ),
            at[:NUMBERS] + wider * self.view.lift(),
            at[NUMBERS : 2 * NUMBERS],
            float(self.motion.turning[k]),
            turned=0.5 * float(self.motion.angle[k]),
            void_fraction=void,
            cells=cells,
        )

    def _find(self, journal: Journal, k: int) -> dict[str, Array]:
        """Pressure of one trigger."""
        motion, view, cavities = self.motion, self.view, self.cavities
        solve, coarse = partial(self._solve, journal, k), _coarser(self.cells)
        numbers = np.concatenate([motion.position[k], motion.rate[k], np.zeros(len(SETTINGS))])
        solved = solve(numbers, self.cells)
        found = view.look(solved)
        own, common = motion.random_root[k], motion.shared_root[k]
        std = np.sqrt((own**2).sum(axis=1) + (common**2).sum(axis=1))
        steps = np.concatenate([_steps(std, float(solved.film.min()), journal), _NUDGE])
        rough = view.look(solve(numbers, coarse))
        slopes = _differentiate(lambda at: view.look(solve(at, coarse)), rough, numbers, steps)

        # cavities are known to within half the change of two triggers
        other = older = gap = dict.fromkeys(found, np.array(0.0))
        if cavities is not None:
            near = cavities.own[coarse]
            voids = [near[k - 1], near[(k + 1) % len(near)], cavities.older[k]]
            before, after, past = (view.look(solve(numbers, coarse, void)) for void in voids)
            other = {name: 0.5 * (after[name] - before[name]) for name in found}
            older = {name: past[name] - rough[name] for name in found}
            if cavities.alone is not None:
                path = view.look(solve(numbers, coarse, cavities.alone[k]))
                gap = {name: path[name] - rough[name] for name in found}

        # what a small turn of the load line does to both forces, and the cells to the rest
        line = self.load_line_std / journal.radius
        turned = {
            "load_from_pressure": line * found["side_from_pressure"],
            "side_from_pressure": line * found["load_from_pressure"],
        }
        rows: dict[str, Array] = {}
        for name, value in found.items():
            carried = np.concatenate(list(self._carry(slopes[name], k).values()), axis=-1)
            cell = _grid_error(self.cells, long=journal.long) * value
            if name == "peak_place":
                cell = PLACE_ERROR * np.array(2 * np.pi * journal.radius / self.cells[0])
            turn = turned.get(name, np.zeros(()))
            rows[name] = value
            rows[name + _CELLS] = np.asarray(rough[name] - value)
            rows[f"{name}_std"] = np.sqrt(
                (carried**2).sum(axis=-1)
                + other[name] ** 2
                + older[name] ** 2
                + gap[name] ** 2
                + cell**2
                + turn**2
            )
            if name == "load_from_pressure":
                rows["load_root"] = np.concatenate([carried, [cell, turn, older[name], gap[name]]])
                rows["load_own"] = np.array(other[name])
        peak = slopes["peak_pressure"]
        for name, part in self._carry(peak, k).items():
            rows[f"peak_std_{name}"] = np.sqrt((part**2).sum())
        for name, slope in zip(_SENSITIVITIES, peak[2 * NUMBERS :], strict=True):
            rows[name] = slope / found["peak_pressure"]

        rows["pressure_solved"] = np.array(1)
        rows["cavity"] = np.array((view.cut(solved.void_fraction) > 0).mean())
        rows["cavity_change"] = np.array(0.0)
        rows["cavity_history"] = np.abs(older["peak_pressure"] / found["peak_pressure"])
        return rows

    def _carry(self, slope: Array, k: int) -> dict[str, Array]:
        """Changes of a result with every cause, (..., cause), by their kind.

        `slope` are the derivatives with position, rate and settings, (number, ...).
        """
        slopes = np.moveaxis(slope, 0, -1)
        motion, settings = slopes[..., None, : 2 * NUMBERS], slopes[..., 2 * NUMBERS :]
        return {
            "random": (motion @ self.motion.random_root[k])[..., 0, :],
            "shared": (motion @ self.motion.shared_root[k])[..., 0, :],
            "settings": settings * self.settings_std,
        }


def _grid_error(cells: tuple[int, int], *, long: bool) -> float:
    """Relative error by the cells; a long joint has none along its axis."""
    wider = [had / has for had, has in zip(CELLS, cells, strict=True)][: 1 if long else 2]
    return float(GRID_ERROR * max(wider) ** 2)


def _steps(std: Array, film: float, journal: Journal) -> Array:
    """Steps of the derivatives: one standard deviation, limited by the change of the film."""
    reach = np.array([1.0, 1.0, journal.length / 2, journal.length / 2])
    most = np.concatenate([_STEP * film / reach, np.full(NUMBERS, np.inf)])
    return np.where(std > 0, np.minimum(std, most), 0.0)


def _differentiate(
    look: Callable[[Array], dict[str, Array]],
    found: dict[str, Array],
    numbers: Array,
    steps: Array,
) -> dict[str, Array]:
    """Derivatives of everything with the numbers, (number, ...), by forward differences.

    `found` is what `look` gives for the numbers themselves.
    """
    slopes = {name: np.zeros((numbers.size, *np.shape(found[name]))) for name in found}
    for i in np.flatnonzero(steps > 0):
        there = numbers.copy()
        there[i] += steps[i]
        moved = look(there)
        for name, slope in slopes.items():
            slope[i] = (moved[name] - found[name]) / steps[i]
    return slopes
