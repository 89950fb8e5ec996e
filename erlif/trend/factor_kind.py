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
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.trend.cells import FEWEST_VISITS
from erlif.trend.smooth_gap import FittedCells, fit_frames

_SHARES = np.linspace(0, 1, 11)  # of a wall in the factor, which are tried
_REFLECTANCES = np.array([0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6])  # of it in the mean
_SIZES = np.geomspace(0.5, 1.5, 7)  # of the factor over that expected
_MARKS = np.array([0.02, 0.05, 0.1, 0.2, 0.4])  # um: standard deviations of the marks
_SHARE_STD = 0.2  # of the share of the wall, at least: marks take up what the derivative lacks
_LINEAR = 0.7  # of the slope at a film that the factor moves: below it nothing is linear
_RIDGE = 1e-6  # over the mean variance of the factors, and over the trace of a gap's equations


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
    known, middle = cells.known, cells.middle
    part = covariance[np.ix_(known, known)]
    variance = float(np.mean(np.diag(part)))
    linear = _linear_part(cells, math.sqrt(variance), calibration)
    if len(linear.film) < FEWEST_VISITS:
        return FactorKind.unknown(middle)

    left = _LeftByGaps(linear)
    root = np.asarray(np.linalg.cholesky(part + _RIDGE * variance * np.eye(len(part))), float)
    kinds = [
        FactorKind(middle, share, reflectance=reflectance)
        for reflectance in _REFLECTANCES
        for share in _SHARES
    ]
    normals = [left.equations(kind.acts(linear.film, calibration)[0], root) for kind in kinds]
    widths = _find_widths(normals, left.freedom)

    gain = np.array([normal.likelihood(*widths) for normal in normals])
    likely = np.exp(gain - gain.max()).reshape(_REFLECTANCES.size, _SHARES.size)
    of_reflectance, of_share = (likely.sum(axis=axis) / likely.sum() for axis in (1, 0))
    mean = float(of_share @ _SHARES)
    std = math.sqrt(float(of_share @ (_SHARES - mean) ** 2))
    return FactorKind(
        middle, mean, math.hypot(std, _SHARE_STD), float(of_reflectance @ _REFLECTANCES)
    )


def _linear_part(cells: FittedCells, size: float, calibration: RatioCurve) -> FittedCells:
    """Known cells and their frames, without films that a factor of this size [1] moves too far.

    Where the slope at the moved film is another, so is the gap that takes up a part of the factor.
    Frames with fewer cells than their gaps have amplitudes are left out.
    """
    known = cells.known
    film, slope, weight = cells.film[:, known], cells.slope[:, known], cells.weight[:, known]
    near = calibration.slope(film + size / slope) > _LINEAR * slope
    weight = np.where(near, weight, 0.0)
    frames = np.sum(weight > 0, axis=1) > len(cells.shapes)
    columns, rows = cells.centres
    return FittedCells(
        cells.rest[:, known][frames],
        weight[frames],
        slope[frames],
        film[frames],
        cells.shapes[:, known],
        known[known],
        (columns[known], rows[known]),
    )


def _find_widths(normals: Sequence[_NormalEquations], freedom: int) -> tuple[float, float, float]:
    """Most likely size of the factor over that expected, of the marks [um], and factor of the
    variance of the noise.
    """
    size, marks, noise = 1.0, float(_MARKS[1]), 1.0
    for _ in range(2):  # in turn with the kind, on which they hardly depend
        best = max(normals, key=lambda normal: normal.likelihood(size, marks, noise))
        tried = itertools.product(_SIZES.tolist(), _MARKS.tolist())
        size, marks = max(tried, key=lambda width: best.likelihood(width[0], width[1], noise))
        noise = max(best.misfit(size, marks, noise) / freedom, 1.0)
    return size, marks, noise


@dataclass(frozen=True)
class _LeftByGaps:
    """What gaps of any amplitudes leave of the logarithms of the ratio of cells."""

    cells: FittedCells

    @property
    def freedom(self) -> int:
        """Values less unknowns, of which each cell has two."""
        (frames, count), shapes = self.cells.rest.shape, len(self.cells.shapes)
        values = np.count_nonzero(self.cells.weight)
        return max(int(values - frames * shapes - 2 * count), 1)

    @cached_property
    def gaps(self) -> tuple[Array, Array]:
        """Weighted acts of the amplitudes, and amplitudes by values, (frame, shape, cell)."""
        acts = self.cells.slope[:, None] * self.cells.shapes
        return acts * self.cells.weight[:, None], fit_frames(acts, self.cells.weight, ridge=_RIDGE)

    @cached_property
    def pull(self) -> Array:
        """What is left of the weighted rest, (frame, cell)."""
        weighted, fitted = self.gaps
        amplitudes = np.einsum("fsc,fc->fs", fitted, self.cells.rest)
        taken = np.einsum("fsc,fs->fc", weighted, amplitudes)
        return np.asarray(self.cells.weight * self.cells.rest - taken)

    def product(self, one: Array, other: Array) -> Array:
        """Sums over frames of the weights between the values of two cells, (cell, cell)."""
        first, second = (
            (gaps * values[:, None]).reshape(-1, values.shape[1])
            for gaps, values in zip(self.gaps, (one, other), strict=True)
        )
        return np.asarray(np.diag((self.cells.weight * one * other).sum(axis=0)) - first.T @ second)

    @cached_property
    def marks(self) -> Array:
        """Normal equations of the marks, (cell, cell)."""
        return self.product(self.cells.slope, self.cells.slope)

    def equations(self, acts: Array, root: Array) -> _NormalEquations:
        """Those of factors, in parts by `root` of their covariance, and of marks."""
        factors = root.T @ self.product(acts, acts) @ root
        mixed = root.T @ self.product(acts, self.cells.slope)
        right = root.T @ (self.pull * acts).sum(axis=0), (self.pull * self.cells.slope).sum(axis=0)
        return _NormalEquations(
            np.block([[factors, mixed], [mixed.T, self.marks]]),
            np.concatenate(right),
            float(np.sum(self.pull * self.cells.rest)),
        )


class _NormalEquations(NamedTuple):
    """Normal equations of the parts of the factors and of the marks, and the square of the rest."""

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
