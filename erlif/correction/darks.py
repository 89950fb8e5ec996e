"""Light that is not film: dark pages, and frames of the dry or dye-free joint under the laser."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
import scipy

from erlif.core.arrays import AnyArray, Counts, Image, Mask
from erlif.core.detector import QUANTISATION_VAR
from erlif.core.errors import FrameError
from erlif.core.statistics import robust_std, sample_pixels
from erlif.correction.pages import PageStack
from erlif.correction.saturation import Histogram

# Excess over the surroundings from which a pixel is hot: robust standard deviations, and DN.
_HOT = 8.0

# Share of good pixels whose temporal variance exceeds the limit for noisy ones by chance.
_FALSE_NOISY = 1e-7

# Added to that limit, so that rounding of a quiet camera makes no pixel noisy. [DN2]
_NOISY_FLOOR = 1.0

# Median light of the dry joint over that of the run from which its frames show a film. [1]
_FILM = 0.5


def median_of_surroundings(image: AnyArray) -> Image:
    """Median over the 5 x 5 pixels about each pixel."""
    return np.asarray(cv2.medianBlur(np.ascontiguousarray(image, np.float32), 5), np.float32)


@dataclass(frozen=True)
class Darks:
    """Darks of one camera, reduced.

    Attributes
    ----------
    mean : AnyArray
        Mean of each pixel, (y, x). [DN]
    mean_var : float
        Variance of that mean. [DN2]
    bad : Mask
        Hot or noisy pixels, (y, x).
    pages : int
        Number of pages; 0 where the dark is a declared level.
    temporal_var : float | None
        Temporal variance of a pixel; None for fewer than two pages. [DN2]
    temporal_var_std : float
        Its standard deviation. [DN2]
    level_std : float
        Standard deviation of the mean level, from page to page. [DN]
    spread : float
        Standard deviation over the pixels (DSNU). [DN]
    """

    mean: AnyArray
    mean_var: float
    bad: Mask
    pages: int
    temporal_var: float | None = None
    temporal_var_std: float = 0.0
    level_std: float = float("nan")
    spread: float = float("nan")

    @cached_property
    def level(self) -> float:
        """Mean dark level of the good pixels. [DN]"""
        return float(self.mean[~self.bad].mean())


def declare_darks(offset: float, shape: tuple[int, int]) -> Darks:
    """Darks of a camera whose dark level is given and not recorded.

    Parameters
    ----------
    offset : float
        Dark level. [DN]
    shape : (rows, columns)
        [px]

    Returns
    -------
    Darks

    Examples
    --------
    >>> declare_darks(64.0, (2, 2)).level
    64.0
    """
    return Darks(np.full(shape, offset, np.float32), 0.0, np.zeros(shape, bool), 0)


def reduce_darks(pages: Iterable[Counts]) -> Darks:
    """Reduce dark pages to their level, their noise and the bad pixels.

    Parameters
    ----------
    pages : iterable of array, (y, x)
        Counts of dark pages. [DN]

    Returns
    -------
    Darks

    Raises
    ------
    FrameError
        If there is no page.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> darks = reduce_darks(np.rint(rng.normal(64.0, 2.0, (8, 32, 32))))
    >>> round(darks.level), round(darks.temporal_var - 1 / 12)
    (64, 4)
    """
    levels: list[float] = []
    stack = _stack_pages(pages, levels)
    if stack is None:
        raise FrameError(
            "Expected at least one dark page; there is none. Record one, or give offset."
        )

    # hot pixels stand out from their surroundings, whatever the dark level does over the sensor
    mean, variance, n = stack.mean, stack.variance, stack.count
    excess = mean - median_of_surroundings(mean)
    limit = max(_HOT * robust_std(sample_pixels(excess)), _HOT)
    hot = np.abs(excess, out=excess) > limit
    if n < 2:
        return Darks(mean, 0.0, hot, 1)

    bad = hot | _find_noisy(variance, n)
    temporal_var = float(variance[~bad].mean())
    pixels = int((~bad).sum())

    # the level drifts from page to page in all pixels alike; their own noise averages out
    drift = float(np.std(levels, ddof=1)) / np.sqrt(n)
    noise_of_mean = temporal_var / (n * pixels)
    # the spread of the means over the pixels holds the noise of the means, which is subtracted
    return Darks(
        mean,
        temporal_var / n,
        bad,
        n,
        temporal_var,
        temporal_var * float(np.sqrt(2 / ((n - 1) * pixels))),
        float(np.hypot(drift, np.sqrt(noise_of_mean))),
        float(np.sqrt(max(float(mean[~bad].var()) - temporal_var / n, 0.0))),
    )


def _stack_pages(pages: Iterable[Counts], levels: list[float] | None = None) -> PageStack | None:
    """All pages, one at a time: a long recording needs no memory. Their levels are collected."""
    stack: PageStack | None = None
    for page in pages:
        stack = stack or PageStack(page)
        stack.add(page)
        if levels is not None:
            levels.append(float(np.mean(page, dtype=float)))
    return stack


def _find_noisy(variance: AnyArray, pages: int) -> Mask:
    """Pixels whose temporal variance is larger than chance allows.

    The variance of n pages follows a chi-square of n - 1 degrees of freedom.
    """
    freedom = pages - 1
    sample = sample_pixels(variance)
    typical = max(
        float(np.median(sample)) * freedom / scipy.special.chdtri(freedom, 0.5),
        # few pages of a quiet camera hold mostly equal counts, and the median is 0; the mean of
        # the variance is then the better estimate, without the noisy pixels themselves
        float(np.minimum(sample, np.quantile(sample, 0.99)).mean()),
        QUANTISATION_VAR,
    )
    limit = typical * scipy.special.chdtri(freedom, _FALSE_NOISY) / freedom + _NOISY_FLOOR
    return np.asarray(variance > limit)


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
    stack = _stack_pages(pages)
    if stack is None:
        return None

    # the median counts of the run, which has as many pixels below as above
    below = np.cumsum(histogram)
    typical = float(np.searchsorted(below, below[-1] / 2)) - darks.level
    light = stack.mean - darks.mean
    share = float(np.median(light)) / typical if typical > 0 else float("nan")
    if share > _FILM:
        raise FrameError(
            f"Expected background of {camera} to be frames of the dry or dye-free joint under the "
            f"laser; their median light is {share:.0%} of that of the run. Check that no dyed oil "
            "was in the joint, or take the key out of run.toml."
        )
    return Background(light, stack.count, share)
