"""The curve from ratio to film of one run: what the run adds to a finished calibration."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy

from erlif.calibration.bands import check_bands
from erlif.calibration.curve import Calibration, RatioCurve
from erlif.calibration.regression import Reabsorption
from erlif.calibration.systematics import NO_SYSTEMATICS, Systematics
from erlif.core.arrays import Array

_RANGE = 1001  # films of the range at which the slope is looked at

# Films at which what a run adds to a curve is tabulated: the first and the last, as thick as one
# without end [um], and their number. Between them it is a cubic spline, right to 1e-8.
_THINNEST, _THICKEST, _ADDED = 0.02, 1e3, 1801


@dataclass(frozen=True)
class RunCurve(RatioCurve):
    """A calibration as a run may use it: its errors, the later fixture, what the run has shown.

    Attributes
    ----------
    calibration : Calibration
        As it was fitted, without its camera map.
    thickness_range : tuple[float, float]
        Calibrated range, shared with the later fixture. [um]
    systematics : Systematics
        Errors of fixture and run that frames do not show, and what the run adds to the curve.
    later : Calibration | None
        That of the fixture after the run; None where there is one fixture.
    passed : float
        Share of the run that has passed: the curve lies so far on the way to that of `later`. [1]
    """

    calibration: Calibration
    thickness_range: tuple[float, float]
    systematics: Systematics = field(repr=False)
    later: Calibration | None = field(default=None, repr=False)
    passed: float = 0.0

    @classmethod
    def of(cls, calibration: Calibration, later: Calibration | None = None) -> RunCurve:
        """Join the calibration of a fixture before a run with that of a fixture after it.

        `at` gives the curve between the two. The errors are those of the first one, which rests on
        the same profile; `erlif.process` adds what those of the later one exceed them by.

        Parameters
        ----------
        calibration : Calibration
        later : Calibration, optional
            Of the same filter bands.

        Returns
        -------
        RunCurve
            In the range that both cover.

        Raises
        ------
        CalibrationError
            If the bands differ, or no film is in both ranges.

        Examples
        --------
        >>> from erlif.show.plots import example_calibration
        >>> before = example_calibration()
        >>> run = RunCurve.of(before, replace(before, ratio_at_zero=0.62))
        >>> [round(float(run.at(passed).predict(5.0)), 2) for passed in (0.0, 0.5, 1.0)]
        [0.87, 0.84, 0.81]
        """
        covered = calibration.thickness_range
        if later is not None:
            check_bands(later, calibration.bands)
            covered = calibration.range_shared_with(later)
            later = replace(later, camera_map=None, systematics=NO_SYSTEMATICS)
        calibration = replace(calibration, camera_map=None)  # it is large
        return cls(calibration, covered, calibration.systematics, later)

    @property
    def covered_range(self) -> tuple[float, float]:
        """Thickness covered by both fixtures. [um]"""
        if self.later is None:
            return self.calibration.covered_by(self)
        low, high = self.calibration.covered_by(replace(self, later=None))
        return max(low, self.later.covered_range[0]), min(high, self.later.covered_range[1])

    @property
    def model(self) -> Reabsorption:
        """The reabsorption model of the first fixture."""
        return self.calibration.model

    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film. `thickness` in um."""
        found = self.calibration.predict_log(thickness)
        if self.later is not None:
            found = found + self.passed * (self.later.predict_log(thickness) - found)
        if not self.follows_run:
            return found
        return np.asarray(found + self._added(np.log(np.maximum(thickness, _THINNEST))))

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""
        found = self.calibration.slope(thickness)
        if self.later is not None:
            found = found + self.passed * (self.later.slope(thickness) - found)
        if not self.follows_run:
            return found
        film = np.maximum(np.asarray(thickness, float), _THINNEST)
        return np.asarray(found + self._added(np.log(film), 1) / film)

    def fitted_gradient(self, thickness: npt.ArrayLike) -> Array:
        """Derivatives of the log ratio by what was fitted to the first fixture, (n, ...)."""
        return self.calibration.fitted_gradient(thickness)

    @property
    def fitted_covariance(self) -> Array:
        """Covariance of what was fitted to the first fixture, (n, n)."""
        return self.calibration.fitted_covariance

    def change(self, thickness: npt.ArrayLike) -> Array:
        """Log ratio of the later fixture less that of the first; 0 with one fixture. [1]"""
        if self.later is None:
            return super().change(thickness)
        return self.later.predict_log(thickness) - self.at(0.0).predict_log(thickness)

    @property
    def follows_run(self) -> bool:
        """Whether the run has added something to the curve of the fixture."""
        return self.systematics.value is not None

    def where_it_rises(self) -> RunCurve:
        """Return the curve in the range in which it rises from the first frame to the last.

        Light that is not film changes the ratio most where the film is thin: what a run has shown
        of it may leave a maximum or minimum within the calibrated range.
        """
        films = np.linspace(*self.thickness_range, _RANGE)
        rises = np.all([self.at(passed).slope(films) > 0 for passed in (0.0, 1.0)], axis=0)
        ends = np.flatnonzero(np.concatenate([[True], ~rises, [True]]))
        widest = int(np.argmax(np.diff(ends)))
        covered = films[ends[widest]], films[ends[widest + 1] - 2]
        return replace(self, thickness_range=(float(covered[0]), float(covered[1])))

    @cached_property
    def _added(self) -> scipy.interpolate.CubicSpline:
        """Spline through the change of the log ratio by the run, over ln(film thickness [um])."""
        plain = replace(self, systematics=replace(self.systematics, value=None))
        films = np.geomspace(_THINNEST, _THICKEST, _ADDED)
        assert self.systematics.value is not None
        added = np.tensordot(self.systematics.value, plain.gradient(films), 1)
        return scipy.interpolate.CubicSpline(np.log(films), added)

    @property
    def moves(self) -> bool:
        """Whether the curve itself changes during the run, not its errors alone."""
        return self.later is not None or self.follows_run

    @property
    def varies(self) -> bool:
        """Whether the curve or its errors change during the run."""
        return self.later is not None or bool(self.systematics.varies.any())

    def at(self, passed: float) -> RunCurve:
        """Return the curve at the time when a share `passed` of the run is over."""
        if not self.varies:
            return self
        return replace(self, systematics=replace(self.systematics, passed=passed), passed=passed)
