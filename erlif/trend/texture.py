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
from dataclasses import dataclass, replace
from typing import NamedTuple

import cv2
import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array, Image
from erlif.ratio.cells import LightCells
from erlif.trend.blocks import Region
from erlif.trend.cells import FEWEST_FRAMES, choose_cells
from erlif.trend.curve import FilmCurve
from erlif.trend.gap import GapMinimum, GapShape, gap_shapes

_MOST_FRAMES = 100  # as for the errors of the gap
_DEGREE = 3  # of the smooth gap, and of what is smooth over the picture: beyond the term field
_STEPS = 3  # of Gauss and Newton to the gap of each frame
_FEWEST = 20  # cells whose factor is known
_LONGEST = 4  # cells: a third of the picture
_LENGTHS, _SIZES = 8, 200  # that are tried, to 8 % of the variance
_SMALLEST, _LARGEST = 1e-3, 0.3  # sizes among which the true one is sought
_NOTED = 0.0015  # flat frames of small pictures leave as much
_SIGNIFICANT = 12.0  # rise of the logarithm of the likelihood: five standard deviations
_GRID = 24  # places along and across a region
_LITTLE = 1e-9  # ridge over the trace: the cells of a frame may lie in few columns
_DEPENDENT = 1e-6  # determinant over its largest value from which f and m are not separated


class Pattern(NamedTuple):
    """What stands still at each pixel, as it is taken out of the ratio, (y, x).

    Attributes
    ----------
    log_ratio : Image
        [1]
    std : Image
        Standard deviation of what is left. [1]
    """

    log_ratio: Image
    std: Image


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
    pattern : Pattern | None
        What of it is taken out of the ratio; None where nothing is.
    """

    size: float
    std: float
    length: float
    film: float
    pattern: Pattern | None = None

    @property
    def left(self) -> float:
        """Error of a pixel in the maps, the median over the picture. [1]"""
        return self.size if self.pattern is None else float(np.median(self.pattern.std))

    def in_cells(self, centres: tuple[Array, Array]) -> Array:
        """Covariance of its means over cells of these columns and rows, (cell, cell)."""
        return self.size**2 * _correlate(self.length, centres, _cell_widths(centres))

    def over(self, region: Region) -> float:
        """Standard deviation of its mean over a region. [1]"""
        variance = self.size**2
        for side in (region.rows, region.columns):
            places = np.linspace(side.start, side.stop - 1, _GRID)
            variance *= np.exp(-((np.subtract.outer(places, places) / self.length) ** 2)).mean()
        return math.sqrt(variance)

    def in_numbers(
        self,
        region: Region,
        gap: GapMinimum,
        curve: RatioCurve,
        contact: GapShape,
        *,
        along_x: bool,
    ) -> Array:
        """Changes of the mean over a region, and of the minimum of a fitted gap, by the pattern.

        Both over those by a change of the ratio that is even over the region. In thick films the
        same change of the ratio is more film. The norm of a row is the share of the size that is
        the error of the number; products of rows are covariances, also those of several gaps.

        Parameters
        ----------
        region : Region
        gap : GapMinimum
        curve : RatioCurve
        contact : GapShape
        along_x : bool
            Whether image x is the sliding direction.

        Returns
        -------
        array, (2, part)
            By independent parts of the pattern of variance 1; those of the mean of an even film for
            both where the gap is not known.
        """
        pixels = (region.columns, region.rows) if along_x else (region.rows, region.columns)
        start = np.array([one.start for one in pixels])
        half = 0.5 * (np.array([one.stop for one in pixels]) - 1 - start)
        places = np.linspace(-1, 1, _GRID)
        apart = np.subtract.outer(places, places)
        powers = [np.linalg.eigh(np.exp(-((side * apart / self.length) ** 2))) for side in half]
        along, across = (axes * np.sqrt(np.maximum(power, 0.0)) for power, axes in powers)

        # weights of even places of the region in the mean, and in the least squares of the gap
        of_mean = of_gap = np.ones(_GRID**2)
        if np.isfinite(gap.amplitudes).all():
            even = np.stack(np.meshgrid(places, places, indexing="ij")).reshape(2, -1)
            shapes = gap_shapes(even[0], even[1], contact)
            low, high = curve.thickness_range
            film = gap.amplitudes[: len(shapes)] @ shapes
            used = shapes * (film < high)
            place = gap.place if along_x else gap.place[::-1]
            at = (place - start) / half - 1
            at_place = gap_shapes(at[0], at[1], contact)
            of_mean = (film < high) / curve.slope(np.clip(film, low, high))
            of_gap = of_mean * (at_place @ np.linalg.solve(used @ shapes.T, used))

        tables = (weights.reshape(_GRID, _GRID) for weights in (of_mean, of_gap))
        return np.stack([(along.T @ table @ across).ravel() / table.sum() for table in tables])


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
    cells = _measure_factor(record, centres, calibration)
    return None if cells is None else cells.find()


def map_texture(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    shape: tuple[int, int],
) -> Texture | None:
    """Find what stands still in the image, and its most likely value at each pixel.

    The values are those of a Gaussian process with the covariance of the factor, by the factors of
    the cells without what is smooth over the picture (Rasmussen and Williams 2006, equations 2.25
    and 2.26).

    Parameters
    ----------
    record, centres, calibration
        As for `find_texture`, of cells that are small enough to show it.
    shape : tuple of int
        Rows and columns of the image.

    Returns
    -------
    Texture or None
        With its pattern; None where nothing is significant.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.show.plots import example_calibration
    >>> empty, places = LightCells(*np.full((4, 4, 120), np.nan)), np.zeros(120)
    >>> map_texture(empty, (places, places), example_calibration(), (80, 96)) is None
    True
    """
    cells = _measure_factor(record, centres, calibration)
    texture = None if cells is None else cells.find()
    if cells is None or texture is None:
        return None
    return replace(texture, pattern=cells.map(texture, shape))


@dataclass(frozen=True)
class _Factors:
    """The fixed factor of the cells that show it.

    `gap` are the shapes that are smooth over the picture, (shape, cell), `left` the share of the
    factor of each cell (column) in that of a cell that shows it (row). `film` is the median. [um]
    """

    factor: Array
    noise: Array
    gap: Array
    left: Array
    centres: tuple[Array, Array]
    film: float

    def find(self) -> Texture | None:
        """Size and length of what stands still; None where it is not significant."""
        gain, size, std, length = _likeliest(
            self.factor, self.noise, self.gap, self.left, self.centres
        )
        if gain < _SIGNIFICANT or size < _NOTED:
            return None
        return Texture(size, std, length, self.film)

    def map(self, texture: Texture, shape: tuple[int, int]) -> Pattern:
        """The most likely pattern."""
        rough = _roughness(self.gap)
        shown, widths = rough.T @ self.left, _cell_widths(self.centres)
        covariance = texture.in_cells(self.centres)
        known = shown @ covariance @ shown.T + (rough.T * self.noise) @ rough
        weights = shown.T @ np.linalg.solve(known, rough.T @ self.factor)

        # at pixels and in the mean over cells, column by column and row by row
        middles = [np.unique(at) for at in self.centres]
        along, down = (
            _correlate_along(texture.length, np.arange(float(count)), at, width, means=1)
            for count, at, width in zip(shape[::-1], middles, widths, strict=True)
        )
        grid = weights.reshape(len(middles[1]), len(middles[0]))
        value = texture.size**2 * (down @ grid @ along.T)

        # what is left in the middle of each cell
        columns, rows = (
            _correlate_along(texture.length, at, at, width, means=1)
            for at, width in zip(middles, widths, strict=True)
        )
        seen = texture.size**2 * np.kron(rows, columns) @ shown.T
        variance = texture.size**2 - np.sum(seen * np.linalg.solve(known, seen.T).T, axis=1)
        std = np.sqrt(np.maximum(variance, 0.0)).reshape(grid.shape).astype(np.float32)
        wide = cv2.resize(std, shape[::-1], interpolation=cv2.INTER_LINEAR)
        return Pattern(value.astype(np.float32), np.asarray(wide))


def _measure_factor(
    record: LightCells, centres: tuple[Array, Array], calibration: RatioCurve
) -> _Factors | None:
    """The fixed factor of each cell beside marks and a smooth gap; None where too few show it."""
    steps = np.unique(np.linspace(0, len(record.log_ratio) - 1, _MOST_FRAMES).round().astype(int))
    value, variance = (np.asarray(one, float)[steps] for one in (record[1], record[3]))
    known = np.isfinite(value) & (variance > 0)
    measured = calibration.inverse.look_up(np.where(known, value, 0.0))
    chosen = choose_cells(measured, known, calibration)
    frames = chosen.any(axis=1)
    if frames.sum() < FEWEST_FRAMES:
        return None
    weight = np.where(chosen, 1 / np.where(chosen, variance, 1.0), 0.0)[frames]
    places = np.array([2 * (at - at.min()) / np.ptp(at) - 1 for at in centres])
    shapes, rates = _shapes(*places), _change_within(centres, places)
    curve, value, measured = FilmCurve.of(calibration), value[frames], measured[frames]
    film, slope, rest = _fit_gaps(value, measured, weight, curve, shapes, rates)

    factor, noise, by_frame = _separate(rest, weight, slope, len(shapes))
    known = np.isfinite(factor)
    if known.sum() < _FEWEST:
        return None
    left = np.eye(len(factor)) - _absorbed(by_frame, weight, slope, shapes)
    seen = factor[known], noise[known], shapes[:, known], left[known]
    return _Factors(*seen, centres, float(np.median(film[weight > 0])))


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


def _absorbed(by_frame: Array, weight: Array, slope: Array, shapes: Array) -> Array:
    """What the gaps of all frames take of a fixed factor, (cell, cell)."""
    acts = slope[:, None] * shapes
    return np.tensordot(by_frame[:, None] * acts, _fit_frames(acts, weight), axes=((0, 1), (0, 1)))


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


def _separate(rest: Array, weight: Array, slope: Array, shapes: int) -> tuple[Array, Array, Array]:
    """Fixed factor of each cell beside its marks, its variance, and the share of each frame in it.

    NaN where films hardly differ.
    `shapes` is the number of those that were fitted to each frame.
    """
    own, mixed, marks = ((weight * slope**n).sum(axis=0) for n in range(3))
    det = own * marks - mixed**2
    det = np.where(det > _DEPENDENT * own * marks, det, np.nan)
    by_frame = weight * (marks - mixed * slope) / det
    factor = (by_frame * rest).sum(axis=0)
    left = rest - factor - slope * (weight * (own * slope - mixed) / det * rest).sum(axis=0)

    # noise beyond that of photons; the gap of each frame takes its share of the freedom
    count = weight > 0
    share = 1 - shapes / np.maximum(count.sum(axis=1), shapes + 1)
    excess = (weight * left**2).sum(axis=0) / np.maximum(share @ count - 2, 1)
    return factor, np.maximum(excess, 1.0) * marks / det, by_frame


def _cell_widths(centres: tuple[Array, Array]) -> list[float]:
    """Columns and rows of a cell. [px]"""
    return [float(np.ptp(at)) / (np.unique(at).size - 1) for at in centres]


def _correlate(length: float, centres: tuple[Array, Array], widths: list[float]) -> Array:
    """Covariance of the means of a pattern of variance 1 over cells, (cell, cell).

    The mean over a cell is that of a Gaussian of the same width.
    """
    along, down = (
        _correlate_along(length, at, at, width) for at, width in zip(centres, widths, strict=True)
    )
    return along * down


def _correlate_along(
    length: float, at: Array, cells: Array, width: float, *, means: int = 2
) -> Array:
    """The same along one axis; where one of both is a pixel, in place of a mean, `means` is 1."""
    seen = length**2 + means * width**2 / 6
    return np.asarray(
        length / math.sqrt(seen) * np.exp(-(np.subtract.outer(at, cells) ** 2) / seen)
    )


def _roughness(shapes: Array) -> Array:
    """Orthogonal changes of the cells that are not smooth over the picture, (cell, change)."""
    return np.asarray(np.linalg.qr(shapes.T, mode="complete")[0][:, len(shapes) :])


def _likeliest(
    factor: Array, noise: Array, shapes: Array, left: Array, centres: tuple[Array, Array]
) -> tuple[float, float, float, float]:
    """Rise of the logarithm of the likelihood by a texture; its size, standard deviation, length.

    Without the smooth shapes.
    """
    rough = _roughness(shapes)
    root = np.linalg.inv(np.linalg.cholesky((rough.T * noise) @ rough)) @ rough.T
    widths = _cell_widths(centres)
    sizes = np.geomspace(_SMALLEST, _LARGEST, _SIZES)
    lengths = np.geomspace(0.5 * max(widths), _LONGEST * min(widths), _LENGTHS)
    gains = []
    for length in lengths:
        covariance = _correlate(length, centres, widths)
        power, axes = np.linalg.eigh(root @ left @ covariance @ left.T @ root.T)
        share, total = (axes.T @ (root @ factor)) ** 2, 1 + sizes[:, None] ** 2 * power
        gains.append(0.5 * (share - share / total - np.log(total)).sum(axis=1))

    # means over all sizes and lengths, each as likely before as any other
    likely = np.exp(np.array(gains) - np.max(gains))
    of_size, squares = likely.sum(axis=0) / likely.sum(), likely @ sizes**2
    size = math.sqrt(float(of_size @ sizes**2))
    std = math.sqrt(max(size**2 - float(of_size @ sizes) ** 2, 0.0))
    return float(np.max(gains)), size, std, float(squares @ lengths / squares.sum())
