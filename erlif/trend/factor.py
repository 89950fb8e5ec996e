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
from erlif.core.arrays import Array, Mask
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells
from erlif.trend.curve import FilmCurve
from erlif.trend.factor_kind import FactorKind

_MOST_FRAMES = 100  # as for the errors of the gap
_DEGREE = 3  # of the smooth gap, and of what is smooth over the picture: beyond the term field
_STEPS = 3  # of Gauss and Newton to the gap of each frame
_FEWEST = 20  # cells whose factor is known
_LITTLE = 1e-9  # ridge over the trace: the cells of a frame may lie in few columns
_DEPENDENT = 1e-2  # determinant over its largest value from which f and m are not separated
_MARKS = np.geomspace(0.01, 1.0, 9)  # um: standard deviations of the marks, which are tried


class FittedCells(NamedTuple):
    """What the smooth gaps of all frames leave of the logarithms of the ratio of cells.

    Attributes
    ----------
    rest : Array
        (frame, cell) [1]
    weight : Array
        One over their variance, 0 where there is none, (frame, cell). [1]
    slope : Array
        Derivative of the logarithm of the ratio by the film, (frame, cell). [1/um]
    film : Array
        Of the smooth gap, (frame, cell). [um]
    shapes : Array
        Those of the gap, (shape, cell). [1]
    known : Mask
        Cells whose films differ enough to separate factor and mark, (cell,).
    centres : tuple[Array, Array]
        Columns and rows of the middles of all cells, (cell,). [px]
    """

    rest: Array
    weight: Array
    slope: Array
    film: Array
    shapes: Array
    known: Mask
    centres: tuple[Array, Array]

    @property
    def middle(self) -> float:
        """Median film. [um]"""
        return float(np.median(self.film[self.weight > 0]))


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


def fit_cells(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    pattern: float = 0.0,
) -> FittedCells | None:
    """Fit the smooth gap of each frame of a run.

    Parameters
    ----------
    record : LightCells
        (frame, cell)
    centres : tuple of two arrays, (cell,)
        Columns and rows of the middles of the cells. [px]
    calibration : RatioCurve
        In the middle of the run.
    pattern : float
        Size of what stands still, where larger cells show it. [1]

    Returns
    -------
    FittedCells or None
        None with fewer than twelve frames, or fewer than 20 cells whose films differ.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.ratio import cell_centres
    >>> from erlif.show.plots import example_calibration
    >>> empty = LightCells(*np.full((4, 4, 120), np.nan))
    >>> fit_cells(empty, cell_centres((80, 96)), example_calibration()) is None
    True
    """
    steps = np.unique(np.linspace(0, len(record.log_ratio) - 1, _MOST_FRAMES).round().astype(int))
    value, variance = (np.asarray(one, float)[steps] for one in (record[1], record[3]))
    known = np.isfinite(value) & (variance > 0)
    measured = calibration.inverse.look_up(np.where(known, value, 0.0))
    places = np.array([2 * (at - at.min()) / np.ptp(at) - 1 for at in centres])
    shapes, rates = _shapes(*places), _change_within(centres, places)
    curve, film = FilmCurve.of(calibration), measured
    for _ in range(2):
        # chosen by their own films, cells at the end of the range are those with less of it
        chosen = choose_cells(film, known, calibration, pattern)
        frames = chosen.any(axis=1)
        if frames.sum() < FEWEST_FRAMES:
            return None
        value, measured, known = value[frames], measured[frames], known[frames]
        variance, chosen = variance[frames], chosen[frames]
        weight = np.where(chosen, 1 / np.where(chosen, variance, 1.0), 0.0)
        film, slope, rest = _fit_gaps(value, measured, weight, curve, shapes, rates)

    plain = _Sums.of(rest, weight, slope, np.ones_like(rest))
    apart = plain.factor * plain.marks - plain.mixed**2
    differ = apart > _DEPENDENT * plain.factor * plain.marks
    if differ.sum() < _FEWEST:
        return None
    return FittedCells(rest, weight, slope, film, shapes, differ, centres)


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
    >>> frames, shapes = np.zeros((12, 30)), np.eye(4, 30)
    >>> film = np.linspace(2, 8, 12)[:, None] + frames
    >>> slope, centres = 1 / film, (np.arange(30.0) % 6, np.arange(30.0) // 6)
    >>> cells = FittedCells(
    ...     frames, 1 + frames, slope, film, shapes, np.ones(30, bool), centres
    ... )
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
    fitted = _fit_frames(gaps, cells.weight) * acts[:, None]
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


def _shapes(x: Array, y: Array) -> Array:
    """Polynomials that are smooth over the picture, (shape, cell), at places from -1 to 1."""
    along, down = (np.polynomial.legendre.legvander(at, _DEGREE).T for at in (x, y))
    return np.stack([a * b for n, a in enumerate(along) for b in down[: _DEGREE + 1 - n]])


def _change_within(centres: tuple[Array, Array], places: Array) -> Array:
    """Change of the shapes over the width of each cell along x and y, (direction, shape, cell)."""
    changes = []
    for n, centre in enumerate(centres):
        # cells are whole blocks side by side
        middles, cell = np.unique(centre, return_inverse=True)
        edges = [-0.5]
        for middle in middles:
            edges.append(2 * middle - edges[-1])
        half = np.eye(2)[n][:, None] * np.diff(edges)[cell] / np.ptp(centre)
        changes.append(_shapes(*(places + half)) - _shapes(*(places - half)))
    return np.array(changes)


def _fit_frames(acts: Array, weight: Array) -> Array:
    """Least squares of each frame: amplitudes by the value of each cell, (frame, shape, cell)."""
    weighted = acts * weight[:, None]
    normal = weighted @ np.swapaxes(acts, 1, 2)
    trace = np.trace(normal, axis1=1, axis2=2)[:, None, None]
    return np.asarray(np.linalg.solve(normal + _LITTLE * trace * np.eye(acts.shape[1]), weighted))


def _fit_gaps(
    value: Array, measured: Array, weight: Array, curve: FilmCurve, shapes: Array, rates: Array
) -> tuple[Array, Array, Array]:
    """Smooth gap of each frame, its slope, and what it leaves of the log ratio, (frame, cell)."""
    start = np.broadcast_to(shapes, (len(value), *shapes.shape))
    amplitudes, step = np.einsum("fsc,fc->fs", _fit_frames(start, np.sign(weight)), measured), 0.01
    for _ in range(_STEPS):
        film = np.clip(amplitudes @ shapes, *curve.films[[0, -1]])
        expected, slope = curve.predict(film)

        # mean over a cell in which the film differs, to second order
        spread = np.sum((amplitudes @ rates) ** 2, axis=0) / 12
        bend = (curve.predict(film + step)[1] - curve.predict(film - step)[1]) / (2 * step)
        rest = np.where(weight > 0, value - expected - 0.5 * bend * spread, 0.0)
        acts = slope[:, None] * shapes
        change = np.einsum("fsc,fc->fs", _fit_frames(acts, weight), rest)
        amplitudes = amplitudes + change
    return film, slope, rest - np.einsum("fs,fsc->fc", change, acts)


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
