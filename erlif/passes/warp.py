"""Camera 2 of one frame pair on the pixels of camera 1, row by row.

The reference is `erlif.registration.align_frames`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.flags import Flag
from erlif.passes.light import PairLight
from erlif.passes.noise import CameraNoise, NoiseRows
from erlif.registration import CameraMap, orient, spline_coefficients
from erlif.registration.alignment import spread_flags
from erlif.registration.interpolation import FARTHEST, NOTHING_BAD, sample_rows

_SPARE = 16
"""Rows of noise beyond those of one band, because the next may need a few more."""


@dataclass(frozen=True)
class MapTables:
    """What the alignment repeats in every frame; images are (y, x).

    Attributes
    ----------
    displacement_x : Image
        [px]
    displacement_y : Image
        [px]
    variance : Image
        Variance of one component of the displacement. [px2]
    flags : FlagImage
        Of the map: outside the overlap, poor registration.
    orientation : str
        How camera 2 is turned.
    rows : Array
        Lowest and highest row of camera 2 without drift, for each row, (2, y); infinite where no
        displacement is known. [px]
    """

    displacement_x: Image
    displacement_y: Image
    variance: Image
    flags: FlagImage
    orientation: str
    rows: Array

    def rows_of(self, start: int, stop: int, drift_y: float, height: int) -> tuple[int, int]:
        """Rows of camera 2 from which some rows are interpolated.

        Parameters
        ----------
        start : int
            First row of camera 1.
        stop : int
            The row after the last one.
        drift_y : float
            [px]
        height : int
            Rows of camera 2.

        Returns
        -------
        tuple of int
            The first one, and the one after the last.
        """
        low, high = float(self.rows[0, start:stop].min()), float(self.rows[1, start:stop].max())
        if not low + drift_y <= high + drift_y:  # no displacement or no drift is known
            return 0, 0

        # a point lies between two rows, and single precision may round it to the next one
        low, high = (min(max(row + drift_y, -4.0), height + 4.0) for row in (low, high))
        return max(min(math.floor(low) - 1, height), 0), max(min(math.floor(high) + 3, height), 0)


def tabulate_map(camera_map: CameraMap) -> MapTables:
    """Prepare the alignment by a camera map.

    Parameters
    ----------
    camera_map : CameraMap

    Returns
    -------
    MapTables
    """
    flags = np.where(camera_map.overlap, 0, Flag.OUTSIDE_OVERLAP)
    flags |= np.where(camera_map.poor, Flag.POOR_REGISTRATION, 0)
    along_y = np.ascontiguousarray(camera_map.displacement_y, np.float32)
    known = np.abs(along_y) < FARTHEST
    lowest = np.min(along_y, axis=1, where=known, initial=np.inf)
    highest = np.max(along_y, axis=1, where=known, initial=-np.inf)
    return MapTables(
        np.ascontiguousarray(camera_map.displacement_x, np.float32),
        along_y,
        np.square(camera_map.displacement_std, dtype=float).astype(np.float32),
        flags.astype(np.uint8),
        camera_map.settings.orientation,
        np.arange(along_y.shape[0]) + np.stack([lowest, highest]).astype(float),
    )


@dataclass(frozen=True)
class PairWarp:
    """Camera 2 of one frame pair on the pixels of camera 1; images are (y, x).

    Attributes
    ----------
    light : Image
        NaN outside camera 2. [DN]
    variance : Image
        New in every frame; some rows or all. [DN2]
    variance_fixed : Image
        Of dark and flat; as many rows. [DN2]
    flags : FlagImage
        Of the pixels from which a point is interpolated; as many rows.
    coefficients : Image
        Of the spline through camera 2, with a margin of 2.
    spread : FlagImage
        Flags of camera 2, on all points that depend on the flagged pixel.
    noise : NoiseRows
        Variances of the rows of camera 2 that are interpolated.
    """

    light: Image
    variance: Image
    variance_fixed: Image
    flags: FlagImage
    coefficients: Image
    spread: FlagImage
    noise: NoiseRows = field(default_factory=NoiseRows)

    @classmethod
    def empty(
        cls, shape: tuple[int, int], orientation: str, *, rows: int | None = None
    ) -> PairWarp:
        """Arrays for frames of a shape (y, x).

        Parameters
        ----------
        shape : tuple of int
            Rows and columns of both cameras, as they are read.
        orientation : str
            How camera 2 is turned.
        rows : int, optional
            Rows of the variances and flags; default: all.

        Returns
        -------
        PairWarp
        """
        height, width = orient(np.empty(shape, np.uint8), orientation).shape
        part = (shape[0] if rows is None else rows, shape[1])
        return cls(
            np.empty(shape, np.float32),
            np.empty(part, np.float32),
            np.empty(part, np.float32),
            np.empty(part, np.uint8),
            np.empty((height + 4, width + 4), np.float32),
            np.empty((height, width), np.uint8),
        )


class Warp:
    """Camera 2 of one frame, ready to be read at the pixels of camera 1.

    Parameters
    ----------
    light : PairLight
    tables : MapTables
    noise : CameraNoise
        Of camera 2, turned as its image is.
    drift : tuple of float
        Translation (x, y) on top of the map; NaN leaves no pixel. [px]
    out : PairWarp
        Receives the rows.
    """

    def __init__(
        self,
        light: PairLight,
        tables: MapTables,
        noise: CameraNoise,
        drift: tuple[float, float],
        out: PairWarp,
    ) -> None:
        def turned(image: AnyArray) -> AnyArray:
            return np.ascontiguousarray(orient(image, tables.orientation))

        self.tables, self.out = tables, out
        self.drift = np.float32(drift[0]), np.float32(drift[1])
        self._light, self._noise, self._energy = turned(light.light[1]), noise, light.energy
        self._kept = -1
        spline_coefficients(self._light, out=out.coefficients)
        spread_flags(turned(light.flags[1]), out.spread)
        self.total, self.count = 0.0, 0

    def fill(self, start: int, stop: int, *, first: int = 0) -> None:
        """Fill the rows from `start` to `stop`; row `first` of the noise is stored as row 0."""
        out, tables = self.out, self.tables
        height = self._light.shape[0]
        needed = tables.rows_of(start, stop, float(self.drift[1]), height)
        if needed[1] - needed[0] > self._kept:
            self._kept = needed[1] - needed[0] + _SPARE
            out.noise.begin(self._light, self._noise, self._energy, rows=self._kept)
        out.noise.hold(*needed)
        total, count = sample_rows(
            out.coefficients,
            tables.displacement_x,
            tables.displacement_y,
            *self.drift,
            NOTHING_BAD,
            out.noise.variance,
            out.noise.fixed,
            out.spread,
            out.light,
            out.variance,
            out.variance_fixed,
            out.flags,
            first,
            start,
            stop,
        )
        self.total += total
        self.count += count

    @property
    def averaging(self) -> float:
        """Mean factor by which the interpolation lowers the variance, over the rows so far."""
        return self.total / self.count if self.count else 1.0
