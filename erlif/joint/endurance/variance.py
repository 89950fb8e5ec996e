"""Variance of the noise of a stage, of which the other stages know a part. Smyth (2004)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import digamma, polygamma

_FEWEST = 2  # other stages that show how unlike stages are
_NEWTON_STEPS = 8


@dataclass(frozen=True)
class Spread:
    """A variance, and the number of independent values that it is worth.

    Attributes
    ----------
    variance : float
        Variance of the noise. [1]
    freedom : float
        Degrees of freedom; 0 where nothing is known.
    """

    variance: float
    freedom: float

    @property
    def power(self) -> float:
        """The sum of squares of these values."""
        return self.variance * self.freedom


UNKNOWN = Spread(1.0, 0.0)
"""Nothing is known of the variance."""


def pool_spreads(spreads: Sequence[Spread]) -> list[Spread]:
    """Estimate the variance of each stage from the other stages.

    Variances of stages scatter about a common one. How much they do follows from the scatter of
    their logarithms beyond that of few samples (Smyth 2004), and gives the degrees of
    freedom that the others are worth: all of theirs where the stages are alike, few where not.

    Parameters
    ----------
    spreads : sequence of Spread
        Variance of each stage.

    Returns
    -------
    list of Spread
        For each stage that of the others; `UNKNOWN` where there are fewer than two of them.

    Examples
    --------
    Stages that are alike are worth all of their samples, unlike ones hardly any:

    >>> alike = pool_spreads([Spread(2.0, 50.0)] * 4)[0]
    >>> print(f"{alike.variance:.2f} of {alike.freedom:.0f}")
    2.03 of 150
    >>> unlike = pool_spreads([Spread(2.0**k, 50.0) for k in range(-4, 5, 2)])[0]
    >>> unlike.freedom < 5
    True
    """
    pooled = []
    for place in range(len(spreads)):
        others = [spread for k, spread in enumerate(spreads) if k != place]
        pooled.append(combine_spreads(others) if len(others) >= _FEWEST else UNKNOWN)
    return pooled


def combine_spreads(spreads: Sequence[Spread]) -> Spread:
    """Estimate the common variance of stages, worth less the more unlike they are."""
    half = np.array([spread.freedom / 2 for spread in spreads])
    logs = np.log([spread.variance for spread in spreads]) - digamma(half) + np.log(half)
    unlike = float(np.var(logs, ddof=1) - np.mean(polygamma(1, half)))

    # stages that are quite alike know no more than their samples do
    most = float(2 * half.sum())
    freedom = min(2 * _inverse_trigamma(unlike), most) if unlike > 0 else most
    level = float(np.mean(logs) + digamma(freedom / 2) - np.log(freedom / 2))
    return Spread(float(np.exp(level)), freedom)


def _inverse_trigamma(value: float) -> float:
    """By Newton's method on its reciprocal, which converges from any side (Smyth 2004)."""
    x = 0.5 + 1 / value
    for _ in range(_NEWTON_STEPS):
        trigamma = float(polygamma(1, x))
        x += trigamma * (1 - trigamma / value) / float(polygamma(2, x))
    return x
