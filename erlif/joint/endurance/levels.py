"""Levels of friction from stage to stage: galling while the load is raised, or a slow one.

Within a stage such galling looks like the level of the stage, or like drift. It is seen against
the other stages alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import Array
from erlif.core.notes import Note, remark, warn
from erlif.core.statistics import robust_std
from erlif.joint.endurance.blocks import RESTART, LogClock, StageFriction
from erlif.joint.endurance.onset import Onset

# Samples of a stage whose level is compared.
FEWEST_LEVEL = 12

_END = 0.25  # of a stage, at its end: running-in is nearly over
_SPREAD = RESTART[0]  # of levels of stages, before any is measured
_STAGES = 4  # stages for which that assumption counts
_DEVIATIONS = 3.0  # 3 of 800 simulated tests without galling exceed it
_USUAL = 0.04  # most by which friction is expected to change from stage to stage


@dataclass(frozen=True)
class LevelRise:
    """A stage whose friction is higher than the other stages let expect.

    Attributes
    ----------
    stage : int
        Place of the stage, from 0.
    level : float
        Friction at its end. [1]
    before : float
        Friction of the stage before at the same time after its start; of the first stage, lowest
        friction before in it. [1]
    expected : float
        Rise that the other stages let expect. [1]
    bound : float
        Rise beyond it that is ordinary. [1]
    recovered : int | None
        Place of a later stage whose friction is as low as before; None where there is none.
    """

    stage: int
    level: float
    before: float
    expected: float
    bound: float
    recovered: int | None = None


def find_level_rises(
    stages: Sequence[StageFriction], onset: Onset | None = None, *, least_rise: float = 0.02
) -> tuple[LevelRise, ...]:
    """Find stages whose friction is higher than the other stages let expect.

    The end of each stage is compared with the same time after the start of the stage before, so
    that running-in cancels. The median of the other rises is expected, as friction may change with
    the load and drift. Three standard deviations of the rises about it are ordinary.

    Parameters
    ----------
    stages : sequence of StageFriction
        As for `erlif.joint.endurance.find_onset`.
    onset : Onset, optional
        Onset of galling: only what is before it counts.
    least_rise : float
        Smallest rise of friction that is called galling. [1]

    Returns
    -------
    tuple of LevelRise

    Examples
    --------
    >>> stages = [(0.133, 0.0), (0.132, 700.0), (0.133, 1400.0), (0.193, 2100.0)]
    >>> stages = [StageFriction(start + np.arange(600.0), np.full(600, mu)) for mu, start in stages]
    >>> [(rise.stage, rise.level, rise.before) for rise in find_level_rises(stages)]
    [(3, 0.193, 0.133)]
    """
    ends = np.inf if onset is None else onset.earliest
    spans: dict[int, _Span] = {}
    for place, stage in enumerate(stages):
        kept = stage.time < ends
        if np.count_nonzero(kept) >= FEWEST_LEVEL:
            time = stage.time[kept]
            spans[place] = LogClock.of(time).logged(time) - time[0], stage.friction[kept]
    numbers, known = [*spans], [*spans.values()]

    found: list[LevelRise] = []
    for k, (passed, _) in enumerate(known):
        window = ((1 - _END) * passed[-1], passed[-1])
        if k == 0:
            rises = [_rise_within(*span) for span in known]
            before = _level(known[0], window) - rises[0]
        else:
            levels = [_level(span, window) for span in known]
            rises = np.diff(levels).tolist()
            before = levels[k - 1]
        own = rises.pop(max(k - 1, 0))
        expected, bound = _ordinary(np.array(rises), least_rise)
        if own > expected + bound:
            later = [j for j in range(k + 1, len(known)) if _end(known[j]) < before + least_rise]
            back = numbers[later[0]] if later else None
            found.append(LevelRise(numbers[k], before + own, before, expected, bound, back))
    return tuple(found)


def note_level_rises(rises: Sequence[LevelRise], numbers: Sequence[int]) -> list[Note]:
    """Describe stages whose friction is higher than expected; `numbers` are those of the stages."""
    notes = []
    for rise in rises:
        subject, more = f"stage {numbers[rise.stage]}", 100 * (rise.level / rise.before - 1)
        against = f"stage {numbers[rise.stage - 1]}" if rise.stage else "its lowest before"
        text = (
            f"friction of {rise.level:.3f} is {more:.0f} % above {against} ({rise.before:.3f}), "
            f"where the other stages let expect a change of {rise.expected:+.3f} ± {rise.bound:.3f}"
        )
        if rise.recovered is None:
            doubt = "galling during the step of load or a slow rise cannot be excluded"
            notes.append(warn(subject, f"{text}; {doubt}"))
        else:
            recovered = f"it has recovered in stage {numbers[rise.recovered]}"
            notes.append(remark(subject, f"{text}; {recovered}"))
    return notes


def first_doubtful(rises: Sequence[LevelRise]) -> int | None:
    """Place of the first stage in which galling cannot be excluded."""
    return next((rise.stage for rise in rises if rise.recovered is None), None)


_Span = tuple[Array, Array]


def _level(span: _Span, window: tuple[float, float]) -> float:
    """Level in a window of the time since the start; of a shorter stage, at its end."""
    passed, friction = span
    low = min(window[0], (1 - _END) * passed[-1])
    inside = (passed >= low) & (passed <= window[1])
    return float(np.median(friction[inside]))


def _end(span: _Span) -> float:
    return _level(span, (np.inf, np.inf))


def _rise_within(passed: Array, friction: Array) -> float:
    """Level at the end of a stage over the lowest part of equal length before it."""
    parts = [
        (passed >= share * passed[-1]) & (passed < (share + _END) * passed[-1])
        for share in np.arange(0.0, 1.0 - _END, _END)
    ]
    lowest = min(float(np.median(friction[part])) for part in parts if part.any())
    return _end((passed, friction)) - lowest


def _ordinary(others: Array, least_rise: float) -> tuple[float, float]:
    """Expected rise from the other stages, and the largest ordinary deviation from it."""
    count = others.size
    middle = float(np.median(others)) if count else 0.0
    scatter = robust_std(others) if count else 0.0
    variance = (_STAGES * 2 * _SPREAD**2 + count * scatter**2) / (_STAGES + count)
    bound = _DEVIATIONS * float(np.sqrt(variance * (1 + 1 / max(count, 1))))
    return float(np.clip(middle, -_USUAL, _USUAL)), max(bound, least_rise)
