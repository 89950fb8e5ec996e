"""Comparison of physical models of the film in the joint by their likelihood."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array
from erlif.core.errors import ModelError
from erlif.core.progress import Progress, silent
from erlif.models.reynolds import Journal
from erlif.prediction.fit import LOAD_LINE_STD, MISFIT, MotionFit, fit_motion
from erlif.prediction.given import GivenErrors
from erlif.prediction.least_squares import (
    LeastSquares,
    Minimum,
    Observations,
    Predict,
    Unknowns,
)
from erlif.prediction.measured import MeasuredMotion
from erlif.prediction.motion import FrameMotion
from erlif.prediction.orbits import FreeOrbits
from erlif.prediction.problem import FrameSteps, Problem

# Steady formulas, by the variables of a film that hold them.
STEADY = {
    "film_hamrock_dowson": "the steady line-contact formula",
    "film_theory": "the steady film of the regime map",
}

# A long joint under its load without rotation, eps / sqrt(1 - eps^2) linear in time.
SQUEEZE = "squeeze in closed form"

# Transient films, by how the pin is held.
HELD = {
    "free": "a pin that is free sideways",
    "guided": "a guided pin",
    "spring": "a pin on a sideways spring",
}

# The largest likelihood of a guided pin: any course along the load, at one sideways place.
ANY_GUIDED = "any guided pin"

# A pin at rest, which no theory of a moving film needs.
CONSTANT = "a constant gap"

# Factor of the stated random errors up to which a model describes a film. Films that follow a
# candidate leave up to 1.1, photographed ones up to 1.7 (docs/theory/which.md).
DESCRIBED = 3.0

_CARRIES = {
    SQUEEZE: "squeeze carries the film, and the film shows no rotation of the bushing",
    HELD["free"]: "squeeze carries the film of a pin that is free sideways, and the pin sinks",
    HELD[
        "guided"
    ]: "the swing carries the film of a pin that is guided: cavities rectify its wedge",
    HELD["spring"]: "squeeze and swing carry the film of a pin on a sideways spring",
    STEADY["film_hamrock_dowson"]: "the film follows the steady line-contact formula",
    ANY_GUIDED: "the pin stays on one line, as a guided one does",
    STEADY["film_theory"]: "the film follows the steady formula of the regime map",
}

# Differences of BIC below which the evidence has a name. Kass and Raftery (1995).
_STRENGTHS = ((2.0, "undecided"), (6.0, "weak"), (10.0, "strong"), (np.inf, "very strong"))


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
    """

    name: str
    bic: float
    unknowns: int
    inflation: float
    residual: float

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
        Which physics carries the film, and how sure that is: one line.
    fit : MotionFit or None
        The best transient model.
    independent : float
        Share of the values that counts as independent: residuals of neighbouring triggers are
        correlated where the model leaves a trend.
    carrier : str or None
        Name of the model that the verdict states; None where no model describes the film, or it is
        constant within its errors.
    not_fitted : mapping of str to str
        Models that could not be fitted, and why.
    """

    candidates: tuple[FilmModel, ...]
    verdict: str
    fit: MotionFit | None
    independent: float
    carrier: str | None = None
    not_fitted: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _Fitted:
    """Fit of one model, reduced to the numbers that a comparison needs."""

    name: str
    log_likelihood: float
    unknowns: int
    inflation: float
    miss: Array  # measured less predicted, (trigger, axis) [m]
    residual: Array  # in stated errors, (trigger, axis)

    @classmethod
    def of(cls, name: str, problem: Problem, found: Minimum, predicted: Array) -> _Fitted:
        """Make the record of a fitted model from its prediction of the measured triggers."""
        value = problem.measured.value[problem.frames.measured]
        return cls(
            name,
            found.log_likelihood,
            found.value.size,
            found.inflation,
            value - predicted,
            found.residual.reshape(value.shape),
        )


def compare_models(
    measured: MeasuredMotion,
    journal: Journal,
    motion: FrameMotion,
    *,
    trigger: npt.NDArray[np.integer[Any]] | None = None,
    steady: Mapping[str, Array] | None = None,
    sideways: Sequence[str] = ("free", "guided"),
    load_line_std: float = LOAD_LINE_STD,
    given: GivenErrors | None = None,
    progress: Progress = silent,
) -> ModelComparison:
    """Compare what may carry the film: steady wedge, squeeze, and the transient film.

    The models are not special cases of each other, so that a likelihood ratio has no known
    distribution. They are compared by the Bayesian information criterion (Schwarz 1978),
    p ln n - 2 ln L. Every model may inflate the random errors by what its residuals require, so
    that a misfit costs as much as the data warrant, and n is reduced to the residuals that are
    independent in the best one. The viscosity is free in all models: a steady formula may have any
    factor.

    Parameters
    ----------
    measured, journal, motion, trigger, load_line_std, given
        As for `fit_motion`.
    steady : mapping of str to array, (trigger,), optional
        Films of steady formulas under the names of `STEADY`. [m]
    sideways : sequence of str
        Transient films to compare: of "free", "guided" and "spring". "any guided" is the
        largest likelihood that a guided pin can have, with any course along the load at one
        sideways place; it needs positions, and solves no film with cavities. It also stands in
        for a guided pin that cannot be fitted.
    progress : callable
        Receives the name of the step, the number of models that are fitted, and of all models.

    Returns
    -------
    ModelComparison

    Raises
    ------
    ConfigError
        As `fit_motion`.
    ModelError
        If none of the models could be fitted.

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
    >>> found = compare_models(
    ...     measured, joint, still, steady={"film_theory": np.full(41, 131e-6)}, sideways=["free"])
    >>> found.candidates[-1].name, found.candidates[-1].bic > 10
    ('the steady film of the regime map', True)
    """
    frames = FrameSteps.of(measured, motion.steps, trigger)
    problem = Problem(FreeOrbits(journal, motion.motion), frames, measured, "free")
    fitted: list[_Fitted] = []
    fits: dict[str, MotionFit] = {}
    failures: dict[str, str] = {}
    transient = [one for one in sideways if one != "any guided"]
    total = len(transient) + 2 + len(steady or {})

    # a model that cannot carry the load is left out, unless none can
    for done, held in enumerate(transient):
        progress("fit", done, total)
        try:
            fit = fit_motion(
                measured,
                journal,
                motion,
                trigger=trigger,
                sideways=held,
                load_line_std=load_line_std,
                given=given,
                profiles=False,
            )
        except ModelError as error:
            failures[HELD[held]] = str(error)
            continue
        fits[HELD[held]] = fit
        predicted = fit.predicted[frames.measured]
        if not measured.is_position:
            predicted = np.hypot(*predicted.T)[:, np.newaxis]
        fitted.append(_Fitted.of(HELD[held], problem, fit.minimum, predicted))

    # closed forms take no time beside the transient films
    simple = [(STEADY[name], *_steady(problem, film)) for name, film in (steady or {}).items()]
    candidates = [(CONSTANT, *_constant(problem)), (SQUEEZE, *_squeeze(problem)), *simple]
    for done, (name, unknowns, predict) in enumerate(candidates, len(transient)):
        progress("fit", done, total)
        least = LeastSquares(problem.observations(), unknowns, predict)
        try:
            minimum = least.solve()
        except ModelError as error:
            failures[name] = str(error)
            continue
        fitted.append(_Fitted.of(name, problem, minimum, minimum.predicted))
    progress("fit", total, total)

    bounded = "any guided" in sideways or HELD["guided"] in failures
    if measured.is_position and bounded:
        fitted.append(_bound_guided(problem, load_line_std))
    if not fitted:
        raise ModelError(
            f"No model of the film could be fitted. {next(iter(failures.values()))} Check load, "
            "viscosity and radii in run.toml."
        )
    return replace(_rank(fitted, fits), not_fitted=failures)


def _rank(fitted: Sequence[_Fitted], fits: Mapping[str, MotionFit]) -> ModelComparison:
    """Order the models by the criterion, with the number of independent residuals."""
    likeliest = max(fitted, key=lambda one: one.log_likelihood)
    share = _independent(likeliest.residual)
    number = likeliest.residual.size
    criteria = [
        one.unknowns * np.log(max(number * share, 2.0)) - 2 * share * one.log_likelihood
        for one in fitted
    ]
    order = np.argsort(criteria)
    least = criteria[order[0]]
    candidates = tuple(
        FilmModel(
            fitted[k].name,
            float(criteria[k] - least),
            fitted[k].unknowns,
            fitted[k].inflation,
            float(np.sqrt(np.mean(fitted[k].miss ** 2))),
        )
        for k in order
    )
    transient = [one.name for one in candidates if one.name in fits]
    carrier, verdict = _verdict(candidates)
    return ModelComparison(
        candidates, verdict, fits[transient[0]] if transient else None, share, carrier
    )


def _verdict(candidates: Sequence[FilmModel]) -> tuple[str | None, str]:
    """Name the model that carries the film, and state the evidence in one line."""
    fitted = [one for one in candidates if one.name != ANY_GUIDED]
    if fitted and fitted[0].name == CONSTANT and fitted[0].describes:
        return None, (
            "The film is constant within its errors, which decides nothing about what carries it. "
            "Record from the moment of loading on, or more cycles."
        )
    best = candidates[0]
    if not best.describes:
        closest = min(fitted or candidates, key=lambda one: one.inflation)
        return None, (
            f"None of the models describes this film: the best of {len(fitted)}, {closest.name}, "
            f"is off by {closest.inflation:.3g} times the stated errors "
            f"({closest.residual * 1e6:.2g} um). Check load, clearance and tilt of the joint, and "
            "the times of the frames."
        )

    text = _CARRIES[best.name]
    if len(candidates) > 1:
        second = candidates[1]
        strength = next(name for limit, name in _STRENGTHS if second.bic < limit)
        text += f" ({strength}: BIC {second.bic:.3g} below that of {second.name})"
    if best.inflation > MISFIT:
        text += f"; its residuals are {best.inflation:.3g} times the stated errors"
    return best.name, text[0].upper() + text[1:] + "."


def _independent(residual: Array) -> float:
    """Share of independent values in residuals (trigger, axis) with a first-order correlation."""
    shares = []
    for axis in residual.T:
        off = axis - axis.mean()
        size = float(off @ off)
        correlation = float(off[1:] @ off[:-1]) / size if size > 0 else 0.0
        correlation = min(max(correlation, 0.0), 0.99)
        shares.append((1 - correlation) / (1 + correlation))
    return float(np.mean(shares))


def _bound_guided(problem: Problem, load_line_std: float) -> _Fitted:
    """Upper bound of the likelihood of a guided pin, as a fitted model.

    Its sideways place is constant but for the turn of the load line. The density of what remains
    along the load is the largest that the random errors allow; errors that all triggers share
    lower it further.
    """
    observed = problem.observations()
    load, side = observed.value.T
    start = {"rest": float(side.mean())} | ({"load_line": 0.0} if load_line_std > 0 else {})
    columns = np.stack([np.ones_like(load), load], axis=1)[:, : len(start)]
    known = np.array([np.inf, load_line_std / problem.orbits.journal.radius])[: len(start)]
    unknowns = replace(_plain_unknowns(start), expected_std=known)
    covariance = observed.random_cov
    alone = Observations(side[:, np.newaxis], covariance[:, 1:, 1:], observed.shared[:, 1:])
    found = LeastSquares(alone, unknowns, lambda sets: (sets @ columns.T)[..., np.newaxis]).solve()

    variance = covariance[:, 0, 0] - covariance[:, 0, 1] ** 2 / covariance[:, 1, 1]
    along = -0.5 * float(np.log(2 * np.pi * variance).sum())
    miss = np.stack([0 * side, side - found.predicted[:, 0]], axis=1)
    residual = np.stack([0 * side, found.residual], axis=1)
    count = len(start) + 2  # viscosity and start film of the course
    return _Fitted(ANY_GUIDED, found.log_likelihood + along, count, found.inflation, miss, residual)


def _plain_unknowns(start: Mapping[str, float], positive: str = "") -> Unknowns:
    """Unknowns of a closed form without prior; `positive` is bounded below by zero."""
    ones = np.ones(len(start))
    return Unknowns(
        names=tuple(start),
        start=np.array(list(start.values())),
        step=1e-4 * ones,
        low=np.array([0.0 if name == positive else -np.inf for name in start]),
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


def _constant(problem: Problem) -> tuple[Unknowns, Predict]:
    """A pin at one place."""
    clearance = problem.orbits.journal.clearance
    place = problem.measured.value[problem.frames.measured]
    start = dict(zip(("load", "side"), place.mean(axis=0) / clearance, strict=False))

    def predict(sets: Array) -> Array:
        return np.tile(sets[:, np.newaxis] * clearance, (1, len(place), 1))

    return _plain_unknowns(start), predict


def _steady(problem: Problem, film: Array) -> tuple[Unknowns, Predict]:
    """A steady film times any factor, in one direction."""
    clearance = problem.orbits.journal.clearance
    distance, direction = _distances(problem)
    shape = np.nan_to_num(np.asarray(film, dtype=float)[problem.frames.measured])
    mean = max(float(shape.mean()), 1e-12)
    factor = max(float((clearance - distance).mean()), 1e-9) / mean

    def predict(sets: Array) -> Array:
        films = np.exp(np.minimum(sets[:, :1], 50.0)) * shape
        return _pointed(problem, clearance - films, sets[:, -1])

    return _plain_unknowns({"factor": float(np.log(factor)), **direction}), predict


def _squeeze(problem: Problem) -> tuple[Unknowns, Predict]:
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

    start = {"start": float(first), "slope": float(slope), **direction}
    return _plain_unknowns(start, positive="slope"), predict  # a viscosity is
