"""Camera 2 of one frame pair on the pixels of camera 1, row by row.

The reference is `erlif.registration.align_frames`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image
from erlif.core.flags import Flag
from erlif.passes.light import PairLight
from erlif.registration import CameraMap, orient, spline_coefficients
from erlif.registration.alignment import spread_flags
from erlif.registration.interpolation import NOTHING_BAD, sample_rows


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
    """

    displacement_x: Image
    displacement_y: Image
    variance: Image
    flags: FlagImage
    orientation: str


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
    return MapTables(
        np.ascontiguousarray(camera_map.displacement_x, np.float32),
        np.ascontiguousarray(camera_map.displacement_y, np.float32),
        np.square(camera_map.displacement_std, dtype=float).astype(np.float32),
        flags.astype(np.uint8),
        camera_map.settings.orientation,
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
    """

    light: Image
    variance: Image
    variance_fixed: Image
    flags: FlagImage
    coefficients: Image
    spread: FlagImage

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
    drift : tuple of float
        Translation (x, y) on top of the map; NaN leaves no pixel. [px]
    out : PairWarp
        Receives the rows.
    """

    def __init__(
        self, light: PairLight, tables: MapTables, drift: tuple[float, float], out: PairWarp
    ) -> None:
        def turned(image: AnyArray) -> AnyArray:
            return np.ascontiguousarray(orient(image, tables.orientation))

        self.tables, self.out = tables, out
        self.drift = np.float32(drift[0]), np.float32(drift[1])
        self.variance, self.fixed = turned(light.variance[1]), turned(light.variance_fixed[1])
        spline_coefficients(turned(light.light[1]), out=out.coefficients)
        spread_flags(turned(light.flags[1]), out.spread)
        self.total, self.count = 0.0, 0

    def fill(self, start: int, stop: int, *, first: int = 0) -> None:
        """Fill the rows from `start` to `stop`; row `first` of the noise is stored as row 0."""
        out, tables = self.out, self.tables
        total, count = sample_rows(
            out.coefficients,
            tables.displacement_x,
            tables.displacement_y,
            *self.drift,
            NOTHING_BAD,
            self.variance,
            self.fixed,
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
