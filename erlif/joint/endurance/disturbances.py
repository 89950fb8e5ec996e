"""Disturbances of friction that the noise of `erlif.joint.endurance.noise` does not describe.

Single bad samples, bursts, and noise whose correlation has another form make small p-values. A
sample far from its neighbours is replaced by their median. Where the scatter is locally larger, the
samples weigh less.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter, uniform_filter1d

from erlif.core.arrays import Array
from erlif.core.statistics import MAD_TO_STD, robust_std

_NEIGHBOURS = 7  # blocks of the running median: three that are alike are no spike
_FAR = 4.0  # standard deviations from the median of the neighbours, from which on it is a spike

_LOCAL = 11  # blocks of the local scatter
_ORDINARY = 3.0  # variance of so many over that of all which chance explains


def replace_spikes(values: Array) -> Array:
    """Replace values far from their neighbours by the median of these; a lasting step stays.

    Parameters
    ----------
    values : array, (n,)

    Returns
    -------
    array, (n,)

    Examples
    --------
    >>> values = np.sin(np.arange(40.0))
    >>> values[30] = 9.0
    >>> np.flatnonzero(replace_spikes(values) != values).tolist()
    [30]
    """
    middle = median_filter(values, _NEIGHBOURS, mode="nearest")
    away = values - middle
    # in a burst of noise no value is far
    near = MAD_TO_STD * median_filter(np.abs(away), _LOCAL, mode="nearest")
    scatter = np.maximum(robust_std(away), near)
    return np.asarray(np.where(np.abs(away) > _FAR * scatter, middle, values))


def local_scale(residuals: Array) -> Array:
    """Compute the scatter of whitened residuals near each over the ordinary one; 1 where less.

    Parameters
    ----------
    residuals : array, (n,)
        White noise where the model holds.

    Returns
    -------
    array, (n,)
        At least 1. [1]

    Examples
    --------
    >>> residuals = np.resize([1.0, -1.0], 100)
    >>> residuals[70:] *= 6
    >>> np.round(local_scale(residuals)[[0, 40, 85]], 1).tolist()
    [1.0, 1.0, 6.0]
    """
    square = uniform_filter1d(residuals**2, _LOCAL, mode="reflect")
    ordinary = max(float(np.median(square)), np.finfo(float).tiny)
    # a burst is as strong at its ends, where the mean holds quiet blocks
    square = maximum_filter1d(square, _LOCAL, mode="nearest")
    return np.sqrt(np.where(square > _ORDINARY * ordinary, square / ordinary, 1.0))
