"""Smooth gaps through the films of coarse cells, and what they leave of the ratio."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array, Mask
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells
from erlif.trend.curve import FilmCurve

_MOST_FRAMES = 100  # as for the errors of the gap
_DEGREE = 3  # of the smooth gap, and of what is smooth over the picture: beyond the term field
_STEPS = 3  # of Gauss and Newton to the gap of each frame
_FEWEST = 20  # cells whose factor is known
_LITTLE = 1e-9  # ridge over the trace: the cells of a frame may lie in few columns
_DEPENDENT = 1e-2  # determinant over its largest value from which f and m are not separated


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
    A film that is even, and moves:

    >>> from erlif.ratio import cell_centres
    >>> from erlif.show.plots import example_calibration
    >>> curve, film = example_calibration(), np.linspace(2, 6, 12)[:, None] + np.zeros(120)
    >>> record = LightCells(0 * film, curve.predict_log(film), 0 * film, 1e-6 + 0 * film)
    >>> cells = fit_cells(record, cell_centres((80, 96)), curve)
    >>> bool(np.allclose(cells.film, film, atol=0.01)), round(cells.middle, 1)
    (True, 4.0)
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

    # normal equations of a factor and a mark of each cell
    factor, mixed, marks = (np.sum(weight * slope**power, axis=0) for power in (0, 1, 2))
    differ = factor * marks - mixed**2 > _DEPENDENT * factor * marks
    if differ.sum() < _FEWEST:
        return None
    return FittedCells(rest, weight, slope, film, shapes, differ, centres)


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


def fit_frames(acts: Array, weight: Array, *, ridge: float = _LITTLE) -> Array:
    """Least squares of each frame.

    Parameters
    ----------
    acts : array, (frame, shape, cell)
        What an amplitude does.
    weight : array, (frame, cell)
    ridge : float
        Over the trace of the normal equations. [1]

    Returns
    -------
    array, (frame, shape, cell)
        Amplitudes by the value of each cell.

    Examples
    --------
    >>> mean = fit_frames(np.ones((1, 1, 4)), np.array([[1.0, 1, 1, 0]]))
    >>> mean.round(3)
    array([[[0.333, 0.333, 0.333, 0.   ]]])
    """
    weighted = acts * weight[:, None]
    normal = weighted @ np.swapaxes(acts, 1, 2)
    trace = np.trace(normal, axis1=1, axis2=2)[:, None, None]
    return np.asarray(np.linalg.solve(normal + ridge * trace * np.eye(acts.shape[1]), weighted))


def _fit_gaps(
    value: Array, measured: Array, weight: Array, curve: FilmCurve, shapes: Array, rates: Array
) -> tuple[Array, Array, Array]:
    """Smooth gap of each frame, its slope, and what it leaves of the log ratio, (frame, cell)."""
    start = np.broadcast_to(shapes, (len(value), *shapes.shape))
    amplitudes, step = np.einsum("fsc,fc->fs", fit_frames(start, np.sign(weight)), measured), 0.01
    for _ in range(_STEPS):
        film = np.clip(amplitudes @ shapes, *curve.films[[0, -1]])
        expected, slope = curve.predict(film)

        # mean over a cell in which the film differs, to second order
        spread = np.sum((amplitudes @ rates) ** 2, axis=0) / 12
        bend = (curve.predict(film + step)[1] - curve.predict(film - step)[1]) / (2 * step)
        rest = np.where(weight > 0, value - expected - 0.5 * bend * spread, 0.0)
        acts = slope[:, None] * shapes
        change = np.einsum("fsc,fc->fs", fit_frames(acts, weight), rest)
        amplitudes = amplitudes + change
    return film, slope, rest - np.einsum("fs,fsc->fc", change, acts)
