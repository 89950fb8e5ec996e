"""Whether two calibrations differ by more than chance: the check for drift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.stats import chi2
from scipy.stats import f as fisher

from erlif.calibration.curve import Calibration, share_bands
from erlif.calibration.departure import find_correlation
from erlif.core.arrays import Array
from erlif.core.errors import CalibrationError

FALSE_ALARM = 0.01
"""Probability of chance below which a difference is taken for one."""

_GRID = 60
_NO_VARIANCE = 1e-5  # share of the largest variance below which a shape of the difference is not told by the covariances
_SHARED = 0.8  # of the CMM points: above it, two calibrations rest on the same readings
_ROUNDING = 1e-5  # mm and um: nearer points of the CMM are one
_PLACES = ("curve_x", "curve_y")


@dataclass(frozen=True)
class Comparison:
    """A calibration less an earlier one.

    Attributes
    ----------
    thickness : array, (film,)
        Over the range that both answer. [um]
    difference, difference_std : array, (film,)
        Of the logarithm of the ratio.
    film_change, film_change_std : array, (film,)
        Thickness read with the new calibration less that read with the earlier one, from the same ratio. [um]
    own_std : array, (film,)
        What the new calibration alone leaves in a thickness. [um]
    probability : float
        Of a difference as large by chance.
    bends : bool
        Whether the ratio changed by more at some films than at others.
    same_profile : bool or None
        Whether both rest on the same CMM readings; None where that is not recorded.
    paired : bool
        Whether the ratios were compared point by point, so that the error of the readings cancels.
    earlier : str
        Name and date of the earlier calibration.
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

    @property
    def significant(self) -> bool:
        """Whether chance gives such a difference less than once in a hundred times."""
        return self.probability < FALSE_ALARM

    @property
    def drifted(self) -> bool:
        """Whether the difference is significant and somewhere beyond two standard deviations of the calibration itself."""
        return self.significant and bool(np.any(np.abs(self.film_change) > 2 * self.own_std))

    @property
    def verdict(self) -> str:
        """What was found, in a sentence or two."""
        basis = self._basis()
        if not self.significant:
            return f"not drifted from {self.earlier}: {self._size()}, as chance has it (probability {self.probability:.2f}; {basis})"
        chance = "below 1e-12" if self.probability < 1e-12 else f"{self.probability:.1g}"
        told = f"{self._size()} (probability of chance {chance}; {basis})"
        if not self.drifted:
            return f"not drifted from {self.earlier} beyond what the calibration leaves uncertain itself (two standard deviations), but measurably: {told}"
        ratio = 100 * np.expm1(self.difference)
        if self.bends:
            cause = (
                f"The ratio changed by {ratio[0]:+.2f} % at {self.thickness[0]:.1f} um and by {ratio[-1]:+.2f} % at {self.thickness[-1]:.1f} um: "
                "p or q changed, as with dye concentration or temperature, or the fixture lay elsewhere"
            )
        else:
            cause = (
                f"The ratio changed by {ratio.mean():+.2f} % alike at all films: K changed, as with filters, exposure or gain of a camera, or "
                "bleaching"
            )
        return f"drifted from {self.earlier}: {told}. {cause}"

    def _basis(self) -> str:
        """How the error of the CMM readings counts."""
        if self.paired:
            return "both rest on the same CMM readings, whose error cancels"
        if self.same_profile:
            return "both rest on the same CMM readings, but not on the same points of them; they were taken as independent"
        if self.same_profile is None:
            return "whether both rest on the same CMM readings is not recorded; they were taken as independent"
        return "the CMM readings differ and count with all their error"

    def _size(self) -> str:
        """How differently films are read, at most and at some films."""
        low, high = self.thickness[0], self.thickness[-1]
        at = [film for film in (1.0, 3.0, 8.0) if low <= film <= high] or [(low + high) / 2]
        changes, n = (
            np.interp(at, self.thickness, self.film_change),
            int(np.argmax(np.abs(self.film_change))),
        )
        films = ", ".join(
            f"{change:+.3f} um at {film:.1f} um" for film, change in zip(at, changes, strict=True)
        )
        largest = f"{self.film_change[n]:+.3f} ± {self.film_change_std[n]:.3f} um ({100 * self.film_change[n] / self.thickness[n]:+.2g} %)"
        return f"films are read differently by {films}, and at most by {largest} at {self.thickness[n]:.1f} um"


def compare_calibrations(calibration: Calibration, earlier: Calibration) -> Comparison:
    """Set a calibration against an earlier one over the range that both answer.

    The difference of the curves is set against the covariances of both, shape by shape (chi-square of the principal components that the
    covariances tell). Two photographs of one fixture whose CMM readings are the same share the readings' error, which is most of
    both covariances: then the ratios are compared point by point, and the scatter of their difference about a smooth change says
    how large chance is (F test). Assumed: errors of the ratio are independent between the two; a fixture laid elsewhere counts as drift.

    Parameters
    ----------
    calibration, earlier : Calibration

    Raises
    ------
    CalibrationError
        If the bands differ, or no film is answered by both.
    """
    if not share_bands(calibration.bands, earlier.bands):
        raise CalibrationError(
            f"Expected calibrations of the same bands; one is of {calibration.bands[0]:g} and {calibration.bands[1]:g} nm, the other of "
            f"{earlier.bands[0]:g} and {earlier.bands[1]:g} nm."
        )
    low, high = (
        limit(calibration.thickness_range[n], earlier.thickness_range[n])
        for n, limit in ((0, max), (1, min))
    )
    if high <= low:
        raise CalibrationError(
            f"Expected calibrations that share a range of films; one answers {calibration.thickness_range[0]:.2f} to "
            f"{calibration.thickness_range[1]:.2f} um, the other {earlier.thickness_range[0]:.2f} to {earlier.thickness_range[1]:.2f} um. Compare "
            "calibrations of the same fixture."
        )
    film = np.linspace(low, high, _GRID)
    pairs = _match_points(calibration, earlier)
    if pairs is None:
        difference = calibration.predict_log(film) - earlier.predict_log(film)
        covariance = sum(
            each.gradient(film).T @ each.full_covariance @ each.gradient(film)
            for each in (calibration, earlier)
        )
        probability, bends = _test_curves(difference, np.asarray(covariance))
        std = np.sqrt(np.diag(np.asarray(covariance)))
    else:
        difference, std, probability, bends = _test_pairs(calibration, film, *pairs)
    slope = calibration.slope(film)
    return Comparison(
        film,
        difference,
        std,
        -difference / slope,
        std / slope,
        calibration.thickness_std(film),
        probability,
        bends,
        _rest_on_same_readings(calibration, earlier, paired=pairs is not None),
        pairs is not None,
        f"{earlier.fixture or 'the earlier calibration'}{f' of {earlier.date}' if earlier.date else ''}",
    )


def _test_curves(difference: Array, covariance: Array) -> tuple[float, bool]:
    """Probability of the difference by chance, and whether it is other than a constant."""
    variance, shapes = np.linalg.eigh(covariance)
    told = variance > _NO_VARIANCE * variance[-1]
    std = np.sqrt(variance[told])
    own = shapes[:, told].T @ difference / std
    constant = shapes[:, told].T @ np.ones(difference.size) / std
    count = int(told.sum())
    left = own - constant * float(constant @ own) / float(constant @ constant)
    bends = bool(chi2.sf(float(left @ left), max(count - 1, 1)) < FALSE_ALARM)
    return float(chi2.sf(float(own @ own), count)), bends


def _match_points(
    calibration: Calibration, earlier: Calibration
) -> tuple[Array, Array, Array] | None:
    """Place, CMM thickness and change of log ratio of the points that both share; None where they rest on other readings."""
    names = [name for name in _PLACES if name in calibration.curve]
    if not names or names != [name for name in _PLACES if name in earlier.curve]:
        return None
    ones, others = (
        np.stack([each.curve[name].values for name in [*names, "curve_thickness"]], axis=1)
        for each in (calibration, earlier)
    )
    distance, other = (np.asarray(found) for found in cKDTree(others).query(ones))
    shared = distance <= _ROUNDING
    if shared.sum() < 20 or shared.sum() < _SHARED * min(len(ones), len(others)):
        return None
    change = np.log(
        calibration.curve.curve_ratio.values[shared]
        / earlier.curve.curve_ratio.values[other[shared]]
    )
    return ones[shared, :-1], ones[shared, -1], change


def _rest_on_same_readings(
    calibration: Calibration, earlier: Calibration, *, paired: bool
) -> bool | None:
    """Whether both rest on the same CMM readings: by their points, or by the file's hash; None where neither tells."""
    if paired:
        return True
    # a fixture's other inputs are its settings and frames
    ones, others = (
        {
            value
            for name, value in each.input_hashes.items()
            if name.lower().endswith((".csv", ".txt"))
        }
        for each in (calibration, earlier)
    )
    if ones and others:
        return not ones.isdisjoint(others)
    return False if all("curve_x" in each.curve for each in (calibration, earlier)) else None


def _test_pairs(
    calibration: Calibration, film: Array, position: Array, thickness: Array, change: Array
) -> tuple[Array, Array, float, bool]:
    """Change of the log ratio over `film` and its standard deviation, the probability of it by chance, and whether it is no constant."""
    design = calibration.gradient(thickness).T
    # functions that the films cannot tell apart are taken once
    shapes, sizes, turn = np.linalg.svd(
        design / np.linalg.norm(design, axis=0), full_matrices=False
    )
    told = sizes > 1e-4 * sizes[0]
    use = np.ones(change.size, bool)
    for _ in range(5):  # without dust that came between
        basis = shapes[use][:, told]
        values, *_ = np.linalg.lstsq(basis, change[use], rcond=None)
        residual = change - shapes[:, told] @ values
        spread = 1.4826 * float(np.median(np.abs(residual[use])))
        now = np.abs(residual) <= 4.5 * max(spread, 1e-12)
        if np.array_equal(now, use):
            break
        use = now
    count, points = int(told.sum()), int(use.sum())
    freedom = points - count
    variance = max(float((residual[use] ** 2).sum()) / freedom, 1e-20)
    correlation, significance = find_correlation(position[use], residual[use])
    if significance > 2:
        variance *= (1 + correlation) / max(1 - correlation, 0.1)
        freedom = max(int(freedom * (1 - correlation) / (1 + correlation)), 1)
    explained = float(change[use] @ change[use] - residual[use] @ residual[use])
    probability = float(fisher.sf(explained / count / variance, count, freedom))
    beyond_constant = explained - points * float(change[use].mean()) ** 2
    bends = bool(
        fisher.sf(beyond_constant / max(count - 1, 1) / variance, max(count - 1, 1), freedom)
        < FALSE_ALARM
    )
    at = (
        (calibration.gradient(film).T / np.linalg.norm(design, axis=0))
        @ turn.T[:, told]
        / sizes[told]
    )
    covariance = variance * np.linalg.inv(basis.T @ basis)
    std = np.sqrt(np.einsum("ij,jk,ik->i", at, covariance, at))
    return at @ values, std, probability, bends
