"""Light that is not film, found from the light and the films of a run.

The light of a cell of the image is pulse energy x illumination x light of its film by the
fluorescence model, plus a background that is even over the image:
``L = E (g F(h) + B)``. A background changes the ratio and with it the measured film h, so that
light and film of a cell no longer change together from trigger to trigger. The illumination g of
each cell and the energy E of each pulse are unknown and fitted. An energy that the log has enters
with the accuracy that it shows. The errors of the calibration act in a similar way; they are fitted
together with the two backgrounds, within their covariance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import scipy

from erlif.calibration import RatioCurve, Systematics
from erlif.core.arrays import Array, Mask
from erlif.core.statistics import covariance_root, quadratic_surface
from erlif.core.terms import TERMS
from erlif.ratio.cells import LightCells
from erlif.trend.cells import FEWEST_FRAMES, choose_cells, separate_light

# Chi-square of two shares that noise exceeds once in 370 cases, as a deviation of three standard
# deviations of one number.
SIGNIFICANT = 11.83

# Share of the median light; a run that would not show this much determines no background. [1]
_LARGEST = 0.05

_ROUNDS = 12  # steps of Gauss and Newton, at most; three are usual

_LOST = 0.5  # share beyond which the search has left the range of its equations [1]

_LOST_FILM = 0.05  # film to which a search comes down that has left it likewise [um]

_SETTLED = 0.05  # last step over the standard deviation at which the search ends

# Relative scatter of the light of a cell to start from: speckle that is new with every pulse.
_START_NOISE = 0.02

_LEAST_ENERGY_STD = 1e-3  # relative accuracy that is granted to the energies of a log at best


@dataclass(frozen=True)
class BackgroundEstimate:
    """Background of both cameras.

    Attributes
    ----------
    share : Array
        Background over the median light of each camera, (camera,). [1]
    covariance : Array
        Covariance of the shares, calibration and noise together, (2, 2).
    cross : Array
        Covariance of the errors of the calibration and of the shares, (n, 2).
    chi_square : float
        Significance of both shares together.
    unit : tuple[float, float]
        Median light of each camera, divided by its flat. [DN]
    brightness : float
        Light of camera 1 per um of a very thin film at median illumination. [DN/um]
    film : float
        Median film of the cells. [um]
    energy_std : float
        Scatter of the logged energies about those of the light; NaN without a log. [1]
    """

    share: Array
    covariance: Array
    cross: Array
    chi_square: float
    unit: tuple[float, float]
    brightness: float
    film: float
    energy_std: float

    @property
    def std(self) -> Array:
        """Standard deviations of the shares, (camera,). [1]"""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def detectable(self) -> float:
        """Share that would be significant, if it were the same in both cameras. [1]"""
        return math.sqrt(SIGNIFICANT / float(np.linalg.inv(self.covariance).sum()))

    @property
    def determined(self) -> bool:
        """Whether the run determines a background at all."""
        return self.detectable < _LARGEST

    @property
    def significant(self) -> bool:
        """Whether the run has a background, beyond its uncertainty."""
        return self.determined and self.chi_square > SIGNIFICANT

    @property
    def error(self) -> Systematics:
        """Error of the background if the estimate is subtracted."""
        one, two = (unit / self.brightness for unit in self.unit)
        parameters = TERMS["background"].parameters
        return Systematics(("background",) * 2, parameters, self.covariance, self.cross, (one, two))

    @property
    def second_moment(self) -> Systematics:
        """Second moment of the background if the estimate is not subtracted."""
        whole = self.covariance + np.outer(self.share, self.share)
        return replace(self.error, covariance=whole)

    def given(self, prior: Array) -> BackgroundEstimate:
        """The estimate with a prior about zero.

        Parameters
        ----------
        prior : array, (2, 2)
            Covariance of the shares. [1]

        Returns
        -------
        BackgroundEstimate
        """
        gain = prior @ np.linalg.inv(prior + self.covariance)
        return replace(
            self,
            share=gain @ self.share,
            covariance=prior - gain @ prior,
            cross=self.cross @ gain.T,
        )

    def film_shift(self, thickness: Array, calibration: RatioCurve) -> Array:
        """Error of the measured film by this background, at median illumination. [um]"""
        return np.asarray(np.tensordot(self.share, self._gradient(thickness, calibration), axes=1))

    def film_shift_std(self, thickness: Array, calibration: RatioCurve) -> Array:
        """Standard deviation of the shift of the film. [um]"""
        by_share = self._gradient(thickness, calibration)
        variance = np.einsum("i...,ij,j...->...", by_share, self.covariance, by_share)
        return np.asarray(np.sqrt(variance))

    def _gradient(self, thickness: Array, calibration: RatioCurve) -> Array:
        """Change of the film with both shares, (camera, ...). [um]"""
        slope = calibration.slope(thickness)
        acts = self.error.gradient(thickness, calibration.model, slope, np.zeros_like(slope))
        return np.asarray(acts / slope)


def estimate_background(
    record: LightCells,
    places: tuple[Array, Array],
    calibration: RatioCurve,
    *,
    energies: Array | None = None,
    passed: Array | None = None,
) -> BackgroundEstimate | None:
    """Estimate the background of both cameras from light and films of a run.

    Parameters
    ----------
    record : LightCells
        Frames in any order.
    places : tuple of two arrays, (cell,)
        Positions (x, y) of the cells, from -1 to 1.
    calibration : RatioCurve
    energies : array, (frame,), optional
        Relative pulse energies of the log. A frame with 0, a pulse that the meter missed, is left
        out; where these are most frames, the energies are not used. [1]
    passed : array, (frame,), optional
        Share of the run that has passed; default: all frames belong to its end. [1]

    Returns
    -------
    BackgroundEstimate or None
        None where the run has too few frames or cells.

    Examples
    --------
    A run of four frames is too short:

    >>> from erlif.show.plots import example_calibration
    >>> empty = LightCells(*np.full((4, 4, 120), np.nan))
    >>> estimate_background(empty, (np.zeros(120), np.zeros(120)), example_calibration()) is None
    True
    """
    known = np.isfinite(record.log_ratio) & np.isfinite(record.light) & (record.variance > 0)
    if energies is not None:
        measured = energies > 0
        if 2 * np.count_nonzero(measured) > measured.size:
            known &= measured[:, None]
        else:
            energies = None
    if known.any(axis=1).sum() < FEWEST_FRAMES:
        return None
    used = known.any(axis=1)
    fit = _BackgroundFit(
        LightCells(*(np.asarray(part, float)[used] for part in record)),
        known[used],
        places,
        calibration,
        None if energies is None else np.asarray(energies, float)[used],
        np.ones((used.sum(), 1)) if passed is None else np.asarray(passed, float)[used, None],
    )
    return fit.solve()


class _Linearisation(NamedTuple):
    """The equations at given shares, each (frame, cell).

    Logarithm of light over that of the film, films without noise [um], and cells that are used.
    """

    value: Array
    smooth: Array
    chosen: Mask


class _LinearSolution(NamedTuple):
    """One linear solution; the correction is to be added to the noise. [1]"""

    share: Array
    covariance: Array
    energies: Array
    illumination: Array
    correction: float
    energy_std: float


class _BackgroundFit:
    """Gauss-Newton for shares, calibration, energies and illumination."""

    def __init__(
        self,
        record: LightCells,
        known: Mask,
        places: tuple[Array, Array],
        calibration: RatioCurve,
        energies: Array | None,
        passed: Array,
    ) -> None:
        self.record, self.known, self.calibration = record, known, calibration
        self.energies, self.passed = energies, passed
        x, y = places
        self.surface = quadratic_surface(*places)
        rows, columns = calibration.systematics.frame
        self.place = 0.5 * (x + 1) * (columns - 1), 0.5 * (y + 1) * (rows - 1)
        light = np.where(known, record.light, 0.0)
        self.unit = (
            float(np.median(np.exp(light[known]))),
            float(np.median(np.exp((light + record.log_ratio)[known]))),
        )
        self.table = calibration.inverse
        # independent causes of shares and errors: a spline has fewer of them than parameters
        errors = covariance_root(calibration.full_covariance)
        self.causes = scipy.linalg.block_diag(np.eye(2), errors)

    def solve(self) -> BackgroundEstimate | None:
        """The estimate; None where too few cells lie within the range of the model."""
        share, noise = np.zeros(2), _START_NOISE**2
        energies = np.ones(len(self.known)) if self.energies is None else self.energies
        energy_std = math.inf if self.energies is None else 0.01  # to start from
        point = self._evaluate(share, energies, None)
        if point is None:
            return None
        null, chosen = point, point.chosen
        illumination = separate_light(point.value, chosen)

        for _ in range(_ROUNDS):
            shift = float(np.log(energies).mean())
            step = self._solve_linear(point, illumination - shift, noise, energy_std)
            share = share + step.share
            if np.abs(share).max() > _LOST:
                return None
            settled = np.abs(step.share) < _SETTLED * np.sqrt(np.diag(step.covariance)[:2])
            noise = max(noise + step.correction, 1e-8)
            illumination, energy_std = step.illumination, step.energy_std
            if self.energies is None:
                energies = np.exp(step.energies - step.energies.mean())
            following = self._evaluate(share, energies, chosen)
            if following is None:
                return None
            point = following
            if settled.all():
                break
        else:
            return None

        # whether there is a background is asked without one, where the equations are known best
        first = self._solve_linear(null, illumination - shift, noise, energy_std)
        return BackgroundEstimate(
            share=share,
            covariance=step.covariance[:2, :2],
            cross=-step.covariance[2:, :2],
            chi_square=float(first.share @ np.linalg.solve(first.covariance[:2, :2], first.share)),
            unit=self.unit,
            brightness=float(np.exp(np.median(illumination[chosen.any(axis=0)]) - shift)),
            film=float(np.median(point.smooth[chosen])),
            energy_std=math.nan if self.energies is None else energy_std,
        )

    def _evaluate(
        self, share: Array, energies: Array, chosen: Mask | None
    ) -> _Linearisation | None:
        """Light over the light of the film, where these shares are subtracted."""
        light, log_ratio = self._subtract(share, energies)
        film, smooth, inside = self._measure_films(log_ratio)
        if chosen is None:
            # cells and frames stay the same while the estimate is improved
            chosen = choose_cells(smooth, inside, self.calibration)
            if chosen.any(axis=1).sum() < FEWEST_FRAMES:
                return None
        if not (smooth[chosen] > _LOST_FILM).all():
            return None
        return _Linearisation(self._compare(light, film, smooth, chosen), smooth, chosen)

    def _subtract(self, share: Array, energies: Array) -> tuple[Array, Array]:
        """Logarithms of light and ratio without the background."""
        one = np.exp(np.where(self.known, self.record.light, 0.0))
        two = one * np.exp(np.where(self.known, self.record.log_ratio, 0.0))
        least = 0.05  # of the light; a trial of the search may subtract too much
        one, two = (
            np.maximum(each - energies[:, None] * part * unit, least * each)
            for each, part, unit in zip((one, two), share, self.unit, strict=True)
        )
        return np.log(one), np.log(two / one)

    def _measure_films(self, log_ratio: Array) -> tuple[Array, Array, Mask]:
        """Films as measured and without noise, and the cells within the calibration.

        The noise of a cell acts on its film and on its light at once. Where the equations are
        evaluated, the film is therefore that of a smooth surface in each frame plus a form of the
        joint that is the same in all.
        """
        first, last = self.table.log_ratio[[0, -1]]
        inside = self.known & (log_ratio > first) & (log_ratio < last)
        film = self.table.look_up(log_ratio)
        slope = self.calibration.slope(film)
        weight = np.where(inside, slope**2 / np.where(self.known, self.record.variance, 1.0), 0.0)
        form = np.zeros(film.shape[1])
        surface = np.zeros_like(film)
        for _ in range(4):  # rounds of surface and form; the form settles in two
            for k, row in enumerate(weight):
                root = np.sqrt(row)
                design = self.surface * root[:, None]
                solved = np.linalg.lstsq(design, (film[k] - form) * root, rcond=None)[0]
                surface[k] = self.surface @ solved
            total = weight.sum(axis=0)
            form = (weight * (film - surface)).sum(axis=0) / np.where(total > 0, total, 1.0)
        return film, surface + form, inside

    def _compare(self, light: Array, film: Array, smooth: Array, chosen: Mask) -> Array:
        """Logarithm of measured over expected light of the film; 0 in cells that are not chosen."""
        film, smooth = np.where(chosen, film, 3.0), np.where(chosen, smooth, 3.0)
        expected = np.log(self.calibration.model.light(film).signal)

        # mean of the logarithm over a cell whose films differ, to second order
        step = 0.01
        bend = (self._response(smooth + step) - self._response(smooth - step)) / (2 * step)
        spread = np.where(chosen, self.record.spread, 0.0)
        bent = 0.5 * bend / self.calibration.slope(smooth) * np.maximum(spread, 0.0)
        return np.where(chosen, light - expected - bent, 0.0)

    def _response(self, film: Array) -> Array:
        """Change of the logarithm of the light with that of the ratio. [1]"""
        return np.asarray(self.calibration.model.light(film).slope / self.calibration.slope(film))

    def _design(self, smooth: Array, illumination: Array) -> tuple[Array, Array]:
        """Derivatives by both shares and by the calibration, and the response."""
        calibration = self.calibration
        light = calibration.model.light(smooth)
        one = np.exp(illumination) * light.signal
        two = one * calibration.predict(smooth)
        response = self._response(smooth)

        # a larger film by the error of the ratio lowers light over expected light by the response
        shares = [self.unit[0] / one * (1 + response), -self.unit[1] / two * response]
        errors = response * self.calibration.fitted_gradient(smooth)
        errors[1] -= light.gradient[0]
        if calibration.model.reflects:
            errors[3:5] -= light.gradient[1:]
        return np.stack([*shares, *errors, *self._act(smooth, illumination, response)]), response

    def _act(self, smooth: Array, illumination: Array, response: Array) -> Array:
        """Derivatives of the light of each cell with respect to the systematic errors."""
        calibration, systematics = self.calibration, self.calibration.systematics
        if not systematics:
            return np.empty((0, *smooth.shape))
        bright = np.exp(illumination) * systematics.light[0] / self.unit[0]
        films = smooth, calibration.model, calibration.slope(smooth), calibration.change(smooth)
        at: dict[str, Any] = {"illumination": bright, "passed": self.passed, "place": self.place}
        of_ratio = systematics.gradient(*films, **at)
        of_light = systematics.gradient(*films, of="light", **at)
        return np.asarray(response * of_ratio - of_light)

    def _solve_linear(
        self,
        point: _Linearisation,
        illumination: Array,
        noise: float,
        energy_std: float,
    ) -> _LinearSolution:
        value, smooth, chosen = point
        design, response = self._design(np.where(chosen, smooth, 3.0), illumination)
        variance = noise + response**2 * np.where(chosen, self.record.variance, 0.0)
        weight = np.where(chosen, 1 / variance, 0.0)
        unknowns, frames = len(design), len(weight)

        # the illumination of each cell is eliminated, then the energy of each frame
        columns = np.concatenate([design, value[None]])
        of_cell = weight.sum(axis=0)
        safe = np.where(of_cell > 0, of_cell, 1.0)
        means = (weight * columns).sum(axis=1) / safe
        centred = columns - means[:, None]
        by_frame = np.diag(weight.sum(axis=1)) - (weight / safe) @ weight.T
        mixed = (weight * centred).sum(axis=2)
        square = np.einsum("ifc,fc,jfc->ij", centred, weight, centred, optimize=True)
        logged = np.zeros(frames)
        if math.isfinite(energy_std) and self.energies is not None:
            logged = np.log(self.energies)
            known = (np.eye(frames) - 1 / frames) / energy_std**2
            by_frame = by_frame + known
            mixed[-1] += known @ logged
            square[-1, -1] += logged @ known @ logged

        # energies have no common scale apart from the illumination: a weak tie sets it
        tie = 1e-9 * np.trace(by_frame) / frames * np.eye(frames)
        solved = np.linalg.solve(by_frame + tie, mixed.T)
        normal = square - mixed @ solved
        prior = np.diag([0.0, 0.0, *np.ones(unknowns - 2)])
        by_cause = self.causes.T @ normal[:-1, :-1] @ self.causes + prior
        covariance = self.causes @ np.linalg.inv(by_cause) @ self.causes.T
        solution = covariance @ normal[:-1, -1]

        energies = solved[:, -1] - solved[:, :-1] @ solution
        constant = (
            means[-1] - solution @ means[:-1] - (weight * energies[:, None]).sum(axis=0) / safe
        )
        rest = value - np.einsum("i,ifc->fc", solution, design) - constant
        left = np.where(chosen, rest - energies[:, None], 0.0)
        freedom = int(chosen.sum()) - int(chosen.any(axis=0).sum()) - frames
        reduced = float((weight * left**2).sum()) / max(freedom, 1)
        return _LinearSolution(
            solution[:2],
            covariance,
            energies,
            constant,
            (reduced - 1) * float(chosen.sum() / weight.sum()),
            self._energy_std(rest, weight, logged, unknowns),
        )

    def _energy_std(self, rest: Array, weight: Array, logged: Array, unknowns: int) -> float:
        """Standard deviation of the logged pulse energies about those from the light."""
        if self.energies is None:
            return math.inf
        of_frame = weight.sum(axis=1)
        some = of_frame > 0
        shown = (weight * rest).sum(axis=1)[some] / of_frame[some] - logged[some]
        scatter = float(((shown - shown.mean()) ** 2).sum()) / max(int(some.sum()) - unknowns, 1)
        noise = float((1 / of_frame[some]).mean())
        return max(math.sqrt(max(scatter - noise, 0.0)), _LEAST_ENERGY_STD)
