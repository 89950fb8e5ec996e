"""A smooth gap fitted to the ratio of a region, and its minimum.

The gap h = a + b s + c z + d s^2 (s along sliding, z across, both from -1 to 1 over the region) is
a parabola along sliding with a tilt across.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Array
from erlif.trend.block_fit import average_blocks, fit_blocks, sum_by_strips
from erlif.trend.blocks import BlockSums
from erlif.trend.curve import FilmCurve
from erlif.trend.region import Region


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
    place : Array
        Where the fitted gap has its minimum, (axis,): column and row of the image. [px]
    """

    value: float
    random_std: float
    surface_std: float
    gradient: Array
    place: Array


def find_gap_minimum(
    sums: BlockSums, curve: FilmCurve, *, region: Region, sliding_along_x: bool
) -> GapMinimum:
    """Fit a smooth gap to the blocks of a region and find its minimum within the region.

    Arguments as in `erlif.trend.summarise_blocks`.

    Returns
    -------
    GapMinimum
        NaN where too few blocks are valid.
    """
    blocks = average_blocks(sums, sliding_along_x=sliding_along_x)
    shapes = np.stack(
        [np.ones_like(blocks.along), blocks.along, blocks.across, blocks.along_squared]
    )
    fit = fit_blocks(blocks, curve, shapes)
    if fit is None:
        parameters = len(curve.gradient)
        unknown, nowhere = np.full(parameters, math.nan), np.full(2, math.nan)
        return GapMinimum(math.nan, math.nan, math.nan, unknown, nowhere)

    # the minimum lies at the vertex of the parabola where it opens upwards, else at an edge
    _, b, c, d = fit.amplitudes
    along = float(np.clip(-b / (2 * d), -1, 1)) if d > 0 else -math.copysign(1.0, b)
    across = -math.copysign(1.0, c)
    at = np.array([1.0, along, across, along**2])

    # change of the minimum with the ratio of each block, through the reweighted fit
    pull = np.linalg.solve(fit.curvature, at) @ fit.jacobian
    by_block = pull * fit.response / fit.total_var

    # the scatter of the blocks about the fit beyond their noise is that of the surfaces
    score = pull * fit.weight * fit.residual
    random = float((score**2 * blocks.variance / fit.total_var).sum())
    total = max(
        float(sum_by_strips(score[None], strip)[0, 0])
        for strip in (blocks.strip_along, blocks.strip_across)
    )
    return GapMinimum(
        float(at @ fit.amplitudes),
        math.sqrt(random),
        math.sqrt(max(total - random, 0.0)),
        np.asarray(-curve.calibration.gradient(fit.film) @ by_block),
        _place(region, (along, across) if sliding_along_x else (across, along)),
    )


def _place(region: Region, position: tuple[float, float]) -> Array:
    """Column and row of a position (x, y) from -1 to 1 over a region. [px]"""
    return np.array(
        [
            pixels.start + 0.5 * (at + 1) * (pixels.stop - 1 - pixels.start)
            for pixels, at in zip((region.columns, region.rows), position, strict=True)
        ]
    )
