"""Orbits of the pin for sets of unknowns: free in a full film, or held in one with cavities."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.reynolds import Journal, Motion, Mount, solve_journal
from erlif.models.reynolds.full_film import FullFilm, follow_full_film
from erlif.models.reynolds.squeeze_tables import THINNEST
from erlif.prediction.motion import scaled_time

# Cells of the transient film round the joint and along half of its length, for derivatives, and
# those of a bore with a shape. What these, and every other step of time, leave out is extrapolated
# once for each fit.
CELLS, SHAPED_CELLS = (64, 2), (64, 8)

# Cells from which is extrapolated, and those for long runs.
FINE_CELLS, LONG_CELLS = (96, 6), (64, 4)
FINE_SHAPED = (96, 8)

# Cells that resolve how cavities end at the ends of the joint; with fewer than a dozen along half
# of the length the film does not yet tend to its limit.
AXIAL_CELLS = (64, 24)

# Relative error of the film of a held pin without extrapolation along the axis.
HELD_ERROR = 0.003

# Relative error of the extrapolated film beside its doubts, new at every trigger.
HELD_SCATTER = 0.0006

_STRIDE = 2  # steps of the motion in one of the film of a search
_LONG = 2000  # steps of a long run

# Of the change by half the spacing, what leads to the limit: 4/3 at second order, 2 at first. The
# edges of cavities move by whole cells, which leaves a part of first order; springs, which belong
# to the end of a step, have it alone. Along the axis the finer of both is already counted.
_HALF_STEPS = {"free": 4 / 3, "guided": 5 / 3, "spring": 2.0}
_AROUND = 4 / 3
_AXIAL = 0.5
_UNEVEN = 0.4  # of the change by half the spacing, as a doubt: from one order to the other

# Scale of the cavitation pressure. [Pa]
ATMOSPHERE = 1e5

_SECANTS = 5  # steps to the start of a longer lead
_MET = 1e-6  # of the clearance, within which the film at the first step is the same
_NUDGE = 0.02  # of the logarithm of the start film, for the first of them
_THICKEST = 0.999  # of the clearance, of a start film

_SMALLEST_FLUIDITY = 1e-3  # of a film with cavities, which a pin without load would never leave


# Cells, stride and unknowns of one film.
_FilmCase: TypeAlias = tuple[tuple[int, int], int, dict[str, float]]


@dataclass(frozen=True)
class FreeOrbits:
    """Pins that are free sideways, in a film that does not rupture.

    Attributes
    ----------
    journal : Journal
        The joint.
    motion : Motion
        Its motion.
    """

    journal: Journal
    motion: Motion

    def follow(self, unknowns: dict[str, Array]) -> Array:
        """Displacement along the load and sideways, (case, step, axis). [m]

        Unknowns are arrays (case,): fluidity, viscosity of the joint over that of the case;
        start_film, logarithm of the film at the first step in metres; start_attitude [rad]. Where
        it is given, drift, change of the logarithm of the viscosity from the first step to the
        last.
        """
        drift = unknowns.get("drift", np.zeros(len(unknowns["fluidity"])))
        orbits = np.empty((drift.size, self.motion.time.size, 2))
        for one in np.unique(drift):
            alike = drift == one
            chosen = {name: column[alike] for name, column in unknowns.items()}
            orbits[alike] = self._follow_in(drifted(self.motion, None, one)[0], chosen)
        return orbits

    def _follow_in(self, motion: Motion, unknowns: dict[str, Array]) -> Array:
        """The orbits of one motion."""
        clearance = self.journal.least_clearance
        film = np.clip(np.exp(unknowns["start_film"]) / clearance, 2 * THINNEST, 1.0)
        eccentric, attitude = (1 - film) * clearance, unknowns["start_attitude"]
        return follow_full_film(
            self.journal,
            motion,
            start=np.stack([eccentric * np.cos(attitude), eccentric * np.sin(attitude)], axis=1),
            fluidity=unknowns["fluidity"],
        )

    def lowest_pressure(self, orbit: Array) -> float:
        """A bound of the lowest pressure on an orbit (step, axis). [Pa]"""
        distance = np.maximum(np.hypot(orbit[:, 0], orbit[:, 1]), 1e-15)
        motion, unit = self.motion, orbit / distance[:, np.newaxis]
        force = motion.load[:, np.newaxis] * np.stack(
            [
                unit[:, 0] * np.cos(motion.load_direction)
                + unit[:, 1] * np.sin(motion.load_direction),
                unit[:, 0] * np.sin(motion.load_direction)
                - unit[:, 1] * np.cos(motion.load_direction),
            ],
            axis=1,
        )
        film = 1 - distance / self.journal.least_clearance
        return float(FullFilm.of(self.journal).lowest_pressure(film, force).min())


@dataclass(frozen=True)
class HeldOrbits:
    """Pins in a film with cavities: guided, on a spring, or free on an elastic liner.

    Attributes
    ----------
    sideways : str
        "guided", "spring" or "free".
    journal : Journal
        The joint. On an elastic liner the displacements are those that would leave its minimum film
        between rigid walls: the deflected wall is what is measured.
    motion : Motion
        Its motion.
    cells : (int, int)
        Cells round the joint and along half of its length.
    shift : Array or None
        What is added to the displacements, (step, axis). [m]
    doubts : Array or None
        Standard deviations of what is added, each an error of all steps together: the changes by
        half the steps, by twice the cells round the joint and along the axis, and smooth courses,
        (step, axis, source). Where there are none, the film is off by `HELD_ERROR`. [m]
    lead : Motion or None
        The turn that precedes the motion, with times below its own: there the cavities form. The
        start of the pin is that of the lead.
    turns : int
        How often the lead is repeated.
    followed : dict
        Orbits of these settings that are known, by cells, stride and unknowns.
    """

    journal: Journal
    motion: Motion
    sideways: str
    cells: tuple[int, int] = CELLS
    shift: Array | None = None
    doubts: Array | None = None
    lead: Motion | None = None
    turns: int = 1
    followed: dict[tuple[object, ...], Array] = field(default_factory=dict, init=False, repr=False)

    def follow(self, unknowns: dict[str, Array]) -> Array:
        """As `FreeOrbits.follow`, one transient film for each case.

        Besides, rest is over the clearance, stiffness the decimal logarithm of that in N/m, and
        cavitation_pressure the suction in atmospheres. NaN where no film carries the load.
        """
        cases = len(unknowns["fluidity"])
        each = [{name: float(column[k]) for name, column in unknowns.items()} for k in range(cases)]
        found = np.stack(self._all_known([(self.cells, _STRIDE, case) for case in each]))
        return found if self.shift is None else found + self.shift

    def corrected(self, unknowns: dict[str, float]) -> HeldOrbits:
        """Shift the orbits by the error of cells and steps at a set of unknowns.

        Richardson's extrapolation, in each direction by itself. Along the axis it begins at
        `AXIAL_CELLS`; long runs have none there.
        """

        def follow(cells: tuple[int, int], stride: int = _STRIDE) -> Array:
            return self._known(cells, stride, unknowns)

        shaped = self.journal.axial_shape is not None
        long = self.motion.time.size > _LONG and not shaped
        around, across = LONG_CELLS if long else FINE_SHAPED if shaped else FINE_CELLS
        if long:  # the longest first, so that the others are followed beside it
            films = [((around, across), 1), ((2 * around, across), _STRIDE)]
            films += [((around, across), _STRIDE), (self.cells, _STRIDE)]
            self._all_known([(cells, stride, unknowns) for cells, stride in films])
        fine = follow((around, across))
        shift = fine - follow(self.cells)
        halved = follow((around, across), stride=1) - fine
        twice = follow((2 * around, across)) - fine
        shift = shift + _HALF_STEPS[self.sideways] * halved + _AROUND * twice

        # the errors that remain are of the kind of the changes, and shared by all steps
        changes = [halved, twice]
        if long:
            changes.append(film_change(fine, self.journal.clearance, HELD_ERROR))
        elif not self.journal.long:
            few, many = AXIAL_CELLS
            limit = follow(AXIAL_CELLS)
            along = limit - follow((few, many // 2))
            shift = shift + limit - follow((few, across)) + _AXIAL * along
            changes.append(along)
        if np.isnan(shift).any():
            return self
        each = np.stack(changes, axis=-1)
        doubts = np.concatenate([_UNEVEN * each, self._smooth(each)], axis=2)
        orbits = replace(self, shift=shift, doubts=doubts)
        orbits.followed.update(self.followed)  # without the shift
        return orbits

    def _smooth(self, changes: Array) -> Array:
        """Smooth errors with the rms size of the given changes, (step, axis, source).

        Constant, linear in time, and once a turn. Cells that change to cavities make the changes
        uneven. The measured positions determine how much of the uneven course there is; the smooth
        errors need not be as much.
        """
        size = np.sqrt(np.mean(np.sum(changes**2, axis=2), axis=0))
        time = self.motion.time - self.motion.time[0]
        modes = [np.ones_like(time), np.sqrt(3) * (2 * time / time[-1] - 1)]
        if self.lead is not None:
            turn = 2 * np.pi * time / (self.motion.time[0] - self.lead.time[0])
            modes += [np.sqrt(2) * np.cos(turn), np.sqrt(2) * np.sin(turn)]
        smooth = np.stack(modes, axis=1)[:, np.newaxis, np.newaxis] * np.diag(size)[..., np.newaxis]
        return np.asarray(smooth.reshape(*changes.shape[:2], -1))

    def _known(self, cells: tuple[int, int], stride: int, unknowns: dict[str, float]) -> Array:
        """`follow_one`, once for each set of unknowns."""
        key = (cells, stride, *sorted(unknowns.items()))
        if key not in self.followed:
            self.followed[key] = self.follow_one(cells, stride, **unknowns)
        return self.followed[key]

    def _all_known(self, wanted: list[_FilmCase]) -> list[Array]:
        """`_known` of several films; those of long runs side by side, one for each processor."""
        if self.motion.time.size <= _LONG or len(wanted) == 1:
            return [self._known(*one) for one in wanted]
        with ThreadPoolExecutor(min(len(wanted), os.cpu_count() or 1)) as pool:
            return list(pool.map(lambda one: self._known(*one), wanted))

    def lengthened(self, unknowns: dict[str, float]) -> tuple[HeldOrbits, float, float]:
        """These orbits after one more turn of the lead, from the same film at the first step.

        Parameters
        ----------
        unknowns : dict of str to float
            As for `follow`, one case.

        Returns
        -------
        orbits : HeldOrbits
        start_film : float
            The unknown of this name, at the start of the longer lead.
        change : float
            Largest change of a displacement: what the cavities of the shorter lead remember of how
            they began. Zero without a lead. [m]
        """
        longer = replace(self, turns=self.turns + 1)
        if self.lead is None:
            return self, unknowns["start_film"], 0.0

        def follow(film: float) -> Array:
            return longer._known(self.cells, _STRIDE, {**unknowns, "start_film": film})

        # by secants, the start that leads to the same film at the first step
        known = self._known(self.cells, _STRIDE, unknowns)
        aim, thickest = np.hypot(*known[0]), np.log(_THICKEST * self.journal.least_clearance)
        start = unknowns["start_film"]
        film, found = start + _NUDGE, follow(start)
        off = np.hypot(*found[0]) - aim
        for _ in range(_SECANTS):
            before, last = off, start
            start, found = film, follow(film)
            off = np.hypot(*found[0]) - aim
            if not np.isfinite(off) or off == before:
                return self, unknowns["start_film"], 0.0
            if abs(off) < _MET * self.journal.clearance:
                break
            film = min(start - off * (start - last) / (off - before), float(thickest))
        return longer, start, float(np.abs(found - known).max())

    def follow_one(
        self,
        cells: tuple[int, int],
        stride: int,
        *,
        fluidity: float,
        start_film: float,
        start_attitude: float | None = None,
        rest: float = 0.0,
        stiffness: float = 0.0,
        cavitation_pressure: float | None = None,
        drift: float = 0.0,
    ) -> Array:
        """Displacements of one pin, (step, axis), from steps of the motion at a stride. [m]"""
        clearance = self.journal.clearance
        viscosity = self.journal.viscosity / max(fluidity, _SMALLEST_FLUIDITY)
        journal = replace(self.journal, viscosity=viscosity)
        if cavitation_pressure is not None:
            suction = ATMOSPHERE * max(cavitation_pressure, 0.0)
            journal = replace(journal, cavitation_pressure=-suction)

        # a pin whose mount has a place at rest starts there unless its attitude is known
        least = self.journal.least_clearance
        eccentric = least - float(np.exp(start_film))
        side = rest * clearance
        if start_attitude is not None:
            side = eccentric * float(np.sin(start_attitude))
        start = float(np.sqrt(max(eccentric**2 - side**2, 0.0))), side
        size = {"guided": np.inf, "free": 0.0}.get(self.sideways, 10**stiffness)
        mount = Mount(size, rest=rest * clearance, direction=0.0)
        own, lead = drifted(self.motion, self.lead, drift)
        whole = _joined(lead, self.turns, own)
        last = whole.time.size - 1
        motion = whole.at(np.unique(np.append(np.arange(0, last + 1, stride), last)))
        try:
            solved = solve_journal(
                journal,
                motion,
                start=start,
                sideways=mount,
                cells=(cells[0], 1) if self.journal.long else cells,
                compiled=True,
            )
        except ModelError:
            return np.full((self.motion.time.size, 2), np.nan)
        both = np.stack([solved.displacement_load.values, solved.displacement_side.values])
        if journal.foundation is not None:
            both *= 1 - peak_yield(solved, journal.foundation) / np.hypot(*both)
        return np.stack([np.interp(own.time, motion.time, axis) for axis in both], axis=1)


# What follows pins through the motion of a run.
Orbits: TypeAlias = FreeOrbits | HeldOrbits


def peak_yield(solved: xr.Dataset, foundation: float) -> Array:
    """Deflection of a liner by the highest pressure at each time, between those of the steps.

    Parameters
    ----------
    solved : xarray.Dataset
        Of `solve_journal`.
    foundation : float
        As of `Journal`. [Pa/m]

    Returns
    -------
    array, (step,)
        [m]

    Examples
    --------
    >>> peaks = xr.Dataset({"peak_pressure": ("time", [np.nan, 3e6, 6e6])})
    >>> peak_yield(peaks, 3e12)
    array([1.0e-06, 1.5e-06, 2.0e-06])
    """
    steps = solved["peak_pressure"].values[1:] / foundation
    return np.convolve(np.pad(steps, 1, mode="edge"), [0.5, 0.5], mode="valid")


def film_change(place: Array, clearance: float, part: float) -> Array:
    """Change of displacements by a part of their film, towards the middle.

    Parameters
    ----------
    place : array, (..., axis)
        Displacement along the load and sideways, or along the load alone. [m]
    clearance : float
        Radial clearance. [m]
    part : float
        Of the film.

    Returns
    -------
    array, (..., axis)
        [m]

    Examples
    --------
    >>> film_change(np.array([[3.0, 4.0]]), 7.0, 0.1)
    array([[-0.12, -0.16]])
    """
    distance = np.sqrt(np.sum(place**2, axis=-1, keepdims=True))
    return np.asarray(-part * (clearance - distance) / np.maximum(distance, 1e-12) * place)


def drifted(motion: Motion, lead: Motion | None, change: float) -> tuple[Motion, Motion | None]:
    """A motion and its lead in oil whose viscosity changes evenly with time.

    Parameters
    ----------
    motion : Motion
    lead : Motion or None
        Before it, in oil of the first step.
    change : float
        Of the logarithm of the viscosity from the first step of the motion to the last; its mean
        stays.

    Returns
    -------
    motion : Motion
    lead : Motion or None

    Examples
    --------
    >>> even = Motion(np.linspace(0.0, 1.0, 5), 0 * np.arange(5.0), load=222.4)
    >>> drifted(even, None, -0.1)[0].time.round(4)
    array([0.    , 0.2408, 0.4877, 0.7409, 1.0005])
    """
    if change == 0:
        return motion, lead
    passed = (motion.time - motion.time[0]) / (motion.time[-1] - motion.time[0])
    return thickened(motion, lead, np.exp(change * (passed - 0.5)))


def thickened(
    motion: Motion, lead: Motion | None, viscosity: Array
) -> tuple[Motion, Motion | None]:
    """A motion and its lead in oil of another viscosity at each step, in scaled times.

    Parameters
    ----------
    motion : Motion
    lead : Motion or None
        Before it, in oil of the first step.
    viscosity : array, (step,)
        Over that of the oil. [1]

    Returns
    -------
    motion : Motion
    lead : Motion or None
    """
    start = motion.time[0]
    mean, since = scaled_time(motion.time, motion.time, viscosity)
    if lead is not None:
        lead = replace(lead, time=start + (lead.time - start) / float(viscosity[0]))
    return replace(motion, time=start + since / mean), lead


def lead_of(motion: Motion, crank: Array) -> Motion | None:
    """The first turn of the crank once more, before a motion.

    Parameters
    ----------
    motion : Motion
    crank : array, (step,)
        Crank angle, counted on from turn to turn. [rad]

    Returns
    -------
    Motion or None
        None where the motion has no whole turn.

    Examples
    --------
    >>> time = np.linspace(0.0, 2.0, 201)
    >>> lead = lead_of(Motion(time, 0.2 * np.sin(6 * time), 222.4), crank=2 * np.pi * time)
    >>> lead.time.size, round(float(lead.time[0]), 3), round(float(lead.time[-1]), 3)
    (100, -1.0, -0.01)
    """
    turned = crank - crank[0]
    if turned[-1] < 2 * np.pi * (1 - 1e-9):
        return None
    period = float(np.interp(2 * np.pi, turned, motion.time)) - motion.time[0]
    first = motion.at(motion.time < motion.time[0] + period * (1 - 1e-9))
    return replace(first, time=first.time - period)


def _joined(lead: Motion | None, turns: int, motion: Motion) -> Motion:
    """A motion after some turns of its lead."""
    if lead is None:
        return motion
    period = motion.time[0] - lead.time[0]
    before = [lead.time - k * period for k in range(turns - 1, -1, -1)]
    return Motion(
        np.concatenate([*before, motion.time]),
        np.append(np.tile(lead.angle, turns), motion.angle),
        np.append(np.tile(lead.load, turns), motion.load),
        np.append(np.tile(lead.load_direction, turns), motion.load_direction),
    )
