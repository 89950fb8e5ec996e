"""What the ratio departs from the reabsorption model, followed by a spline where the data insist on it.

The candidates are cubic splines of few pieces, added to the logarithm of the modelled ratio. The Bayesian information criterion
(Schwarz, Ann. Statist. 6 (1978) 461) decides whether one is used: a spline of k degrees of freedom must lower chi-square by
k ln(points) and by 10 more, "very strong" evidence in the words of Kass & Raftery, J. Am. Stat. Assoc. 90 (1995) 773. Without it the
model stands alone. The number of pieces is then six, not the number that fits best: a choice made by the data leaves out what the noise
hides, and the error bars would not know of it. There are fewer pieces where six would let the ratio fall with thickness.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.interpolate import BSpline
from scipy.stats import chi2

from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom
from erlif.calibration.regression import Fit
from erlif.core.arrays import Array

VERY_STRONG = 10.0
"""Difference of the criterion from which on the spline is used."""
STRUCTURE = 1e-3
"""Probability of chance below which structure in the residuals is said."""

_MOST_KNOTS = 5


@dataclass(frozen=True)
class Departure:
    """Cubic spline added to the logarithm of the modelled ratio; constant beyond its ends.

    Attributes
    ----------
    knots : array, (function + 4,)
        [um]
    coefficients : array, (function,)
        Of the B-splines.
    covariance : array, (function, function)
        Of the coefficients; they err independently of K, p and q.
    """

    knots: Array
    coefficients: Array
    covariance: Array

    def basis(self, thickness: npt.ArrayLike, *, derivative: bool = False) -> Array:
        """B-splines, or their slopes [1/um], at each thickness, (function, ...)."""
        t = np.asarray(thickness, float)
        low, high = self.knots[0], self.knots[-1]
        inside = np.clip(t, low, high)
        functions = BSpline(self.knots, np.eye(self.coefficients.size), 3)
        if not derivative:
            return np.moveaxis(np.asarray(functions(inside)), -1, 0)
        slopes = np.moveaxis(np.asarray(functions.derivative()(inside)), -1, 0)
        return np.where((t < low) | (t > high), 0.0, slopes)

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Departure of the logarithm of the ratio."""
        return np.tensordot(self.coefficients, self.basis(thickness), 1)

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Of the departure. [1/um]"""
        return np.tensordot(self.coefficients, self.basis(thickness, derivative=True), 1)

    def describe(self, dataset: xr.Dataset) -> None:
        """Add the spline to the dataset of a calibration."""
        dataset["departure_knots"] = (
            "departure_knot",
            self.knots,
            {
                "units": "um",
                "long_name": "knots of the cubic spline added to the logarithm of the modelled ratio",
            },
        )
        dataset["departure_coefficient"] = (
            "departure_function",
            self.coefficients,
            {"units": "1", "long_name": "coefficients of its B-splines"},
        )
        dataset["departure_covariance"] = (
            ("departure_function", "departure_function2"),
            self.covariance,
            {
                "units": "1",
                "long_name": "covariance of the coefficients, which err independently of K, p and q",
            },
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> Departure | None:
        """Undo `describe`; None where the model stands alone."""
        if "departure_knots" not in dataset:
            return None
        names = ("departure_knots", "departure_coefficient", "departure_covariance")
        return cls(*(np.asarray(dataset[name].values, float) for name in names))


@dataclass(frozen=True)
class Candidate:
    """A spline fitted to what the model leaves.

    Attributes
    ----------
    departure : Departure
    displacement : array, (combination,)
        Pose that goes with it. [mm]
    chi_square, freedom : float
        What is left, and the degrees of freedom that the spline took.
    true_thickness : array, (point,)
        Film that CMM and ratio agree on. [um]
    """

    departure: Departure
    displacement: Array
    chi_square: float
    freedom: float
    true_thickness: Array

    @property
    def inner_knots(self) -> int:
        """Places where its pieces meet."""
        return self.departure.coefficients.size - 4

    def noise(self, points: int, parameters: int) -> float:
        """Variance of the noise in units of the stated one."""
        return self.chi_square / max(points - parameters - self.freedom, 1.0)


@dataclass(frozen=True)
class Choice:
    """What came of the comparison.

    Attributes
    ----------
    candidate : Candidate or None
        The spline to use.
    evidence : float
        By which the Bayesian criterion prefers the best spline to the model alone.
    chance : float
        Probability that the residuals of the model look so smooth by chance.
    smooth : Candidate
        The spline that this was told by.
    falling : bool
        Whether the most supple spline was passed over because the ratio would fall with thickness.
    """

    candidate: Candidate | None
    evidence: float
    chance: float
    smooth: Candidate
    falling: bool


def choose_departure(points: Points, fit: Fit, freedom: Freedom) -> Choice | None:
    """Set splines of 0 to 5 inner knots against the reabsorption model alone; None where there are too few points."""
    count, parameters = int(fit.kept.sum()), len(fit.covariance)
    most = min(_MOST_KNOTS, count // 10 - 4)
    if most < 0:
        return None
    candidates = [fit_departure(points, fit, freedom, knots) for knots in range(most + 1)]
    # scatter that even the most supple spline leaves is noise; less than stated is not believed
    noise = max(1.0, candidates[-1].noise(count, parameters))
    gain = np.array([(fit.chi_square - candidate.chi_square) / noise for candidate in candidates])
    freed = np.array([candidate.freedom for candidate in candidates])
    evidence = gain - freed * math.log(count)
    smooth = candidates[most // 2]
    chance = float(chi2.sf(gain[most // 2], smooth.freedom))
    chosen, falling = None, False
    if evidence.max() >= VERY_STRONG:
        chosen = next((candidate for candidate in candidates[::-1] if _rises(fit, candidate)), None)
        falling = chosen is not candidates[-1]
    return Choice(chosen, float(evidence.max()), chance, smooth, falling)


def _rises(fit: Fit, candidate: Candidate) -> bool:
    """Whether model and spline together rise with thickness over all that the fixture covers."""
    true = candidate.true_thickness[fit.kept]
    grid = np.linspace(float(true.min()), float(true.max()), 1001)
    return bool(np.all(fit.slope(grid) + candidate.departure.slope(grid) > 0))


def fit_departure(points: Points, fit: Fit, freedom: Freedom, inner_knots: int) -> Candidate:
    """Fit a spline to what the model leaves, with errors in both variables, the pose free as in the fit of the model.

    The knots are even in the modelled logarithm of the ratio, closer where it bends. K, p and q stay: their effect is as good as
    contained in the spline's, so model and spline together are the least-squares curve.
    """
    kept = fit.kept
    displaced = freedom.displacement[kept]
    y, y_std, t_std = points.log_ratio[kept], points.log_ratio_std[kept], fit.thickness_std[kept]
    true = fit.true_thickness[kept]
    departure = Departure(
        _place_knots(fit, true, inner_knots), np.zeros(inner_knots + 4), np.empty(0)
    )
    displacement = fit.displacement
    model = np.concatenate([fit.gradient(true), (fit.slope(true)[:, None] * displaced).T])
    for _ in range(6):
        slope = fit.slope(true) + departure.slope(true)
        film = points.thickness[kept] + displaced @ displacement
        std = np.hypot(y_std, slope * t_std)
        rest = y - fit.predict(true) - departure.predict(true) - slope * (film - true)
        design = (
            np.column_stack([departure.basis(true).T, slope[:, None] * displaced]) / std[:, None]
        )
        change = np.linalg.lstsq(design, rest / std, rcond=None)[0]
        departure = Departure(
            departure.knots, departure.coefficients + change[: inner_knots + 4], np.empty(0)
        )
        displacement = displacement + change[inner_knots + 4 :]
        rest = rest - design @ change * std
        film = points.thickness[kept] + displaced @ displacement
        true = film + slope * (t_std / std) ** 2 * rest
    chi_square = float(((rest / std) ** 2).sum())
    # what the model has taken of the noise already is not taken again
    taken = np.linalg.qr(model.T / std[:, None])[0]
    space = np.linalg.svd(design, full_matrices=False)[0]
    solve = np.linalg.pinv(design)
    solve = solve - solve @ taken @ taken.T
    covariance = (solve @ solve.T)[: inner_knots + 4, : inner_knots + 4]
    used = design.shape[1] - float(((space.T @ taken) ** 2).sum())
    true_thickness = points.thickness + freedom.displacement @ displacement
    true_thickness[kept] = true
    departure = Departure(departure.knots, departure.coefficients, covariance)
    return Candidate(departure, displacement, chi_square, used, true_thickness)


def _place_knots(fit: Fit, thickness: Array, inner_knots: int) -> Array:
    low, high = float(thickness.min()), float(thickness.max())
    grid = np.linspace(low, high, 501)
    modelled = fit.predict(grid)
    inside = np.interp(
        np.linspace(modelled[0], modelled[-1], inner_knots + 2)[1:-1], modelled, grid
    )
    return np.concatenate([[low] * 4, inside, [high] * 4])


def find_correlation(position: Array, residual: Array) -> tuple[float, float]:
    """Correlation of neighbours along a line, and how many standard deviations of chance it is.

    Parameters
    ----------
    position : array, (point, axis)
    residual : array, (point,)
        In units of its standard deviation.
    """
    if position.shape[1] == 2 or residual.size < 20:
        return 0.0, 0.0
    ordered = residual[np.argsort(position[:, 0])]
    ordered = ordered - ordered.mean()
    if not ordered.any():
        return 0.0, 0.0
    correlation = float((ordered[1:] * ordered[:-1]).sum() / (ordered**2).sum())
    return correlation, correlation * math.sqrt(residual.size)
