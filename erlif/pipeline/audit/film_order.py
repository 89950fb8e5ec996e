"""Order of the rows of the log, in which the film follows the speed."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.statistics import robust_std
from erlif.pipeline.audit.energies import FARTHEST, FEW_ODD, FEWEST, ODD, SIDE, Order, shifted

# Share of the variance that the right order leaves, gain in the logarithm of the likelihood over
# the order as it is, and factor of the variances, from which another order is stated.
LEFT, _GAIN, _BETTER = 0.1, 40.0, 3.0

# Gain and factor for the reverse order, which is a single one.
_GAIN_REVERSE, _BETTER_REVERSE = 15.0, 2.0

# The share where the film follows its speed later, as squeeze lets it.
_LEFT_BY_SQUEEZE = 0.005

# Frames by which squeeze may delay the film of a speed.
_MEMORIES = np.geomspace(0.4, 25, 24)

_PLACES = 25  # places at which lost rows are sought

# Share of the variance of the film that its speed may leave where single pairs are judged by it.
_FOLLOWED = 0.03

# Standard deviation of the logarithm of the ratio below which no film changes, and difference of a
# pair from which its film is another one.
FLAT, _OTHER = 0.02, 0.01


def compare_film(drive: Array, levels: Array, *, size: Array | None = None) -> Order | None:
    """Find the order of the rows in which the film follows the speed.

    Parameters
    ----------
    drive : array, (frame,)
        Size of the speed, over the load where it is known, by the log.
    levels : array, (frame,)
        Logarithm of the ratio, which rises with the film; NaN where it is not known.
    size : array, (frame,), optional
        Size of the speed alone: not every film follows the load of its log.

    Returns
    -------
    Order or None
        None where the film follows the speed of its own row best, or follows no speed.

    Examples
    --------
    >>> turn = np.arange(60) * 2 * np.pi / 60
    >>> speed = np.abs(np.sin(turn)) * (1 + 0.3 * np.cos(turn))
    >>> film = np.sqrt(speed) + 0.01 * np.random.default_rng(1).normal(size=60)
    >>> compare_film(speed, np.roll(film, 3)).lag
    -3
    """
    known = np.isfinite(levels)
    if known.sum() < FEWEST or not np.ptp(drive) > 0.2 * drive.max():
        return None
    if np.nanstd(levels) < FLAT:
        return None
    drive = drive / drive.max()
    limit = min(FARTHEST, levels.size // 4)
    orders = [Order(0, 0, True, rest_share(speed_terms(drive[::-1]), levels))]
    places = np.unique(np.linspace(0, levels.size - SIDE, _PLACES).astype(int))
    for lag in (*range(-limit, 0), *range(1, limit + 1)):
        moved = shifted(drive, lag)
        for since in places[(places == 0) | (places >= SIDE)]:
            joined = np.where(np.arange(drive.size) >= since, moved, drive)
            orders.append(Order(lag, int(since), False, rest_share(speed_terms(joined), levels)))
    best = min(orders, key=lambda one: one.left)

    plain = share_as_it_is(drive, levels, best.left)
    if size is not None:
        plain = min(plain, rest_share(speed_terms(size / size.max()), levels))
    bounds = {"gain": _GAIN_REVERSE, "factor": _BETTER_REVERSE} if best.reverse else {}
    most = _LEFT_BY_SQUEEZE if best.lag < 0 else LEFT
    return best if best.left < most and is_better(levels, plain, best.left, **bounds) else None


def find_other_films(drive: Array, levels: Array) -> AnyArray:
    """Find frames whose film does not follow the speed, where almost all others do.

    Parameters
    ----------
    drive, levels : array, (frame,)
        As for `compare_film`.

    Returns
    -------
    array of int
    """
    used = np.flatnonzero(np.isfinite(levels))
    if used.size < FEWEST or not np.ptp(drive) > 0.2 * drive.max():
        return np.array([], int)
    columns, y = speed_terms(drive[used] / drive.max()), levels[used]
    kept = np.ones(used.size, bool)
    rest = y
    for _ in range(5):
        rest = y - columns @ np.linalg.lstsq(columns[kept], y[kept], rcond=None)[0]
        kept = np.abs(rest) <= ODD * robust_std(rest)
    few = np.count_nonzero(~kept) <= FEW_ODD * used.size
    follows = np.mean(rest[kept] ** 2) < _FOLLOWED * np.var(y[kept])
    return used[~kept & (np.abs(rest) > _OTHER)] if few and follows else np.array([], int)


def speed_terms(drive: Array) -> Array:
    """Terms of the film as a function of a speed over its largest, (frame, term). [1]"""
    return np.stack([np.ones_like(drive), np.sqrt(drive), drive, drive**2], axis=1)


def _delayed(drive: Array, memory: float) -> Array:
    """Terms of a film that is correlated over `memory` frames, and the decay of its start."""
    from scipy.linalg import solve_banded  # lfilter loads scipy.stats

    kept = math.exp(-1 / memory)
    before = np.full((2, drive.size), [[1.0], [-kept]])
    late = solve_banded((1, 0), before, (1 - kept) * speed_terms(drive))
    return np.column_stack([late, kept ** np.arange(drive.size)])


def share_as_it_is(drive: Array, levels: Array, best: float) -> float:
    """Share that the speed by the log leaves; beside a better one, that squeeze may delay it. [1]

    `drive` and `levels` are as for `compare_film`; `best` is the smallest share of other orders.

    The size of a speed repeats twice a turn: what squeeze delays looks late, early or reversed.
    """
    plain = rest_share(speed_terms(drive), levels)
    if best < plain:
        plain = min(plain, *(rest_share(_delayed(drive, one), levels) for one in _MEMORIES))
    return plain


def is_better(
    levels: Array, plain: float, left: float, *, gain: float = _GAIN, factor: float = _BETTER
) -> bool:
    """Whether a share of the variance that is left is clearly smaller than the plain one.

    It is by the gain in the logarithm of the likelihood, and by the factor of the shares.
    """
    floor = 1e-6  # of a film without noise, which leaves nothing
    more = np.isfinite(levels).sum() / 2 * math.log(max(plain, floor) / max(left, floor))
    return bool(more > gain and plain > factor * left)


def rest_share(columns: Array, levels: Array) -> float:
    """Share of the variance of the levels, (frame,), that columns, (frame, term), leave. [1]"""
    used = np.isfinite(columns).all(axis=1) & np.isfinite(levels)
    if used.sum() < FEWEST:
        return 1.0
    columns, y = columns[used], levels[used]
    rest = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    variance = float(np.var(y))
    return float(np.mean(rest**2) / variance) if variance > 0 else 1.0
