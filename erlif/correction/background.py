"""Light that is not film: frames of the dry or dye-free joint under the laser."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, Counts
from erlif.core.errors import FrameError
from erlif.correction.darks import Darks
from erlif.correction.pages import PageStack
from erlif.correction.saturation import Histogram

_LARGEST = 0.5
"""Median background over the median light of the run from which the frames show a film."""


@dataclass(frozen=True)
class Background:
    """Light of the dry joint in one camera.

    Attributes
    ----------
    light : AnyArray
        Mean counts above the dark, (y, x). [DN]
    pages : int
        Number of pages.
    share : float
        Median over the median light of the run. [1]
    """

    light: AnyArray
    pages: int
    share: float


def reduce_background(
    pages: Iterable[Counts], *, darks: Darks, histogram: Histogram, camera: str
) -> Background | None:
    """Average the frames of the dry joint.

    Parameters
    ----------
    pages : iterable of array, (y, x)
        Counts. [DN]
    darks : Darks
        Darks of the same camera.
    histogram : array of int, (full scale + 1,)
        Pixels by count in some frames of the run; their median is the light to compare with.
    camera : str
        Name in messages, "camera1".

    Returns
    -------
    Background or None
        None where there is no page.

    Raises
    ------
    FrameError
        If the pages are half as bright as the frames of the run.

    Examples
    --------
    >>> from erlif.correction import declare_darks
    >>> dry = [np.full((2, 2), counts, np.uint16) for counts in (73, 75)]
    >>> run = np.bincount([1064], minlength=4096)
    >>> found = reduce_background(
    ...     dry, darks=declare_darks(64.0, (2, 2)), histogram=run, camera="camera1"
    ... )
    >>> float(found.light[0, 0]), found.pages, found.share
    (10.0, 2, 0.01)
    """
    stack: PageStack | None = None
    for page in pages:
        stack = stack or PageStack(page)
        stack.add(page)
    if stack is None:
        return None

    # the median counts of the run, which has as many pixels below as above
    below = np.cumsum(histogram)
    typical = float(np.searchsorted(below, below[-1] / 2)) - darks.level
    light = stack.mean - darks.mean
    share = float(np.median(light)) / typical if typical > 0 else float("nan")
    if share > _LARGEST:
        raise FrameError(
            f"Expected background of {camera} to be frames of the dry or dye-free joint under the "
            f"laser; their median light is {share:.0%} of that of the run. Check that no dyed oil "
            "was in the joint, or take the key out of run.toml."
        )
    return Background(light, stack.count, share)
