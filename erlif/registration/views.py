"""The frames from which a map is made, laid over each other and summed over cells.

The rig is fixed, so one map serves a run: the cell sums of many frames are added up and solved as
if they were one frame, each frame read at its own drift.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from scipy import ndimage

from erlif.core.arrays import Array, Image
from erlif.core.errors import RegistrationError
from erlif.registration.drift import follow_drift
from erlif.registration.matching import (
    EE,
    GRADIENT_PRODUCTS,
    SCORES,
    WEIGHT,
    cell_centres,
    cell_sums,
    merge_cells,
    move_sums,
    solve_shift,
    without_noise,
)
from erlif.registration.pairs import Frames, Pair, Textures, laid_over, textures
from erlif.registration.settings import RegistrationSettings
from erlif.registration.surface import Cells, Surface, cell_weights
from erlif.registration.whitening import Filter, Spectra, measure_spectra, padded_size, whiten

FEWEST_CELLS: Final = 16
"""A surface needs this many cells with weight: four for each coefficient of an affine map."""

LARGE: Final = 400
"""Frames with a shorter side from this on have cells enough to be merged two by two. [px]"""

NEIGHBOURS: Final = 3
"""Side of the median of the expected rms. [merged cells]"""


def make_cells(sums: Array, step: int, surface: Surface, *, binning: int = 1) -> Cells:
    """Attach to cell sums where they were taken.

    Parameters
    ----------
    sums : array, (row, column, 11)
        From `cell_sums`, in binned pixels.
    step : int
        Side of a cell. [binned px]
    surface : Surface
        The displacement at which the sums were taken. [px]
    binning : int
        Binning of the frames.

    Returns
    -------
    Cells
        In full pixels.

    Raises
    ------
    RegistrationError
        If fewer than 16 cells have weight.
    """
    rows, cols = sums.shape[:2]
    centre = (binning - 1) / 2  # of a binned pixel, from the centre of its first full pixel
    x = cell_centres(cols * step, step) * binning + centre
    y = cell_centres(rows * step, step) * binning + centre

    # gradients per binned pixel become gradients per full pixel
    scaled = sums.copy()
    scaled[..., GRADIENT_PRODUCTS] /= binning**2
    scaled[..., SCORES] /= binning

    here_x, here_y = surface.evaluate(x, y)
    weight = cell_weights(scaled)
    count = (weight > 0).sum()
    if not count >= FEWEST_CELLS:
        raise RegistrationError(
            "Too little is left where both cameras have light and sound pixels: registration needs "
            f"{FEWEST_CELLS} cells of {step} px, got {count}. Check the masks, the exposure and "
            "the regions of interest."
        )
    return Cells(scaled, x, y, here_x, here_y, weight)


def expected_rms(sums: Array) -> Array:
    """Rms difference of the textures to be expected in each cell.

    Parameters
    ----------
    sums : array, (row, column, 11)
        From `cell_sums`.

    Returns
    -------
    array, (row, column)
        The root of the median of the mean squares around the cell: dust in one cell does not
        raise it. [1]
    """
    merged = merge_cells(sums, 2)
    n = merged[..., WEIGHT]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(n > 0, merged[..., EE] / n, 0)
    rms = np.sqrt(ndimage.median_filter(mean, NEIGHBOURS, mode="nearest"))

    rms = np.repeat(np.repeat(rms, 2, axis=0), 2, axis=1)
    return np.asarray(rms[: sums.shape[0], : sums.shape[1]])


class Summed(NamedTuple):
    """Sums over the frames at a dense displacement.

    Attributes
    ----------
    sums : Array
        (row, column, 11)
    spectra : Spectra | None
        Spectra of the textures; None if they are filtered already.
    mean_drift : Array
        (2,), x first: what the displacement must be moved by for the sums to hold. [px]
    """

    sums: Array

    spectra: Spectra | None

    mean_drift: Array


@dataclass(frozen=True)
class Seen:
    """Everything summed over the chosen frames at one surface.

    Attributes
    ----------
    sums : Array
        (row, column, 11)
    spectra : Spectra | None
        Spectra of the textures; None if they are filtered already.
    surface : Surface
        Where the sums hold: the given surface and the mean drift that was found. [px]
    """

    sums: Array

    spectra: Spectra | None

    surface: Surface


class Views:
    """The frames from which the map is made, at full resolution, and the drift of each.

    A single pair is kept in memory. Of several, each is read, prepared and dropped in every pass.
    """

    def __init__(self, frames: Frames, first: Pair, settings: RegistrationSettings) -> None:
        self.frames = frames
        self.settings = settings
        self.shape = (first.reference.shape[0], first.reference.shape[1])
        self.shape_moving = (first.moving.shape[0], first.moving.shape[1])
        self.merge = 2 if min(self.shape) >= LARGE else 1
        self.drift = np.zeros((len(frames.chosen), 2))
        self._drift_known = frames.count == 1
        self._whitening: Filter | None = None
        self._single = textures(first, 1, settings.threads) if frames.count == 1 else None

    def filter_through(self, whitening: Filter) -> None:
        """Filter the textures from now on."""
        self._whitening = whitening
        if self._single is not None:
            self._single = self._filtered(self._single, whitening)

    def _filtered(self, plain: Textures, whitening: Filter) -> Textures:
        """Both textures through the filter."""
        grid = whitening.on_grid(padded_size(plain.a.shape))
        a, wa = whiten(plain.a, plain.weight, grid, threads=self.settings.threads)
        if plain.b.shape != plain.a.shape:
            grid = whitening.on_grid(padded_size(plain.b.shape))
        b, wb = whiten(plain.b, plain.weight_b, grid, threads=self.settings.threads)
        return Textures(a, wa, b, wb)

    def _each(self, dx: Image, dy: Image) -> Iterator[tuple[int, Textures]]:
        """Number and textures of the frames that have a drift, which the first pass measures."""
        if self._single is not None:
            yield 0, self._single
            return

        for number, pair in enumerate(self.frames.pick(self.frames.chosen)):
            if not self._drift_known:
                found = follow_drift(dx, dy, pair, threads=self.settings.threads)
                self.drift[number] = found.dx, found.dy
            if np.isnan(self.drift[number]).any():
                continue
            view = textures(pair, 1, self.settings.threads)
            if self._whitening is not None:
                view = self._filtered(view, self._whitening)
            yield number, view
        self._drift_known = True

    def sums(self, dx: Image, dy: Image, scale: Array | None) -> Summed:
        """Go through the frames once and add up their sums.

        Parameters
        ----------
        dx, dy : array, (y, x), float32
            Displacement at zero drift. [px]
        scale : array, (row, column), optional
            Expected rms difference of each cell, see `cell_sums`. [1]

        Returns
        -------
        Summed

        Raises
        ------
        RegistrationError
            If in none of the frames the cameras share texture.
        """
        threads = self.settings.threads
        total: Array | None = None
        spectra: Spectra | None = None
        for number, view in self._each(dx, dy):
            here = (float(self.drift[number, 0]), float(self.drift[number, 1]))
            b = laid_over(view.spline(threads), dx, dy, here, threads)
            sums = cell_sums(
                view.a, view.weight, b, self.settings.step, scale=scale, threads=threads
            )
            if self._whitening is None:
                one = measure_spectra(view.a, view.weight, b)
                spectra = one if spectra is None else spectra + one

            # a frame of many gets what is left of its drift; the map gets what they have in common
            if self.frames.count > 1:
                shift = solve_shift(sums)
                self.drift[number] += shift
                sums = move_sums(sums, *shift)
            total = sums if total is None else total + sums

        if total is None:
            raise RegistrationError(
                f"None of the {len(self.frames.chosen)} frames from which the map is to be made "
                "shows texture that both cameras share. Check the exposure, the focus and that the "
                "frames of the two cameras belong together."
            )
        mean = np.nanmean(self.drift, axis=0)
        self.drift -= mean
        return Summed(total, spectra, mean)

    def look(self, surface: Surface, *, scale: Array | None = None) -> Seen:
        """Go through the frames once, laid over each other by the surface and each one's drift."""
        dx, dy = surface.on_pixels(self.shape)
        total, spectra, mean = self.sums(dx, dy, scale)
        return Seen(total, spectra, surface.moved(float(mean[0]), float(mean[1])))

    def cells(self, sums: Array, surface: Surface, slope: float) -> Cells:
        """The cells from which a surface is made, free of the noise of the gradients."""
        merged = without_noise(merge_cells(sums, self.merge), slope)
        return make_cells(merged, self.settings.step * self.merge, surface)
