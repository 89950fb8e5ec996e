"""Fit of the reabsorption model to thickness and ratio by orthogonal distance regression.

Both the thickness by the CMM and the ratio carry errors, so each point is moved along both axes
(Boggs, Byrd and Schnabel 1987, as implemented in ODRPACK). A pose with free combinations is fitted
with the parameters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from odrpack import OdrResult, odr_fit

from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom
from erlif.calibration.profile import MINIMUM_POINTS
from erlif.core.arrays import Array, Mask
from erlif.core.statistics import robust_rms
from erlif.models.fluorescence import log_band_ratio, log_band_ratio_gradient, log_band_ratio_slope

# Standard deviations from the curve beyond which a point is dust, a bubble or a slip of the
# CMM.
OUTLIER = 4.5

_PASSES = 6  # without outliers; the set of kept points is stable after two or three
_FIRST_STD = 0.1  # um: error of the CMM assumed in the first pass where none is stated
_SMALLEST_STD = 1e-3  # um: resolution of a CMM, so that exact data keep a finite weight
_OPTICAL_DEPTHS = (0.3, 2.0, 6.0)  # starting points from a thin to a saturated film
_ATTENUATION_BOUNDS = (math.log(1e-4), math.log(10.0))  # 1/um, beyond any dyed oil
_LOG_RATIO_BOUND = 10.0  # of ln K
_DISPLACEMENT_BOUND = 5.0  # mm
_ITERATIONS = 200


@dataclass(frozen=True)
class Reabsorption:
    """The reabsorption model with its three parameters.

    Attributes
    ----------
    parameters : Array
        K [1], p and q [1/um], (3,).
    """

    parameters: Array

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Logarithm of the ratio of a film. `thickness` in um."""
        K, p, q = self.parameters
        return np.asarray(
            log_band_ratio(thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q)
        )

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Slope of the logarithm of the ratio over thickness. [1/um]"""
        _, p, q = self.parameters
        return np.asarray(
            log_band_ratio_slope(thickness, attenuation_camera1=p, attenuation_camera2=q)
        )

    def gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the logarithm of the ratio by K, p and q, (3, ...)."""
        K, p, q = self.parameters
        return log_band_ratio_gradient(
            thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q
        )


@dataclass(frozen=True)
class Fit(Reabsorption):
    """The model fitted to the points that were kept.

    Attributes
    ----------
    displacement : Array
        Remaining change of the pose in its free combinations, (combination,). [mm]
    covariance : Array
        Covariance of parameters and displacement for the stated noise, (3 + combination, 3 +
        combination).
    chi_square : float
        Sum of squared distances in units of the stated standard deviations.
    kept : Mask
        Points that are no outliers, (point,).
    thickness_std : Array
        Standard deviation of the CMM, stated or estimated from the scatter, (point,). [um]
    true_thickness : Array
        Film thickness from CMM and ratio together, (point,). [um]
    """

    displacement: Array
    covariance: Array
    chi_square: float
    kept: Mask
    thickness_std: Array
    true_thickness: Array

    @property
    def reduced_chi_square(self) -> float:
        """Chi-square per degree of freedom."""
        return self.chi_square / max(int(self.kept.sum()) - len(self.covariance), 1)


def fit_robustly(points: Points, freedom: Freedom) -> Fit:
    """Fit the model by orthogonal distance regression, repeated without outliers.

    Parameters
    ----------
    points : Points
        CMM points and the ratio there. Where the CMM states no uncertainty, it is estimated from
        the scatter about the curve.
    freedom : Freedom
        Changes of the pose to fit with K, p and q.

    Returns
    -------
    Fit
    """
    kept = np.ones(points.thickness.size, bool)
    unknown = not points.has_error_bars
    thickness_std = np.full(kept.size, _FIRST_STD) if unknown else points.thickness_std
    for _ in range(_PASSES):
        fit = _fit_once(points, thickness_std, kept, freedom)
        film = points.thickness + freedom.displacement @ fit.displacement
        slope = np.abs(fit.slope(points.thickness))
        residual = points.log_ratio - fit.predict(film)
        total = np.hypot(points.log_ratio_std, thickness_std * slope)

        # the new estimate serves the next pass; outliers of this one are judged by the old
        if unknown:
            scatter = residual[kept] / slope[kept]
            thickness_std = np.full(kept.size, max(robust_rms(scatter), _SMALLEST_STD))

        width = OUTLIER * max(1.0, math.sqrt(fit.reduced_chi_square))
        now = np.abs(residual) <= width * total
        if now.sum() < MINIMUM_POINTS or (np.array_equal(now, kept) and not unknown):
            break
        kept = now
    return fit


def _fit_once(points: Points, thickness_std: Array, kept: Mask, freedom: Freedom) -> Fit:
    """One regression over the kept points, with the covariance of its parameters."""
    solution = _regress(points, thickness_std, kept, freedom)
    displacement = freedom.displacement[kept]
    beta = solution.beta
    moved = displacement @ beta[3:]
    true_thickness = points.thickness + freedom.displacement @ beta[3:]
    true_thickness[kept] = np.asarray(solution.xplusd) + moved
    fit = Fit(
        parameters=_parameters_of(beta),
        displacement=np.array(beta[3:]),
        covariance=np.empty((0, 0)),
        chi_square=float(solution.sum_square),
        kept=kept,
        thickness_std=thickness_std,
        true_thickness=true_thickness,
    )

    # Derivatives in closed form: ODRPACK's finite differences are relative to the parameter and
    # fail about a displacement of zero.
    slope = fit.slope(true_thickness[kept])
    design = np.column_stack([fit.gradient(true_thickness[kept]).T, slope[:, None] * displacement])
    design /= np.hypot(points.log_ratio_std[kept], slope * thickness_std[kept])[:, None]
    return replace(fit, covariance=np.asarray(np.linalg.inv(design.T @ design)))


def _regress(points: Points, thickness_std: Array, kept: Mask, freedom: Freedom) -> OdrResult:
    """The best of the regressions from several starting points.

    Its parameters are ln K, ln(p - q) and ln q, so that all are positive and p exceeds q, then
    the displacement.
    """
    t, y = points.thickness[kept], points.log_ratio[kept]
    displacement = freedom.displacement[kept]

    def model(x: Array, beta: Array) -> Array:
        return Reabsorption(_parameters_of(beta)).predict(x + displacement @ beta[3:])

    lowest, highest = _ATTENUATION_BOUNDS
    reach = np.full(freedom.size, _DISPLACEMENT_BOUND)
    low = np.array([-_LOG_RATIO_BOUND, lowest, lowest, *-reach])
    high = np.array([_LOG_RATIO_BOUND, highest, highest, *reach])
    trials = [
        odr_fit(
            model,
            t,
            y,
            np.clip(np.array([*start, *np.zeros(freedom.size)]), low, high),
            weight_x=thickness_std[kept] ** -2.0,
            weight_y=points.log_ratio_std[kept] ** -2.0,
            bounds=(low, high),
            maxit=_ITERATIONS,
        )
        for start in _starts(t, y)
    ]
    return min(trials, key=lambda trial: float(trial.sum_square))


def _parameters_of(beta: Array) -> Array:
    """K, p and q of the searched ln K, ln(p - q) and ln q."""
    K, difference, q = (math.exp(value) for value in beta[:3])
    return np.array([K, q + difference, q])


def _starts(thickness: Array, log_ratio: Array) -> list[list[float]]:
    """Starting points (ln K, ln(p - q), ln q) from the rise of the ratio, at several depths."""
    line = np.polyfit(thickness, log_ratio, 1)
    span = float(np.ptp(thickness))
    starts = []
    for optical_depth in _OPTICAL_DEPTHS:
        q = optical_depth / span
        # the slope at zero is (p - q)/2 and falls with depth; a flat ratio still needs a start
        rise = max(2 * line[0], 0.05 / span) * (1 + optical_depth / 2)
        starts.append([float(log_ratio[np.argmin(thickness)]), math.log(rise), math.log(q)])
    return starts
