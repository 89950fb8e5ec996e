"""What stands still in the image while the film moves: a fixed factor of the ratio.

The logarithm of the ratio of a cell less that of the smooth gap of its frame is f + m s and noise.
The marks m of the surfaces are film, and act by the slope s of the logarithm of the ratio at that
film. Films that differ at one place from frame to frame separate both. What is smooth over the
picture is left to the gap; the rest of f has the covariance v exp(-d^2 / l^2) at a distance d. The
reflectance of a wall acts on films from 5 to 10 um alike to 10 %, as windows and flats do: the
films of a run do not separate them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.ratio.cells import CELLS, LightCells, cell_places
from erlif.trend.blocks import Region
from erlif.trend.cells import FEWEST_FRAMES, choose_cells
from erlif.trend.curve import FilmCurve
from erlif.trend.gap import GapShape, gap_shapes

_MOST_FRAMES = 100  # as for the errors of the gap
_DEGREE = 2  # of the smooth gap, and of what is smooth over the picture: that of the term field
_STEPS = 3  # of Gauss and Newton to the gap of each frame
_FEWEST = 30  # cells whose factor is known
_LENGTHS, _SIZES = 8, 200  # that are tried, to 8 % of the variance
_SMALLEST, _LARGEST = 1e-3, 0.3  # sizes among which the true one is sought
_NOTED = 0.0015  # flat frames of small pictures leave as much
_SIGNIFICANT = 8.0  # rise of the logarithm of the likelihood: four standard deviations
_GRID = 20, 24  # places of a region, in rows and columns
_DEPENDENT = 1e-6  # determinant over its largest value from which f and m are not separated


@dataclass(frozen=True)
class Texture:
    """A factor of the ratio that is fixed in the image.

    Attributes
    ----------
    size : float
        Standard deviation of the logarithm of the ratio over the picture. [1]
    std : float
        Standard deviation of the size. [1]
    length : float
        Distance over which it is correlated (1/e). [px]
    film : float
        Median film of the cells. [um]
    """

    size: float
    std: float
    length: float
    film: float

    def mean_variance(self, region: Region, weights: Array) -> Array:
        """Variance of weighted means over a region, over that of the factor.

        Parameters
        ----------
        region : Region
        weights : array, (mean, row, column)
            At even places of the region, with a sum of 1. [1]

        Returns
        -------
        array, (mean,)
        """
        sizes = (one.stop - one.start for one in (region.rows, region.columns))
        apart = (np.linspace(0, size, n) for size, n in zip(sizes, weights.shape[1:], strict=True))
        down, along = (np.exp(-((np.subtract.outer(at, at) / self.length) ** 2)) for at in apart)
        return np.asarray(np.sum(weights * (down @ weights @ along), axis=(1, 2)))

    def over_mean(
        self, region: Region, places: Array, contact: GapShape, *, sliding_along_x: bool
    ) -> tuple[float, Array]:
        """Number of patches, and the error at places of a fitted gap over that of its mean.

        Parameters
        ----------
        region : Region
        places : array, (trigger, 2)
            Column and row. [px]
        contact : GapShape
        sliding_along_x : bool

        Returns
        -------
        patches : float
            Independent ones in the region. [1]
        ratios : array, (trigger,)
            1 where the place is not known. [1]
        """
        even = np.full((1, *_GRID), 1 / math.prod(_GRID))
        mean = float(self.mean_variance(region, even)[0])
        y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in _GRID), indexing="ij")
        first = np.array([region.columns.start, region.rows.start])
        last = np.array([region.columns.stop, region.rows.stop]) - 1
        u, v = (2 * (places - first) / (last - first) - 1).T
        order = slice(None) if sliding_along_x else slice(None, None, -1)
        shapes, wanted = (
            gap_shapes(*pair[order], contact) for pair in ((x.ravel(), y.ravel()), (u, v))
        )
        weights = wanted.T @ np.linalg.solve(shapes @ shapes.T, shapes)
        at = self.mean_variance(region, weights.reshape(-1, *_GRID))
        return 1 / mean, np.where(np.isfinite(at), np.sqrt(at / mean), 1.0)


def find_texture(
    record: LightCells, centres: tuple[Array, Array], calibration: RatioCurve
) -> Texture | None:
    """Find what stands still in the image, beside marks and a smooth gap.

    Parameters
    ----------
    record : LightCells
        (frame, cell)
    centres : tuple of two arrays, (cell,)
        Columns and rows of the middles of the cells. [px]
    calibration : RatioCurve
        In the middle of the run.

    Returns
    -------
    Texture or None
        None where nothing is significant.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.show.plots import example_calibration
    >>> empty, places = LightCells(*np.full((4, 4, 120), np.nan)), np.zeros(120)
    >>> find_texture(empty, (places, places), example_calibration()) is None
    True
    """
    steps = np.unique(np.linspace(0, len(record.log_ratio) - 1, _MOST_FRAMES).round().astype(int))
    value, variance = (np.asarray(one, float)[steps] for one in (record[1], record[3]))
    known = np.isfinite(value) & (variance > 0)
    measured = calibration.inverse.look_up(np.where(known, value, 0.0))
    chosen = choose_cells(measured, known, calibration)
    frames = chosen.any(axis=1)
    if frames.sum() < FEWEST_FRAMES:
        return None
    chosen, places = chosen[frames], cell_places()
    weight = np.where(chosen, 1 / np.where(known, variance, 1.0)[frames], 0.0)
    film, slope, rest = _fit_gaps(
        value[frames], measured[frames], weight, FilmCurve.of(calibration), places
    )

    fixed = _separate(rest, weight, slope, places)
    if fixed is None:
        return None
    gain, size, std, length = _likeliest(*fixed, centres)
    if gain < _SIGNIFICANT or size < _NOTED:
        return None
    return Texture(size, std, length, float(np.median(film[chosen])))


def _shapes(x: Array, y: Array) -> Array:
    """Polynomials that are smooth over the picture, (shape, cell)."""
    along, down = (np.polynomial.legendre.legvander(at, _DEGREE).T for at in (x, y))
    pairs = [(n, m) for n in range(_DEGREE + 1) for m in range(_DEGREE + 1 - n)]
    return np.stack([along[n] * down[m] for n, m in pairs])


def _fit_gaps(
    value: Array, measured: Array, weight: Array, curve: FilmCurve, places: tuple[Array, Array]
) -> tuple[Array, Array, Array]:
    """Smooth gap of each frame, its slope, and what it leaves of the log ratio, (frame, cell)."""
    x, y = places
    shapes, step = _shapes(x, y), 0.01
    rates = (_shapes(x + step, y) - shapes) / step, (_shapes(x, y + step) - shapes) / step

    def solve(acts: Array, goal: Array, weight: Array) -> Array:
        weighted = acts * weight[:, None]
        normal = weighted @ np.swapaxes(acts, 1, 2)
        return np.asarray(np.linalg.solve(normal, weighted @ goal[..., None])[..., 0])

    amplitudes = solve(np.broadcast_to(shapes, (len(value), *shapes.shape)), measured, weight > 0)
    for _ in range(_STEPS):
        film = np.clip(amplitudes @ shapes, *curve.films[[0, -1]])
        expected, slope = curve.predict(film)

        # mean over a cell in which the film differs, to second order
        spread = sum(
            (amplitudes @ rate) ** 2 * (2 / cells) ** 2 / 12
            for rate, cells in zip(rates, CELLS[::-1], strict=True)
        )
        bend = (curve.predict(film + step)[1] - curve.predict(film - step)[1]) / (2 * step)
        rest, acts = value - expected - 0.5 * bend * spread, slope[:, None] * shapes
        rest = np.where(weight > 0, rest, 0.0)
        change = solve(acts, rest, weight)
        amplitudes = amplitudes + change
    return film, slope, rest - np.einsum("fs,fsc->fc", change, acts)


def _separate(
    rest: Array, weight: Array, slope: Array, places: tuple[Array, Array]
) -> tuple[Array, Array, Array] | None:
    """Fixed factor of each cell without what is smooth, its noise, and both as projections.

    Returns the projection (cell, n), the factor (n,) and its covariance (n, n); None where the
    films do not separate the factor from the marks.
    """
    own, mixed, marks = ((weight * slope**n).sum(axis=0) for n in range(3))
    whole = own * marks
    known = whole - mixed**2 > _DEPENDENT * whole
    if known.sum() < _FEWEST:
        return None
    own, mixed, marks = own[known], mixed[known], marks[known]
    rest, weight, slope = (one[:, known] for one in (rest, weight, slope))
    of_factor, of_marks = ((weight * one * rest).sum(axis=0) for one in (1.0, slope))
    det = own * marks - mixed**2
    factor = (marks * of_factor - mixed * of_marks) / det
    left = rest - factor - slope * (own * of_marks - mixed * of_factor) / det

    # noise beyond that of photons
    shapes = _shapes(*places)[:, known]
    freedom = (weight > 0).sum() - 2 * known.sum() - len(shapes) * len(rest)
    excess = max(float((weight * left**2).sum()) / max(int(freedom), 1), 1.0)

    rough = np.zeros((known.size, known.sum() - len(shapes)))
    rough[known] = np.linalg.qr(shapes.T, mode="complete")[0][:, len(shapes) :]
    noise = np.zeros(known.size)
    noise[known] = excess * marks / det
    whole = np.zeros(known.size)
    whole[known] = factor
    return rough, rough.T @ whole, (rough.T * noise) @ rough


def _likeliest(
    rough: Array, factor: Array, noise: Array, centres: tuple[Array, Array]
) -> tuple[float, float, float, float]:
    """Rise of the logarithm of the likelihood by a texture; its size, standard deviation, length.

    Of all cells; the mean over a cell is that of a Gaussian of the same width.
    """
    root = np.linalg.inv(np.linalg.cholesky(noise))
    seen, acts = root @ factor, root @ rough.T
    widths = [np.ptp(at) / (cells - 1) for at, cells in zip(centres, CELLS[::-1], strict=True)]
    variance = np.geomspace(_SMALLEST, _LARGEST, _SIZES)[:, None] ** 2
    best = (-math.inf, 0.0, 0.0, 1.0)
    for length in np.geomspace(0.5 * max(widths), 6 * min(widths), _LENGTHS):
        covariance = np.ones((1, 1))
        for at, width in zip(centres, widths, strict=True):
            seen_length = length**2 + width**2 / 3
            apart = np.subtract.outer(at, at) ** 2 / seen_length
            covariance = covariance * length / math.sqrt(seen_length) * np.exp(-apart)
        power, axes = np.linalg.eigh(acts @ covariance @ acts.T)
        share = (axes.T @ seen) ** 2
        total = 1 + variance * np.maximum(power, 0)
        gains = 0.5 * (share - share / total - np.log(total)).sum(axis=1)
        k = int(np.argmax(gains))
        if gains[k] > best[0]:
            size = math.sqrt(float(variance[k, 0]))
            information = 0.5 * float(((power / total[k]) ** 2).sum())
            best = float(gains[k]), size, information**-0.5 / (2 * size), float(length)
    return best
