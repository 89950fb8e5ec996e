"""Effect of errors of given numbers on a fit: clearance, load, load line, tilt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from erlif.core.arrays import Array
from erlif.models.reynolds.full_film import FullFilm
from erlif.prediction.least_squares import LeastSquares, Minimum
from erlif.prediction.orbits import HeldOrbits, thickened
from erlif.prediction.problem import Problem

# Relative change of clearance and load from which derivatives are computed, and of the load line
# over the radius: above the jumps of a film whose cells change to cavities.
_STEP = 2e-3

# The film changes with the square of the tilt, whose rms is this times the variance.
_SQUARE = float(np.sqrt(3))

_SLICES = 8  # along the joint, of a tilted film

# Numbers within whose widths the fit itself looks.
FITTED = ("drift", "cavitation_pressure")


@dataclass(frozen=True)
class GivenErrors:
    """Standard deviations of numbers that a fit takes as given.

    The positions do not correct clearance, load, load line and tilt: each changes the fitted
    numbers. Drift and cavitation pressure change the course of the film, and are fitted within
    their widths.

    Attributes
    ----------
    clearance : float
        Of the radial clearance. The films are measured, so that displacements change with it. [m]
    load : float
        Of the load, all triggers alike, over the load.
    load_line : float or None
        Of a load line that is given, along sliding; None where it is not. [m]
    tilt : float
        Of the pin in its bushing, towards the load, about parallel. [m/m]
    drift : float
        Of the change of the logarithm of the viscosity from the first step to the last, beside that
        of the logged temperature.
    cavitation_pressure : float
        Of that of a held pin. [Pa]
    viscosity : float
        Of the viscosity over it, all triggers alike. A fit, which finds the viscosity, has no use
        for it.

    Raises
    ------
    ValueError
        If one of them is negative.
    """

    clearance: float = 0.0
    load: float = 0.0
    load_line: float | None = None
    tilt: float = 0.0
    drift: float = 0.0
    cavitation_pressure: float = 0.0
    viscosity: float = 0.0

    def __post_init__(self) -> None:
        if min(one or 0.0 for one in vars(self).values()) < 0:
            raise ValueError(f"give standard deviations of zero or more, got {self}")


@dataclass(frozen=True)
class GivenStep:
    """Problem with one given number changed by a step, and the unknowns that then fit.

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
) -> dict[str, GivenStep]:
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
    dict of str to GivenStep
        By the names of `GivenErrors`, of those above zero that are not fitted.
    """
    journal = problem.orbits.journal
    units = {"clearance": journal.clearance, "load": 1.0, "load_line": journal.radius}
    here = least.misses(minimum.value[np.newaxis])[0]
    changes = {}
    for name in (*units, "tilt"):
        std = getattr(given, name)
        if not std or name in least.unknowns.names:
            continue
        unknowns = least.unknowns
        if name == "tilt":
            moved, steps = _tilted(problem, unknowns.by_name(minimum.value[np.newaxis]), std)
        else:
            moved, steps = _moved(problem, name), std / (_STEP * units[name])
        if name == "load_line":
            unknowns = replace(unknowns, fixed={**unknowns.fixed, name: _STEP})
        (films,) = moved.predict(minimum.value[np.newaxis], unknowns)

        # the films are measured, and the displacements follow with the clearance
        wider = moved.orbits.journal.clearance - journal.clearance
        widening = problem.measured.widening[problem.frames.measured]
        off = least.observed.whiten(least.observed.value + wider * widening - films) - here
        changes[name] = GivenStep(moved, steps, minimum.value + _first_order(least, minimum, off))
    return changes


def share_of_fitted(least: LeastSquares, minimum: Minimum) -> Mapping[str, Array]:
    """Contribution of the prior widths of fitted numbers to the standard deviations of a fit.

    Parameters
    ----------
    least : LeastSquares
    minimum : Minimum
        Where it ended.

    Returns
    -------
    dict of str to array
        By the names of `FITTED` that are known beforehand, (unknown,); that of a number itself is
        zero.
    """
    unknowns, shares = least.unknowns, {}
    for k, name in enumerate(unknowns.names):
        std = unknowns.expected_std[k]
        if name in FITTED and np.isfinite(std):
            shares[name] = np.abs(_first_order(least, minimum, std * minimum.jacobian[:, k]))
            shares[name][k] = 0.0
    return shares


def _moved(problem: Problem, name: str) -> Problem:
    """A problem with the clearance or the load larger by a step."""
    orbits, more = problem.orbits, 1 + _STEP
    if name == "clearance":
        orbits = replace(orbits, journal=orbits.journal.with_clearance(more))
    elif name == "load":
        orbits = replace(orbits, motion=replace(orbits.motion, load=more * orbits.motion.load))
        if isinstance(orbits, HeldOrbits) and orbits.lead is not None:
            orbits = replace(orbits, lead=replace(orbits.lead, load=more * orbits.lead.load))
    return replace(problem, orbits=orbits)


def _tilted(problem: Problem, unknowns: dict[str, Array], tilt: float) -> tuple[Problem, float]:
    """A problem with a tilted pin, and the rms of what it changes over this.

    Slices along the axis are squeezed as parallel films of their own thickness: a film of 6 um is
    7.6 mm wide. A tilt is thus a thicker oil, by as much as the film is thin. The cavities of a
    held pin, and the film on a bore with a shape, are those of the tilted film itself.
    """
    orbits, journal = problem.orbits, problem.orbits.journal
    half = tilt * journal.length / 2
    if not journal.long and (isinstance(orbits, HeldOrbits) or journal.axial_shape is not None):
        shape = np.zeros(2) if journal.axial_shape is None else np.asarray(journal.axial_shape)
        bent = replace(journal, axial_shape=shape + np.linspace(-half, half, shape.size))
        return replace(problem, orbits=replace(orbits, journal=bent)), _SQUARE
    unknowns.pop("load_line", None)
    (orbit,) = orbits.follow(unknowns)
    film = journal.clearance - np.hypot(*orbit.T)
    place, weight = np.polynomial.legendre.leggauss(_SLICES)
    slices = (film + half * place[:, np.newaxis]) / journal.clearance
    squeeze = FullFilm.of(journal)
    parallel = squeeze.damping(film / journal.clearance)[:, 0]
    thicker = weight @ squeeze.damping(slices)[..., 0] / 2 / parallel
    motion, lead = thickened(orbits.motion, getattr(orbits, "lead", None), thicker)
    changed: dict[str, Any] = {"motion": motion} | ({} if lead is None else {"lead": lead})
    return replace(problem, orbits=replace(orbits, **changed)), _SQUARE


def _first_order(least: LeastSquares, minimum: Minimum, off: Array) -> Array:
    """Change of the unknowns with a change of the whitened misses, to first order."""
    if not np.isfinite(off).all():
        return np.full(minimum.value.size, np.nan)
    jacobian = np.nan_to_num(minimum.jacobian)
    matrix, right = least.system(off, jacobian, minimum.value, minimum.inflation)
    right[off.size :] = 0.0  # what was expected stays
    found = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    return np.asarray(found[: minimum.value.size])
