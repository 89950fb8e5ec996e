"""A smooth gap fitted to the ratio of a region, and its minimum.

The gap h = a + b s + c z + d s^2 (s along sliding, z across, both from -1 to 1 over the region) is
a parabola along sliding with a tilt across. It is fitted to blocks of the measured log ratio by
iteratively reweighted least squares, so that no pixel is lost to the limits of the measurable range
and no single pixel decides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.calibration import Calibration
from erlif.core.arrays import Array, Mask
from erlif.core.products import RatioImages
from erlif.core.statistics import MAD_TO_STD
from erlif.trend.blocks import BlockSums, sum_blocks
from erlif.trend.curve import FilmCurve
from erlif.trend.region import Region

_CLIP = 4.685
"""Residual from which a block has no weight: 95 % efficient for normal noise. [std]"""

_LAG = 3
"""Strips of blocks over which the marks of a surface are correlated, at most."""

_STRIPS_PER_LAG = 6
"""Strips that one lag of correlation takes."""

_LEAST_BLOCKS, _LEAST_ALONG, _LEAST_ACROSS = 16, 4, 3
"""Blocks in all, and positions along and across sliding, that determine four parameters."""

_MANY = 4000
"""Blocks above which four are merged into one: of a megapixel a parabola needs no finer ones."""

_MOST_STEPS = 30
_CONVERGED = 1e-4
"""Change of the gap below which the iteration ends. [um]"""

_PLAIN_STEPS = 2
"""First steps, without weights of residuals: the start is too coarse to judge outliers."""

_DECISIVE = 0.2
"""Biweight (before squaring) above which a block counts towards determining the gap."""


class GapMinimum(NamedTuple):
    """Minimum of a smooth gap, with the parts of its standard deviation.

    Attributes
    ----------
    value : float
        Minimum within the region. [um]
    random_std : float
        From the noise of the ratio. [um]
    surface_std : float
        From marks and waviness of the surfaces about a smooth gap. [um]
    gradient : Array
        Change with the parameters of the calibration, in the order of
        `Calibration.full_covariance`.
    """

    value: float
    random_std: float
    surface_std: float
    gradient: Array


def fit_gap_minimum(
    ratios: RatioImages,
    calibration: Calibration,
    *,
    region: Region,
    sliding_along_x: bool,
) -> GapMinimum:
    """Fit a smooth gap to the ratio of a region and find its minimum within the region.

    Parameters
    ----------
    ratios : RatioImages
        log_ratio, log_ratio_var and flags (y, x).
    calibration : Calibration
    region : Region
    sliding_along_x : bool
        Whether image x is the sliding direction.

    Returns
    -------
    GapMinimum
        NaN where too few blocks are valid.

    Examples
    --------
    A parabola of 3 um in the middle that rises by 0.4 um across, 0.2 um to either side:

    >>> import xarray as xr
    >>> from erlif.core.products import RatioImages
    >>> from erlif.plots import example_calibration
    >>> from erlif.trend import Region
    >>> calibration, position = example_calibration(), np.linspace(0, 12, 64)
    >>> film = 3 + 0.1 * (position - 6) ** 2 + 0.2 * (position[:, None] / 6 - 1)
    >>> log_ratio = ("y", "x"), calibration.predict_log(film)
    >>> variance, flags = np.full((64, 64), 1e-6), np.zeros((64, 64), np.uint8)
    >>> ratios = RatioImages(xr.Dataset({
    ...     "log_ratio": log_ratio,
    ...     "log_ratio_var": (("y", "x"), variance),
    ...     "flags": (("y", "x"), flags),
    ... }))
    >>> whole = Region(slice(0, 64), slice(0, 64))
    >>> minimum = fit_gap_minimum(ratios, calibration, region=whole, sliding_along_x=True)
    >>> round(minimum.value, 2)
    2.8
    """
    return find_gap_minimum(
        sum_blocks(ratios, region), FilmCurve.of(calibration), sliding_along_x=sliding_along_x
    )


def find_gap_minimum(sums: BlockSums, curve: FilmCurve, *, sliding_along_x: bool) -> GapMinimum:
    """Fit a smooth gap to the blocks of a region; `fit_gap_minimum` does the same from images."""
    blocks = _average_blocks(sums, sliding_along_x=sliding_along_x)
    fit = _fit_gap(blocks, curve)
    if fit is None:
        parameters = len(curve.gradient)
        return GapMinimum(math.nan, math.nan, math.nan, np.full(parameters, math.nan))

    # the minimum lies at the vertex of the parabola where it opens upwards, else at an edge
    _, b, c, d = fit.gap
    along = float(np.clip(-b / (2 * d), -1, 1)) if d > 0 else -math.copysign(1.0, b)
    at = np.array([1.0, along, -math.copysign(1.0, c), along**2])

    # change of the minimum with the ratio of each block, through the reweighted fit
    per_var = fit.response / fit.total_var
    curvature = (fit.jacobian * per_var) @ fit.jacobian.T
    pull = np.linalg.solve(curvature, at) @ fit.jacobian
    by_block = pull * fit.response / fit.total_var

    # the scatter of the blocks about the fit beyond their noise is that of the surfaces
    score = pull * fit.weight * fit.residual
    random = float((score**2 * blocks.variance / fit.total_var).sum())
    total = max(
        _variance_by_strips(score, strip) for strip in (blocks.strip_along, blocks.strip_across)
    )
    return GapMinimum(
        float(at @ fit.gap),
        math.sqrt(random),
        math.sqrt(max(total - random, 0.0)),
        np.asarray(-curve.calibration.gradient(fit.film) @ by_block),
    )


@dataclass(frozen=True)
class _Blocks:
    """Log ratio averaged over blocks; positions run from -1 to 1 over the region."""

    log_ratio: Array
    variance: Array
    along: Array
    along_squared: Array
    across: Array
    strip_along: npt.NDArray[np.intp]
    """Number of the strip of blocks that runs along sliding."""
    strip_across: npt.NDArray[np.intp]
    """Number of the strip that runs across."""


@dataclass(frozen=True)
class _GapFit:
    """The state of the fit at its last step; arrays are (block,)."""

    gap: Array
    """a, b, c, d. [um]"""
    film: Array
    """[um]"""
    residual: Array
    """Of the log ratio. [1]"""
    weight: Array
    total_var: Array
    """Variance of the log ratio, noise and surfaces together. [1]"""
    response: Array
    """Derivative of weighted residual to residual, of the biweight."""
    jacobian: Array
    """Log ratio to parameters, (4, block). [1/um]"""


def _fit_gap(blocks: _Blocks, curve: FilmCurve) -> _GapFit | None:
    """Fit the four parameters of the gap; None where the blocks do not determine them."""
    value, noise = blocks.log_ratio, blocks.variance
    high = curve.calibration.thickness_range[1]
    design = np.stack([np.ones_like(value), blocks.along, blocks.across, blocks.along_squared])

    # start from the blocks within the calibrated range, inverted one by one
    use = (value > curve.bins[0]) & (value < curve.bins[1])
    if not _determine_a_gap(blocks, use):
        return None
    place, _ = curve.find_bins(value)
    chosen = design * use
    gap = np.linalg.solve(chosen @ design.T, chosen @ curve.film[place])

    trust = use.astype(float)
    response = trust
    surface = 0.0  # variance of the film about a smooth gap beyond that of the noise [um2]
    for step in range(_MOST_STEPS):
        film = np.clip(gap @ design, *curve.limits)
        predicted, slope = curve.predict(film)
        residual = value - predicted

        if step >= _PLAIN_STEPS:
            # blocks are chosen by the fitted gap, not by their noisy value, to leave no bias
            use = film < high
            if not _determine_a_gap(blocks, use):
                return None
            surface = _excess_variance(residual[use] / slope[use], noise[use] / slope[use] ** 2)

            # biweight (Beaton and Tukey 1974) against scratches, dust and bubbles
            square = np.clip(1 - (residual / _CLIP) ** 2 / (noise + slope**2 * surface), 0, None)
            trust = np.where(use, square**2, 0.0)
            if not _determine_a_gap(blocks, square > _DECISIVE):
                return None
            response = np.where(use, square * (5 * square - 4), 0.0)

        total_var = noise + slope**2 * surface
        weight = trust / total_var
        jacobian = design * slope
        weighted = jacobian * weight
        change = np.linalg.solve(weighted @ jacobian.T, weighted @ residual)
        gap = gap + change
        if step > _PLAIN_STEPS and np.abs(change).max() < _CONVERGED:
            break
    return _GapFit(gap, film, residual, weight, total_var, response, jacobian)


def _determine_a_gap(blocks: _Blocks, use: Mask) -> bool:
    """Whether the chosen blocks determine a parabola along sliding and a tilt across."""
    along, across = (
        np.count_nonzero(np.bincount(strip[use]))
        for strip in (blocks.strip_across, blocks.strip_along)
    )
    return bool(use.sum() >= _LEAST_BLOCKS and along >= _LEAST_ALONG and across >= _LEAST_ACROSS)


def _excess_variance(residual: Array, variance: Array) -> float:
    """Variance of residuals beyond their own, by their median absolute deviation.

    With it, half of the residuals lie within std/1.4826 of zero, for each its own std. A residual
    does so where (1.4826 residual)^2 - variance is below the excess, which is the median of that.
    """
    return max(float(np.median((MAD_TO_STD * residual) ** 2 - variance)), 0.0)


def _variance_by_strips(score: Array, strip: npt.NDArray[np.intp]) -> float:
    """Variance of a sum whose terms are correlated within a strip and, less, with the next strips.

    The estimator is that of Newey and West (1987). A fit to few strips absorbs a good part of what
    their blocks have in common: their number is corrected for, and few strips count singly.
    """
    sums = np.bincount(strip, score)
    count = int(np.count_nonzero(np.bincount(strip)))
    lags = min(max(count // _STRIPS_PER_LAG, 1), _LAG)

    total = float((sums**2).sum())
    for lag in range(1, lags):
        total += 2 * (1 - lag / lags) * float((sums[lag:] * sums[:-lag]).sum())
    return total * count / (count - 1)


def _average_blocks(sums: BlockSums, *, sliding_along_x: bool) -> _Blocks:
    """Average the log ratio over blocks with equal weights: others would depend on the noise."""
    names = "lit", "lit_ratio", "lit_var", "row", "row_squared", "column", "column_squared"
    merged = {name: getattr(sums, name) for name in names}
    if sums.lit.size > _MANY:
        merged = {name: _merge(blocks) for name, blocks in merged.items()}
    some = merged["lit"] > 0
    down, right = np.nonzero(some)
    count, ratio, var, row, row_squared, column, column_squared = (
        merged[name][some] for name in names
    )
    log_ratio = sums.offset + ratio / count
    variance = sums.noise_correlation * var / count**2

    rows, columns = sums.size
    v, vv = _scale(row / count, row_squared / count, rows)
    u, uu = _scale(column / count, column_squared / count, columns)
    if sliding_along_x:
        return _Blocks(log_ratio, variance, u, uu, v, down, right)
    return _Blocks(log_ratio, variance, v, vv, u, right, down)


def _merge(blocks: Array) -> Array:
    """Sums over four blocks; at the lower and right edge of an odd number, over those there are."""
    rows = blocks[::2].copy()
    rows[: len(blocks) // 2] += blocks[1::2]
    merged = rows[:, ::2].copy()
    merged[:, : rows.shape[1] // 2] += rows[:, 1::2]
    return merged


def _scale(place: Array, squared: Array, size: int) -> tuple[Array, Array]:
    """Means of pixel positions and of their squares, on a scale from -1 to 1 over the region."""
    step = 2 / (size - 1)
    return step * place - 1, step**2 * squared - 2 * step * place + 1
