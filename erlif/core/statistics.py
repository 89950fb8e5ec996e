"""Statistics of samples that hold outliers."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import AnyArray

SAMPLED = 200_000
"""Pixels from which the median of a whole image is taken: to 0.3 % of the standard deviation."""

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


def sample_pixels(image: AnyArray, most: int = SAMPLED) -> AnyArray:
    """Evenly spread pixels of an image, for statistics that need not visit all of them.

    Parameters
    ----------
    image : array
    most : int
        Number of pixels, about; smaller images are returned whole.

    Returns
    -------
    array, (pixel,)
        A view where the image is contiguous.

    Examples
    --------
    >>> sample_pixels(np.arange(12).reshape(3, 4), most=3)
    array([ 0,  5, 10])
    """
    # without a factor in common with the width, so that every column takes part
    step, width = max(1, image.size // most), image.shape[-1]
    while math.gcd(step, width) > 1:
        step += 1
    return image.ravel()[::step]
