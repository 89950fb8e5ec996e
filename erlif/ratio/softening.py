"""Blur of the sharper camera, so that the speckle is the same in both.

Speckle that one camera blurs more remains in the ratio. To sharpen the softer camera would multiply
its noise; to blur the sharper one averages noise. The blur is Gaussian, its variance that by which
the cameras differ, along each axis by itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import FAST, Array, FlagImage, Image, Mask
from erlif.core.speed.kernels import njit

# Half a variance up to which the response of five taps is right to 0.012, for waves of up to
# 1.5 rad/px: speckle of 0.7 px in a camera of 0.5 px has an amplitude that falls over 1.2. [px2]
_FIVE_TAPS = 0.4

# Largest half variance of a blur: what is left of a larger difference stays in the ratio. [px2]
LARGEST = 4 * _FIVE_TAPS

# Pixels beside its own that a blur reaches, at most. [px]
FARTHEST = 8

# Standard deviations from which on a difference of sharpness is corrected.
_SIGNIFICANT = 3

_ZERO, _ONE, _NAN = (np.float32(value) for value in (0, 1, np.nan))
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`


@dataclass(frozen=True)
class BlurDifference:
    """Half the difference of the cameras' blur variances, camera 2 less camera 1.

    Attributes
    ----------
    x : float
        Along x. [px2]
    y : float
        Along y. [px2]
    std_x : float
        [px2]
    std_y : float
        [px2]
    excess : float
        Excess of the mean log ratio (`erlif.ratio.excess`) after the blur. [1]
    excess_std : float
        [1]

    Examples
    --------
    >>> BlurDifference(x=0.030, y=0.010, std_x=0.004, std_y=0.004).significant
    True
    >>> BlurDifference(x=0.010, y=0.010, std_x=0.004, std_y=0.004).significant
    False
    """

    x: float = 0.0
    y: float = 0.0
    std_x: float = 0.0
    std_y: float = 0.0
    excess: float = 0.0
    excess_std: float = 0.0

    @property
    def significant(self) -> bool:
        """Whether the texture shows a difference, along either axis."""
        return abs(self.x) > _SIGNIFICANT * self.std_x or abs(self.y) > _SIGNIFICANT * self.std_y

    @property
    def corrected(self) -> tuple[float, float]:
        """The difference (x, y) that a blur removes: zero unless it is significant. [px2]"""
        return (self.x, self.y) if self.significant else (0.0, 0.0)

    @property
    def corrected_excess(self) -> float:
        """The excess that is subtracted from the log ratio: zero unless it is significant. [1]"""
        return self.excess if abs(self.excess) > _SIGNIFICANT * self.excess_std else 0.0


def gaussian_taps(half_variance: float) -> Array:
    """Weights of neighbours that blur an image along one axis.

    The response exp(-d k^2) of a Gaussian of variance 2 d to waves of k rad/px, to the second order
    in second differences, and as often as d asks for.

    Parameters
    ----------
    half_variance : float
        [px2]

    Returns
    -------
    array, (2 reach + 1,)
        A single 1 without a blur. [1]

    Examples
    --------
    >>> taps = gaussian_taps(0.28)
    >>> place = np.arange(taps.size) - taps.size // 2
    >>> round(float(taps.sum()), 6), round(float(taps @ place**2), 6)
    (1.0, 0.56)
    """
    taps = np.ones(1)
    d = min(max(half_variance, 0.0), LARGEST)
    times = math.ceil(d / _FIVE_TAPS)
    for _ in range(times):
        part = d / times
        bend = part * (part / 2 - 1 / 12)
        five = np.array([bend, part - 4 * bend, 1 - 2 * part + 6 * bend, part - 4 * bend, bend])
        taps = np.convolve(taps, five)
    return taps


@dataclass(frozen=True)
class Softening:
    """The blur of each camera that makes both equally sharp.

    Attributes
    ----------
    taps : tuple[Array, Array]
        Weights of camera 1 and of camera 2, (axis x y, 2 reach + 1). [1]
    factors : tuple[float, float]
        Variance of a pixel of both cameras over that without the blur. That of camera 2 is the mean
        over all sub-pixel positions of its interpolation, whose noise the blur no longer lowers as
        much. [1]
    excess : float
        Excess of the mean log ratio, which is subtracted. [1]
    """

    taps: tuple[Array, Array]
    factors: tuple[float, float]
    excess: float

    @classmethod
    def of(cls, blur: BlurDifference) -> Softening:
        """The blur for a difference of sharpness; none unless it is significant.

        Parameters
        ----------
        blur : BlurDifference

        Returns
        -------
        Softening

        Examples
        --------
        Camera 2 is softer, so camera 1 is blurred:

        >>> soft = Softening.of(BlurDifference(x=0.1, y=0.1, std_x=0.001, std_y=0.001))
        >>> [taps.shape for taps in soft.taps], [round(factor, 2) for factor in soft.factors]
        ([(2, 5), (2, 1)], [0.4, 1.0])
        """
        one, two = (_pair_taps(*(sign * along for along in blur.corrected)) for sign in (1, -1))
        white = np.ones(_WAVES)
        return cls(
            (one, two),
            (_keep_variance(one, white), _keep_variance(two, _splined())),
            blur.corrected_excess,
        )

    @property
    def arrays(self) -> tuple[Image, Image, Image]:
        """Taps of both cameras, and excess and factors, as `divide_rows` takes them."""
        one, two = (taps.astype(np.float32) for taps in self.taps)
        return one, two, np.array([self.excess, *self.factors], np.float32)

    @property
    def reach(self) -> int:
        """Pixels beside its own that a ratio is made of. [px]"""
        return max(int(taps.shape[1]) // 2 for taps in self.taps)


def _pair_taps(x: float, y: float) -> Array:
    """Weights along both axes, of one length."""
    lines = [gaussian_taps(x), gaussian_taps(y)]
    longest = max(line.size for line in lines)
    return np.stack([np.pad(line, (longest - line.size) // 2) for line in lines])


_WAVES = 64  # of a spectrum, over 2 pi rad/px


def _splined() -> Array:
    """Power spectrum of white noise after interpolation by cubic splines, mean over positions.

    That of the spline of seventh degree, the cubic one with itself, over the square of the filter.
    """
    k = 2 * np.pi * np.arange(_WAVES) / _WAVES
    seventh = (2416 + 2 * (1191 * np.cos(k) + 120 * np.cos(2 * k) + np.cos(3 * k))) / 5040
    return np.asarray(seventh / ((2 + np.cos(k)) / 3) ** 2)


def _keep_variance(taps: Array, power: Array) -> float:
    """Variance that a blur leaves of noise of some power spectrum along each axis. [1]"""
    response = np.abs(np.fft.fft(taps, _WAVES)) ** 2
    return float(np.prod(response @ power / power.sum()))


@njit(nogil=True, cache=True)
def empty_rows(taps, width):  # type: ignore[no-untyped-def]
    """Rows for `soften_row`: blurred along x, whether each pixel is sound, and one with a margin.

    Parameters
    ----------
    taps : array, (axis x y, 2 reach + 1), float32
    width : int

    Returns
    -------
    tuple of three array
    """
    kept = taps.shape[1]
    shape = (kept, width)
    return (
        np.zeros(shape, np.float32),
        np.zeros(shape, np.float32),
        np.zeros((2, width + kept), np.float32),
    )


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def soften_row(light, flags, first, row, begin, taps, rows, out):  # type: ignore[no-untyped-def]
    """Blur one row of an image; a neighbour that is flagged has the value of the pixel itself.

    Parameters
    ----------
    light : array, (y, x)
        [DN]
    flags : array, (row, x)
        From row `first` of the image on.
    first, row : int
    begin : bool
        Whether the row before this one was not the last one blurred.
    taps : array, (axis x y, 2 reach + 1), float32
    rows : tuple of array
        As `empty_rows` makes them.
    out : array, (x,)
        Receives the row, NaN where the light is. [DN]
    """
    height, width = light.shape
    along, sound, line = rows
    kept = taps.shape[1]
    reach = kept // 2

    # blurred along x as far below as the taps along y reach
    for below in range(max(row - reach, 0) if begin else row + reach, min(row + reach + 1, height)):
        y, k, z = _at(below), _at(below % kept), _at(below - first)
        for t in range(width):
            x, m = _at(t), _at(t + reach)
            value = light[y, x]
            line[0, m] = value if value == value else _ZERO
            line[1, m] = _ONE if flags[z, x] == 0 else _ZERO
        for t in range(width):
            x, m = _at(t), _at(t + reach)
            along[k, x] = line[0, m]
            sound[k, x] = line[1, m]
        for n in range(kept):
            weight = taps[0, n]
            if n != reach:
                for t in range(width):
                    x, m, beside = _at(t), _at(t + reach), _at(t + n)
                    along[k, x] += weight * line[1, beside] * (line[0, beside] - line[0, m])

    y, middle = _at(row), _at(row % kept)
    for t in range(width):
        x = _at(t)
        out[x] = along[middle, x]
    for n in range(kept):
        weight, at = taps[1, n], row + n - reach
        if n != reach and 0 <= at < height:
            k = _at(at % kept)
            for t in range(width):
                x = _at(t)
                out[x] += weight * sound[k, x] * (along[k, x] - along[middle, x])
    for t in range(width):
        x = _at(t)
        out[x] = out[x] if light[y, x] == light[y, x] else _NAN


def soften(light: Image, flags: Mask | FlagImage, taps: Array) -> Image:
    """Blur an image; a neighbour that is flagged has the value of the pixel itself.

    Parameters
    ----------
    light : array, (y, x)
        [DN]
    flags : array, (y, x)
        Not 0 where flagged.
    taps : array, (axis x y, 2 reach + 1)
        Of `Softening`. [1]

    Returns
    -------
    array, (y, x)
        The image itself without a blur. [DN]
    """
    if taps.shape[1] == 1:
        return light
    return np.asarray(_soften_image(light, flags, taps.astype(np.float32)))


@njit(nogil=True, cache=True)
def _soften_image(light, flags, taps):  # type: ignore[no-untyped-def]
    """All rows by `soften_row`."""
    rows = empty_rows(taps, light.shape[1])
    out = np.empty(light.shape, np.float32)
    for row in range(light.shape[0]):
        soften_row(light, flags, 0, row, row == 0, taps, rows, out[row])
    return out
