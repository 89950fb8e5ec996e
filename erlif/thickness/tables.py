"""A calibration as the tables in single precision that the film pass reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import AnyArray, Image


@dataclass(frozen=True)
class FilmTables:
    """What the pass reads from a calibration, in single precision.

    Attributes
    ----------
    start : np.float32
        Log ratio at the first entry of the tables. [1]
    per_step : np.float32
        One over the distance of the entries. [1]
    last : np.float32
        The largest number below that of the last entry.
    thickness : Image
        Film thickness, (entry,). [um]
    rate : Image
        Derivative of the thickness by the log ratio, (entry,). [um]
    calibration_std : Image
        Standard deviation of the thickness due to the calibration, (entry,). [um]
    limits : Image
        Log ratios of the calibrated range, of what the fixture covers, and the first and last one
        that the tables hold, (6,). [1]
    """

    start: np.float32
    per_step: np.float32
    last: np.float32
    thickness: Image
    rate: Image
    calibration_std: Image
    limits: Image

    @classmethod
    def of(cls, calibration: Calibration) -> FilmTables:
        """Tables of a calibration.

        Parameters
        ----------
        calibration : Calibration

        Returns
        -------
        FilmTables
        """
        table = calibration.inverse
        limits = np.concatenate(
            [
                calibration.predict_log(calibration.thickness_range),
                calibration.predict_log(calibration.covered_range),
            ]
        ).astype(np.float32)

        # the first and last number in single precision that lie between the ends of the tables
        end = table.start + table.step * (table.thickness.size - 1)
        first, last = np.float32(table.start), np.float32(end)
        if float(first) < table.start:
            first = np.nextafter(first, np.float32(np.inf))
        while (float(last) - table.start) / table.step > table.thickness.size - 1:
            last = np.nextafter(last, np.float32(-np.inf))
        return cls(
            np.float32(table.start),
            np.float32(1 / table.step),
            np.nextafter(np.float32(table.thickness.size - 1), np.float32(0)),
            table.thickness.astype(np.float32),
            table.per_log_ratio.astype(np.float32),
            table.calibration_std.astype(np.float32),
            np.append(limits, [first, last]).astype(np.float32),
        )

    @cached_property
    def pairs(self) -> AnyArray:
        """Entries of rate and calibration_std, two numbers in the memory of one, read at once."""
        return np.stack([self.rate, self.calibration_std], axis=-1).ravel().view(np.float64)
