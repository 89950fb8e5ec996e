"""Whether the rows of the log belong to their pairs, by a film that follows the speed."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.statistics import robust_std
from erlif.pipeline.audit.rows import FARTHEST, FEW_ODD, FEWEST, ODD, SIDE, Order, shifted

# Share of the variance that the right order leaves, gain in the logarithm of the likelihood over
# the order as it is, and factor of the variances, from which another order is stated.
_LEFT, _GAIN, _BETTER = 0.1, 40.0, 3.0

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
_FLAT, _OTHER = 0.02, 0.01


def compare_film(drive: Array, levels: Array) -> Order | None:
    """The order in which the film follows the speed.

    Parameters
    ----------
    drive : array, (frame,)
        Size of the speed, over the load where it is known, by the log.
    levels : array, (frame,)
        Logarithm of the ratio, which rises with the film; NaN where it is not known.

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
    if np.nanstd(levels) < _FLAT:
        return None
    drive = drive / drive.max()
    plain = _rest_share(_speed_terms(drive), levels)
    limit = min(FARTHEST, levels.size // 4)
    orders = [Order(0, 0, True, _rest_share(_speed_terms(drive[::-1]), levels), 0.0)]
    places = np.unique(np.linspace(0, levels.size - SIDE, _PLACES).astype(int))
    for lag in (*range(-limit, 0), *range(1, limit + 1)):
        moved = shifted(drive, lag)
        for since in places[(places == 0) | (places >= SIDE)]:
            joined = np.where(np.arange(drive.size) >= since, moved, drive)
            orders.append(
                Order(lag, int(since), False, _rest_share(_speed_terms(joined), levels), 0.0)
            )
    best = min(orders, key=lambda one: one.left)
    if best.left < plain:
        # the size of a speed repeats twice a turn: what squeeze delays is late, early or reversed
        plain = min(plain, *(_rest_share(_delayed(drive, one), levels) for one in _MEMORIES))
    gain = known.sum() / 2 * math.log(max(plain, 1e-6) / max(best.left, 1e-6))
    least, better = (_GAIN_REVERSE, _BETTER_REVERSE) if best.reverse else (_GAIN, _BETTER)
    most = _LEFT_BY_SQUEEZE if best.lag < 0 else _LEFT
    if gain > least and plain > better * best.left and best.left < most:
        return best._replace(gain=float(gain))
    return None


def find_other_films(drive: Array, levels: Array) -> AnyArray:
    """Frames whose film is not that of their speed, where that of almost all others is.

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
    columns, y = _speed_terms(drive[used] / drive.max()), levels[used]
    kept = np.ones(used.size, bool)
    rest = y
    for _ in range(5):
        rest = y - columns @ np.linalg.lstsq(columns[kept], y[kept], rcond=None)[0]
        kept = np.abs(rest) <= ODD * robust_std(rest)
    few = np.count_nonzero(~kept) <= FEW_ODD * used.size
    follows = np.mean(rest[kept] ** 2) < _FOLLOWED * np.var(y[kept])
    return used[~kept & (np.abs(rest) > _OTHER)] if few and follows else np.array([], int)


def _speed_terms(drive: Array) -> Array:
    """Functions of the speed whose sum the film is taken to be, (frame, term)."""
    return np.stack([np.ones_like(drive), np.sqrt(drive), drive, drive**2], axis=1)


def _delayed(drive: Array, memory: float) -> Array:
    """The same of a film that forgets within so many frames, and what is left of its start."""
    from scipy.signal import lfilter  # slow to load

    kept = math.exp(-1 / memory)
    late = lfilter([1 - kept], [1, -kept], _speed_terms(drive), axis=0)
    return np.column_stack([late, kept ** np.arange(drive.size)])


def _rest_share(columns: Array, levels: Array) -> float:
    """Share of the variance of the film that functions of its speed leave."""
    used = np.isfinite(columns).all(axis=1) & np.isfinite(levels)
    if used.sum() < FEWEST:
        return 1.0
    columns, y = columns[used], levels[used]
    rest = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    variance = float(np.var(y))
    return float(np.mean(rest**2) / variance) if variance > 0 else 1.0
