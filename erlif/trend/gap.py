"""A smooth gap fitted to the ratio of a region, its minimum, and what it adds to the map.

The gap is h = a + b s + c z + d s^2 + e z^2 + f z^3, with s along sliding and z across, both from
-1 to 1 over the region. A plane has the tilts b and c alone, a line contact is curved along
sliding, a point contact in both directions. A journal has all of them, e and f as far as pin and
bore are not straight. A bore of known shape adds this along z. An elastic point contact is a
plateau (`erlif.trend.plateau`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import StrEnum
from functools import cache
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.trend.block_fit import BlockFit, BlockMeans, average_blocks, fit_blocks, sum_by_strips
from erlif.trend.blocks import BLOCK, BlockSums, Region
from erlif.trend.bore import AxialShape
from erlif.trend.curve import FilmCurve
from erlif.trend.number import FilmNumber
from erlif.trend.plateau import find_plateau

# Variance of a map by smooth departures from its gap, over that by noise and marks, from which the
# gap does not describe the map. [1]
MISFIT = 1.0

# Error by such departures above which a minimum is not stated: in um, and relative to it.
_TOLERATED, _TOLERATED_SHARE = 0.1, 0.1

# Negative minimum from which it is none. [std]
_BELOW_ZERO = 3.0

_DEGREE = 4  # of the polynomials that are smooth departures
_FEWEST = 60  # blocks that distinguish them from marks
_STRAIGHT = 0.5  # um: standard deviation of e and f of a journal
_OUTLIER = 4.685  # departure beyond which a block counts as one of this size [std]


class GapShape(StrEnum):
    """Smooth gap between two surfaces."""

    PLANE = "plane"
    LINE = "line"
    JOURNAL = "journal"
    POINT = "point"
    PLATEAU = "plateau"


# Number of the shapes 1, s, z, s^2, z^2 and z^3 that a gap has.
_SHAPES = {
    GapShape.PLANE: 3,
    GapShape.LINE: 4,
    GapShape.JOURNAL: 6,
    GapShape.POINT: 5,
    GapShape.PLATEAU: 5,
}

# Those of a gap of so many shapes that change across sliding alone, and along it alone.
_ALONE = {3: (2, 2), 4: (2, 3), 5: (3, 3), 6: (4, 3)}

_NO_GAP = np.full(6, math.nan)


def gap_shapes(along: Array, across: Array, contact: GapShape) -> Array:
    """Shapes whose sum is the gap, (shape, place), at places from -1 to 1 over the region."""
    shapes = [np.ones_like(along), along, across, along**2, across**2, across**3]
    return np.stack(shapes[: _SHAPES[contact]])


class GapMinimum(NamedTuple):
    """Minimum and mean of a smooth gap within a region.

    Attributes
    ----------
    minimum : FilmNumber
    mean : FilmNumber
        Over the whole region, also where its film is beyond the measurable range.
    unseen : FilmNumber
        Sum of the inverse of the gap over the pixels without a measurable film, over all pixels of
        the region. [1/um]
    central : FilmNumber
        At the centre of a point contact; NaN for other gaps.
    place : Array
        Where the fitted gap has its minimum, (axis,): column and row of the image. [px]
    misfit : float
        Variance of smooth departures of the map from the gap, over that by noise and marks. [1]
    bend : Array
        Of a point contact its curvatures d along sliding and e across, of a journal e and f, (2,);
        NaN for other gaps. [um]
    bend_random_var : Array
        Their variances by the noise of the ratio. [um2]
    bend_surface_var : Array
        By marks and waviness of the surfaces. [um2]
    amplitudes : Array
        Of the six shapes of a smooth gap, those that it does not have 0, (6,); NaN where none is
        fitted. [um]
    """

    minimum: FilmNumber
    mean: FilmNumber
    unseen: FilmNumber
    central: FilmNumber
    place: Array
    misfit: float
    bend: Array
    bend_random_var: Array
    bend_surface_var: Array
    amplitudes: Array = _NO_GAP

    @classmethod
    def unknown(cls, parameters: int, misfit: float = math.nan) -> GapMinimum:
        """Make the minimum of a gap that is not known; `parameters` of the calibration."""
        pair, number = np.full(2, math.nan), FilmNumber.unknown(parameters)
        return cls(*(number,) * 4, pair, misfit, *(pair,) * 3)


def find_gap_minimum(
    sums: BlockSums,
    curve: FilmCurve,
    *,
    region: Region,
    sliding_along_x: bool,
    contact: GapShape = GapShape.LINE,
    bore: AxialShape | None = None,
) -> GapMinimum:
    """Fit the smooth gap of a contact to the blocks of a region and find its minimum within it.

    Parameters
    ----------
    sums : BlockSums
    curve : FilmCurve
    region, sliding_along_x
        As for `erlif.trend.summarise_film`; the region is that of the sums.
    contact : GapShape
    bore : AxialShape, optional
        Shape along the axis of a bore that is not straight; the minimum is that of the whole gap.

    Returns
    -------
    GapMinimum
        NaN where too few blocks are valid. Where the map departs from the gap smoothly, and this
        leaves the minimum an error above 0.1 um and a tenth of it, or where the minimum is below
        zero by more than three errors, minimum and errors are NaN.

    Examples
    --------
    An even film of 3 um, without noise:

    >>> from erlif.core.products import RatioImages
    >>> from erlif.show.plots import example_calibration
    >>> from erlif.trend.blocks import sum_blocks
    >>> import xarray as xr
    >>> calibration, whole = example_calibration(), Region(slice(0, 64), slice(0, 64))
    >>> ratio, zeros = calibration.predict_log(3.0), np.zeros((64, 64), np.float32)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": (("y", "x"), zeros + np.float32(ratio)),
    ...     "log_ratio_var": (("y", "x"), zeros + np.float32(1e-6)),
    ...     "log_ratio_var_shared": (("y", "x"), zeros),
    ...     "flags": (("y", "x"), np.zeros((64, 64), np.uint16)),
    ... }))
    >>> sums, curve = sum_blocks(ratios, whole), FilmCurve.of(calibration)
    >>> found = find_gap_minimum(sums, curve, region=whole, sliding_along_x=True)
    >>> print(f"{found.minimum.value:.3f}")
    3.000
    """
    return find_gap_minima(
        sums,
        curve,
        region=region,
        sliding_along_x=sliding_along_x,
        contacts=[contact],
        bore=bore,
    )[contact]


def _block_shapes(blocks: BlockMeans) -> Array:
    """Means of the six shapes of a gap over blocks, (shape, block)."""
    s, z = blocks.along, blocks.across
    cubed = 3 * z * blocks.across_squared - 2 * z**3
    return np.stack([np.ones_like(s), s, z, blocks.along_squared, blocks.across_squared, cubed])


def _find_minimum(
    fit: BlockFit,
    acts: Array,
    blocks: BlockMeans,
    missing: Array,
    curve: FilmCurve,
    region: Region,
    contact: GapShape,
    bore: AxialShape | None,
    *,
    sliding_along_x: bool,
) -> GapMinimum:
    """The minimum of a gap that is fitted to the means of blocks.

    `acts` are the derivatives of their log ratio by the parameters of the calibration, and
    `missing` the pixels without a measurable film in each block, over all of the region.
    """
    count = len(fit.amplitudes)
    axial = region.rows if sliding_along_x else region.columns
    misfit = _measure_misfit(blocks, fit, curve.calibration.thickness_range[1])
    found = GapMinimum.unknown(curve.parameters, misfit)
    if contact in (GapShape.POINT, GapShape.JOURNAL):
        pulls = np.linalg.inv(fit.curvature)[-2:] @ fit.jacobian
        variances = np.array([_variance_parts(pull, fit, blocks) for pull in pulls])
        found = found._replace(
            bend=fit.amplitudes[-2:],
            bend_random_var=variances[:, 0],
            bend_surface_var=variances[:, 1],
        )

    # minimum and mean are linear in the amplitudes; the mean is that of the pixels
    amplitudes = np.pad(fit.amplitudes, (0, len(_NO_GAP) - count))
    _, b, c, d, e, f = amplitudes
    along, across = _lowest_place(b, d), _lowest_place(c, e, f)
    least = level = 0.0
    if bore is not None:
        places = np.linspace(-1, 1, axial.stop - axial.start)
        heights = bore.within(axial, places)
        at = np.argmin(c * places + e * places**2 + f * places**3 + heights)
        across, least, level = float(places[at]), float(heights[at]), float(heights.mean())
    lowest = np.array([1.0, along, across, along**2, across**2, across**3])
    columns, rows = (_mean_square(pixels) for pixels in (region.columns, region.rows))
    means = (columns, rows) if sliding_along_x else (rows, columns)
    by_block = -acts * (fit.response / fit.total_var)
    minimum, mean = (
        _number_of(at[:count], height, fit, blocks, by_block)
        for at, height in ((lowest, least), (np.array([1, 0, 0, *means, 0]), level))
    )

    # below zero the smooth gap passes through a contact that is flattened
    own = math.hypot(minimum.random_std, minimum.surface_std)
    if minimum.value + _BELOW_ZERO * own < 0:
        return found._replace(misfit=max(misfit, 2 * MISFIT))
    tolerated = max(_TOLERATED, _TOLERATED_SHARE * minimum.value)
    if misfit > MISFIT and minimum.surface_std > tolerated:
        return found
    place = _pixel_of(region, along, across, sliding_along_x=sliding_along_x)
    found = found._replace(minimum=minimum, mean=mean, place=place, amplitudes=amplitudes)
    if contact is GapShape.POINT:
        found = found._replace(central=minimum)

    # where no film is measurable
    s, z = _places_of_blocks(region, missing > 0, sliding_along_x=sliding_along_x)
    shapes = gap_shapes(s, z, contact)
    gap = fit.amplitudes @ shapes + (0.0 if bore is None else bore.within(axial, z))
    if (gap <= 0).any():
        return found
    inverse = missing[missing > 0] / gap

    # an inverse changes with the amplitudes by its square
    unseen = _number_of(shapes @ (-inverse / gap), 0.0, fit, blocks, by_block)
    return found._replace(unseen=unseen._replace(value=float(inverse.sum())))


def _number_of(
    at: Array, height: float, fit: BlockFit, blocks: BlockMeans, by_block: Array
) -> FilmNumber:
    """A number of the gap: the sum of its amplitudes times `at`, and a height of the bore [um].

    `by_block` is the change of the amplitudes' equations with each parameter, (parameter, block).
    """
    # its change with the ratio of each block, through the reweighted fit
    pull = np.linalg.solve(fit.curvature, at) @ fit.jacobian
    random, surface = _variance_parts(pull, fit, blocks)
    gradient = np.asarray(by_block @ pull)
    value = float(at @ fit.amplitudes) + height
    return FilmNumber(value, math.sqrt(random), math.sqrt(surface), gradient)


def find_gap_minima(
    sums: BlockSums,
    curve: FilmCurve,
    *,
    region: Region,
    sliding_along_x: bool,
    contacts: Sequence[GapShape],
    bore: AxialShape | None = None,
) -> dict[GapShape, GapMinimum]:
    """The minimum of the gap of each of some contacts.

    Arguments that are not listed are those of `find_gap_minimum`.

    Parameters
    ----------
    contacts : sequence of GapShape
        A plateau after a point contact is looked for where the map departs from that; elsewhere,
        and where there is none, it is the gap of the point contact.

    Returns
    -------
    dict of GapShape to GapMinimum

    Examples
    --------
    A region without light has no gap:

    >>> from erlif.show.plots import example_calibration
    >>> one = np.zeros((4, 4))
    >>> dark = BlockSums((32, 32), 0.0, *[one] * 11, valid=0, beyond=0)
    >>> whole, curve = Region(slice(0, 32), slice(0, 32)), FilmCurve.of(example_calibration())
    >>> found = find_gap_minima(
    ...     dark, curve, region=whole, sliding_along_x=True, contacts=[GapShape.LINE]
    ... )
    >>> found[GapShape.LINE].minimum.value
    nan
    """
    blocks = average_blocks(sums, sliding_along_x=sliding_along_x)
    column, row = _pixel_of(region, blocks.along, blocks.across, sliding_along_x=sliding_along_x)
    axial = region.rows if sliding_along_x else region.columns
    base = 0.0 if bore is None else bore.in_blocks(blocks, axial)
    shapes = _block_shapes(blocks)

    @cache
    def fit_gap(contact: GapShape) -> tuple[BlockFit, Array] | None:
        """Fit of a gap, and derivatives of its log ratio by the parameters of the calibration."""
        if contact is GapShape.JOURNAL:
            if (straight := fit_gap(GapShape.LINE)) is None:
                return None
            fit, acts = straight
            return fit.with_shapes(shapes[len(fit.amplitudes) :], _STRAIGHT), acts
        one = fit_blocks(blocks, curve, shapes[: _SHAPES[contact]], base=base)
        if one is None:
            return None
        return one, curve.calibration.gradient(one.film, place=(column, row))

    found: dict[GapShape, GapMinimum] = {}
    high, wide = ([min(BLOCK, size - at) for at in range(0, size, BLOCK)] for size in sums.size)
    missing = (np.outer(high, wide) - sums.measurable) / math.prod(sums.size)
    options = {"sliding_along_x": sliding_along_x}
    for contact in contacts:
        point = found.get(GapShape.POINT)
        if contact is not GapShape.PLATEAU:
            if (fitted := fit_gap(contact)) is None:
                found[contact] = GapMinimum.unknown(curve.parameters)
                continue
            fit, acts = fitted
            found[contact] = _find_minimum(
                fit, acts, blocks, missing, curve, region, contact, bore, **options
            )
        elif point is None or point.misfit > MISFIT:
            plateau = _fit_plateau(blocks, curve, region, **options)
            found[contact] = plateau if point is None or plateau.misfit < MISFIT else point
        else:
            found[contact] = point
    return found


def _fit_plateau(
    blocks: BlockMeans, curve: FilmCurve, region: Region, *, sliding_along_x: bool
) -> GapMinimum:
    """Central and minimum film of an elastic contact; the gap that departs where there is none."""
    column, row = _pixel_of(region, blocks.along, blocks.across, sliding_along_x=sliding_along_x)

    def gradient(film: Array, use: Mask) -> Array:
        return curve.calibration.gradient(film, place=(column[use], row[use]))

    found = find_plateau(blocks, gradient, curve)
    if found is None:
        return GapMinimum.unknown(curve.parameters, 2 * MISFIT)
    place = _pixel_of(region, found.along, found.across, sliding_along_x=sliding_along_x)
    flat = GapMinimum.unknown(curve.parameters, misfit=0.0)
    return flat._replace(minimum=found.minimum, central=found.central, place=place)


def _lowest_place(slope: float, bend: float, twist: float = 0.0) -> float:
    """Position of the minimum of slope x + bend x^2 + twist x^3 from -1 to 1."""
    places = [-1.0, 1.0]
    divisor = bend + math.sqrt(max(bend**2 - 3 * twist * slope, 0.0))
    if divisor > 0:  # where it turns upwards
        places.append(min(max(-slope / divisor, -1.0), 1.0))
    return min(places, key=lambda x: x * (slope + x * (bend + x * twist)))


def _mean_square(pixels: slice) -> float:
    """Mean over some pixels of the square of their positions, which go from -1 to 1."""
    count = int(pixels.stop - pixels.start)
    return (count + 1) / (3 * (count - 1))


def _variance_parts(pull: Array, fit: BlockFit, blocks: BlockMeans) -> tuple[float, float]:
    """Variance of a number of the fit by noise, and by the surfaces. [um2]

    The scatter of the blocks about the fit beyond their noise is that of the surfaces.
    """
    score = pull * fit.weight * fit.residual
    random = float((score**2 * blocks.variance / fit.total_var).sum())
    across, along = _ALONE[len(fit.amplitudes)]
    total = max(
        float(sum_by_strips(score[None], strip, absorbed=absorbed)[0, 0])
        for strip, absorbed in ((blocks.strip_along, across), (blocks.strip_across, along))
    )
    return random, max(total - random, 0.0)


def _measure_misfit(blocks: BlockMeans, fit: BlockFit, thickest: float) -> float:
    """Variance of the smooth part of the residuals over that of the rest. [1]

    0 where too few blocks distinguish one from the other.
    """
    use = fit.film < thickest
    count = int(use.sum())
    if count < _FEWEST:
        return 0.0
    slope = fit.jacobian[0, use]  # the first shape is 1
    limit = _OUTLIER * np.sqrt(fit.total_var[use])
    film = np.clip(fit.residual[use], -limit, limit) / slope

    powers = [(n, m) for n in range(_DEGREE + 1) for m in range(_DEGREE + 1 - n)]
    along, across = (
        np.polynomial.legendre.legvander(place[use], _DEGREE).T
        for place in (blocks.along, blocks.across)
    )
    shapes = np.stack([along[n] * across[m] for n, m in powers])

    # in a region of few strips the shapes are dependent
    shared = shapes @ film
    smooth = float(shared @ np.linalg.pinv(shapes @ shapes.T, hermitian=True) @ shared)
    rest = (float(film @ film) - smooth) / (count - len(powers))
    return smooth / count / max(rest, float((blocks.variance[use] / slope**2).mean()))


def _places_of_blocks(
    region: Region, chosen: Mask, *, sliding_along_x: bool
) -> tuple[Array, Array]:
    """Middles of some blocks along sliding and across, from -1 to 1 over the region, (block,)."""
    middles = []
    for pixels in (region.rows, region.columns):
        last = int(pixels.stop - pixels.start) - 1
        starts = np.arange(0, last + 1, BLOCK)
        middles.append((starts + np.minimum(starts + BLOCK - 1, last)) / last - 1)
    down, right = (each[chosen] for each in np.meshgrid(*middles, indexing="ij"))
    return (right, down) if sliding_along_x else (down, right)


def _pixel_of(
    region: Region, along: Array | float, across: Array | float, *, sliding_along_x: bool
) -> Array:
    """Columns and rows of positions from -1 to 1 over a region, (axis, *position). [px]"""
    position = (along, across) if sliding_along_x else (across, along)
    return np.array(
        [
            pixels.start + 0.5 * (at + 1) * (pixels.stop - 1 - pixels.start)
            for pixels, at in zip((region.columns, region.rows), position, strict=True)
        ]
    )
