"""Fit of the reabsorption model to thickness and ratio by orthogonal distance regression.

Both the thickness by the CMM and the ratio carry errors, so each point is moved along both axes
(Boggs, Byrd and Schnabel 1987). A pose with free combinations is fitted with the parameters.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from erlif.calibration.points import Points
from erlif.calibration.pose import Freedom
from erlif.calibration.profile import MINIMUM_POINTS
from erlif.core.arrays import Array, Mask
from erlif.core.statistics import robust_rms
from erlif.models.fluorescence import BandLight, BandRatio, band_light, band_ratio

# Standard deviations from the curve beyond which a point is dust, a bubble or a slip of the
# CMM.
OUTLIER = 4.5

# Difference of the Bayesian criterion from which on a larger model is used (Kass & Raftery 1995).
VERY_STRONG = 10.0

# Reflectance below which a spline follows the curve as well, and broad filters look the same: 50 nm
# at half width give 0.08. [1]
LEAST_REFLECTANCE = 0.1

# Parameters of the model before a black wall: K, p and q.
BLACK = 3

# Attenuation of the laser over that of camera 2 where the wall does not show it, and its error.
LASER_SHARE, LASER_SHARE_STD = 0.8, 0.1

# Reflectance from which on a fixture shows the attenuation of the laser better. [1]
_SHOWS_LASER = 0.2

# Standard deviation of a stated reflectance, whose error is the term `wall` of the systematics.
EXACT = 1e-6

_MOST_REFLECTANCE = 0.999  # a fit that ends at the bound of 1 follows something else
_PASSES = 6  # without outliers; the set of kept points is stable after two or three
_FIRST_STD = 0.1  # um: error of the CMM assumed in the first pass where none is stated
_SMALLEST_STD = 1e-3  # um: resolution of a CMM, so that exact data keep a finite weight
_OPTICAL_DEPTHS = (0.3, 2.0, 6.0)  # starting points from a thin to a saturated film
_ATTENUATION_BOUNDS = (math.log(1e-4), math.log(10.0))  # 1/um, beyond any dyed oil
_LOG_RATIO_BOUND = 10.0  # of ln K
_DISPLACEMENT_BOUND = 5.0  # mm
_ITERATIONS = 200
_CONVERGED = 1e-10  # relative change of chi-square or of the unknowns
_NEAREST = 10  # steps to the place of the curve that is nearest to a point; four are enough
_SETTLED = 1e-9  # relative change of a film; distances change by its square
_MORE = 2  # parameters of a reflecting wall
_BENDS = 6  # degree of the smooth curve through the residuals
_REFLECTANCES = (0.5, 0.1)  # starting points of R
_LEAST_LASER_SHARE = 0.4  # the dyes absorb the laser at least about as much as their own light


# Wall behind the film: None if it is black, otherwise value and standard deviation of those of its
# parameters that are stated and not fitted, by the number of the parameter.
Wall = Mapping[int, tuple[float, float]] | None


@dataclass(frozen=True)
class Reabsorption:
    """The reabsorption model, before a black wall or before one that reflects.

    Attributes
    ----------
    parameters : Array
        K [1], p and q [1/um], (3,); before a reflecting wall also a [1/um], the attenuation of the
        laser, and R [1], the reflectance, (5,).
    """

    parameters: Array

    @property
    def reflects(self) -> bool:
        """Whether the wall behind the film reflects."""
        return len(self.parameters) > BLACK

    @property
    def with_wall(self) -> Reabsorption:
        """The same with the parameters of a wall, a black one where it has none."""
        if self.reflects:
            return self
        K, p, q = self.parameters
        return Reabsorption(np.array([K, p, q, LASER_SHARE * q, 0.0]))

    def predict(self, thickness: npt.ArrayLike) -> Array:
        """Logarithm of the ratio of a film. `thickness` in um."""
        return self.ratio(thickness).log_ratio

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Slope of the logarithm of the ratio over thickness. [1/um]"""
        return self.ratio(thickness).slope

    def gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the logarithm of the ratio by the parameters, (parameter, ...)."""
        return self.ratio(thickness).gradient[: len(self.parameters)]

    def light(self, thickness: npt.ArrayLike) -> BandLight:
        """Light of camera 1, with its derivatives by p, and by a and R of a reflecting wall."""
        wall = {}
        if self.reflects:
            wall = {"attenuation_laser": self.parameters[3], "reflectance": self.parameters[4]}
        light = band_light(thickness, attenuation=self.parameters[1], **wall)
        return light if wall else replace(light, black=True)

    def ratio(self, thickness: npt.ArrayLike) -> BandRatio:
        """Ratio of both cameras, with its derivatives by K, p and q, and a and R of any wall."""
        K, p, q, *wall = self.parameters
        a, R = wall or (0.0, 0.0)
        return band_ratio(
            thickness,
            ratio_at_zero=K,
            attenuation_camera1=p,
            attenuation_camera2=q,
            attenuation_laser=a,
            reflectance=R,
        )


@dataclass(frozen=True)
class Fit(Reabsorption):
    """The model fitted to the points that were kept.

    Attributes
    ----------
    displacement : Array
        Remaining change of the pose in its free combinations, (combination,). [mm]
    covariance : Array
        Covariance of parameters and displacement for the stated noise, (parameter + combination,
        parameter + combination).
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


def fit_robustly(points: Points, freedom: Freedom, *, reflectance: float | None = None) -> Fit:
    """Fit the model by orthogonal distance regression, repeated without outliers.

    The wall behind the film is black, or reflects where the Bayesian criterion is lower by 10 with
    the two further parameters and the reflectance is above `LEAST_REFLECTANCE`.

    Parameters
    ----------
    points : Points
        CMM points and the ratio there. Where the CMM states no uncertainty, it is estimated from
        the scatter about the curve.
    freedom : Freedom
        Changes of the pose to fit with the model.
    reflectance : float, optional
        Stated share of the light that the wall returns; default: as the points show it. The
        attenuation of the laser is then fitted from a reflectance of 20 % on; below, it is 0.8 ±
        0.1 of that in the band of camera 2. [1]

    Returns
    -------
    Fit
    """
    if reflectance is not None:
        return _drop_outliers(points, freedom, _state_wall(reflectance))
    fit = _drop_outliers(points, freedom, None)
    if not _is_bent(points, fit, freedom):
        return fit
    wall = _drop_outliers(points, freedom, {})
    black = _fit_once(points, wall.thickness_std, wall.kept, freedom, None)
    gain = (black.chi_square - wall.chi_square) / max(1.0, wall.reduced_chi_square)
    evidence = gain - _MORE * math.log(int(wall.kept.sum()))
    reflects = LEAST_REFLECTANCE <= wall.parameters[-1] < _MOST_REFLECTANCE
    return wall if reflects and evidence >= VERY_STRONG else fit


def _is_bent(points: Points, fit: Fit, freedom: Freedom) -> bool:
    """Whether a smooth curve through the residuals would be worth two parameters.

    Of the kept points, or of all: dust hides a curve among all, and a bent curve is itself left out
    as outliers.
    """
    film = points.thickness + freedom.displacement @ fit.displacement
    std = np.hypot(points.log_ratio_std, fit.thickness_std * fit.slope(film))
    residual = (points.log_ratio - fit.predict(film)) / std
    basis = np.polynomial.chebyshev.chebvander(film / film.max(), _BENDS) / std[:, None]

    def gain(of: Mask) -> float:
        rest = np.linalg.lstsq(basis[of], residual[of], rcond=None)[1].sum()
        gained = float(residual[of] @ residual[of] - rest)
        return gained / max(1.0, float(rest) / int(of.sum()))

    needed = VERY_STRONG + _MORE * math.log(residual.size)
    return any(gain(of) > needed for of in (fit.kept, np.ones_like(fit.kept)))


def _drop_outliers(points: Points, freedom: Freedom, wall: Wall) -> Fit:
    """The fit of one form of the model without its outliers."""
    kept = np.ones(points.thickness.size, bool)
    unknown = not points.has_error_bars
    thickness_std = np.full(kept.size, _FIRST_STD) if unknown else points.thickness_std
    for _ in range(_PASSES):
        fit = _fit_once(points, thickness_std, kept, freedom, wall)
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


def _fit_once(
    points: Points, thickness_std: Array, kept: Mask, freedom: Freedom, wall: Wall
) -> Fit:
    """One regression over the kept points, with the covariance of its parameters."""
    solution = _regress(points, thickness_std, kept, freedom, wall)
    displacement = freedom.displacement[kept]
    beta, shift = np.split(solution.unknowns, [len(solution.unknowns) - freedom.size])
    true_thickness = points.thickness + freedom.displacement @ shift
    true_thickness[kept] = solution.film
    fit = Fit(
        parameters=_parameters_of(beta),
        displacement=shift,
        covariance=np.empty((0, 0)),
        chi_square=solution.chi_square,
        kept=kept,
        thickness_std=thickness_std,
        true_thickness=true_thickness,
    )

    slope = fit.slope(true_thickness[kept])
    design = np.column_stack([fit.gradient(true_thickness[kept]).T, slope[:, None] * displacement])
    design /= np.hypot(points.log_ratio_std[kept], slope * thickness_std[kept])[:, None]
    # of a wall that hardly reflects, the attenuation of the laser is not determined
    invert = np.linalg.inv if wall is None else np.linalg.pinv
    if not wall:
        return replace(fit, covariance=np.asarray(invert(design.T @ design)))

    # what is not fitted moves the others by its error
    curvature = design.T @ design
    free = np.delete(np.arange(len(curvature)), list(wall))
    fitted = np.zeros_like(curvature)
    fitted[np.ix_(free, free)] = invert(curvature[np.ix_(free, free)])
    covariance, scale = fitted.copy(), {BLACK: fit.parameters[2], BLACK + 1: 1.0}  # a over q
    for n, (_, std) in wall.items():
        response = -fitted @ curvature[n]
        response[n] = 1.0
        covariance += np.outer(response, response) * (std * scale[n]) ** 2
    return replace(fit, covariance=covariance)


def _state_wall(reflectance: float) -> Wall:
    """Return the wall of a stated reflectance."""
    if reflectance == 0:
        return None
    wall = {BLACK + 1: (reflectance, EXACT)}
    return wall if reflectance >= _SHOWS_LASER else {BLACK: (LASER_SHARE, LASER_SHARE_STD), **wall}


class _Solution(NamedTuple):
    """Unknowns of a curve, true films of the points [um] and sum of squared distances."""

    unknowns: Array
    film: Array
    chi_square: float


@dataclass(frozen=True)
class _Distances:
    """Distances of points from a curve along both axes, in their standard deviations.

    The unknowns of a curve are ln K, ln(p - q) and ln q, so that all are positive and p exceeds q,
    before a reflecting wall a/q and R, then the displacement.
    """

    thickness: Array
    thickness_std: Array
    log_ratio: Array
    log_ratio_std: Array
    displacement: Array  # films by the combinations, (point, combination) [um/mm]

    def nearest(self, unknowns: Array) -> tuple[Reabsorption, Array, BandRatio]:
        """The curve, the films by the CMM [um], and the ratio at its nearest places."""
        size = len(unknowns) - self.displacement.shape[1]
        curve = Reabsorption(_parameters_of(unknowns[:size]))
        film = stated = self.thickness + self.displacement @ unknowns[size:]
        far = 2 * self.thickness.max()  # of a bad start, places run away

        place = curve.ratio(film)
        for _ in range(_NEAREST):
            before, slope = film, place.slope
            across = slope * self.thickness_std**2
            share = across / (self.log_ratio_std**2 + across * slope)
            miss = self.log_ratio - place.log_ratio + slope * (film - stated)
            film = np.clip(stated + share * miss, -far, far)
            place = curve.ratio(film)
            if np.abs(film - before).max() < _SETTLED * far:
                break
        return curve, stated, place

    def distances(self, stated: Array, place: BandRatio) -> Array:
        """Distance of each point, with the sign of what the ratio has above the curve."""
        miss = (self.log_ratio - place.log_ratio) / self.log_ratio_std
        return np.copysign(np.hypot(miss, (place.thickness - stated) / self.thickness_std), miss)

    def jacobian(self, curve: Reabsorption, place: BandRatio) -> Array:
        """Derivatives of the distances, (point, unknown); the nearest place stays the nearest."""
        K, p, q, *wall = curve.parameters
        by_K, by_p, by_q, *by_wall = place.gradient[: len(curve.parameters)]
        if by_wall:
            by_q, by_wall[0] = by_q + wall[0] / q * by_wall[0], q * by_wall[0]
        slope = place.slope

        columns = [K * by_K, (p - q) * by_p, q * (by_p + by_q), *by_wall]
        change = np.column_stack([*columns, slope[:, None] * self.displacement])
        return -change / np.hypot(self.log_ratio_std, slope * self.thickness_std)[:, None]

    def fit(
        self,
        start: Array,
        low: Array,
        high: Array,
        held: Mapping[int, float],
        *,
        method: Literal["trf", "dogbox"] = "trf",
    ) -> _Solution:
        """The smallest sum of squares about `start`, with the unknowns `held` at their values."""
        from scipy.optimize import least_squares  # at use: a run needs no fit

        unknowns = np.clip(start, low, high)
        for n, value in held.items():
            unknowns[n] = value
        free = np.delete(np.arange(len(start)), list(held))

        def complete(searched: Array) -> Array:
            changed = unknowns.copy()
            changed[free] = searched
            return changed

        @lru_cache(maxsize=1)  # distances and their derivatives are asked for in turn
        def nearest(searched: bytes) -> tuple[Reabsorption, Array, BandRatio]:
            return self.nearest(complete(np.frombuffer(searched)))

        def distances(searched: Array) -> Array:
            return self.distances(*nearest(searched.tobytes())[1:])

        def derivatives(searched: Array) -> Array:
            curve, _, place = nearest(searched.tobytes())
            return self.jacobian(curve, place)[:, free]

        found = least_squares(
            distances,
            unknowns[free],
            derivatives,
            bounds=(low[free], high[free]),
            method=method,
            x_scale="jac",
            ftol=_CONVERGED,
            xtol=_CONVERGED,
            gtol=_CONVERGED,
            max_nfev=_ITERATIONS,
        )
        best = complete(found.x)
        return _Solution(best, self.nearest(best)[2].thickness, 2 * float(found.cost))


def _regress(
    points: Points, thickness_std: Array, kept: Mask, freedom: Freedom, wall: Wall
) -> _Solution:
    """Return the best of the fits from several starting points."""
    distances = _Distances(
        points.thickness[kept],
        thickness_std[kept],
        points.log_ratio[kept],
        points.log_ratio_std[kept],
        freedom.displacement[kept],
    )
    thin, dark = _ATTENUATION_BOUNDS
    reach = np.full(freedom.size, _DISPLACEMENT_BOUND)
    low = np.array([-_LOG_RATIO_BOUND, thin, thin])
    high = np.array([_LOG_RATIO_BOUND, dark, dark])
    starts = _starts(distances.thickness, distances.log_ratio)
    if wall is not None:
        # the laser is attenuated less than laser and band together
        low, high = np.append(low, [_LEAST_LASER_SHARE, 0.0]), np.append(high, [1.0, 1.0])
        starts = [[*start, LASER_SHARE, R] for R in _REFLECTANCES for start in starts[1:]]
    low, high = np.append(low, -reach), np.append(high, reach)
    held = {n: value for n, (value, _) in (wall or {}).items()}

    def best_of_starts(held: Mapping[int, float]) -> _Solution:
        begun = [np.append(start, np.zeros(freedom.size)) for start in starts]
        trials = [distances.fit(start, low, high, held) for start in begun]
        return min(trials, key=lambda trial: trial.chi_square)

    if wall is None or BLACK in held:
        return best_of_starts(held)

    # Along the attenuation of the laser chi-square has a long valley, and minima that the points do
    # not distinguish; at its ends, light of the background looks like a wall. The fit begins with
    # the usual attenuation.
    usual = best_of_starts({**held, BLACK: LASER_SHARE})
    return distances.fit(usual.unknowns, low, high, held, method="dogbox")


def _parameters_of(beta: Array) -> Array:
    """K, p and q, and a and R, of the searched ln K, ln(p - q) and ln q, a/q and R."""
    K, difference, q = (math.exp(value) for value in beta[:BLACK])
    return np.array([K, q + difference, q, *(beta[3:4] * q), *beta[4:]])


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
