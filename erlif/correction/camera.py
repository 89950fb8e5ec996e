"""One camera, measured: darks and flats in one pass, before gain and read noise are known.

Pixels that no light reaches show the dark level of the camera in every frame of a run.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray, Counts, Image, Mask
from erlif.correction.darks import Background, Darks, declare_darks, reduce_background, reduce_darks
from erlif.correction.flats import reduce_flats, sum_light
from erlif.correction.photon_transfer import LightLevel, reduce_level
from erlif.correction.saturation import Histogram
from erlif.correction.view import FrameView

# Share of the saturation below which a pixel of a flat is linear.
_CLEAR_OF_SATURATION = 0.95


@dataclass(frozen=True)
class CameraMeasurement:
    """Results of the darks and flats of one camera that need no gain.

    Attributes
    ----------
    darks : Darks
    full_scale : int
        Largest possible count. [DN]
    saturation : int
        Count at which the camera saturates. [DN]
    levels : tuple[LightLevel, ...]
        Points of the photon transfer curve, of light levels with two and more pages.
    flat_light : AnyArray | None
        Light of all flat pages together, (y, x); None without a flat. [DN]
    flat_pages : int
        Number of flat pages.
    background : Background | None
        Light of the dry joint; None where none was recorded.
    level_pages : tuple[int, ...]
        Flat pages of each light level.
    view : FrameView | None
        Mean of the frames with which darks and flats are compared; None where there are none.
    unlit : UnlitPixels | None
        Pixels that no light reaches in these frames; None where there are none.
    """

    darks: Darks
    full_scale: int
    saturation: int
    levels: tuple[LightLevel, ...] = ()
    flat_light: AnyArray | None = None
    flat_pages: int = 0
    background: Background | None = None
    level_pages: tuple[int, ...] = ()
    view: FrameView | None = None
    unlit: UnlitPixels | None = None

    @property
    def has_flat(self) -> bool:
        """Whether the response of the pixels was recorded."""
        return self.flat_light is not None


def measure_camera(
    *,
    darks: Iterable[Counts] | float,
    flats: Iterable[Counts],
    histogram: Histogram,
    shape: tuple[int, int],
    camera: str,
    background: Iterable[Counts] = (),
) -> CameraMeasurement:
    """Reduce the darks and flats of one camera; every page is read once.

    Parameters
    ----------
    darks : iterable of array, (y, x), or float
        Counts of dark pages, or the dark level where none were recorded. [DN]
    flats : iterable of array, (y, x)
        Counts of flat pages; empty where none were recorded. [DN]
    histogram : array of int, (full scale + 1,)
        Pixels by count in some frames, searched for saturation below full scale.
    shape : (rows, columns)
        [px]
    camera : str
        Name in messages, "camera1".
    background : iterable of array, (y, x)
        Counts of the dry joint under the laser; empty where none were recorded.

    Returns
    -------
    CameraMeasurement

    Raises
    ------
    FrameError
        If no flat page is well above dark and below saturation, or the pages of the dry joint
        are half as bright as the frames.

    Examples
    --------
    >>> import numpy as np
    >>> measured = measure_camera(
    ...     darks=64.0, flats=[], histogram=np.zeros(4096, np.int64), shape=(4, 4), camera="camera1"
    ... )
    >>> measured.saturation, measured.has_flat
    (4095, False)
    """
    # darks first: the flats are light above them
    reduced = declare_darks(darks, shape) if isinstance(darks, float) else reduce_darks(darks)
    stacks, saturation = reduce_flats(flats, dark=reduced.mean, histogram=histogram, camera=camera)
    dry = reduce_background(background, darks=reduced, histogram=histogram, camera=camera)

    # near saturation counts are clipped in some pages only, which lowers the temporal variance
    levels = []
    for stack in stacks:
        usable = stack.mean + reduced.mean < _CLEAR_OF_SATURATION * saturation
        usable &= ~reduced.bad
        level = reduce_level(stack, usable)
        if level is not None:
            levels.append(level)
    return CameraMeasurement(
        reduced,
        histogram.size - 1,
        saturation,
        tuple(levels),
        sum_light(stacks) if stacks else None,
        sum(stack.count for stack in stacks),
        dry,
        tuple(stack.count for stack in stacks),
    )


# Light below which a pixel counts as dark, over that of the brighter pixels. [1]
_FAR_BELOW = 0.05

# Light of a pixel of the flats that does not respond, over their median. [1]
_NO_RESPONSE = 0.02

# Share of the pixels that are darker than these brighter ones. [1]
_BRIGHTER = 0.9

# Standard deviations of a dark count by which that light must exceed it: pixels are then not chosen
# by their noise.
_CLEAR = 4.0

# Around a dark pixel that is preferred: at the edge of the light it may be lit by a displacement.
_NEIGHBOURS = np.ones((7, 7), np.uint8)

_FEWEST = 3  # pixels: fewer do not show whether their noise is that of the dark

_NEAR = 8  # pixels from a dark pixel to its neighbour, at most

_MOSTLY = 0.5  # share of the pixels that have neighbours from which on the others are left out

# Pixels at most, in runs of neighbours: their mean is then good to a few hundredths of a count.
_MOST, _RUN = 4096, 8


@dataclass(frozen=True)
class UnlitPixels:
    """Pixels of one camera that are dark in all frames that were looked at.

    Attributes
    ----------
    place : array of int, (pixel,)
        Their numbers, row by row.
    near : array of bool, (pixel - 1,)
        Which of them show their noise by the difference from the next one.
    dark : Image
        Their dark, (pixel,). [DN]
    dark_std : float
        Standard deviation of the mean of the dark, from page to page. [DN]
    variance : float
        Variance of a count less its dark where there is no light. [DN2]
    variance_std : float
        Its standard deviation, as far as it is the same in all frames. [DN2]
    light : float
        Median light of the pixels that are lit. [DN]
    """

    place: npt.NDArray[np.intp]
    near: Mask
    dark: Image
    dark_std: float
    variance: float
    variance_std: float
    light: float

    def read(self, counts: Counts) -> tuple[float, float]:
        """Mean of the pixels above their dark in one frame, and their variance.

        Parameters
        ----------
        counts : array, (y, x)
            [DN]

        Returns
        -------
        mean : float
            [DN]
        variance : float
            By the differences of neighbours, so that uneven light does not enter. [DN2]
        """
        above = counts.ravel()[self.place] - self.dark
        return float(above.mean()), float(np.mean(np.diff(above)[self.near] ** 2) / 2)


def find_unlit(
    highest: AnyArray, histogram: Histogram, darks: Darks, flat: AnyArray | None = None
) -> UnlitPixels | None:
    """Find the pixels of a camera that no light reaches in a recording.

    Parameters
    ----------
    highest : array, (y, x)
        Highest count of each pixel in some frames. [DN]
    histogram : array of int, (full scale + 1,)
        Pixels by count in these frames.
    darks : Darks
        Of the camera.
    flat : array, (y, x), optional
        Light of the flats, whose dark pixels serve where an offset raises all of the frames. [DN]

    Returns
    -------
    UnlitPixels or None
        None where the darks have fewer than two pages, all pixels are lit, or the light is too weak
        for a distinction.

    Examples
    --------
    >>> from erlif.correction import reduce_darks
    >>> rng = np.random.default_rng(1)
    >>> darks = reduce_darks(np.rint(rng.normal(64.0, 2.0, (8, 40, 40))))
    >>> highest = np.full((40, 40), 1000, np.uint16)
    >>> highest[:4, :4] = 68
    >>> found = find_unlit(highest, np.bincount(highest.ravel(), minlength=4096), darks)
    >>> found.place.size, round(found.light)
    (16, 936)
    """
    if darks.temporal_var is None or not histogram.any():
        return None
    below = np.cumsum(histogram)
    bright = float(np.searchsorted(below, _BRIGHTER * below[-1])) - darks.level
    limit = _FAR_BELOW * bright
    dark = highest < darks.mean + np.float32(limit)
    inner = cv2.erode(dark.astype(np.uint8), _NEIGHBOURS) > 0
    masks = [inner, dark]
    if flat is not None:
        masks.append(flat < _NO_RESPONSE * np.median(flat))
    for mask in masks:
        unlit = np.flatnonzero(mask & ~darks.bad)
        if unlit.size >= _FEWEST:
            break
    if limit < _CLEAR * np.sqrt(darks.temporal_var) or unlit.size < _FEWEST:
        return None

    # their darks have errors that are the same in all frames
    place = unlit
    if unlit.size > _MOST:
        runs = np.linspace(0, unlit.size - _RUN, _MOST // _RUN).astype(int)
        place = unlit[(runs[:, None] + np.arange(_RUN)).ravel()]
    near = np.diff(place) < _NEAR
    near &= np.diff(place // highest.shape[1]) == 0
    if near.mean() < _MOSTLY:  # single pixels, whose light is hardly uneven
        near[:] = True
    of_mean = darks.temporal_var / darks.pages
    first = int(darks.level + limit) + 1
    lit = histogram[first:].cumsum()
    return UnlitPixels(
        place,
        near,
        darks.mean.ravel()[place].astype(np.float32),
        float(darks.level_std),
        darks.temporal_var + of_mean,
        float(np.hypot(darks.temporal_var_std, of_mean * np.sqrt(3 / (place.size - 1)))),
        float(first + np.searchsorted(lit, lit[-1] / 2)) - darks.level,
    )
