"""Statistics of samples that hold outliers."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import AnyArray

MAD_TO_STD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation, 1/Phi^-1(3/4)."""


def robust_std(values: AnyArray) -> float:
    """Standard deviation about the median, from the median absolute deviation.

    Parameters
    ----------
    values : array
        Without NaN.

    Returns
    -------
    float
        In the unit of the values.

    Examples
    --------
    >>> robust_std(np.array([-1.0, 0.0, 1.0, 0.0, 1000.0]))
    1.4826
    """
    return float(MAD_TO_STD * np.median(np.abs(values - np.median(values))))


def robust_rms(values: AnyArray) -> float:
    """Standard deviation about zero, from the median of absolute values.

    Parameters
    ----------
    values : array
        Residuals, without NaN.

    Returns
    -------
    float
        In the unit of the values.

    Examples
    --------
    >>> robust_rms(np.array([-2.0, 2.0, 1000.0]))
    2.9652
    """
    return MAD_TO_STD * float(np.median(np.abs(values)))
