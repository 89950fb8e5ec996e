"""Mean and minimum film thickness of one trigger, with their uncertainties."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.core.products import RatioImages, ThicknessMaps, require
from erlif.trend.blocks import BLOCK, BlockSums, Region, sum_blocks
from erlif.trend.contact import choose_contact
from erlif.trend.curve import FilmCurve
from erlif.trend.gap import MISFIT, GapMinimum, GapShape, find_gap_minima
from erlif.trend.number import FilmNumber

_LEAST_PIXELS = 64  # measurable pixels of a mean, at least
_WHOLE = 0.9  # share of its pixels from which a block shows the slope of the film
_WIDTH = (BLOCK**2 - 1) / 12  # variance of the places of the pixels of a block [px2]


@dataclass(frozen=True)
class FilmStatistics:
    """Film thickness of one trigger, over the region of interest.

    Attributes
    ----------
    mean : FilmNumber
        Mean over the measurable pixels.
    gap : GapMinimum
        Minimum and mean of a smooth gap.
    beyond_range : float
        Share of the region outside the measurable range. The mean is that of the rest; the
        gap is not affected. [1]
    inverse : FilmNumber
        Mean of the inverse of the film over the measurable pixels. [1/um]
    measured : float
        Share of the measurable pixels in the region. [1]
    noise_correlation : float
        As of the sums of the ratio. [1]
    """

    mean: FilmNumber
    gap: GapMinimum
    beyond_range: float
    inverse: FilmNumber
    measured: float = 1.0
    noise_correlation: float = 1.0

    @property
    def region_inverse(self) -> FilmNumber:
        """Mean inverse of the film over the whole region, to which its shear is in proportion.

        Where no film is measurable it is that of the gap; without a gap it is 0 to 2 times that of
        the rest. [1/um]
        """
        seen, unseen = self.inverse.scaled(self.measured), self.gap.unseen
        if math.isfinite(unseen.value):
            return seen.plus(unseen)
        unknown = (1 - self.measured) * self.inverse.value / math.sqrt(3)
        return self.inverse._replace(random_std=math.hypot(self.inverse.random_std, unknown))

    @property
    def departs(self) -> bool:
        """Whether the departures of the map from the fitted gap exceed the limit."""
        return self.gap.misfit > MISFIT


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
    >>> round(found.mean.value, 2), round(found.gap.minimum.value, 2), found.beyond_range
    (3.0, 3.0, 0.0)
    """
    require(ratios, "log_ratio", "log_ratio_var", "flags")
    sums, curve = sum_blocks(ratios, region, maps), FilmCurve.of(calibration)
    minima = find_gap_minima(
        sums, curve, region=region, sliding_along_x=sliding_along_x, contacts=contacts
    )
    chosen = contacts[0] if len(contacts) == 1 else choose_contact([minima])
    return summarise_blocks(sums, curve, minima[chosen], region=region)


def summarise_blocks(
    sums: BlockSums, curve: FilmCurve, minimum: GapMinimum, *, region: Region
) -> FilmStatistics:
    """Mean and minimum film thickness from the sums over the blocks of a region.

    `summarise_film` does the same from images.

    Parameters
    ----------
    sums : BlockSums
    curve : FilmCurve
    minimum : GapMinimum
        From `find_gap_minimum`.
    region : Region
        That of the sums.

    Returns
    -------
    FilmStatistics
        NaN where the region holds too few valid pixels.

    Examples
    --------
    A region without light has no film:

    >>> from erlif.show.plots import example_calibration
    >>> one = np.zeros((4, 4))
    >>> dark = BlockSums((32, 32), 0.0, *[one] * 11, valid=0, beyond=0)
    >>> whole, curve = Region(slice(0, 32), slice(0, 32)), FilmCurve.of(example_calibration())
    >>> from erlif.trend import find_gap_minimum
    >>> minimum = find_gap_minimum(dark, curve, region=whole, sliding_along_x=True)
    >>> summarise_blocks(dark, curve, minimum, region=whole).mean.value
    nan
    """
    # of the otherwise valid pixels, those whose film lies outside the measurable range
    beyond = sums.beyond / max(sums.valid + sums.beyond, 1)
    mean, inverse = _average_film(sums, curve, region)
    measured = float(sums.measurable.sum()) / math.prod(sums.size)
    return FilmStatistics(mean, minimum, beyond, inverse, measured, sums.noise_correlation)


def _average_film(sums: BlockSums, curve: FilmCurve, region: Region) -> list[FilmNumber]:
    """Mean over the measurable pixels, of the film and of its inverse.

    The inverse h of the log ratio r is expanded about the mean log ratio m of each block,
    h(m) + h'' (r - m)^2 / 2, with the scatter of r by the slope of the film alone: noise and
    textures that the two cameras do not share scatter too, and would make the film thicker.
    """
    some = sums.measurable > 0
    size = float(sums.measurable.sum())
    unknown = FilmNumber.unknown(curve.parameters)
    if size < _LEAST_PIXELS:
        return [unknown, unknown]
    count, ratio, variance, displaced = (
        each[some] for each in (sums.measurable, sums.ratio, sums.var, sums.displaced)
    )

    # the sums about the middle of a bin, from those about the offset
    place, distance = curve.find_bins(sums.offset + ratio / count)
    middle = ratio / count - distance
    linear, square = ratio - count * middle, count * _scatter_of_film(sums)[some]
    film, rate, curvature = (each[place] for each in (curve.film, curve.rate, curve.curvature))
    row, column = (
        pixels.start + BLOCK * block + 0.5 * (BLOCK - 1)
        for pixels, block in zip((region.rows, region.columns), np.nonzero(some), strict=True)
    )
    acts = -curve.calibration.gradient(film, place=(column, row)) * rate

    # each quantity with its derivatives: first and second by the log ratio, and by the film
    thin, per_film = 1 / film, -1 / film**2
    bent = 2 * rate**2 * thin**3 + curvature * per_film
    averages = []
    for value, first, second, slope in (
        (film, rate, curvature, np.ones_like(film)),
        (thin, per_film * rate, bent, per_film),
    ):
        mean = float((value * count + first * linear + 0.5 * second * square).sum()) / size
        gradient = acts @ (count * slope) / size
        random = math.sqrt(sums.noise_correlation * float((first**2 * variance).sum())) / size

        # the error of the displacement is common to neighbours, the gradient of light that it acts
        # on is not: the product is correlated over about one block
        registration = math.sqrt(float((first**2 * displaced).sum())) / size
        random = math.hypot(random, BLOCK * registration)
        averages.append(FilmNumber(mean, random, 0.0, gradient))

    # blocks whose ratio no film has are extrapolated, to thousands of um where most are such
    low, high = curve.calibration.thickness_range
    return averages if low <= averages[0].value <= high else [unknown, unknown]


def _scatter_of_film(sums: BlockSums) -> Array:
    """Variance of the log ratio within each block by the slope of the film, (row, column). [1]"""
    # the pixels of a block of which half is measurable lie to one side of its middle
    whole = sums.measurable > _WHOLE * BLOCK**2
    count = np.where(whole, sums.measurable, 1)
    means = np.where(whole, sums.ratio / count, np.nan)
    noise = sums.noise_correlation * sums.var / count**2
    return _WIDTH * (_slope_squared(means, noise) + _slope_squared(means.T, noise.T).T)


def _slope_squared(means: Array, variance: Array) -> Array:
    """Square of the slope along the rows of blocks, without that of noise, per squared pixel.

    It is 0 where no neighbour of a block is known.
    """
    place = np.arange(means.shape[1])
    before, after = np.maximum(place - 1, 0), np.minimum(place + 1, place[-1])
    before, after = (
        np.where(np.isfinite(means[:, other]), other, place) for other in (before, after)
    )
    steps = np.maximum(BLOCK * (after - before), 1)

    def taken(values: Array) -> tuple[Array, Array]:
        one, other = (np.take_along_axis(values, at, axis=1) for at in (before, after))
        return one, other

    low, high = taken(means)
    slope = np.where(after > before, (high - low) / steps, 0.0)
    noise = np.where(after > before, sum(taken(variance)) / steps**2, 0.0)
    return np.asarray(np.nan_to_num(slope**2 - noise))
