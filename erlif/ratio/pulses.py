"""Check that the two images of a pair belong to the same laser pulse.

The speckle of a laser is new with every pulse, and both cameras see it: it leaves the ratio. Where
camera 2 shows another pulse, the ratio contains the speckle of camera 1 with the opposite sign.
The slope of the logarithm of the ratio over the logarithm of the light, from place to place, is
therefore 0 for a true pair and -1 for two images of different pulses.

Film and surfaces are the same in both, or change slowly over the image: each frame is compared with
the mean of all frames, and a quadratic surface is taken out of it. Light and ratio come from
different pixels, so that the shot noise of camera 1 does not pass for speckle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.statistics import quadratic_surface

# Squares along each axis of the image; smaller frames than 64 px are not measured.
PLACES = 8

# Side of a square: wider than the displacement that registration leaves, narrower than the beam.
# [px]
SIDE = 8

# Places of a frame from which on it is judged; a quadratic surface takes six of them.
_FEWEST = 40

# Least correlation of the speckle in the two halves of the pixels. Below it, noise prevails.
_COMMON = 0.7

# Slope half-way between a true pair and two different pulses; its error is below 0.1.
_MISMATCHED = -0.5

# Pulses by which camera 2 is expected to be late or early at most.
_FARTHEST = 5

# Frames that can be judged from which on a recording is judged; their mean is subtracted.
_FEWEST_FRAMES = 4


class PulseSample(NamedTuple):
    """Light and ratio of a frame pair in squares of a grid; NaN where few pixels are valid.

    Attributes
    ----------
    light : Image
        Mean logarithm of the light of camera 1 over one half of the pixels, (place,).
    light_again : Image
        The same over the other half.
    log_ratio : Image
        Mean logarithm of the ratio over the other half, (place,).
    """

    light: Image
    light_again: Image
    log_ratio: Image


# Stands for a frame pair that cannot be judged.
NO_PULSE = PulseSample(*(np.full(PLACES**2, np.nan, np.float32) for _ in range(3)))


def sample_pulse(light: Image, log_ratio: Image, flags: FlagImage) -> PulseSample:
    """Means over small squares of a frame pair, by which its pulse is recognised.

    Parameters
    ----------
    light : array, (y, x)
        Light of camera 1. [DN]
    log_ratio : array, (y, x)
        Logarithm of camera 2 over camera 1. [1]
    flags : array, (y, x)
        0 for valid pixels.

    Returns
    -------
    PulseSample

    Examples
    --------
    >>> flat = np.full((64, 80), 1000, np.float32)
    >>> sample = sample_pulse(flat, 0 * flat, np.zeros(flat.shape, np.uint16))
    >>> sample.light.shape, round(float(np.exp(sample.light[0])))
    ((64,), 1000)
    """
    if min(light.shape) < PLACES * SIDE:
        return NO_PULSE

    rows, columns = (_square_places(size) for size in light.shape)
    grid = np.ix_(rows, columns)
    value, ratio, valid = light[grid], log_ratio[grid], flags[grid] == 0
    valid &= value > 0
    logarithm = np.log(np.where(valid, value, 1))

    # a chessboard: neighbours of either half see the same speckle
    first = (np.add.outer(np.arange(rows.size), np.arange(columns.size)) % 2 == 0) & valid
    second = valid & ~first
    return PulseSample(
        _mean(logarithm, first), _mean(logarithm, second), _mean(np.where(valid, ratio, 0), second)
    )


def _square_places(size: int) -> AnyArray:
    """Rows or columns of the squares."""
    starts = np.linspace(0, size - SIDE, PLACES).round().astype(int)
    return (starts[:, None] + np.arange(SIDE)).ravel()


def _mean(values: Image, chosen: AnyArray) -> Image:
    """Mean over the chosen pixels of each square; NaN where fewer than half are left."""
    shape = (PLACES, SIDE, PLACES, SIDE)
    count = chosen.reshape(shape).sum(axis=(1, 3))
    total = np.where(chosen, values, 0).reshape(shape).sum(axis=(1, 3), dtype=float)
    mean = np.where(count >= SIDE**2 // 4, total / np.maximum(count, 1), np.nan)
    return mean.ravel().astype(np.float32)


@dataclass(frozen=True)
class PulseFault:
    """Pairs whose images belong to different pulses.

    Attributes
    ----------
    kind : str
        "late", "reversed", "exchanged", "unknown" or "repeated".
    frames : tuple[int, ...]
        Frames whose image of camera 2 is that of another pulse; for "repeated", frames with the
        same light.
    partners : tuple[int, ...]
        Frame of camera 1 that shows the pulse of each, -1 where none does.
    lag : int
        Pulses by which camera 2 is late; negative where it is early; 0 for other kinds.
    """

    kind: str
    frames: tuple[int, ...]
    partners: tuple[int, ...] = ()
    lag: int = 0


def find_pulse_faults(samples: Sequence[PulseSample]) -> list[PulseFault]:
    """Recognise images of camera 2 that belong to another pulse than those of camera 1.

    Parameters
    ----------
    samples : sequence of PulseSample
        Of all frame pairs, in the order of their pulses; NaN for pairs that are left out.

    Returns
    -------
    list of PulseFault
        Empty where every pair that can be judged is a true one. Nothing is found where the light
        has no speckle that is new with every pulse.

    Examples
    --------
    >>> speckle = 0.03 * np.random.default_rng(1).normal(size=(6, 64)).astype(np.float32)
    >>> late = np.roll(speckle, 1, axis=0)
    >>> pairs = [PulseSample(a, a, b - a) for a, b in zip(speckle, late)]
    >>> fault, = find_pulse_faults(pairs)
    >>> fault.kind, fault.lag
    ('late', 1)
    """
    if not samples:
        return []
    faults = list(_find_repeated(samples))
    light, again, ratio = (
        _detrend(np.array(values, float)) for values in zip(*samples, strict=True)
    )
    slope = _ratio_slopes(light, again, ratio)
    judged = np.flatnonzero(np.isfinite(slope))
    if judged.size < _FEWEST_FRAMES:
        return faults

    wrong = judged[slope[judged] < _MISMATCHED]
    if not wrong.size:
        return faults

    # where most pairs are wrong, the order of one camera as a whole is
    other = again + ratio
    if 2 * wrong.size > judged.size:
        return [*faults, _find_order(light, other, wrong)]
    partner_of = {int(k): _find_partner(light, other[k]) for k in wrong}
    exchanged = _find_closed(partner_of)
    for kind, inside in (("exchanged", True), ("unknown", False)):
        frames = tuple(k for k in partner_of if (k in exchanged) is inside)
        if frames:
            faults.append(PulseFault(kind, frames, tuple(partner_of[k] for k in frames)))
    return faults


def _find_closed(partner_of: dict[int, int]) -> set[int]:
    """Frames whose images have changed places among themselves."""
    closed = set(partner_of)
    while True:
        taken = {partner_of[k] for k in closed}
        left = {k for k in closed & taken if partner_of[k] in closed}
        if left == closed:
            return closed
        closed = left


def _find_repeated(samples: Sequence[PulseSample]) -> Iterator[PulseFault]:
    """Frames that show the same light to the last bit: copies of one exposure."""
    groups: dict[bytes, list[int]] = {}
    for k, sample in enumerate(samples):
        if np.isfinite(sample.light).any():
            groups.setdefault(sample.light.tobytes(), []).append(k)
    for frames in groups.values():
        if len(frames) > 1:
            yield PulseFault("repeated", tuple(frames))


def _detrend(values: Array) -> Array:
    """Values (frame, place) less the mean of all frames and a quadratic surface of each."""
    with np.errstate(invalid="ignore"):
        valid = np.isfinite(values)
        count = valid.sum(axis=0)
        mean = np.where(valid, values, 0).sum(axis=0) / np.maximum(count, 1)
    rest = np.where(valid & (count > 1), values - mean, np.nan)

    y, x = np.indices((PLACES, PLACES)).reshape(2, -1) / (PLACES - 1) - 0.5
    surface = quadratic_surface(x, y)
    for row in rest:
        known = np.isfinite(row)
        if known.sum() < _FEWEST:
            row[:] = np.nan
            continue
        fitted, *_ = np.linalg.lstsq(surface[known], row[known], rcond=None)
        row -= surface @ fitted
    return rest


def _ratio_slopes(light: Array, again: Array, ratio: Array) -> Array:
    """Slope of the ratio over the light in each frame; NaN where noise prevails, (frame,)."""
    valid = np.isfinite(light) & np.isfinite(again) & np.isfinite(ratio)
    one, two, three = (np.where(valid, values, 0) for values in (light, again, ratio))
    common = (one * two).sum(axis=1)
    size = np.sqrt((one**2).sum(axis=1) * (two**2).sum(axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = (one * three).sum(axis=1) / common
        return np.where(common > _COMMON * size, slope, np.nan)


def _find_order(light: Array, other: Array, wrong: AnyArray) -> PulseFault:
    """Find the shift or reversal of camera 2 for which most pulses agree."""
    count = len(light)
    orders = {n: np.arange(count) - n for n in range(-_FARTHEST, _FARTHEST + 1) if n}
    orders[0] = np.arange(count)[::-1]  # no lag, but the reverse order

    agreement = {lag: _agreement(light, other, order) for lag, order in orders.items()}
    best = max(agreement, key=lambda lag: np.nan_to_num(agreement[lag], nan=-1.0))
    frames = tuple(int(k) for k in wrong)
    if not agreement[best] > _COMMON:
        return PulseFault("unknown", frames, tuple(_find_partner(light, other[k]) for k in wrong))
    partners = tuple(int(k) for k in orders[best][wrong])
    return PulseFault("late" if best else "reversed", frames, partners, best)


def _agreement(light: Array, other: Array, order: AnyArray) -> float:
    """Median correlation of camera 2 in each frame with camera 1 in the frame that order names."""
    inside = (order >= 0) & (order < len(light))
    if 2 * inside.sum() < len(light):
        return float("nan")  # too few pairs would be left to judge by
    correlations = [_correlation(light[n], other[k]) for k, n in enumerate(order) if inside[k]]
    known = [one for one in correlations if np.isfinite(one)]
    return float(np.median(known)) if known else float("nan")


def _find_partner(light: Array, other: Array) -> int:
    """Frame of camera 1 that shows the pulse of an image of camera 2; -1 where none does."""
    correlations = np.nan_to_num([_correlation(one, other) for one in light], nan=-1.0)
    best = int(np.argmax(correlations))
    return best if correlations[best] > _COMMON else -1


def _correlation(one: Array, two: Array) -> float:
    valid = np.isfinite(one) & np.isfinite(two)
    if valid.sum() < _FEWEST:
        return float("nan")
    size = np.sqrt((one[valid] ** 2).sum() * (two[valid] ** 2).sum())
    return float((one[valid] * two[valid]).sum() / size) if size > 0 else float("nan")
