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
    gain, size, std, length = _likeliest(
        factor[known], noise[known], shapes[:, known], left[known], centres
    )
    if gain < _SIGNIFICANT or size < _NOTED:
        return None
    return Texture(size, std, length, float(np.median(film[weight > 0])))


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


def _likeliest(
    factor: Array, noise: Array, shapes: Array, left: Array, centres: tuple[Array, Array]
) -> tuple[float, float, float, float]:
    """Rise of the logarithm of the likelihood by a texture; its size, standard deviation, length.

    Without the smooth shapes; the mean over a cell is that of a Gaussian of the same width.
    """
    rough = np.linalg.qr(shapes.T, mode="complete")[0][:, len(shapes) :]
    root = np.linalg.inv(np.linalg.cholesky((rough.T * noise) @ rough)) @ rough.T
    widths = [np.ptp(at) / (np.unique(at).size - 1) for at in centres]
    sizes = np.geomspace(_SMALLEST, _LARGEST, _SIZES)
    lengths = np.geomspace(0.5 * max(widths), _LONGEST * min(widths), _LENGTHS)
    gains = []
    for length in lengths:
        covariance = np.ones((1, 1))
        for at, width in zip(centres, widths, strict=True):
            seen = length**2 + width**2 / 3
            apart = np.subtract.outer(at, at) ** 2
            covariance = covariance * length / math.sqrt(seen) * np.exp(-apart / seen)
        power, axes = np.linalg.eigh(root @ left @ covariance @ left.T @ root.T)
        share, total = (axes.T @ (root @ factor)) ** 2, 1 + sizes[:, None] ** 2 * power
        gains.append(0.5 * (share - share / total - np.log(total)).sum(axis=1))

    # means over all sizes and lengths, each as likely before as any other
    likely = np.exp(np.array(gains) - np.max(gains))
    of_size, squares = likely.sum(axis=0) / likely.sum(), likely @ sizes**2
    size = math.sqrt(float(of_size @ sizes**2))
    std = math.sqrt(max(size**2 - float(of_size @ sizes) ** 2, 0.0))
    return float(np.max(gains)), size, std, float(squares @ lengths / squares.sum())
