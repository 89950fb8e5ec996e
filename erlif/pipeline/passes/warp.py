"""Camera 2 of one frame pair on the pixels of camera 1, in bands of rows.

`erlif.registration.align_frames` does the same for whole images of the variances; here few rows of
them are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.flags import Flag
from erlif.correction import NoiseTables, PairLight
from erlif.correction.light import fill_noise
from erlif.registration import CameraMap, orient
from erlif.registration.alignment import spread_flags
from erlif.registration.interpolation import (
    FARTHEST,
    NOTHING_BAD,
    filter_rows,
    filtered_columns,
    mirror_rows,
    sample_rows,
)


@dataclass(frozen=True)
class MapTables:
    """Tables of the camera map for the alignment, the same in all frames; images are (y, x).

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
        Lowest row of camera 2 without drift that this row or one below it needs, and the highest
        that this row or one above it needs, (2, y); infinite where there is none. [px]
    """

    displacement_x: Image
    displacement_y: Image
    variance: Image
    flags: FlagImage
    orientation: str
    rows: Array

    def rows_for(self, drift_y: float, height: int) -> tuple[AnyArray, AnyArray]:
        """Range of rows of camera 2 whose noise each row of camera 1 needs.

        Neither number falls from row to row. Camera 2 is read as far as camera 1 at least, so that
        rows above may be used for something else.

        Parameters
        ----------
        drift_y : float
            [px]
        height : int
            Rows of camera 2.

        Returns
        -------
        tuple of two array, (y)
            The first one, and the one after the last.
        """
        count = self.rows.shape[1]
        if not np.isfinite(drift_y):
            return np.zeros(count, int), np.zeros(count, int)

        # a point lies between two rows, and single precision may round it to the next one
        around = np.floor(self.rows + drift_y) + np.array([[-1.0], [3.0]])
        below = np.arange(1.0, count + 1)
        low, high = np.clip([around[0], np.maximum(around[1], below)], 0, height).astype(int)
        return np.minimum(low, high), high


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
    row = np.arange(along_y.shape[0], dtype=float)
    return MapTables(
        np.ascontiguousarray(camera_map.displacement_x, np.float32),
        along_y,
        np.square(camera_map.displacement_std, dtype=float).astype(np.float32),
        flags.astype(np.uint16),
        camera_map.settings.orientation,
        np.stack(
            [
                np.minimum.accumulate((row + lowest)[::-1])[::-1],
                np.maximum.accumulate(row + highest),
            ]
        ),
    )


def turn_noise(noise: NoiseTables, orientation: str) -> NoiseTables:
    """Tables of the noise for an image that is turned first.

    Parameters
    ----------
    noise : NoiseTables
    orientation : str
        One of `erlif.registration.settings.ORIENTATIONS`.

    Returns
    -------
    NoiseTables
    """
    if orientation == "normal":
        return noise

    def turned(image: Image) -> Image:
        return np.ascontiguousarray(orient(image, orientation))

    return NoiseTables(
        turned(noise.per_flat),
        turned(np.broadcast_to(noise.dark_var, noise.per_flat.shape)),
        turned(noise.flat_var),
        turned(noise.dry_light),
        turned(noise.dry_var),
        noise.numbers,
    )


class NoiseRows:
    """Both variances of some rows of an image, computed when they are first needed.

    Row j is stored as row j modulo the number of rows that are kept.
    """

    def __init__(self) -> None:
        self.variance: Image = np.empty((0, 0), np.float32)
        """New in every frame. [DN2]"""
        self.fixed: Image = np.empty((0, 0), np.float32)
        """Of dark and flat. [DN2]"""
        self._fill: Callable[[int, int], object] = lambda start, stop: None
        self._first = self._stop = 0

    def begin(self, light: Image, noise: NoiseTables, energy: Array, *, rows: int) -> None:
        """Start with another image.

        Parameters
        ----------
        light : array, (y, x)
            [DN]
        noise : NoiseTables
        energy : array, (1)
            Energy of the pulse over the mean of the run. [1]
        rows : int
            Rows to keep at least.
        """
        rows = min(rows, light.shape[0])
        if self.variance.shape[0] < rows or self.variance.shape[1] != light.shape[1]:
            self.variance, self.fixed = (
                np.empty((rows, light.shape[1]), np.float32) for _ in range(2)
            )
        tables, scale = tuple(noise), np.float32(energy[0])
        self._fill = lambda start, stop: fill_noise(
            light, tables, scale, self.variance, self.fixed, start, stop
        )
        self._first = self._stop = 0

    def hold(self, first: int, stop: int) -> None:
        """Compute the variances of the rows from `first` to `stop` that are not held yet."""
        # rows that are there stay; a gap, or rows above, mean a new beginning
        if not self._first <= first <= self._stop:
            self._first = self._stop = first
        if stop > self._stop:
            self._fill(self._stop, stop)
            self._stop = stop
            self._first = max(self._first, stop - self.variance.shape[0])


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
        height, width = orient(np.empty(shape, np.uint16), orientation).shape
        part = (shape[0] if rows is None else rows, shape[1])
        return cls(
            np.empty(shape, np.float32),
            np.empty(part, np.float32),
            np.empty(part, np.float32),
            np.empty(part, np.uint16),
            np.empty((height + 4, width + 4), np.float32),
            np.empty((height, width), np.uint16),
        )


class Warp:
    """Camera 2 of one frame, ready to be read at the pixels of camera 1.

    Parameters
    ----------
    light : PairLight
    tables : MapTables
    noise : NoiseTables
        Of camera 2, turned as its image is.
    drift : tuple of float
        Translation (x, y) on top of the map; NaN leaves no pixel. [px]
    out : PairWarp
        Receives the rows.
    band : int, optional
        Most rows that are filled in one call; default: all.
    """

    def __init__(
        self,
        light: PairLight,
        tables: MapTables,
        noise: NoiseTables,
        drift: tuple[float, float],
        out: PairWarp,
        *,
        band: int | None = None,
    ) -> None:
        def turned(image: AnyArray) -> AnyArray:
            return np.ascontiguousarray(orient(image, tables.orientation))

        self.tables, self.out = tables, out
        self.drift = np.float32(drift[0]), np.float32(drift[1])
        image = turned(light.light[1])
        filtered_columns(image, out=out.coefficients)
        self._filtered = 0
        spread_flags(turned(light.flags[1]), out.spread)
        self.total, self.count = 0.0, 0

        # the noise of as many rows as one band needs at most
        self._low, self._high = tables.rows_for(float(self.drift[1]), image.shape[0])
        ahead = min(band or self._low.size, self._low.size) - 1
        kept = int((self._high[ahead:] - self._low[: self._low.size - ahead]).max())
        out.noise.begin(image, noise, light.energy, rows=max(kept, 1))

    def fill(self, start: int, stop: int, *, first: int = 0) -> None:
        """Fill the rows from `start` to `stop`; row `first` of the noise is stored as row 0."""
        out, tables = self.out, self.tables
        needed = int(self._high[stop - 1])
        out.noise.hold(int(self._low[start]), needed)
        self._filter(needed)
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

    def _filter(self, stop: int) -> None:
        """Filter the coefficients of the rows before `stop` that are not filtered yet."""
        coefficients = self.out.coefficients
        height = coefficients.shape[0] - 4
        stop = min(max(stop, 3), height)  # the margin above mirrors three rows
        if stop > self._filtered:
            filter_rows(coefficients, self._filtered, stop)
            if self._filtered == 0 or stop == height:
                mirror_rows(coefficients)
            self._filtered = stop

    @property
    def averaging(self) -> float:
        """Mean factor by which the interpolation lowers the variance, over the rows so far."""
        return self.total / self.count if self.count else 1.0
