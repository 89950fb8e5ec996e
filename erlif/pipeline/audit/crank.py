"""Readings of the encoder against a crank that turns evenly: odd readings, slips, wrong links."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import ModelError
from erlif.core.notes import Note, list_some, warn
from erlif.core.statistics import neighbours_of, robust_std
from erlif.io.ingest import Run
from erlif.io.settings import CrankRockerSettings
from erlif.kinematics import choose_link
from erlif.models.mechanism import crank_for_swing
from erlif.pipeline.audit.evidence import Evidence
from erlif.pipeline.audit.log import signed_steps
from erlif.pipeline.physics.joint import build_linkage

_FEWEST = 12  # readings from which on they are compared with an even turn

_BLOCK = 60  # readings of a fit at least: an error of the speed adds up over the turns

_MOST = 3000  # readings that are compared; more would only take time

_LARGEST_REST = 0.05  # of the swing that a crank at constant speed may leave: it turns unevenly

# Robust standard deviations from which a reading is odd or the encoder has slipped.
_ODD = 8.0

# Size of both, over the swing: more than times of a millisecond leave. [1]
_LEAST_ODD = 0.008

# Deviation of the swing that is reported, and its standard deviations: lengths are known to half a
# per cent. [1]
_SWING, _SIGNIFICANT = 0.007, 5.0

_WHOLE = 0.8  # of a turn, from which on both ends of the swing are near

# Largest distance of ticks that an encoder has [degree], and what a log rounds off of one. [1]
_COARSE, _OFF_TICK = 2.0, 0.1

_SMALL = 0.2  # of the swing of the linkage, below which the unit of the readings is wrong

_ROOM = 0.3  # by which the neighbours of an odd reading may depart from half of it


def note_crank(evidence: Evidence) -> Iterator[Note]:
    """Warn of odd readings, slips of the encoder, and a swing unlike that of the linkage.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    run, located = evidence.run, evidence.located
    if run.settings.linkage is None or "encoder_angle" not in located:
        return
    reading = np.asarray(located.encoder_angle.values, float)[:_MOST]
    if reading.size < _FEWEST or evidence.mounting:
        return
    if "time" not in run.log:
        yield from _note_odd_steps(reading)
        return
    if small := list(_note_small_swing(run, reading)):
        yield from small
        return

    time = np.asarray(run.log["time"].values, float)[:_MOST]
    block = max(_BLOCK, 2 * int(located.trigger.max() + 1))
    visible = 1.5 * _tick(reading)  # an encoder of few ticks leaves the even turn by one of them
    odd, slips, most = [], [], 0.0
    first: _Turn | None = None
    for start in range(0, max(reading.size - _FEWEST, 1), block):
        rows = slice(start, start + block)
        fit = _fit_turn(run, evidence, time[rows], reading[rows])
        if fit is None:
            continue
        first = first or fit
        single = find_odd(fit.rest, fit.swing)
        even = np.delete(np.arange(fit.rest.size), single)
        rest = np.interp(np.arange(fit.rest.size), even, fit.rest[even])
        slipped = find_slips(rest, fit.swing)
        slips += [(start + k, size) for k, size in slipped if abs(size) > visible]

        # a slip spoils the even turn, by no more than its size
        usual = max((abs(size) for _, size in slipped), default=0.0)
        single = single[np.abs(fit.rest[single]) > max(2 * usual, visible)]
        odd += [start + int(k) for k in single]
        most = max(most, float(np.abs(fit.rest[single]).max(initial=0.0)))
    if odd:
        yield _warn_of_readings(odd, most)
    for row, size in slips[:1]:
        yield warn(
            "encoder",
            f"it slipped by {size:+.2f} deg at row {row}, or rows or pulses are missing there: "
            "the readings leave the turn of an even crank. Fasten it, and correct the readings or "
            "process the parts as two runs",
        )
    if first is not None and not odd and not slips:
        yield from _note_swing(run, first)


def _tick(reading: Array) -> float:
    """Distance of the ticks of which all readings are multiples; 0 if none is seen. [degree]"""
    tick = float(np.diff(np.unique(reading.round(6))).min(initial=360.0))
    ticks = (reading - reading[0]) / tick
    whole = bool((np.abs(ticks - ticks.round()) < _OFF_TICK).all())
    return tick if whole and tick < _COARSE else 0.0


def _note_small_swing(run: Run, reading: Array) -> Iterator[Note]:
    """Warn of readings that swing by a fraction of the linkage's swing in a turn or more."""
    links, encoder = run.settings.linkage, run.settings.encoder
    mounted = "rocker" if encoder is None else encoder.mounted_on
    if links is None or mounted == "crank":
        return
    turns = links.crank_speed * float(np.ptp(run.log["time"].values)) / (2 * math.pi)
    low, high = np.degrees(choose_link(build_linkage(links), mounted).limits)
    seen = float(np.ptp(reading))
    if turns > _WHOLE and 0 < seen < _SMALL * (high - low):
        yield warn(
            "encoder",
            f"its reading swings by {seen:.3g} deg in {turns:.1f} turns of the crank, the "
            f"{mounted} of [mechanism] by {high - low:.2f} deg, {(high - low) / seen:.0f} times as "
            'far. Correct the unit, units = { angle = "rad" } or "turn" in [encoder], or '
            "ticks_per_turn",
        )


class _Turn(NamedTuple):
    """Readings compared with a crank that turns at constant speed."""

    rest: Array  # what it leaves, (frame,) [degree]
    swing: float  # of the link: a turn of a crank [degree]
    size: float  # swing of the readings over that of the link; NaN on a crank [1]
    size_std: float


def _fit_turn(run: Run, evidence: Evidence, time: Array, reading: Array) -> _Turn | None:
    """Compare readings with an even crank; None where it turns too unevenly for that."""
    links, encoder = run.settings.linkage, run.settings.encoder
    assert links is not None
    since = time - time[0]
    if time.size < _FEWEST or not (np.diff(time) > 0).all():
        return None
    if encoder is not None and encoder.mounted_on == "crank":
        return _fit_crank(since, reading)

    carrier = choose_link(build_linkage(links), "rocker" if encoder is None else encoder.mounted_on)
    start = int(np.searchsorted(run.log["time"].values, time[0]))
    crank = np.radians(evidence.located.crank_angle.values[start : start + time.size])
    low, high = np.degrees(carrier.limits)
    sign = -1.0 if evidence.located.encoder_angle.attrs.get("direction") == "falling" else 1.0

    def swing(turn: Array) -> Array:
        return np.asarray(sign * (np.degrees(carrier.angle(turn)) - (low + high) / 2))

    return _fit_swing(since, reading, crank, swing, high - low)


def _fit_crank(since: Array, reading: Array) -> _Turn | None:
    """Fit a line and harmonics of once and twice a turn to the readings on a crank."""
    turned = np.degrees(np.unwrap(np.radians(reading)))
    phase = np.radians(turned)
    waves = [one(n * phase) for n in (1, 2) for one in (np.cos, np.sin)]
    columns = np.stack([np.ones_like(since), since, *waves], axis=1)
    rest = _fit_robustly(columns, turned)
    trusted = robust_std(rest) < _LARGEST_REST * 360 and float(np.ptp(turned)) > 90
    return _Turn(rest, 360.0, math.nan, math.nan) if trusted else None


def _fit_robustly(columns: Array, values: Array) -> Array:
    """Residuals of a least-squares fit in which outliers have less weight."""
    weight = np.ones(values.size)
    rest = values
    for _ in range(10):
        found = np.linalg.lstsq(columns * weight[:, None], values * weight, rcond=None)[0]
        rest = values - columns @ found
        scale = max(1.5 * robust_std(rest), 1e-6)
        weight = 1 / np.maximum(1.0, np.abs(rest) / scale)
    return np.asarray(rest)


def _fit_swing(
    since: Array, reading: Array, crank: Array, swing: Callable[[Array], Array], width: float
) -> _Turn | None:
    """Start, speed, zero and size of the swing, so that they fit most readings."""
    from scipy.optimize import least_squares  # slow to load

    # steps of the crank by the readings themselves; a few wrong ones do not matter
    step = np.diff(crank) % (2 * math.pi)
    speed = float(np.median(step / np.diff(since)))
    first = float(np.angle(np.exp(1j * (crank - speed * since)).mean()))

    def rest_of(guess: Array) -> Array:
        start, turns, zero, size = guess
        return np.asarray(reading - zero - size * swing(start + turns * since))

    middle = (float(reading.min()) + float(reading.max())) / 2
    found = None
    for factor in (1.0, 0.98, 1.02, 0.95, 1.05):
        guess = np.array([first, factor * speed, middle, 1.0])
        scale = np.array([0.1, 0.1 / max(float(since[-1]), 1e-9), 1.0, 0.1])
        fit = least_squares(rest_of, guess, loss="soft_l1", f_scale=0.1, x_scale=scale)
        if found is None or fit.cost < found.cost:
            found = fit
        if robust_std(rest_of(found.x)) < 0.02 * width:
            break
    assert found is not None
    rest = rest_of(found.x)
    noise = robust_std(rest)
    if noise >= _LARGEST_REST * width:
        return None
    turned = abs(found.x[1]) * float(since[-1])
    whole = turned > _WHOLE * 2 * math.pi
    slopes = np.asarray(found.jac)
    normal = np.linalg.pinv(slopes.T @ slopes)
    std = max(noise, 1e-4) * math.sqrt(float(normal[3, 3])) if whole else math.inf
    return _Turn(rest, width, float(found.x[3]), std)


def find_odd(rest: Array, swing: float) -> AnyArray:
    """Rows whose reading departs from its neighbours on both sides.

    Parameters
    ----------
    rest : array, (frame,)
        Readings less those of an even turn. [degree]
    swing : float
        Range of the readings. [degree]

    Returns
    -------
    array of int

    Examples
    --------
    >>> rest = 0.01 * np.random.default_rng(1).normal(size=40)
    >>> rest[7] += 3
    >>> find_odd(rest, 24.0)
    array([7])
    """
    beside = neighbours_of(rest, 2)
    off = np.abs(rest - np.median(beside, axis=1))

    # on either side of a slip the readings differ
    apart = np.abs(beside[:, :2].mean(axis=1) - beside[:, 2:].mean(axis=1))
    return np.flatnonzero(
        (off > max(_LEAST_ODD * swing, _ODD * robust_std(off))) & (apart < off / 2)
    )


def find_slips(rest: Array, swing: float) -> list[tuple[int, float]]:
    """Rows from which on all readings are off, and by how much; the largest slip first.

    Parameters
    ----------
    rest : array, (frame,)
        Readings less those of an even turn. [degree]
    swing : float
        Range of the readings. [degree]

    Returns
    -------
    list of (int, float)

    Examples
    --------
    >>> rest = 0.01 * np.random.default_rng(1).normal(size=40) + 0.5 * (np.arange(40) >= 22)
    >>> [(row, round(size, 1)) for row, size in find_slips(rest, 24.0)]
    [(22, 0.5)]
    """
    # three readings on either side, less what they change by within themselves
    if rest.size < _FEWEST:
        return []
    windows = np.lib.stride_tricks.sliding_window_view(rest, 6)
    before, after = np.median(windows[:, :3], axis=1), np.median(windows[:, 3:], axis=1)
    within = (windows[:, 5] - windows[:, 3] + windows[:, 2] - windows[:, 0]) / 2
    size = after - before - 1.5 * within
    noise = robust_std(size)
    found: list[tuple[int, float]] = []
    for k in np.argsort(-np.abs(size)):
        if abs(size[k]) <= max(_LEAST_ODD * swing, _ODD * noise):
            break
        if all(abs(k + 3 - row) > 5 for row, _ in found):
            found.append((int(k) + 3, float(size[k])))
    return found


def _note_odd_steps(reading: Array) -> Iterator[Note]:
    """Warn of single readings that depart from the mean of their neighbours; needs no times."""
    step = signed_steps(reading)
    bend = np.diff(step) / -2  # a reading less the mean of its neighbours
    size = np.abs(bend[1:-1])
    beside = -2 * np.stack([bend[:-2], bend[2:]])
    alone = (np.abs(beside - bend[1:-1]) < _ROOM * size + 2 * np.median(np.abs(bend))).all(axis=0)
    odd = 2 + np.flatnonzero(alone & (size > np.median(np.abs(step))))
    if 0 < odd.size <= reading.size // 10:
        yield _warn_of_readings(odd.tolist(), size[odd - 2].max())


def _warn_of_readings(odd: Sequence[int], most: float) -> Note:
    return warn(
        "encoder",
        f"reading or time of {'row' if len(odd) == 1 else 'rows'} {list_some(odd)} is not that of "
        f"an even turn, by up to {most:.3g} deg: speed and crank angle there are wrong. Correct "
        "them, or take out these pairs",
    )


def _note_swing(run: Run, fit: _Turn) -> Iterator[Note]:
    """Warn of a swing of the readings that differs from that of the linkage."""
    links, off = run.settings.linkage, fit.size - 1
    if not abs(off) > max(_SWING, _SIGNIFICANT * fit.size_std) or links is None:
        return
    mounted = "rocker" if run.settings.encoder is None else run.settings.encoder.mounted_on
    fitting = ""
    if mounted == "rocker" and isinstance(links, CrankRockerSettings):
        others = {"coupler": links.coupler, "rocker": links.rocker, "ground": links.ground}
        with suppress(ModelError):  # no crank gives that swing with these links
            crank = 100 * crank_for_swing(fit.size * math.radians(fit.swing), **others)
            fitting = f", as with a crank of {crank:.3g} cm in place of {100 * links.crank:.3g} cm"
    yield warn(
        "encoder",
        f"its reading swings by {fit.size * fit.swing:.2f} deg, the linkage of [mechanism] by "
        f"{fit.swing:.2f} deg{fitting}. Correct the lengths of the links, or ticks_per_turn",
    )
