"""Comparison of physical models of the film in the joint by their likelihood."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, ModelError
from erlif.core.progress import Progress, silent
from erlif.models.reynolds import Journal, Motion
from erlif.prediction.fit import FEWEST_TRIGGERS, LOAD_LINE_STD, Estimate, MotionFit, fit_motion
from erlif.prediction.given import GivenErrors
from erlif.prediction.least_squares import (
    LeastSquares,
    Minimum,
    Predict,
    Unknowns,
)
from erlif.prediction.measured import MeasuredMotion, measured_minima
from erlif.prediction.motion import FrameMotion
from erlif.prediction.orbits import FreeOrbits
from erlif.prediction.problem import FrameSteps, Problem

# The steady film of the formula that holds in the regime of each trigger.
REGIME_MAP = "the steady film of the regime map"

# Any power of speed over load, alone and above an offset: laws of no theory.
POWER = ("a power of speed over load", "a power of speed over load above an offset")

# A long joint under its load without rotation, eps / sqrt(1 - eps^2) linear in time.
SQUEEZE = "squeeze in closed form"

# Transient films, by how the pin is held.
HELD = {
    "free": "a pin that is free sideways",
    "guided": "a guided pin",
    "spring": "a pin on a sideways spring",
}

# A pin at rest, which no theory of a moving film needs.
CONSTANT = "a constant gap"

# Factor of the stated random errors up to which a model describes a film. Films that follow a
# candidate leave up to 1.1, photographed ones up to 1.7 (docs/theory/which.md).
DESCRIBED = 3.0

# The factor from which a viscosity that changes within the run is looked for, and to which; the
# number of values from which so small a factor is no chance; and the width of that change.
DRIFTING, _LOST, _MANY, _DRIFT_STD = 1.2, 10.0, 100, 0.3

# Standard deviation of the viscosity of the oil in the joint where none is stated, relative.
OIL_STD = 0.3

_CARRIES = {
    SQUEEZE: "Squeeze carries the film, without a sign of rotation",
    HELD["free"]: "Squeeze carries the film of a pin that is free sideways",
    HELD["guided"]: "The swing carries the film of a guided pin: cavities rectify its wedge",
    HELD["spring"]: "Squeeze and swing carry the film of a pin on a sideways spring",
    REGIME_MAP: "The film follows the steady formula of the regime map",
}

# Differences of BIC below which the evidence has a name. Kass and Raftery (1995).
_STRENGTHS = ((2.0, "undecided"), (6.0, "weak"), (10.0, "strong"), (np.inf, "very strong"))

# Difference up to which a constant gap, which needs no cause, is not left for another model.
_WEAK = 6.0

# Estimates of a transient film that belong to the verdict.
_SHOWN = ("viscosity", "drift")

# Lowest over highest speed over load from which a film has one alone.
_ONE_SPEED = 0.99

_WIDER = "Record over a wider range of speeds or loads."

# First-order correlations of residuals, of which the likeliest is taken.
_CORRELATIONS = np.linspace(0.0, 0.99, 100)


@dataclass(frozen=True)
class SteadyFilm:
    """Film of a steady formula, to be compared with a measured one.

    Attributes
    ----------
    name : str
        What the formula is called.
    film : array, (trigger,)
        Its film. [m]
    power : float
        Of the viscosity in the film. [1]
    error : float
        Relative standard deviation of the formula, which the viscosity takes up; infinite outside
        its regime, where the shape alone is compared. [1]
    """

    name: str
    film: Array
    power: float
    error: float = 0.0


@dataclass(frozen=True)
class FilmModel:
    """One model of the film, fitted.

    Attributes
    ----------
    name : str
        What carries the film.
    bic : float
        Bayesian information criterion above that of the best model. [1]
    unknowns : int
        Numbers that were fitted, the load line among them.
    inflation : float
        Factor of the stated random errors that the residuals require.
    residual : float
        Root mean square of what remains of the measured values. [m]
    estimates : mapping of str to Estimate
        What the model takes to agree: viscosity [Pa s]; factor [1] of a steady formula, power [1]
        and offset [m] of a power law. The residuals' correlation is part of the standard
        deviations.
    """

    name: str
    bic: float
    unknowns: int
    inflation: float
    residual: float
    estimates: Mapping[str, Estimate] = field(default_factory=dict)

    @property
    def describes(self) -> bool:
        """Whether the residuals are within a few of the stated random errors."""
        return self.inflation <= DESCRIBED


@dataclass(frozen=True)
class ModelComparison:
    """Models of the film in the order of their likelihood.

    Attributes
    ----------
    candidates : tuple of FilmModel
        The best first.
    verdict : str
        Which physics carries the film, how sure that is, and with which viscosity: the first
        sentence; what limits this follows.
    fit : MotionFit or None
        The best transient model.
    carrier : str or None
        Name of the model that carries the film; None where no model describes it with the viscosity
        of the oil, or it is constant within its errors.
    not_fitted : mapping of str to str
        Models that could not be fitted, and why.
    """

    candidates: tuple[FilmModel, ...]
    verdict: str
    fit: MotionFit | None
    carrier: str | None = None
    not_fitted: Mapping[str, str] = field(default_factory=dict)


def _weigh(
    name: str, problem: Problem, found: Minimum, predicted: Array, shown: Mapping[str, Estimate]
) -> FilmModel:
    """The record of a fitted model from its prediction of the measured triggers, with the whole of
    its criterion.
    """
    value = problem.measured.value[problem.frames.measured]
    gained, correlation = _correlate(found.residual.reshape(value.shape), found.inflation)
    likely = found.log_likelihood + gained

    # of neighbours that depart together fewer are independent
    wider = float(np.sqrt((1 + correlation) / (1 - correlation)).max())
    return FilmModel(
        name,
        float(found.value.size * np.log(value.size) - 2 * likely),
        found.value.size,
        found.inflation,
        float(np.sqrt(np.mean((value - predicted) ** 2))),
        {key: replace(one, std=wider * one.std) for key, one in shown.items()},
    )


def _correlate(residual: Array, inflation: float) -> tuple[float, Array]:
    """Log-likelihood that residuals gain by a first-order correlation, and this, (axis,).

    Each axis (trigger, axis) has its own correlation and its own factor of the stated errors, of
    at least 1; without correlation all have the same factor, `inflation`.
    """
    count = len(residual)
    square = (residual**2).sum(axis=0)
    beside = (residual[1:] * residual[:-1]).sum(axis=0)
    inner = (residual[1:-1] ** 2).sum(axis=0)
    rho = _CORRELATIONS[:, np.newaxis]
    left = (square - 2 * rho * beside + rho**2 * inner) / (1 - rho**2)
    variance = np.maximum(left / count, 1.0)
    likely = -0.5 * (count * np.log(variance) + (count - 1) * np.log(1 - rho**2) + left / variance)
    plain = -0.5 * (2 * residual.size * np.log(inflation) + square.sum() / inflation**2)
    return float(likely.max(axis=0).sum() - plain), _CORRELATIONS[likely.argmax(axis=0)]


def compare_models(
    measured: MeasuredMotion,
    journal: Journal,
    motion: FrameMotion,
    *,
    trigger: npt.NDArray[np.integer[Any]] | None = None,
    steady: Sequence[SteadyFilm] = (),
    drive: Array | None = None,
    viscosity_std: float | None = None,
    sideways: Sequence[str] = ("free", "guided"),
    load_line_std: float = LOAD_LINE_STD,
    given: GivenErrors | None = None,
    progress: Progress = silent,
) -> ModelComparison:
    """Compare what may carry the film: steady wedge, squeeze, and the transient film.

    The models are not special cases of each other, so that a likelihood ratio has no known
    distribution. They are compared by the Bayesian information criterion (Schwarz 1978),
    p ln n - 2 ln L. Every model may inflate the random errors by what its residuals require, and
    each axis of its residuals has a first-order correlation from trigger to trigger, so that a
    misfit costs as much as the data warrant and a wandering film is no trend. The viscosity is free
    in all models: a steady formula may have any factor. What carries the film is named where the
    best model describes it, its viscosity is that of the oil within two standard deviations, and a
    constant gap is worse by more than 6.

    Where many residuals of a free pin exceed their errors by more than 1.2, a viscosity that
    changes evenly with time is fitted as well.

    Parameters
    ----------
    measured, journal, motion, trigger, load_line_std, given
        As for `fit_motion`.
    steady : sequence of SteadyFilm
        Films of steady formulas.
    drive : array, (trigger,), optional
        Speed over load, in any unit: with it two laws in powers of its size are fitted.
    viscosity_std : float, optional
        Standard deviation of the viscosity of the journal; by default `OIL_STD` of it. [Pa s]
    sideways : sequence of str
        Transient films to compare: of "free", "guided" and "spring"; empty where no theory of a
        moving pin applies, squeeze included. With "any guided" the verdict
        states where a guided pin is left to fit, as the sideways place does not change; it needs
        positions, and solves no film with cavities. So it does where a guided pin cannot be fitted.
    progress : callable
        Receives the name of the step, the number of models that are fitted, and of all models.

    Returns
    -------
    ModelComparison

    Raises
    ------
    ConfigError
        As `fit_motion`.

    Examples
    --------
    Squeeze without rotation, measured to 10 nm, beside a constant steady film:

    >>> from erlif.models.reynolds import Motion
    >>> joint = Journal(0.03336, 0.03359, length=0.237, viscosity=0.12, long=True)
    >>> time = np.linspace(0.0, 4.0, 41)
    >>> ratio = 3.0 + time * 222.4 / joint.squeeze_constant
    >>> noise = 1e-8 * np.random.default_rng(1).normal(size=(41, 2))
    >>> place = np.stack([230e-6 * ratio / np.hypot(1, ratio), 0 * time], axis=1) + noise
    >>> measured = MeasuredMotion(place, 1e-16 * np.eye(2) * np.ones((41, 1, 1)),
    ...                           np.zeros((41, 2, 0)))
    >>> still = FrameMotion(Motion(time, 0 * time, load=222.4), np.arange(41), 0 * time, 0.12)
    >>> steady = SteadyFilm("a steady film", np.full(41, 131e-6), power=1.0)
    >>> found = compare_models(measured, joint, still, steady=[steady], sideways=["free"])
    >>> found.candidates[-1].name, found.candidates[-1].bic > 10
    ('a steady film', True)
    """
    frames = FrameSteps.of(measured, motion.steps, trigger)
    problem = Problem(FreeOrbits(journal, motion.motion), frames, measured, "free")
    fitted: list[FilmModel] = []
    fits: dict[str, MotionFit] = {}
    failures: dict[str, str] = {}
    transient = [one for one in sideways if one != "any guided"]
    total = len(transient) + 2 + len(steady) + (0 if drive is None else len(POWER))

    # a model that cannot carry the load is left out, unless none can
    for done, held in enumerate(transient):
        progress("fit", done, total)
        fit_held = partial(
            fit_motion,
            measured,
            journal,
            motion,
            trigger=trigger,
            sideways=held,
            load_line_std=load_line_std,
            profiles=False,
        )
        try:
            fit = fit_held(given=given)
            near = held == "free" and "drift" not in fit.names and fit.inflation < _LOST
            if near and _misses(fit.inflation, problem):
                drifting = fit_held(given=replace(given or GivenErrors(), drift=_DRIFT_STD))
                if drifting.minimum.log_likelihood > fit.minimum.log_likelihood + _WEAK:
                    fit = drifting
        except ModelError as error:
            failures[HELD[held]] = str(error)
            continue
        fits[HELD[held]] = fit
        predicted = fit.predicted[frames.measured]
        if not measured.is_position:
            predicted = np.hypot(*predicted.T)[:, np.newaxis]
        shown = {name: fit.estimates[name] for name in _SHOWN if name in fit.estimates}
        fitted.append(_weigh(HELD[held], problem, fit.minimum, predicted, shown))

    # closed forms take no time beside the transient films; that of squeeze is of a straight, smooth
    # and rigid bore
    forms = [(CONSTANT, _constant(problem))]
    straight = journal.axial_shape is None and journal.roughness is None
    if sideways and straight and journal.foundation is None:
        forms.append((SQUEEZE, _squeeze(problem)))
    for one in steady:
        law = _law(problem, one.film, viscous=one.power, known=one.error)
        forms.append((one.name, law))
    # a power needs more than one speed over load
    if drive is not None and np.nanmin(np.abs(drive)) < _ONE_SPEED * np.nanmax(np.abs(drive)):
        laws = ("power",), ("power", "offset")
        forms += [(name, _law(problem, drive, *law)) for name, law in zip(POWER, laws, strict=True)]
    for done, (name, closed) in enumerate(forms, len(transient)):
        progress("fit", done, total)
        # laws without a theory are for films that no theory describes to their errors; formulas of
        # a contact are too rough for the last percents of a film
        if name in POWER and (
            not _misses(min(one.inflation for one in fitted), problem)
            if sideways
            else any(one.describes for one in fitted if one.name != CONSTANT)
        ):
            continue
        least = LeastSquares(problem.observations(), closed.unknowns, closed.predict)
        try:
            minimum = least.solve()
        except ModelError as error:
            failures[name] = str(error)
            continue
        read = closed.read(minimum.value, np.sqrt(np.diag(minimum.covariance)))
        fitted.append(_weigh(name, problem, minimum, minimum.predicted, read))
    progress("fit", total, total)

    fitted.sort(key=lambda one: one.bic)
    candidates = tuple(replace(one, bic=one.bic - fitted[0].bic) for one in fitted)
    asked = "any guided" in sideways or HELD["guided"] in failures
    guided = measured.is_position and asked and _stays_on_line(problem)
    std = OIL_STD * journal.viscosity if viscosity_std is None else viscosity_std
    oil = Estimate(journal.viscosity, std, 0.0, np.inf, "Pa s")
    drifts = _misses(fitted[0].inflation, problem)
    carrier, verdict = _verdict(
        candidates, oil, guided=guided, drifts=drifts, pin=len(sideways) > 0
    )
    best = next((fits[one.name] for one in candidates if one.name in fits), None)
    return ModelComparison(candidates, verdict, best, carrier, failures)


def compare_films(
    film: Array, random_std: Array, std_shared: Array, *, viscosity: float, **options: Any
) -> ModelComparison:
    """Compare what may carry the film of a contact without a pin: formulas, power laws, nothing.

    Parameters
    ----------
    film, random_std : array, (trigger,)
        Minimum film, and its standard deviation by what is new at every trigger; NaN is left out.
        [m]
    std_shared : array, (trigger, source) or (trigger,)
        Standard deviations by errors that all triggers share. [m]
    viscosity : float
        Of the oil in the formulas. [Pa s]
    **options
        steady, drive and viscosity_std of `compare_models`.

    Returns
    -------
    ModelComparison

    Raises
    ------
    ConfigError
        As `compare_models`, and for fewer than four minima.

    Examples
    --------
    >>> speed = np.linspace(0.1, 1.0, 40)
    >>> noise, none = 1e-9 * np.random.default_rng(1).normal(size=40), np.zeros(40)
    >>> steady = SteadyFilm("a steady film", 1e-6 * speed**0.7, power=0.7)
    >>> film = 1.1 * steady.film + noise
    >>> found = compare_films(film, none + 1e-9, none, viscosity=0.1, steady=[steady])
    >>> found.verdict.partition(" (")[0], found.candidates[0].estimates["factor"].value.__round__(2)
    ('The film follows a steady film', 1.1)
    """
    known = int(np.isfinite(film).sum())
    if known < FEWEST_TRIGGERS:
        raise ConfigError(
            f"Expected {FEWEST_TRIGGERS} or more minimum films for a comparison, got {known} of "
            f"{len(film)} triggers. Record more triggers."
        )

    # films are distances to a wall of which only they are known
    wall = 2 * float(np.nanmax(film))
    measured = measured_minima(film, random_std, clearance=wall, std_shared=std_shared)
    time, still = np.arange(len(film), dtype=np.float64), np.zeros(len(film))
    motion = FrameMotion(Motion(time, still, load=1.0), np.arange(len(film)), still, viscosity)
    journal = Journal(wall, 2 * wall, length=wall, viscosity=viscosity, long=True)
    return compare_models(measured, journal, motion, sideways=(), **options)


def _misses(inflation: float, problem: Problem) -> bool:
    """Whether so many residuals exceed their errors by so much that something else happens."""
    return inflation > DRIFTING and problem.measured.value[problem.frames.measured].size >= _MANY


def _verdict(
    candidates: Sequence[FilmModel], oil: Estimate, *, guided: bool, drifts: bool, pin: bool
) -> tuple[str | None, str]:
    """Name the model that carries the film; the first sentence states it.

    `guided`: a guided pin is possible, and was not fitted; `drifts`: the residuals of the best
    model are too large for chance; `pin`: the film may be that of a pin that moves.
    """
    best, constant = candidates[0], next((one for one in candidates if one.name == CONSTANT), None)
    if constant is not None and constant.describes and constant.bic <= _WEAK:
        return None, (
            "The film is constant within its errors, which decides nothing about what carries it. "
            + ("Record from the moment of loading on, or more cycles." if pin else _WIDER)
        )
    if not best.describes:
        closest = min(candidates, key=lambda one: one.inflation)
        left = "; a guided pin is left to fit" if guided else ""
        cure = (
            "The pin stays on one line, as a guided one: fit it with erlif predict FILM --fit."
            if guided
            else "Check load, clearance and tilt of the joint, and the times of the frames."
            if pin
            else "Check load and temperature, and the times of the frames."
        )
        missed = "positions" if pin else "minima"
        return None, (
            f"No model fits: the best, {closest.name}, is off by {closest.inflation:.3g} times its "
            f"errors{left}. It misses the {missed} by {closest.residual * 1e6:.2g} um. {cure}"
        )

    # what is a case of another model is no rival of it
    rivals = [one for one in candidates[1:] if one.name not in POWER]
    strengths = [name for limit, name in _STRENGTHS if rivals and rivals[0].bic < limit]
    strength = f" ({strengths[0]})" if strengths else ""
    found = best.estimates
    carrier = None
    factor = f"{found['factor']} times it" if "factor" in found else ""
    times = f"{factor}, " if factor else ""
    if best.name in POWER:
        text = f"The film follows speed over load to the power {found['power']}{strength}"
        text += f", above {found['offset'].times(1e6, 'um')}" if "offset" in found else ""
        text += ", as no theory here has it"
    elif "viscosity" not in found:
        text = f"The shape is that of {best.name}{strength}, outside its regime: {factor}"
    elif abs(found["viscosity"].value - oil.value) <= 2 * np.hypot(found["viscosity"].std, oil.std):
        carrier = best.name
        carries = _CARRIES.get(best.name, f"The film follows {best.name}")
        text = f"{carries}{strength}: {times}{found['viscosity']}"
    else:
        text = (
            f"The shape is that of {best.name}, the viscosity not: {times}{found['viscosity']}, "
            f"[oil] {oil.value:.3g}"
        )
    text += "."
    if rivals:
        text += f" Second: {rivals[0].name}, BIC {rivals[0].bic:.3g} higher."
    if "drift" in found:
        text += f" The viscosity changes by {found['drift'].times(100, '%')} within the run."
    if drifts:
        text += f" Its residuals are {best.inflation:.3g} times their errors: viscosity or "
        text += "temperature may drift within the run" + (
            ", or the pin is guided." if guided else "."
        )
    return carrier, text


def _stays_on_line(problem: Problem) -> bool:
    """Whether a guided pin may be behind the positions: its sideways place is constant, but for the
    turn of the load line.
    """
    observed = problem.observations()
    load, side = observed.value.T
    left = side - np.polyval(np.polyfit(load, side, 1), load)
    return bool(np.sqrt(np.mean(left**2 / observed.random_cov[:, 1, 1])) <= DESCRIBED)


class _ClosedForm(NamedTuple):
    """A film in closed form: its unknowns, its course, and what these numbers mean."""

    unknowns: Unknowns
    predict: Predict
    read: Callable[[Array, Array], dict[str, Estimate]]  # unknowns and their std, (unknown,)


def _plain_unknowns(start: Mapping[str, float], *positive: str) -> Unknowns:
    """Unknowns of a closed form without prior; those that are `positive` are above zero."""
    ones = np.ones(len(start))
    return Unknowns(
        names=tuple(start),
        start=np.array(list(start.values())),
        step=1e-4 * ones,
        low=np.array([0.0 if name in positive else -np.inf for name in start]),
        high=np.inf * ones,
        expected=0 * ones,
        expected_std=np.inf * ones,
    )


def _pointed(problem: Problem, distance: Array, direction: Array) -> Array:
    """Resolve distances in one direction into displacements, (case, trigger, axis)."""
    if not problem.measured.is_position:
        return distance[..., np.newaxis]
    angle = direction[:, np.newaxis]
    return np.stack([distance * np.cos(angle), distance * np.sin(angle)], axis=-1)


def _distances(problem: Problem) -> tuple[Array, dict[str, float]]:
    """Measured displacements, and their mean direction by its name, where positions have one."""
    value = problem.measured.value[problem.frames.measured]
    if not problem.measured.is_position:
        return value[:, 0], {}
    mean = value.mean(axis=0)
    return np.hypot(*value.T), {"direction": float(np.arctan2(mean[1], mean[0]))}


def _constant(problem: Problem) -> _ClosedForm:
    """A pin at one place."""
    clearance = problem.orbits.journal.clearance
    place = problem.measured.value[problem.frames.measured]
    start = dict(zip(("load", "side"), place.mean(axis=0) / clearance, strict=False))

    def predict(sets: Array) -> Array:
        return np.tile(sets[:, np.newaxis] * clearance, (1, len(place), 1))

    return _ClosedForm(_plain_unknowns(start), predict, lambda value, std: {})


def _law(
    problem: Problem, shape: Array, *more: str, viscous: float = np.nan, known: float = 0.0
) -> _ClosedForm:
    """A film of a shape (trigger,) times any factor, in one direction.

    Of `more`, it is to a "power" and above an "offset"; `viscous` is the power of the viscosity,
    `known` the relative error of the formula of the shape, infinite outside its regime.
    """
    journal = problem.orbits.journal
    distance, direction = _distances(problem)
    film = np.maximum(journal.least_clearance - distance, 1e-9)
    size = np.abs(np.nan_to_num(shape[problem.frames.measured]))
    top = max(float(size.max()), 1e-300)
    relative = np.log(np.maximum(size / top, 1e-12))
    offset = 0.9 * film.min() if "offset" in more else 0.0
    power, factor = 1.0, np.log(film.mean() / max(np.mean(size / top), 1e-12))
    if "power" in more:
        power, factor = np.polyfit(relative, np.log(film - offset), 1, w=film - offset)
    begin = {"power": max(power, 0.1), "offset": offset / journal.clearance}
    start = {"factor": float(factor)}
    start |= {name: begin[name] for name in more} | direction

    def predict(sets: Array) -> Array:
        by_name = dict(zip(start, sets.T[..., np.newaxis], strict=True))
        films = np.exp(np.minimum(by_name["factor"] + by_name.get("power", 1.0) * relative, 50.0))
        films = films + journal.clearance * by_name.get("offset", 0.0)
        return _pointed(problem, journal.least_clearance - films, sets[:, -1])

    def read(value: Array, std: Array) -> dict[str, Estimate]:
        named = zip(start, value, std, strict=True)
        found = {name: _about(one, error, "1") for name, one, error in named}
        error = found.pop("factor").std
        times = float(np.exp(value[0])) / top
        eta = journal.viscosity * times ** (1 / viscous)
        by_formula = {"factor": _about(times, times * error, "1")}
        if np.isfinite(known):  # a formula outside its regime has no viscosity
            by_formula["viscosity"] = _about(eta, eta * error / viscous, "Pa s").widened(
                {"formula": eta * known / viscous} if known else {}
            )
        if "offset" in found:
            found["offset"] = found["offset"].times(journal.clearance, "m")
        return {name: found[name] for name in more} or by_formula

    return _ClosedForm(_plain_unknowns(start, *more), predict, read)


def _squeeze(problem: Problem) -> _ClosedForm:
    """Squeeze of a long joint in closed form, in one direction."""
    journal = problem.orbits.journal
    impulse = problem.impulse()
    scale = max(float(np.ptp(impulse)), 1e-300)
    distance, direction = _distances(problem)
    eccentricity = np.clip(distance / journal.clearance, 0.0, 0.99999)
    ratio = eccentricity / np.sqrt(1 - eccentricity**2)
    at = problem.frames.average(impulse[np.newaxis])[0, problem.frames.measured]
    slope, first = np.polyfit(at / scale, ratio, 1, w=(1 - eccentricity) ** 1.5)

    def predict(sets: Array) -> Array:
        ratios = sets[:, :1] + sets[:, 1:2] * impulse / scale
        frames = journal.clearance * ratios / np.hypot(1, ratios)
        found = problem.frames.average(frames)[:, problem.frames.measured]
        return _pointed(problem, found, sets[:, -1])

    def read(value: Array, std: Array) -> dict[str, Estimate]:
        rate = max(float(value[1]), 1e-12)
        eta = journal.viscosity * scale / journal.squeeze_constant / rate
        return {"viscosity": _about(eta, eta * std[1] / rate, "Pa s")}

    start = {"start": float(first), "slope": float(slope), **direction}
    return _ClosedForm(_plain_unknowns(start, "slope"), predict, read)  # a viscosity is positive


def _about(value: float, std: float, unit: str) -> Estimate:
    """An estimate with the interval of its standard deviation."""
    return Estimate(float(value), float(std), value - 1.96 * std, value + 1.96 * std, unit)
