"""Flat pages: light levels, saturation, pixel response, dead pixels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Counts, Mask
from erlif.core.errors import FrameError
from erlif.correction.darks import median_of_surroundings
from erlif.correction.pages import PageStack, precision_of
from erlif.correction.saturation import Histogram, count_pixels, find_pile_up

# Relative difference of mean brightness below which two pages belong to one light level.
_SAME_LEVEL = 0.05

# Share of saturated pixels above which a flat page is left out.
_SATURATED_SHARE = 1e-3

# Share of full scale that the brightest level must reach.
_BRIGHT_ENOUGH = 1 / 50

# Mean light of flats that are darks, or the same file. [DN]
_SAME_COUNTS = 1.0

# Light over that of the surroundings beyond which a pixel is dead or too bright.
_DEAD, _OVERBRIGHT = 0.5, 1.5

# Light over the mean below which a pixel is dead.
_DARKEST = 0.02


class FlatField(NamedTuple):
    """Response of the pixels of one camera.

    Attributes
    ----------
    response : AnyArray
        Relative to the mean, (y, x). [1]
    response_var : AnyArray
        Its variance, (y, x). [1]
    dead : Mask
        Pixels that hardly respond, or far too much, (y, x).
    """

    response: AnyArray
    response_var: AnyArray
    dead: Mask


def reduce_flats(
    pages: Iterable[Counts], *, dark: AnyArray, histogram: Histogram, camera: str
) -> tuple[list[PageStack], int]:
    """Sort flat pages into light levels, and find the count at which the camera saturates.

    Consecutive pages of one brightness form a level; they are scaled to one another, which removes
    the flicker of the lamp. Pages without light and pages with saturated pixels are left out, those
    that saturate below full scale included.

    Parameters
    ----------
    pages : iterable of array, (y, x)
        Counts of flat pages. [DN]
    dark : array, (y, x)
        Mean dark. [DN]
    histogram : array of int, (full scale + 1,)
        Pixels by count in some frames, which are searched for a pile-up as well.
    camera : str
        Name in messages.

    Returns
    -------
    list of PageStack
        Flats above dark, one stack for each light level; empty where no flat was recorded.
    int
        Count at which the camera saturates. [DN]

    Raises
    ------
    FrameError
        If there are pages and none is both well above dark and below saturation.
    """
    full_scale = histogram.size - 1
    levels: list[PageStack] = []
    lights: list[float] = []
    first_brightness = brightest = 0.0
    total = histogram.copy()
    recorded = False
    for image in pages:
        recorded = True

        # a page judged by itself: a pile-up of its own may lie below that of all pages
        counted = count_pixels(image, full_scale)
        total += counted
        top = find_pile_up(counted) or full_scale
        if counted[top:].sum() > _SATURATED_SHARE * image.size:
            continue

        # a page without light has no response of the pixels, and nothing to be scaled by
        light = np.subtract(image, dark, dtype=precision_of(image))
        brightness = float(light.mean())
        lights.append(brightness)
        if brightness <= 0:
            continue

        # the scale removes flicker of the lamp, which would count as noise of the camera
        if not levels or abs(brightness / first_brightness - 1) >= _SAME_LEVEL:
            levels.append(PageStack(light))
            first_brightness = brightness
            brightest = max(brightest, brightness)
        levels[-1].add(light, scale=first_brightness / brightness)

    # the histogram of all pages and frames shows a pile-up that single pages hint at
    saturation = find_pile_up(total) or full_scale
    if recorded and (not levels or brightest < full_scale * _BRIGHT_ENOUGH):
        raise _no_flats(camera, lights, saturation)
    return levels, saturation


def _no_flats(camera: str, lights: Sequence[float], saturation: int) -> FrameError:
    """The refusal of flats without light, by the mean light of each page. [DN]"""
    mean = float(np.mean(lights)) if lights else np.inf
    if mean <= -_SAME_COUNTS:
        found = f"they are {-mean:.0f} counts darker than the darks"
        cure = "Exchange dark and flat in the settings; save images anew that are stored inverted"
    elif mean < _SAME_COUNTS:
        found = "they are as dark as the darks"
        cure = "Name the file of the flats in the settings, or record flats with light"
    else:
        found = "none is"
        cure = "Record flats with the light at a quarter to three quarters of full scale"
    return FrameError(
        f"Expected flats of {camera} well above dark and below saturation ({saturation}); {found}. "
        f"{cure}."
    )


def sum_light(levels: Iterable[PageStack]) -> AnyArray:
    """Light of all pages together, (y, x). [DN]"""
    parts = [part for level in levels for part in (level.count * level.first, level.total)]
    return np.asarray(reduce(np.add, parts))


def make_flat_field(
    total: AnyArray, pages: int, *, dark_var: AnyArray, bad: Mask, gain: float, page_var: float
) -> FlatField:
    """Response of each pixel relative to the mean, its variance, and the dead pixels.

    Parameters
    ----------
    total : array, (y, x)
        Light of all pages together. [DN]
    pages : int
        Their number.
    dark_var : array, (y, x)
        Variance of the mean dark. [DN2]
    bad : array of bool, (y, x)
        Hot and noisy pixels, which take the response of their surroundings.
    gain : float
        [electron/DN]
    page_var : float
        Variance of reading and rounding in one page. [DN2]

    Returns
    -------
    FlatField

    Examples
    --------
    >>> light = np.full((16, 16), 1000.0)
    >>> light[:, 8:] = 3000.0
    >>> none = np.zeros((16, 16), bool)
    >>> field = make_flat_field(
    ...     light, 1, dark_var=np.zeros((16, 16)), bad=none, gain=4.0, page_var=0.0
    ... )
    >>> float(field.response[0, 0]), float(field.response[0, 15])
    (0.5, 1.5)
    """
    # dead pixels are found against their surroundings, which carry the vignetting as well; in a
    # dead patch those are dark too, and the mean of the image decides
    scale = float(total[~bad].mean())
    surroundings = median_of_surroundings(total)
    dead = (
        (total < _DEAD * surroundings)
        | (total > _OVERBRIGHT * surroundings)
        | (total < _DARKEST * scale)
    )

    # a pixel without a response of its own takes that of its surroundings, never zero
    response = np.where(dead | bad, np.maximum(surroundings, _DARKEST * scale), total) / scale

    # shot noise of all pages, their reading noise, and the dark subtracted from each of them
    variance = np.maximum(total, 0.0) / gain + pages * page_var + pages**2 * dark_var
    return FlatField(response, variance / scale**2, np.asarray(dead))
