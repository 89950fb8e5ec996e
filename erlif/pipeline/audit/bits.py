"""Faults of the bits of counts: lines that are stuck, and counts that never occur."""

from __future__ import annotations

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


def note_bits(histograms: Iterable[Histogram]) -> Iterator[Note]:
    """Warn of bits that are never or always set, and of counts that never occur.

    Parameters
    ----------
    histograms : iterable of array of int, (full scale + 1,)
        Pixels by count, of camera 1 and camera 2.

    Yields
    ------
    Note
    """
    for camera, histogram in enumerate(histograms, 1):
        for fault in find_bit_faults(histogram):
            yield warn("bits", f"camera{camera}: {fault}")


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
