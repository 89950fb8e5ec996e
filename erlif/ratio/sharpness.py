"""Difference of sharpness between the two cameras, by the speckle that it leaves in their ratio.

A blur of variance s^2 changes the logarithm of an image by s^2/2 times its second derivative, to
first order. The difference of the blurs is two numbers, one per axis; they follow from the texture
of the frames. Where it is significant, the sharper camera is blurred by it and the rest measured,
so that the first order is enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from erlif.core.arrays import AnyArray, Array, Image, Mask
from erlif.core.products import AlignedFrames, require
from erlif.ratio.softening import BlurDifference, Softening, soften

# Times that the rest of a difference is measured: after two it is below a hundredth of the first.
_ROUNDS = 3

# Distance of the neighbours whose mean is subtracted; no pixel in common with a second
# difference. [px]
_APART = 3

# Pixels of a regression, at least.
_LEAST_PIXELS = 1000

# Pixels that count as one independent: neighbours share texture and noise.
_CORRELATED = 10

# Rows and columns of a frame that are worked on at once: their arrays stay in the cache. [px]
_TILE = (64, 256)


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

    def add(self, frames: AlignedFrames, blur: BlurDifference | None = None) -> None:
        """Add aligned frames.

        The logarithm of the ratio is regressed on the second differences of camera 1. Both contain
        the noise of camera 1; the product of this noise, without a blur twice its relative
        variance, is known and subtracted. The square of the texture is the product of camera 1 and
        camera 2, which have no noise in common.

        Parameters
        ----------
        frames : AlignedFrames
            signal, signal_var, signal_var_fixed and flags (camera, frame, y, x).
        blur : BlurDifference, optional
            By which the sharper camera is blurred first; the sums are those of the rest.

        Raises
        ------
        ErlifError
            If a variable is missing.
        """
        require(frames, "signal", "signal_var", "signal_var_fixed", "flags")
        flags = (frames.flags.values[0] | frames.flags.values[1]) != 0
        taps = Softening.of(BlurDifference() if blur is None else blur).taps
        products = _multiply_noise(taps[0])
        for n in range(frames.sizes["frame"]):
            one, two = (
                soften(np.ascontiguousarray(frames.signal.values[camera, n]), flags[n], of_camera)
                for camera, of_camera in enumerate(taps)
            )
            variance = frames.signal_var.values[0, n] + frames.signal_var_fixed.values[0, n]
            for tile in _tiles(one.shape):
                matrix, vector, noise, pixels = _moments(
                    one[tile], two[tile], variance[tile], flags[n][tile], products
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


def measure_blur(parts: Sequence[AlignedFrames]) -> BlurDifference:
    """Difference of sharpness that aligned frames show.

    Parameters
    ----------
    parts : sequence of AlignedFrames
        As for `BlurMoments.add`.

    Returns
    -------
    BlurDifference
        Without the excess of the ratio.

    Examples
    --------
    Photons of an even light have no texture:

    >>> import xarray as xr
    >>> light = np.random.default_rng(1).poisson(4000, (2, 1, 64, 64)).astype(np.float32)
    >>> dims = ("camera", "frame", "y", "x")
    >>> even = AlignedFrames(xr.Dataset({
    ...     "signal": (dims, light), "signal_var": (dims, light),
    ...     "signal_var_fixed": (dims, 0 * light), "flags": (dims, np.uint16(0 * light)),
    ... }))
    >>> measure_blur([even]).significant
    False
    """
    found = BlurDifference()
    for _ in range(_ROUNDS):
        moments = BlurMoments.empty()
        for part in parts:
            moments.add(part, found)
        rest = moments.solve()
        found = replace(rest, x=found.x + rest.x, y=found.y + rest.y)
        if not found.significant:
            break
    return found


def _multiply_noise(taps: Array) -> Array:
    """Noise of camera 1 in the log ratio times that in its second differences, along x and y.

    For noise of variance 1 before a blur, (axis x y, 2 reach + 1): without one -n times -2 n. [1]
    """
    wide = np.pad(np.outer(taps[1], taps[0]), _APART + 1)  # so that nothing is cut off
    less = wide.copy()
    for axis in (0, 1):
        less -= 0.25 * (np.roll(wide, _APART, axis) + np.roll(wide, -_APART, axis))
    bends = [np.roll(wide, 1, axis) + np.roll(wide, -1, axis) - 2 * wide for axis in (1, 0)]
    return np.array([-np.sum(less * bend) for bend in bends])


def _tiles(shape: tuple[int, ...]) -> Iterator[tuple[slice, slice]]:
    """Parts of a frame that share no pixel of the sums, each with the margin it needs."""
    margin = 2 * (_APART + 1)
    rows, columns = _TILE
    for y in range(0, shape[0] - margin, rows):
        for x in range(0, shape[1] - margin, columns):
            yield slice(y, y + rows + margin), slice(x, x + columns + margin)


def _moments(
    one: Image, two: Image, variance: Image, flagged: Mask, products: Array
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

    margin = _APART + 1
    light = one[margin:-margin, margin:-margin][used]
    relative = np.sum(variance[margin:-margin, margin:-margin][used] / (light * light), dtype=float)
    common = relative * products

    along_x, along_y = rest * ax, rest * ay
    both = _dot(along_x, along_y)
    return (
        np.array([[_dot(ax, bx), _dot(ax, by)], [_dot(ay, bx), _dot(ay, by)]]),
        np.array([along_x.sum(), along_y.sum()]) - common,
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
