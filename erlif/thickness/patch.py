"""Means over a patch of known film in one frame pair."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.core.arrays import FlagImage, Image

# Valid pixels of a mean, at least.
_LEAST_PIXELS = 64


class PatchMean(NamedTuple):
    """Means over the patch in one frame pair; NaN where too few pixels are valid.

    Attributes
    ----------
    light : float
        Logarithm of the mean light of camera 1. [ln DN]
    log_ratio : float
        Mean logarithm of the ratio. [1]
    variance : float
        Variance of log_ratio by the noise of the pixels. [1]
    """

    light: float
    log_ratio: float
    variance: float


def sample_patch(
    light: Image,
    log_ratio: Image,
    variance: Image,
    flags: FlagImage,
    *,
    noise_correlation: float = 1.0,
) -> PatchMean:
    """Average light and ratio over the pixels of a patch.

    Parameters
    ----------
    light : array, (y, x)
        Light of camera 1. [DN]
    log_ratio : array, (y, x)
        Logarithm of camera 2 over camera 1. [1]
    variance : array, (y, x)
        Variance of log_ratio. [1]
    flags : array, (y, x)
        0 for valid pixels.
    noise_correlation : float
        Variance of a mean over many pixels, relative to that of independent pixels. [1]

    Returns
    -------
    PatchMean

    Examples
    --------
    >>> even = np.full((16, 16), 0.5, np.float32)
    >>> patch = sample_patch(1000 * even, even, 0.01 * even, np.zeros(even.shape, np.uint16))
    >>> round(float(np.exp(patch.light))), patch.log_ratio
    (500, 0.5)
    """
    # a patch under a bubble gives no mean
    valid = flags == 0
    count = int(valid.sum())
    if count < _LEAST_PIXELS:
        return NO_PATCH
    # in double precision: a patch may have many pixels
    total, ratio, noise = (
        float(image[valid].sum(dtype=float)) for image in (light, log_ratio, variance)
    )
    return PatchMean(
        float(np.log(total / count)) if total > 0 else float("nan"),
        ratio / count,
        noise / count**2 * noise_correlation,
    )


# Stands for a run without a patch, or a frame in which it is not seen.
NO_PATCH = PatchMean(float("nan"), float("nan"), float("nan"))
