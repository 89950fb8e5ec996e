"""The inverse of a calibration as a table, for whole images."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import Array

# Entries of the table of the inverse.
_ENTRIES = 20001


class Curve(Protocol):
    """Protocol of a curve that `InverseTable` tabulates, such as a calibration."""

    @property
    def covered_range(self) -> tuple[float, float]:
        """Thickness covered by the fixture. [um]"""

    def predict_log(self, thickness: npt.ArrayLike) -> Array:
        """Natural logarithm of the ratio of a film."""

    def slope(self, thickness: npt.ArrayLike) -> Array:
        """Derivative of the logarithm of the ratio by thickness. [1/um]"""

    def thickness_std(self, thickness: npt.ArrayLike) -> Array:
        """Standard deviation of a thickness due to the calibration alone. [um]"""


@dataclass(frozen=True)
class InverseTable:
    """Thickness, slope and calibration error on an even grid of the logarithm of the ratio.

    Attributes
    ----------
    start : float
        Logarithm of the ratio at the first entry. [1]
    step : float
        Distance of the entries in the logarithm of the ratio. [1]
    thickness : Array
        Film thickness, (entry,). [um]
    per_log_ratio : Array
        Derivative of the thickness by the logarithm of the ratio, (entry,). [um]
    calibration_std : Array
        Standard deviation of the thickness due to the calibration, (entry,). [um]
    """

    start: float
    step: float
    thickness: Array
    per_log_ratio: Array
    calibration_std: Array

    @classmethod
    def of(cls, calibration: Curve) -> InverseTable:
        """Tabulate the inverse over the range of the fixture.

        Linear interpolation in it is good to 1e-5 um.
        """
        low, high = calibration.covered_range
        first, last = calibration.predict_log([low, high])
        grid = np.linspace(first, last, _ENTRIES)

        # Newton's steps from a dense direct table: the curve is monotonic and smooth
        dense = np.linspace(low, high, _ENTRIES)
        thickness = np.interp(grid, calibration.predict_log(dense), dense)
        for _ in range(3):  # quadratic from an error of 1e-3 um: the third reaches rounding
            thickness -= (calibration.predict_log(thickness) - grid) / calibration.slope(thickness)
        thickness = np.clip(thickness, low, high)
        return cls(
            start=float(first),
            step=float(grid[1] - grid[0]),
            thickness=thickness,
            per_log_ratio=1 / calibration.slope(thickness),
            calibration_std=calibration.thickness_std(thickness),
        )

    @cached_property
    def log_ratio(self) -> Array:
        """Logarithm of the ratio of each entry, (entry,). [1]"""
        return np.asarray(self.start + self.step * np.arange(self.thickness.size))

    def look_up(self, log_ratio: Array) -> Array:
        """Thickness by linear interpolation, that of the ends beyond them. [um]"""
        return np.interp(log_ratio, self.log_ratio, self.thickness)
