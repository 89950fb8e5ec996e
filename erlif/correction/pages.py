"""Pages of one light level, reduced to mean and temporal variance."""

from __future__ import annotations

import cv2
import numpy as np

from erlif.core.arrays import AnyArray


def precision_of(page: AnyArray) -> type[np.float32] | type[np.float64]:
    """Precision in which pages like this one are summed: double only for double.

    Parameters
    ----------
    page : array

    Returns
    -------
    type

    Examples
    --------
    >>> precision_of(np.array([4095], np.uint16)).__name__
    'float32'
    """
    return np.float64 if page.dtype == np.float64 else np.float32


class PageStack:
    """Mean and temporal variance of each pixel over pages that are added one at a time.

    Pages may be scaled to one brightness as they are added; the scales are kept, because they
    change the variance. Counts and single precision are summed in single precision, whose rounding
    (6e-8 of the light) is far below the noise; double precision in double.

    Parameters
    ----------
    first : array, (y, x)
        Reference from which differences are summed. It is not counted until it is added.

    Examples
    --------
    >>> stack = PageStack(np.array([[10.0]]))
    >>> for value in (10.0, 12.0, 14.0):
    ...     stack.add(np.array([[value]]))
    >>> float(stack.mean[0, 0]), float(stack.variance[0, 0])
    (12.0, 4.0)
    """

    def __init__(self, first: AnyArray) -> None:
        self.count = 0
        precision = precision_of(first)
        self.first: AnyArray = np.ascontiguousarray(first, precision)
        self.total: AnyArray = np.zeros(first.shape, precision)
        self.squares: AnyArray = np.zeros(first.shape, precision)
        self.scales: list[float] = []
        self._difference: AnyArray = np.empty(first.shape, precision)

    def add(self, page: AnyArray, *, scale: float = 1.0) -> None:
        """Add `scale` times a page (y, x)."""
        # differences from the first page: sums of squares of the counts would cancel
        difference = self._difference
        depth = cv2.CV_64F if difference.dtype == np.float64 else cv2.CV_32F
        cv2.addWeighted(page, scale, self.first, -1.0, 0.0, difference, dtype=depth)
        self.count += 1
        self.scales.append(scale)
        cv2.accumulate(difference, self.total)
        cv2.accumulateSquare(difference, self.squares)

    @property
    def mean(self) -> AnyArray:
        """Mean (y, x) over the pages."""
        mean = self.total / self.count
        mean += self.first
        return mean

    @property
    def variance(self) -> AnyArray:
        """Unbiased temporal variance (y, x); zero for a single page."""
        variance = self.total * self.total
        variance /= -self.count
        variance += self.squares
        variance /= max(self.count - 1, 1)
        return np.asarray(np.maximum(variance, 0.0, out=variance))
