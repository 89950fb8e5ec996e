"""The reabsorption model laid through thickness and ratio by orthogonal distance regression, the pose free where it is told."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from odrpack import odr_fit

from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom
from erlif.calibration.profile import LEAST_POINTS
from erlif.core.arrays import Array, Mask
from erlif.models.fluorescence import log_band_ratio, log_band_ratio_gradient, log_band_ratio_slope

OUTLIER = 4.5
"""Points this many standard deviations off the curve are dust, bubbles or a slip of the CMM."""


@dataclass(frozen=True)
class Fit:
    """The model through the points that were kept.

    Attributes
    ----------
    parameters : array, (3,)
        K [1], p and q [1/um].
    displacement : array, (combination,)
        What is left to change of the pose, in its free combinations. [mm]
    covariance : array, (3 + combination, 3 + combination)
        Of both, for the stated noise.
    chi_square : float
    kept : array of bool, (point,)
    thickness_std : array, (point,)
        As stated, or estimated from the scatter. [um]
    true_thickness : array, (point,)
        Film that CMM and ratio agree on. [um]
    """

    parameters: Array
    displacement: Array
    covariance: Array
    chi_square: float
    kept: Mask
    thickness_std: Array
    true_thickness: Array

    @property
    def reduced_chi_square(self) -> float:
        """Per degree of freedom."""
        return self.chi_square / max(int(self.kept.sum()) - len(self.covariance), 1)

    def predict(self, thickness: Array) -> Array:
        """Logarithm of the ratio."""
        K, p, q = self.parameters
        return np.asarray(
            log_band_ratio(thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q)
        )

    def slope(self, thickness: Array) -> Array:
        """Of the logarithm of the ratio. [1/um]"""
        _, p, q = self.parameters
        return np.asarray(
            log_band_ratio_slope(thickness, attenuation_camera1=p, attenuation_camera2=q)
        )

    def gradient(self, thickness: Array) -> Array:
        """Of the logarithm of the ratio by K, p and q, (3, ...)."""
        K, p, q = self.parameters
        return log_band_ratio_gradient(
            thickness, ratio_at_zero=K, attenuation_camera1=p, attenuation_camera2=q
        )


def fit_robustly(points: Points, freedom: Freedom) -> Fit:
    """Orthogonal distance regression, repeated without outliers; a CMM without error bars gets them from the scatter."""
    kept = np.ones(points.thickness.size, bool)
    unknown = not np.isfinite(points.thickness_std).all()
    thickness_std = np.full(kept.size, 0.1) if unknown else points.thickness_std
    for _ in range(6):
        fit = _fit_once(points, thickness_std, kept, freedom)
        film = points.thickness + freedom.displacement @ fit.displacement
        slope = np.abs(fit.slope(points.thickness))
        residual = points.log_ratio - fit.predict(film)
        total = np.hypot(points.log_ratio_std, thickness_std * slope)
        if unknown:
            scatter = residual[kept] / slope[kept]
            thickness_std = np.full(
                kept.size, max(1.4826 * float(np.median(np.abs(scatter))), 1e-3)
            )
        width = OUTLIER * max(1.0, math.sqrt(fit.reduced_chi_square))
        now = np.abs(residual) <= width * total
        if now.sum() < LEAST_POINTS or (np.array_equal(now, kept) and not unknown):
            break
        kept = now
    return fit


def _fit_once(points: Points, thickness_std: Array, kept: Mask, freedom: Freedom) -> Fit:
    t, y = points.thickness[kept], points.log_ratio[kept]
    displacement = freedom.displacement[kept]

    def model(x: Array, beta: Array) -> Array:
        q = math.exp(beta[2])
        p = q + math.exp(beta[1])
        film = x + displacement @ beta[3:]
        return np.asarray(
            log_band_ratio(
                film, ratio_at_zero=math.exp(beta[0]), attenuation_camera1=p, attenuation_camera2=q
            )
        )

    solution = None
    for start in _starts(t, y):
        beta = np.array([*start, *np.zeros(freedom.size)])
        low = np.array([-10.0, math.log(1e-4), math.log(1e-4), *np.full(freedom.size, -5.0)])
        high = np.array([10.0, math.log(10.0), math.log(10.0), *np.full(freedom.size, 5.0)])
        trial = odr_fit(
            model,
            t,
            y,
            np.clip(beta, low, high),
            weight_x=thickness_std[kept] ** -2.0,
            weight_y=points.log_ratio_std[kept] ** -2.0,
            bounds=(low, high),
            maxit=200,
        )
        if solution is None or trial.sum_square < solution.sum_square:
            solution = trial
    assert solution is not None
    beta = solution.beta
    K, q = math.exp(beta[0]), math.exp(beta[2])
    moved = displacement @ beta[3:]
    true_thickness = points.thickness + freedom.displacement @ beta[3:]
    true_thickness[kept] = np.asarray(solution.xplusd) + moved
    fit = Fit(
        np.array([K, q + math.exp(beta[1]), q]),
        np.array(beta[3:]),
        np.empty((0, 0)),
        float(solution.sum_square),
        kept,
        thickness_std,
        true_thickness,
    )
    # by derivatives in closed form: finite differences about a displacement of zero are no derivatives
    slope = fit.slope(true_thickness[kept])
    design = np.column_stack([fit.gradient(true_thickness[kept]).T, slope[:, None] * displacement])
    design /= np.hypot(points.log_ratio_std[kept], slope * thickness_std[kept])[:, None]
    return replace(fit, covariance=np.asarray(np.linalg.inv(design.T @ design)))


def _starts(thickness: Array, log_ratio: Array) -> list[list[float]]:
    """Starting points (ln K, ln(p - q), ln q) from the rise of the ratio, for several scales of attenuation."""
    line = np.polyfit(thickness, log_ratio, 1)
    span = float(np.ptp(thickness))
    starts = []
    for optical_depth in (0.3, 2.0, 6.0):
        q = optical_depth / span
        rise = max(2 * line[0], 0.05 / span) * (1 + optical_depth / 2)
        starts.append([float(log_ratio[np.argmin(thickness)]), math.log(rise), math.log(q)])
    return starts
