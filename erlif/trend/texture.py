"""What stands still in the image while the film moves: a fixed factor of the ratio.

The reflectance of a wall acts on films from 5 to 10 um alike to 10 %, as windows and flats do, and
less on thinner ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.calibration import RatioCurve
from erlif.core.arrays import Array
from erlif.ratio.cells import LightCells
from erlif.trend.blocks import Region
from erlif.trend.factor import FactorKind, measure_factors
from erlif.trend.gap import GapMinimum, GapShape, gap_shapes
from erlif.trend.pattern import Pattern, PatternSize, correlate_cells, find_size, map_pattern

_NOTED = 0.0015  # flat frames of small pictures leave as much
_SIGNIFICANT = 18.0  # rise of the logarithm of the likelihood: six standard deviations
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
    pattern : Pattern | None
        What of it is taken out of the ratio; None where nothing is.
    """

    found: PatternSize
    kind: FactorKind
    pattern: Pattern | None = None

    @property
    def left(self) -> float:
        """Error of a pixel in the maps, the median over the picture. [1]"""
        return self.found.size if self.pattern is None else float(np.median(self.pattern.std))

    def in_cells(self, centres: tuple[Array, Array]) -> Array:
        """Covariance of its means over cells of these columns and rows, (cell, cell)."""
        return self.found.size**2 * correlate_cells(self.found.length, centres)

    def over(self, region: Region, film: float, curve: RatioCurve) -> float:
        """Standard deviation of its mean over a region of this film [um]. [1]"""
        variance = self.found.size**2 * float(np.sum(np.square(self.kind.acts(film, curve))))
        for side in (region.rows, region.columns):
            places = np.linspace(side.start, side.stop - 1, _GRID)
            variance *= np.exp(
                -((np.subtract.outer(places, places) / self.found.length) ** 2)
            ).mean()
        return math.sqrt(variance)

    def in_numbers(
        self,
        region: Region,
        gap: GapMinimum,
        curve: RatioCurve,
        contact: GapShape,
        *,
        along_x: bool,
    ) -> Array:
        """Changes of the mean over a region, and of the minimum of a fitted gap, by the pattern.

        Both over those by a change of the ratio that is even over the region. In thick films the
        same change of the ratio is more film. The norm of a row is the share of the size that is
        the error of the number; products of rows are covariances, also those of several gaps.

        Parameters
        ----------
        region : Region
        gap : GapMinimum
        curve : RatioCurve
        contact : GapShape
        along_x : bool
            Whether image x is the sliding direction.

        Returns
        -------
        array, (2, part)
            By independent parts of the pattern of variance 1; those of the mean of an even film for
            both where the gap is not known.
        """
        pixels = (region.columns, region.rows) if along_x else (region.rows, region.columns)
        start = np.array([one.start for one in pixels])
        half = 0.5 * (np.array([one.stop for one in pixels]) - 1 - start)
        places = np.linspace(-1, 1, _GRID)
        apart = np.subtract.outer(places, places)
        powers = [
            np.linalg.eigh(np.exp(-((side * apart / self.found.length) ** 2))) for side in half
        ]
        along, across = (axes * np.sqrt(np.maximum(power, 0.0)) for power, axes in powers)

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

        found = []
        for weights in (of_mean, of_gap):
            table = (acts * weights).reshape(_GRID, _GRID)
            found.append((along.T @ table @ across).ravel() / weights.sum())
        return np.stack(found)


def find_texture(
    record: LightCells,
    centres: tuple[Array, Array],
    calibration: RatioCurve,
    *,
    shape: tuple[int, int] | None = None,
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
    shape : tuple of int, optional
        Rows and columns of the image, where its most likely value at each pixel is asked for: of
        cells that are small enough to show it.

    Returns
    -------
    Texture or None
        None where nothing is significant.

    Examples
    --------
    Four frames are too few:

    >>> from erlif.show.plots import example_calibration
    >>> empty, places = LightCells(*np.full((4, 4, 120), np.nan)), np.zeros(120)
    >>> find_texture(empty, (places, places), example_calibration()) is None
    True
    """
    factors = measure_factors(record, centres, calibration)
    if factors is None:
        return None
    found = find_size(factors)
    if found.gain < _SIGNIFICANT or found.size < _NOTED:
        return None
    if shape is None:
        return Texture(found, factors.kind)
    pattern = map_pattern(factors, found, shape)
    return Texture(found, factors.kind, pattern.on_films(factors.kind, calibration))
