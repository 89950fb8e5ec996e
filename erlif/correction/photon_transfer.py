"""What flats tell of a camera: gain, straightness of its photon transfer, where it saturates, how alike its pixels are.

Photon transfer (EMVA 1288, release 4.0 Linear, sec. 6): of a camera whose counts are proportional to its electrons, the temporal
variance of a pixel rises with its light along a straight line of slope 1/gain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import Array, Mask
from erlif.core.statistics import robust_std
from erlif.correction.pages import PageStack

_RELEVANT_BEND, _SIGNIFICANT = (
    0.02,
    4.0,
)  # a bend worth a word: in itself, and in standard deviations


@dataclass(frozen=True)
class LightLevel:
    """One point of the photon transfer curve."""

    light: float
    """Mean above dark. [DN]"""
    variance: float
    """Mean temporal variance of a pixel. [DN2]"""
    variance_std: float
    """Its standard deviation. [DN2]"""
    dark_scale: float = 1.0
    """What the scaling of the pages has done to the dark's share of the variance. [1]"""


@dataclass(frozen=True)
class PhotonTransfer:
    """Gain by photon transfer, and how straight the curve is."""

    gain: float
    """[electron/DN]"""
    gain_std: float
    """[electron/DN]"""
    bend: float = float("nan")
    """Change of variance per light from dark to the brightest level, relative; NaN where the levels are too few. [1]"""
    bend_std: float = float("nan")
    """[1]"""

    @property
    def is_bent(self) -> bool:
        """Whether the curve departs from a straight line both significantly and by more than 2 %."""
        return abs(self.bend) > max(_RELEVANT_BEND, _SIGNIFICANT * self.bend_std)


def reduce_level(pages: PageStack, usable: Mask) -> LightLevel | None:
    """Point of the photon transfer curve that the usable pixels of two or more pages of one light level give.

    A page scaled by s has s times the shot variance of the level it is scaled to, and s^2 times the variance of the dark. The
    squared variance of n pages overestimates the square of the variance by (n + 1)/(n - 1), which its standard deviation, that of
    a chi-square of n - 1 degrees of freedom, must not.
    """
    n, pixels = pages.count, int(usable.sum())
    if n < 2 or pixels < 2:
        return None
    mean, variance = pages.mean[usable], pages.variance[usable]
    std = np.sqrt(2 * float((variance**2).mean()) / ((n + 1) * pixels))
    scales = np.array(pages.scales)
    return LightLevel(
        light=float(mean.mean()) * float(scales.mean()),
        variance=float(variance.mean()),
        variance_std=float(std),
        dark_scale=float((scales**2).mean()),
    )


def fit_photon_transfer(
    levels: Sequence[LightLevel], *, dark_variance: float | None, dark_variance_std: float = 0.0
) -> PhotonTransfer | None:
    """Fit a straight line to variance against light, and look for a bend.

    A bend shows where the response is not proportional to light: if it is f, variance per light is f'^2/f of the electrons, and a
    response that falls short by a share e of itself at the top bends the curve by about 3 e. Charge that spreads to
    neighbours bends it too. Flats whose exposures are not known cannot show more: a camera that multiplies light *and* noise
    alike, or a lamp that is not what it seems, leaves the curve straight. Absolute linearity needs known exposures.

    Parameters
    ----------
    levels : sequence of LightLevel
    dark_variance : float, optional
        Temporal variance of a pixel without light. If None it is fitted too, which takes one more level; of one level alone, none
        is assumed. [DN2]
    dark_variance_std : float
        Its standard deviation. [DN2]

    Returns
    -------
    PhotonTransfer or None
        None where the variance does not rise with light.
    """
    points = [level for level in levels if level.variance_std > 0]
    if not points:
        return None
    light = np.array([level.light for level in points])
    scale = np.array([level.dark_scale for level in points])
    variance = np.array([level.variance for level in points])
    covariance = np.diag([level.variance_std**2 for level in points])
    known = dark_variance is not None or len(points) == 1
    if known:
        variance = variance - scale * (dark_variance or 0.0)
        covariance = covariance + dark_variance_std**2 * np.outer(scale, scale)
    columns = [light] if known else [light, scale]
    (slope, *_), errors = _least_squares(np.stack(columns, axis=1), variance, covariance)
    if slope <= 0:
        return None
    gain, gain_std = 1 / slope, float(np.sqrt(errors[0, 0])) / slope**2
    columns.append(light**2)
    if len(points) < len(columns):
        return PhotonTransfer(gain, gain_std)
    parameters, errors = _least_squares(np.stack(columns, axis=1), variance, covariance)
    start, curve, top = parameters[0], parameters[-1], light.max()
    gradient = np.zeros(len(columns))
    gradient[0], gradient[-1] = -curve * top / start**2, top / start
    return PhotonTransfer(
        gain, gain_std, curve * top / start, float(np.sqrt(gradient @ errors @ gradient))
    )


def _least_squares(design: Array, values: Array, covariance: Array) -> tuple[Array, Array]:
    """Generalised least squares: parameters and their covariance."""
    weighted = np.linalg.solve(covariance, design)
    errors = np.linalg.inv(design.T @ weighted)
    return errors @ (weighted.T @ values), errors


def measure_response_spread(flat: Array, flat_var: Array, bad: Mask) -> float:
    """Relative standard deviation of the response from pixel to pixel (EMVA 1288: PRNU), noise of the flat taken off.

    Each pixel is set against the mean of its eight neighbours, so that vignetting and dust do not count.
    """
    ring = np.full((3, 3), 1 / 8)
    ring[1, 1] = 0
    around = cv2.filter2D(np.ascontiguousarray(flat), -1, ring, borderType=cv2.BORDER_REFLECT_101)
    sound = cv2.dilate(bad.astype(np.uint8), np.ones((3, 3), np.uint8)) == 0
    if sound.sum() < 2:
        return float("nan")
    departure = (flat / around - 1)[sound]
    noise = float(np.median((flat_var / flat**2)[sound]))
    return float(np.sqrt(max(robust_std(departure) ** 2 / (1 + 1 / 8) - noise, 0.0)))
