"""Course of a run: what should stay the same from frame to frame, and steps or drifts of it.

The light of camera 1 and the ratio both depend on the film. In each cell of the image the light of
camera 1 is that of the film which the ratio shows, times an illumination of the cell and
the energy of the pulse. Where the light of camera 2 over camera 1 changes during a run, the films
of all cells change in the ratio and not in the light. The light of camera 1 over that of the film
then changes by more in thin than in thick films, which neither the energy of a pulse nor a beam
that moves can do: a plane over the cells of each frame is free. A smooth function of the film that
is the same in all frames is free as well, so that errors of the calibration do not count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from erlif.calibration import RatioCurve
from erlif.core.arrays import AnyArray, Array, Mask
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells

# Standard deviations from which on a change is reported. The largest of 400 possible steps exceeds
# them by chance once in 400 runs.
_SIGNIFICANT = 4.5

_SIDE = 3  # frames before and after a step, at least

_LOOSE = 0.05  # standard deviation of a change of the ratio that determines nothing [1]

_TINY = 1e-12  # in place of the scatter of values without noise

_ROUNDS = 8  # of the search for the size, at most; four are usual

_TOGETHER = 16  # frames whose products are in memory at a time

_SETTLED = 0.1  # rest of a change over its standard deviation at which the search ends


@dataclass(frozen=True)
class CourseChange:
    """A step or a drift.

    Attributes
    ----------
    frame : int | None
        First frame after a step; None for a drift, which is linear over the run.
    size : float
        After less before, or at the last frame less at the first.
    std : float
        Its standard deviation.
    significance : float
        Size over its standard deviation when it was looked for; of one number for each frame, over
        the scatter of the frames.
    film : float
        Median film of the cells, for a change of the ratio. [um]
    drift : tuple[float, float]
        Drift over the run alone, whatever else explains more, and its standard deviation; for a
        change of the ratio. [1]
    """

    frame: int | None
    size: float
    std: float
    significance: float
    film: float = float("nan")
    drift: tuple[float, float] = (float("nan"), float("nan"))

    @property
    def significant(self) -> bool:
        """Whether the change is significant among all frames at which a step may begin."""
        return self.significance > _SIGNIFICANT


@dataclass(frozen=True)
class _Rows:
    """Equations ``value = response * course + others @ unknowns``, with a course by frame."""

    value: Array  # (row,)
    response: Array  # (row,)
    others: Array  # (row, unknown)
    frame: npt.NDArray[np.intp]  # (row,), rising from 0; each has a row
    count: int  # frames

    def find(self, courses: Array) -> tuple[int, float, float]:
        """Find the course (course, frame) that explains most: its number, size and std."""
        n, others = self.count, self.others
        inverse = np.linalg.pinv(others.T @ others, rcond=1e-10, hermitian=True)
        value = self.value - others @ (inverse @ (others.T @ self.value))
        first = np.searchsorted(self.frame, np.arange(n))
        mixed = self._by_frame(first)
        normal = np.diag(np.bincount(self.frame, self.response**2, n)) - mixed @ inverse @ mixed.T
        score = courses @ np.bincount(self.frame, self.response * value, n)
        square = np.einsum("kn,nm,km->k", courses, normal, courses, optimize=True)
        explained = np.where(square > 0, score**2 / np.where(square > 0, square, 1.0), 0.0)

        best = int(np.argmax(explained))
        if not square[best] > 0:
            return best, 0.0, np.inf
        size = float(score[best] / square[best])
        response = self.response * courses[best, self.frame]
        response -= others @ (inverse @ (courses[best] @ mixed))
        rest = value - size * response

        # errors of the cells of a frame, and of a few frames in turn, are not independent
        alone = float((rest**2).mean() * square[best])
        together = _long_run(np.bincount(self.frame, response * rest, n).astype(float))
        return best, size, float(np.sqrt(max(alone, together))) / float(square[best])

    def _by_frame(self, first: npt.NDArray[np.intp]) -> Array:
        """Sums of `response * others` over the rows of each frame, (frame, unknown)."""
        sums = np.empty((self.count, self.others.shape[1]))
        for start in range(0, self.count, _TOGETHER):
            of = first[start : start + _TOGETHER]
            end = first[start + _TOGETHER] if start + _TOGETHER < self.count else len(self.frame)
            rows = slice(of[0], end)
            products = self.others[rows] * self.response[rows, None]
            sums[start : start + len(of)] = np.add.reduceat(products, of - of[0])
        return sums


def _long_run(values: Array) -> float:
    """Variance of the sum of values that are correlated over a few frames (Newey, West 1987)."""
    lags = int(4 * (len(values) / 100) ** (2 / 9))
    products = [float(values[lag:] @ values[: len(values) - lag]) for lag in range(lags + 1)]
    weights = [2 * (1 - lag / (lags + 1)) for lag in range(1, lags + 1)]
    return max(products[0] + float(np.dot(weights, products[1:])), products[0])


def _courses(count: int) -> Array:
    """Possible courses, (course, frame): a drift, then a step at each frame."""
    frame = np.arange(count)
    steps = frame >= np.arange(_SIDE, count - _SIDE + 1)[:, None]
    return np.concatenate([frame[None] / (count - 1), steps.astype(float)])


def find_shift(frames: AnyArray, values: Array) -> CourseChange | None:
    """The largest step or drift of one number of each frame.

    Parameters
    ----------
    frames : array of int, (frame,)
        Numbers of the frames.
    values : array, (frame,)
        NaN where it was not measured.

    Returns
    -------
    CourseChange or None
        None with fewer than 12 frames.

    Examples
    --------
    >>> values = np.random.default_rng(1).normal(size=40) + 8 * (np.arange(40) >= 25)
    >>> found = find_shift(np.arange(40), values)
    >>> found.frame, found.significant, round(found.size)
    (25, True, 8)
    """
    known = np.flatnonzero(np.isfinite(values))
    if known.size < FEWEST_FRAMES:
        return None
    one, courses = np.ones((known.size, 1)), _courses(known.size)
    rows = _Rows(values[known], one[:, 0], one, np.arange(known.size), known.size)
    best, size, std = rows.find(courses)

    # values that wander have their largest step somewhere: one that counts exceeds their scatter
    scatter = float(np.std(rows.value - size * courses[best]))
    significance = abs(size) / max(scatter, _TINY)
    return CourseChange(_frame_of(best, frames[known]), size, std, significance)


def find_ratio_change(
    frames: AnyArray,
    record: LightCells,
    places: tuple[Array, Array],
    calibration: RatioCurve,
) -> CourseChange | None:
    """The largest step or drift of the logarithm of the ratio at equal film.

    Parameters
    ----------
    frames : array of int, (frame,)
        Numbers of the frames, rising.
    record : LightCells
        Of these frames.
    places : tuple of two arrays, (cell,)
        Positions (x, y) of the cells, from -1 to 1.
    calibration : RatioCurve

    Returns
    -------
    CourseChange or None
        None where too few frames or cells show a film within the calibrated range, or where one
        film in all cells and frames leaves nothing to compare.

    Examples
    --------
    A run of four frames is too short:

    >>> from erlif.show.plots import example_calibration
    >>> empty = LightCells(*np.full((4, 4, 120), np.nan))
    >>> places = np.zeros(120), np.zeros(120)
    >>> find_ratio_change(np.arange(4), empty, places, example_calibration()) is None
    True
    """
    film, chosen = _choose(record.log_ratio, record.light, calibration)
    used = np.flatnonzero(chosen.any(axis=1))
    if used.size < FEWEST_FRAMES:
        return None
    courses = _courses(used.size)
    light, chosen = record.light[used], chosen[used]
    log_ratio = np.where(chosen, record.log_ratio[used], record.log_ratio[used][chosen].mean())

    rows = _light_rows(light, log_ratio, chosen, places, calibration)
    best, size, std = rows.find(courses)
    if not std < _LOOSE:
        return None
    drifting = rows.find(courses[:1])[1]
    del rows  # tens of megabytes, before those of each round
    significance = abs(size) / max(std, _TINY)

    def settle(number: int, size: float) -> tuple[float, float]:
        """Size of a course and its standard deviation; NaN where it is not determined."""
        course, total, step, rest, rate = courses[number], size, size, size, 1.0
        for _ in range(_ROUNDS - 1):
            shifted = log_ratio - total * course[:, None]
            rows = _light_rows(light, shifted, chosen, places, calibration)
            _, size, std = rows.find(course[None])
            del rows
            if not std < _LOOSE:
                return float("nan"), float("nan")
            if size == rest:
                break
            # by secants: films of another ratio also change the smooth function, and the equations
            # show so many times a change, and its error
            rate = (rest - size) / step
            if abs(size) < _SETTLED * std:
                break
            step, rest = size / rate, size
            total += step
        return total, std / abs(rate)

    total, std = settle(best, size)
    if not std < _LOOSE:
        return None
    drift = settle(0, drifting) if best else (total, std)
    median = float(np.median(film[used][chosen]))
    return CourseChange(_frame_of(best, frames[used]), total, std, significance, median, drift)


def _frame_of(course: int, frames: AnyArray) -> int | None:
    """Frame at which a course of `_courses` has its step."""
    return int(frames[course - 1 + _SIDE]) if course else None


def _choose(log_ratio: Array, light: Array, calibration: RatioCurve) -> tuple[Array, Mask]:
    """Films, and the cells whose light can be compared with them, (frame, cell)."""
    table = calibration.inverse
    first, last = table.log_ratio[[0, -1]]
    known = np.isfinite(log_ratio) & np.isfinite(light) & (log_ratio > first) & (log_ratio < last)
    film = table.look_up(np.where(known, log_ratio, first))
    return film, choose_cells(film, known, calibration)


def _light_rows(
    light: Array, log_ratio: Array, chosen: Mask, places: tuple[Array, Array], cal: RatioCurve
) -> _Rows:
    """Set up the equations of the light of camera 1 against that expected of the film."""
    film = cal.inverse.look_up(log_ratio)
    of_film = cal.model.light(film)
    response = of_film.slope / cal.slope(film)
    frame, cell = np.nonzero(chosen)

    # the illumination of each cell, and what errors of the calibration do in all frames alike
    own = [response, response**2, response**3, film, film**2, film * response]
    cells = light.shape[1]
    columns = np.zeros((len(frame), 2 + cells + len(own)))
    columns[np.arange(len(frame)), 2 + cell] = 1.0
    for n, one in enumerate(own, 2 + cells):
        columns[:, n] = one[chosen]

    # energy and pointing of each pulse: a plane over the cells of a frame
    columns[:, 0], columns[:, 1] = (light - np.log(of_film.signal))[chosen], -response[chosen]
    plane = np.stack([np.ones_like(places[0]), *places], axis=1)[cell]
    ends = np.searchsorted(frame, np.arange(len(light) + 1))
    for at in map(slice, ends[:-1], ends[1:]):
        base = np.linalg.qr(plane[at])[0]
        columns[at] -= base @ (base.T @ columns[at])
    return _Rows(columns[:, 0], columns[:, 1], columns[:, 2:], frame, len(light))
