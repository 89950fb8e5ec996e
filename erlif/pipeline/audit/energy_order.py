"""Whether the rows of the log belong to their pairs, by the energy of the pulses."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.statistics import robust_rms, robust_std
from erlif.pipeline.audit.rows import FARTHEST, FEW_ODD, FEWEST, ODD, SIDE, Order, shifted

# Pairs with a partner in another order, at least.
_PARTNERS = 8

# Least scatter of the energies: meters are no better. [1]
_SCATTER = 0.01

# Share of the variance that the right order leaves, and gain in the logarithm of the likelihood
# over the order as it is, from which another order is stated.
_LEFT, _GAIN = 0.4, 20.0

# Cost of a pair that is of neither order, at most; a fair one costs 0.5.
_OUTLIER = 5.0

# Difference of costs up to which an order is taken to hold for all pairs.
_ALIKE = 10.0


def compare_energies(energies: Array, light: Array) -> tuple[Order | None, AnyArray] | None:
    """The order in which the energies of a log are those of the light.

    Parameters
    ----------
    energies : array, (frame,)
        Of the log, over their mean. [1]
    light : array, (frame,)
        Of the pulses by the light of their film; NaN where it is not known. [1]

    Returns
    -------
    order : Order or None
        None where rows and pairs are in order.
    odd : array of int
        Pairs whose energy is not that of their row.

    Or None where energies and light are not related in any order.

    Examples
    --------
    >>> energy = 1 + 0.03 * np.random.default_rng(1).normal(size=50)
    >>> order, odd = compare_energies(energy, np.roll(energy, 2))
    >>> order.lag
    -2
    """
    known = np.isfinite(light) & (light > 0) & (energies > 0)
    if known.sum() < FEWEST:
        return None
    logged = _without_trend(np.log(np.where(energies > 0, energies, 1.0)))
    seen = _without_trend(np.log(np.where(known, light, np.nan)))
    spread = robust_rms(seen[np.isfinite(seen)]), robust_std(logged)
    if min(spread) < _SCATTER:
        return None

    # the noise of both is that of the order in which they agree best
    limit = min(FARTHEST, logged.size // 4)
    moved = {lag: seen - shifted(logged, lag) for lag in range(-limit, limit + 1)}
    back = seen - logged[::-1]
    noise = max(min(_quartile_noise(rest) for rest in (*moved.values(), back)), _SCATTER / 2)
    cost = {lag: _cost(rest, noise, spread) for lag, rest in moved.items()}
    best, least = Order(0, 0, True, 0.0, 0.0), float(_cost(back, noise, spread).sum())
    for lag in filter(None, cost):
        partners = np.cumsum(np.isfinite(moved[lag])[::-1])[::-1]
        since, total = _split_orders(cost[0], cost[lag], int((partners >= _PARTNERS).sum()))
        if total < least:
            best, least = Order(lag, since, False, 0.0, 0.0), total
    gain = float(cost[0].sum()) - least
    if gain > _GAIN:
        rest = back if best.reverse else np.where(
            np.arange(seen.size) < best.since, moved[0], moved[best.lag]
        )  # fmt: skip
        left = 2 * _known_scatter(rest) ** 2 / (spread[0] ** 2 + spread[1] ** 2)
        if left < _LEFT:
            return best._replace(left=left, gain=gain), np.array([], int)
    if _known_scatter(moved[0]) > spread[0]:
        return None  # the energies have nothing to do with the light

    off = np.abs(moved[0] - np.nanmedian(moved[0])) > ODD * max(_known_scatter(moved[0]), noise)
    odd = np.flatnonzero(off & known)
    return None, odd if odd.size <= FEW_ODD * known.sum() else np.array([], int)


def _known_scatter(rest: Array) -> float:
    """Robust standard deviation of the known values; infinite where they are few."""
    some = rest[np.isfinite(rest)]
    return robust_std(some) if some.size >= FEWEST / 2 else math.inf


def _quartile_noise(rest: Array) -> float:
    """The same where only a part of the differences is noise: by the smallest quarter of them."""
    some = np.abs(rest[np.isfinite(rest)])
    return float(np.quantile(some, 0.25)) / 0.3186 if some.size >= FEWEST / 2 else math.inf


def _cost(rest: Array, noise: float, spread: tuple[float, float]) -> Array:
    """Less the logarithm of the likelihood of each difference, (frame,).

    A difference without a partner costs what one of strangers does, a far one no more than an
    outlier.
    """
    apart = (spread[0] ** 2 + spread[1] ** 2) / (2 * noise**2)
    squares = np.where(np.isfinite(rest), rest**2 / (2 * noise**2), min(apart, _OUTLIER / 2))
    return np.asarray(np.minimum(squares, _OUTLIER))


def _without_trend(values: Array) -> Array:
    """Values less the median of their surroundings."""
    around = np.pad(values, 4, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(around, 9)
    with np.errstate(invalid="ignore"):
        usual = np.array(
            [np.median(w[np.isfinite(w)]) if np.isfinite(w).any() else 0 for w in windows]
        )
    return np.asarray(values - usual)


def _split_orders(own: Array, other: Array, last: int) -> tuple[int, float]:
    """The pair up to `last` from which on another order costs less, and what both cost together."""
    before = np.concatenate([[0.0], np.cumsum(own)])
    after = np.concatenate([np.cumsum(other[::-1])[::-1], [0.0]])
    total = before + after
    places = np.concatenate([[0], np.arange(SIDE, max(last, SIDE))])
    best = int(places[np.argmin(total[places])])
    if total[0] - total[best] < _ALIKE:
        best = 0
    return best, float(total[best])
