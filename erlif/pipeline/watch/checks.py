"""What one pair of frames shows of the cameras before a run, and what to turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Counts
from erlif.registration import CameraMap

# Intervals of a histogram over the range of the counts.
_BINS = 64

# Share of the brightest pixels that is left out of the highest count, and the part of full scale
# at which it is to lie. [1]
_BRIGHTEST, _GOOD = 1e-3, 0.8

# Share of saturated pixels from which the light is too strong, and part of full scale below which
# the highest count makes it too weak. [1]
_SATURATED, _WEAK = 1e-3, 0.4

# Sharpness over the best one so far below which the focus is worth a look, and share of the image
# of camera 1 that camera 2 is to see. [1]
_BLURRED, _OVERLAP = 0.9, 0.95


class CameraCheck(NamedTuple):
    """What one frame shows of its camera.

    Attributes
    ----------
    histogram : tuple[int, ...]
        Pixels in 64 equal intervals from 0 to full scale.
    full_scale : int
        [DN]
    mean : float
        [DN]
    dark : float
        Mean of the darks; NaN where they are not there yet. [DN]
    highest : float
        Count that one pixel in a thousand exceeds, over full scale. [1]
    saturated : float
        Share of pixels at full scale. [1]
    sharpness : float
        As `measure_sharpness`; NaN without darks or texture. [1]
    measurable : float
        Share of pixels that are neither saturated, dim nor bad; NaN without darks. [1]
    """

    histogram: tuple[int, ...]
    full_scale: int
    mean: float
    dark: float
    highest: float
    saturated: float
    sharpness: float
    measurable: float


class MapCheck(NamedTuple):
    """How camera 2 lies on camera 1.

    Attributes
    ----------
    shift : tuple[float, float]
        Median displacement x, y. [px]
    quality : float
        Correlation of the textures after alignment. [1]
    overlap : float
        Share of the image of camera 1 that camera 2 sees. [1]
    poor : float
        Share where the registration is not accurate enough. [1]
    """

    shift: tuple[float, float]
    quality: float
    overlap: float
    poor: float

    @classmethod
    def of(cls, camera_map: CameraMap) -> MapCheck:
        """What a map shows."""
        x, y = (
            float(np.nanmedian(axis))
            for axis in (camera_map.displacement_x, camera_map.displacement_y)
        )
        overlap, poor = float(camera_map.overlap.mean()), float(camera_map.poor.mean())
        return cls((x, y), camera_map.quality, overlap, poor)


def check_counts(counts: Counts, full_scale: int) -> CameraCheck:
    """What the counts of a frame show by themselves.

    Parameters
    ----------
    counts : array, (y, x)
        [DN]
    full_scale : int
        [DN]

    Returns
    -------
    CameraCheck
        Without what darks and flats determine.

    Examples
    --------
    >>> check = check_counts(np.full((64, 64), 1024, np.uint16), 4095)
    >>> check.mean, round(check.highest, 2), check.saturated
    (1024.0, 0.25, 0.0)
    """
    levels = np.bincount(counts.ravel(), minlength=full_scale + 1)
    edges = np.linspace(0, levels.size, _BINS + 1).astype(int)[:-1]
    passed = np.cumsum(levels) / counts.size
    return CameraCheck(
        tuple(int(count) for count in np.add.reduceat(levels, edges)),
        full_scale,
        float(counts.mean()),
        math.nan,
        float(np.searchsorted(passed, 1 - _BRIGHTEST)) / full_scale,
        float(levels[full_scale:].sum()) / counts.size,
        math.nan,
        math.nan,
    )


def advise(
    cameras: Sequence[CameraCheck], found: MapCheck | None, best: Sequence[float]
) -> list[str]:
    """What to turn, in sentences.

    Parameters
    ----------
    cameras : sequence of CameraCheck
    found : MapCheck or None
    best : sequence of float
        Best sharpness of each camera so far. [1]

    Returns
    -------
    list of str

    Examples
    --------
    >>> bright = check_counts(np.full((64, 64), 4095, np.uint16), 4095)
    >>> advise([bright], None, [float("nan")])
    ['camera 1 saturates in 100.0 % of its pixels: halve its gain or exposure']
    """
    texts = []
    for n, (camera, sharpest) in enumerate(zip(cameras, best, strict=True), 1):
        if camera.saturated > _SATURATED:
            texts.append(
                f"camera {n} saturates in {100 * camera.saturated:.1f} % of its pixels: halve its "
                "gain or exposure"
            )
        elif camera.highest < _WEAK:
            factor = _GOOD / max(camera.highest, 1e-3)
            texts.append(
                f"camera {n} uses {100 * camera.highest:.0f} % of its range: {factor:.1f} times "
                "the gain, exposure or light would use 80 %"
            )
        if camera.sharpness < _BLURRED * sharpest:
            share = 100 * camera.sharpness / sharpest
            texts.append(
                f"camera {n} has {share:.0f} % of the best sharpness so far: turn its focus back"
            )
    if found is not None and found.overlap < _OVERLAP:
        x, y = found.shift
        texts.append(
            f"camera 2 sees {100 * found.overlap:.0f} % of the image of camera 1: it is "
            f"displaced by {x:+.0f} px along x and {y:+.0f} px along y"
        )
    return texts
