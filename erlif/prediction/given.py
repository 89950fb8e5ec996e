"""What errors of given numbers, clearance, load and load line, change in a fit of the film."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import Array
from erlif.prediction.least_squares import LeastSquares, Minimum
from erlif.prediction.orbits import HeldOrbits
from erlif.prediction.problem import Problem

# Relative change of clearance and load from which derivatives are computed, and of the load line
# over the radius: above the jumps of a film whose cells change to cavities.
_STEP = 2e-3


@dataclass(frozen=True)
class GivenErrors:
    """Standard deviations of numbers that a fit takes for given.

    The positions do not correct them: each changes the fitted numbers in proportion.

    Attributes
    ----------
    clearance : float
        Of the radial clearance. The films are measured, so that displacements change with it. [m]
    load : float
        Of the load, all triggers alike, over the load.
    load_line : float or None
        Of a load line that is given, along sliding; None where it is not. [m]

    Raises
    ------
    ValueError
        If one of them is negative.
    """

    clearance: float = 0.0
    load: float = 0.0
    load_line: float | None = None

    def __post_init__(self) -> None:
        if min(self.clearance, self.load, self.load_line or 0.0) < 0:
            raise ValueError(f"give standard deviations of zero or more, got {self}")


@dataclass(frozen=True)
class Change:
    """A given number that is changed by a small step, and the fit that follows.

    Attributes
    ----------
    problem : Problem
        With the changed number.
    steps : float
        Standard deviations of the number over the step.
    value : Array
        The unknowns of the least squares, to first order; NaN where no film carries the load.
        (unknown,)
    """

    problem: Problem
    steps: float
    value: Array


def follow_changes(
    problem: Problem, least: LeastSquares, minimum: Minimum, given: GivenErrors
) -> dict[str, Change]:
    """Move the least squares with each given number that has an error.

    One film for each number, at the fitted unknowns; the derivatives of the fit do the rest.

    Parameters
    ----------
    problem : Problem
    least : LeastSquares
        Its search.
    minimum : Minimum
        Where that ended.
    given : GivenErrors

    Returns
    -------
    dict of str to Change
        By the names of `GivenErrors`, of those above zero. A load line is among them only where it
        is not fitted.
    """
    journal = problem.orbits.journal
    units = {"clearance": journal.clearance, "load": 1.0, "load_line": journal.radius}
    here = least.misses(minimum.value[np.newaxis])[0]
    changes = {}
    for name, unit in units.items():
        std = getattr(given, name)
        if not std or name in least.unknowns.names:
            continue
        moved, unknowns = _moved(problem, name), least.unknowns
        if name == "load_line":
            unknowns = replace(unknowns, fixed={**unknowns.fixed, name: _STEP})
        (films,) = moved.predict(minimum.value[np.newaxis], unknowns)

        # the films are measured, and the displacements follow with the clearance
        wider = moved.orbits.journal.clearance - journal.clearance
        widening = problem.measured.widening[problem.frames.measured]
        off = least.observed.whiten(least.observed.value + wider * widening - films) - here
        value = minimum.value + _follow(least, minimum, off)
        changes[name] = Change(moved, std / (_STEP * unit), value)
    return changes


def _moved(problem: Problem, name: str) -> Problem:
    """A problem with the clearance or the load larger by a step."""
    orbits, more = problem.orbits, 1 + _STEP
    if name == "clearance":
        radius = orbits.journal.pin_radius + more * orbits.journal.clearance
        orbits = replace(orbits, journal=replace(orbits.journal, bushing_radius=radius))
    elif name == "load":
        orbits = replace(orbits, motion=replace(orbits.motion, load=more * orbits.motion.load))
        if isinstance(orbits, HeldOrbits) and orbits.lead is not None:
            orbits = replace(orbits, lead=replace(orbits.lead, load=more * orbits.lead.load))
    return replace(problem, orbits=orbits)


def _follow(least: LeastSquares, minimum: Minimum, off: Array) -> Array:
    """Change of the unknowns with a change of the whitened misses, to first order."""
    if not np.isfinite(off).all():
        return np.full(minimum.value.size, np.nan)
    jacobian = np.nan_to_num(minimum.jacobian)
    matrix, right = least.system(off, jacobian, minimum.value, minimum.inflation)
    right[off.size :] = 0.0  # what was expected stays
    found = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    return np.asarray(found[: minimum.value.size])
