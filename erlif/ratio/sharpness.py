"""Two lenses are never equally sharp: speckle that one camera blurs more leaves a ghost of itself in the ratio.

A blur of variance s^2 changes the logarithm of an image by s^2/2 times its second derivative, to first order. The difference of
the two cameras' blurs is therefore two numbers, one per axis, that a run's own texture tells, and the ghost can be taken out
of the logarithm of the ratio pixel by pixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from erlif.core.arrays import Array
from erlif.core.products import AlignedFrames, require

_APART = 3  # pixels to the neighbours whose mean is taken off, far enough to share no noise with a second difference


@dataclass(frozen=True)
class BlurDifference:
    """Half the difference of the cameras' blur variances, camera 2 less camera 1, along x and y. [px2]"""

    x: float = 0.0
    y: float = 0.0
    std_x: float = 0.0
    std_y: float = 0.0

    @property
    def significant(self) -> bool:
        """Whether the texture tells the cameras apart."""
        return abs(self.x) > 3 * self.std_x or abs(self.y) > 3 * self.std_y


@dataclass
class BlurMoments:
    """Sums over frames from which the blur difference is solved."""

    matrix: Array
    vector: Array
    noise: Array
    pixels: int = 0

    @classmethod
    def empty(cls) -> BlurMoments:
        """Nothing added yet."""
        return cls(np.zeros((2, 2)), np.zeros(2), np.zeros((2, 2)))

    def add(self, frames: AlignedFrames) -> None:
        """Add aligned frames (camera, frame, y, x).

        The logarithm of the ratio is set against the second differences of camera 1. Noise of camera 1 stands in both; what it
        feigns, twice its relative variance, is known and taken off. The square of the texture is that of camera 1 times
        camera 2, which share no noise.
        """
        require(frames, "signal", "signal_var", "signal_var_fixed", "flags")
        flags = (frames.flags.values[0] | frames.flags.values[1]) != 0
        for n in range(frames.sizes["frame"]):
            one, two = frames.signal.values[:, n]
            variance = frames.signal_var.values[0, n] + frames.signal_var_fixed.values[0, n]
            matrix, vector, noise, pixels = _moments(one, two, variance, flags[n], _APART)
            self.matrix += matrix
            self.vector += vector
            self.noise += noise
            self.pixels += pixels

    def solve(self) -> BlurDifference:
        """The blur difference with its standard deviation; zero where there is too little texture to tell."""
        symmetric = (self.matrix + self.matrix.T) / 2
        if self.pixels < 1000 or np.linalg.eigvalsh(symmetric)[0] <= 0:
            return BlurDifference()
        inverse = np.linalg.inv(symmetric)
        x, y = inverse @ self.vector
        # neighbours share texture and noise: a tenth of the pixels count as independent
        std = np.sqrt(10 * np.diag(inverse @ self.noise @ inverse))
        return BlurDifference(float(x), float(y), float(std[0]), float(std[1]))


def measure_blur_difference(frames: AlignedFrames) -> BlurDifference:
    """Find by how much camera 2 is blurred more than camera 1.

    Parameters
    ----------
    frames : AlignedFrames
        signal, signal_var, signal_var_fixed and flags (camera, frame, y, x).

    Returns
    -------
    BlurDifference
    """
    moments = BlurMoments.empty()
    moments.add(frames)
    return moments.solve()


@numba.njit(nogil=True, cache=True)
def _moments(one, two, variance, flagged, apart):  # type: ignore[no-untyped-def]
    height, width = one.shape
    matrix, vector, noise = np.zeros((2, 2)), np.zeros(2), np.zeros((2, 2))
    pixels = 0
    first, second = np.empty((height, width)), np.empty((height, width))
    for i in range(height):
        for j in range(width):
            sound = not flagged[i, j] and one[i, j] > 0 and two[i, j] > 0
            first[i, j] = np.log(one[i, j]) if sound else np.nan
            second[i, j] = np.log(two[i, j]) if sound else np.nan
    bend_x, bend_y = np.full((height, width), np.nan), np.full((height, width), np.nan)
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            bend_x[i, j] = second[i, j - 1] - 2 * second[i, j] + second[i, j + 1]
            bend_y[i, j] = second[i - 1, j] - 2 * second[i, j] + second[i + 1, j]
    for i in range(apart + 1, height - apart - 1):
        for j in range(apart + 1, width - apart - 1):
            ax = first[i, j - 1] - 2 * first[i, j] + first[i, j + 1]
            ay = first[i - 1, j] - 2 * first[i, j] + first[i + 1, j]
            # what is slow, the film, is taken off the ratio, and likewise off what the ratio is set against
            bx, by, rest = bend_x[i, j], bend_y[i, j], second[i, j] - first[i, j]
            for k, m in ((-apart, 0), (apart, 0), (0, -apart), (0, apart)):
                bx -= 0.25 * bend_x[i + k, j + m]
                by -= 0.25 * bend_y[i + k, j + m]
                rest -= 0.25 * (second[i + k, j + m] - first[i + k, j + m])
            if not np.isfinite(ax + ay + bx + by + rest):
                continue
            feigned = 2 * variance[i, j] / (one[i, j] * one[i, j])
            matrix[0, 0] += ax * bx
            matrix[0, 1] += ax * by
            matrix[1, 0] += ay * bx
            matrix[1, 1] += ay * by
            vector[0] += rest * ax - feigned
            vector[1] += rest * ay - feigned
            noise[0, 0] += (rest * ax) ** 2
            noise[1, 1] += (rest * ay) ** 2
            noise[0, 1] += rest * rest * ax * ay
            noise[1, 0] += rest * rest * ax * ay
            pixels += 1
    return matrix, vector, noise, pixels


@numba.njit(nogil=True, cache=True)
def take_out_ghost(log_ratio, one, two, along_x, along_y):  # type: ignore[no-untyped-def]
    """Subtract the ghost of the texture from the logarithm of the ratio, in place.

    Parameters
    ----------
    log_ratio, one, two : array, (y, x)
        The logarithm of the ratio, and the light of the two cameras on one grid.
    along_x, along_y : float
        The blur difference. [px2]
    """
    height, width = one.shape
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            centre = one[i, j] * two[i, j]
            left, right = one[i, j - 1] * two[i, j - 1], one[i, j + 1] * two[i, j + 1]
            above, below = one[i - 1, j] * two[i - 1, j], one[i + 1, j] * two[i + 1, j]
            if centre > 0 and left > 0 and right > 0 and above > 0 and below > 0:
                # half the logarithm of the product is the mean of both cameras' logarithms
                square = centre * centre
                log_ratio[i, j] -= 0.5 * (
                    along_x * np.log(left * right / square)
                    + along_y * np.log(above * below / square)
                )
