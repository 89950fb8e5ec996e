"""Excess of the mean log ratio where one camera shows less of the texture.

The mean logarithm of a textured light lies below the logarithm of its mean, by half the relative
variance of the texture. Where blur or interpolation takes texture from one camera, the mean log
ratio errs by half the difference of the variances. The mean that is weighted with the light does
not: ``(a + b)/2 ln(b/a)`` is ``b - a`` to the second order of their difference, and the mean light
of a blurred camera is that of a sharp one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import Array, Image, Mask
from erlif.core.products import AlignedFrames, RatioImages, require

# Width of the surroundings in whose mean light and mean ratio beam and film are contained. [px]
_WIDTH = 9

# Share of the surroundings that is sound, at least. [1]
_SOUND = 0.5

# Pixels that count as one independent: the products of texture and noise are nearly uncorrelated.
_CORRELATED = 1.5


@dataclass
class ExcessSums:
    """Sums over pixels from which the excess follows.

    Attributes
    ----------
    total : float
        Sum of the excess of each pixel. [1]
    squared : float
        Sum of its squares. [1]
    pixels : int
        Pixels in the sums.

    Examples
    --------
    Grains of 20 % contrast, of which camera 2 shows 15 %; the variances differ by 0.0175:

    >>> import xarray as xr
    >>> y, x = np.indices((64, 64))
    >>> grains = np.sin(2 * np.pi * x / 3) * np.sin(2 * np.pi * y / 3) * 2
    >>> dims = ("camera", "frame", "y", "x")
    >>> light = np.array([[1 + 0.2 * grains], [1 + 0.15 * grains]])
    >>> frames = AlignedFrames(xr.Dataset({
    ...     "signal": (dims, light),
    ...     "signal_var": (dims, 0 * light),
    ...     "signal_var_fixed": (dims, 0 * light),
    ... }))
    >>> log_ratio = np.log(light[1] / light[0])
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (dims[1:], log_ratio), "flags": (dims[1:], 0 * y[None]),
    ... }))
    >>> sums = ExcessSums()
    >>> sums.add(frames, ratios, ratios)
    >>> round(sums.solve()[0], 4), round(float(log_ratio.mean()), 4)
    (0.0092, 0.0091)
    """

    total: float = 0.0
    squared: float = 0.0
    pixels: int = 0

    def add(self, frames: AlignedFrames, ratios: RatioImages, corrected: RatioImages) -> None:
        """Add aligned frames and their ratio.

        Parameters
        ----------
        frames : AlignedFrames
            signal, signal_var and signal_var_fixed (camera, frame, y, x).
        ratios : RatioImages
            log_ratio and flags (frame, y, x), the ghost of the texture not subtracted.
        corrected : RatioImages
            log_ratio with the ghost subtracted, whose mean over the sound pixels is not zero.

        Raises
        ------
        ErlifError
            If a variable is missing.
        """
        require(frames, "signal", "signal_var", "signal_var_fixed")
        require(ratios, "log_ratio", "flags")
        require(corrected, "log_ratio")
        variance = frames.signal_var.values + frames.signal_var_fixed.values
        for n, log_ratio in enumerate(ratios.log_ratio.values):
            sound = ratios.flags.values[n] == 0
            used, found = _excess_share(
                frames.signal.values[:, n], variance[:, n], log_ratio, sound
            )
            found += (corrected.log_ratio.values[n] - log_ratio)[used]
            self.total += float(found.sum())
            self.squared += float(found @ found)
            self.pixels += found.size

    def solve(self) -> tuple[float, float]:
        """Excess of the mean log ratio and its standard deviation; 0 without pixels. [1]"""
        if not self.pixels:
            return 0.0, 0.0
        mean = self.total / self.pixels
        spread = max(self.squared / self.pixels - mean**2, 0.0)
        return mean, math.sqrt(_CORRELATED * spread / self.pixels)


def _excess_share(
    light: Image, variance: Image, log_ratio: Image, sound: Mask
) -> tuple[Mask, Array]:
    """The pixels used, and their share of the excess before the ghost is subtracted.

    It is the covariance of the light, relative to its surroundings, and the log ratio, with its
    sign reversed: the mean log ratio less the mean that is weighted with the light.
    """
    count = np.maximum(_sum_around(sound), 1)
    used = sound & (count > _SOUND * _WIDTH**2)

    def of_surroundings(image: Image) -> Array:
        """Mean of the sound pixels about each pixel that is used."""
        return np.asarray((_sum_around(np.where(sound, image, 0)) / count)[used])

    about = np.stack([of_surroundings(image) for image in light])
    here, part = light[:, used].astype(float), 1 - 1 / count[used]
    relative = 0.5 * (here / about).sum(axis=0) - 1
    rest = log_ratio[used] - of_surroundings(log_ratio)

    # noise is in the light and in the ratio; the pixel itself is one of its surroundings
    of_one, of_two = variance[:, used] / (here * about)
    return used, np.asarray(0.5 * part * (of_two - of_one) - relative * rest)


def _sum_around(image: Image | Mask) -> Array:
    """Sum over the surroundings of each pixel."""
    size, border = (_WIDTH, _WIDTH), cv2.BORDER_CONSTANT
    values = np.asarray(image, float)
    return np.asarray(cv2.boxFilter(values, -1, size, normalize=False, borderType=border))
