"""Statistics of samples that hold outliers."""

from __future__ import annotations

import numpy as np

from erlif.core.arrays import Array


def robust_std(values: Array) -> float:
    """Standard deviation of the bulk, from the median absolute deviation."""
    return float(1.4826 * np.median(np.abs(values - np.median(values))))
