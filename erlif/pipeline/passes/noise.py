"""Variances of the light of one camera from the light itself, for the rows that are needed.

The reference is `erlif.correction.correct_frames`. A whole image of either variance takes as long
to write and read as to compute, so that none is kept between two passes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import Array, Image
from erlif.registration import orient
from erlif.registration.interpolation import FAST

_ZERO, _ONE = np.float32(0), np.float32(1)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`


class CameraNoise(NamedTuple):
    """What the variances of one camera need besides its light; images are (y, x).

    Attributes
    ----------
    per_flat : Image
        One over the flat. [1]
    dark_var : Image
        Variance of the dark; one row where all rows are alike. [DN2]
    flat_var : Image
        Variance of the light by the flat, for light 1. [1]
    dry_light : Image
        Light of the dry joint at the mean pulse energy; of size 0 where none was recorded. [DN]
    dry_var : Image
        Variance of the mean page of the dry joint, of size 0 as well. [DN2]
    numbers : Image
        One over the gain [DN/electron]; variance by reading and rounding [DN2]; 1 where pages of
        the dry joint were recorded above the same dark, else 0.
    """

    per_flat: Image
    dark_var: Image
    flat_var: Image
    dry_light: Image
    dry_var: Image
    numbers: Image

    def turned(self, orientation: str) -> CameraNoise:
        """The same for an image that is turned first.

        Parameters
        ----------
        orientation : str
            One of `erlif.registration.settings.ORIENTATIONS`.

        Returns
        -------
        CameraNoise
        """
        if orientation == "normal":
            return self

        def turned(image: Image) -> Image:
            return np.ascontiguousarray(orient(image, orientation))

        return CameraNoise(
            turned(self.per_flat),
            turned(np.broadcast_to(self.dark_var, self.per_flat.shape)),
            turned(self.flat_var),
            turned(self.dry_light),
            turned(self.dry_var),
            self.numbers,
        )


class NoiseRows:
    """Both variances of some rows of an image, computed when they are first needed.

    Row j is stored as row j modulo the number of rows that are kept.
    """

    def __init__(self) -> None:
        self.variance: Image = np.empty((0, 0), np.float32)
        """New in every frame. [DN2]"""
        self.fixed: Image = np.empty((0, 0), np.float32)
        """Of dark and flat. [DN2]"""
        self._fill: Callable[[int, int], object] = lambda start, stop: None
        self._first = self._stop = 0

    def begin(self, light: Image, noise: CameraNoise, energy: Array, *, rows: int) -> None:
        """Start with another image.

        Parameters
        ----------
        light : array, (y, x)
            [DN]
        noise : CameraNoise
        energy : array, (1)
            Energy of the pulse over the mean of the run. [1]
        rows : int
            Rows to keep at least.
        """
        rows = min(rows, light.shape[0])
        if self.variance.shape[0] < rows or self.variance.shape[1] != light.shape[1]:
            self.variance, self.fixed = (
                np.empty((rows, light.shape[1]), np.float32) for _ in range(2)
            )
        tables, scale = tuple(noise), np.float32(energy[0])
        self._fill = lambda start, stop: fill_noise(
            light, tables, scale, self.variance, self.fixed, start, stop
        )
        self._first = self._stop = 0

    def hold(self, first: int, stop: int) -> None:
        """Have the rows from `first` to `stop`, no more than are kept."""
        # rows that are there stay; a gap, or rows above, mean a new beginning
        if not self._first <= first <= self._stop:
            self._first = self._stop = first
        if stop > self._stop:
            self._fill(self._stop, stop)
            self._stop = stop
            self._first = max(self._first, stop - self.variance.shape[0])


@numba.njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def fill_noise(light, noise, energy, variance, fixed, start, stop):  # type: ignore[no-untyped-def]
    """Fill rows of two variances; row j is stored as row j modulo their number of rows.

    Parameters
    ----------
    light : array, (y, x)
        [DN]
    noise : tuple of array
        `CameraNoise` as a plain tuple.
    energy : float32
        Energy of the pulse over the mean of the run; it scales the light of the dry joint. [1]
    variance, fixed : array, (row, x)
        New in every frame, and of dark and flat. [DN2]
    start, stop : int
        Rows of the image.
    """
    per_flat, dark_var, flat_var, dry_light, dry_var, numbers = noise
    per_gain, read_var, recorded = numbers[0], numbers[1], numbers[2]
    of_dark, of_page = (_ONE - energy * recorded) ** 2, energy * energy
    width = light.shape[1]
    for row in range(start, stop):
        y, kept, m = _at(row), _at(row % variance.shape[0]), _at(row % dark_var.shape[0])

        # one result a loop: more would need more comparisons of addresses than the compiler accepts
        if dry_light.size == 0:
            for t in range(width):
                x = _at(t)
                scale = per_flat[y, x]
                variance[kept, x] = (max(light[y, x], _ZERO) * per_gain + read_var * scale) * scale
            for t in range(width):
                x = _at(t)
                value, scale = light[y, x], per_flat[y, x]
                fixed[kept, x] = dark_var[m, x] * scale * scale + value * value * flat_var[y, x]
            continue

        # the dry joint has shot noise as well, and its page another variance than the dark
        for t in range(width):
            x = _at(t)
            scale = per_flat[y, x]
            whole = max(light[y, x] + energy * dry_light[y, x], _ZERO)
            variance[kept, x] = (whole * per_gain + read_var * scale) * scale
        for t in range(width):
            x = _at(t)
            value, scale = light[y, x], per_flat[y, x]
            repeated = of_dark * dark_var[m, x] * scale * scale + of_page * dry_var[y, x]
            fixed[kept, x] = repeated + value * value * flat_var[y, x]
