"""Faults of a recording in progress, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from erlif.pipeline.watch.live import LivePair
from erlif.ratio import PulseSample, find_pulse_faults

# Pairs at either end of a run whose brightest are compared, and share of the light from which on a
# fall is stated: a film that changes with the angle changes the light of single pairs as much.
_ENDS, _FALLEN = 20, 0.75


def describe_pulses(pairs: Iterable[tuple[int, PulseSample]]) -> str:
    """State that most of the pairs show two different pulses; empty if they do not.

    Parameters
    ----------
    pairs : iterable of (int, PulseSample)
        Places, and by what their pulses are recognised.

    Returns
    -------
    str

    Examples
    --------
    >>> import numpy as np
    >>> speckle = 0.03 * np.random.default_rng(1).normal(size=(6, 64)).astype(np.float32)
    >>> late = np.roll(speckle, 1, axis=0)
    >>> pairs = [PulseSample(a, a, b - a) for a, b in zip(speckle, late)]
    >>> describe_pulses(enumerate(pairs))
    'the cameras show different laser pulses in 6 of the pairs 0 to 5: their film is wrong'
    >>> describe_pulses(enumerate(PulseSample(a, a, 0 * a) for a in speckle))
    ''
    """
    places, samples = zip(*sorted(pairs, key=lambda one: one[0]), strict=True)
    faults = find_pulse_faults(samples)
    wrong = {frame for one in faults if one.kind != "repeated" for frame in one.frames}
    if 2 * len(wrong) <= len(samples):
        return ""
    return (
        f"the cameras show different laser pulses in {len(wrong)} of the pairs {places[0]} to "
        f"{places[-1]}: their film is wrong"
    )


def describe_fall(pairs: Sequence[LivePair]) -> str:
    """State that the light of a camera has fallen since the start; empty if it has not.

    Parameters
    ----------
    pairs : sequence of LivePair
        In any order: the newest pair is measured first.

    Returns
    -------
    str

    Examples
    --------
    >>> zero = (0.0, 0.0)
    >>> pairs = [
    ...     LivePair(n, "", 0.0, 2.0, 0.1, 2.0, 0.1, 1.0, (1000.0 - 10 * n, 900.0), zero, zero)
    ...     for n in range(60)
    ... ]
    >>> describe_fall(pairs)
    'the light of camera 1 falls: at most 600 DN in the last 20 pairs, 1000 DN at the start'
    >>> describe_fall(pairs[:45])
    ''
    """
    if len(pairs) < 2 * _ENDS:
        return ""
    pairs = sorted(pairs, key=lambda pair: pair.place)
    for camera in range(2):
        first, last = (
            max(one.light[camera] for one in part) for part in (pairs[:_ENDS], pairs[-_ENDS:])
        )
        if last < _FALLEN * first:
            return (
                f"the light of camera {camera + 1} falls: at most {last:.0f} DN in the last "
                f"{_ENDS} pairs, {first:.0f} DN at the start"
            )
    return ""


def describe_missing(missing: dict[str, int]) -> dict[str, str]:
    """Frames that one camera lacks, or both, in words, by the camera."""
    texts = {}
    for camera in (0, 1, 2):
        names = [name for name, lacking in missing.items() if lacking == camera]
        if names:
            more = f" and of {len(names) - 3} more" if len(names) > 3 else ""
            listed = ", ".join(names[:3])
            who = f"camera {camera} lacks the partner of" if camera else "neither camera has"
            texts[f"frames of camera {camera}"] = f"{who} {listed}{more}"
    return texts
