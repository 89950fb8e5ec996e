"""Statistics of samples that hold outliers, and roots of covariances."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import AnyArray, Array

# Pixels from which the median of a whole image is taken: to 0.3 % of the standard deviation.
SAMPLED = 200_000

# Standard deviation of a normal distribution over its median absolute deviation, 1/Phi^-1(3/4).
MAD_TO_STD = 1.4826

_WITHIN = (0.5, 99.5)  # percentiles at the ends of a colour scale
_LEAST_SPAN, _ROOM = 0.02, 0.05  # of the film: least range of an axis; room at its ends


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
    """Standard deviation about zero, from the median of absolute values; as `robust_std`.

    Parameters
    ----------
    values : array
        Residuals.

    Returns
    -------
    float

    Examples
    --------
    >>> robust_rms(np.array([-2.0, 2.0, 1000.0]))
    2.9652
    """
    return MAD_TO_STD * float(np.median(np.abs(values)))


def neighbours_of(values: AnyArray, reach: int) -> AnyArray:
    """Values before and after each of a series, which is mirrored at its ends.

    Parameters
    ----------
    values : array, (row,)
    reach : int
        Neighbours on either side.

    Returns
    -------
    array, (row, 2 reach)

    Examples
    --------
    >>> neighbours_of(np.array([1, 2, 3]), 1)
    array([[2, 2],
           [1, 3],
           [2, 2]])
    """
    around = np.pad(values, reach, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(around, 2 * reach + 1)
    return np.delete(windows, reach, axis=1)


def central_range(values: AnyArray) -> tuple[float, float]:
    """Range of all but the 0.5 % lowest and highest values, as the ends of a colour scale.

    Parameters
    ----------
    values : array

    Returns
    -------
    tuple of float
        Of the finite values; 0 and 1 without any.

    Examples
    --------
    >>> central_range(np.append(np.linspace(0, 1, 1001), [np.nan, np.inf]))
    (0.005, 0.995)
    """
    known = values[np.isfinite(values)]
    if known.size == 0:
        return 0.0, 1.0
    low, high = np.percentile(known, _WITHIN)
    return float(low), float(high)


def film_limits(values: Array) -> tuple[float, float]:
    """Ends of an axis of film thickness, from the films with their error bands.

    Parameters
    ----------
    values : array
        Lower and upper ends of the bands, NaN where unknown. [um]

    Returns
    -------
    (float, float)
        From zero where the films vary by more than their smallest value, else with a little room.
        [um]

    Examples
    --------
    A film that varies by a few per cent, and one that comes close to contact:

    >>> low, high = film_limits(np.array([7.0, 8.0]))
    >>> print(f"{low:.2f} to {high:.2f}")
    6.95 to 8.05
    >>> low, high = film_limits(np.array([1.0, 8.0]))
    >>> print(f"{low:.2f} to {high:.2f}")
    0.00 to 8.35
    """
    known = values[np.isfinite(values)]
    if known.size == 0:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())

    # a range below that of the noise of a film would make noise look like a cycle
    span = max(high - low, _LEAST_SPAN * abs(high)) or 1.0
    middle, room = (low + high) / 2, (0.5 + _ROOM) * span
    return (0.0 if 0 <= low < span else middle - room), middle + room


def quadratic_surface(x: Array, y: Array) -> Array:
    """Terms of a surface that is smooth over an image, for least squares, (place, 6).

    Parameters
    ----------
    x, y : array, (place,)
        In any unit.

    Returns
    -------
    array, (place, 6)
        1, x, y, x^2, x y and y^2.

    Examples
    --------
    >>> quadratic_surface(np.array([2.0]), np.array([3.0]))
    array([[1., 2., 3., 4., 6., 9.]])
    """
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)


def covariance_root(covariance: Array) -> Array:
    """Compute a matrix whose square is a covariance that may be singular, (number, cause).

    Its numbers may have any unit.

    Parameters
    ----------
    covariance : array, (number, number)

    Returns
    -------
    array, (number, cause)
        Causes are independent and of unit variance.

    Examples
    --------
    >>> np.abs(covariance_root(np.diag([4.0, 9e-12])).sum(axis=1))
    array([2.e+00, 3.e-06])
    """
    scale, axes, sizes = _axes_of(covariance)
    return np.asarray(scale[:, np.newaxis] * axes * sizes)


def symmetric_root(covariance: Array) -> Array:
    """Compute a root of a covariance in which each cause acts mostly on one number.

    It is the symmetric root of the correlation, times the standard deviations.

    Parameters
    ----------
    covariance : array, (..., number, number)
        Rounding may have left small negative variances.

    Returns
    -------
    array, (..., number, cause)

    Examples
    --------
    >>> symmetric_root(np.diag([4.0, 9.0]))
    array([[2., 0.],
           [0., 3.]])
    """
    scale, axes, sizes = _axes_of(covariance)
    root = (axes * sizes[..., np.newaxis, :]) @ np.swapaxes(axes, -1, -2)
    return np.asarray(scale[..., np.newaxis] * root)


def _axes_of(covariance: Array) -> tuple[Array, Array, Array]:
    """Standard deviations, and axes of the correlation with the roots of its variances."""
    variances = np.diagonal(covariance, axis1=-2, axis2=-1)
    scale = np.sqrt(np.maximum(variances, np.finfo(float).tiny))
    unit = covariance / scale[..., np.newaxis, :] / scale[..., np.newaxis]
    variances, axes = np.linalg.eigh(unit)
    return scale, axes, np.sqrt(np.maximum(variances, 0.0))


def sample_pixels(image: AnyArray) -> AnyArray:
    """Evenly spread pixels of an image, for statistics that need not visit all of them.

    Parameters
    ----------
    image : array
        Smaller ones than `SAMPLED` are returned whole.

    Returns
    -------
    array, (pixel,)
        A view where the image is contiguous.

    Examples
    --------
    >>> sample_pixels(np.arange(1_200_000).reshape(3, -1))[:3]
    array([ 0,  7, 14])
    """
    # without a factor in common with the width, so that every column takes part
    step, width = max(1, image.size // SAMPLED), image.shape[-1]
    while math.gcd(step, width) > 1:
        step += 1
    return image.ravel()[::step]
