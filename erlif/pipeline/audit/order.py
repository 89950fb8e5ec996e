"""Check that the rows of the log belong to the pairs beside them.

They do by the energy of the pulses or, where the log has none, by a film that follows the speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, list_some, warn
from erlif.core.statistics import robust_rms, robust_std
from erlif.core.units import count_of
from erlif.io.settings import SinusoidalSettings, SliderCrankSettings
from erlif.kinematics.locate import joint_speed
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.physics.joint import build_linkage

FEWEST = 16  # frames from which on an order is judged

FARTHEST = 12  # rows by which a log is taken to be late at most

SIDE = 5  # frames on either side of a place at which rows are lost, at least

# Standard deviations from which a single pair is not that of its row, and the share of such pairs.
ODD, FEW_ODD = 7.0, 0.2


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


_MOST = 3000  # frames that are compared; more would only take time


def note_order(evidence: Evidence) -> Iterator[Note]:
    """Warn of rows that belong to other pairs, by the energy of the pulses, else by the film.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    numbers, energies = evidence.numbers[:_MOST], evidence.energies
    judged = None
    if energies is not None:
        seen = evidence.light[:_MOST]
        judged = compare_energies(energies[:_MOST], seen, evidence.levels[:_MOST])
    found, odd = judged or (None, np.array([], int))
    if found is not None:
        yield _note_other_order(found, numbers, "the light of the pulses follows the energies")
    elif odd.size:
        yield warn(
            "log",
            f"{_subject(numbers[odd])} of another place or of another recording: the light is not "
            "that of the energy in the rows, or the energies are wrong. Compare numbers of frames "
            "and rows",
        )
    else:
        if judged is not None:
            yield from _note_zero(evidence)
        yield from _note_by_film(evidence, numbers, known=judged is not None)


def _note_by_film(evidence: Evidence, numbers: AnyArray, *, known: bool) -> Iterator[Note]:
    """Warn of misplaced rows by the film; if the order is `known`, of single pairs only."""
    speed, levels = evidence.logged("rocker_speed"), evidence.levels[:_MOST]
    if speed is None:
        speed = evidence.logged("sliding_speed")
    if speed is None:
        return
    load = evidence.logged("joint_load")
    drive = np.abs(speed[:_MOST]) / (1.0 if load is None else load[:_MOST] / np.median(load))
    found = None if known else compare_film(drive, levels)
    if found is not None:
        yield _note_other_order(found, numbers, "the film follows the speed")
        return
    odd = find_other_films(drive, levels)
    odd = odd[odd > 0]  # a camera keeps nothing of a pulse before its first one
    if odd.size:
        yield warn(
            "log",
            f"{_subject(numbers[odd])} of another place or of another recording, or the angles are "
            "wrong: the film does not follow the speed there. Compare numbers of frames and rows",
        )


def _note_zero(evidence: Evidence) -> Iterator[Note]:
    """Warn of an angle at which the film does not follow the speed of slider or crank pin."""
    angle, load = evidence.logged("crank_angle"), evidence.logged("joint_load")
    if angle is None:
        return
    match evidence.run.settings.mechanism:
        case SinusoidalSettings():
            period, what = 180.0, "drive"
            cure = "zero in [encoder]: the reading at mid-stroke on the way out"

            def speed(angle: Array) -> Array:
                return np.abs(np.cos(angle))
        case SliderCrankSettings() as links:
            period, what = 360.0, "crank"
            cure = "zero or direction in [encoder]; the crank is at 0 at the outer dead centre"
            speed = partial(joint_speed, build_linkage(links), crank_speed=1.0)
        case _:
            return
    weight = np.ones_like(angle) if load is None else np.median(load) / load
    radians, levels = np.radians(angle[:_MOST]), evidence.levels[:_MOST]
    off = find_zero(radians, weight[:_MOST], levels, speed=speed, period=period)
    if off is not None:
        yield warn(
            "encoder",
            f"the film follows the speed of a {what} angle {off:+.0f} deg off: speed and position "
            f"are wrong. Correct {cure}",
        )


def _subject(numbers: AnyArray) -> str:
    """Pairs as the subject of a sentence, with its verb."""
    return f"pair {numbers[0]} is" if numbers.size == 1 else f"pairs {list_some(numbers)} are"


def _note_other_order(found: Order, numbers: AnyArray, fact: str) -> Note:
    """Make the warning about an order of the rows, with the remedy."""
    if found.reverse:
        return warn(
            "log",
            f"the frames of both cameras are in reverse order: {fact} in the other one "
            f"({1 - found.left:.0%} of the variance). Number them in the order of the pulses",
        )
    start, cure = "", "Remove the rows or frames that have no partner at the start"
    if found.since:
        start = f"from pair {numbers[found.since]} on "
        cure = (
            "Pulses, frames or rows are missing: find them by the numbers of frames and rows, and "
            "leave out their partners"
        )
    return warn(
        "log",
        f"{start}the rows of the pairs stand {count_of(abs(found.lag), 'row')} "
        f"{'later' if found.lag > 0 else 'earlier'} in the log: {fact} there "
        f"({1 - found.left:.0%} of the variance). {cure}",
    )


# Pairs with a partner in another order, at least.
_PARTNERS = 8

# Least scatter of the energies: meters are no better. [1]
_SCATTER = 0.01

# Share of the variance that the right order leaves, and gain in the logarithm of the likelihood
# over the order as it is, from which another order is stated.
_LEFT, _GAIN = 0.4, 20.0

# Pairs of a like film with which one is compared.
_NEXT = 3

# Cost of a pair that is of neither order, at most; a fair one costs 0.5.
_OUTLIER = 5.0

# Difference of costs up to which an order is taken to hold for all pairs.
_ALIKE = 10.0


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
    best, least = Order(0, 0, True, 0.0), float(_cost(back, noise, spread).sum())
    for lag in filter(None, cost):
        partners = np.cumsum(np.isfinite(moved[lag])[::-1])[::-1]
        since, total = _split_orders(cost[0], cost[lag], int((partners >= _PARTNERS).sum()))
        if total < least:
            best, least = Order(lag, since, False, 0.0), total
    if float(cost[0].sum()) - least > _GAIN:
        rest = back if best.reverse else np.where(
            np.arange(seen.size) < best.since, moved[0], moved[best.lag]
        )  # fmt: skip
        left = 2 * _known_scatter(rest) ** 2 / (spread[0] ** 2 + spread[1] ** 2)
        if left < _LEFT:
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


# Share of the variance that the right order leaves, gain in the logarithm of the likelihood over
# the order as it is, and factor of the variances, from which another order is stated.
_LEFT_BY_FILM, _GAIN_BY_FILM, _BETTER = 0.1, 40.0, 3.0

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
    """Find the order of the rows in which the film follows the speed.

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
    limit = min(FARTHEST, levels.size // 4)
    orders = [Order(0, 0, True, _rest_share(_speed_terms(drive[::-1]), levels))]
    places = np.unique(np.linspace(0, levels.size - SIDE, _PLACES).astype(int))
    for lag in (*range(-limit, 0), *range(1, limit + 1)):
        moved = shifted(drive, lag)
        for since in places[(places == 0) | (places >= SIDE)]:
            joined = np.where(np.arange(drive.size) >= since, moved, drive)
            orders.append(Order(lag, int(since), False, _rest_share(_speed_terms(joined), levels)))
    best = min(orders, key=lambda one: one.left)

    plain = _share_as_it_is(drive, levels, best.left)
    gain = _gain(levels, plain, best.left)
    least, better = (_GAIN_REVERSE, _BETTER_REVERSE) if best.reverse else (_GAIN_BY_FILM, _BETTER)
    most = _LEFT_BY_SQUEEZE if best.lag < 0 else _LEFT_BY_FILM
    if gain > least and plain > better * best.left and best.left < most:
        return best
    return None


def find_zero(
    angle: Array,
    weight: Array,
    levels: Array,
    *,
    speed: Callable[[Array], Array],
    period: float,
) -> float | None:
    """Find the error of the angle of slider or crank by a film that follows the speed.

    Parameters
    ----------
    angle : array, (frame,)
        By the log. [rad]
    weight : array, (frame,)
        Of the speed: one over the load. [1]
    levels : array, (frame,)
        Logarithm of the ratio, which rises with the film; NaN where it is not known.
    speed : callable
        Angle to the size of the speed.
    period : float
        Angle after which it repeats: half a turn of a slider, whose strokes are alike. [degree]

    Returns
    -------
    float or None
        Within half a period; None where the film follows the speed of the angle as it is, a film
        that squeeze delays included, or no speed. [degree]

    Examples
    --------
    >>> def speed(angle): return np.abs(np.cos(angle))
    >>> angle = np.linspace(0, 4 * np.pi, 60)
    >>> film = np.sqrt(np.abs(np.cos(angle))) + 0.01 * np.random.default_rng(1).normal(size=60)
    >>> find_zero(angle + 0.35, np.ones(60), film, speed=speed, period=180.0)
    -20.0
    """
    known = np.isfinite(levels)
    if known.sum() < FEWEST or np.nanstd(levels) < _FLAT:
        return None
    turns = np.arange(-90, 90) * (period / 180)
    drives = speed(angle + np.radians(turns)[:, None]) * weight
    drives /= drives.max(axis=1, keepdims=True)

    # no film falls as the speed rises
    slopes = np.cov(levels[known], drives[:, known])[0, 1:]
    shares = np.array([_rest_share(_speed_terms(one), levels) for one in drives])
    shares[slopes < 0] = 1.0
    best = int(np.argmin(shares))
    left = float(shares[best])

    plain = float(shares[turns == 0][0])
    if plain < 1:
        plain = _share_as_it_is(drives[turns == 0][0], levels, left)
    clear = _gain(levels, plain, left) > _GAIN_BY_FILM and plain > _BETTER * left
    return float(turns[best]) if clear and left < _LEFT_BY_FILM else None


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
    """Terms of the film as a function of the speed, (frame, term)."""
    return np.stack([np.ones_like(drive), np.sqrt(drive), drive, drive**2], axis=1)


def _delayed(drive: Array, memory: float) -> Array:
    """Terms of a film that is correlated over `memory` frames, and the decay of its start."""
    from scipy.signal import lfilter  # slow to load

    kept = math.exp(-1 / memory)
    late = lfilter([1 - kept], [1, -kept], _speed_terms(drive), axis=0)
    return np.column_stack([late, kept ** np.arange(drive.size)])


def _share_as_it_is(drive: Array, levels: Array, best: float) -> float:
    """Share that the speed by the log leaves; beside a better one, that squeeze may delay it.

    The size of a speed repeats twice a turn: what squeeze delays looks late, early or reversed.
    """
    plain = _rest_share(_speed_terms(drive), levels)
    if best < plain:
        plain = min(plain, *(_rest_share(_delayed(drive, one), levels) for one in _MEMORIES))
    return plain


def _gain(levels: Array, plain: float, left: float) -> float:
    """Gain in the logarithm of the likelihood where a smaller share of the variance is left."""
    floor = 1e-6  # of a film without noise, which leaves nothing
    return float(np.isfinite(levels).sum() / 2 * math.log(max(plain, floor) / max(left, floor)))


def _rest_share(columns: Array, levels: Array) -> float:
    """Share of the variance of the film that the terms of the speed do not explain."""
    used = np.isfinite(columns).all(axis=1) & np.isfinite(levels)
    if used.sum() < FEWEST:
        return 1.0
    columns, y = columns[used], levels[used]
    rest = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    variance = float(np.var(y))
    return float(np.mean(rest**2) / variance) if variance > 0 else 1.0
