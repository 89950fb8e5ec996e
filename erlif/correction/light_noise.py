"""Variances of the light of one camera from the light itself, for the rows that are needed.

A whole image of either variance takes as long to write and read as to compute, so that the pipeline
keeps none between two steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import FAST, Image

_ZERO, _ONE = np.float32(0), np.float32(1)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`


class NoiseTables(NamedTuple):
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


@numba.njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def fill_noise(light, noise, energy, variance, fixed, start, stop):  # type: ignore[no-untyped-def]
    """Fill rows of two variances; row j is stored as row j modulo their number of rows.

    Parameters
    ----------
    light : array, (y, x)
        [DN]
    noise : tuple of array
        `NoiseTables` as a plain tuple.
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
