"""Orbits of the pin for sets of unknowns: free in a full film, or held in one with cavities."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.models.reynolds import Journal, Motion, Mount, solve_journal
from erlif.models.reynolds.full_film import THINNEST, FullFilm, follow_full_film

CELLS = (64, 2)
"""Cells of the transient film round the joint and along half of its length, for derivatives. What
these, and every other step of time, leave out is extrapolated once for each fit."""

FINE_CELLS, LONG_CELLS = (96, 6), (64, 4)
"""Cells from which is extrapolated, and those for long runs."""

HELD_ERROR = 0.004
"""Relative error of the extrapolated film of a held pin, against that of the virtual rig."""

HELD_SCATTER = 0.0015
"""Part of it that changes over the cycle."""

_LONG = 2000  # steps of a long run
_SECOND_ORDER = 4 / 3  # of the change by twice as many cells, that by infinitely many
_FIRST_ORDER = 2.0  # and of the change by steps of half the length

ATMOSPHERE = 1e5
"""Scale of the cavitation pressure. [Pa]"""

_SMALLEST_FLUIDITY = 1e-3  # of a film with cavities, which a pin without load would never leave


class Orbits(Protocol):
    """What follows pins through the motion of a run.

    Attributes
    ----------
    journal : Journal
        The joint, with the viscosity to which the fitted fluidity is relative.
    motion : Motion
        Rotation of the bushing and load at each time.
    """

    @property
    def journal(self) -> Journal: ...

    @property
    def motion(self) -> Motion: ...

    def follow(self, unknowns: dict[str, Array]) -> Array:
        """Displacement along the load and sideways, (case, step, axis). [m]

        Unknowns are arrays (case,): fluidity, viscosity of the joint over that of the case;
        start_film, logarithm of the film at the first step in metres; start_attitude [rad]; rest,
        over the clearance; stiffness, decimal logarithm of that in N/m; cavitation_pressure,
        suction in atmospheres. NaN where no film carries the load.
        """


@dataclass(frozen=True)
class FreeOrbits:
    """Pins that are free sideways, or on a soft spring, in a film that does not rupture.

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
        """As `Orbits.follow`; fluidity, start_film and start_attitude, with a spring the others."""
        clearance = self.journal.clearance
        film = np.clip(np.exp(unknowns["start_film"]) / clearance, 2 * THINNEST, 1.0)
        eccentric, attitude = (1 - film) * clearance, unknowns["start_attitude"]
        spring = "stiffness" in unknowns
        return follow_full_film(
            self.journal,
            self.motion,
            start=np.stack([eccentric * np.cos(attitude), eccentric * np.sin(attitude)], axis=1),
            fluidity=unknowns["fluidity"],
            stiffness=10 ** unknowns["stiffness"] if spring else 0.0,
            rest=unknowns["rest"] * clearance if spring else 0.0,
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
        film = 1 - distance / self.journal.clearance
        return float(FullFilm.of(self.journal).lowest_pressure(film, force).min())


@dataclass(frozen=True)
class HeldOrbits:
    """Pins in a film with cavities: guided, on a spring, or free.

    Attributes
    ----------
    journal : Journal
        The joint.
    motion : Motion
        Its motion.
    sideways : str
        "guided", "spring" or "free".
    cells : (int, int)
        Cells round the joint and along half of its length.
    shift : Array or None
        What is added to the displacements, (step, axis). [m]
    lead : Motion or None
        What precedes the motion, with times below its own: there the cavities form. The start of
        the pin is that of the lead.
    followed : dict
        Orbits of these settings that are known, by cells, stride and unknowns.
    """

    journal: Journal
    motion: Motion
    sideways: str
    cells: tuple[int, int] = CELLS
    shift: Array | None = None
    lead: Motion | None = None
    followed: dict[tuple[object, ...], Array] = field(default_factory=dict, init=False, repr=False)

    def follow(self, unknowns: dict[str, Array]) -> Array:
        """As `Orbits.follow`, one transient film for each case, in every other step of time."""
        cases = len(unknowns["fluidity"])
        one = ({name: float(column[k]) for name, column in unknowns.items()} for k in range(cases))
        found = np.stack([self._known(self.cells, 2, case) for case in one])
        return found if self.shift is None else found + self.shift

    def corrected(self, unknowns: dict[str, float]) -> HeldOrbits:
        """These orbits, shifted by what cells and steps leave out at a set of unknowns.

        Richardson's extrapolation, in each direction by itself.
        """
        fine = FINE_CELLS if self.motion.time.size <= _LONG else LONG_CELLS
        (around, across), steps = fine, self._known(fine, 2, unknowns)
        shift = steps - self._known(self.cells, 2, unknowns)
        shift = shift + _FIRST_ORDER * (self._known(fine, 1, unknowns) - steps)
        finer = [(2 * around, across)] + ([] if self.journal.long else [(around, 2 * across)])
        for cells in finer:
            shift = shift + _SECOND_ORDER * (self._known(cells, 2, unknowns) - steps)
        if np.isnan(shift).any():
            return self
        found = replace(self, shift=shift)
        found.followed.update(self.followed)  # without the shift
        return found

    def _known(self, cells: tuple[int, int], stride: int, unknowns: dict[str, float]) -> Array:
        """`follow_one`, once for each set of unknowns."""
        key = (cells, stride, *sorted(unknowns.items()))
        if key not in self.followed:
            self.followed[key] = self.follow_one(cells, stride, **unknowns)
        return self.followed[key]

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
    ) -> Array:
        """Displacements of one pin, (step, axis), from steps of the motion at a stride. [m]"""
        clearance = self.journal.clearance
        viscosity = self.journal.viscosity / max(fluidity, _SMALLEST_FLUIDITY)
        journal = replace(self.journal, viscosity=viscosity)
        if cavitation_pressure is not None:
            suction = ATMOSPHERE * max(cavitation_pressure, 0.0)
            journal = replace(journal, cavitation_pressure=-suction)

        # a pin whose mount has a place at rest starts there unless its attitude is known
        eccentric = clearance - float(np.exp(start_film))
        side = rest * clearance
        if start_attitude is not None:
            side = eccentric * float(np.sin(start_attitude))
        start = float(np.sqrt(max(eccentric**2 - side**2, 0.0))), side
        mount: Mount | str = "free"
        if self.sideways == "guided":
            mount = Mount(np.inf, rest=rest * clearance, direction=0.0)
        elif self.sideways == "spring":
            mount = Mount(10**stiffness, rest=rest * clearance, direction=0.0)
        motion = _thinned(_joined(self.lead, self.motion), stride)
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
        both = solved.displacement_load.values, solved.displacement_side.values
        return np.stack([np.interp(self.motion.time, motion.time, axis) for axis in both], axis=1)


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
    kept = motion.time < motion.time[0] + period * (1 - 1e-9)
    if kept.sum() < 2:
        return None
    return Motion(
        motion.time[kept] - period,
        *(np.asarray(one)[kept] for one in (motion.angle, motion.load, motion.load_direction)),
    )


def _joined(lead: Motion | None, motion: Motion) -> Motion:
    """A motion after its lead."""
    if lead is None:
        return motion
    names = "time", "angle", "load", "load_direction"
    return Motion(*(np.append(getattr(lead, name), getattr(motion, name)) for name in names))


def _thinned(motion: Motion, stride: int) -> Motion:
    """Every so many steps of a motion, and the last."""
    kept = np.unique(np.append(np.arange(0, motion.time.size, stride), motion.time.size - 1))
    series = motion.time, motion.angle, motion.load, motion.load_direction
    return Motion(*(np.asarray(one)[kept] for one in series))
