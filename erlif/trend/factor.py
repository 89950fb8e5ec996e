"""The factor of the ratio of each cell that is the same in all frames, beside marks and film.

The logarithm of the ratio of a cell less that of the smooth gap of its frame is f + m s and noise.
The marks m of the surfaces are film, and act by the slope s of the logarithm of the ratio at that
film. Films that differ at one place from frame to frame separate both. What is smooth over the
picture is left to the gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
_DEPENDENT = 1e-6  # determinant over its largest value from which f and m are not separated


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
    film : float
        Median film of the cells. [um]
    """

    values: Array
    noise: Array
    shown: Array
    centres: tuple[Array, Array]
    film: float


def measure_factors(
    record: LightCells, centres: tuple[Array, Array], calibration: RatioCurve
) -> CellFactors | None:
    """Measure the fixed factor of the cells of a run.

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
    CellFactors or None
        None where fewer than 20 cells show it.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.show.plots import example_calibration
    >>> empty, places = LightCells(*np.full((4, 4, 120), np.nan)), np.zeros(120)
    >>> measure_factors(empty, (places, places), example_calibration()) is None
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

    # changes of these cells that are orthogonal to the smooth shapes
    smooth = shapes[:, known]
    rough = np.linalg.qr(smooth.T, mode="complete")[0][:, len(smooth) :].T
    return CellFactors(
        values=rough @ factor[known],
        noise=(rough * noise[known]) @ rough.T,
        shown=rough @ left[known],
        centres=centres,
        film=float(np.median(film[weight > 0])),
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
