"""Mean and minimum film thickness of one trigger, with their uncertainties."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array, FlagImage
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.trend.gap import BLOCK, fit_gap_minimum, noise_correlation
from erlif.trend.region import Region

_LEAST_PIXELS = 64
"""Measurable pixels of a mean, at least."""

_BINS = 4000
"""Bins of log ratio over the calibrated range, far narrower than the noise of a pixel."""


@dataclass(frozen=True)
class FilmStatistics:
    """Film thickness of one trigger, over the region of interest.

    Attributes
    ----------
    mean : float
        Mean over the measurable pixels. [um]
    mean_std : float
        Random and shared errors together. [um]
    mean_random_std : float
        The part of it that is new at every trigger. [um]
    mean_gradient : Array
        Change of the mean with what was fitted to the fixture, (parameter,), in the order of
        `Calibration.full_covariance`.
    minimum : float
        Minimum of a smooth gap. [um]
    minimum_std : float
        Random and shared errors together, marks of the surfaces included. [um]
    minimum_random_std : float
        The part of it that is new at every trigger. [um]
    minimum_surface_std : float
        The part that marks and waviness of the surfaces leave, the same at every trigger. [um]
    minimum_gradient : Array
        As mean_gradient, for the minimum.
    beyond_range : float
        Share of the region outside the measurable range. The mean is that of the rest; the
        minimum is not affected. [1]
    """

    mean: float
    mean_std: float
    mean_random_std: float
    mean_gradient: Array
    minimum: float
    minimum_std: float
    minimum_random_std: float
    minimum_surface_std: float
    minimum_gradient: Array
    beyond_range: float


class _Mean(NamedTuple):
    value: float
    random_std: float
    gradient: Array


def summarise_film(
    ratios: RatioImages,
    maps: ThicknessMaps,
    calibration: Calibration,
    *,
    x: Array,
    y: Array,
    region: Region,
    sliding_along_x: bool = True,
) -> FilmStatistics:
    """Mean and minimum film thickness of one trigger over a region.

    The mean is that of the measurable film, corrected for the bias that noise causes where the
    inverse of the ratio is curved. The minimum is that of a smooth gap (`erlif.trend.gap`).

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of the trigger, its variances and flags.
    maps : ThicknessMaps
        The maps that `measure_thickness` made of them.
    calibration : Calibration
    x, y : array
        Pixel positions. [mm]
    region : Region
    sliding_along_x : bool
        Whether image x is the sliding direction.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels.

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    An even film of 3 um:

    >>> import xarray as xr
    >>> from erlif.core.products import RatioImages
    >>> from erlif.plots import example_calibration
    >>> from erlif.thickness import measure_thickness
    >>> from erlif.trend import Region
    >>> calibration, position = example_calibration(), 0.1 * np.arange(64)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), np.full((64, 64), calibration.predict_log(3.0))),
    ...     "log_ratio_var": (("y", "x"), np.full((64, 64), 1e-6)),
    ...     "log_ratio_var_shared": (("y", "x"), np.zeros((64, 64))),
    ...     "flags": (("y", "x"), np.zeros((64, 64), np.uint8)),
    ... }))
    >>> found = summarise_film(
    ...     ratios,
    ...     measure_thickness(ratios, calibration),
    ...     calibration,
    ...     x=position,
    ...     y=position,
    ...     region=Region(slice(0, 64), slice(0, 64)),
    ... )
    >>> round(found.mean, 2), round(found.minimum, 2), found.beyond_range
    (3.0, 3.0, 0.0)
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    mean = _average_film(ratios, maps, calibration, region)
    minimum = fit_gap_minimum(
        ratios, calibration, x=x, y=y, region=region, sliding_along_x=sliding_along_x
    )

    covariance = calibration.full_covariance
    mean_shared = float(mean.gradient @ covariance @ mean.gradient)
    minimum_shared = float(minimum.gradient @ covariance @ minimum.gradient)
    return FilmStatistics(
        mean=mean.value,
        mean_std=math.sqrt(mean.random_std**2 + mean_shared),
        mean_random_std=mean.random_std,
        mean_gradient=mean.gradient,
        minimum=minimum.value,
        minimum_std=math.sqrt(minimum.random_std**2 + minimum.surface_std**2 + minimum_shared),
        minimum_random_std=minimum.random_std,
        minimum_surface_std=minimum.surface_std,
        minimum_gradient=minimum.gradient,
        beyond_range=_share_beyond_range(maps.flags.values[region.rows, region.columns]),
    )


def _share_beyond_range(flags: FlagImage) -> float:
    """Share of the otherwise valid pixels whose film lies outside the measurable range."""
    beyond = (flags == Flag.BELOW_RANGE) | (flags == Flag.ABOVE_RANGE)
    sound = int((flags == 0).sum()) + int(beyond.sum())
    return float(beyond.sum()) / sound if sound else 0.0


def _average_film(
    ratios: RatioImages, maps: ThicknessMaps, calibration: Calibration, region: Region
) -> _Mean:
    """Mean over the pixels of the measurable range, independent of the noise of single pixels.

    The inverse h of the log ratio r is expanded about the mean log ratio m of the surroundings of
    each pixel, h(m) + h' (r - m) + h'' ((r - m)^2 - variance) / 2. The mean of this is the mean
    film whatever the size of the noise.
    """
    within = region.rows, region.columns
    near = maps.log_ratio_near.values[within]
    good = np.isfinite(near)
    if good.sum() < _LEAST_PIXELS:
        return _Mean(math.nan, math.nan, np.full(len(calibration.full_covariance), math.nan))
    near = near[good].astype(float)
    off = ratios.log_ratio.values[within][good] - near
    variance = ratios.log_ratio_var.values[within][good].astype(float)
    displaced = ratios.log_ratio_var_shared.values[within][good].astype(float)

    # film, slope, curvature and gradient change slowly with the ratio: evaluate them once per bin
    first, last = calibration.predict_log(calibration.thickness_range)
    place = np.clip(((near - first) * (_BINS / (last - first))).astype(np.intp), 0, _BINS - 1)
    centre = first + (np.arange(_BINS) + 0.5) * (last - first) / _BINS
    table = calibration.inverse
    grid = table.start + table.step * np.arange(table.thickness.size)
    film = np.interp(centre, grid, table.thickness)
    rate = 1 / calibration.slope(film)
    curvature = np.gradient(rate, centre)

    count = np.bincount(place, minlength=_BINS)
    size = near.size
    off += near - centre[place]
    linear = np.bincount(place, off, _BINS)
    square = np.bincount(place, off**2 - variance, _BINS)
    mean = float((film * count + rate * linear + 0.5 * curvature * square).sum()) / size
    gradient = -(calibration.gradient(film) * rate * count).sum(axis=1) / size

    noise = float((rate**2 * np.bincount(place, variance, _BINS)).sum())
    random = math.sqrt(noise_correlation(ratios) * noise) / size

    # the error of the displacement is common to neighbours, the gradient of light that it acts on
    # is not: the product is correlated over about one block
    registration = math.sqrt(float((rate**2 * np.bincount(place, displaced, _BINS)).sum())) / size
    return _Mean(mean, math.hypot(random, BLOCK * registration), gradient)
