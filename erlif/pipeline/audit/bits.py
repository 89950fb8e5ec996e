"""Faults of the bits of counts: lines that are stuck, and counts that never occur."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from erlif.core.notes import Note, warn
from erlif.correction.saturation import Histogram

_FULLY = 0.98  # share of the pixels between the darkest and the brightest per cent

# Share of the counts in between that occur, and of the pixels whose neighbouring counts occur; a
# change of scale leaves fewer.
_LEAST_USED = 0.5

# Pixels for each possible count from which on every count is expected to occur.
_PIXELS_PER_COUNT = 20

# Pixels of a count over those of its neighbours, outside of which it is odd, share of odd counts
# from which a scale was changed, and counts from which on the share is known. Changes by 2 % leave
# 2 % of odd counts, frames as they are none.
_RARE, _FREQUENT, _ODD_SHARE, _FEWEST_COUNTS = 0.25, 1.75, 0.012, 200

_BESIDE = np.array([1, 1, 1, 0, 1, 1, 1]) / 6  # neighbours with which a count is compared


def note_bits(
    histograms: Iterable[Histogram], flats: Iterable[Histogram | None] = (None, None)
) -> Iterator[Note]:
    """Warn of bits that are never or always set, and of counts that never occur or were scaled.

    Parameters
    ----------
    histograms : iterable of array of int, (full scale + 1,)
        Pixels by count, of camera 1 and camera 2.
    flats : iterable of array of int, optional
        The same of their flats: a camera that scales its counts by itself has done so in both.

    Yields
    ------
    Note
    """
    for camera, (histogram, flat) in enumerate(zip(histograms, flats, strict=True), 1):
        faults = find_bit_faults(histogram)
        yield from (warn("bits", f"camera{camera}: {fault}") for fault in faults)
        if faults or flat is None:
            continue
        odd, by_camera = share_odd(histogram), share_odd(flat)
        if odd > _ODD_SHARE > by_camera:
            yield warn(
                "bits",
                f"camera{camera}: {odd:.1%} of the counts occur far less or more often than their "
                "neighbours, those of the flat do not: the counts of the frames were scaled after "
                "the exposure, and films are wrong. Export the raw counts of the camera",
            )


def share_odd(histogram: Histogram) -> float:
    """Share of the counts that occur far less or more often than their neighbours.

    It is the smallest one of three parts of the range: a dark border has odd counts in one.

    Parameters
    ----------
    histogram : array of int, (full scale + 1,)
        Pixels by count.

    Returns
    -------
    float
        NaN where too few counts are frequent.

    Examples
    --------
    >>> counts = np.random.default_rng(1).normal(1500, 300, 200_000)
    >>> scaled = np.rint(1.1 * np.rint(counts)).astype(int)
    >>> round(share_odd(np.bincount(np.rint(counts).astype(int), minlength=4096)), 2)
    0.0
    >>> round(share_odd(np.bincount(scaled, minlength=4096)), 2)
    0.09
    """
    beside = np.convolve(histogram, _BESIDE, "same")
    tested = beside >= _PIXELS_PER_COUNT
    if tested.sum() < _FEWEST_COUNTS:
        return math.nan
    factor = histogram[tested] / beside[tested]
    odd = (factor < _RARE) | (factor > _FREQUENT)
    return min(float(part.mean()) for part in np.array_split(odd, 3))


def find_bit_faults(histogram: Histogram) -> list[str]:
    """Faults of the bits of counts, in words.

    Parameters
    ----------
    histogram : array of int, (full scale + 1,)
        Pixels by count.

    Returns
    -------
    list of str

    Examples
    --------
    Eight bits in the upper part of twelve:

    >>> histogram = np.zeros(4096, np.int64)
    >>> histogram[320:3200:16] = 1000
    >>> print(find_bit_faults(histogram)[0][:46])
    the lowest 4 bits are never set: counts are mu
    """
    used = np.flatnonzero(histogram)
    if used.size < 2:
        return []
    span = int(used[-1] - used[0])
    ever, always = int(np.bitwise_or.reduce(used)), int(np.bitwise_and.reduce(used))

    # a range of counts twice as wide as a bit must contain counts with and without it
    tested = [bit for bit in range(span.bit_length()) if span >= 2 << bit]
    never = [bit for bit in tested if not ever >> bit & 1]
    stuck = [bit for bit in tested if always >> bit & 1]
    lowest = next((n for n in range(len(tested) + 1) if n not in never), 0)

    faults = []
    if lowest:
        low = "the lowest bit is" if lowest == 1 else f"the lowest {lowest} bits are"
        faults.append(
            f"{low} never set: counts are multiples of "
            f"{1 << lowest}. Frames of fewer bits were scaled up, or are left-aligned: export the "
            'raw counts, or correct bit_depth and write alignment = "left"'
        )
    other = [bit for bit in never if bit >= lowest]
    for bits, what in ((other, "never"), (stuck, "always")):
        if bits:
            names = ", ".join(str(bit) for bit in bits)
            faults.append(
                f"bit {names} (value {', '.join(str(1 << bit) for bit in bits)}) is {what} set: a "
                "line of the camera or of its cable is stuck. Check the camera with a test image"
            )
    return faults or _find_skipped_counts(histogram)


def _find_skipped_counts(histogram: Histogram) -> list[str]:
    """Counts that do not occur between others, as a change of scale leaves them."""
    total = np.cumsum(histogram)
    tail = (1 - _FULLY) / 2 * total[-1]
    low, high = (int(np.searchsorted(total, level)) for level in (tail, total[-1] - tail))
    inside = histogram[low : high + 1]
    used = int(np.count_nonzero(inside))
    if inside.sum() < _PIXELS_PER_COUNT * inside.size or used >= _LEAST_USED * inside.size:
        return []

    # between a dark border and a bright film no count occurs either, but within each all do
    beside = np.convolve(inside > 0, [1, 0, 1], "same") > 0
    if inside[beside].sum() >= _LEAST_USED * inside.sum():
        return []
    return [
        f"only {used} of the {inside.size} counts from {low} to {high} occur: frames of fewer bits "
        "were scaled or corrected. Export the raw counts of the camera"
    ]
