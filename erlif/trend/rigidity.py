"""Errors that no single frame shows, from a gap whose form is known and the same in all frames.

A rigid pin in a rigid bore changes the film between two frames by a displacement and a tilt alone:
four numbers. The form of the gap is that of circles of known radii, but for their roundness. An
error of the ratio or of the curve changes the film by more in thick than in thin films, and so the
curvature of the gap. All frames are fitted together: positions of the pin, form of the gap, and the
errors of the calibration and of its systematics within their covariance.

The light of camera 1 gives the illumination of the cells alone. As an equation of its own it would
lower the errors by another fifth, at the price of its energies and of the model of the light.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import block_diag

from erlif.calibration import RatioCurve, Systematics
from erlif.core.arrays import Array, Mask
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells, separate_light
from erlif.trend.equations import (
    RatioEquations,
    RigidityUnknowns,
    gap_of_pin,
    solve_equations,
)
from erlif.trend.pattern import CellPattern
from erlif.trend.position import PinView
from erlif.trend.texture import Texture

# Accuracy of the clearance by the radii at best. [1]
CLEARANCE_STD = 0.01

_MOST_FRAMES = 100  # more of them hardly lower the errors, which are common to all
_ROUNDS = 30  # steps of Gauss and Newton, at most; four are usual
_SETTLED = 0.02  # last step over the standard deviation at which the search ends
_NOTHING = 1e-12  # what rounding leaves of an error without a width
_THINNEST = 0.05  # um: film to which a search comes down that has left its equations
_NEWTON = 5  # steps to the film whose ratio has the errors
_BEYOND = 2.0  # standard deviations of the widths: a larger shift is none of theirs
_LARGEST = 5.0  # standard deviations beyond which the errors are not those of their widths


def of_curve(value: Array, covariance: Array, systematics: Systematics) -> tuple[Array, Array]:
    """Errors that a curve can take out, and their covariance.

    It cannot take out a change with the place in the picture, whose second moment is its error.

    Parameters
    ----------
    value : array, (error,)
        What a run has shown of all errors, those of `systematics` last.
    covariance : array, (error, error)
        Of this.
    systematics : Systematics

    Returns
    -------
    value, covariance : array

    Examples
    --------
    >>> field = Systematics.of({"ratio": 0.01, "field": 0.005}, parameters=0)
    >>> value, covariance = of_curve(np.full(6, 0.003), 1e-6 * np.eye(6), field)
    >>> [round(1e6 * float(variance), 3) for variance in np.diag(covariance)[:2]]
    [1.0, 10.0]
    """
    left = np.zeros_like(value)
    placed = value.size - len(systematics.parameters) + systematics.placed
    left[placed] = value[placed]
    return value - left, covariance + np.outer(left, left)


@dataclass(frozen=True)
class ErrorEstimate:
    """Errors of a calibration and of its systematics as a run shows them.

    Attributes
    ----------
    value : Array
        What the parameters lack, (error,), in the order of `RatioCurve.full_covariance`.
    covariance : Array
        Their covariance with the run, (error, error).
    scatter : Array
        The part of it that is new in every run.
    prior : Array
        Their covariance without it.
    noise : float
        Scatter of the logarithm of the ratio of a cell beyond photon noise. [1]
    film : float
        Median film of the cells. [um]
    pattern : CellPattern | None
        What stands still in the image; None where it was no unknown.
    """

    value: Array
    covariance: Array
    scatter: Array
    prior: Array
    noise: float
    film: float
    pattern: CellPattern | None = None

    @property
    def second_moment(self) -> Array:
        """Second moment of the errors if the estimate is not subtracted, (error, error)."""
        return np.asarray(self.covariance + np.outer(self.value, self.value))

    def exceeds_widths(self, calibration: RatioCurve) -> bool:
        """Whether the estimate shifts its film by over two standard deviations of all errors."""
        middle, film = calibration.at(0.5), np.array(self.film)
        before = self.film_std(film, middle, before=True)
        return bool(abs(self.film_shift(film, middle)) > _BEYOND * before)

    def film_shift(self, film: npt.ArrayLike, calibration: RatioCurve) -> Array:
        """Error of a measured film. [um]"""
        measured = np.asarray(film, float)
        goal, found = calibration.predict_log(measured), measured
        for _ in range(_NEWTON):
            added = np.tensordot(self.value, calibration.gradient(found), axes=1)
            found = found - (calibration.predict_log(found) + added - goal) / calibration.slope(
                found
            )
        return np.asarray(measured - found)

    def film_std(
        self, film: npt.ArrayLike, calibration: RatioCurve, *, before: bool = False
    ) -> Array:
        """Standard deviation of a measured film with the run, or before it. [um]"""
        by_error = calibration.film_gradient(film)
        covariance = calibration.systematics.anywhere(self.prior if before else self.covariance)
        variance = np.einsum("i...,ij,j...->...", by_error, covariance, by_error)
        return np.asarray(np.sqrt(variance))


def estimate_errors(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    view: PinView,
    *,
    passed: Array,
    clearance_std: float,
    flattening: float = 0.0,
    texture: Texture | None = None,
) -> ErrorEstimate | None:
    """Estimate the errors of a run from the gap that all its frames show.

    Parameters
    ----------
    record : LightCells
    centres : tuple of two arrays, (cell,)
        Columns and rows of the middles of the cells. [px]
    calibration : RatioCurve
        Of one fixture, with its systematics: their covariance is the prior.
    view : PinView
    passed : array, (frame,)
        Share of the run that has passed at each frame. [1]
    clearance_std : float
        How well the radii are stated; at least 1 % of the clearance is taken. [um]
    flattening : float
        Depth by which the load flattens the surfaces: the form of the gap, and its change from
        frame to frame, are known to so much. [um]
    texture : Texture, optional
        A factor of the ratio that is fixed in the image: an unknown of each cell.

    Returns
    -------
    ErrorEstimate or None
        None where the run has too few frames or cells, or an error far beyond its width.

    Examples
    --------
    A run of four frames is too short:

    >>> from erlif.show.plots import example_calibration
    >>> empty, none = LightCells(*np.full((4, 4, 120), np.nan)), np.zeros(120)
    >>> view = PinView(33.36e-3, 33.59e-3, 0.06, load_line=9.6, axial_origin=7.7)
    >>> found = estimate_errors(
    ...     empty, (none, none), example_calibration(), view,
    ...     passed=np.linspace(0, 1, 4), clearance_std=4.0,
    ... )
    >>> found is None
    True
    """
    steps = np.unique(np.linspace(0, len(passed) - 1, _MOST_FRAMES).round().astype(int))
    record = LightCells(*(np.asarray(part, float)[steps] for part in record))
    if texture is not None:
        # films that differ within a cell curve its mean; what differs by the pattern does not
        within = texture.found.size**2 - np.diag(texture.in_cells(centres))
        record = record._replace(spread=record.spread - within)
    known = np.isfinite(record.log_ratio) & np.isfinite(record.light) & (record.variance > 0)
    film = calibration.inverse.look_up(np.where(known, record.log_ratio, 0.0))
    size = 0.0 if texture is None else texture.found.size
    chosen = choose_cells(film, known, calibration, size)
    x, y = (view.pitch * centre for centre in centres)
    along, across = (x, y) if view.sliding_along_x else (y, x)
    gap = gap_of_pin(
        along - view.load_line,
        across - view.axial_origin,
        view.radius,
        clearance_std=float(np.hypot(clearance_std, CLEARANCE_STD * view.clearance)),
        flattening=flattening,
    )
    # chosen by their own films, cells at the end of the range are those whose noise is negative
    start = _fit_positions(film, chosen, gap[0], view.clearance)
    chosen = choose_cells(view.clearance + start @ gap[0], known, calibration, size)
    if chosen.any(axis=1).sum() < FEWEST_FRAMES:
        return None
    record = LightCells(*(np.where(chosen, part, 0.0) for part in record))
    return _ErrorFit(
        record, chosen, calibration, passed[steps], gap, view.clearance, centres, texture
    ).solve(film, start)


def _fit_positions(measured: Array, chosen: Mask, motion: Array, clearance: float) -> Array:
    """Position of the pin in each frame by the measured films, (frame, motion). [um]"""
    found = np.zeros((len(measured), len(motion)))
    for k, used in enumerate(chosen):
        rest = measured[k, used] - clearance
        found[k, :-1] = np.linalg.lstsq(motion[:-1, used].T, rest, rcond=None)[0]
    return found


@dataclass(frozen=True)
class _ErrorFit:
    """Gauss-Newton for errors, positions and form."""

    record: LightCells
    chosen: Mask
    calibration: RatioCurve
    passed: Array
    gap: tuple[Array, Array, Array]
    clearance: float
    place: tuple[Array, Array]
    texture: Texture | None

    def solve(self, measured: Array, start: Array) -> ErrorEstimate | None:
        """The estimate, from positions of the pin; None where it does not settle in the widths."""
        own, noise, cells = self.calibration.full_covariance, 0.0, measured.shape[1]
        still = None if self.texture is None else self.texture.in_cells(self.place)
        width = np.sqrt(np.diag(own if still is None else block_diag(own, still, still)))
        nothing = np.zeros(len(width)), np.zeros(cells)
        state, bright = RigidityUnknowns(*nothing, start), self._illumination(measured)
        for _ in range(_ROUNDS):
            film = self._film(state)
            if not (film > _THINNEST).all():
                return None
            equations = self._linearise(self._rigid_film(state), bright, noise)
            rest = self._rest(film, equations.by_errors(state.errors))
            step, covariance, scatter = solve_equations(equations, own, rest, state, pattern=still)
            state = RigidityUnknowns(*(old + new for old, new in zip(state, step, strict=True)))
            noise = max(noise + self._excess(equations, rest, step), 0.0)
            settled = np.abs(step.errors) <= _SETTLED * np.sqrt(np.diag(covariance)) + _NOTHING
            if settled[: len(own)].all():
                break
        else:
            return None
        if (np.abs(state.errors) > _LARGEST * width + _NOTHING).any():
            return None
        curve, pattern = slice(len(own)), slice(len(own), len(own) + cells)
        means = None
        if still is not None:
            means = CellPattern(self.place, state.errors[pattern], covariance[pattern, pattern])
        value, covariance = of_curve(
            state.errors[curve], covariance[curve, curve], self.calibration.systematics
        )
        return ErrorEstimate(
            value,
            covariance,
            scatter[curve, curve],
            own,
            float(np.sqrt(noise)),
            float(np.median(film[self.chosen])),
            means,
        )

    def _illumination(self, measured: Array) -> Array:
        """Illumination of each cell relative to the median, (cell,). [1]"""
        film = np.where(self.chosen, measured, 3.0)
        light = self.record.light - np.log(self.calibration.model.light(film).signal)
        bright = separate_light(np.where(self.chosen, light, 0.0), self.chosen)
        return np.asarray(np.exp(bright - np.median(bright[self.chosen.any(axis=0)])))

    def _film(self, state: RigidityUnknowns) -> Array:
        """Film of each cell; 3 um where it is not used. [um]"""
        film = self.clearance + state.motion @ self.gap[0] + state.form
        return np.where(self.chosen, film, 3.0)

    def _rigid_film(self, state: RigidityUnknowns) -> Array:
        """The same between circles, by the positions alone: the derivatives are those of it. [um]

        At the whole film they would grow with form and bend, which have a prior: the errors would
        be found where both are smallest, and films too thin. Noise of the flats, which the form
        holds, would be an error of the ratio.
        """
        film = self.clearance + state.motion[:, :-1] @ self.gap[0][:-1]
        return np.where(self.chosen, np.maximum(film, _THINNEST), 3.0)

    def _linearise(self, film: Array, bright: Array, noise: float) -> RatioEquations:
        """The equations at these films."""
        calibration, slope = self.calibration, self.calibration.slope(film)
        variance = np.where(self.chosen, self.record.variance + noise, np.inf)
        errors = calibration.gradient(
            film, illumination=bright, passed=self.passed[:, None], place=self.place
        )
        equations = RatioEquations(slope, errors, variance, *self.gap)
        if self.texture is None:
            return equations
        # the second part: whether it is that of a window or of a wall is known to its error
        return equations._replace(pattern=np.stack(self.texture.kind.acts(film, calibration)))

    def _rest(self, film: Array, by_errors: Array) -> Array:
        """Measured less expected logarithm of the ratio. [1]"""
        step, slope = 0.01, self.calibration.slope
        curvature = (slope(film + step) - slope(film - step)) / (2 * step)

        # mean of the logarithm over a cell whose films differ, to second order
        bent = 0.5 * curvature * np.maximum(self.record.spread, 0.0) / slope(film) ** 2
        expected = self.calibration.predict_log(film) + by_errors + bent
        return np.where(self.chosen, self.record.log_ratio - expected, 0.0)

    def _excess(self, equations: RatioEquations, rest: Array, step: RigidityUnknowns) -> float:
        """Variance of the logarithm of the ratio beyond the one taken. [1]"""
        moved = step.motion @ equations.motion + step.form
        left = rest - equations.slope * moved - equations.by_errors(step.errors)
        weight = np.where(self.chosen, 1 / equations.variance, 0.0)
        cells, frames = (int(self.chosen.any(axis=axis).sum()) for axis in (0, 1))
        freedom = self.chosen.sum() - cells - (len(equations.motion) - 1) * frames
        reduced = float((weight * left**2).sum()) / max(int(freedom), 1)
        return (reduced - 1) * float(self.chosen.sum() / weight.sum())
