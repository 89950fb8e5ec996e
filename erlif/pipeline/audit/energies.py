"""Order of the rows of the log, in which the logged energies agree with the light of the pulses."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.statistics import robust_rms, robust_std

FEWEST = 16  # frames from which on an order is judged

FARTHEST = 12  # rows by which a log is taken to be late at most

SIDE = 5  # frames on either side of a place at which rows are lost, at least

# Standard deviations from which a single pair is not that of its row, and the share of such pairs.
ODD, FEW_ODD = 7.0, 0.2

# Pairs with a partner in another order, at least.
_PARTNERS = 8

# Least scatter of the energies: meters are no better. [1]
_SCATTER = 0.01

# Share of the variance that the right order leaves, and gain in the logarithm of the likelihood
# over the order as it is, from which another order is stated; the share where the gain over all
# others is as large.
_LEFT, _GAIN, _LEFT_ALONE = 0.4, 20.0, 0.7

# Pairs of a like film with which one is compared.
_NEXT = 3

# Cost of a pair that is of neither order, at most; a fair one costs 0.5.
_OUTLIER = 5.0

# Difference of costs up to which an order is taken to hold for all pairs.
_ALIKE = 10.0


class Order(NamedTuple):
    """Order of the rows of the log relative to the pairs.

    Attributes
    ----------
    lag : int
        The row of pair k is row k + lag of the log.
    since : int
        First pair of which this holds; those before have their own rows.
    reverse : bool
        Whether the pairs stand in reverse order.
    left : float
        Share of the variance that this order leaves.
    """

    lag: int
    since: int
    reverse: bool
    left: float


def shifted(values: Array, lag: int) -> Array:
    """Value k + lag in the place of value k.

    Parameters
    ----------
    values : array, (frame,)
    lag : int

    Returns
    -------
    array, (frame,)
        NaN beyond the ends.

    Examples
    --------
    >>> shifted(np.array([1.0, 2.0, 3.0]), 1)
    array([ 2.,  3., nan])
    """
    moved = np.full(values.size, np.nan)
    inside = np.arange(max(-lag, 0), min(values.size - lag, values.size))
    moved[inside] = values[inside + lag]
    return moved


def compare_energies(
    energies: Array, light: Array, levels: Array | None = None
) -> tuple[Order | None, AnyArray] | None:
    """Find the order of the rows in which the logged energies agree with the light.

    Parameters
    ----------
    energies : array, (frame,)
        Of the log, over their mean. [1]
    light : array, (frame,)
        Of the pulses by the light of their film; NaN where it is not known. [1]
    levels : array, (frame,), optional
        Logarithm of the ratio, by which the film was found. Where a wall reflects, or there is
        light that is not film, all pairs of a film are off alike.

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
    orders = [(float(_cost(back, noise, spread).sum()), Order(0, 0, True, 0.0))]
    for lag in filter(None, cost):
        partners = np.cumsum(np.isfinite(moved[lag])[::-1])[::-1]
        since, total = _split_orders(cost[0], cost[lag], int((partners >= _PARTNERS).sum()))
        orders.append((total, Order(lag, since, False, 0.0)))
    (least, best), (second, _) = sorted(orders)[:2]
    if float(cost[0].sum()) - least > _GAIN:
        rest = back if best.reverse else np.where(
            np.arange(seen.size) < best.since, moved[0], moved[best.lag]
        )  # fmt: skip
        left = 2 * _known_scatter(rest) ** 2 / (spread[0] ** 2 + spread[1] ** 2)
        if left < (_LEFT_ALONE if second - least > _GAIN else _LEFT):
            return best._replace(left=left), np.array([], int)
    if _known_scatter(moved[0]) > spread[0]:
        return None  # the energies have nothing to do with the light

    rest = moved[0] - np.nanmedian(moved[0])
    most = ODD * max(_known_scatter(rest), noise)
    odd = np.flatnonzero((np.abs(rest) > most) & known)
    if levels is not None:
        odd = odd[[_off_its_like(rest, levels, int(k)) > most for k in odd]]
    return None, odd if odd.size <= FEW_ODD * known.sum() else np.array([], int)


def _off_its_like(rest: Array, levels: Array, number: int) -> float:
    """Least distance of a pair's difference from those of the pairs with a like film."""
    away = np.where(np.isfinite(rest), np.abs(levels - levels[number]), np.nan)
    away[number] = np.nan
    return float(np.abs(rest[np.argsort(away)[:_NEXT]] - rest[number]).min())


def _known_scatter(rest: Array) -> float:
    """Robust standard deviation of the finite values; infinite if they are few."""
    some = rest[np.isfinite(rest)]
    return robust_std(some) if some.size >= FEWEST / 2 else math.inf


def _quartile_noise(rest: Array) -> float:
    """Standard deviation by the smallest quarter, where only a part of the differences is noise."""
    some = np.abs(rest[np.isfinite(rest)])
    return float(np.quantile(some, 0.25)) / 0.3186 if some.size >= FEWEST / 2 else math.inf


def _cost(rest: Array, noise: float, spread: tuple[float, float]) -> Array:
    """Negative log likelihood of each difference, (frame,).

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
    """First pair from which on another order costs less, and the total cost."""
    before = np.concatenate([[0.0], np.cumsum(own)])
    after = np.concatenate([np.cumsum(other[::-1])[::-1], [0.0]])
    total = before + after
    places = np.concatenate([[0], np.arange(SIDE, max(last, SIDE))])
    best = int(places[np.argmin(total[places])])
    if total[0] - total[best] < _ALIKE:
        best = 0
    return best, float(total[best])
