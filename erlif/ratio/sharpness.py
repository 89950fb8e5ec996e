"""Difference of sharpness between the two cameras, and the ghost of the speckle that it leaves.

A blur of variance s^2 changes the logarithm of an image by s^2/2 times its second derivative, to
first order. Speckle that one camera blurs more therefore remains in the logarithm of the ratio. The
difference of the blurs is two numbers, one per axis; they follow from the texture of the frames,
and the ghost is subtracted from the logarithm of the ratio pixel by pixel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.core.products import AlignedFrames, require

# Distance of the neighbours whose mean is subtracted; no pixel in common with a second
# difference. [px]
_APART = 3

# Standard deviations from which on a difference of sharpness is corrected.
_SIGNIFICANT = 3

# Pixels of a regression, at least.
_LEAST_PIXELS = 1000

# Pixels that count as one independent: neighbours share texture and noise.
_CORRELATED = 10

# Rows and columns of a frame that are worked on at once: their arrays stay in the cache. [px]
_TILE = (64, 256)


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
        Excess of the mean log ratio (`erlif.ratio.excess`) after the ghost is subtracted. [1]
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
        """The difference (x, y) whose ghost is subtracted: zero unless it is significant. [px2]"""
        return (self.x, self.y) if self.significant else (0.0, 0.0)

    @property
    def corrected_excess(self) -> float:
        """The excess that is subtracted from the log ratio: zero unless it is significant. [1]"""
        return self.excess if abs(self.excess) > _SIGNIFICANT * self.excess_std else 0.0


@dataclass
class BlurMoments:
    """Sums over frames from which the blur difference is solved.

    Attributes
    ----------
    matrix : Array
        Products of the second differences of camera 1 (rows x, y) and camera 2 (columns). [1]
    vector : Array
        Products of the log ratio and the second differences of camera 1, along x and y. [1]
    noise : Array
        Covariance of the vector, pixels taken as independent. [1]
    pixels : int
        Pixels in the sums.

    Examples
    --------
    Speckle of wave number 0.4 rad/px, weakened in camera 2 as by a blur of variance 0.06 px2:

    >>> import xarray as xr
    >>> y, x = np.indices((64, 64))
    >>> speckle = 0.1 * (np.sin(0.4 * x) + np.sin(0.4 * y))
    >>> blurred = speckle * np.exp(-(0.4**2) * 0.06 / 2)
    >>> dims = ("camera", "frame", "y", "x")
    >>> frames = AlignedFrames(xr.Dataset({
    ...     "signal": (dims, 1000 * np.exp([[speckle], [blurred]])),
    ...     "signal_var": (dims, np.zeros((2, 1, 64, 64))),
    ...     "signal_var_fixed": (dims, np.zeros((2, 1, 64, 64))),
    ...     "flags": (dims, np.zeros((2, 1, 64, 64), np.uint16)),
    ... }))
    >>> moments = BlurMoments.empty()
    >>> moments.add(frames)
    >>> difference = moments.solve()
    >>> round(difference.x, 2), round(difference.y, 2)
    (0.03, 0.03)
    """

    matrix: Array
    vector: Array
    noise: Array
    pixels: int = 0

    @classmethod
    def empty(cls) -> BlurMoments:
        """Sums over no frames.

        Returns
        -------
        BlurMoments
        """
        return cls(np.zeros((2, 2)), np.zeros(2), np.zeros((2, 2)))

    def add(self, frames: AlignedFrames) -> None:
        """Add aligned frames.

        The logarithm of the ratio is regressed on the second differences of camera 1. Both contain
        the noise of camera 1; the product of this noise, twice its relative variance, is known and
        subtracted. The square of the texture is the product of camera 1 and camera 2, which have
        no noise in common.

        Parameters
        ----------
        frames : AlignedFrames
            signal, signal_var, signal_var_fixed and flags (camera, frame, y, x).

        Raises
        ------
        ErlifError
            If a variable is missing.
        """
        require(frames, "signal", "signal_var", "signal_var_fixed", "flags")
        flags = (frames.flags.values[0] | frames.flags.values[1]) != 0
        for n in range(frames.sizes["frame"]):
            one, two = frames.signal.values[:, n]
            variance = frames.signal_var.values[0, n] + frames.signal_var_fixed.values[0, n]
            for tile in _tiles(one.shape):
                matrix, vector, noise, pixels = _moments(
                    one[tile], two[tile], variance[tile], flags[n][tile]
                )
                self.matrix += matrix
                self.vector += vector
                self.noise += noise
                self.pixels += pixels

    def solve(self) -> BlurDifference:
        """Blur difference with its standard deviation.

        Returns
        -------
        BlurDifference
            Zero where there is too little texture.
        """
        symmetric = (self.matrix + self.matrix.T) / 2
        if self.pixels < _LEAST_PIXELS or np.linalg.eigvalsh(symmetric)[0] <= 0:
            return BlurDifference()

        inverse = np.linalg.inv(symmetric)
        x, y = inverse @ self.vector
        std = np.sqrt(_CORRELATED * np.diag(inverse @ self.noise @ inverse))
        return BlurDifference(float(x), float(y), float(std[0]), float(std[1]))


def _tiles(shape: tuple[int, ...]) -> Iterator[tuple[slice, slice]]:
    """Parts of a frame that share no pixel of the sums, each with the margin it needs."""
    margin = 2 * (_APART + 1)
    rows, columns = _TILE
    for y in range(0, shape[0] - margin, rows):
        for x in range(0, shape[1] - margin, columns):
            yield slice(y, y + rows + margin), slice(x, x + columns + margin)


def _moments(
    one: Image, two: Image, variance: Image, flagged: Mask
) -> tuple[Array, Array, Array, int]:
    """Moments of one tile, in the order of the fields of `BlurMoments`."""
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = np.log(one).astype(float), np.log(two).astype(float)
    sound = ~flagged & np.isfinite(first) & np.isfinite(second)
    unsound = ~sound
    first[unsound] = 0
    second[unsound] = 0

    # the film varies slowly; the mean of four neighbours removes it from the ratio, and the same is
    # done to the second differences, so that the factor between both stays
    detail = _less_neighbours(second)
    rest = (detail - _less_neighbours(first))[1:-1, 1:-1]
    ax, ay = _second_differences(first[_APART:-_APART, _APART:-_APART])
    bx, by = _second_differences(detail)

    # all pixels that enter must be sound: the neighbours, and their neighbours
    whole = sound[_APART:-_APART, _APART:-_APART].copy()
    for one_side in _four_neighbours(sound, _APART):
        whole &= one_side
    used = whole[1:-1, 1:-1].copy()
    for one_side in _four_neighbours(whole, 1):
        used &= one_side
    ax *= used
    ay *= used

    # noise n of camera 1 is -n in the ratio and -2 n in its second differences
    margin = _APART + 1
    light = one[margin:-margin, margin:-margin][used]
    common = np.sum(2.0 * variance[margin:-margin, margin:-margin][used] / (light * light))

    along_x, along_y = rest * ax, rest * ay
    both = _dot(along_x, along_y)
    return (
        np.array([[_dot(ax, bx), _dot(ax, by)], [_dot(ay, bx), _dot(ay, by)]]),
        np.array([along_x.sum() - common, along_y.sum() - common]),
        np.array([[_dot(along_x, along_x), both], [both, _dot(along_y, along_y)]]),
        len(light),
    )


def _four_neighbours(values: AnyArray, apart: int) -> tuple[AnyArray, ...]:
    """The values left, right, above and below, for the pixels at least `apart` from the edge."""
    middle = slice(apart, -apart)
    before, after = slice(None, -2 * apart), slice(2 * apart, None)
    return (
        values[middle, before],
        values[middle, after],
        values[before, middle],
        values[after, middle],
    )


def _less_neighbours(values: Array) -> Array:
    """Each value less the mean of the four at the distance `_APART`."""
    left, right, above, below = _four_neighbours(values, _APART)
    return np.asarray(
        values[_APART:-_APART, _APART:-_APART] - 0.25 * (left + right + above + below)
    )


def _second_differences(values: Array) -> tuple[Array, Array]:
    """Second differences along x and along y, without the pixels at the edge."""
    left, right, above, below = _four_neighbours(values, 1)
    twice = 2 * values[1:-1, 1:-1]
    return left + right - twice, above + below - twice


def _dot(one: Array, two: Array) -> float:
    """Sum of the products; the order of the sum does not depend on the number of processors."""
    return float(np.einsum("yx,yx->", one, two))
