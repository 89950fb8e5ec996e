"""Two designs compared by their loads at failure, of few runs, some of which survive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.special import log_ndtr

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import EnduranceError
from erlif.joint.endurance.analysis import FailureLoad

# Scatter of the logarithm of the load that is possible: no bearings are more alike. [1]
SCATTERS = (0.01, 2.0)

_SCATTER_STEPS = 60
_STEP = 0.3  # of a scatter: step of the grid of the median
_FINEST = 0.004
_REACH = 4.0  # scatters beyond the runs, but at least
_LEAST_REACH = 0.7
_MOST_REACH = 3.0
_QUANTILES = (0.025, 0.5, 0.975)
_MOST_PERMUTATIONS = 20_000
_TIE = 1e-9
_DECIMALS = 9  # of a sum of log-rank scores


@dataclass(frozen=True)
class DesignComparison:
    """The load that a second design carries over that of a first.

    Attributes
    ----------
    first : str
        Name of the first design.
    second : str
        Name of the second design.
    runs : tuple[int, int]
        Number of runs of both.
    failures : tuple[int, int]
        Number of failures among them.
    ratio : float
        Median load at failure of the second over that of the first; NaN where a design has no
        failure. [1]
    low : float
        Start of its 95 % interval. [1]
    high : float
        End of its 95 % interval. [1]
    probability : float
        Probability that the second design carries more. [1]
    log_rank : float
        Two-sided p-value of the log-rank test by permutation of the designs. [1]
    least_p : float
        The smallest p-value that so few runs can give. [1]
    model : str
        "lognormal" or "weibull".
    undecided : tuple[int, int]
        Runs of both in which galling cannot be excluded; they count as bearings that carry more
        than the stage before.
    if_failed : tuple[float, float, float]
        Low, ratio and high where each of these is a failure at the load of its doubtful stage; NaN
        without any, or where a design still has no failure. [1]
    """

    first: str
    second: str
    runs: tuple[int, int]
    failures: tuple[int, int]
    ratio: float
    low: float
    high: float
    probability: float
    log_rank: float
    least_p: float
    model: str
    undecided: tuple[int, int] = (0, 0)
    if_failed: tuple[float, float, float] = (np.nan, np.nan, np.nan)


def compare_designs(
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    *,
    names: tuple[str, str] = ("first", "second"),
    model: Literal["lognormal", "weibull"] = "lognormal",
) -> DesignComparison:
    """Compare the loads at failure of two designs.

    The load that a bearing can carry lies between the last stage that it survived and the load at
    which it failed; of a bearing that survived, above its highest load. Its logarithm has a normal
    or a smallest-extreme-value distribution (Weibull), with one scatter for both designs. The
    prior is flat in the median and in the logarithm of the scatter; for loads that are known
    exactly its intervals are those of the classical pivot, at any number of runs.

    Parameters
    ----------
    first, second : sequence of FailureLoad
        Runs of both designs, two or more of each.
    names : (str, str)
        Names of the designs.
    model : str
        "lognormal" or "weibull".

    Returns
    -------
    DesignComparison

    Raises
    ------
    EnduranceError
        If a design has fewer than two runs.

    Examples
    --------
    Three uncut bearings of Farzaneh (2002) failed at 28, 28 and 24 klbf after 24, 24 and 20; of
    three undercut ones, all loads invented, two failed at 36 and one survived 36:

    >>> uncut = [FailureLoad(28.0, 0.1, 24.0, True, 6)] * 2
    >>> uncut += [FailureLoad(24.0, 0.1, 20.0, True, 5)]
    >>> undercut = [FailureLoad(36.0, 0.1, 32.0, True, 8)] * 2
    >>> undercut += [FailureLoad(36.0, 0.1, 36.0, False, 8)]
    >>> found = compare_designs(uncut, undercut)
    >>> print(f"{found.ratio:.2f} ({found.low:.2f} to {found.high:.2f}), p = {found.log_rank:.2f}")
    1.46 (1.20 to 1.85), p = 0.10
    """
    for name, runs in zip(names, (first, second), strict=True):
        if len(runs) < 2:
            raise EnduranceError(
                f"Expected at least two runs of the design {name}; got {len(runs)}. Give more logs."
            )
    p_value, least = _log_rank(first, second)
    failures = (sum(run.failed for run in first), sum(run.failed for run in second))
    ratio = low = high = probability = float("nan")
    if min(failures) > 0:
        low, ratio, high, probability = _posterior(first, second, model)
    undecided = (sum(not run.decided for run in first), sum(not run.decided for run in second))
    if_failed = (np.nan, np.nan, np.nan)
    one, two = _as_failures(first), _as_failures(second)
    if any(undecided) and all(any(run.failed for run in runs) for runs in (one, two)):
        if_failed = _posterior(one, two, model)[:3]
    return DesignComparison(
        first=names[0],
        second=names[1],
        runs=(len(first), len(second)),
        failures=failures,
        ratio=ratio,
        low=low,
        high=high,
        probability=probability,
        log_rank=p_value,
        least_p=least,
        model=model,
        undecided=undecided,
        if_failed=if_failed,
    )


# ratio

_Runs = Sequence[FailureLoad]


def _as_failures(runs: _Runs) -> list[FailureLoad]:
    """Replace undecided runs by failures at the load of the doubtful stage."""
    return [
        run
        if run.decided
        else replace(run, failed=True, survived=run.load, load=max(run.next_load, run.load))
        for run in runs
    ]


def _posterior(first: _Runs, second: _Runs, model: str) -> tuple[float, float, float, float]:
    """Quantiles of the ratio, and the probability that it is above 1."""
    bounds = [_bounds(runs) for runs in (first, second)]
    known = np.concatenate([np.log(one[np.isfinite(one) & (one > 0)]) for one in bounds])

    # the difference of the medians on one grid for all scatters
    reach = 2 * _MOST_REACH + float(np.ptp(known))
    half = int(np.ceil(reach / _FINEST))
    differences = _FINEST * np.arange(-half, half + 1)
    densities, weights = [], []
    for scatter in np.geomspace(*SCATTERS, _SCATTER_STEPS):
        step = max(_STEP * scatter, _FINEST)
        margin = min(max(_REACH * scatter, _LEAST_REACH), _MOST_REACH)
        places = np.arange(known.min() - margin, known.max() + margin, step)
        one, other = (_log_likelihood(b, places, scatter, model) for b in bounds)
        left, right = np.exp(one - one.max()), np.exp(other - other.max())
        together = np.correlate(right, left, mode="full") * step
        shift = step * (np.arange(together.size) - (places.size - 1))
        densities.append(np.interp(differences, shift, together, left=0.0, right=0.0))
        weights.append(one.max() + other.max())

    # the prior is flat in the logarithm of the scatter, and so is its grid
    density = np.exp(np.array(weights) - max(weights)) @ np.array(densities)
    # a place of the grid stands for half a step on both sides
    cumulative = (np.cumsum(density) - density / 2) / density.sum()
    low, middle, high = np.exp(np.interp(_QUANTILES, cumulative, differences))
    return low, middle, high, 1 - float(np.interp(0.0, differences, cumulative))


def _bounds(runs: _Runs) -> Array:
    """Load that each bearing carried, and load that it did not carry: (run, 2).

    A bearing that fails at a load that it carried before, as bolts relax or the load is lowered,
    fails at exactly this load: an interval would be empty.
    """
    return np.array(
        [
            (min(run.survived, run.load), run.load) if run.failed else (run.load, np.inf)
            for run in runs
        ],
        float,
    )


def _log_likelihood(bounds: Array, places: Array, scatter: float, model: str) -> Array:
    """Logarithm of the likelihood of medians on the logarithmic scale."""
    total = np.zeros(places.size)
    for low, high in bounds:
        upper = (np.log(high) - places) / scatter if np.isfinite(high) else np.inf
        lower = (np.log(low) - places) / scatter if low > 0 else -np.inf
        total += _log_probability(lower, upper, model)
        if high - low < _TIE * high:
            total -= np.log(scatter)  # a density, not a probability
    return total


def _log_probability(lower: AnyArray | float, upper: AnyArray | float, model: str) -> Array:
    """Logarithm of the probability between two standardised loads; equal ones are exact."""
    lower, upper = np.broadcast_arrays(lower, upper)
    with np.errstate(invalid="ignore"):
        exact = np.abs(upper - lower) < _TIE
    tiny = np.finfo(float).tiny
    if model == "lognormal":
        density = -0.5 * upper**2
        # the side of the tail on which both are small
        flip = lower > 0
        a, b = np.where(flip, -upper, lower), np.where(flip, -lower, upper)
        between = log_ndtr(b) + np.log(-np.expm1(np.minimum(log_ndtr(a) - log_ndtr(b), -tiny)))
    else:
        # log(2) puts the median at zero
        x = np.exp(np.minimum(np.where(np.isfinite(lower), lower, -700.0), 700.0)) * np.log(2)
        y = np.exp(np.minimum(np.where(np.isfinite(upper), upper, 700.0), 700.0)) * np.log(2)
        density = upper - y
        between = -x + np.log(-np.expm1(np.minimum(x - y, -tiny)))
    return np.where(exact, density, between)


# log-rank test


def _log_rank(first: _Runs, second: _Runs) -> tuple[float, float]:
    """Two-sided p-value by permutation, and the smallest one possible."""
    from scipy.stats import permutation_test  # slow to load

    runs = [*first, *second]
    loads = np.array([run.load for run in runs])
    failed = np.array([run.failed for run in runs])
    scores = np.split(_scores(loads, failed), [len(first)])

    # rounded, so that equal sums of scores in another order are equal
    test = permutation_test(
        scores,
        lambda one, _, axis: np.round(np.abs(one.sum(axis=axis)), _DECIMALS),
        n_resamples=_MOST_PERMUTATIONS,
        alternative="greater",
        rng=np.random.default_rng(0),
    )
    sums = test.null_distribution
    return float(test.pvalue), float(np.mean(sums == sums.max()))


def _scores(loads: Array, failed: AnyArray) -> Array:
    """Log-rank scores: failures less their expected number among the runs still at risk."""
    scores = failed.astype(float)
    for load in np.unique(loads[failed]):
        at_risk = loads >= load
        scores[at_risk] -= np.sum(failed & (loads == load)) / at_risk.sum()
    return scores
