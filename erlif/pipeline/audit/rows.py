"""An order of the rows of a log against the pairs, and how such orders are judged."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array

FEWEST = 16  # frames from which on an order is judged

FARTHEST = 12  # rows by which a log is taken to be late at most

SIDE = 5  # frames on either side of a place at which rows are lost, at least

# Standard deviations from which a single pair is not that of its row, and the share of such pairs.
ODD, FEW_ODD = 7.0, 0.2


class Order(NamedTuple):
    """How the rows lie against the pairs.

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
    gain : float
        Gain in the logarithm of the likelihood over the order as it is.
    """

    lag: int
    since: int
    reverse: bool
    left: float
    gain: float


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
