"""Weighted least squares with errors that observations share, and profiles of the likelihood.

The models follow many sets of unknowns at once, so that all derivatives come from one call.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

# Trials until a search ends without a minimum; four to ten are usual.
MOST_TRIALS = 60

# Decrease of chi-square in a step, below which the search ends: a hundredth of a standard
# deviation.
CONVERGED = 1e-4

# Rise of chi-square at the ends of the 95 % interval, and at a 95 % limit.
TWO_SIDED, ONE_SIDED = 3.841, 2.706

# Standard deviations at which a profile is computed.
TARGETS = (-2.4, -1.2, 1.2, 2.4)

_INFLATIONS = 4001  # of which the likeliest is taken: steps of half a percent
_LARGEST_LOG = 40.0  # of the square of an inflation
_SINGULAR = 1e-14  # of the scaled normal matrix, below which a direction is left out
_ROUNDS = 8  # of minimum and inflation, which depend on each other
_SAME = 0.02  # relative change of the inflation below which its round is the last
_SMALLEST_STEP = 1e-5  # of the unknowns, relative: a model solved to a tolerance promises more
_NEARLY_CLOSED = 0.8  # of the wanted root of the rise, from which the last point gives the end

# Sets of unknowns (case, unknown) to observations (case, observation).
Predict = Callable[[Array], Array]


@dataclass(frozen=True)
class Observations:
    """Measured values with independent and shared errors.

    Attributes
    ----------
    value : Array
        Measured values, in groups of equal size, (group, member).
    random_cov : Array
        Covariance of the errors that are new in each group, (group, member, member).
    shared : Array
        Change of the values with one standard deviation of each error that all groups share,
        (group, member, source). These are fitted as nuisance parameters.
    """

    value: Array
    random_cov: Array
    shared: Array

    @cached_property
    def _inverse_root(self) -> Array:
        """Inverses of the lower triangular roots of `random_cov`, (group, member, member)."""
        return np.linalg.inv(np.linalg.cholesky(self.random_cov))

    def whiten(self, values: Array) -> Array:
        """Values in units of their random standard deviations, (..., observation).

        Parameters
        ----------
        values : array, (..., group, member)

        Returns
        -------
        array, (..., observation)
        """
        white = np.einsum("gij,...gj->...gi", self._inverse_root, values)
        return np.asarray(white.reshape(*values.shape[:-2], self.size))

    @property
    def size(self) -> int:
        """Number of observations."""
        return self.value.size

    def log_determinant(self, inflation: float = 1.0) -> float:
        """Logarithm of the determinant of the whole covariance.

        Parameters
        ----------
        inflation : float
            Factor of the random standard deviations.

        Returns
        -------
        float
        """
        random = np.linalg.slogdet(self.random_cov)[1].sum() + 2 * self.size * np.log(inflation)
        columns = self.whiten(np.moveaxis(self.shared, -1, 0)) / inflation
        joint = np.linalg.slogdet(np.eye(len(columns)) + columns @ columns.T)[1]
        return float(random + joint)


@dataclass(frozen=True)
class Unknowns:
    """Unknowns of a fit, with start, bounds and prior knowledge.

    Attributes
    ----------
    names : tuple of str
        One for each unknown.
    start : Array
        Values at which the search begins, (unknown,).
    step : Array
        Differences from which derivatives are computed, (unknown,).
    low : Array
        Lower bounds, (unknown,).
    high : Array
        Upper bounds, (unknown,).
    expected : Array
        What is known beforehand, (unknown,).
    expected_std : Array
        Its standard deviations; infinite where nothing is known, (unknown,).
    fixed : Mapping[str, float]
        What the model needs besides, and is not fitted.
    """

    names: tuple[str, ...]
    start: Array
    step: Array
    low: Array
    high: Array
    expected: Array
    expected_std: Array
    fixed: Mapping[str, float] = field(default_factory=dict)

    def without(self, name: str, start: Array) -> Unknowns:
        """Fix one unknown at its expected value; `start` (unknown,) holds the start of all."""
        k = self.names.index(name)
        keys = ("step", "low", "high", "expected", "expected_std")
        kept = {key: np.delete(getattr(self, key), k) for key in keys}
        return Unknowns(
            names=tuple(one for one in self.names if one != name),
            start=np.delete(start, k),
            fixed={**self.fixed, name: float(self.expected[k])},
            **kept,
        )

    def by_name(self, sets: Array) -> dict[str, Array]:
        """Values of sets of unknowns (case, unknown) and of fixed numbers by name, each (case,)."""
        columns = {name: sets[:, k] for k, name in enumerate(self.names)}
        return columns | {name: np.full(len(sets), value) for name, value in self.fixed.items()}

    def one_by_name(self, value: Array) -> dict[str, float]:
        """Values of one set of unknowns (unknown,) and of fixed numbers by name."""
        return {name: float(column[0]) for name, column in self.by_name(value[None]).items()}


@dataclass(frozen=True)
class Minimum:
    """The least squares.

    Attributes
    ----------
    value : Array
        The unknowns, (unknown,).
    covariance : Array
        Their covariance in the linear approximation, all kinds of errors together.
    shared : Array
        The errors that the observations share, in standard deviations, (source,).
    predicted : Array
        Values without the shared errors, (group, member).
    residual : Array
        What remains, in random standard deviations, (observation,).
    jacobian : Array
        Derivatives of the whitened observations, (observation, unknown).
    inflation : float
        Factor of the random standard deviations that the residuals require, at least 1.
    log_likelihood : float
        With that factor, the shared errors integrated out.
    """

    value: Array
    covariance: Array
    shared: Array
    predicted: Array
    residual: Array
    jacobian: Array
    inflation: float
    log_likelihood: float


class LeastSquares:
    """The sum of squares of a model.

    Parameters
    ----------
    observed : Observations
    unknowns : Unknowns
    predict : callable
        Sets of unknowns (case, unknown) to values (case, group, member); NaN where the model has
        none.
    tolerance : float
        Decrease of chi-square in a step, below which the search ends.
    """

    def __init__(
        self,
        observed: Observations,
        unknowns: Unknowns,
        predict: Predict,
        tolerance: float = CONVERGED,
    ) -> None:
        self.observed, self.unknowns, self.predict = observed, unknowns, predict
        self.tolerance = tolerance
        self.target = observed.whiten(observed.value)
        self.columns = observed.whiten(np.moveaxis(observed.shared, -1, 0)).T
        self.sources = self.columns.shape[1]
        axes, sizes, _ = np.linalg.svd(self.columns, full_matrices=False)
        self.axes, self.spread = axes, sizes**2
        self.known = np.isfinite(unknowns.expected_std)
        # the factors of which the likeliest is taken, squared, and what they make of the variances
        self.square = np.exp(np.linspace(0.0, _LARGEST_LOG, _INFLATIONS))[:, np.newaxis]
        self.variances = self.square + self.spread
        self.logarithms = np.log(self.variances)

    def misses(self, sets: Array) -> Array:
        """Whitened differences of the observations from each set of unknowns."""
        return np.asarray(self.target - self.observed.whiten(self.predict(sets)))

    def neighbours(self, value: Array) -> Array:
        """A set of unknowns and one beside it for each of them."""
        step = np.where(value + self.unknowns.step > self.unknowns.high, -1, 1) * self.unknowns.step
        return np.vstack([value, value + np.diag(step)])

    def expected_miss(self, value: Array) -> Array:
        """Departures of the unknowns from their expected values, in standard deviations."""
        unknowns = self.unknowns
        return np.asarray(((unknowns.expected - value) / unknowns.expected_std)[..., self.known])

    def system(
        self, miss: Array, jacobian: Array, value: Array, inflation: float
    ) -> tuple[Array, Array]:
        """Matrix and right side of the linear step of unknowns and shared errors."""
        count = value.size
        known = np.diag(1 / self.unknowns.expected_std)[self.known]
        rows = [
            np.hstack([jacobian, self.columns]) / inflation,
            np.hstack([known, np.zeros((len(known), self.sources))]),
            np.hstack([np.zeros((self.sources, count)), np.eye(self.sources)]),
        ]
        right = [miss / inflation, self.expected_miss(value), np.zeros(self.sources)]
        return np.vstack(rows), np.concatenate(right)

    def reduced(self, miss: Array, value: Array, inflation: float) -> tuple[float, Array]:
        """Chi-square with the best shared errors, and these errors."""
        matrix = self.columns.T @ self.columns + inflation**2 * np.eye(self.sources)
        shared = np.asarray(np.linalg.solve(matrix, self.columns.T @ miss))
        left = (miss - self.columns @ shared) / inflation
        known = self.expected_miss(value)
        return float(left @ left + shared @ shared + known @ known), shared

    def solve(self) -> Minimum:
        """Search the minimum by a trust region within the bounds (Branch et al. 1999).

        Returns
        -------
        Minimum

        Raises
        ------
        ModelError
            If the model has no values at the start, or no minimum was found.
        """
        from scipy.optimize import least_squares  # slow to load

        unknowns = self.unknowns
        value = np.clip(unknowns.start, unknowns.low, unknowns.high)
        (miss,) = self.misses(value[np.newaxis])
        if not np.isfinite(miss).all():
            raise ModelError(
                "The model has no film at the start of the fit. Check load and viscosity, or give "
                "another start."
            )

        # a poor model is not bent by shared errors of many standard deviations
        inflation = self._inflation(miss, value)
        for _ in range(_ROUNDS):
            search = least_squares(
                self._independent_errors,
                value,
                self._derivatives,
                args=(inflation,),
                bounds=(unknowns.low, unknowns.high),
                x_scale="jac",
                ftol=self.tolerance / self.target.size,
                xtol=_SMALLEST_STEP,
                max_nfev=MOST_TRIALS,
            )
            if not search.success:
                raise ModelError(
                    f"The fit found no minimum in {MOST_TRIALS} trials: chi-square "
                    f"{2 * search.cost:.4g} of {self.target.size} observations. Leave one of them "
                    f"out of the fit: {', '.join(unknowns.names)}."
                )
            value, before = search.x, inflation
            (miss,) = self.misses(value[np.newaxis])
            inflation = self._inflation(miss, value)
            if abs(inflation / before - 1) < _SAME:
                break
        return self._minimum(value, miss, self._jacobian(value))

    def _independent_errors(self, value: Array, inflation: float) -> Array:
        """Residuals and departures from the prior, as independent errors of unit size."""
        (miss,) = self.misses(value[np.newaxis])
        return np.append(self._without_shared(miss, inflation), self.expected_miss(value))

    def _derivatives(self, value: Array, inflation: float) -> Array:
        """Their derivatives with the unknowns."""
        moved = self._without_shared(np.nan_to_num(self._jacobian(value)), inflation)
        return -np.vstack([moved, np.diag(1 / self.unknowns.expected_std)[self.known]])

    def _without_shared(self, miss: Array, inflation: float) -> Array:
        """Differences over the root of their whole covariance, shared errors included."""
        along = self.axes.T @ miss
        root = np.sqrt(self.spread + inflation**2).reshape(-1, *[1] * (miss.ndim - 1))
        return np.asarray((miss - self.axes @ along) / inflation + self.axes @ (along / root))

    def _jacobian(self, value: Array) -> Array:
        """Derivatives of the prediction, in random standard deviations. (observation, unknown)"""
        sets = self.neighbours(value)
        there = self.misses(sets)
        steps = np.diag(sets[1:] - value)
        return np.asarray((there[0] - there[1:]) / steps[:, np.newaxis]).T

    def _inflation(self, miss: Array, value: Array) -> float:
        """Factor of the random errors of the greatest likelihood, at least 1."""
        freedom = max(self.target.size - self.sources - value.size, 1)
        along = self.axes.T @ miss
        rest = max(float(miss @ miss - along @ along), 0.0)

        # the likelihood with the shared errors integrated out, over the factor squared
        square = self.square[:, 0]
        unlikely = (along**2 / self.variances + self.logarithms).sum(axis=1)
        unlikely += rest / square + freedom * np.log(square)
        return float(np.sqrt(square[int(np.argmin(unlikely))]))

    def _minimum(self, value: Array, miss: Array, jacobian: Array) -> Minimum:
        """The result at a set of unknowns."""
        count, inflation = value.size, self._inflation(miss, value)
        matrix, _ = self.system(miss, np.nan_to_num(jacobian), value, inflation)
        normal = matrix.T @ matrix
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        outer = np.outer(scale, scale)

        # without the directions that nothing determines
        covariance = np.linalg.pinv(normal / outer, rcond=_SINGULAR, hermitian=True) / outer
        chi, shared = self.reduced(miss, value, inflation)
        residual = miss - self.columns @ shared
        likelihood = -0.5 * (
            chi
            + self.observed.log_determinant(inflation)
            + self.target.size * float(np.log(2 * np.pi))
        )
        return Minimum(
            value=value,
            covariance=covariance[:count, :count],
            shared=shared,
            predicted=self.predict(value[np.newaxis])[0],
            residual=residual,
            jacobian=jacobian,
            inflation=inflation,
            log_likelihood=likelihood,
        )

    def profiles(
        self, found: Minimum, which: list[int], targets: Sequence[float] = TARGETS
    ) -> list[tuple[Array, Array]]:
        """Chi-square over each of some unknowns, all others and the shared errors fitted again.

        Parameters
        ----------
        found : Minimum
        which : list of int
            Numbers of the unknowns.
        targets : sequence of float
            Standard deviations from the minimum at which chi-square is computed.

        Returns
        -------
        list of tuple of array
            For each, values that rise and the rise of chi-square there; the minimum is one.
        """
        unknowns, count = self.unknowns, found.value.size
        std = np.sqrt(np.diag(found.covariance))
        sets, fixed = [], []
        for one in which:
            slope = found.covariance[:, one] / found.covariance[one, one]
            for target in targets:
                place = found.value[one] + target * std[one]
                place = float(np.clip(place, unknowns.low[one], unknowns.high[one]))
                moved = found.value + slope * (place - found.value[one])
                moved = np.clip(moved, unknowns.low, unknowns.high)
                moved[one] = place
                sets.append(moved)
                fixed.append(one)

        # one step of the others with the derivatives of the minimum corrects for the curvature
        def chi_squares(sets: Array, misses: Array) -> list[float]:
            both = zip(misses, sets, strict=True)
            return [self.reduced(miss, value, found.inflation)[0] for miss, value in both]

        trial = np.array(sets)
        misses = self.misses(trial)
        first = chi_squares(trial, misses)
        again = trial.copy()
        for k, one in enumerate(fixed):
            if not np.isfinite(misses[k]).all():
                continue
            matrix, right = self.system(
                misses[k], np.nan_to_num(found.jacobian), trial[k], found.inflation
            )
            others = np.delete(np.arange(matrix.shape[1]), one)
            step = np.linalg.lstsq(matrix[:, others], right, rcond=1e-12)[0]
            again[k, others[: count - 1]] += step[: count - 1]
        again = np.clip(again, unknowns.low, unknowns.high)
        second = chi_squares(again, self.misses(again))
        here = found.value[np.newaxis]
        rise = np.fmin(first, second) - chi_squares(here, self.misses(here))

        curves, middle = [], len(targets) // 2
        for n, one in enumerate(which):
            part = slice(n * len(targets), (n + 1) * len(targets))
            place = np.insert(trial[part, one], middle, found.value[one])
            curves.append((place, np.insert(rise[part], middle, 0.0)))
        return curves


def interval(value: Array, rise: Array, level: float) -> tuple[float, float]:
    """Find the values at which a profile crosses a level; infinite where it does not.

    An end up to a quarter beyond the last point follows from the parabola through that point: cells
    that change to cavities make a profile jump by as much.

    Parameters
    ----------
    value, rise : array, (point,)
        A profile, as from `LeastSquares.profile`.
    level : float
        Rise of chi-square.

    Returns
    -------
    low, high : float

    Examples
    --------
    >>> place = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    >>> interval(place, place**2, 1.44)
    (-1.2, 1.2)
    """
    root = np.sqrt(np.maximum(rise, 0.0)) * np.sign(np.arange(rise.size) - int(np.argmin(rise)))
    ends = []
    for wanted in (-np.sqrt(level), np.sqrt(level)):
        inside = np.isfinite(root)
        place, at = root[inside], value[inside]
        order = np.argsort(place, kind="stable")
        place, at = place[order], at[order]
        last, edge = (place[-1], at[-1]) if wanted > 0 else (place[0], at[0])
        middle = float(value[int(np.argmin(rise))])
        if last / wanted < _NEARLY_CLOSED:
            ends.append(float(np.copysign(np.inf, wanted)))
        elif last / wanted < 1:
            ends.append(middle + float((edge - middle) * wanted / last))
        else:
            ends.append(float(np.interp(wanted, place, at)))
    return ends[0], ends[1]
