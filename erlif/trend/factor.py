"""The factor of the ratio of each cell that is the same in all frames, beside marks and film.

The logarithm of the ratio of a cell less that of the smooth gap of its frame is a f + m s, beside
noise. The marks m of the surfaces are film, and act by the slope s of the logarithm of the ratio at
that film. Films that differ at one place from frame to frame separate both. What is smooth over the
picture is left to the gap.

Windows and flats act on all films alike, a is 1; the reflectance of a wall acts less on thin films,
by its derivative at its mean. A run has a part of both: the share of the wall, its mean reflectance
and the size of the marks are the most likely ones, over the values of f that they give.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells
from erlif.trend.curve import FilmCurve

_MOST_FRAMES = 100  # as for the errors of the gap
_DEGREE = 3  # of the smooth gap, and of what is smooth over the picture: beyond the term field
_STEPS = 3  # of Gauss and Newton to the gap of each frame
_FEWEST = 20  # cells whose factor is known
_LITTLE = 1e-9  # ridge over the trace: the cells of a frame may lie in few columns
_DEPENDENT = 1e-2  # determinant over its largest value from which f and m are not separated
_SHARES = np.linspace(0, 1, 11)  # of a wall in the factor, which are tried
_REFLECTANCES = np.array([0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6])  # of it in the mean
_MARKS = np.geomspace(0.01, 1.0, 9)  # um: standard deviations of the marks, which are tried
_SHARE_STD = 0.3  # of the share of the wall, at least: marks take up a part of it


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

    def acts(self, film: npt.ArrayLike, calibration: RatioCurve) -> tuple[Array, Array]:
        """Factor of other films over that of `film`, and its standard deviation by `wall_std`."""
        less = self.less_by_wall(film, calibration)
        return 1 - self.wall * less, self.wall_std * less

    def less_by_wall(self, film: npt.ArrayLike, calibration: RatioCurve) -> Array:
        """How much less a wall alone acts on films [um] than on `film`. [1]"""
        here, there = (calibration.by_wall(of, self.reflectance) for of in (film, self.film))
        return np.asarray(1 - here / there)


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


def measure_factors(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    pattern: float = 0.0,
) -> CellFactors | None:
    """Measure the fixed factor of the cells of a run.

    Parameters
    ----------
    record, centres, calibration, pattern
        As for `erlif.trend.find_texture`.

    Returns
    -------
    CellFactors or None
        None where fewer than 20 cells show it.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.ratio import cell_centres
    >>> from erlif.show.plots import example_calibration
    >>> empty = LightCells(*np.full((4, 4, 120), np.nan))
    >>> measure_factors(empty, cell_centres((80, 96)), example_calibration()) is None
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

    # cells whose films differ
    plain = _Sums.of(rest, weight, slope, np.ones_like(rest))
    apart = plain.factor * plain.marks - plain.mixed**2
    known = apart > _DEPENDENT * plain.factor * plain.marks
    if known.sum() < _FEWEST:
        return None
    middle = float(np.median(film[weight > 0]))
    cells = rest[:, known], weight[:, known], slope[:, known]
    kind, marks = _judge_kind(*cells, film[:, known], middle, calibration)
    acts = kind.acts(film, calibration)[0]
    factor, noise, by_frame = _separate(*cells, acts[:, known], marks, len(shapes))

    # what the gaps of all frames take of the factors of all cells
    gaps = slope[:, None] * shapes
    fitted = _fit_frames(gaps, weight) * acts[:, None]
    taken = np.tensordot(by_frame[:, None] * gaps[..., known], fitted, axes=((0, 1), (0, 1)))

    # changes of these cells that are orthogonal to the smooth shapes
    smooth = shapes[:, known]
    rough = np.linalg.qr(smooth.T, mode="complete")[0][:, len(smooth) :].T
    return CellFactors(
        values=rough @ factor,
        noise=(rough * noise) @ rough.T,
        shown=rough @ (np.eye(known.size)[known] - taken),
        centres=centres,
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


def _judge_kind(
    rest: Array, weight: Array, slope: Array, film: Array, middle: float, calibration: RatioCurve
) -> tuple[FactorKind, float]:
    """How the factor acts, given for the film `middle` [um], and standard deviation of marks [um].

    By the likelihood of all cells, factors and marks of any value.
    """
    found = []
    for reflectance in _REFLECTANCES:
        less = FactorKind(middle, reflectance=reflectance).less_by_wall(film, calibration)
        for share in _SHARES:
            sums = _Sums.of(rest, weight, slope, 1 - share * less)
            found.append([sums.likelihood(marks) for marks in _MARKS])
    gain = np.array(found).reshape(_REFLECTANCES.size, _SHARES.size, _MARKS.size)
    likely = np.exp(gain - gain.max()).sum(axis=2)
    of_reflectance, of_share = (likely.sum(axis=axis) / likely.sum() for axis in (1, 0))
    mean = float(of_share @ _SHARES)
    std = math.sqrt(float(of_share @ (_SHARES - mean) ** 2))
    kind = FactorKind(
        middle, mean, math.hypot(std, _SHARE_STD), float(of_reflectance @ _REFLECTANCES)
    )
    return kind, float(_MARKS[np.argmax(gain.max(axis=(0, 1)))])


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
        """Logarithm of the likelihood, but for what is the same for all shares and marks."""
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
