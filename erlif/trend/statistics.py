"""Mean and minimum film thickness of one trigger, with their uncertainties."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.trend.blocks import BLOCK, BlockSums, Region, sum_blocks
from erlif.trend.curve import FilmCurve
from erlif.trend.gap import MISFIT, GapMinimum, GapShape, choose_contact, find_gap_minima

_LEAST_PIXELS = 64  # measurable pixels of a mean, at least
_BEYOND = 0.1  # of the thickest calibrated film, by which a mean may lie beyond the range


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
        `RatioCurve.full_covariance`.
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
    minimum_place : Array
        Where the smooth gap has its minimum, (axis,): column and row of the image. [px]
    beyond_range : float
        Share of the region outside the measurable range. The mean is that of the rest; the
        minimum is not affected. [1]
    minimum_misfit : float
        Variance of smooth departures of the map from the gap, over that by noise and marks. [1]
    inverse : float
        Mean of the inverse of the film over the measurable pixels, to which its shear is in
        proportion. [1/um]
    inverse_random_std : float
        The part of its standard deviation that is new at every trigger. [1/um]
    inverse_gradient : Array
        As mean_gradient, for the inverse.
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
    minimum_place: Array
    beyond_range: float
    minimum_misfit: float = 0.0
    inverse: float = math.nan
    inverse_random_std: float = math.nan
    inverse_gradient: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def minimum_departs(self) -> bool:
        """Whether the departures of the map from the fitted gap exceed the limit."""
        return self.minimum_misfit > MISFIT

    def with_minimum(self, minimum: GapMinimum, covariance: Array) -> FilmStatistics:
        """Return a copy with the minimum of another gap; `covariance` as for `with_errors`."""
        return replace(self, **_numbers_of(minimum)).with_errors(covariance)

    def with_errors(self, covariance: Array) -> FilmStatistics:
        """Return a copy with the shared errors of another covariance.

        Parameters
        ----------
        covariance : array
            As `RatioCurve.full_covariance`.

        Returns
        -------
        FilmStatistics
        """
        mean, minimum = (
            float(gradient @ covariance @ gradient)
            for gradient in (self.mean_gradient, self.minimum_gradient)
        )
        own = self.minimum_random_std**2 + self.minimum_surface_std**2
        return replace(
            self,
            mean_std=math.sqrt(self.mean_random_std**2 + mean),
            minimum_std=math.sqrt(own + minimum),
        )


def summarise_film(
    ratios: RatioImages,
    maps: ThicknessMaps,
    calibration: RatioCurve,
    *,
    region: Region,
    sliding_along_x: bool = True,
    contacts: Sequence[GapShape] = (GapShape.LINE,),
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
    calibration : RatioCurve
    region : Region
    sliding_along_x : bool
        Whether image x is the sliding direction.
    contacts : sequence of GapShape
        The gap, or all of them, among which the curvatures of this trigger choose.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels; no minimum where no smooth gap describes
        the map.

    Raises
    ------
    ErlifError
        If `ratios` lacks a variable.

    Examples
    --------
    An even film of 3 um:

    >>> import xarray as xr
    >>> from erlif.core.products import RatioImages
    >>> from erlif.show.plots import example_calibration
    >>> from erlif.thickness import measure_thickness
    >>> from erlif.trend import Region
    >>> calibration = example_calibration()
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), np.full((64, 64), calibration.predict_log(3.0))),
    ...     "log_ratio_var": (("y", "x"), np.full((64, 64), 1e-6)),
    ...     "log_ratio_var_shared": (("y", "x"), np.zeros((64, 64))),
    ...     "flags": (("y", "x"), np.zeros((64, 64), np.uint16)),
    ... }))
    >>> found = summarise_film(
    ...     ratios,
    ...     measure_thickness(ratios, calibration),
    ...     calibration,
    ...     region=Region(slice(0, 64), slice(0, 64)),
    ... )
    >>> round(found.mean, 2), round(found.minimum, 2), found.beyond_range
    (3.0, 3.0, 0.0)
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    sums, curve = sum_blocks(ratios, region, maps), FilmCurve.of(calibration)
    minima = find_gap_minima(
        sums, curve, region=region, sliding_along_x=sliding_along_x, contacts=contacts
    )
    chosen = contacts[0] if len(contacts) == 1 else choose_contact([minima])
    return summarise_blocks(sums, curve, minima[chosen])


def summarise_blocks(sums: BlockSums, curve: FilmCurve, minimum: GapMinimum) -> FilmStatistics:
    """Mean and minimum film thickness from the sums over the blocks of a region.

    `summarise_film` does the same from images.

    Parameters
    ----------
    sums : BlockSums
    curve : FilmCurve
    minimum : GapMinimum
        From `find_gap_minimum`.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels.

    Examples
    --------
    A region without light has no film:

    >>> from erlif.show.plots import example_calibration
    >>> one = np.zeros((4, 4))
    >>> dark = BlockSums((32, 32), 0.0, *[one] * 12, valid=0, beyond=0)
    >>> whole, curve = Region(slice(0, 32), slice(0, 32)), FilmCurve.of(example_calibration())
    >>> from erlif.trend import find_gap_minimum
    >>> minimum = find_gap_minimum(dark, curve, region=whole, sliding_along_x=True)
    >>> summarise_blocks(dark, curve, minimum).mean
    nan
    """
    (mean, mean_random, mean_gradient), inverse = _average_film(sums, curve)
    found = FilmStatistics(
        mean=mean,
        mean_std=math.nan,
        mean_random_std=mean_random,
        mean_gradient=mean_gradient,
        **_numbers_of(minimum),
        minimum_std=math.nan,
        # of the otherwise valid pixels, those whose film lies outside the measurable range
        beyond_range=sums.beyond / max(sums.valid + sums.beyond, 1),
        inverse=inverse[0],
        inverse_random_std=inverse[1],
        inverse_gradient=inverse[2],
    )
    return found.with_errors(curve.calibration.full_covariance)


def _numbers_of(minimum: GapMinimum) -> dict[str, Any]:
    """Fields of `FilmStatistics` that a minimum determines."""
    return {
        "minimum": minimum.value,
        "minimum_random_std": minimum.random_std,
        "minimum_surface_std": minimum.surface_std,
        "minimum_gradient": minimum.gradient,
        "minimum_place": minimum.place,
        "minimum_misfit": minimum.misfit,
    }


def _average_film(sums: BlockSums, curve: FilmCurve) -> list[tuple[float, float, Array]]:
    """Mean over the measurable pixels, its random standard deviation and its gradient.

    Of the film, then of its inverse.

    The inverse h of the log ratio r is expanded about the mean log ratio m of each block,
    h(m) + h' (r - m) + h'' ((r - m)^2 - variance) / 2. The mean of this is the mean film whatever
    the size of the noise.
    """
    size = float(sums.measurable.sum())
    unknown = math.nan, math.nan, np.full(len(curve.gradient), math.nan)
    if size < _LEAST_PIXELS:
        return [unknown, unknown]
    some = sums.measurable > 0
    count, ratio, squared, variance, displaced = (
        each[some]
        for each in (sums.measurable, sums.ratio, sums.ratio_squared, sums.var, sums.displaced)
    )

    # the sums about the middle of a bin, from those about the offset
    place, distance = curve.find_bins(sums.offset + ratio / count)
    middle = ratio / count - distance
    linear = ratio - count * middle
    square = squared - 2 * middle * ratio + count * middle**2 - variance
    film, rate, curvature = (each[place] for each in (curve.film, curve.rate, curve.curvature))
    thin, per_film = 1 / film, -1 / film**2
    bent = 2 * rate**2 * thin**3 + curvature * per_film
    averages = []
    for value, first, second, slope in (
        (film, rate, curvature, np.ones_like(film)),
        (thin, per_film * rate, bent, per_film),
    ):
        mean = float((value * count + first * linear + 0.5 * second * square).sum()) / size
        gradient = curve.gradient @ np.bincount(place, count * slope, curve.film.size) / size
        random = math.sqrt(sums.noise_correlation * float((first**2 * variance).sum())) / size

        # the error of the displacement is common to neighbours, the gradient of light that it acts
        # on is not: the product is correlated over about one block
        registration = math.sqrt(float((first**2 * displaced).sum())) / size
        averages.append((mean, math.hypot(random, BLOCK * registration), gradient))

    # blocks whose ratio no film has are extrapolated, to thousands of um where most are such
    low, high = curve.calibration.thickness_range
    if not low - _BEYOND * high <= averages[0][0] <= high + _BEYOND * high:
        return [unknown, unknown]
    return averages
