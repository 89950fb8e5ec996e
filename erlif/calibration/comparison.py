"""Comparison of two calibrations: whether they differ by more than chance, the check for drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from erlif.calibration.bands import share_bands
from erlif.calibration.curve import Calibration
from erlif.calibration.departure import find_correlation
from erlif.calibration.regression import OUTLIER
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError
from erlif.core.statistics import robust_rms

# Probability of chance below which a difference is significant.
FALSE_ALARM = 0.01

# Standard deviations of a calibration beyond which a significant difference is a drift.
DRIFT = 2.0

_WARMER = 1.0  # K: difference from which on a change with temperature is computed
_GRID = 60  # films at which the curves are compared
_NO_VARIANCE = 1e-5  # of the largest: shapes below it are fixed by the covariance's rounding
_SHARED = 0.8  # of the CMM points: above it, two calibrations rest on the same readings
_MINIMUM_PAIRS = 20  # points for a comparison of their scatter
_ROUNDING = 1e-5  # mm and um: readings that differ by less are one, stored twice
_PRESENT = 1e-3  # of the largest function: smaller ones lie beside the points
_RESOLVED = 1e-4  # of the largest singular value: functions below it are not separable
_PASSES = 5  # without outliers
_SMALLEST_SPREAD = 1e-12  # of the log ratio, so that equal images keep their points
_SMALLEST_VARIANCE = 1e-20  # its square is below any noise of a mean ratio
_CORRELATED = 2.0  # standard deviations from which on neighbours are taken as correlated
_SHOWN_FILMS = (1.0, 3.0, 8.0)  # um: films of the verdict
_NOTHING = 0.0005  # um: changes that round to none
_POSITIONS = ("curve_x", "curve_y")


@dataclass(frozen=True)
class Comparison:
    """Difference of a calibration from an earlier one.

    Attributes
    ----------
    thickness : Array
        Films of the range that both cover, (film,). [um]
    difference : Array
        Difference of the logarithm of the ratio, new less earlier, (film,). [1]
    difference_std : Array
        Its standard deviation, (film,). [1]
    film_change : Array
        Thickness by the new calibration less that by the earlier one, from the same ratio,
        (film,). [um]
    film_change_std : Array
        Its standard deviation, (film,). [um]
    own_std : Array
        Standard deviation of a thickness due to the new calibration alone, (film,). [um]
    probability : float
        Probability of a difference as large by chance. [1]
    bends : bool
        Whether the ratio changed by more at some films than at others.
    same_profile : bool | None
        Whether both rest on the same CMM readings; None where that is not recorded.
    paired : bool
        Whether the ratios were compared point by point, so that the error of the readings
        cancels.
    earlier : str
        Name and date of the earlier calibration.
    warmer : float | None
        Temperature of the fixture less that at the earlier calibration; None where one is not
        known. [K]
    """

    thickness: Array
    difference: Array
    difference_std: Array
    film_change: Array
    film_change_std: Array
    own_std: Array
    probability: float
    bends: bool
    same_profile: bool | None
    paired: bool
    earlier: str
    warmer: float | None = None

    @property
    def temperature_coefficient(self) -> tuple[float, float] | None:
        """Change of the logarithm of the ratio with temperature, and its standard deviation. [1/K]

        None where the temperatures are not known or differ by less than 1 K, or where the ratio
        changed by more at some films than at others. The films share their error.
        """
        if self.warmer is None or abs(self.warmer) < _WARMER or self.bends:
            return None
        weight = self.difference_std**-2.0 / np.sum(self.difference_std**-2.0)
        change, std = (float(weight @ each) for each in (self.difference, self.difference_std))
        return change / self.warmer, std / abs(self.warmer)

    @property
    def significant(self) -> bool:
        """Whether chance gives such a difference less than once in a hundred times."""
        return self.probability < FALSE_ALARM

    @property
    def drifted(self) -> bool:
        """Whether the difference is significant and exceeds the calibration's own error.

        It does where it is beyond two standard deviations of the calibration at any film.
        """
        return self.significant and bool(np.any(np.abs(self.film_change) > DRIFT * self.own_std))

    @property
    def verdict(self) -> str:
        """The result in a few sentences."""
        found = self.temperature_coefficient
        if found is None or self.warmer is None:
            return self._describe_drift()
        than = "warmer" if self.warmer > 0 else "colder"
        coefficient, std = (100 * each for each in found)
        return (
            f"{self._describe_drift()}. The oil was {abs(self.warmer):.1f} K {than}. If nothing "
            f"else changed, the ratio changes by {coefficient:+.4f} ± {std:.4f} %/K; in "
            f'[temperature] of run.toml: camera1 = "0 %/K", camera2 = "{coefficient:.4f} %/K", '
            f'std = "{std:.4f} %/K"'
        )

    def _describe_drift(self) -> str:
        """State whether the calibration has drifted, by how much, and the probable cause."""
        basis = self._basis()
        if not self.significant:
            return (
                f"not drifted from {self.earlier}: {self._size()}, consistent with chance "
                f"(probability {self.probability:.2f}; {basis})"
            )
        chance = "below 1e-12" if self.probability < 1e-12 else f"{self.probability:.1g}"
        size = f"{self._size()} (probability of chance {chance}; {basis})"
        if not self.drifted:
            return (
                f"not drifted from {self.earlier} beyond the uncertainty of the calibration itself "
                f"(two standard deviations), but measurably: {size}"
            )

        # K scales the ratio of all films alike; p and q change it more for thick films
        ratio = 100 * np.expm1(self.difference)
        if self.bends:
            cause = (
                f"The ratio changed by {ratio[0]:+.2f} % at {self.thickness[0]:.1f} um and by "
                f"{ratio[-1]:+.2f} % at {self.thickness[-1]:.1f} um: p or q changed, as with dye "
                "concentration or temperature, or the position of the fixture changed"
            )
        else:
            cause = (
                f"The ratio changed by {ratio.mean():+.2f} % at all films alike: K changed, as "
                "with filters, exposure or gain of a camera, or bleaching"
            )
        return f"drifted from {self.earlier}: {size}. {cause}"

    def _basis(self) -> str:
        """Treatment of the error of the CMM readings, as text."""
        if self.paired:
            return "both rest on the same CMM readings, whose error cancels"
        if self.same_profile:
            return (
                "both rest on the same CMM readings, but not on the same points of them; they were "
                "taken as independent"
            )
        if self.same_profile is None:
            return (
                "whether both rest on the same CMM readings is not recorded; they were taken as "
                "independent"
            )
        return "the CMM readings differ and count with all their error"

    def _size(self) -> str:
        """Size of the difference at some films and at its largest, as text."""
        if np.abs(self.film_change).max() < _NOTHING:
            return "measured films change by less than 1 nm"
        low, high = self.thickness[0], self.thickness[-1]
        at = [film for film in _SHOWN_FILMS if low <= film <= high] or [(low + high) / 2]
        changes = np.interp(at, self.thickness, self.film_change)
        films = ", ".join(
            f"{change:+.3f} um at {film:.1f} um" for film, change in zip(at, changes, strict=True)
        )

        n = int(np.argmax(np.abs(self.film_change)))
        film, change, std = self.thickness[n], self.film_change[n], self.film_change_std[n]
        return (
            f"measured films change by {films}, and at most by {change:+.3f} ± {std:.3f} um "
            f"({100 * change / film:+.2g} %) at {film:.1f} um"
        )


def compare_calibrations(calibration: Calibration, earlier: Calibration) -> Comparison:
    """Compare a calibration with an earlier one over the range that both cover.

    The difference of the curves is tested against the covariances of both (chi-square of the
    principal components that the covariances resolve). Two photographs of one fixture with the
    same CMM readings share the readings' error, which is most of both covariances. Their ratios
    are then compared point by point, and the scatter of the difference about a smooth change
    gives the size of chance (F test).

    Errors of the ratio are assumed independent between the two; a fixture in another position
    counts as drift.

    Parameters
    ----------
    calibration, earlier : Calibration
        The new calibration and the one to compare with, of the same filter bands.

    Returns
    -------
    Comparison

    Raises
    ------
    CalibrationError
        If the bands differ, or the calibrated ranges do not overlap.

    Examples
    --------
    The ratio rises by 2 % at all films, while its standard deviation by the covariance of both is
    0.1 %:

    >>> from dataclasses import replace
    >>> import xarray as xr
    >>> earlier = Calibration(
    ...     1.0, 0.40, 0.25, np.diag([5e-7, 1e-12, 1e-12]), (0.5, 10.0), (580.0, 610.0),
    ...     xr.Dataset(), 1.0, "wedge",
    ... )
    >>> found = compare_calibrations(replace(earlier, ratio_at_zero=1.02), earlier)
    >>> found.drifted, found.bends
    (True, False)
    >>> bool(np.allclose(found.difference, np.log(1.02)))
    True
    """
    if not share_bands(calibration.bands, earlier.bands):
        raise CalibrationError(
            f"Expected calibrations of the same bands; one is of {calibration.bands[0]:g} and "
            f"{calibration.bands[1]:g} nm, the other of {earlier.bands[0]:g} and "
            f"{earlier.bands[1]:g} nm. Compare calibrations made with the same filters."
        )
    film = np.linspace(*calibration.range_shared_with(earlier), _GRID)
    pairs = _match_points(calibration, earlier)
    change = (
        _test_curves(calibration, earlier, film)
        if pairs is None
        else _test_pairs(calibration, film, *pairs)
    )

    slope = calibration.slope(film)
    date = f" of {earlier.date}" if earlier.date else ""
    return Comparison(
        thickness=film,
        difference=change.difference,
        difference_std=change.std,
        # a higher curve gives the same ratio a thinner film
        film_change=-change.difference / slope,
        film_change_std=change.std / slope,
        own_std=calibration.thickness_std(film),
        probability=change.probability,
        bends=change.bends,
        same_profile=_share_readings(calibration, earlier, paired=pairs is not None),
        paired=pairs is not None,
        earlier=f"{earlier.fixture or 'the earlier calibration'}{date}",
        warmer=(
            None
            if calibration.temperature is None or earlier.temperature is None
            else calibration.temperature - earlier.temperature
        ),
    )


class _Change(NamedTuple):
    """Change of the curve and its test against chance."""

    difference: Array  # change of the logarithm of the ratio, (film,). [1]
    std: Array  # its standard deviation, (film,). [1]
    probability: float  # probability of such a change by chance
    bends: bool  # whether it is significantly other than a constant


def _test_curves(calibration: Calibration, earlier: Calibration, film: Array) -> _Change:
    """Test the difference of two curves against the sum of their covariances."""
    difference = calibration.predict_log(film) - earlier.predict_log(film)
    one, other = calibration.gradient(film), earlier.gradient(film)
    covariance = one.T @ calibration.full_covariance @ one
    covariance = covariance + other.T @ earlier.full_covariance @ other

    # principal components with a variance of their own, in units of it
    variance, shapes = np.linalg.eigh(covariance)
    resolved = variance > _NO_VARIANCE * variance[-1]
    std = np.sqrt(variance[resolved])
    own = shapes[:, resolved].T @ difference / std
    count = int(resolved.sum())
    probability = float(scipy.special.chdtrc(count, float(own @ own)))

    # what the best constant leaves is a bend
    constant = shapes[:, resolved].T @ np.ones(difference.size) / std
    left = own - constant * float(constant @ own) / float(constant @ constant)
    bends = bool(scipy.special.chdtrc(max(count - 1, 1), float(left @ left)) < FALSE_ALARM)
    return _Change(difference, np.sqrt(np.diag(covariance)), probability, bends)


def _match_points(
    calibration: Calibration, earlier: Calibration
) -> tuple[Array, Array, Array] | None:
    """CMM points that both calibrations share; None where they rest on other readings.

    Position (point, axis) [mm], thickness by the CMM [um], and change of the logarithm of the
    ratio, new less earlier. [1]
    """
    names = [name for name in _POSITIONS if name in calibration.curve]
    if not names or names != [name for name in _POSITIONS if name in earlier.curve]:
        return None
    ones, others = (
        np.stack([each.curve[name].values for name in [*names, "curve_thickness"]], axis=1)
        for each in (calibration, earlier)
    )
    distance, other = (np.asarray(found) for found in scipy.spatial.cKDTree(others).query(ones))
    shared = distance <= _ROUNDING
    if shared.sum() < _MINIMUM_PAIRS or shared.sum() < _SHARED * min(len(ones), len(others)):
        return None
    change = np.log(
        calibration.curve.curve_ratio.values[shared]
        / earlier.curve.curve_ratio.values[other[shared]]
    )
    return ones[shared, :-1], ones[shared, -1], change


def _share_readings(calibration: Calibration, earlier: Calibration, *, paired: bool) -> bool | None:
    """Decide whether both calibrations rest on the same CMM readings, by points or profile hash.

    None where neither is recorded.
    """
    if paired:
        return True
    one, other = (each.input_hashes.get(each.profile_file) for each in (calibration, earlier))
    if one and other:
        return one == other
    return False if all("curve_x" in each.curve for each in (calibration, earlier)) else None


def _test_pairs(
    calibration: Calibration, film: Array, position: Array, thickness: Array, change: Array
) -> _Change:
    """Fit a smooth change to that of the points and test it against their scatter."""
    # photographs of one fixture, whose position and size are the same in both
    design = calibration.fitted_gradient(thickness).T
    use = np.ones(change.size, bool)
    for _ in range(_PASSES):  # without dust that settled between the photographs
        # functions that these films cannot separate are used once, those of other films not at all
        scale = np.linalg.norm(design[use], axis=0)
        scale = np.maximum(scale, _PRESENT * scale.max())
        shapes, sizes, turn = np.linalg.svd(design[use] / scale, full_matrices=False)
        resolved = sizes > _RESOLVED * sizes[0]
        basis = turn.T[:, resolved] / sizes[resolved] / scale[:, None]
        values = shapes[:, resolved].T @ change[use]
        residual = change - design @ basis @ values
        spread = robust_rms(residual[use])
        now = np.abs(residual) <= OUTLIER * max(spread, _SMALLEST_SPREAD)
        if np.array_equal(now, use):
            break
        use = now

    # correlated neighbours leave fewer independent points and a larger variance of their mean
    count, points = int(resolved.sum()), int(use.sum())
    freedom = points - count
    variance = max(float((residual[use] ** 2).sum()) / freedom, _SMALLEST_VARIANCE)
    correlation = find_correlation(position[use], residual[use])
    if correlation.significance > _CORRELATED:
        r = correlation.coefficient
        variance *= correlation.inflation
        freedom = max(int(freedom * (1 - r) / (1 + r)), 1)

    # F test of the whole change, then of what a constant does not explain
    explained = float(change[use] @ change[use] - residual[use] @ residual[use])
    probability = float(scipy.special.fdtrc(count, freedom, explained / count / variance))
    beyond_constant = explained - points * float(change[use].mean()) ** 2
    bend = max(count - 1, 1)
    bends = bool(
        scipy.special.fdtrc(bend, freedom, beyond_constant / bend / variance) < FALSE_ALARM
    )

    at = calibration.fitted_gradient(film).T @ basis
    std = np.sqrt(variance) * np.linalg.norm(at, axis=1)
    return _Change(at @ values, std, probability, bends)
