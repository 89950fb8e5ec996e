"""A smooth gap fitted with weights to the averaged log ratio of blocks.

The film is a base and a sum of given shapes, one amplitude each. The amplitudes follow from the
measured log ratio by iteratively reweighted least squares, so that no pixel is lost to the limits
of the measurable range and no single pixel decides. `erlif.trend.gap` fits a parabola this way,
`erlif.trend.position` the gap of a pin in a bushing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array, Mask
from erlif.core.statistics import MAD_TO_STD
from erlif.trend.blocks import BlockSums
from erlif.trend.curve import FilmCurve

_CLIP = 4.685  # residual from which a block has no weight: 95 % efficient for normal noise [std]

_LAG = 3  # strips of blocks over which the marks of a surface are correlated, at most

_STRIPS_PER_LAG = 6  # strips that one lag of correlation takes

# Blocks in all, and positions along and across sliding, that determine four parameters.
_LEAST_BLOCKS, _LEAST_ALONG, _LEAST_ACROSS = 16, 4, 3

# Blocks above which four are merged into one: of a megapixel a parabola needs no finer ones.
_MANY = 4000

_MOST_STEPS = 30
_CONVERGED = 1e-4  # change of the gap below which the iteration ends [um]

_BENT_STEPS = 5  # of a fit of further shapes

# First steps, without weights of residuals: the start is too coarse to judge outliers.
_PLAIN_STEPS = 2

# Ratio of the ends of the spectrum of squares, accurate to 1e-12, that is no rounding.
_APART = 1e-9

_DECISIVE = 0.2  # biweight (before squaring) above which a block counts towards determining the gap


@dataclass(frozen=True)
class BlockMeans:
    """Log ratio averaged over blocks; positions run from -1 to 1 over the region.

    Attributes
    ----------
    log_ratio : Array
        (block,). [1]
    variance : Array
        Its variance by noise. [1]
    along : Array
        Mean position along sliding. [1]
    along_squared : Array
        Mean of its square. [1]
    across : Array
        Mean position across sliding. [1]
    across_squared : Array
        Mean of its square. [1]
    strip_along : NDArray[np.intp]
        Number of the strip of blocks that runs along sliding.
    strip_across : NDArray[np.intp]
        Number of the strip that runs across.
    """

    log_ratio: Array
    variance: Array
    along: Array
    along_squared: Array
    across: Array
    across_squared: Array
    strip_along: npt.NDArray[np.intp]
    strip_across: npt.NDArray[np.intp]


@dataclass(frozen=True)
class BlockFit:
    """The state of a fit at its last step; arrays are (block,).

    Attributes
    ----------
    amplitudes : Array
        Of the shapes, (shape,). [um]
    film : Array
        Fitted film. [um]
    residual : Array
        Of the log ratio. [1]
    weight : Array
        Weight of the residual. [1]
    total_var : Array
        Variance of the log ratio, noise and surfaces together. [1]
    response : Array
        Derivative of weighted residual to residual, of the biweight.
    jacobian : Array
        Derivative of the log ratio to the amplitudes, (shape, block). [1/um]
    noise : Array
        Variance of the log ratio by noise. [1]
    used : Mask
        Blocks whose film is within the calibrated range.
    known : Array
        Inverse of the variance with which each amplitude is known to be zero; 0: it is free,
        (shape,). [1/um2]
    """

    amplitudes: Array
    film: Array
    residual: Array
    weight: Array
    total_var: Array
    response: Array
    jacobian: Array
    noise: Array
    used: Mask
    known: Array

    @property
    def curvature(self) -> Array:
        """Curvature of the sum of squares, (shape, shape). [1/um2]"""
        measured = (self.jacobian * (self.response / self.total_var)) @ self.jacobian.T
        return np.asarray(measured + np.diag(self.known))

    def with_shapes(self, shapes: Array, std: float) -> BlockFit:
        """Fit further shapes as well, by the slopes of this fit.

        Parameters
        ----------
        shapes : array, (shape, block)
            Small ones: a slope hardly changes by them.
        std : float
            Standard deviation of their amplitudes about zero. [um]

        Returns
        -------
        BlockFit
        """
        slope, added = self.jacobian[0], np.zeros(len(shapes))
        jacobian = np.concatenate([self.jacobian, shapes * slope])
        known = np.concatenate([self.known, added + std**-2])
        trust, total_var = self.used.astype(float), self.total_var
        for _ in range(_BENT_STEPS):
            weighted = jacobian * (trust / total_var)
            change = np.linalg.solve(
                weighted @ jacobian.T + np.diag(known), weighted @ self.residual
            )
            residual = self.residual - change @ jacobian
            square, total_var = _judge(residual, slope, self.noise, self.used)
            trust = square**2
        return replace(
            self,
            amplitudes=np.concatenate([self.amplitudes, added]) + change,
            film=self.film + change @ jacobian / slope,
            residual=residual,
            weight=trust / total_var,
            total_var=total_var,
            response=square * (5 * square - 4),
            jacobian=jacobian,
            known=known,
        )


def fit_blocks(
    blocks: BlockMeans, curve: FilmCurve, shapes: Array, *, base: float | Array = 0.0
) -> BlockFit | None:
    """Fit the amplitudes of shapes to the log ratio of blocks.

    Parameters
    ----------
    blocks : BlockMeans
    curve : FilmCurve
    shapes : array, (shape, block)
        Of the order of 1, the first one even.
    base : float or array, (place, block)
        Film that the shapes are added to; of an array, the log ratio of a block is the mean over
        its places. [um]

    Returns
    -------
    BlockFit or None
        None where the blocks do not determine the shapes, or not a parabola along sliding and a
        tilt across.
    """
    try:
        return _iterate(blocks, curve, shapes, np.atleast_2d(base))
    except np.linalg.LinAlgError:
        return None


def _iterate(blocks: BlockMeans, curve: FilmCurve, shapes: Array, base: Array) -> BlockFit | None:
    """Reweighted least squares; raises LinAlgError where the shapes are not independent."""
    value, noise = blocks.log_ratio, blocks.variance
    high = curve.calibration.thickness_range[1]

    # start from the blocks within the calibrated range, inverted one by one
    use = (value > curve.bins[0]) & (value < curve.bins[1])
    if not _determine_a_gap(blocks, use):
        return None
    place, _ = curve.find_bins(value)
    chosen = shapes * use

    # rounding can leave the matrix of dependent shapes invertible, so that their rank decides; it
    # takes longer than a step of the fit, and the squares alone show shapes that are clearly apart
    square = chosen @ shapes.T
    spectrum = np.linalg.eigvalsh(square)
    if spectrum[0] < _APART * spectrum[-1] and np.linalg.matrix_rank(chosen) < len(shapes):
        return None
    goal = chosen @ (curve.film[place] - base.mean(axis=0))
    amplitudes: Array = np.asarray(np.linalg.solve(square, goal), float)

    # the log ratio is bent within a block that is as wide as the film changes along it
    width = np.sqrt(np.maximum(blocks.along_squared - blocks.along**2, 0.0))
    parabola = np.linalg.pinv(np.vander(blocks.along, 3, increasing=True))[1:]
    rates = width * np.stack([np.ones_like(width), 2 * blocks.along])

    trust = use.astype(float)
    response, total_var = trust, noise
    for step in range(_MOST_STEPS):
        middle = base + amplitudes @ shapes
        spread = (parabola @ middle.mean(axis=0)) @ rates
        places = np.clip(np.vstack([middle - spread, middle + spread]), *curve.films[[0, -1]])
        predicted, slope = (one.mean(axis=0) for one in curve.predict(places))
        film = places.mean(axis=0)
        residual = value - predicted

        if step >= _PLAIN_STEPS:
            # blocks are chosen by the fitted gap, not by their noisy value, to leave no bias
            use = film < high
            if not _determine_a_gap(blocks, use):
                return None
            square, total_var = _judge(residual, slope, noise, use)
            trust = square**2
            if not _determine_a_gap(blocks, square > _DECISIVE):
                return None
            response = square * (5 * square - 4)

        weight = trust / total_var
        jacobian = shapes * slope
        weighted = jacobian * weight
        change = np.linalg.solve(weighted @ jacobian.T, weighted @ residual)
        amplitudes = amplitudes + change
        if step > _PLAIN_STEPS and np.abs(change).max() < _CONVERGED:
            break
    free = np.zeros(len(shapes))
    return BlockFit(
        amplitudes, film, residual, weight, total_var, response, jacobian, noise, use, free
    )


def _judge(residual: Array, slope: Array, noise: Array, use: Mask) -> tuple[Array, Array]:
    """Biweight of blocks before squaring, and variance of their log ratio by noise and surfaces.

    The biweight (Beaton and Tukey 1974) is against scratches, dust and bubbles; 0 where a block is
    not used.
    """
    surface = _excess_variance(residual[use] / slope[use], noise[use] / slope[use] ** 2)
    total_var = noise + slope**2 * surface
    square = np.clip(1 - (residual / _CLIP) ** 2 / total_var, 0, None)
    return np.where(use, square, 0.0), total_var


def _determine_a_gap(blocks: BlockMeans, use: Mask) -> bool:
    """Whether the chosen blocks determine a parabola along sliding and a tilt across."""
    across, along = (
        np.count_nonzero(np.bincount(strip[use]))
        for strip in (blocks.strip_along, blocks.strip_across)
    )
    return bool(use.sum() >= _LEAST_BLOCKS and along >= _LEAST_ALONG and across >= _LEAST_ACROSS)


def _excess_variance(residual: Array, variance: Array) -> float:
    """Variance of residuals beyond their own, by their median absolute deviation.

    With it, half of the residuals lie within std/1.4826 of zero, for each its own std. A residual
    does so where (1.4826 residual)^2 - variance is below the excess, which is the median of that.
    """
    return max(float(np.median((MAD_TO_STD * residual) ** 2 - variance)), 0.0)


def sum_by_strips(scores: Array, strip: npt.NDArray[np.intp], *, absorbed: int = 1) -> Array:
    """Covariance of sums whose terms are correlated within a strip and, less, with the next strips.

    The estimator is that of Newey and West (1987). A fit to few strips absorbs a good part of what
    their blocks have in common: their number is corrected for, and few strips count singly.

    Parameters
    ----------
    scores : array, (sum, block)
        Terms of each sum.
    strip : array of int, (block,)
        Number of the strip of each block.
    absorbed : int
        Fitted shapes that differ from strip to strip, with the mean.

    Returns
    -------
    array, (sum, sum)
    """
    sums: Array = np.stack([np.bincount(strip, score) for score in scores])
    count = int(np.count_nonzero(np.bincount(strip)))
    lags = min(max(count // _STRIPS_PER_LAG, 1), _LAG)

    total: Array = sums @ sums.T
    for lag in range(1, lags):
        product = sums[:, lag:] @ sums[:, :-lag].T
        total = total + (1 - lag / lags) * (product + product.T)
    return np.asarray(total * count / max(count - absorbed, 1))


def average_blocks(sums: BlockSums, *, sliding_along_x: bool) -> BlockMeans:
    """Average the log ratio over blocks with equal weights: others would depend on the noise."""
    names = "lit", "lit_ratio", "lit_var", "row", "row_squared", "column", "column_squared"
    parts = [getattr(sums, name) for name in names]
    if sums.lit.size > _MANY:
        parts = [_merge_blocks(part) for part in parts]
    some = parts[0] > 0
    down, right = np.nonzero(some)
    count, ratio, var, row, row_squared, column, column_squared = (part[some] for part in parts)
    log_ratio = sums.offset + ratio / count
    variance = sums.noise_correlation * var / count**2

    rows, columns = sums.size
    v, vv = _scale(row / count, row_squared / count, rows)
    u, uu = _scale(column / count, column_squared / count, columns)
    if sliding_along_x:
        return BlockMeans(log_ratio, variance, u, uu, v, vv, down, right)
    return BlockMeans(log_ratio, variance, v, vv, u, uu, right, down)


def _merge_blocks(blocks: Array) -> Array:
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
