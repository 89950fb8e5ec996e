"""Ratios of several frames, combined with inverse-variance weights."""

from __future__ import annotations

import cv2
import numpy as np

from erlif.core.arrays import Array, Image
from erlif.core.speed.kernels import njit
from erlif.ratio.pair import PairRatio

# Width of the surroundings whose mean variance gives the weight of a pixel. [px]
_WIDTH = 9

# Step between the pixels whose median is the offset of the sums; a prime, to avoid columns.
_SAMPLE = 97

_NAN = np.float32(np.nan)


class RatioSum:
    """Frames of one trigger, summed with inverse-variance weights without keeping them.

    Shot and read noise are new in every frame and average out; the noise of dark and flat and the
    registration error do not. The weight of a pixel follows from the mean variance of its
    surroundings. Its own variance is correlated with its noise, and a mean weighted by it would be
    biased. A pixel is valid if it is valid in any frame; otherwise it keeps the flags of all.

    Parameters
    ----------
    shape : tuple[int, int]
        Rows and columns of the images. [px]

    Examples
    --------
    A frame with a quarter of the variance has four times the weight:

    >>> image = np.ones((16, 16), np.float32)
    >>> flags = np.zeros(image.shape, np.uint16)
    >>> total, none = RatioSum(image.shape), 0 * image
    >>> for value, variance in ((0.5, 4e-4), (1.0, 1e-4)):
    ...     weight = total.add(
    ...         PairRatio(value * image, variance * image, none, none, flags, image)
    ...     )
    >>> round(float(total.mean().log_ratio[8, 8]), 6)
    0.9
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        """Rows and columns. [px]"""
        self.frames = 0
        """Frames that were added."""
        self.weight: Array = np.zeros(shape)
        """Sum of the weights, (y, x). [1]"""
        # of the ratio, of the variance that is new in every frame, of both others
        self._sums = tuple(np.zeros(shape) for _ in range(4))
        self._flags = np.zeros(shape, np.uint16)
        self._correlation = 0.0

    def add(self, pair: PairRatio) -> Image:
        """Add a frame pair.

        Parameters
        ----------
        pair : PairRatio

        Returns
        -------
        array, (y, x)
            Weights of its pixels: one over the mean of the surroundings of the variance that is new
            in this frame; 0 where the pixel is flagged. [1]
        """
        # new variance alone weighs: what repeats does not average out
        weight = _weigh(pair)
        images = pair.log_ratio, pair.variance, pair.variance_fixed, pair.variance_shared
        _add_frame(weight, images, pair.flags, self.weight, self._sums, self._flags)
        self.frames += 1
        self._correlation += pair.noise_correlation
        return weight

    def mean(self) -> PairRatio:
        """Weighted mean of the frames that were added; its light is unknown.

        Returns
        -------
        PairRatio
            NaN with the flags of all frames where a pixel is valid in none.
        """
        log_ratio, variance, fixed, shared = np.empty((4, *self.shape), np.float32)
        flags = np.empty(self.shape, np.uint16)
        images = log_ratio, variance, fixed, shared
        _fill_mean(self.weight, self._sums, self._flags, images, flags)
        unknown = np.broadcast_to(_NAN, self.shape)
        correlation = self._correlation / max(self.frames, 1)
        return PairRatio(log_ratio, variance, fixed, shared, flags, unknown, correlation)


def _weigh(pair: PairRatio) -> Image:
    """Weights of the pixels of a frame; sums over squares from OpenCV's box filter."""
    sound = pair.flags == 0
    values = pair.variance - pair.variance_fixed

    # differences from the median: in single precision, sums of large values lose digits
    sample = values[sound][::_SAMPLE]
    middle = np.median(sample) if sample.size else np.float32(0)
    values -= middle
    values[~sound] = 0
    count = sound.astype(np.float32)
    for image in (values, count):
        size, border = (_WIDTH, _WIDTH), cv2.BORDER_CONSTANT
        cv2.boxFilter(image, -1, size, dst=image, normalize=False, borderType=border)

    # one over the mean variance of the surroundings
    values /= np.maximum(count, 1, out=count)
    values += middle
    weights: Image = np.divide(1, values, out=np.zeros_like(values), where=sound)
    return weights


@njit(nogil=True, cache=True, error_model="numpy")
def _add_frame(frame_weight, images, flag, weight, sums, flags):  # type: ignore[no-untyped-def]
    """Add the images of a frame to the sums."""
    log_ratio, variance, fixed, shared = images
    ratio, new, total_fixed, total_shared = sums
    for i in range(flag.shape[0]):
        for j in range(flag.shape[1]):
            flags[i, j] |= flag[i, j]
            if flag[i, j] == 0:
                w = frame_weight[i, j]
                weight[i, j] += w
                ratio[i, j] += w * log_ratio[i, j]

                # errors of one frame add in quadrature, those common to all frames linearly
                new[i, j] += w * w * (variance[i, j] - fixed[i, j])
                total_fixed[i, j] += w * fixed[i, j]
                total_shared[i, j] += w * shared[i, j]


@njit(nogil=True, cache=True, error_model="numpy")
def _fill_mean(weight, sums, total_flags, images, flags):  # type: ignore[no-untyped-def]
    """Fill the images of the mean, and its flags."""
    ratio, new, total_fixed, total_shared = sums
    log_ratio, variance, fixed, shared = images
    for i in range(flags.shape[0]):
        for j in range(flags.shape[1]):
            w = weight[i, j]
            some = w > 0
            # the variance of independent errors falls with the weights, of repeated ones it stays
            repeated = total_fixed[i, j] / w
            log_ratio[i, j] = np.float32(ratio[i, j] / w) if some else _NAN
            variance[i, j] = np.float32(new[i, j] / (w * w) + repeated) if some else _NAN
            fixed[i, j] = np.float32(repeated) if some else _NAN
            shared[i, j] = np.float32(total_shared[i, j] / w) if some else _NAN
            flags[i, j] = 0 if some else total_flags[i, j]
