"""Steps of the film, as at the edge of a pocket, which the lenses blur."""

from __future__ import annotations

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, FlagImage, Image, Mask
from erlif.core.flags import Flag
from erlif.core.statistics import robust_rms

_ACROSS = np.array([-1, 0, 1], np.float32)  # difference of the cells on either side of a place
_ALONG = np.full(3, 1 / 3, np.float32)  # cells along the step
_BEYOND = 2  # cells from one difference to the next
_REACH = _BEYOND + _ACROSS.size // 2  # cells
_SAMPLED = 10_000  # steps from which the scatter is taken
_SURE = 5.5  # standard deviations of a step from which it is one
_SMALLEST = 0.005  # step of the logarithm of the ratio that matters: 0.15 um in 6 um [1]
_LARGEST = 0.6  # of the largest within three cells: beside a step others follow from it
_LEVEL = 0.55  # of a step: what the film rises by before and beyond it; more at a constriction


def flag_steps(log_ratio: Image, variance: Image, flags: FlagImage) -> None:
    """Flag the surroundings of steps of the film.

    The lenses blur the films of both sides of a step into each other. What is flagged are cells of
    2 x 2 pixels that hold a step, and one pixel around them. None is sought within three cells of
    a pixel that is flagged already.

    Parameters
    ----------
    log_ratio : array, (y, x)
        Logarithm of the ratio. [1]
    variance : array, (y, x)
        Of its noise, of which the form over the image is taken; its size is that of the scatter.
        [1]
    flags : array of uint16, (y, x)
        Reasons why a pixel has no ratio; receives `Flag.FILM_STEP`.

    Examples
    --------
    >>> film = np.where(np.arange(64) < 32, 0.2, 0.4) * np.ones((64, 1))
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=film.shape)
    >>> ratio = (cv2.GaussianBlur(film, (0, 0), 0.8) + noise).astype(np.float32)
    >>> flags = np.zeros(film.shape, np.uint16)
    >>> flag_steps(ratio, np.full_like(ratio, 1e-4), flags)
    >>> np.flatnonzero(flags.any(axis=0)).tolist()
    [29, 30, 31, 32, 33, 34]
    """
    height, width = (size // 2 for size in flags.shape)
    if min(height, width) < 2 * _REACH + 1:
        return

    # cells of 2 x 2 pixels; their noise has the form of that of one pixel
    even, size = (slice(2 * height), slice(2 * width)), (width, height)
    sound = np.where(flags[even] == 0, log_ratio[even], np.float32(np.nan))
    cells = cv2.resize(sound, size, interpolation=cv2.INTER_AREA)
    noise = cv2.sqrt(cv2.resize(variance[even], size, interpolation=cv2.INTER_NEAREST))

    held = _find_steps(cells, noise)
    held |= _find_steps(cells.T, noise.T).T
    if held.any():
        doubled = 2 * width, 2 * height
        pixels = cv2.resize(held.view(np.uint8), doubled, interpolation=cv2.INTER_NEAREST)
        around = cv2.dilate(pixels, np.ones((3, 3), np.uint8)).astype(bool)
        flags[even][around] |= np.uint16(Flag.FILM_STEP)


def _find_steps(cells: AnyArray, noise: AnyArray) -> Mask:
    """Cells beside which the film steps from one row to the next."""
    rise = cv2.sepFilter2D(cells, -1, _ALONG, _ACROSS)
    inner = slice(_REACH, -_REACH)
    before, beyond = rise[1 : -2 * _BEYOND - 1], rise[2 * _BEYOND + 1 : -1]

    # zero for a film that is inclined or bends, and the whole of a step; beyond the border there is
    # no film to compare with
    step = np.full_like(cells, np.nan)
    step[inner] = np.abs(rise[inner] - (before + beyond) / 2)

    sized = cv2.divide(step, noise)
    sample = sized[:: max(sized.size // _SAMPLED, 1)]
    sample = sample[np.isfinite(sample)]
    scatter = robust_rms(sample) if sample.size else 0.0
    sized[~(sized < np.inf)] = 0.0  # as nan_to_num, in a third of the time
    if not sized.max() > _SURE * scatter > 0:
        return np.zeros(step.shape, bool)

    largest = cv2.dilate(sized, np.ones((2 * _REACH + 1, _ALONG.size), np.uint8))
    sure: Mask = sized > np.maximum(_SURE * scatter, _LARGEST * largest)
    sure &= step > _SMALLEST
    sure[inner] &= np.maximum(np.abs(before), np.abs(beyond)) < _LEVEL * step[inner]
    return sure
