"""Mean and minimum film thickness of one trigger, with their uncertainties."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array, FlagImage
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.trend.gap import _BLOCK, _correlation, _least_film


@dataclass(frozen=True)
class FilmStatistics:
    """Film of one trigger, summed up over the region of interest.

    Attributes
    ----------
    mean, mean_std, minimum, minimum_std : float
        [um]; the standard deviations hold random and shared errors.
    mean_gradient, minimum_gradient : array, (parameter,)
        Change of mean and minimum with what was fitted to the fixture, in the order of `Calibration.full_covariance`.
    mean_random_std, minimum_random_std : float
        Parts of them that are new at every trigger. [um]
    minimum_surface_std : float
        Part of minimum_std that the surfaces leave, marks and waviness about a smooth gap; the same at every trigger. [um]
    censored : float
        Share of the region whose film is too thin or too thick to be answered. The mean is that of the rest and leans to the
        other side; the minimum is not touched. [1]
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
    censored: float


def summarise_film(
    ratios: RatioImages,
    maps: ThicknessMaps,
    calibration: Calibration,
    *,
    x: Array,
    y: Array,
    rows: slice,
    columns: slice,
    sliding_along_x: bool = True,
) -> FilmStatistics:
    """Mean and least film of one trigger over a region.

    The mean is that of the film within the range, freed of the bias that noise leaves where the inverse of the ratio is curved. The
    minimum is that of a smooth gap, a parabola along the sliding direction plus a tilt across it, whose ratio is fitted to
    the measured ratio with weights: no pixel is lost to the limits of the range, and none is trusted alone.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio (y, x) of the trigger.
    maps : ThicknessMaps
        What `measure_thickness` made of it.
    calibration : Calibration
    x, y : array
        Pixel positions. [mm]
    rows, columns : slice
        The region of interest.
    sliding_along_x : bool
        Whether image x is the sliding direction.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels.
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    mean, mean_random, mean_gradient = _mean_film(ratios, maps, calibration, rows, columns)
    minimum, minimum_random, minimum_surface, minimum_gradient = _least_film(
        ratios, calibration, x, y, rows, columns, sliding_along_x=sliding_along_x
    )
    covariance = calibration.full_covariance
    return FilmStatistics(
        mean,
        math.sqrt(mean_random**2 + float(mean_gradient @ covariance @ mean_gradient)),
        mean_random,
        mean_gradient,
        minimum,
        math.sqrt(
            minimum_random**2
            + minimum_surface**2
            + float(minimum_gradient @ covariance @ minimum_gradient)
        ),
        minimum_random,
        minimum_surface,
        minimum_gradient,
        _share_beyond_range(maps.flags.values[rows, columns]),
    )


def _share_beyond_range(flags: FlagImage) -> float:
    """Share of the pixels with light and without other fault whose film lies beyond the range of the calibration."""
    beyond = (flags == Flag.BELOW_RANGE) | (flags == Flag.ABOVE_RANGE)
    sound = int((flags == 0).sum()) + int(beyond.sum())
    return float(beyond.sum()) / sound if sound else 0.0


def _mean_film(
    ratios: RatioImages, maps: ThicknessMaps, calibration: Calibration, rows: slice, columns: slice
) -> tuple[float, float, Array]:
    """Mean over the pixels within the range, whatever their own noise made of them.

    The inverse of the ratio is taken about the mean ratio of each pixel's surroundings, to second order in what the pixel differs
    from that: h(m) + h' (r - m) + h'' ((r - m)^2 - variance) / 2, whose mean is that of the film however large the noise is.
    """
    near = maps.log_ratio_near.values[rows, columns]
    good = np.isfinite(near)
    if good.sum() < 64:
        return math.nan, math.nan, np.full(len(calibration.full_covariance), math.nan)
    near = near[good].astype(float)
    off = ratios.log_ratio.values[rows, columns][good] - near
    variance = ratios.log_ratio_var.values[rows, columns][good].astype(float)
    displaced = ratios.log_ratio_var_shared.values[rows, columns][good].astype(float)
    # film, slope, curvature and gradient change slowly with the ratio: evaluate them once per narrow bin
    first, last = calibration.predict_log(calibration.thickness_range)
    bins = 4000
    place = np.clip(((near - first) * (bins / (last - first))).astype(np.intp), 0, bins - 1)
    centre = first + (np.arange(bins) + 0.5) * (last - first) / bins
    table = calibration.inverse
    film = np.interp(
        centre, table.start + table.step * np.arange(table.thickness.size), table.thickness
    )
    rate = 1 / calibration.slope(film)
    curvature = np.gradient(rate, centre)  # of thickness over the logarithm of the ratio
    count = np.bincount(place, minlength=bins)
    size = near.size
    off += near - centre[place]
    linear, square = (np.bincount(place, values, bins) for values in (off, off**2 - variance))
    mean = float((film * count + rate * linear + 0.5 * curvature * square).sum()) / size
    gradient = -(calibration.gradient(film) * rate * count).sum(axis=1) / size
    random = (
        math.sqrt(
            _correlation(ratios) * float((rate**2 * np.bincount(place, variance, bins)).sum())
        )
        / size
    )
    registration = math.sqrt(float((rate**2 * np.bincount(place, displaced, bins)).sum())) / size
    # neighbours share the displacement error but not the sign of the gradient it meets: correlated over about 8 pixels
    return mean, math.hypot(random, _BLOCK * registration), gradient
