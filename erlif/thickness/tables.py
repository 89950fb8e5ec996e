"""A calibration as the tables in single precision that the film pass reads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import AnyArray, Image


class FilmTables(NamedTuple):
    """What the pass reads from a calibration, in single precision.

    Attributes
    ----------
    scale : tuple[np.float32, np.float32, np.float32]
        Log ratio at the first entry of the tables, one over the distance of the entries, and the
        largest number below that of the last entry. [1]
    films : tuple[Image, AnyArray]
        Film thickness, (entry,) [um]. Its derivative by the log ratio [um] and its standard
        deviation due to the calibration [um], two numbers in the memory of one, read at once.
    limits : Image
        Log ratios of the calibrated range, of what the fixture covers, and the first and last one
        that the tables hold, (6,). [1]
    """

    scale: tuple[np.float32, np.float32, np.float32]
    films: tuple[Image, AnyArray]
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
        ranges = *calibration.thickness_range, *calibration.covered_range

        # the first and last number in single precision that lie between the ends of the tables
        end = table.start + table.step * (table.thickness.size - 1)
        first, last = np.float32(table.start), np.float32(end)
        if float(first) < table.start:
            first = np.nextafter(first, np.float32(np.inf))
        while (float(last) - table.start) / table.step > table.thickness.size - 1:
            last = np.nextafter(last, np.float32(-np.inf))
        entries = np.nextafter(np.float32(table.thickness.size - 1), np.float32(0))
        slopes = np.stack([table.per_log_ratio, table.calibration_std], axis=-1).astype(np.float32)
        return cls(
            (np.float32(table.start), np.float32(1 / table.step), entries),
            (table.thickness.astype(np.float32), slopes.ravel().view(np.float64)),
            np.append(calibration.predict_log(ranges), [first, last]).astype(np.float32),
        )

    def growing_to(
        self, last: FilmTables, passed: float, middle: FilmTables | None = None
    ) -> FilmTables:
        """Tables when a share of a run has passed, between those of its first and its last frame.

        Parameters
        ----------
        last : FilmTables
            Of the same calibration; the error that grows from nothing is there at its full size.
        passed : float
            Share of the run. [1]
        middle : FilmTables, optional
            At half of the run, where what grows is correlated with what does not.

        Returns
        -------
        FilmTables
        """
        slopes, end = (tables.films[1].view(np.float32).copy() for tables in (self, last))
        fixed, whole = slopes[1::2] ** 2, end[1::2] ** 2
        if middle is None:
            variance = fixed + passed**2 * np.maximum(whole - fixed, 0.0)
        else:
            # a parabola of the share
            half = middle.films[1].view(np.float32)[1::2] ** 2
            bend = 2 * (fixed + whole - 2 * half)
            variance = fixed + passed * (whole - fixed - bend) + passed**2 * bend
        slopes[1::2] = np.sqrt(np.maximum(variance, 0.0))
        return self._replace(films=(self.films[0], slopes.view(np.float64)))
