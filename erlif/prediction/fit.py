"""Fit of the parameters of a joint to the measured positions of its pin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ModelError
from erlif.core.notes import Note, remark, warn
from erlif.models.reynolds import Journal
from erlif.prediction.given import FITTED, GivenErrors, GivenStep, follow_changes, share_of_fitted
from erlif.prediction.least_squares import (
    CONVERGED,
    ONE_SIDED,
    TARGETS,
    TWO_SIDED,
    LeastSquares,
    Minimum,
    Unknowns,
    interval,
)
from erlif.prediction.measured import MeasuredMotion
from erlif.prediction.motion import FrameMotion
from erlif.prediction.orbits import (
    ATMOSPHERE,
    CELLS,
    SHAPED_CELLS,
    FreeOrbits,
    HeldOrbits,
    Orbits,
    lead_of,
)
from erlif.prediction.problem import FrameSteps, Problem
from erlif.trend import VogelLaw

# Measured positions below which nothing is fitted.
FEWEST_TRIGGERS = 4

# Standard deviation of the place of the load line where only the image is known. [m]
LOAD_LINE_STD = 5e-3

# Factor of the stated random errors that the residuals require, from which it is reported.
MISFIT = 1.5

_HELD_CONVERGED = 0.01  # of chi-square; cells that change to cavities make it jump by as much
_HELD_NEAR = 1.0  # before its orbits are corrected
_FEW = (-2.1, 2.1)  # standard deviations at which slow profiles are computed
_ROUNDS = 3  # corrections of the orbits of a held pin
_FIRST_STEPS = 1000  # of the motion, of which a long run is fitted first
_FEWEST_FIRST = 50  # triggers in them
_FIRST_CONVERGED = 0.1  # of chi-square, in that fit
_MOST_TURNS = 8  # of the lead of a held pin
_LINES = (-2e-3, 2e-3)  # of the load line about the assumed one, from which it is searched [m]
_FAR = 3.0  # standard deviations of a load line from the assumed place, beyond which it is tested
_NEAR = 0.2  # change of a correction over the random errors, below which it is the last

_NUISANCES = "load_line", "drift"  # of which no profile is computed

_POSITIVE = "Pa s", "s"  # units of quantities that have no sign

_Column = TypeVar("_Column", float, Array)

# How a pin may be held.
SIDEWAYS = ("free", "guided", "spring")


@dataclass(frozen=True)
class Estimate:
    """A fitted quantity.

    Attributes
    ----------
    value : float
        Its value at the least squares.
    std : float
        Standard deviation in the linear approximation, errors shared by all triggers and those of
        given numbers included.
    low : float
        Lower end of the 95 % interval of the profile likelihood; zero or infinite without one.
        Where only one end exists, it is the 95 % limit of one side.
    high : float
        Upper end.
    unit : str
        Unit of all numbers.
    parts : mapping of str to float
        Standard deviations of which `std` is the root of the sum of squares: fit, and the names of
        `GivenErrors`. Empty where only the fit has one.
    """

    value: float
    std: float
    low: float
    high: float
    unit: str
    parts: Mapping[str, float] = field(default_factory=dict)

    @property
    def determined(self) -> bool:
        """Whether both ends of the interval exist."""
        return bool(np.isfinite(self.low) and np.isfinite(self.high) and self.low != 0)

    def __str__(self) -> str:
        """Value and standard deviation, with two digits of this."""
        size = np.log10(self.std) if 0 < self.std < np.inf else 0.0
        digits = max(1 - int(np.floor(size)), 0)
        unit = "" if self.unit == "1" else self.unit
        return f"{self.value:.{digits}f} ± {self.std:.{digits}f} {unit}".rstrip()

    def times(self, factor: float, unit: str) -> Estimate:
        """Multiply the estimate by a factor and give it the unit of the product."""
        low, high = sorted((float(factor * self.low), float(factor * self.high)))
        parts = {name: abs(factor) * std for name, std in self.parts.items()}
        return Estimate(factor * self.value, abs(factor) * self.std, low, high, unit, parts)

    def widened(
        self, parts: Mapping[str, float], within: Mapping[str, float] | None = None
    ) -> Estimate:
        """The estimate with standard deviations of given numbers besides; quantities above zero
        stay there. Those of `within` are part of it already.
        """
        within = within or {}
        if not parts and not within:
            return self
        own = float(np.sqrt(max(self.std**2 - sum(one**2 for one in within.values()), 0.0)))
        more = float(np.hypot.reduce(list(parts.values())))
        low = self.value - float(np.hypot(self.value - self.low, 1.96 * more))
        high = self.value + float(np.hypot(self.high - self.value, 1.96 * more))
        return Estimate(
            self.value,
            float(np.hypot(self.std, more)),
            max(low, 0.0) if self.unit in _POSITIVE and self.low >= 0 else low,
            high,
            self.unit,
            {"fit": own, **within, **parts},
        )


@dataclass(frozen=True)
class MotionFit:
    """A model of the joint, fitted to measured positions.

    Attributes
    ----------
    sideways : str
        "free", "guided" or "spring".
    estimates : mapping of str to Estimate
        viscosity [Pa s], squeeze_time K/W [s], start_film [m], and what else was fitted.
    names : tuple of str
        Unknowns of the search.
    minimum : Minimum
        The least squares: unknowns in the order of `names`, covariance, shared errors, residuals.
    predicted : Array
        Displacement of the pin along the load and sideways, in the coordinates of the measured
        ones, (trigger, 2). [m]
    frames : Array
        The same at every frame, (frame, 2). [m]
    notes : tuple of Note
        What limits the result.
    """

    sideways: str
    estimates: Mapping[str, Estimate]
    names: tuple[str, ...]
    minimum: Minimum
    predicted: Array
    frames: Array
    notes: tuple[Note, ...] = ()

    @property
    def inflation(self) -> float:
        """Factor of the stated random errors that the residuals require, at least 1.

        The standard deviations contain it.
        """
        return self.minimum.inflation


def fit_motion(
    measured: MeasuredMotion,
    journal: Journal,
    motion: FrameMotion,
    *,
    trigger: npt.NDArray[np.integer[Any]] | None = None,
    sideways: str = "free",
    fitted: Sequence[str] = ("viscosity",),
    load_line_std: float = LOAD_LINE_STD,
    given: GivenErrors | None = None,
    profiles: bool = True,
) -> MotionFit:
    """Fit viscosity, start film and mount of a joint to the measured positions of its pin.

    On an elastic liner the minima of the deflected wall are fitted: positions are refused.

    Weighted least squares on the transient film. Errors that all triggers share and the place of
    the load line are nuisance parameters: they are fitted with the rest, each within its own
    standard deviation. Only K/W, squeeze constant over load, is measured; the viscosity follows
    with the given radii, length and load, whose errors `given` states. The load line of a guided
    pin leaves nearly the same film as its place at rest: a given one is not fitted.

    Parameters
    ----------
    measured : MeasuredMotion
    journal : Journal
        The joint, with the expected viscosity.
    motion : FrameMotion
        Rotation of the bushing and load from the first frame on. The film of a held pin is led in
        by a turn of the crank, in which its cavities form: by the first one of the motion, else by
        the lead of the linkage. Without either it is full at the first frame.
    trigger : array, (frame,), optional
        Trigger of each frame, a negative number for one that was not measured. By default each
        frame is a trigger.
    sideways : str
        "free", "guided" or "spring".
    fitted : sequence of str
        "viscosity", and for a held pin "cavitation_pressure". The start of the pin is always
        fitted, and the stiffness and rest of a spring.
    load_line_std : float
        Standard deviation of the place of the load line along sliding; 0 where it is known. [m]
    given : GivenErrors, optional
        Errors of what is taken for given; by default none.
    profiles : bool
        Whether intervals come from the profile of the likelihood, or from standard deviations.

    Returns
    -------
    MotionFit

    Raises
    ------
    ConfigError
        Too few positions, positions on an elastic liner, an unknown name.
    ModelError
        No film carries the load, or no minimum was found.

    Examples
    --------
    A joint at rest under its load, measured to 10 nm, whose oil is 25 % thicker than expected:

    >>> from erlif.models.reynolds import Motion
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
    >>> time = np.linspace(0.0, 4.0, 41)
    >>> ratio = 3.0 + time * 222.4 / (1.25 * joint.squeeze_constant)
    >>> place = np.stack([230e-6 * ratio / np.hypot(1, ratio), 0 * time], axis=1)
    >>> measured = MeasuredMotion(place, 1e-16 * np.eye(2) * np.ones((41, 1, 1)),
    ...                           np.zeros((41, 2, 0)))
    >>> still = FrameMotion(Motion(time, 0 * time, load=222.4), np.arange(41), 0 * time, 0.12)
    >>> found = fit_motion(measured, joint, still)
    >>> round(found.estimates["viscosity"].value, 4)
    0.15
    """
    frames = FrameSteps.of(measured, motion.steps, trigger)
    _refuse_unfit(measured, frames, sideways, fitted)
    if journal.foundation is not None and measured.is_position:
        raise ConfigError(
            "Expected minima for a fit on an elastic liner, whose yield is part of the positions. "
            "Take measured_minima."
        )
    orbits: Orbits = FreeOrbits(journal, motion.motion)
    if sideways != "free" or journal.foundation is not None:
        lead = lead_of(motion.motion, motion.crank)
        if lead is None and motion.lead is not None:
            # the last step of the lead is the first one of the motion
            before = motion.lead.at(slice(-1))
            since = motion.motion.time[0] - motion.lead.time[-1]
            lead = replace(before, time=since + before.time)
        cells = CELLS if journal.axial_shape is None else SHAPED_CELLS
        orbits = HeldOrbits(journal, motion.motion, sideways, cells, lead=lead)
    problem = Problem(orbits, frames, measured, sideways)
    given = given or GivenErrors()
    known = {name: getattr(given, name) for name in FITTED}
    if sideways != "guided" or given.load_line is None:
        known["load_line"] = load_line_std
    return _fit_held(problem, problem.unknowns(fitted, known), given, profiles)


def film_temperature(viscosity: Estimate, law: VogelLaw) -> Estimate:
    """The temperature at which the oil has a fitted viscosity, by Vogel's law eta = a e^(b/(T-c)).

    Parameters
    ----------
    viscosity : Estimate
        As fitted. [Pa s]
    law : VogelLaw
        Of the oil; its own error is not included.

    Returns
    -------
    Estimate
        [degC]

    Examples
    --------
    A viscosity of e times `a` belongs to the temperature c + b:

    >>> found = film_temperature(
    ...     Estimate(0.1 * np.e, 0.001, 0.26, 0.28, "Pa s"), VogelLaw(a=0.1, b=20.0, c=5.0))
    >>> round(found.value, 6), found.low < found.value < found.high
    (25.0, True)
    """
    logarithm = float(np.log(viscosity.value / law.a))
    low, high = (
        law.c + law.b / float(np.log(one / law.a)) if law.a < one < np.inf else edge
        for one, edge in ((viscosity.high, -np.inf), (viscosity.low, np.inf))
    )
    slope = abs(law.b / logarithm**2 / viscosity.value)
    parts = {name: slope * std for name, std in viscosity.parts.items()}
    value = law.c + law.b / logarithm
    return Estimate(value, slope * viscosity.std, low, high, "degree_Celsius", parts)


def _fit_held(
    problem: Problem, unknowns: Unknowns, given: GivenErrors, profiles: bool
) -> MotionFit:
    """Fit the unknowns; correct the orbits of a held pin at the solution.

    Line and place at rest of a guided pin leave nearly the same film: its search begins with the
    line at the assumed place, and is repeated with the line from there and from either side.
    """
    whole, free = unknowns, isinstance(problem.orbits, FreeOrbits)
    lined = problem.sideways == "guided" and "load_line" in whole.names
    if lined:
        unknowns = whole.without("load_line", whole.start)

    # a held pin is searched from coarse cells first, to a rough tolerance
    least = problem.pose(unknowns, CONVERGED if free else _HELD_NEAR)
    minimum = (None if free else _fit_first_steps(problem, unknowns)) or least.solve()
    smallest = float(np.sqrt(np.diagonal(least.observed.random_cov, axis1=1, axis2=2).min()))
    orbits = problem.orbits
    for _ in range(_ROUNDS if isinstance(orbits, HeldOrbits) else 0):
        assert isinstance(orbits, HeldOrbits)
        columns = _of_orbit(unknowns.one_by_name(minimum.value))

        # the lead is repeated until the film no longer depends on how its cavities began
        start = minimum.value.copy()
        for _ in range(_MOST_TURNS - orbits.turns):
            longer, film, memory = orbits.lengthened(columns)
            if memory < _NEAR * smallest:
                break
            orbits, columns["start_film"] = longer, film
            start[unknowns.names.index("start_film")] = film

        before = 0.0 if orbits.shift is None else orbits.shift
        orbits = orbits.corrected(columns)
        change = 0.0 if orbits.shift is None else float(np.abs(orbits.shift - before).max())

        # the same search with the corrected model, from where it ended
        problem = replace(problem, orbits=orbits)
        unknowns = replace(unknowns, start=start)
        least = problem.pose(unknowns, _HELD_CONVERGED)
        minimum = least.solve()
        if change < _NEAR * smallest * minimum.inflation:
            break
    if lined:
        least, minimum = _free_load_line(problem, whole, minimum)
    return _motion_fit(problem, least, minimum, given, profiles)


def _free_load_line(
    problem: Problem, unknowns: Unknowns, fixed: Minimum
) -> tuple[LeastSquares, Minimum]:
    """The minimum of a guided pin whose load line is unknown, from that with the line as assumed.

    The error of the line is that of the likelihood: by what this is lower at the assumed place, the
    line is known, and no better.
    """
    k, rest = (unknowns.names.index(name) for name in ("load_line", "rest"))
    place = problem.measured.value[problem.frames.measured, 0]
    found = []
    for line in (0.0, *_LINES):
        start = np.insert(fixed.value, k, line / problem.orbits.journal.radius)
        start[rest] -= start[k] * place.mean() / problem.orbits.journal.clearance
        least = problem.pose(replace(unknowns, start=start), _HELD_CONVERGED)
        try:
            found.append(least.solve())
        except ModelError:
            if not found:
                raise
    minimum = max(found, key=lambda one: one.log_likelihood)
    line, variance = minimum.value[k], minimum.covariance[k, k]
    along = minimum.covariance[:, k] / variance
    if abs(line) <= _FAR * np.sqrt(variance):
        return least, minimum
    gain = max(minimum.log_likelihood - fixed.log_likelihood, 1e-12)
    doubt = min(line**2 / (2 * gain), unknowns.expected_std[k] ** 2) - variance
    more = max(doubt, 0.0) * np.outer(along, along)
    return least, replace(minimum, covariance=minimum.covariance + more)


def _of_orbit(columns: dict[str, _Column]) -> dict[str, _Column]:
    """The unknowns of an orbit: all but the place of the load line in the image."""
    return {name: column for name, column in columns.items() if name != "load_line"}


def _fit_first_steps(problem: Problem, unknowns: Unknowns) -> Minimum | None:
    """Fit the first steps of a long run as a starting point; None for other runs."""
    orbits, frames = problem.orbits, problem.frames
    inside = frames.steps < _FIRST_STEPS
    whole = np.setdiff1d(frames.measured, frames.trigger[~inside])
    if not isinstance(orbits, HeldOrbits) or inside.all() or whole.size < _FEWEST_FIRST:
        return None
    orbits = replace(orbits, motion=orbits.motion.at(slice(_FIRST_STEPS)))
    kept = FrameSteps(frames.steps[inside], frames.trigger[inside], whole, frames.count)

    minimum = None
    for corrected in (False, True):
        if minimum is not None and corrected:
            orbits = orbits.corrected(_of_orbit(unknowns.one_by_name(minimum.value)))
        brief = replace(problem, orbits=orbits, frames=kept)
        try:
            minimum = brief.pose(unknowns, _FIRST_CONVERGED).solve()
        except ModelError:
            return minimum
        unknowns = replace(unknowns, start=minimum.value)
    return minimum


def _refuse_unfit(
    measured: MeasuredMotion, frames: FrameSteps, sideways: str, fitted: Sequence[str]
) -> None:
    """Refuse what cannot be fitted."""
    if sideways not in SIDEWAYS:
        raise ConfigError(
            f"Expected a pin that is {', '.join(SIDEWAYS[:-1])} or {SIDEWAYS[-1]}, got "
            f"{sideways!r}. Choose one."
        )
    unknown = [name for name in fitted if name not in ("viscosity", "cavitation_pressure")]
    if unknown:
        raise ConfigError(
            f"Expected viscosity or cavitation_pressure to fit, got {unknown[0]!r}; start, rest "
            "and stiffness are always fitted where the pin has them."
        )
    if frames.measured.size < FEWEST_TRIGGERS:
        raise ConfigError(
            f"Expected {FEWEST_TRIGGERS} or more measured positions for a fit of the film, got "
            f"{frames.measured.size} of {len(measured.value)} triggers. Widen roi in [thickness], "
            "or record more triggers."
        )
    if sideways == "spring" and not measured.is_position:
        raise ConfigError(
            "Expected positions of the pin for the fit of a spring; minima do not contain the "
            'sideways displacement. Choose "free" or "guided".'
        )


def _motion_fit(
    problem: Problem,
    least: LeastSquares,
    minimum: Minimum,
    given: GivenErrors,
    profiles: bool,
) -> MotionFit:
    """The minimum in physical quantities, with intervals and notes."""
    names = least.unknowns.names
    std = np.sqrt(np.diag(minimum.covariance))
    ends = [
        (value - 1.96 * one, value + 1.96 * one)
        for value, one in zip(minimum.value, std, strict=True)
    ]
    low, high = least.unknowns.low, least.unknowns.high
    if profiles:
        wanted = [k for k, name in enumerate(names) if name not in _NUISANCES]
        few = _FEW if isinstance(problem.orbits, HeldOrbits) else TARGETS
        for k, curve in zip(wanted, least.profiles(minimum, wanted, few), strict=True):
            ends[k] = interval(*curve, TWO_SIDED)
            if not np.isfinite(ends[k]).all():
                one_sided = interval(*curve, ONE_SIDED)
                ends[k] = (
                    -np.inf if np.isinf(ends[k][0]) else one_sided[0],
                    np.inf if np.isinf(ends[k][1]) else one_sided[1],
                )

    # an end at the bound of the search is none
    ends = [
        (a if a > low[k] else -np.inf, b if b < high[k] else np.inf)
        for k, (a, b) in enumerate(ends)
    ]
    estimates = _estimates(problem, least.unknowns, minimum.value, std, ends)
    within = {
        name: _estimates(problem, least.unknowns, minimum.value, share, ends)
        for name, share in share_of_fitted(least, minimum).items()
    }
    if isinstance(problem.orbits, HeldOrbits) and problem.orbits.lead is not None:
        for found in (estimates, *within.values()):
            found.pop("start_attitude", None)
            found.pop("start_film")
        estimates["start_film"] = _first_film(problem, least, minimum)
    changes = follow_changes(problem, least, minimum, given)
    estimates = _widened(estimates, least.unknowns, changes, within)
    frames = problem.frame_positions(minimum.value[np.newaxis], least.unknowns)[0]
    return MotionFit(
        sideways=problem.sideways,
        estimates=estimates,
        names=names,
        minimum=minimum,
        predicted=problem.frames.average(frames[np.newaxis])[0],
        frames=frames,
        notes=(
            *_limits_of_fit(estimates, minimum, known=given.cavitation_pressure > 0),
            *_note_rupture(problem, least, minimum),
        ),
    )


def _widened(
    estimates: Mapping[str, Estimate],
    unknowns: Unknowns,
    changes: Mapping[str, GivenStep],
    within: Mapping[str, Mapping[str, Estimate]],
) -> dict[str, Estimate]:
    """Widen the estimates by the errors of given numbers."""
    parts: dict[str, dict[str, float]] = {name: {} for name in estimates}
    for given, change in changes.items():
        still = np.zeros(change.value.size)
        ends = list(zip(change.value, change.value, strict=True))
        moved = _estimates(change.problem, unknowns, change.value, still, ends)
        # without a film of the changed number the error is not known
        known = np.isfinite(change.value).all()
        if known and isinstance(change.problem.orbits, HeldOrbits):
            film = _first_films(change.problem, unknowns, change.value[np.newaxis])
            moved["start_film"] = replace(moved["start_film"], value=float(film[0]))
        for name, estimate in estimates.items():
            std = abs(moved[name].value - estimate.value) * change.steps
            parts[name][given] = float(np.nan_to_num(std, nan=np.inf))
    return {
        name: one.widened(
            parts[name],
            {given: found[name].std for given, found in within.items() if name in found},
        )
        for name, one in estimates.items()
    }


def _first_film(problem: Problem, least: LeastSquares, minimum: Minimum) -> Estimate:
    """Estimate of the film at the first step of the motion, from the fitted start of the lead."""
    sets = least.neighbours(minimum.value)
    film = _first_films(problem, least.unknowns, sets)
    slope = (film[1:] - film[0]) / np.diag(sets[1:] - minimum.value)
    std = float(np.sqrt(slope @ minimum.covariance @ slope))
    value = float(film[0])
    return Estimate(value, std, value - 1.96 * std, value + 1.96 * std, "m")


def _first_films(problem: Problem, unknowns: Unknowns, sets: Array) -> Array:
    """Films of a held pin at the first step of the motion for sets of unknowns, (case,). [m]"""
    orbits, clearance = problem.orbits, problem.orbits.journal.least_clearance
    assert isinstance(orbits, HeldOrbits)
    shift = None if orbits.shift is None else orbits.shift[:3]
    brief = replace(orbits, motion=orbits.motion.at(slice(3)), shift=shift)
    orbit = brief.follow(_of_orbit(unknowns.by_name(sets)))
    return np.asarray(clearance - np.hypot(*orbit[:, 0].T))


def _estimates(
    problem: Problem,
    unknowns: Unknowns,
    value: Array,
    std: Array,
    ends: Sequence[tuple[float, float]],
) -> dict[str, Estimate]:
    """The unknowns of a search (unknown,) as quantities of the joint."""
    journal, motion = problem.orbits.journal, problem.orbits.motion
    units = {
        "start_attitude": (1.0, "rad"),
        "rest": (journal.clearance, "m"),
        "load_line": (journal.radius, "m"),
        "cavitation_pressure": (-ATMOSPHERE, "Pa"),
        "drift": (1.0, "1"),
    }
    found: dict[str, Estimate] = {}
    numbers = zip(unknowns.names, value.tolist(), std.tolist(), ends, strict=True)
    for name, one, error, (low, high) in numbers:
        if name == "fluidity":
            safe = max(one, 1e-9)
            eta = journal.viscosity / safe
            low_eta = journal.viscosity / high if np.isfinite(high) else 0.0
            high_eta = journal.viscosity / low if low > 0 else np.inf
            time = journal.squeeze_constant / journal.viscosity / float(motion.load.mean())
            viscosity = Estimate(eta, eta * error / safe, low_eta, high_eta, "Pa s")
            found |= {"viscosity": viscosity, "squeeze_time": viscosity.times(time, "s")}
        elif name == "start_film":
            film, thin, thick = (float(np.exp(each)) for each in (one, low, high))
            found[name] = Estimate(film, film * error, thin, thick, "m")
        elif name == "stiffness":
            size = float(10**one)
            error = size * error * float(np.log(10))
            found[name] = Estimate(size, error, float(10**low), float(10**high), "N m-1")
        else:
            found[name] = Estimate(one, error, low, high, "").times(*units[name])
    return found


def _limits_of_fit(
    estimates: Mapping[str, Estimate], minimum: Minimum, *, known: bool
) -> list[Note]:
    """Notes on the limits of the result; `known`: the cavitation pressure has a given width."""
    notes = []
    viscosity = estimates.get("viscosity")
    if viscosity is not None and not viscosity.determined:
        text = (
            "The film does not change enough to determine the viscosity: it is at least "
            f"{viscosity.low:.3g} Pa s (95 %). Record more cycles, or from the moment of loading "
            "on."
        )
        notes.append(warn("fit", text))
    if {"viscosity", "cavitation_pressure"} <= set(estimates) and not known:
        text = (
            "Viscosity and cavitation pressure change the film in nearly the same way: 0.1 % of "
            "the film is up to 3 % of both, which the standard deviations do not contain. State a "
            "width of the cavitation pressure, or fix one of the two."
        )
        notes.append(warn("fit", text))
    if minimum.inflation > MISFIT:
        text = (
            f"The residuals are {minimum.inflation:.3g} times the stated random errors; the "
            "standard deviations contain this factor."
        )
        notes.append(warn("fit", text))
    return notes


def _note_rupture(problem: Problem, least: LeastSquares, minimum: Minimum) -> list[Note]:
    """Note that the full film of a free pin would rupture at the cavitation pressure."""
    orbits = problem.orbits
    if not isinstance(orbits, FreeOrbits):
        return []
    (orbit,) = orbits.follow(least.unknowns.by_name(minimum.value[np.newaxis]))
    lowest, rupture = orbits.lowest_pressure(orbit), orbits.journal.cavitation_pressure
    if not lowest < rupture:
        return []
    text = (
        f"The film of the free pin is taken as full; its pressure falls to {lowest * 1e-3:.3g} "
        f"kPa, below the cavitation pressure of {rupture * 1e-3:.3g} kPa. Compare with "
        "solve_journal, which follows the cavities."
    )
    return [remark("fit", text)]
