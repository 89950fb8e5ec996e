"""What stands still in the image as a Gaussian process: its size, and its most likely values.

The pattern has the covariance v exp(-d^2 / l^2) at a distance d. Its values by the factors of cells
are equations 2.25 and 2.26 of Rasmussen and Williams (2006), http://www.gaussianprocess.org/gpml.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array, Image
from erlif.trend.factor import CellFactors
from erlif.trend.factor_kind import FactorKind

_LONGEST = 0.4  # of the shorter side of the picture: what is longer is smooth
_LENGTHS, _SIZES = 8, 200  # that are tried; sizes to 3 %
_SMALLEST, _LARGEST = 1e-3, 0.3  # sizes among which the true one is sought
_STEPS = 3  # each leaves a tenth of what the one before did
_RIDGE = 1e-4  # of the variance: means of neighbours hardly differ where the pattern is long
_FILMS = 33  # of the range, for which it is tabulated how a pattern acts


class Pattern(NamedTuple):
    """What stands still at each pixel, (y, x), as it is taken out of the ratio.

    Attributes
    ----------
    log_ratio : Image
        In the film of its `FactorKind`. [1]
    std : Image
        Standard deviation of what is left there. [1]
    ratios : Array
        Logarithms of the ratio, rising, (film,).
    acts : Array
        Factor of the films that have these, (film,). [1]
    """

    log_ratio: Image
    std: Image
    ratios: Array = np.zeros(1)
    acts: Array = np.ones(1)

    def on_films(self, kind: FactorKind, curve: RatioCurve) -> Pattern:
        """The same as it acts on films of this curve."""
        films = np.linspace(*curve.thickness_range, _FILMS)
        return self._replace(ratios=curve.predict_log(films), acts=kind.acts(films, curve)[0])

    def take_out(self, log_ratio: Image) -> None:
        """Subtract it from the logarithm of a ratio, in its place."""
        taken = self.log_ratio
        for _ in range(_STEPS):  # to that of the film whose ratio is left
            acts = np.interp(log_ratio - taken, self.ratios, self.acts)
            taken = (self.log_ratio * acts).astype(np.float32)
        log_ratio -= taken


class PatternSize(NamedTuple):
    """How large a pattern is, and how far it is correlated.

    Attributes
    ----------
    size : float
        Standard deviation of the logarithm of the ratio over the picture. [1]
    std : float
        Standard deviation of the size. [1]
    length : float
        Distance over which it is correlated (1/e). [px]
    gain : float
        Rise of the logarithm of the likelihood by it.
    """

    size: float
    std: float
    length: float
    gain: float


class CellPattern(NamedTuple):
    """Means of a pattern over cells.

    Attributes
    ----------
    centres : tuple[Array, Array]
        Columns and rows of the middles of the cells, (cell,). [px]
    value : Array
        (cell,) [1]
    covariance : Array
        (cell, cell) [1]
    """

    centres: tuple[Array, Array]
    value: Array
    covariance: Array


def find_size(factors: CellFactors) -> PatternSize:
    """Find size and length, means over all that are tried, each as likely before as any other.

    Parameters
    ----------
    factors : CellFactors

    Returns
    -------
    PatternSize
    """
    root = np.linalg.inv(np.linalg.cholesky(factors.noise))
    shown, values = root @ factors.shown, root @ factors.values
    widths = _cell_widths(factors.centres)
    sizes = np.geomspace(_SMALLEST, _LARGEST, _SIZES)

    def find_gains(lengths: Array) -> Array:
        gains = []
        for length in lengths:
            power, axes = np.linalg.eigh(shown @ correlate_cells(length, factors.centres) @ shown.T)
            share, total = (axes.T @ values) ** 2, 1 + sizes[:, None] ** 2 * power
            gains.append(0.5 * (share - share / total - np.log(total)).sum(axis=1))
        return np.array(gains)

    # many cells leave a range of lengths that is narrower than the steps of the first search
    side = min(float(np.ptp(at)) + width for at, width in zip(factors.centres, widths, strict=True))
    lengths = np.geomspace(0.5 * max(widths), _LONGEST * side, _LENGTHS)
    best = int(np.argmax(find_gains(lengths).max(axis=1)))
    shortest, longest = lengths[max(best - 1, 0)], lengths[min(best + 1, _LENGTHS - 1)]
    lengths = np.geomspace(shortest, longest, _LENGTHS)
    gains = find_gains(lengths)
    likely = np.exp(gains - gains.max())
    of_size, squares = likely.sum(axis=0) / likely.sum(), likely @ sizes**2
    size = math.sqrt(float(of_size @ sizes**2))
    std = math.sqrt(max(size**2 - float(of_size @ sizes) ** 2, 0.0))
    length = float(squares @ lengths / squares.sum())
    return PatternSize(size, std, length, float(gains.max()))


def map_pattern(
    factors: CellFactors,
    found: PatternSize,
    shape: tuple[int, int],
    means: CellPattern | None = None,
) -> Pattern:
    """Map the most likely pattern of the size and length found.

    The factors show what no smooth gap takes up. Where means over larger cells are known from a gap
    of known form, they are the pattern there, and the factors show how it varies about them.

    Parameters
    ----------
    factors : CellFactors
    found : PatternSize
    shape : tuple of int
        Rows and columns of the image.
    means : CellPattern, optional
        Over cells, each a number of whole cells of the factors.

    Returns
    -------
    Pattern
    """
    variance, length = found.size**2, found.length
    shown, widths = factors.shown, _cell_widths(factors.centres)
    prior = variance * correlate_cells(length, factors.centres)
    known = np.linalg.inv(shown @ prior @ shown.T + factors.noise)

    # at pixels, by the means over cells, column by column and row by row
    middles = [np.unique(at) for at in factors.centres]
    along, down = (
        _correlate_along(length, np.arange(float(count)), at, width, means=1)
        for count, at, width in zip(shape[::-1], middles, widths, strict=True)
    )
    weights = shown.T @ known @ factors.values

    # what is left in the middle of each cell
    columns, rows = (
        _correlate_along(length, at, at, width, means=1)
        for at, width in zip(middles, widths, strict=True)
    )
    at_middles = variance * np.kron(rows, columns)
    seen = at_middles @ shown.T
    left = variance - np.sum(seen @ known * seen, axis=1)
    if means is not None:
        merge = _merge_cells(factors.centres, means.centres)
        by_means = merge.T - shown.T @ known @ (shown @ prior @ merge.T)
        before = merge @ prior @ by_means
        share = by_means @ np.linalg.inv(before + _RIDGE * variance * np.eye(len(before)))
        weights = weights + share @ (means.value - merge @ prior @ weights)
        moved = at_middles @ share
        left = left + np.sum(moved @ (means.covariance - before) * moved, axis=1)
    table = len(middles[1]), len(middles[0])
    value = variance * (down @ weights.reshape(table) @ along.T)
    std = np.sqrt(np.maximum(left, 0.0)).reshape(table).astype(np.float32)
    wide = cv2.resize(std, shape[::-1], interpolation=cv2.INTER_LINEAR)
    return Pattern(value.astype(np.float32), np.asarray(wide))


def _merge_cells(small: tuple[Array, Array], large: tuple[Array, Array]) -> Array:
    """Weights of small cells in the means over large ones, (large, small)."""
    apart = sum(np.subtract.outer(one, other) ** 2 for one, other in zip(large, small, strict=True))
    inside = np.equal.outer(np.arange(len(large[0])), np.argmin(apart, axis=0)).astype(float)
    return np.asarray(inside / inside.sum(axis=1, keepdims=True))


def correlate_cells(length: float, centres: tuple[Array, Array]) -> Array:
    """Covariance of the means of a pattern of variance 1 over cells.

    The mean over a cell is that of a Gaussian of the same width.

    Parameters
    ----------
    length : float
        [px]
    centres : tuple of two arrays, (cell,)
        Columns and rows of their middles. [px]

    Returns
    -------
    array, (cell, cell)

    Examples
    --------
    The mean over a cell varies less than the pattern:

    >>> centres = np.array([0.0, 8, 0, 8]), np.array([0.0, 0, 8, 8])
    >>> correlate_cells(16.0, centres)[0, :2].round(2)
    array([0.92, 0.73])
    """
    along, down = (
        _correlate_along(length, at, at, width)
        for at, width in zip(centres, _cell_widths(centres), strict=True)
    )
    return along * down


def _cell_widths(centres: tuple[Array, Array]) -> list[float]:
    """Columns and rows of a cell. [px]"""
    return [float(np.ptp(at)) / (np.unique(at).size - 1) for at in centres]


def _correlate_along(
    length: float, at: Array, cells: Array, width: float, *, means: int = 2
) -> Array:
    """The same along one axis, of `means` over cells; with a pixel in place of one it is 1."""
    seen = length**2 + means * width**2 / 6
    return np.asarray(
        length / math.sqrt(seen) * np.exp(-(np.subtract.outer(at, cells) ** 2) / seen)
    )
