"""Preferred numbers of ISO 3."""

from __future__ import annotations

import math
from typing import Literal

Series = Literal["none", "R10", "R20", "R40"]

_R40 = (
    1.0, 1.06, 1.12, 1.18, 1.25, 1.32, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.12, 2.24, 2.36, 2.5,
    2.65, 2.8, 3.0, 3.15, 3.35, 3.55, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.3, 5.6, 6.0, 6.3, 6.7, 7.1,
    7.5, 8.0, 8.5, 9.0, 9.5,
)  # fmt: skip

_TOLERANCE = 1e-9  # a length that is a preferred number but for rounding stays


def round_up(length: float, series: Series) -> float:
    """Round a length up to the next preferred number in mm.

    Parameters
    ----------
    length : float
        Above 0. [m]
    series : str
        ``"R10"``, ``"R20"``, ``"R40"``, or ``"none"`` to leave it.

    Returns
    -------
    float
        [m]

    Examples
    --------
    >>> [round(round_up(37.067e-3, series) * 1e3, 6) for series in ("none", "R10", "R20", "R40")]
    [37.067, 40.0, 40.0, 37.5]
    """
    if series == "none" or not 0 < length < math.inf:
        return length
    numbers = _R40[:: {"R10": 4, "R20": 2, "R40": 1}[series]]
    millimetres = length * 1e3
    decade = math.floor(math.log10(millimetres))
    for power in (decade - 1, decade, decade + 1):
        for number in numbers:
            # the decimal number of the series, without the rounding of a product
            candidate = float(f"{number:g}e{power}")
            if candidate >= millimetres * (1 - _TOLERANCE):
                return float(f"{number:g}e{power - 3}")
    return length
