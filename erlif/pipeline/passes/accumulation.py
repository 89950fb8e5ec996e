"""Ratios of the frames of one trigger, summed in one pass over each.

The reference is `erlif.ratio.RatioSum`.
"""

from __future__ import annotations

import numba
import numpy as np

from erlif.pipeline.passes.buffers import empty_image
from erlif.pipeline.passes.pair import PairRatio
from erlif.pipeline.passes.rows import (
    PAD,
    STATES,
    Part,
    Place,
    Ring,
    across,
    add_squares,
    number_parts,
    table_of,
)

_ZERO, _NONE, _NAN = np.float32(0), np.uint8(0), np.float32(np.nan)
_BELOW_IMAGE = np.uint8(1)
_HALF = 4
"""Rows between a pixel and the end of the square whose mean variance gives its weight. [px]"""


_SINGLE, _SEVERAL = 17, 9
_NOISE, _NOISE_2, _NOISE_4 = Ring(0, _SINGLE), Ring(17, _SEVERAL), Ring(26, _SEVERAL)
_SHARES = [Ring(35), Ring(36), Ring(37)]
_PAIR, _DOWN = Ring(38), Ring(39)
_COUNT_9, _PIXELS_9, _SPREAD, _ROWS = 40, 41, 42, 43
"""Rows of the buffer; `erlif.pipeline.passes.rows` explains the rings."""

_PARTS = [
    Part(
        [
            (_NOISE_2, Place(_NOISE), Place(_NOISE, 16)),
            (_NOISE_4, Place(_NOISE_2), Place(_NOISE_2, 7)),
        ]
    ),
    Part(across(Ring(_COUNT_9), 9, _SHARES, Ring(_PIXELS_9)), _COUNT_9, 9),
    Part(
        [
            (_PAIR, Place(_NOISE_4), Place(_NOISE_4, 5)),
            (_DOWN, Place(_PAIR), Place(_NOISE, 9)),
            *across(_DOWN, 9, _SHARES, Ring(_SPREAD)),
        ]
    ),
]
_STEPS = number_parts(_PARTS)
_TABLE = table_of([step for part in _PARTS for step in part.steps])


class PairSum:
    """Frame pairs of one trigger, summed with inverse-variance weights without keeping them.

    Parameters
    ----------
    shape : tuple[int, int]
        Rows and columns of the images. [px]

    Examples
    --------
    A frame with a quarter of the variance has four times the weight:

    >>> image = np.ones((16, 16), np.float32)
    >>> flags = np.zeros(image.shape, np.uint8)
    >>> total = PairSum(image.shape)
    >>> none = 0 * image
    >>> for value, variance in ((0.5, 4e-4), (1.0, 1e-4)):
    ...     total.add(PairRatio(value * image, variance * image, none, none, flags, image))
    >>> round(float(total.mean().log_ratio[8, 8]), 6)
    0.9
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        """Rows and columns. [px]"""
        self.frames = 0
        """Frames that were added."""
        self._correlation = 0.0
        # single precision adds 1e-7 of a variance a frame; the ratio itself is worth more digits
        weight, var, fixed, shared = (empty_image(shape) for _ in range(4))
        ratio, flags = empty_image(shape, np.float64), empty_image(shape, np.uint8)
        self._sums = weight, ratio, var, fixed, shared, flags

    def add(self, pair: PairRatio) -> None:
        """Add a frame pair.

        Parameters
        ----------
        pair : PairRatio
        """
        width = self.shape[1]
        state = np.ones((STATES, width), np.uint8)
        rows = np.zeros((_ROWS, width + 2 * PAD), np.float32)
        images = pair.log_ratio, pair.variance, pair.variance_fixed, pair.variance_shared
        _add_frame(images, pair.flags, self.frames == 0, state, rows, self._sums)
        self.frames += 1
        self._correlation += pair.noise_correlation

    def mean(self) -> PairRatio:
        """Weighted mean of the frames that were added; its light is unknown.

        Returns
        -------
        PairRatio
            NaN with the flags of all frames where a pixel is valid in none.
        """
        log_ratio, variance, fixed, shared = (empty_image(self.shape) for _ in range(4))
        flags = empty_image(self.shape, np.uint8)
        if self.frames == 0:
            for image in (log_ratio, variance, fixed, shared):
                image.fill(np.nan)
            flags.fill(0)
        else:
            _average(self._sums, (log_ratio, variance, fixed, shared), flags)
        unknown = np.broadcast_to(_NAN, self.shape)
        correlation = self._correlation / max(self.frames, 1)
        return PairRatio(log_ratio, variance, fixed, shared, flags, unknown, correlation)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _enter(variance, fixed, flags, i, extra, state, s, rows, k):  # type: ignore[no-untyped-def]
    """Row i of the flags, with extra bits, and of the variance that is new in this frame."""
    for j in range(flags.shape[1]):
        bits = flags[i, j] | extra
        state[s, j] = bits
        rows[k, j + PAD] = variance[i, j] - fixed[i, j] if bits == 0 else _ZERO


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _add_row(images, flags, i, first, rows, sums):  # type: ignore[no-untyped-def]
    """Add row i to the sums, or begin them with it."""
    log_ratio, variance, fixed, shared = images
    weight, ratio, var, total_fixed, total_shared, total_flags = sums
    for j in range(flags.shape[1]):
        sound = flags[i, j] == 0
        w = rows[_PIXELS_9, j] / rows[_SPREAD, j] if sound else _ZERO
        new = variance[i, j] - fixed[i, j]

        # errors of one frame add in quadrature, those common to all frames linearly
        weight[i, j] = (_ZERO if first else weight[i, j]) + w
        ratio[i, j] = (0.0 if first else ratio[i, j]) + (w * log_ratio[i, j] if sound else _ZERO)
        var[i, j] = (_ZERO if first else var[i, j]) + (w * w * new if sound else _ZERO)
        repeated = w * fixed[i, j] if sound else _ZERO
        total_fixed[i, j] = (_ZERO if first else total_fixed[i, j]) + repeated
        common = w * shared[i, j] if sound else _ZERO
        total_shared[i, j] = (_ZERO if first else total_shared[i, j]) + common
        total_flags[i, j] = (_NONE if first else total_flags[i, j]) | flags[i, j]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _add_frame(images, flags, first, state, rows, sums):  # type: ignore[no-untyped-def]
    """Add the images of a frame to the sums."""
    _, variance, fixed, _ = images
    bottom_row = flags.shape[0] - 1
    for u in range(flags.shape[0] + _HALF):
        at, extra = min(u, bottom_row), _NONE if u <= bottom_row else _BELOW_IMAGE
        _enter(variance, fixed, flags, at, extra, state, u % STATES, rows, u % _SINGLE)
        add_squares(state, rows, _TABLE, _STEPS, u, u >= _HALF)
        if u >= _HALF:
            _add_row(images, flags, u - _HALF, first, rows, sums)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def _average(sums, images, flags):  # type: ignore[no-untyped-def]
    """Fill the images of the mean, and its flags."""
    weight, ratio, var, total_fixed, total_shared, total_flags = sums
    log_ratio, variance, fixed, shared = images
    for i in range(weight.shape[0]):
        for j in range(weight.shape[1]):
            w = weight[i, j]
            some = w > _ZERO
            # the variance of independent errors falls with the weights, of repeated ones it stays
            repeated = total_fixed[i, j] / w
            log_ratio[i, j] = np.float32(ratio[i, j] / w) if some else _NAN
            variance[i, j] = var[i, j] / (w * w) + repeated if some else _NAN
            fixed[i, j] = repeated if some else _NAN
            shared[i, j] = total_shared[i, j] / w if some else _NAN
            flags[i, j] = _NONE if some else total_flags[i, j]
