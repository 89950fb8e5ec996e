"""Frame pairs of other recordings, known by where light falls and by the form of their film.

From pair to pair the film of a joint becomes thicker or thinner, and its form changes with its
thickness in one way. Between a pair of the run and one of another run, or of the fixture, the form
jumps, on the way in and on the way out.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.notes import Note, list_some, warn
from erlif.core.statistics import MAD_TO_STD
from erlif.core.units import count_of
from erlif.pipeline.audit.evidence import Evidence, median_by_frame

_FEWEST = 14  # frames from which on the change of the form is known

_PLACES = 24  # places with film in most frames, at least

# Change of form over that which four of five frames have at most, beyond which it is a jump; the
# largest one of sound runs is 2.
_JUMP, _USUAL = 3.0, 0.8

_FEW = 1 / 3  # share of the frames up to which pairs between jumps are strangers

_MANY = 0.3  # share of jumps from which the form changes by itself

_ROUNDS = 6  # of the robust fit

_AT_REST = 0.01  # range of the ratio of most frames below which the film is at rest [1]

_STEADY = 1.2  # factor of load or speed beyond which a change of the film is one of the run

# Counts of both cameras over their highest one, of pixels without light in other pairs, from which
# these are lit; sound runs reach 0.01. Share of the pairs up to which lit ones are strangers.
_LIT, _MOST_LIT = 0.2, 0.6


def note_strangers(evidence: Evidence) -> Iterator[Note]:
    """Warn of pairs whose film is not that of the run.

    Parameters
    ----------
    evidence : Evidence

    Yields
    ------
    Note
    """
    lit = find_lit(evidence)
    if lit.size:
        subject = f"pair {lit[0]} is" if lit.size == 1 else f"pairs {list_some(lit)} are"
        yield warn(
            "pairs",
            f"{subject} of another run or of the fixture: pixels that are dark in the other pairs "
            "are lit there, in both cameras. Compare the files with the recording, and leave them "
            "out",
        )
        return
    order = np.argsort(evidence.numbers)  # as recorded; frames of several cycles are in groups
    change = form_changes(evidence.ratios[order])
    if change is None:
        return
    jumps = np.flatnonzero(change > _JUMP * np.quantile(change, _USUAL))
    if not jumps.size or jumps.size > _MANY * change.size:
        return
    groups = find_groups(jumps, change.size + 1)
    numbers = evidence.numbers[order]
    for first, last in groups:
        if last == 0:
            continue  # a camera keeps nothing of a pulse before its first one
        edges = [k for k in (first - 1, last) if 0 <= k < change.size]
        if all(_changes_itself(evidence, order, row) for row in edges):
            continue
        size = float(np.max(change[edges]))
        where = f"pair {numbers[first]} is"
        if last > first:
            where = f"pairs {numbers[first]} to {numbers[last]} are"
        count = count_of(last - first + 1, "pair")
        yield warn(
            "pairs",
            f"{where} of another run or of the fixture, or the film jumped there: its form "
            f"changes by {size:.0f} times what it does elsewhere. Compare the files of {count} "
            "with the recording, and leave them out",
        )


def find_lit(evidence: Evidence) -> AnyArray:
    """Numbers of pairs in which pixels that are dark in the other pairs are lit in both cameras."""
    dark = np.array([[level for level, _ in one.dark] for one in evidence.frames])
    peaks = np.array([one.peaks for one in evidence.frames])
    lit = (dark > _LIT * peaks).all(axis=1)
    return np.asarray(evidence.numbers[lit & (lit.mean() <= _MOST_LIT)])


def _changes_itself(evidence: Evidence, order: AnyArray, row: int) -> bool:
    """Whether load or crank change between a frame and the next one, as a step of a program."""
    load, time = evidence.logged("joint_load"), evidence.logged("time")
    if load is not None and row + 1 < load.size:
        factor = load[order[row + 1]] / load[order[row]]
        if not 1 / _STEADY < factor < _STEADY:
            return True
    if time is not None and row + 1 < time.size:
        step = np.diff(time[order])
        return bool(step[row] > 3 * np.median(step))
    return False


def form_changes(ratios: Array) -> Array | None:
    """Change of the form of the film from frame to frame, over its median.

    Parameters
    ----------
    ratios : array, (frame, place)
        Logarithm of the ratio; NaN where it is not known.

    Returns
    -------
    array, (frame - 1,), or None
        Change that the change of the median film does not explain; None where too few frames or
        places are known.

    Examples
    --------
    A gap that opens and closes, with one frame of another form:

    >>> rng = np.random.default_rng(3)
    >>> film = np.linspace(0, 1, 36) ** 2 + np.abs(np.sin(np.arange(40) / 5))[:, None]
    >>> film[20] = film[20, ::-1]
    >>> change = form_changes(film + 0.01 * rng.normal(size=film.shape))
    >>> np.flatnonzero(change > 3)
    array([19, 20])
    """
    shown = np.isfinite(ratios).any(axis=1)
    common = np.isfinite(ratios).mean(axis=0) > shown.mean() / 2
    if shown.sum() < _FEWEST or common.sum() < _PLACES:
        return None
    form = ratios[:, common]
    level = median_by_frame(form)
    scale = float(np.nanstd(level)) if np.isfinite(level).any() else 0.0
    if not scale > 0:
        return None
    level = (level - np.nanmedian(level)) / scale

    # of the differences, so that few equations know both recordings
    step, middle = np.diff(level), (level[1:] + level[:-1]) / 2
    columns = np.stack([step, middle * step, middle**2 * step], axis=1)
    if scale * np.ptp(np.nanquantile(level, (0.2, 0.8))) < _AT_REST:
        columns = np.zeros_like(columns)  # at rest: strangers alone would show how the form changes
    values = np.diff(form, axis=0)
    values = values - median_of(values)[:, None]
    known = np.isfinite(values) & np.isfinite(columns.sum(axis=1, keepdims=True))
    columns, values = np.nan_to_num(columns), np.where(known, values, 0.0)
    weight, change = np.ones(len(values)), np.zeros(len(values))
    for _ in range(_ROUNDS):
        # normal equations of all places at once
        w = np.where(known, weight[:, None] ** 2, 0.0)
        normal = np.einsum("fp,fi,fj->pij", w, columns, columns)
        right = np.einsum("fp,fi,fp->pi", w, columns, values)
        found = np.einsum("pij,pj->pi", np.linalg.pinv(normal, hermitian=True), right)
        rest = np.where(known, values - columns @ found.T, np.nan)
        change = MAD_TO_STD * median_of(np.abs(rest))
        usual = float(np.nanmedian(change))
        if not usual > 0:
            return None
        change = change / usual
        weight = 1 / np.maximum(1.0, np.nan_to_num(change, nan=np.inf) / 1.5) ** 2
    return np.asarray(np.nan_to_num(change))


def median_of(values: Array) -> Array:
    """Median of each row; NaN where a row has few values."""
    found = np.full(len(values), np.nan)
    some = np.isfinite(values).sum(axis=1) >= _PLACES / 2
    found[some] = np.nanmedian(values[some], axis=1)
    return found


def find_groups(jumps: AnyArray, count: int) -> list[tuple[int, int]]:
    """First and last frame of the groups between jumps that are few.

    Parameters
    ----------
    jumps : array of int
        Frames after which the form jumps.
    count : int
        Number of frames.

    Returns
    -------
    list of (int, int)

    Examples
    --------
    >>> find_groups(np.array([19, 29]), 50)
    [(20, 29)]
    >>> find_groups(np.array([2]), 50)
    [(0, 2)]
    """
    edges = np.concatenate([[-1], jumps, [count - 1]])
    parts = [(int(one) + 1, int(two)) for one, two in pairwise(edges)]
    sizes = [last - first + 1 for first, last in parts]

    # own parts and strangers take turns, and the longest part is the run's own
    longest = int(np.argmax(sizes))
    groups = [part for k, part in enumerate(parts) if (k - longest) % 2 and sizes[k] > 0]
    return [(one, two) for one, two in groups if two - one + 1 <= _FEW * count]
