"""Gain of a camera by photon transfer, linearity of its response, and spread of its pixels.

Photon transfer (EMVA 1288, release 4.0 Linear, sec. 6): where counts are proportional to
electrons, the temporal variance of a pixel rises with its light along a straight line of slope
1/gain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Mask
from erlif.core.statistics import robust_std, sample_pixels
from erlif.correction.pages import PageStack

# Ratio of the light of two levels from which on they determine more than one does.
DISTINCT = 1.02

# Relative bend below which a camera counts as linear: its error bars change by 1 %.
_RELEVANT_BEND = 0.02

# Standard deviations above which a bend is significant; 1 camera in 16000 by chance.
_SIGNIFICANT = 4.0


def _count_apart(lights: Sequence[float]) -> int:
    """Number of light levels that differ."""
    count, last = 0, 0.0
    for light in sorted(lights):
        if light > DISTINCT * last:
            count, last = count + 1, light
    return count


@dataclass(frozen=True)
class LightLevel:
    """One point of the photon transfer curve.

    Attributes
    ----------
    light : float
        Mean above dark. [DN]
    variance : float
        Mean temporal variance of a pixel. [DN2]
    variance_std : float
        Its standard deviation. [DN2]
    dark_scale : float
        Factor by which scaling the pages to one brightness changed the variance of the dark.
        [1]
    """

    light: float
    variance: float
    variance_std: float
    dark_scale: float = 1.0


@dataclass(frozen=True)
class PhotonTransfer:
    """Gain by photon transfer, and the bend of the curve.

    Attributes
    ----------
    gain : float
        [electron/DN]
    gain_std : float
        [electron/DN]
    bend : float
        Relative change of variance per light from dark to the brightest level; NaN where the
        levels are too few. [1]
    bend_std : float
        [1]
    """

    gain: float
    gain_std: float
    bend: float = float("nan")
    bend_std: float = float("nan")

    @property
    def is_bent(self) -> bool:
        """Whether the curve departs from a straight line, significantly and by more than 2 %."""
        return abs(self.bend) > max(_RELEVANT_BEND, _SIGNIFICANT * self.bend_std)


def reduce_level(pages: PageStack, usable: Mask) -> LightLevel | None:
    """Point of the photon transfer curve from the pages of one light level.

    A page scaled by s has s times the shot variance of the level it is scaled to, and s^2 times
    the variance of the dark. The variance of n pages follows a chi-square of n - 1 degrees of
    freedom: the mean of its square exceeds the square of its mean by (n + 1)/(n - 1), which its
    standard deviation takes into account.

    Parameters
    ----------
    pages : PageStack
        Pages above dark. [DN]
    usable : array of bool, (y, x)
        Pixels that are sound and clear of saturation.

    Returns
    -------
    LightLevel or None
        None for a single page, or for fewer than two usable pixels.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> stack = PageStack(np.full((64, 64), 1000.0))
    >>> for _ in range(4):
    ...     stack.add(rng.normal(1000.0, 15.0, (64, 64)))
    >>> level = reduce_level(stack, np.ones((64, 64), bool))
    >>> abs(level.variance - 225.0) < 4 * level.variance_std
    True
    """
    # a variance takes two pages, its standard deviation two pixels
    n, pixels = pages.count, int(usable.sum())
    if n < 2 or pixels < 2:
        return None

    mean, variance = pages.mean[usable], pages.variance[usable]
    std = np.sqrt(2 * float(np.mean(variance * variance)) / ((n + 1) * pixels))
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
    """Fit a straight line to variance against light, and test it for a bend.

    A bend shows where the response f is not proportional to light: variance per light is then
    f'^2/f of the electrons, and a response that falls short by a share e at the top bends the
    curve by about 3 e. Charge that spreads to neighbouring pixels bends it too. Flats of unknown
    exposure show no more: a camera that multiplies light and noise alike leaves the curve
    straight. Absolute linearity needs known exposures.

    Parameters
    ----------
    levels : sequence of LightLevel
        Levels that differ by less than `DISTINCT` count as one.
    dark_variance : float, optional
        Temporal variance of a pixel without light. If None it is fitted too, which takes one more
        level; for a single level it is then taken as zero. [DN2]
    dark_variance_std : float
        Its standard deviation. [DN2]

    Returns
    -------
    PhotonTransfer or None
        None where the variance does not rise with light.

    Examples
    --------
    >>> levels = [LightLevel(light, 4.0 + light / 4.4, 1.0) for light in (500.0, 1500.0, 3000.0)]
    >>> transfer = fit_photon_transfer(levels, dark_variance=4.0)
    >>> round(transfer.gain, 6), transfer.is_bent
    (4.4, False)
    """
    points = [level for level in levels if level.variance_std > 0 and level.light > 0]
    if not points:
        return None
    apart = _count_apart([level.light for level in points])
    light = np.array([level.light for level in points])
    scale = np.array([level.dark_scale for level in points])
    variance = np.array([level.variance for level in points])
    covariance = np.diag([level.variance_std**2 for level in points])

    # the variance of the dark is either subtracted, with its covariance, or fitted
    known = dark_variance is not None or apart == 1
    if known:
        variance = variance - scale * (dark_variance or 0.0)
        covariance = covariance + dark_variance_std**2 * np.outer(scale, scale)
    columns = [light] if known else [light, scale]

    parameters, errors = _generalised_least_squares(np.stack(columns, axis=1), variance, covariance)
    slope = float(parameters[0])
    if slope <= 0:
        return None
    gain, gain_std = 1 / slope, float(np.sqrt(errors[0, 0])) / slope**2

    # a term in light squared takes one more level
    columns.append(light**2)
    if apart < len(columns):
        return PhotonTransfer(gain, gain_std)

    # the bend is square * top / start; its gradient carries the covariance of the fit to it
    parameters, errors = _generalised_least_squares(np.stack(columns, axis=1), variance, covariance)
    start, square, top = parameters[0], parameters[-1], light.max()
    gradient = np.zeros(len(columns))
    gradient[0], gradient[-1] = -square * top / start**2, top / start
    bend_std = float(np.sqrt(gradient @ errors @ gradient))
    return PhotonTransfer(gain, gain_std, float(square * top / start), bend_std)


def measure_response_spread(flat: AnyArray, flat_var: AnyArray, bad: Mask) -> float:
    """Relative standard deviation of the response over the pixels (EMVA 1288: PRNU).

    Each pixel is compared with the mean of its eight neighbours, so that vignetting and dust do
    not count. The noise of the flat is subtracted.

    Parameters
    ----------
    flat, flat_var : array, (y, x)
        Response relative to the mean, and its variance. [1]
    bad : array of bool, (y, x)
        Pixels to be left out, with their neighbours.

    Returns
    -------
    float
        NaN where no pixel is left. [1]

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> flat = rng.normal(1.0, 0.01, (64, 64))
    >>> spread = measure_response_spread(flat, np.zeros((64, 64)), np.zeros((64, 64), bool))
    >>> abs(spread - 0.01) < 0.001
    True
    """
    ring = np.full((3, 3), 1 / 8)
    ring[1, 1] = 0

    # a pixel beside a bad one has a wrong mean about it and is left out too
    around = cv2.filter2D(np.ascontiguousarray(flat), -1, ring, borderType=cv2.BORDER_REFLECT_101)
    sound = cv2.dilate(bad.astype(np.uint8), np.ones((3, 3), np.uint8)) == 0
    # a pixel less the mean of eight others has 1 + 1/8 times the variance of a pixel
    use = sample_pixels(sound)
    if use.sum() < 2:
        return float("nan")
    own, mean, variance = (sample_pixels(image)[use] for image in (flat, around, flat_var))
    departure = own / mean - 1
    noise = float(np.median(variance / own**2))
    return float(np.sqrt(max(robust_std(departure) ** 2 / (1 + 1 / 8) - noise, 0.0)))


def _generalised_least_squares(
    design: Array, values: Array, covariance: Array
) -> tuple[Array, Array]:
    """Parameters by generalised least squares, and their covariance."""
    weighted = np.linalg.solve(covariance, design)
    errors = np.linalg.inv(design.T @ weighted)
    return errors @ (weighted.T @ values), errors
