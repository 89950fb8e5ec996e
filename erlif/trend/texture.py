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
from erlif.trend.gap import GapShape, gap_shapes

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
        self, region: Region, places: Array, contact: GapShape, *, along_x: bool
    ) -> Array:
        """Its errors of a mean over a region, and of places of a fitted gap, over that of a pixel.

        Parameters
        ----------
        region : Region
        places : array, (place, 2)
            Column and row. [px]
        contact : GapShape
        along_x : bool
            Whether image x is the sliding direction.

        Returns
        -------
        array, (1 + place,)
            That of the mean where a place is not known.
        """
        order = slice(None) if along_x else slice(None, None, -1)
        sides = [(one.start, one.stop - one.start) for one in (region.columns, region.rows)]
        start, size = np.array(sides[order])[..., None].swapaxes(0, 1)
        even = np.stack(np.meshgrid(*[np.linspace(-1, 1, _GRID)] * 2)).reshape(2, -1)
        at = 2 * (places[:, order].T - start) / (size - 1) - 1

        # weights of even places of the region in the mean, and in the least squares of the gap
        shapes, wanted = gap_shapes(even[0], even[1], contact), gap_shapes(at[0], at[1], contact)
        of_gap = wanted.T @ np.linalg.solve(shapes @ shapes.T, shapes)
        weights = np.vstack([np.full_like(even[0], 1 / even[0].size), of_gap])
        pixels = even * size / 2
        apart = np.square(pixels[..., None] - pixels[:, None]).sum(axis=0)
        common = np.exp(-apart / self.length**2)
        ratios = np.sqrt(np.sum(weights @ common * weights, axis=1))
        return np.asarray(np.where(np.isfinite(ratios), ratios, ratios[0]))


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

    factor, noise = _separate(rest, weight, slope, len(shapes))
    known = np.isfinite(factor)
    if known.sum() < _FEWEST:
        return None
    gain, size, std, length = _likeliest(
        factor[known], noise[known], shapes[:, known], [at[known] for at in centres]
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


def _fit_gaps(
    value: Array, measured: Array, weight: Array, curve: FilmCurve, shapes: Array, rates: Array
) -> tuple[Array, Array, Array]:
    """Smooth gap of each frame, its slope, and what it leaves of the log ratio, (frame, cell)."""

    def solve(acts: Array, goal: Array, weight: Array) -> Array:
        weighted = acts * weight[:, None]
        normal = weighted @ np.swapaxes(acts, 1, 2)
        normal += _LITTLE * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(len(shapes))
        return np.asarray(np.linalg.solve(normal, weighted @ goal[..., None])[..., 0])

    start = np.broadcast_to(shapes, (len(value), *shapes.shape))
    amplitudes, step = solve(start, measured, np.sign(weight)), 0.01
    for _ in range(_STEPS):
        film = np.clip(amplitudes @ shapes, *curve.films[[0, -1]])
        expected, slope = curve.predict(film)

        # mean over a cell in which the film differs, to second order
        spread = np.sum((amplitudes @ rates) ** 2, axis=0) / 12
        bend = (curve.predict(film + step)[1] - curve.predict(film - step)[1]) / (2 * step)
        rest = np.where(weight > 0, value - expected - 0.5 * bend * spread, 0.0)
        acts = slope[:, None] * shapes
        change = solve(acts, rest, weight)
        amplitudes = amplitudes + change
    return film, slope, rest - np.einsum("fs,fsc->fc", change, acts)


def _separate(rest: Array, weight: Array, slope: Array, shapes: int) -> tuple[Array, Array]:
    """Fixed factor of each cell beside its marks, and its variance; NaN where films hardly differ.

    `shapes` is the number of those that were fitted to each frame.
    """
    own, mixed, marks = ((weight * slope**n).sum(axis=0) for n in range(3))
    det = own * marks - mixed**2
    det = np.where(det > _DEPENDENT * own * marks, det, np.nan)
    of_factor, of_marks = ((weight * slope**n * rest).sum(axis=0) for n in range(2))
    factor = (marks * of_factor - mixed * of_marks) / det
    left = rest - factor - slope * (own * of_marks - mixed * of_factor) / det

    # noise beyond that of photons; the gap of each frame takes its share of the freedom
    count = weight > 0
    share = 1 - shapes / np.maximum(count.sum(axis=1), shapes + 1)
    excess = (weight * left**2).sum(axis=0) / np.maximum(share @ count - 2, 1)
    return factor, np.maximum(excess, 1.0) * marks / det


def _likeliest(
    factor: Array, noise: Array, shapes: Array, centres: list[Array]
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
        power, axes = np.linalg.eigh(root @ covariance @ root.T)
        share, total = (axes.T @ (root @ factor)) ** 2, 1 + sizes[:, None] ** 2 * power
        gains.append(0.5 * (share - share / total - np.log(total)).sum(axis=1))

    # means over all sizes and lengths, each as likely before as any other
    likely = np.exp(np.array(gains) - np.max(gains))
    of_size, squares = likely.sum(axis=0) / likely.sum(), likely @ sizes**2
    size = math.sqrt(float(of_size @ sizes**2))
    std = math.sqrt(max(size**2 - float(of_size @ sizes) ** 2, 0.0))
    return float(np.max(gains)), size, std, float(squares @ lengths / squares.sum())
