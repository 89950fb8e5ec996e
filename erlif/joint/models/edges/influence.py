"""Displacement and stress in a half space under uniformly loaded cells, and their convolution.

Coordinates of the contact: x across (circumferential), z along the axis, both in the surface, and
the depth below it. All cells of a grid are equal, so that one cell at every offset determines the
whole matrix, and a convolution by FFT on a doubled grid multiplies by it without wrap-around.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.fft

from erlif.core.arrays import AnyArray, Array


def corner_differences(
    corner: Callable[[Array, Array], Array], shape: tuple[int, int], spacing: tuple[float, float]
) -> Array:
    """Integral over a cell from its antiderivative at the four corners, for all offsets of a grid.

    Parameters
    ----------
    corner : callable
        Antiderivative of the influence of a point in x and z.
    shape : tuple of int
        Numbers of offsets of either sign along x and z: 2 n - 1 offsets from 1 - n to n - 1.
    spacing : tuple of float
        Sides of a cell. [m]

    Returns
    -------
    array, (2 nx - 1, 2 nz - 1)
        Influence at the offsets, the offset zero in the middle.
    """
    x, z = (_edges(count, step) for count, step in zip(shape, spacing, strict=True))
    values = corner(x.reshape(-1, 1), z.reshape(1, -1))
    return np.diff(np.diff(values, axis=0), axis=1)


def _edges(count: int, step: float) -> Array:
    """Sides of the cells at offsets from 1 - n to n - 1, about the middle of a cell."""
    return np.asarray((np.arange(2 * count) - (count - 0.5)) * step, dtype=np.float64)


def displacement_of_cells(
    shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float
) -> Array:
    """Displacement under a cell with unit pressure at all offsets. Johnson (1985), eq. 3.25.

    u = [f(x + a, z + b) + f(x - a, z - b) - f(x + a, z - b) - f(x - a, z + b)] / (pi E*) with
    f = x ln(z + r) + z ln(x + r). Terms that cancel at the corners are left out.
    """

    def corner(x: Array, z: Array) -> Array:
        return x * np.arcsinh(z / np.abs(x)) + z * np.arcsinh(x / np.abs(z))

    return corner_differences(corner, shape, spacing) / (np.pi * contact_modulus)


def displacement_of_strips(count: int, spacing: float, contact_modulus: float) -> Array:
    """Displacement under a strip with unit pressure at all offsets, plane strain.

    u = -(2 / (pi E*)) int ln(|x - s| / L) ds with the width L of the grid: displacements are
    relative to a point at the distance L.
    """
    edges = _edges(count, spacing)
    integral = edges * (np.log(np.abs(edges) / (count * spacing)) - 1)
    strips: Array = -2 * np.diff(integral) / (np.pi * contact_modulus)
    return strips


def stress_of_cells(
    shape: tuple[int, int], spacing: tuple[float, float], depth: float, poisson: float
) -> dict[str, Array]:
    """Stresses below a cell with unit pressure, at one depth and all offsets. Love (1929).

    With V = int 1/r and chi = int ln(y + r) over the cell, y the depth:
    s_xx = [2 nu V_y - y V_xx - (1 - 2 nu) chi_xx] / (2 pi), s_yy = [V_y - y V_yy] / (2 pi),
    s_xz = -[y V_xz + (1 - 2 nu) chi_xz] / (2 pi), s_xy = -y V_xy / (2 pi), and alike for z.

    Returns
    -------
    dict of array, (2 nx - 1, 2 nz - 1)
        Stress per pressure of the components xx, zz, yy (along the depth), xz, xy, zy; tension
        positive.
    """
    y = depth

    def root(x: Array, z: Array) -> Array:
        return np.sqrt(x * x + z * z + y * y)

    def v_y(x: Array, z: Array) -> Array:
        return -np.arctan(x * z / (y * root(x, z)))

    def v_xx(x: Array, z: Array) -> Array:
        return -x * z / (root(x, z) * (x * x + y * y))

    def chi_xx(x: Array, z: Array) -> Array:
        return np.arctan(z / x) - np.arctan(y * z / (x * root(x, z)))

    def v_xy(x: Array, z: Array) -> Array:
        return -y * z / (root(x, z) * (x * x + y * y))

    free = 1 - 2 * poisson
    corners: dict[str, Callable[[Array, Array], Array]] = {
        "xx": lambda x, z: 2 * poisson * v_y(x, z) - y * v_xx(x, z) - free * chi_xx(x, z),
        "zz": lambda x, z: 2 * poisson * v_y(x, z) - y * v_xx(z, x) - free * chi_xx(z, x),
        "yy": lambda x, z: v_y(x, z) + y * (v_xx(x, z) + v_xx(z, x)),  # V is harmonic
        "xz": lambda x, z: -y / root(x, z) - free * np.log(y + root(x, z)),
        "xy": lambda x, z: -y * v_xy(x, z),
        "zy": lambda x, z: -y * v_xy(z, x),
    }
    return {
        name: corner_differences(corner, shape, spacing) / (2 * np.pi)
        for name, corner in corners.items()
    }


@dataclass(frozen=True)
class Convolution:
    """Multiplication by the matrix of a grid's influence coefficients.

    Attributes
    ----------
    shape : tuple of int
        Cells of the grid.
    padded : tuple of int
        Cells of the doubled grid of the FFT.
    transform : array
        Transform of the influence.
    diagonal : float
        Influence of a cell on itself.
    """

    shape: tuple[int, ...]
    padded: tuple[int, ...]
    transform: AnyArray
    diagonal: float

    @classmethod
    def of(cls, influence: Array) -> "Convolution":
        """Prepare the convolution with an influence at offsets from 1 - n to n - 1."""
        shape = tuple((size + 1) // 2 for size in influence.shape)
        padded = tuple(scipy.fft.next_fast_len(size, real=True) for size in influence.shape)
        wrapped = np.zeros(padded)
        wrapped[tuple(slice(0, size) for size in influence.shape)] = influence
        # the offset zero, in the middle of the influence, becomes the first cell
        wrapped = np.roll(wrapped, [1 - size for size in shape], axis=tuple(range(len(shape))))
        middle = tuple(size - 1 for size in shape)
        return cls(shape, padded, scipy.fft.rfftn(wrapped), float(influence[middle]))

    def __call__(self, pressure: Array) -> Array:
        """Sum of the influences of all cells at all cells."""
        return self.multiply(pressure, tuple(slice(0, size) for size in self.shape))

    def multiply(self, values: Array, window: tuple[slice, ...]) -> Array:
        """Multiply values of any extent on the doubled grid and return the wanted window.

        Rows of the padding are zero before, and not wanted after, so that their transforms are
        left out.
        """
        spectrum = scipy.fft.rfft(values, self.padded[-1], axis=-1)
        if len(self.shape) == 1:
            return scipy.fft.irfft(spectrum * self.transform, self.padded[-1])[window]
        spectrum = scipy.fft.fft(spectrum, self.padded[0], axis=0, overwrite_x=True)
        spectrum *= self.transform
        rows = scipy.fft.ifft(spectrum, axis=0, overwrite_x=True)[window[0]]
        return scipy.fft.irfft(rows, self.padded[-1], axis=-1)[:, window[1]]
