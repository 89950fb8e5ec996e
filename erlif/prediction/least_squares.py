"""Weighted least squares with errors that observations share, and profiles of the likelihood.

The models are slow and follow many sets of unknowns at once, so an iteration evaluates a trial and
its neighbours together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ModelError

MOST_ITERATIONS = 40
"""Trials until the search ends without a minimum; four to ten are usual."""

CONVERGED = 1e-4
"""Decrease of chi-square that a further step promises, below which the search ends: a hundredth of
a standard deviation."""

TWO_SIDED, ONE_SIDED = 3.841, 2.706
"""Rise of chi-square at the ends of the 95 % interval, and at a 95 % limit."""

TARGETS = (-2.4, -1.2, 1.2, 2.4)
"""Standard deviations at which a profile is computed."""

_DAMPING = 1e-3  # of the first step, over the curvature
_INFLATIONS = 4001  # of which the likeliest is taken: steps of half a percent
_LARGEST_LOG = 40.0  # of the square of an inflation
_SINGULAR = 1e-14  # of the scaled normal matrix, below which a direction is left out
_NEARLY = 1.0  # promised decrease up to which the last of all iterations is taken
_GAIN = 3.0  # tolerances that a step gains, below which it counts as slow
_SLOW = 3  # steps in turn that hardly gain, or fail alone, after which the search ends
_STEEPER = 100.0  # factor of the damping after a trial alone that fails
_LARGEST_DAMPING = 1e5
_NEARLY_CLOSED = 0.8  # of the wanted root of the rise, from which the last point gives the end

Predict = Callable[[Array], Array]
"""Sets of unknowns (case, unknown) to observations (case, observation)."""


@dataclass(frozen=True)
class Observations:
    """What was measured, with errors of two kinds.

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

    def whiten(self, values: Array) -> Array:
        """Values in units of their random standard deviations, (..., observation).

        Parameters
        ----------
        values : array, (..., group, member)

        Returns
        -------
        array, (..., observation)
        """
        inverse = np.linalg.inv(np.linalg.cholesky(self.random_cov))
        found = np.einsum("gij,...gj->...gi", inverse, values)
        return np.asarray(found.reshape(*values.shape[:-2], self.size))

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
    """What is fitted.

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
    largest : Array
        Largest change in one iteration, (unknown,).
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
    largest: Array
    expected: Array
    expected_std: Array
    fixed: Mapping[str, float] = field(default_factory=dict)

    def by_name(self, sets: Array) -> dict[str, Array]:
        """Sets of unknowns (case, unknown) and what is fixed as columns (case,)."""
        columns = {name: sets[:, k] for k, name in enumerate(self.names)}
        return columns | {name: np.full(len(sets), value) for name, value in self.fixed.items()}

    def one_by_name(self, value: Array) -> dict[str, float]:
        """The same of one set (unknown,)."""
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
    shared_std : Array
        What remains of these standard deviations, (source,).
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
    shared_std: Array
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
    trials : sequence of float
        Dampings that are tried together, over that of the iteration.
    tolerance : float
        Decrease of chi-square that a further step promises, below which the search ends.
    secants : bool
        Whether each step corrects the derivatives, for models that are slow. They are computed
        anew at the minimum.
    """

    def __init__(
        self,
        observed: Observations,
        unknowns: Unknowns,
        predict: Predict,
        trials: Sequence[float] = (1.0,),
        tolerance: float = CONVERGED,
        secants: bool = False,
    ) -> None:
        self.trials, self.tolerance, self.secants = trials, tolerance, secants
        self.observed, self.unknowns, self.predict = observed, unknowns, predict
        self.target = observed.whiten(observed.value)
        self.columns = observed.whiten(np.moveaxis(observed.shared, -1, 0)).T
        self.sources = self.columns.shape[1]
        axes, sizes, _ = np.linalg.svd(self.columns, full_matrices=False)
        self.axes, self.spread = axes, sizes**2
        self.known = np.isfinite(unknowns.expected_std)

    def misses(self, sets: Array) -> Array:
        """Whitened differences of the observations from each set of unknowns."""
        return np.asarray(self.target - self.observed.whiten(self.predict(sets)))

    def neighbours(self, value: Array) -> Array:
        """A set of unknowns and one beside it for each of them."""
        step = np.where(value + self.unknowns.step > self.unknowns.high, -1, 1) * self.unknowns.step
        return np.vstack([value, value + np.diag(step)])

    def expected_miss(self, value: Array) -> Array:
        """Departures from what was expected, in standard deviations."""
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
        """Search the minimum by the method of Levenberg and Marquardt.

        Returns
        -------
        Minimum

        Raises
        ------
        ModelError
            If the model has no values at the start, or no minimum was found.
        """
        unknowns = self.unknowns
        value = np.clip(unknowns.start, unknowns.low, unknowns.high)
        ((miss, jacobian),) = self._evaluate(value)
        if not np.isfinite(miss).all():
            raise ModelError(
                "The model has no film at the start of the fit. Check load and viscosity, or give "
                "another start."
            )
        first = jacobian
        damping, slow, cost, promised = _DAMPING, 0, np.inf, np.inf
        for _ in range(MOST_ITERATIONS):
            # a poor model is not bent by shared errors of many standard deviations
            inflation = self._inflation(miss, value)
            cost = self.reduced(miss, value, inflation)[0]
            state = miss, jacobian, value, inflation
            promised = self._step(*state, damping)[1]
            if promised < self.tolerance:
                return self._minimum(value, miss, self._renewed(value, jacobian, first))

            # several trials and their neighbours at once, for models that follow many sets quickly:
            # where one is better, its derivatives are there
            dampings = [damping * factor for factor in self.trials]
            steps = [self._step(*state, one)[0] for one in dampings]
            trials = [np.clip(value + step, unknowns.low, unknowns.high) for step in steps]
            found = [] if self.secants else self._evaluate(*trials)
            ends = self.misses(np.array(trials)) if self.secants else [one for one, _ in found]
            reached = [
                self.reduced(there, trial, inflation)[0] if np.isfinite(there).all() else np.inf
                for trial, there in zip(trials, ends, strict=True)
            ]
            best = int(np.argmin(reached))
            gain = cost - reached[best]
            hardly = gain >= 0 or self.secants
            slow = 0 if gain > _GAIN * self.tolerance else slow + int(hardly)
            if reached[best] < cost:
                before = value, miss
                value, miss = trials[best], ends[best]
                jacobian = (
                    self._secant(jacobian, before[1] - miss, value - before[0])
                    if self.secants
                    else found[best][1]
                )
                damping = max(dampings[best] / 3, 1e-9)
            elif damping > _LARGEST_DAMPING:
                return self._minimum(value, miss, self._renewed(value, jacobian, first))
            else:
                damping *= _STEEPER if self.secants else 10 * max(self.trials)

            # differences of a model that is solved to a tolerance promise more than they keep
            if slow == _SLOW:
                return self._minimum(value, miss, self._renewed(value, jacobian, first))
        if promised < _NEARLY:
            return self._minimum(value, miss, self._renewed(value, jacobian, first))
        raise ModelError(
            f"The fit found no minimum in {MOST_ITERATIONS} iterations: chi-square {cost:.4g} of "
            f"{self.target.size} observations. Leave one of them out of the fit: "
            f"{', '.join(unknowns.names)}."
        )

    def _secant(self, jacobian: Array, change: Array, moved: Array) -> Array:
        """Derivatives that agree with a change of the prediction (Broyden 1965).

        A step shorter than those of the derivatives leaves them, because cells that change to
        cavities make the prediction jump.
        """
        scaled = moved / self.unknowns.step
        if not (np.abs(scaled).max() > 1 and np.isfinite(jacobian).all()):
            return jacobian
        missing = change - jacobian @ moved
        return np.asarray(
            jacobian + np.outer(missing, scaled / self.unknowns.step) / (scaled @ scaled)
        )

    def _renewed(self, value: Array, jacobian: Array, first: Array) -> Array:
        """Derivatives at a set of unknowns, computed anew where secants have corrected them."""
        if not self.secants or jacobian is first:
            return jacobian
        ((_, jacobian),) = self._evaluate(value)
        return jacobian

    def _evaluate(self, *values: Array) -> list[tuple[Array, Array]]:
        """Differences at sets of unknowns, and the derivatives of the prediction there."""
        groups = [self.neighbours(value) for value in values]
        misses = np.split(self.misses(np.vstack(groups)), len(groups))
        found = []
        for value, sets, there in zip(values, groups, misses, strict=True):
            steps = np.diag(sets[1:] - value)
            found.append((there[0], np.asarray((there[0] - there[1:]) / steps[:, np.newaxis]).T))
        return found

    def _step(
        self, miss: Array, jacobian: Array, value: Array, inflation: float, damping: float
    ) -> tuple[Array, float]:
        """A damped step within the bounds, and the decrease of chi-square without damping."""
        unknowns = self.unknowns
        usable = np.nan_to_num(jacobian)
        matrix, right = self.system(miss, usable, value, inflation)
        normal, gradient = matrix.T @ matrix, matrix.T @ right

        # an unknown at its bound that would leave it is held there
        count = value.size
        held = np.zeros(normal.shape[0], dtype=bool)
        held[:count] = ((value <= unknowns.low) & (gradient[:count] < 0)) | (
            (value >= unknowns.high) & (gradient[:count] > 0)
        )
        free = ~held
        inner, pull = normal[np.ix_(free, free)], gradient[free]
        best = _solve(inner, pull)
        now = self.reduced(miss, value, inflation)[0]
        promised = float(now - right @ right + 2 * best @ pull - best @ inner @ best)
        damped = np.where(np.flatnonzero(free) < count, damping * np.diag(inner), 0.0)
        taken = np.zeros(normal.shape[0])
        taken[free] = _solve(inner + np.diag(damped), pull)
        step = taken[:count]
        step = step / max(1.0, float((np.abs(step) / unknowns.largest).max()))
        return step, promised

    def _inflation(self, miss: Array, value: Array) -> float:
        """Factor of the random errors of the greatest likelihood, at least 1."""
        freedom = max(self.target.size - self.sources - value.size, 1)
        along = self.axes.T @ miss
        rest = max(float(miss @ miss - along @ along), 0.0)

        # the likelihood with the shared errors integrated out, over the factor squared
        square = np.exp(np.linspace(0.0, _LARGEST_LOG, _INFLATIONS))[:, np.newaxis]
        unlikely = (along**2 / (square + self.spread) + np.log(square + self.spread)).sum(axis=1)
        unlikely += rest / square[:, 0] + freedom * np.log(square[:, 0])
        return float(np.sqrt(square[int(np.argmin(unlikely)), 0]))

    def _minimum(self, value: Array, miss: Array, jacobian: Array) -> Minimum:
        """The result at a set of unknowns."""
        count, inflation = value.size, self._inflation(miss, value)
        matrix, _ = self.system(miss, np.nan_to_num(jacobian), value, inflation)
        normal = matrix.T @ matrix
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        covariance = _inverse(normal / np.outer(scale, scale)) / np.outer(scale, scale)
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
            shared_std=np.sqrt(np.diag(covariance)[count:]),
            predicted=self.predict(value[np.newaxis])[0],
            residual=residual,
            jacobian=jacobian,
            inflation=inflation,
            log_likelihood=likelihood,
        )

    def profile(self, found: Minimum, which: int) -> tuple[Array, Array]:
        """Chi-square over one unknown, all others and the shared errors fitted again.

        Parameters
        ----------
        found : Minimum
        which : int
            Number of the unknown.

        Returns
        -------
        value, rise : array, (point,)
            Values of the unknown, rising, and the rise of chi-square there; the minimum is one.
        """
        (points,) = self.profiles(found, [which])
        return points

    def profiles(
        self, found: Minimum, which: list[int], targets: Sequence[float] = TARGETS
    ) -> list[tuple[Array, Array]]:
        """Profiles of several unknowns, computed together; see `profile`."""
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
        trial = np.array(sets)
        misses = self.misses(trial)
        first = [self.reduced(m, v, found.inflation)[0] for m, v in zip(misses, trial, strict=True)]
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
        misses = self.misses(again)
        second = [
            self.reduced(m, v, found.inflation)[0] for m, v in zip(misses, again, strict=True)
        ]
        least = self.reduced(self.misses(found.value[np.newaxis])[0], found.value, found.inflation)[
            0
        ]
        rise = np.fmin(first, second) - least

        curves, middle = [], len(targets) // 2
        for n, one in enumerate(which):
            part = slice(n * len(targets), (n + 1) * len(targets))
            place = np.insert(trial[part, one], middle, found.value[one])
            curves.append((place, np.insert(rise[part], middle, 0.0)))
        return curves


def _inverse(matrix: Array) -> Array:
    """Inverse of a scaled normal matrix, without the directions that nothing determines."""
    return np.asarray(np.linalg.pinv(matrix, rcond=_SINGULAR, hermitian=True))


def _solve(normal: Array, right: Array) -> Array:
    """Solution of normal equations that may be singular."""
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return np.asarray(_inverse(normal / np.outer(scale, scale)) @ (right / scale) / scale)


def interval(value: Array, rise: Array, level: float) -> tuple[float, float]:
    """Where a profile crosses a level; infinite where it does not.

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
