"""Check of the form of the gap against that of the joint, over all triggers of a run.

The gap of rigid circles has the curvature of their radii along sliding and none along the axis. A
deviation has one of few causes. Wrong radii change the curvature by the same share at any film. So
does a wrong scale of the calibration, by which curvature and film grow together; any other error of
the calibration changes with the film. A bent pin has a curvature along the axis. The pressure of a
thin film flattens the surfaces. Errors that frames do not show imitate each of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from erlif.calibration import Systematics
from erlif.core.arrays import Array
from erlif.core.terms import TERMS
from erlif.trend.position import FittedNumbers, PinPosition, PinView

# Accuracy of the film scale of the method, Hidrovo and Hart (2001). [1]
SCALE_STD = 0.01

# Deviation from which a cause is named. [std]
SIGNIFICANT = 3.0

# Largest size of an error that frames do not show for which it is named. [1]
_LARGEST = 0.3

# Change of the excess over the films, relative to it, from which it depends on the film.
_DISTINCT = 0.3


class Cause(StrEnum):
    """Likely cause of a deviation of the form."""

    NONE = "none"
    RADII = "radii"
    CALIBRATION = "calibration"
    BENDING = "bending"
    FLATTENING = "flattening"


@dataclass(frozen=True)
class Imitation:
    """Systematic error that causes the same deviation of the gap.

    Attributes
    ----------
    term : str
        As in [systematics].
    size : float
        How large it would be in the run. [1]
    cost : float
        Misfit of the triggers with it, and its size over its standard deviation, squared. [1]
    """

    term: str
    size: float
    cost: float


@dataclass(frozen=True)
class GapForm:
    """Form of the gap against that of rigid circles.

    Attributes
    ----------
    excess : float
        Curvature along sliding beyond that of the circles, relative to that of touching ones. [1]
    excess_std : float
        Its standard deviation: noise, surfaces, calibration, and the film scale of the method. [1]
    excess_change : float
        Change of the excess from the thinnest to the thickest film; NaN with one film. [1]
    excess_change_std : float
        Its standard deviation. [1]
    bend : float
        Curvature along the axis. [um/mm2]
    bend_std : float
        Its standard deviation. [um/mm2]
    films : tuple[float, float]
        Thinnest and thickest film at the load line. [um]
    cause : Cause
        What is behind a significant deviation where it is that of the joint or of the fixture.
    imitations : tuple[Imitation, ...]
        What makes the same deviation, the likeliest first; empty where there is none.
    """

    excess: float
    excess_std: float
    excess_change: float
    excess_change_std: float
    bend: float
    bend_std: float
    films: tuple[float, float]
    cause: Cause
    imitations: tuple[Imitation, ...] = ()


@dataclass(frozen=True)
class _Covariance:
    """Covariance of one number of the form over the triggers, of which a run may have thousands.

    Attributes
    ----------
    random : Array
        Variance by noise, new at every trigger, (trigger,). [um2/mm4]
    surface : Array
        Standard deviation by marks of the surfaces, common to all, (trigger,). [um/mm2]
    gradient : Array
        Change with the parameters of the calibration, common to all, (trigger, parameter).
    calibration : Array
        Their covariance, (parameter, parameter).
    """

    random: Array
    surface: Array
    gradient: Array
    calibration: Array

    @classmethod
    def of(cls, forms: Sequence[FittedNumbers], number: int, calibration: Array) -> _Covariance:
        """Of the number with this place in the form."""
        random = np.array([one.random_cov[number, number] for one in forms])
        surface = np.sqrt([one.surface_cov[number, number] for one in forms])
        gradient = np.array([one.gradient[number] for one in forms])
        return cls(random, surface, gradient, calibration)

    def times(self, factor: float) -> _Covariance:
        """The covariance of a multiple of the number."""
        columns = factor * self.surface, factor * self.gradient
        return _Covariance(factor**2 * self.random, *columns, self.calibration)

    @property
    def variance(self) -> Array:
        """Of each trigger, (trigger,)."""
        common = np.einsum("ti,ij,tj->t", self.gradient, self.calibration, self.gradient)
        return np.asarray(self.random + self.surface**2 + common)

    def of_sum(self, weight: Array) -> float:
        """Variance of the sum with these weights, (trigger,)."""
        along = weight @ self.gradient
        common = along @ self.calibration @ along
        return float(weight**2 @ self.random + (weight @ self.surface) ** 2 + common)


def judge_form(
    positions: Sequence[PinPosition],
    view: PinView,
    *,
    calibration_cov: Array,
    clearance_std: float = 0.0,
    flattening: float = 0.0,
    systematics: Systematics | None = None,
) -> GapForm | None:
    """Compare the form of the gap at all triggers with that of rigid circles.

    Parameters
    ----------
    positions : sequence of PinPosition
        Of the triggers.
    view : PinView
    calibration_cov : array
        `RatioCurve.full_covariance`.
    clearance_std : float
        How well the radii give the clearance. Against it and the accuracy of the film scale, radii
        and scale are weighed. [um]
    flattening : float
        Depth 2 q / (pi E*) of a Hertzian contact under the load; 0 for rigid bodies. [um]
    systematics : Systematics, optional
        Of the calibration; the last parameters of `calibration_cov`.

    Returns
    -------
    GapForm or None
        None where no trigger has a position.

    Examples
    --------
    A curvature that is 5 % too large at 2 and at 6 um; the clearance is known to 10 um:

    >>> from erlif.trend import FittedNumbers, PinPosition, PinView
    >>> view = PinView(33.36e-3, 33.59e-3, 0.06, load_line=9.6, axial_origin=7.7)
    >>> small, none = 1e-6 * np.eye(2), np.zeros((2, 3))
    >>> form = FittedNumbers(np.array([0.05 * view.curvature, 0.0]), small, small, none)
    >>> found = [
    ...     PinPosition(
    ...         value=np.array([view.clearance - film, 0.0, 0.0, 0.0]),
    ...         random_cov=np.eye(4), surface_cov=np.eye(4), gradient=np.zeros((4, 3)),
    ...         form=form,
    ...     )
    ...     for film in (2.0, 6.0)
    ... ]
    >>> str(judge_form(found, view, calibration_cov=np.eye(3), clearance_std=10.0).cause)
    'radii'
    """
    known = [one for one in positions if np.isfinite(one.form.value).all()]
    if not known:
        return None
    film = view.least_clearance - np.array([one.value[0] for one in known])
    excess, bend = np.array([one.form.value for one in known]).T
    cov = [_Covariance.of([one.form for one in known], n, calibration_cov) for n in (0, 1)]

    # weights by the variance of each trigger; what is common to all enters the variances alone
    rate = 1 / view.curvature
    of_rate = cov[0].times(rate)
    mean, mean_std = _fit_last(rate * excess, of_rate, np.ones((1, film.size)))
    bent, bent_std = _fit_last(bend, cov[1], np.ones((1, film.size)))
    change, change_std = math.nan, math.nan
    if np.ptp(film) > 0:
        line = np.stack([np.ones_like(film), (film - film.min()) / np.ptp(film)])
        change, change_std = _fit_last(rate * excess, of_rate, line)
    excess_std = math.hypot(mean_std, SCALE_STD)

    # the pressure of a squeezed film, (1 + x^2/2Rh)^-2, flattens the middle by 3/4 b^2/(R h)
    flat = -1.5 * flattening / np.maximum(film, flattening)
    rest, _ = _fit_last(rate * excess - flat, of_rate, np.ones((1, film.size)))
    if abs(bent) > SIGNIFICANT * bent_std:
        cause = Cause.BENDING
    elif abs(mean) <= SIGNIFICANT * excess_std:
        cause = Cause.NONE
    elif flattening > 0 and abs(rest) <= SIGNIFICANT * excess_std:
        cause = Cause.FLATTENING
    elif abs(change) > max(SIGNIFICANT * change_std, _DISTINCT * abs(mean)):
        cause = Cause.CALIBRATION
    else:
        clearance = clearance_std / view.clearance
        cause = Cause.RADII if clearance > SCALE_STD else Cause.CALIBRATION

    imitations: list[Imitation] = []
    if cause is not Cause.NONE and systematics is not None:
        n, values = (1, bend) if cause is Cause.BENDING else (0, excess)
        gradient = np.array([one.form.gradient[n] for one in known])
        imitations = _find_imitations(values, cov[n], gradient, systematics)
    return GapForm(
        excess=mean,
        excess_std=excess_std,
        excess_change=change,
        excess_change_std=change_std,
        bend=bent,
        bend_std=bent_std,
        films=(float(film.min()), float(film.max())),
        cause=cause,
        imitations=tuple(imitations),
    )


def _find_imitations(
    values: Array, covariance: _Covariance, gradient: Array, systematics: Systematics
) -> list[Imitation]:
    """Find error terms that explain a deviation of all triggers, each by its best parameter."""
    found: dict[str, Imitation] = {}
    width, scale = np.sqrt(np.diag(systematics.covariance)), covariance.variance
    for n, term in enumerate(systematics.terms):
        column = gradient[:, n - len(width)]
        if TERMS[term].unit != "%" or width[n] == 0 or not column.any():
            continue
        error, _ = _fit_last(values, covariance, column[None])
        cost = float(((values - error * column) ** 2 / scale).sum() + (error / width[n]) ** 2)
        if abs(error) < _LARGEST and (term not in found or cost < found[term].cost):
            found[term] = Imitation(term, -error, cost)  # the run has what its calibration lacks
    return sorted(found.values(), key=lambda one: one.cost)


def _fit_last(values: Array, covariance: _Covariance, design: Array) -> tuple[float, float]:
    """Last coefficient of a weighted fit and its standard deviation by the whole covariance."""
    weighted = design / np.maximum(covariance.variance, np.finfo(float).tiny)
    solve = np.linalg.solve(weighted @ design.T, weighted)
    return float(solve[-1] @ values), math.sqrt(max(covariance.of_sum(solve[-1]), 0.0))
