"""The smooth gap fitted to a map, and its minimum."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from erlif.calibration import Calibration
from erlif.core.arrays import Array, Mask
from erlif.core.products import RatioImages

_BLOCK = 8  # pixels averaged before the gap is fitted
_CLIP = 4.685  # standard deviations off the gap at which a block has lost its say; 95 % efficient where noise is normal
_LAG = 3  # strips of blocks over which the marks of a surface go together
_STRIPS_PER_LAG = 6
_LEAST_BLOCKS = 16
_MOST_STEPS = 30


def _least_film(
    ratios: RatioImages,
    calibration: Calibration,
    x: Array,
    y: Array,
    rows: slice,
    columns: slice,
    *,
    sliding_along_x: bool,
) -> tuple[float, float, float, Array]:
    """Fit h = a + b s + c z + d s^2 (s along sliding, z across, both -1 to 1 over the region) to the ratio."""
    nothing = (math.nan, math.nan, math.nan, np.full(len(calibration.full_covariance), math.nan))
    blocks = _block_means(ratios, x, y, rows, columns, sliding_along_x=sliding_along_x)
    value, noise = blocks.log_ratio, blocks.variance
    low, high = calibration.thickness_range
    design = np.column_stack(
        [np.ones_like(value), blocks.along, blocks.across, blocks.along_squared]
    )
    limits = calibration.predict_log([low, high])
    start = np.interp(
        value, calibration.predict_log(np.linspace(low, high, 500)), np.linspace(low, high, 500)
    )
    use = (value > limits[0]) & (value < limits[1])
    if not _determine_a_gap(blocks, use):
        return nothing
    gap = np.linalg.lstsq(design[use], start[use], rcond=None)[0]
    trust = use.astype(float)
    surface = 0.0  # variance of the film about a smooth gap beyond that of the noise [um2]
    for step in range(_MOST_STEPS):
        film = np.clip(design @ gap, low - 0.5, 1.5 * high)
        slope = calibration.slope(film)
        residual = value - calibration.predict_log(film)
        if step >= 2:
            # choose by the fitted gap, never by the noisy value, so that the choice leaves no bias
            use = film < high
            if not _determine_a_gap(blocks, use):
                return nothing
            surface = _excess_variance(residual[use] / slope[use], noise[use] / slope[use] ** 2)
            # biweight (Beaton and Tukey 1974): scratches, dust and unseen bubbles lose their say
            square = np.clip(1 - (residual / _CLIP) ** 2 / (noise + slope**2 * surface), 0, None)
            trust = np.where(use, square**2, 0.0)
            if not _determine_a_gap(blocks, square > 0.2):
                return nothing
            response = np.where(
                use, square * (5 * square - 4), 0.0
            )  # of trust times residual to the residual
        weight = trust / (noise + slope**2 * surface)
        jacobian = design * slope[:, None]
        normal = jacobian.T @ (jacobian * weight[:, None])
        change = np.linalg.solve(normal, jacobian.T @ (weight * residual))
        gap = gap + change
        if step > 2 and np.abs(change).max() < 1e-4:
            break
    _, b, c, d = gap
    place = float(np.clip(-b / (2 * d), -1, 1)) if d > 0 else -math.copysign(1.0, b)
    at = np.array([1.0, place, -math.copysign(1.0, c), place**2])
    curvature = jacobian.T @ (jacobian * (response / (noise + slope**2 * surface))[:, None])
    pull = jacobian @ np.linalg.solve(curvature, at)
    by_block = (
        pull * response / (noise + slope**2 * surface)
    )  # change of the least film with the ratio of each block
    score = pull * weight * residual
    random = float((score**2 * noise / (noise + slope**2 * surface)).sum())
    total = max(
        _variance_by_strips(score, strip) for strip in (blocks.strip_along, blocks.strip_across)
    )
    by_parameter = -calibration.gradient(film) @ by_block
    return (
        float(at @ gap),
        math.sqrt(random),
        math.sqrt(max(total - random, 0.0)),
        np.asarray(by_parameter),
    )


def _determine_a_gap(blocks: _Blocks, use: Mask) -> bool:
    """Whether the chosen blocks tell a parabola along sliding and a tilt across."""
    along, across = (
        np.unique(strip[use]).size for strip in (blocks.strip_across, blocks.strip_along)
    )
    return bool(use.sum() >= _LEAST_BLOCKS and along >= 4 and across >= 3)


def _excess_variance(residual: Array, variance: Array) -> float:
    """Variance that residuals have beyond their own, by their median absolute deviation."""
    excess = 0.0
    for _ in range(20):
        scale = 1.4826 * float(np.median(np.abs(residual) / np.sqrt(variance + excess)))
        change = (scale**2 - 1) * float(np.median(variance + excess))
        excess = max(excess + change, 0.0)
        if abs(change) < 1e-3 * float(np.median(variance)) or excess == 0.0:
            break
    return excess


def _variance_by_strips(score: Array, strip: npt.NDArray[np.intp]) -> float:
    """Variance of a sum whose terms go together within a strip and, less and less, with the next strips (Newey and West 1987).

    The fit has taken from few strips a good part of what they share, so their number is corrected for, and where there are few,
    each is taken by itself.
    """
    sums = np.bincount(strip, score)
    count = np.unique(strip).size
    lags = min(max(count // _STRIPS_PER_LAG, 1), _LAG)
    total = float((sums**2).sum())
    for lag in range(1, lags):
        total += 2 * (1 - lag / lags) * float((sums[lag:] * sums[:-lag]).sum())
    return total * count / (count - 1)


@dataclass(frozen=True)
class _Blocks:
    """Log ratio averaged over blocks; places along and across sliding run from -1 to 1 over the region."""

    log_ratio: Array
    variance: Array
    along: Array
    along_squared: Array
    across: Array
    strip_along: npt.NDArray[np.intp]  # number of the strip that runs along sliding
    strip_across: npt.NDArray[np.intp]


def _block_means(
    ratios: RatioImages, x: Array, y: Array, rows: slice, columns: slice, *, sliding_along_x: bool
) -> _Blocks:
    """Average the log ratio over blocks, all pixels of a block alike: weights would go with the noise of its pixels."""
    total = _sum_blocks(
        ratios.log_ratio.values[rows, columns],
        ratios.log_ratio_var.values[rows, columns],
        ratios.flags.values[rows, columns],
        np.linspace(-1, 1, x[columns].size),
        np.linspace(-1, 1, y[rows].size),
        _BLOCK,
    )
    full = total[0] > 0
    down, right = np.nonzero(full)
    count = total[0, full]
    log_ratio, variance, u, uu, v, vv = total[1:, full] / count
    variance *= _correlation(ratios)
    along = (u, uu, v, down, right) if sliding_along_x else (v, vv, u, right, down)
    return _Blocks(log_ratio, variance / count, *along)


@numba.njit(nogil=True, cache=True)
def _sum_blocks(log_ratio, variance, flags, u, v, block):  # type: ignore[no-untyped-def]
    """Count, log ratio, variance, u, u squared, v and v squared, summed over the sound pixels of each block."""
    height, width = log_ratio.shape
    total = np.zeros((7, (height + block - 1) // block, (width + block - 1) // block))
    for i in range(height):
        for j in range(width):
            if flags[i, j] == 0:
                here = total[:, i // block, j // block]
                here[0] += 1.0
                here[1] += log_ratio[i, j]
                here[2] += variance[i, j]
                here[3] += u[j]
                here[4] += u[j] ** 2
                here[5] += v[i]
                here[6] += v[i] ** 2
    return total


def _correlation(ratios: RatioImages) -> float:
    """By how much the variance of a mean over pixels exceeds that of independent ones."""
    return float(ratios.noise_correlation) if "noise_correlation" in ratios else 1.0
