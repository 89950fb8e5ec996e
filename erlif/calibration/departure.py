"""Departure of the ratio from the reabsorption model, a spline where the data require one.

The spline is cubic and smooth, added to the logarithm of the modelled ratio. It has more pieces
than a fixture resolves. The second differences of its coefficients are drawn from a normal
distribution, whose width has the highest restricted likelihood (Eilers and Marx 1996):
a ratio that bends slowly makes it stiff, one that bends quickly does not. The error bars are those
of the posterior (Wahba 1983), which contain what the stiffness hides.

The Bayesian information criterion (Schwarz 1978) decides whether it is used: a spline that takes k
degrees of freedom must lower chi-square by k ln(points) and by 10 more, "very strong" evidence
(Kass & Raftery 1995). Otherwise the model stands alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy
import xarray as xr

from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom
from erlif.calibration.regression import VERY_STRONG, Fit
from erlif.core.arrays import Array, Mask

# Probability of chance below which structure in the residuals is reported.
STRUCTURE = 1e-3

# Variables of the file of a calibration, and what of the spline they hold.
_STORED = {
    "departure_knots": "knots",
    "departure_coefficient": "coefficients",
    "departure_covariance": "covariance",
}

_FEWEST_POINTS = 40  # of a spline
_MOST_KNOTS = 47  # inner knots, that is 48 pieces; the prior holds those that noise would bend
_POINTS_PER_KNOT = 4
_TEST_KNOTS = 2  # inner knots of the spline without a prior that tests for structure
_PASSES = 8  # Gauss-Newton steps; the change is below rounding after six
_STIFFNESS = np.geomspace(1.0, 1e6, 49)  # inverse standard deviations of a second difference [1]
_GRID = 1001  # places at which the slope of the curve is checked
_NEIGHBOURS = 20  # points from which on their correlation is estimated


@dataclass(frozen=True)
class Departure:
    """Cubic spline added to the logarithm of the modelled ratio; constant beyond its ends.

    Attributes
    ----------
    knots : Array
        Knots, the end ones fourfold, (function + 4,). [um]
    coefficients : Array
        Coefficients of the B-splines, (function,). [1]
    covariance : Array
        Covariance of the coefficients, (function, function); independent of K, p and q. [1]
    """

    knots: Array
    coefficients: Array
    covariance: Array

    def basis(self, thickness: npt.ArrayLike, *, derivative: bool = False) -> Array:
        """B-splines, or their slopes [1/um], at each thickness [um], (function, ...)."""
        t = np.asarray(thickness, float)
        low, high = self.knots[0], self.knots[-1]
        inside = np.clip(t, low, high)
        if not derivative:
            return np.moveaxis(np.asarray(self._functions(inside)), -1, 0)
        slopes = np.moveaxis(np.asarray(self._slopes(inside)), -1, 0)
        return np.where((t < low) | (t > high), 0.0, slopes)

    @cached_property
    def _functions(self) -> scipy.interpolate.BSpline:
        return scipy.interpolate.BSpline(self.knots, np.eye(self.coefficients.size), 3)

    @cached_property
    def _slopes(self) -> scipy.interpolate.BSpline:
        return self._functions.derivative()

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Departure of the logarithm of the ratio at each thickness [um]."""
        return np.tensordot(self.coefficients, self.basis(thickness), 1)

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Slope of the departure over thickness. [1/um]"""
        return np.tensordot(self.coefficients, self.basis(thickness, derivative=True), 1)

    def variables(self) -> dict[str, Array]:
        """Values of the spline by the names of the file of a calibration."""
        return {name: getattr(self, field) for name, field in _STORED.items()}

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> Departure | None:
        """The spline of a calibration's dataset; None where the model stands alone."""
        if "departure_knots" not in dataset:
            return None
        return cls(*(np.asarray(dataset[name].values, float) for name in _STORED))


@dataclass(frozen=True)
class SplineCandidate:
    """A spline fitted to the residuals of the model.

    Attributes
    ----------
    departure : Departure
        The spline.
    displacement : Array
        Change of the pose fitted together with it, (combination,). [mm]
    chi_square : float
        Chi-square of model and spline.
    freedom : float
        Degrees of freedom that the spline takes.
    true_thickness : Array
        Film thickness from CMM and ratio together, (point,). [um]
    """

    departure: Departure
    displacement: Array
    chi_square: float
    freedom: float
    true_thickness: Array

    @property
    def pieces(self) -> int:
        """Number of its pieces."""
        return self.departure.coefficients.size - 3

    def noise(self, points: int, parameters: int) -> float:
        """Variance of the noise in units of the stated one."""
        return self.chi_square / max(points - parameters - self.freedom, 1.0)


@dataclass(frozen=True)
class Choice:
    """Result of the comparison of model and splines.

    Attributes
    ----------
    candidate : SplineCandidate | None
        The spline to use; None where the model stands alone.
    evidence : float
        Difference of the Bayesian criterion in favour of the spline.
    chance : float
        Probability that chance alone makes the residuals of the model as smooth.
    tested : SplineCandidate
        The spline from which `chance` was computed.
    falling : bool
        Whether the ratio falls somewhere with the spline to use; the range ends there.
    """

    candidate: SplineCandidate | None
    evidence: float
    chance: float
    tested: SplineCandidate
    falling: bool


def choose_departure(points: Points, fit: Fit, freedom: Freedom) -> Choice | None:
    """Compare a spline with the reabsorption model alone.

    Parameters
    ----------
    points : Points
        CMM points and the ratio there.
    fit : Fit
        The reabsorption model fitted to them.
    freedom : Freedom
        Changes of the pose that are free in both fits.

    Returns
    -------
    Choice or None
        None with fewer than 40 points.
    """
    count, parameters = int(fit.kept.sum()), len(fit.covariance)
    if count < _FEWEST_POINTS:
        return None
    smooth = fit_departure(points, fit, freedom)
    tested = fit_departure(points, fit, freedom, test_knots=_TEST_KNOTS)

    # scatter about the spline is noise; a noise below the stated one is chance
    noise = max(1.0, smooth.noise(count, parameters))
    gain, of_test = ((fit.chi_square - one.chi_square) / noise for one in (smooth, tested))
    evidence = gain - smooth.freedom * math.log(count)
    used = evidence >= VERY_STRONG
    return Choice(
        candidate=smooth if used else None,
        evidence=evidence,
        chance=float(scipy.special.chdtrc(tested.freedom, of_test)),
        tested=tested,
        falling=used and _falls(fit, smooth),
    )


def _falls(fit: Fit, candidate: SplineCandidate) -> bool:
    """Whether model and spline fall somewhere."""
    true = candidate.true_thickness[fit.kept]
    grid = np.linspace(float(true.min()), float(true.max()), _GRID)
    ratio = fit.predict(grid) + candidate.departure.predict(grid)
    return bool((np.diff(ratio) <= 0).any())


def longest_rise(rises: Mask) -> tuple[int, int]:
    """First place and end of the longest stretch over which a curve rises.

    Parameters
    ----------
    rises : array of bool, (place,)

    Returns
    -------
    tuple of int
        As of a slice; the whole where it rises nowhere.

    Examples
    --------
    >>> longest_rise(np.array([True, False, True, True]))
    (2, 4)
    """
    edges = np.flatnonzero(np.diff(rises.astype(int), prepend=0, append=0))
    if not edges.size:
        return 0, rises.size
    starts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    return int(starts[longest]), int(ends[longest])


def fit_departure(
    points: Points, fit: Fit, freedom: Freedom, *, test_knots: int | None = None
) -> SplineCandidate:
    """Fit a spline to the residuals of the model, with errors in both variables.

    The knots are even in the modelled logarithm of the ratio, closer where it bends. K, p and q
    stay: the spline contains their effect almost completely, so model and spline together are the
    least-squares curve. The pose is free as in the fit of the model.

    Parameters
    ----------
    points, fit, freedom
        As for `choose_departure`.
    test_knots : int, optional
        Places where pieces meet of a spline without a prior. Default: a smooth spline.

    Returns
    -------
    SplineCandidate
    """
    kept = fit.kept
    inner = test_knots or min(_MOST_KNOTS, int(kept.sum()) // _POINTS_PER_KNOT)
    functions = inner + 4
    displaced = freedom.displacement[kept]
    y, y_std, t_std = points.log_ratio[kept], points.log_ratio_std[kept], fit.thickness_std[kept]
    true = fit.true_thickness[kept]
    spline = Departure(_place_knots(fit, true, inner), np.zeros(functions), np.empty(0))
    unknowns = np.concatenate([spline.coefficients, fit.displacement])
    model = np.concatenate([fit.gradient(true), (fit.slope(true)[:, None] * displaced).T])
    bends = np.diff(np.eye(functions, unknowns.size), n=2, axis=0)
    prior = np.zeros((0, unknowns.size))

    for _ in range(_PASSES):
        # effective variance: the CMM's error enters the ratio through the slope of the curve
        basis = spline.basis(true).T
        coefficients, displacement = np.split(unknowns, [functions])
        slope = fit.slope(true) + spline.basis(true, derivative=True).T @ coefficients
        film = points.thickness[kept] + displaced @ displacement
        std = np.hypot(y_std, slope * t_std)
        rest = y - fit.predict(true) - basis @ coefficients - slope * (film - true)
        design = np.column_stack([basis, slope[:, None] * displaced]) / std[:, None]
        value = rest / std + design @ unknowns
        if test_knots is None:
            prior = _stiffness(design, value, bends) * bends
        aim = np.concatenate([value, np.zeros(len(prior))])
        unknowns = np.linalg.lstsq(np.concatenate([design, prior]), aim, rcond=None)[0]

        # the point on the curve nearest to each measured one
        scaled = value - design @ unknowns
        coefficients, displacement = np.split(unknowns, [functions])
        film = points.thickness[kept] + displaced @ displacement
        true = film + slope * t_std**2 / std * scaled
    chi_square = float((scaled**2).sum())

    # noise that the model has already absorbed is not counted again
    taken = np.linalg.qr(model.T / std[:, None])[0]
    solve, stiff = np.split(np.linalg.pinv(np.concatenate([design, prior])), [len(design)], axis=1)
    used = float(np.einsum("ij,ji->", design, solve))
    used -= float(np.einsum("ni,nj,jm,mi->", taken, design, solve, taken, optimize=True))
    solve = solve - solve @ taken @ taken.T
    covariance = (solve @ solve.T + stiff @ stiff.T)[:functions, :functions]

    true_thickness = points.thickness + freedom.displacement @ displacement
    true_thickness[kept] = true
    departure = Departure(spline.knots, coefficients, covariance)
    return SplineCandidate(departure, displacement, chi_square, used, true_thickness)


def _stiffness(design: Array, value: Array, bends: Array) -> float:
    """Inverse standard deviation of the second differences: highest restricted likelihood. [1]

    The noise counts as it scatters, and not below the stated one.
    """
    penalty = bends.T @ bends
    known = design.T @ design + penalty
    share, basis = scipy.linalg.eigh(penalty, known)  # of the penalty in both together
    aim = basis.T @ (design.T @ value)
    weight = 1 - share + _STIFFNESS[:, None] ** 2 * share
    cost = value @ value - (aim**2 / weight).sum(axis=1)

    free = len(value) - design.shape[1] + len(bends)
    scale = np.maximum(cost / free, 1.0)
    likelihood = len(bends) * np.log(_STIFFNESS) - 0.5 * (
        np.log(weight).sum(axis=1) + cost / scale + free * np.log(scale)
    )
    return float(_STIFFNESS[np.argmax(likelihood)])


def _place_knots(fit: Fit, thickness: Array, inner_knots: int) -> Array:
    """Knots that are even in the modelled logarithm of the ratio. [um]"""
    low, high = float(thickness.min()), float(thickness.max())
    grid = np.linspace(low, high, 501)
    modelled = fit.predict(grid)
    inside = np.interp(
        np.linspace(modelled[0], modelled[-1], inner_knots + 2)[1:-1], modelled, grid
    )
    return np.concatenate([[low] * 4, inside, [high] * 4])


class Correlation(NamedTuple):
    """Correlation of neighbouring residuals along a line.

    Attributes
    ----------
    coefficient : float
        Correlation coefficient of neighbours. [1]
    significance : float
        The coefficient in standard deviations of independent residuals. [1]
    """

    coefficient: float
    significance: float

    @property
    def inflation(self) -> float:
        """Variance of a mean of correlated residuals over that of independent ones.

        That of a first-order autoregression, (1 + r) / (1 - r), with 1 - r held above 0.1.
        """
        return (1 + self.coefficient) / max(1 - self.coefficient, 0.1)


def find_correlation(position: Array, residual: Array) -> Correlation:
    """Correlation of neighbouring residuals along a line.

    Parameters
    ----------
    position : array, (point, axis)
        Position on the profile. [mm]
    residual : array, (point,)
        Residuals in units of their standard deviation.

    Returns
    -------
    Correlation
        0 for a surface and for fewer than 20 points.

    Examples
    --------
    Residuals that alternate in sign are anticorrelated; 99 pairs of 100 points give -0.99:

    >>> alternating = np.tile([1.0, -1.0], 50)
    >>> find_correlation(np.arange(100.0)[:, None], alternating).coefficient
    -0.99
    """
    if position.shape[1] == 2 or residual.size < _NEIGHBOURS:
        return Correlation(0.0, 0.0)
    ordered = residual[np.argsort(position[:, 0])]
    ordered = ordered - ordered.mean()
    if not ordered.any():
        return Correlation(0.0, 0.0)
    coefficient = float((ordered[1:] * ordered[:-1]).sum() / (ordered**2).sum())
    return Correlation(coefficient, coefficient * math.sqrt(residual.size))
