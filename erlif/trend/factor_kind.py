"""How what stands still in the image acts on films: as a window, or as a wall.

Windows and flats change the ratio of all films alike; the reflectance of a wall acts less on thin
films, by its derivative at its mean. A run has a part of both: the share of the wall and its mean
reflectance are the most likely ones. The gaps of all frames, the marks of the surfaces and the
values of the factor are unknowns of the same likelihood, since a factor that acts less on thin
films looks like one that acts on all, beside marks.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.trend.cells import FEWEST_VISITS
from erlif.trend.smooth_gap import FittedCells

_SHARES = np.linspace(0, 1, 11)  # of a wall in the factor, which are tried
_REFLECTANCES = np.array([0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6])  # of it in the mean
_SIZES = np.geomspace(0.5, 1.5, 7)  # of the factor over that expected
_MARKS = np.array([0.02, 0.05, 0.1, 0.2, 0.4])  # um: standard deviations of the marks
_SHARE_STD = 0.2  # of the share of the wall, at least: marks take up what the derivative lacks
_LINEAR = 0.7  # of the slope at a film that the factor moves: below it nothing is linear
_RIDGE = 1e-6  # of the variance


class FactorKind(NamedTuple):
    """How a factor acts: as that of a window, as that of a wall, or as both.

    Attributes
    ----------
    film : float
        Median film of the cells, for which the factor is given. [um]
    wall : float
        Share of it that acts as the reflectance of a wall, 0 to 1.
    wall_std : float
        Standard deviation of this.
    reflectance : float
        Of the wall in the mean.
    """

    film: float
    wall: float = 0.0
    wall_std: float = _SHARE_STD
    reflectance: float = 0.0

    @classmethod
    def unknown(cls, film: float) -> FactorKind:
        """Half that of a wall."""
        return cls(film, 0.5, reflectance=0.2)

    def acts(self, film: npt.ArrayLike, calibration: RatioCurve) -> tuple[Array, Array]:
        """Factor of other films over that of `film`, and its standard deviation by `wall_std`."""
        less = self.less_by_wall(film, calibration)
        return 1 - self.wall * less, self.wall_std * less

    def less_by_wall(self, film: npt.ArrayLike, calibration: RatioCurve) -> Array:
        """How much less a wall alone acts on films [um] than on `film`. [1]"""
        here, there = (calibration.by_wall(of, self.reflectance) for of in (film, self.film))
        return np.asarray(1 - here / there)


def judge_kind(cells: FittedCells, covariance: Array, calibration: RatioCurve) -> FactorKind:
    """How the factor acts, by the likelihood of all cells.

    Parameters
    ----------
    cells : FittedCells
    covariance : array, (cell, cell)
        Covariance of the factors that are expected, at the median film. [1]
    calibration : RatioCurve
        In the middle of the run.

    Returns
    -------
    FactorKind
        Half of a wall where too few films are thin enough for the factor.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> none, shapes = np.zeros((4, 30)), np.eye(4, 30)
    >>> known, centres = none[0] == 0, (none[0], none[0])
    >>> few = FittedCells(none, none + 1, none + 0.1, none + 3, shapes, known, centres)
    >>> judge_kind(few, 1e-4 * np.eye(30), example_calibration()).wall
    0.5
    """
    known = cells.known
    film, slope, rest, weight = (
        one[:, known] for one in (cells.film, cells.slope, cells.rest, cells.weight)
    )
    # where the factor moves a film so far that the slope is another, the gap is another
    moved = math.sqrt(float(np.mean(np.diag(covariance)))) / slope
    weight = np.where(calibration.slope(film + moved) > _LINEAR * slope, weight, 0.0)
    frames = np.sum(weight > 0, axis=1) > len(cells.shapes)  # the others are left to their gaps
    middle = cells.middle
    if frames.sum() < FEWEST_VISITS:
        return FactorKind.unknown(middle)

    film, slope, rest, weight = (one[frames] for one in (film, slope, rest, weight))
    part = covariance[np.ix_(known, known)]
    root = np.linalg.cholesky(part + _RIDGE * np.trace(part) / len(part) * np.eye(len(part)))
    left = _LeftByGaps.of(rest, weight, slope, cells.shapes[:, known])
    kinds = [
        FactorKind(middle, share, reflectance=reflectance)
        for reflectance in _REFLECTANCES
        for share in _SHARES
    ]
    normals = [left.normal(kind.acts(film, calibration)[0], slope, root) for kind in kinds]
    size, marks, noise = 1.0, float(_MARKS[1]), 1.0
    for _ in range(2):
        best = max(normals, key=lambda normal: normal.likelihood(size, marks, noise))
        widths = itertools.product(_SIZES.tolist(), _MARKS.tolist())
        size, marks = max(widths, key=lambda width: best.likelihood(width[0], width[1], noise))
        noise = max(best.misfit(size, marks, noise) / left.freedom, 1.0)

    gain = np.array([normal.likelihood(size, marks, noise) for normal in normals])
    likely = np.exp(gain - gain.max()).reshape(_REFLECTANCES.size, _SHARES.size)
    of_reflectance, of_share = (likely.sum(axis=axis) / likely.sum() for axis in (1, 0))
    mean = float(of_share @ _SHARES)
    std = math.sqrt(float(of_share @ (_SHARES - mean) ** 2))
    return FactorKind(
        middle, mean, math.hypot(std, _SHARE_STD), float(of_reflectance @ _REFLECTANCES)
    )


class _LeftByGaps(NamedTuple):
    """What gaps of any amplitudes leave: weights W - U^T U of each frame, W diagonal.

    Attributes
    ----------
    rest : Array
        (frame, cell) [1]
    weight : Array
        (frame, cell) [1]
    taken : Array
        U, (frame, shape, cell).
    """

    rest: Array
    weight: Array
    taken: Array

    @classmethod
    def of(cls, rest: Array, weight: Array, slope: Array, shapes: Array) -> _LeftByGaps:
        gaps = slope[:, None] * shapes
        weighted = gaps * weight[:, None]
        normal = weighted @ np.swapaxes(gaps, 1, 2)
        trace = np.trace(normal, axis1=1, axis2=2)[:, None, None]
        root = np.linalg.cholesky(normal + _RIDGE * trace * np.eye(len(shapes)))
        return cls(rest, weight, np.asarray(np.linalg.solve(root, weighted), float))

    @property
    def freedom(self) -> int:
        """Values less unknowns, of which each cell has two."""
        frames, shapes, cells = self.taken.shape
        left = np.count_nonzero(self.weight) - frames * shapes - 2 * cells
        return max(int(left), 1)

    def product(self, one: Array, other: Array) -> Array:
        """Sums over frames of the weights between the values of two cells, (cell, cell)."""
        first, second = (
            (self.taken * values[:, None]).reshape(-1, values.shape[1]) for values in (one, other)
        )
        return np.asarray(np.diag((self.weight * one * other).sum(axis=0)) - first.T @ second)

    def normal(self, acts: Array, slope: Array, root: Array) -> _Normal:
        """Normal equations of factors, in parts by `root` of their covariance, and of marks."""
        mixed = root.T @ self.product(acts, slope)
        matrix = np.block(
            [
                [root.T @ self.product(acts, acts) @ root, mixed],
                [mixed.T, self.product(slope, slope)],
            ]
        )
        along = np.einsum("fsc,fc->fs", self.taken, self.rest)
        weighted = self.weight * self.rest - np.einsum("fsc,fs->fc", self.taken, along)
        right = root.T @ (weighted * acts).sum(axis=0), (weighted * slope).sum(axis=0)
        return _Normal(matrix, np.concatenate(right), float(np.sum(weighted * self.rest)))


class _Normal(NamedTuple):
    """Normal equations of the parts of the factors and of the marks."""

    matrix: Array
    right: Array
    square: float

    def _scaled(self, size: float, marks: float, noise: float) -> tuple[Array, Array, Array]:
        """Widths of the unknowns, and the equations of these in units of their widths."""
        half = self.right.size // 2
        width = np.repeat([size, marks], half)
        matrix = width[:, None] * self.matrix * width / noise + np.eye(2 * half)
        return width, matrix, width * self.right / noise

    def likelihood(self, size: float, marks: float, noise: float) -> float:
        """Logarithm of the likelihood, but for what is the same for all kinds and widths."""
        _, matrix, right = self._scaled(size, marks, noise)
        root = np.linalg.cholesky(matrix)
        return float(0.5 * np.sum(np.linalg.solve(root, right) ** 2) - np.log(np.diag(root)).sum())

    def misfit(self, size: float, marks: float, noise: float) -> float:
        """Weighted sum of squares that the most likely factors and marks leave."""
        width, matrix, right = self._scaled(size, marks, noise)
        found = width * np.linalg.solve(matrix, right)
        return float(self.square - 2 * found @ self.right + found @ self.matrix @ found)
