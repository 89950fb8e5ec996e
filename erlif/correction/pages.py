"""Pages of one light level, reduced to mean and temporal variance."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array


class PageStack:
    """Mean and temporal variance of each pixel over pages that are added one at a time.

    Pages may be scaled to one brightness as they are added; the scales are kept, because they
    change the variance.

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

    def __init__(self, first: Array) -> None:
        self.count = 0
        self.first = first
        self.total, self.squares = np.zeros(first.shape), np.zeros(first.shape)
        self.scales: list[float] = []

    def add(self, page: Array, *, scale: float = 1.0) -> None:
        """Add `scale` times a page (y, x)."""
        # differences from the first page: sums of squares of the counts would cancel
        difference = scale * page - self.first
        self.count += 1
        self.scales.append(scale)
        self.total += difference
        self.squares += difference**2

    @property
    def mean(self) -> Array:
        """Mean (y, x) over the pages."""
        return self.first + self.total / self.count

    @property
    def variance(self) -> Array:
        """Unbiased temporal variance (y, x); zero for a single page."""
        return np.maximum(self.squares - self.total**2 / self.count, 0.0) / max(self.count - 1, 1)
