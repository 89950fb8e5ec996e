"""Counters of a fixed number of bits that start again at their lowest value."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array

# Bits of counters in encoders, clocks and frame grabbers.
_BITS = (8, 10, 12, 14, 16, 20, 24, 32)

# Longest step of a counter in its ranges; a counter that was reset by hand jumps elsewhere.
_LONGEST = 1 / 8


def count_on(values: Array, turn: float = 0.0) -> tuple[Array, int]:
    """Whole numbers counted on where a counter of 2^k states starts again.

    Parameters
    ----------
    values : array, (row,)
    turn : float
        Counts of one turn of an encoder that starts again after each; 0 for other counters.

    Returns
    -------
    values : array, (row,)
        The same where no counter of a known number of bits explains the jumps.
    bits : int
        Of the counter; 0 where it does not start again.

    Examples
    --------
    >>> count_on(np.array([65530.0, 65534.0, 2.0, 6.0]))
    (array([65530., 65534., 65538., 65542.]), 16)
    >>> count_on(np.array([3590.0, 3598.0, 6.0]), turn=3600)
    (array([3590., 3598.,    6.]), 0)
    """
    whole = values.size > 1 and np.isfinite(values).all() and not (values % 1).any()
    low, high = (values.min(), values.max()) if whole else (0.0, 0.0)
    if not whole or 0 <= low <= high < turn:
        return values, 0
    jump = np.abs(np.diff(values))
    for bits in _BITS:
        states = 2.0**bits
        first = 0.0 if low >= 0 else -states / 2
        again = jump > states / 2
        if low < first or high >= first + states or not again.any():
            continue

        # at a jump one value lies at either end, as near as the steps are long
        counted = np.unwrap(values, period=states)
        step = np.abs(np.diff(counted)).max()
        pairs = np.sort([values[:-1][again], values[1:][again]], axis=0)
        at_ends = max((pairs[0] - first).max(), (first + states - 1 - pairs[1]).max()) <= step
        if at_ends and step <= _LONGEST * states:
            return counted, bits
    return values, 0
