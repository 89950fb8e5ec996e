"""One camera, measured: darks and flats in one pass, before gain and read noise are known."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from erlif.core.arrays import AnyArray, Counts
from erlif.correction.darks import Background, Darks, declare_darks, reduce_background, reduce_darks
from erlif.correction.flats import reduce_flats, sum_light
from erlif.correction.photon_transfer import LightLevel, reduce_level
from erlif.correction.saturation import Histogram
from erlif.correction.unlit import UnlitPixels
from erlif.correction.view import FrameView

# Share of the saturation below which a pixel of a flat is linear.
_CLEAR_OF_SATURATION = 0.95


@dataclass(frozen=True)
class CameraMeasurement:
    """What the darks and flats of one camera determine without knowing its gain.

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
    full_scale = histogram.size - 1
    reduced = declare_darks(darks, shape) if isinstance(darks, float) else reduce_darks(darks)
    stacks, saturation = reduce_flats(
        flats, dark=reduced.mean, full_scale=full_scale, histogram=histogram, camera=camera
    )
    dry = reduce_background(background, darks=reduced, histogram=histogram, camera=camera)
    if not stacks:
        return CameraMeasurement(reduced, full_scale, saturation, background=dry)

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
        full_scale,
        saturation,
        tuple(levels),
        sum_light(stacks),
        sum(stack.count for stack in stacks),
        dry,
        tuple(stack.count for stack in stacks),
    )
