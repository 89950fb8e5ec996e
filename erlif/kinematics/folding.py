"""Trigger and cycle of each frame."""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError
from erlif.core.products import EncoderLog
from erlif.core.variables import FILM, FRAMES
from erlif.kinematics.encoder import Encoder, Mechanism

# Turns of the crank below which a log without triggers_per_cycle counts as one cycle.
_SINGLE_CYCLE = 1.5

# Deviation from the first cycle's angle that a trigger may have, in spacings of triggers.
OFF_ANGLE = 0.5

# The same where triggers_per_cycle is not given: triggers that creep by less do no harm.
_REPEATED = 0.2

# Distance from a dead point, in steps of the crank, beyond which the stroke is certain.
_CLEAR = 0.25

_BACK = 1.5 * math.pi  # A larger step of a slow crank is a small one backwards [rad]

_TURN = 2 * math.pi


# Values at each frame of variables of a film, and their names in words; empty: as in the table.
FrameColumns: TypeAlias = dict[str, tuple[npt.ArrayLike, str]]


class Fold(NamedTuple):
    """Trigger and cycle of each frame.

    Attributes
    ----------
    trigger : numpy.ndarray
        Counted from 0 without gaps. (frame,)
    cycle : numpy.ndarray
        Turn of the crank, counted from 0. (frame,)
    remark : str
        How the frames were grouped, where that is not the usual way.
    """

    trigger: npt.NDArray[np.int64]
    cycle: npt.NDArray[np.int64]
    remark: str = ""


def fold_frames(crank: Array, log: EncoderLog, encoder: Encoder, mechanism: Mechanism) -> Fold:
    """Group the frames of several cycles.

    With bins, frames within the same part of a stroke form a trigger; no bin holds frames of both
    strokes. With triggers_per_cycle, frames that many apart do. Otherwise that number is taken
    from the angles; where the triggers of the cycles are at different angles, each frame is a
    trigger of its own.

    Parameters
    ----------
    crank : array, (frame,)
        Crank angle. [rad]
    log : EncoderLog
        angle (frame) [degree] and number (frame).
    encoder : Encoder
    mechanism : CrankRocker or SliderCrank

    Returns
    -------
    Fold

    Raises
    ------
    EncoderError
        If the frames of a trigger are at different angles with the given triggers_per_cycle.

    Examples
    --------
    Two turns, five frames in each, averaged over the two strokes:

    >>> import xarray as xr
    >>> from erlif.models.mechanism import SliderCrank
    >>> turn = np.arange(10) * 72.0
    >>> log = EncoderLog(xr.Dataset({"number": ("frame", np.arange(10)), "angle": ("frame", turn)}))
    >>> fold = fold_frames(np.radians(turn), log, Encoder("crank", bins=2), SliderCrank(1.0, 3.0))
    >>> fold.trigger.tolist()
    [1, 1, 0, 0, 1, 1, 1, 0, 0, 1]
    """
    if encoder.bins is not None:
        return fold_by_phase(crank, encoder.bins, mechanism.dead_points())

    reading, turning = log.angle.values, encoder.mounted_on == "crank"
    if encoder.triggers_per_cycle is not None:
        return fold_by_number(log, reading, encoder.triggers_per_cycle, turning=turning)

    # the step that follows the last frame completes its turn
    since = log.number.values - log.number.values[0]
    turned = float(np.sum(crank_steps(crank))) / _TURN
    cycles = turned + turned / max(since[-1], 1)
    frames = int(since[-1] + 1)
    per_cycle = frames if cycles < _SINGLE_CYCLE else round(frames / cycles)
    fold = Fold(since % per_cycle, since // per_cycle)
    off, spacing = find_deviations(reading, fold.trigger, turning=turning)
    if off.max() <= _REPEATED * spacing and not _mixes_strokes(fold, crank, mechanism):
        return fold
    remark = (
        f"{frames / cycles:.2f} triggers per cycle do not repeat from cycle to cycle: each frame "
        "is a trigger of its own; bins in [encoder] averages frames of one part of a stroke"
    )
    return Fold(np.arange(since.size), _count_turns(crank, float(crank[0])), remark)


def fold_by_phase(
    crank: Array, bins: int, dead_points: tuple[float, float], *, falling: bool = False
) -> Fold:
    """Group frames by their part of the cycle, strokes apart.

    Parameters
    ----------
    crank : array, (frame,)
        Angle of the drive. [rad]
    bins : int
        Parts of the cycle.
    dead_points : (float, float)
        Angles between which one stroke lies and then the other; a disc that has none may take any
        two opposite ones. [rad]
    falling : bool
        Whether the angle falls from frame to frame.

    Returns
    -------
    Fold

    Examples
    --------
    >>> fold_by_phase(np.radians([10.0, 100.0, 190.0, 370.0]), 2, (0.0, np.pi)).trigger.tolist()
    [0, 0, 1, 0]
    """
    at_smallest, at_largest = dead_points
    phase = (crank - at_smallest) % _TURN
    rise = (at_largest - at_smallest) % _TURN

    # each stroke has bins of one length, in number as its share of the cycle
    rising = min(max(round(bins * rise / _TURN), 1), bins - 1)
    outward = np.floor(phase / rise * rising)
    back = rising + np.floor((phase - rise) / (_TURN - rise) * (bins - rising))
    part = np.where(phase < rise, np.minimum(outward, rising - 1), np.minimum(back, bins - 1))

    occupied, trigger = np.unique(part.astype(np.int64), return_inverse=True)
    frames = np.bincount(trigger)
    empty = bins - occupied.size
    remark = f"{bins} bins of the cycle, {frames.min()} to {frames.max()} frames in each"
    if empty:
        remark += f"; {empty} without frames are left out"
    sign = -1 if falling else 1
    return Fold(trigger.astype(np.int64), _count_turns(sign * crank, sign * at_smallest), remark)


def crank_steps(crank: Array) -> Array:
    """Step of the crank from frame to frame; noise about a dead point may make it negative.

    Parameters
    ----------
    crank : array, (frame,)
        [rad]

    Returns
    -------
    array, (frame - 1,)
        [rad]

    Examples
    --------
    >>> np.degrees(crank_steps(np.radians([350.0, 10.0, 9.0, 30.0]))).round()
    array([20., -1., 21.])
    """
    step = np.diff(crank) % _TURN
    slow = step.size > 0 and float(np.median(step)) < math.pi
    return np.where(slow & (step > _BACK), step - _TURN, step)


def _count_turns(crank: Array, start: float) -> npt.NDArray[np.int64]:
    """Turns since the beginning of the log, each from the crank angle `start` on."""
    first = (crank[0] - start) % _TURN
    turned = first + np.concatenate([[0.0], np.cumsum(crank_steps(crank))])
    return np.asarray(np.floor(turned / _TURN + 1e-9), np.int64)  # rounding at a whole turn


def _mixes_strokes(fold: Fold, crank: Array, mechanism: Mechanism) -> bool:
    """Whether a trigger holds frames of both strokes, clear of the dead points."""
    at_smallest, at_largest = mechanism.dead_points()
    phase = (crank - at_smallest) % _TURN
    outward = phase < (at_largest - at_smallest) % _TURN

    # a frame nearer to a dead point than a quarter of a step may be on either side of it
    away = np.min(
        [np.abs((crank - at + np.pi) % _TURN - np.pi) for at in (at_smallest, at_largest)], 0
    )
    step = float(np.median(crank_steps(crank))) if crank.size > 1 else 0.0
    clear = away > _CLEAR * step
    count = [np.bincount(fold.trigger, clear & side) for side in (outward, ~outward)]
    return bool(((count[0] > 0) & (count[1] > 0)).any())


def find_deviations(
    angle: Array, trigger: npt.NDArray[np.int64], *, turning: bool
) -> tuple[Array, float]:
    """Distance of each frame from the first one of its trigger, and the spacing of the triggers.

    Parameters
    ----------
    angle : array, (frame,)
        [degree]
    trigger : array of int, (frame,)
    turning : bool
        Whether angles that are whole turns apart are the same.

    Returns
    -------
    off : array, (frame,)
        [degree]
    spacing : float
        Median step from frame to frame; infinite for a single one. [degree]

    Examples
    --------
    >>> angle, trigger = np.array([350.0, 10, 351]), np.array([0, 1, 0])
    >>> off, spacing = find_deviations(angle, trigger, turning=True)
    >>> off.tolist(), spacing
    ([0.0, 0.0, 1.0], 19.5)
    """
    # filled from the back, so that the first frame of each trigger is the reference
    first = np.empty(trigger.max() + 1)
    first[trigger[::-1]] = angle[::-1]
    off, step = np.abs(angle - first[trigger]), np.abs(np.diff(angle))
    if turning:
        off, step = (np.abs((one + 180.0) % 360.0 - 180.0) for one in (off, step))
    return off, float(np.median(step)) if step.size else math.inf


def fold_by_number(
    log: EncoderLog, angle: Array | None, triggers_per_cycle: int, *, turning: bool = True
) -> Fold:
    """Group frames that are a fixed number of triggers apart.

    Parameters
    ----------
    log : EncoderLog
        number (frame).
    angle : array, (frame,), or None
        Angle that the frames of a trigger share; None where it is not known. [degree]
    triggers_per_cycle : int
    turning : bool
        Whether angles that are whole turns apart are the same.

    Returns
    -------
    Fold

    Raises
    ------
    EncoderError
        If frames of one trigger are at different angles.

    Examples
    --------
    >>> import xarray as xr
    >>> log = EncoderLog(xr.Dataset({"number": ("frame", [5, 6, 7, 8])}))
    >>> fold_by_number(log, None, 2).trigger
    array([0, 1, 0, 1])
    """
    since = log.number.values - log.number.values[0]
    fold = Fold(since % triggers_per_cycle, since // triggers_per_cycle)
    if angle is None:
        return fold
    off, spacing = find_deviations(angle, fold.trigger, turning=turning)
    if off.max() > OFF_ANGLE * spacing:
        worst = int(np.argmax(off))
        raise EncoderError(
            f"Expected the frames of one trigger at one angle; with {triggers_per_cycle} triggers "
            f"per cycle (triggers_per_cycle) frame {int(log.number[worst])} is {off[worst]:.2f} "
            "deg from the first cycle's. Set triggers_per_cycle in [encoder] to the number of "
            "triggers in one cycle and keep every row; or take it out where the triggers do not "
            "repeat, and average by bins = 50."
        )
    return fold


def describe_frames(fold: Fold, columns: FrameColumns, *, cycle: str) -> xr.Dataset:
    """Trigger and cycle of each frame, and further columns.

    Parameters
    ----------
    fold : Fold
    columns : FrameColumns
        Variables of a film, at each frame.
    cycle : str
        What a cycle is, in words.

    Returns
    -------
    xarray.Dataset
        On dim frame, numbered from 0.

    Examples
    --------
    >>> describe_frames(Fold(np.array([0, 1]), np.array([0, 0])), {}, cycle="turn").cycle.long_name
    'turn'
    """
    numbers: FrameColumns = {"trigger": (fold.trigger, ""), "cycle": (fold.cycle, cycle)}
    frames = xr.Dataset(coords={"frame": np.arange(fold.trigger.size)})
    for name, (values, words) in (numbers | columns).items():
        known = {**FILM, **FRAMES}[name].attrs
        frames[name] = ("frame", values, {**known, "long_name": words or known["long_name"]})
    return frames
