"""The factor of the ratio of each cell that is the same in all frames, beside marks and film.

The logarithm of the ratio of a cell less that of the smooth gap of its frame is a f + m s, beside
noise. The marks m of the surfaces are film, and act by the slope s of the logarithm of the ratio at
that film. Films that differ at one place from frame to frame separate both. What is smooth over the
picture is left to the gap. How a factor acts on other films, a, is its `FactorKind`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.trend.factor_kind import FactorKind
from erlif.trend.smooth_gap import FittedCells, fit_frames

_MARKS = np.geomspace(0.01, 1.0, 9)  # um: standard deviations of the marks, which are tried


@dataclass(frozen=True)
class CellFactors:
    """Logarithms of the fixed factor of the cells that show it, without what is smooth.

    Attributes
    ----------
    values : Array
        Orthogonal changes of the factor that are not smooth over the picture, (change,). [1]
    noise : Array
        Their covariance, (change, change). [1]
    shown : Array
        How the factors of all cells make them, (change, cell). [1]
    centres : tuple[Array, Array]
        Columns and rows of the middles of all cells, (cell,). [px]
    kind : FactorKind
        How the factors act on other films.
    """

    values: Array
    noise: Array
    shown: Array
    centres: tuple[Array, Array]
    kind: FactorKind


def measure_factors(cells: FittedCells, kind: FactorKind, calibration: RatioCurve) -> CellFactors:
    """Measure the fixed factor of the cells of a run.

    Parameters
    ----------
    cells : FittedCells
    kind : FactorKind
        How it acts.
    calibration : RatioCurve
        In the middle of the run.

    Returns
    -------
    CellFactors

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> film, shapes = np.linspace(2, 8, 12)[:, None] + np.zeros(30), np.eye(4, 30)
    >>> rest, known = 0.01 * np.sin(np.arange(30)) + 0 * film, np.ones(30, bool)
    >>> centres = np.arange(30.0) % 6, np.arange(30.0) // 6
    >>> cells = FittedCells(rest, 1e6 + 0 * film, 1 / film, film, shapes, known, centres)
    >>> found = measure_factors(cells, FactorKind(5.0), example_calibration())
    >>> found.values.shape, found.shown.shape
    ((26,), (26, 30))
    """
    known, shapes, slope = cells.known, cells.shapes, cells.slope
    of = cells.rest[:, known], cells.weight[:, known], slope[:, known]
    acts = kind.acts(cells.film, calibration)[0]
    sums = _Sums.of(*of, acts[:, known])
    marks = max(_MARKS, key=sums.likelihood)
    factor, noise, by_frame = _separate(*of, acts[:, known], marks, len(shapes))

    # what the gaps of all frames take of the factors of all cells
    gaps = slope[:, None] * shapes
    fitted = fit_frames(gaps, cells.weight) * acts[:, None]
    taken = np.tensordot(by_frame[:, None] * gaps[..., known], fitted, axes=((0, 1), (0, 1)))

    # changes of these cells that are orthogonal to the smooth shapes
    smooth = shapes[:, known]
    rough = np.linalg.qr(smooth.T, mode="complete")[0][:, len(smooth) :].T
    return CellFactors(
        values=rough @ factor,
        noise=(rough * noise) @ rough.T,
        shown=rough @ (np.eye(known.size)[known] - taken),
        centres=cells.centres,
        kind=kind,
    )


class _Sums(NamedTuple):
    """Weighted sums over the frames of each cell, (cell,): its normal equations for f and m."""

    factor: Array
    mixed: Array
    marks: Array
    right_factor: Array
    right_marks: Array
    square: Array

    @classmethod
    def of(cls, rest: Array, weight: Array, slope: Array, acts: Array) -> _Sums:
        """The sums of what is measured, of what the factor does, and of the slope."""
        pairs = (acts, acts), (acts, slope), (slope, slope), (acts, rest), (slope, rest)
        return cls(*((weight * a * b).sum(axis=0) for a, b in (*pairs, (rest, rest))))

    def solve(self, marks: float) -> tuple[Array, Array, Array]:
        """Factor, mark and variance of the factor, for marks of this standard deviation [um]."""
        own = self.marks + marks**-2
        det = self.factor * own - self.mixed**2
        factor = (own * self.right_factor - self.mixed * self.right_marks) / det
        mark = (self.factor * self.right_marks - self.mixed * self.right_factor) / det
        return factor, mark, own / det

    def likelihood(self, marks: float) -> float:
        """Logarithm of the likelihood, but for what is the same for all marks."""
        factor, mark, variance = self.solve(marks)
        misfit = self.square - factor * self.right_factor - mark * self.right_marks

        # factors have the size that they show
        spread = np.log1p(marks**2 * self.marks) + np.log(np.mean(factor**2) / variance)
        return float(-0.5 * (misfit + spread).sum())


def _separate(
    rest: Array, weight: Array, slope: Array, acts: Array, marks: float, shapes: int
) -> tuple[Array, Array, Array]:
    """Fixed factor of each cell beside its marks, its variance, and the share of each frame in it.

    `marks` is the standard deviation of these [um], `shapes` the number of those that were fitted
    to each frame.
    """
    sums = _Sums.of(rest, weight, slope, acts)
    factor, mark, variance = sums.solve(marks)
    by_frame = weight * variance * (acts - sums.mixed / (sums.marks + marks**-2) * slope)

    # noise beyond that of photons; the gap of each frame takes its share of the freedom
    left, count = rest - acts * factor - slope * mark, weight > 0
    share = 1 - shapes / np.maximum(count.sum(axis=1), shapes + 1)
    excess = (weight * left**2).sum(axis=0) / np.maximum(share @ count - 2, 1)
    return factor, np.maximum(excess, 1.0) * variance, by_frame
