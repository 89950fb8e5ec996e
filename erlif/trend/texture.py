"""What stands still in the image while the film moves: a fixed factor of the ratio.

The reflectance of a wall acts on films from 5 to 10 um alike to 10 %, as windows and flats do, and
less on thinner ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.core.statistics import covariance_root
from erlif.ratio.cells import LightCells
from erlif.trend.blocks import Region
from erlif.trend.factor import CellFactors, measure_factors
from erlif.trend.factor_kind import FactorKind, judge_kind
from erlif.trend.gap import GapMinimum, GapShape, gap_shapes
from erlif.trend.pattern import (
    CellPattern,
    Pattern,
    PatternSize,
    correlate_cells,
    find_size,
    map_pattern,
)
from erlif.trend.smooth_gap import fit_cells

_NOTED = 0.0015  # flat frames of small pictures leave as much
_SIGNIFICANT = 18.0  # rise of the logarithm of the likelihood: six standard deviations
_UNKNOWN = 0.95  # of the size: where as much is left, no cell shows the pattern
_GRID = 24  # places along and across a region


@dataclass(frozen=True)
class Texture:
    """A factor of the ratio that is fixed in the image.

    Attributes
    ----------
    found : PatternSize
        How large it is, and how far it is correlated.
    kind : FactorKind
        How it acts on other films; size and pattern are those at its film.
    factors : CellFactors | None
        By which it was found.
    pattern : Pattern | None
        What of it is taken out of the ratio; None where nothing is.
    means : CellPattern | None
        What is known of its means over cells; None where nothing is taken out.
    """

    found: PatternSize
    kind: FactorKind
    factors: CellFactors | None = None
    pattern: Pattern | None = None
    means: CellPattern | None = None

    @property
    def left(self) -> float:
        """Error of a pixel in the maps, the median where something is taken out. [1]"""
        if self.pattern is None:
            return self.found.size
        lower = self.pattern.std < _UNKNOWN * self.found.size
        return float(np.median(self.pattern.std[lower])) if lower.any() else self.found.size

    def in_cells(self, centres: tuple[Array, Array]) -> Array:
        """Covariance of its means over cells of these columns and rows, (cell, cell)."""
        return self.found.size**2 * correlate_cells(self.found.length, centres)

    def mapped(
        self, shape: tuple[int, int], curve: RatioCurve, means: CellPattern | None = None
    ) -> Texture:
        """Return a copy that is taken out of the ratio of an image of this shape, (rows, columns).

        `means` are those that the known gap of a joint shows.
        """
        assert self.factors is not None
        pattern = map_pattern(self.factors, self.found, shape, means)
        return replace(self, pattern=pattern.on_films(self.kind, curve), means=means)

    def over(self, region: Region, film: float, curve: RatioCurve) -> float:
        """Standard deviation of its mean over a region of this film [um]. [1]"""
        variance = self.found.size**2 * float(np.sum(np.square(self.kind.acts(film, curve))))
        for side in (region.rows, region.columns):
            places = np.linspace(side.start, side.stop - 1, _GRID)
            variance *= np.exp(
                -((np.subtract.outer(places, places) / self.found.length) ** 2)
            ).mean()
        return math.sqrt(variance)

    def parts_in(self, region: Region, *, along_x: bool) -> Array:
        """Independent parts of what is left of it, at even places of a region, (place, part). [1]

        Places lie line by line along sliding, which is image x with `along_x`.
        """
        sides = (region.columns, region.rows)
        even = [np.linspace(one.start, one.stop - 1, _GRID) for one in sides]
        if self.means is None:
            roots = [
                covariance_root(np.exp(-((np.subtract.outer(at, at) / self.found.length) ** 2)))
                for at in even
            ]
            parts = self.found.size * np.kron(*roots)
        else:
            columns, rows = np.meshgrid(*even, indexing="ij")
            apart = sum(
                np.subtract.outer(at.ravel(), cells) ** 2
                for at, cells in zip((columns, rows), self.means.centres, strict=True)
            )
            parts = covariance_root(self.means.covariance)[np.argmin(apart, axis=1)]
        table = parts.reshape(_GRID, _GRID, -1)
        return np.asarray((table if along_x else table.swapaxes(0, 1)).reshape(_GRID**2, -1))

    def in_numbers(
        self,
        parts: Array,
        region: Region,
        gap: GapMinimum,
        curve: RatioCurve,
        contact: GapShape,
        *,
        along_x: bool,
    ) -> Array:
        """Changes of the mean over a region, and of the minimum of a fitted gap, by the pattern.

        Both over those by a change of the ratio that is even over the region. In thick films the
        same change of the ratio is more film. The norm of a row is the even change of the ratio by
        which the number is off; products of rows are covariances, also those of several gaps.

        Parameters
        ----------
        parts : array, (place, part)
            As `parts_in` gives them for the region.
        region : Region
        gap : GapMinimum
        curve : RatioCurve
        contact : GapShape
        along_x : bool
            Whether image x is the sliding direction.

        Returns
        -------
        array, (2, part)
            By each part; those of the mean of an even film for both where the gap is not known. [1]
        """
        pixels = (region.columns, region.rows) if along_x else (region.rows, region.columns)
        start = np.array([one.start for one in pixels])
        half = 0.5 * (np.array([one.stop for one in pixels]) - 1 - start)
        places = np.linspace(-1, 1, _GRID)

        # weights of even places of the region in the mean, and in the least squares of the gap
        of_mean = of_gap = acts = np.ones(_GRID**2)
        if np.isfinite(gap.amplitudes).all():
            even = np.stack(np.meshgrid(places, places, indexing="ij")).reshape(2, -1)
            shapes = gap_shapes(even[0], even[1], contact)
            low, high = curve.thickness_range
            film = gap.amplitudes[: len(shapes)] @ shapes
            used = shapes * (film < high)
            place = gap.place if along_x else gap.place[::-1]
            at = (place - start) / half - 1
            at_place = gap_shapes(at[0], at[1], contact)
            of_mean = (film < high) / curve.slope(np.clip(film, low, high))
            of_gap = of_mean * (at_place @ np.linalg.solve(used @ shapes.T, used))
            acts = np.hypot(*self.kind.acts(np.clip(film, low, high), curve))

        weights = np.stack([of_mean, of_gap])
        return np.asarray((acts * weights) @ parts / weights.sum(axis=1, keepdims=True))


def find_texture(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    coarse: Texture | None = None,
) -> Texture | None:
    """Find what stands still in the image, beside marks and a smooth gap.

    Parameters
    ----------
    record : LightCells
        (frame, cell)
    centres : tuple of two arrays, (cell,)
        Columns and rows of the middles of the cells. [px]
    calibration : RatioCurve
        In the middle of the run.
    coarse : Texture, optional
        What larger cells show of it. How it acts is the same here.

    Returns
    -------
    Texture or None
        None where nothing is significant.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.ratio import cell_centres
    >>> from erlif.show.plots import example_calibration
    >>> empty = LightCells(*np.full((4, 4, 120), np.nan))
    >>> find_texture(empty, cell_centres((80, 96)), example_calibration()) is None
    True
    """
    cells = fit_cells(record, centres, calibration, 0.0 if coarse is None else coarse.found.size)
    if cells is None:
        return None
    kind = FactorKind.unknown(cells.middle) if coarse is None else coarse.kind
    factors = measure_factors(cells, kind, calibration)
    found = find_size(factors)
    if found.gain < _SIGNIFICANT or found.size < _NOTED:
        return None
    if coarse is None:
        expected = found.size**2 * correlate_cells(found.length, centres)
        kind = judge_kind(cells, expected, calibration)
        factors = measure_factors(cells, kind, calibration)
        found = find_size(factors)
    return Texture(found, kind, factors)
