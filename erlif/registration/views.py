"""The frames from which a map is made, laid over each other and summed over cells.

The rig is fixed, so one map serves a run: the cell sums of many frames are added up and solved as
if they were one frame, each frame read at its own drift.
"""

from collections.abc import Iterator
from functools import reduce
from operator import add
from typing import Final, NamedTuple

import numpy as np
from scipy import ndimage

from erlif.core.arrays import Array, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.registration.drift import LARGE, rough_drift
from erlif.registration.interpolation import laid_over
from erlif.registration.matching import (
    EE,
    GRADIENT_PRODUCTS,
    SCORES,
    WEIGHT,
    cell_sums,
    centres_along_axis,
    merge_cells,
    move_sums,
    solve_shift,
    without_noise,
)
from erlif.registration.pairs import Pair, PairSeries, Textures, textures
from erlif.registration.surface import Cells, Surface, cell_weights
from erlif.registration.whitening import (
    Filter,
    Spectra,
    measure_spectra,
    padded_size,
    whiten_texture,
)

# A surface needs this many cells with weight: four for each coefficient of an affine map.
FEWEST_CELLS: Final = 16

# Pixels of all chosen frames up to which their textures are kept: some 300 MB. [px]
MOST_KEPT: Final = 20_000_000

# Blocks whose spectra determine the filter; no further frames are read for it.
ENOUGH_BLOCKS: Final = 200

# Side of the median of the expected rms. [merged cells]
NEIGHBOURS: Final = 3


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
    x = centres_along_axis(cols * step, step) * binning + centre
    y = centres_along_axis(rows * step, step) * binning + centre

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


class TextureView(NamedTuple):
    """The textures of one frame, ready to be laid over each other.

    Attributes
    ----------
    a : Image
        Texture of camera 1, (y, x). [1]
    weight : Image | Mask
        Its weight; a mask where it is 0 or 1 everywhere. [1]
    spline : tuple[Image, Mask]
        Spline coefficients of camera 2, and its pixels without weight.
    """

    a: Image
    weight: Image | Mask
    spline: tuple[Image, Mask]


class TextureViews:
    """The frames from which the map is made, at full resolution, and the drift of each.

    Each frame is read and prepared once, and its textures are kept. Frames that are too many or too
    large for that are read again in every pass.
    """

    def __init__(self, frames: PairSeries, first: Pair, *, number: int = 0) -> None:
        self.frames = frames
        self.settings = settings = frames.settings
        self.shape = (first.reference.shape[0], first.reference.shape[1])
        self.shape_moving = (first.moving.shape[0], first.moving.shape[1])
        # large frames have cells enough to be merged two by two
        self.merge = 2 if min(self.shape) >= LARGE else 1
        self._keep = len(frames.chosen) * first.reference.size <= MOST_KEPT
        self._whitening: Filter | None = None
        self._grids: dict[tuple[int, int], Image] = {}

        # the start was made from one frame, which is read already; the drift of the others is
        # found when they are
        self._plain = {number: textures(first, 1, settings.threads)}
        self._views: dict[int, TextureView] = {}
        self.drift = np.full((len(frames.chosen), 2), np.nan)
        self.drift[number] = 0
        self._unknown = set(range(len(frames.chosen))) - {number}

    def filter_through(self, whitening: Filter) -> None:
        """Filter the textures from now on."""
        self._whitening = whitening
        self._views.clear()
        self._grids.clear()

    def _filtered(self, texture: Image, weight: Image, whitening: Filter) -> tuple[Image, Image]:
        """A texture and its weight through the filter."""
        size = padded_size(texture.shape)
        if size not in self._grids:
            self._grids[size] = whitening.on_grid(size)
        # a frame that is kept filtered is not needed as it was
        out = (texture, weight) if self._keep else None
        return whiten_texture(
            texture, weight, self._grids[size], threads=self.settings.threads, out=out
        )

    def _prepared(self, plain: Textures) -> TextureView:
        """A frame as it is summed: filtered, if there is a filter, with its spline."""
        if self._whitening is not None:
            plain = Textures(
                *self._filtered(plain.a, plain.weight, self._whitening),
                *self._filtered(plain.b, plain.weight_b, self._whitening),
            )
        # frames that are kept take less memory with masks
        mask = plain.weight > 0
        weight = mask if np.array_equal(mask, plain.weight) else plain.weight
        return TextureView(plain.a, weight, plain.spline(self.settings.threads))

    def _each_plain(self, dx: Image, dy: Image) -> Iterator[tuple[int, Textures]]:
        """Number and unfiltered textures of the frames that are not kept filtered.

        The first reading measures the drift; frames without one are left out.
        """
        for number in sorted(self._plain):
            yield number, self._plain[number]

        known = self._plain.keys() | self._views.keys()
        useless = {n for n in np.nonzero(np.isnan(self.drift[:, 0]))[0] if n not in self._unknown}
        others = sorted(set(range(len(self.frames.chosen))) - known - useless)
        pairs = self.frames.pick([self.frames.chosen[number] for number in others])
        for number in others:
            # no name here holds a frame while it is filtered, or while the next is read
            handed = [textures(next(pairs), 1, self.settings.threads)]
            if number in self._unknown:
                self._unknown.remove(number)
                self.drift[number] = rough_drift(dx, dy, handed[0], threads=self.settings.threads)
                if np.isnan(self.drift[number]).any():
                    continue
            yield number, handed.pop()

    def _each(self, dx: Image, dy: Image) -> Iterator[tuple[int, TextureView]]:
        """Number and textures of the frames that have a drift, ready to be summed."""
        for number in sorted(self._views):
            yield number, self._views[number]

        for number, plain in self._each_plain(dx, dy):
            view = self._prepared(plain)
            del plain
            if self._keep:
                self._views[number] = view
                self._plain.pop(number, None)
            yield number, view

    def _sum(
        self, number: int, view: TextureView, dx: Image, dy: Image, scale: Array | None
    ) -> tuple[Array, Image]:
        """Sum the cells of one frame at its drift, update the drift, return camera 2 laid over."""
        threads = self.settings.threads
        here = (float(self.drift[number, 0]), float(self.drift[number, 1]))
        b = laid_over(view.spline, dx, dy, here, threads)
        weight = view.weight.astype(np.float32, copy=False)
        sums = cell_sums(view.a, weight, b, self.settings.step, scale=scale, threads=threads)

        # a frame of many gets what is left of its drift, free of the noise of the gradients; the
        # map gets what the frames have in common, so no frame asks for a translation of its own
        if self.frames.count > 1:
            self.drift[number] += solve_shift(without_noise(sums))
            sums = move_sums(sums, *solve_shift(sums))
        return sums, b

    def _centre_drift(self) -> Array:
        """Make the mean drift of the frames 0 and return what it was, x first. [px]"""
        mean = np.asarray(np.nanmean(self.drift, axis=0))
        self.drift -= mean
        return mean

    def compare(self, surface: Surface) -> tuple[Array, Surface, Spectra]:
        """Sums and spectra of the unfiltered textures, over as many frames as the spectra need.

        Parameters
        ----------
        surface : Surface
            Lays camera 2 over camera 1 in the frame from which the start was made. [px]

        Returns
        -------
        array, (row, column, 11)
            Sums over the frames.
        Surface
            Where they hold: the given surface and the mean drift. [px]
        Spectra
        """
        dx, dy = surface.on_pixels(self.shape)
        total = np.zeros(0)
        spectra: Spectra | None = None
        for number, plain in self._each_plain(dx, dy):
            view = TextureView(plain.a, plain.weight, plain.spline(self.settings.threads))
            sums, b = self._sum(number, view, dx, dy, None)
            one = measure_spectra(plain.a, plain.weight, b)
            total = sums if spectra is None else total + sums
            spectra = one if spectra is None else spectra + one
            if self._keep:
                self._plain[number] = plain
            if spectra.blocks >= ENOUGH_BLOCKS:
                break

        assert spectra is not None  # the frame of the start has a drift
        return total, surface.moved(*self._centre_drift()), spectra

    def sums(self, dx: Image, dy: Image, scale: Array | None) -> tuple[Array, Array]:
        """Go through the frames once and add up their sums.

        Parameters
        ----------
        dx, dy : array, (y, x), float32
            Displacement at zero drift. [px]
        scale : array, (row, column), optional
            Expected rms difference of each cell, see `cell_sums`. [1]

        Returns
        -------
        array, (row, column, 11)
            Sums over the frames.
        array, (2,)
            Mean drift, x first: what the displacement must be moved by for the sums to hold. [px]
        """
        frames = self._each(dx, dy)  # the frame of the start at least, which has a drift
        total = reduce(add, (self._sum(number, view, dx, dy, scale)[0] for number, view in frames))
        return total, self._centre_drift()

    def look(self, surface: Surface, *, scale: Array | None = None) -> tuple[Array, Surface]:
        """Go through the frames once, laid over each other by the surface and each one's drift."""
        total, mean = self.sums(*surface.on_pixels(self.shape), scale)
        return total, surface.moved(*mean)

    def cells(self, sums: Array, surface: Surface, slope: float) -> Cells:
        """The cells from which a surface is made, free of the noise of the gradients."""
        merged = without_noise(merge_cells(sums, self.merge), slope)
        return make_cells(merged, self.settings.step * self.merge, surface)
