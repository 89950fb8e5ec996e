"""Counts of one frame pair to light, with the binned light that a drift needs.

The variances of a pixel follow from its light. A whole image of either takes as long to write and
read as to compute, so that the pipeline keeps none between two steps: each step computes them for
the rows that it needs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import FAST, AnyArray, Array, FlagImage, Image, Mask
from erlif.core.detector import reading_var
from erlif.core.flags import Flag
from erlif.core.products import References
from erlif.core.speed.kernels import njit

_SATURATED, _DIM, _BAD_PIXEL, _MASKED = (
    np.uint16(flag) for flag in (Flag.SATURATED, Flag.DIM, Flag.BAD_PIXEL, Flag.MASKED)
)

# Pixels on which no registration can rely.
UNUSABLE = np.uint16(_SATURATED | _BAD_PIXEL | _MASKED)
_ZERO, _ONE, _NONE = np.float32(0), np.float32(1), np.uint16(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# Width of the blocks whose light is averaged. [px]
BLOCK = 8

# Rings of neighbours searched for good pixels: larger defects stay as they were read. [px]
_FARTHEST = 5

# Rows that are measured before they are averaged.
_BAND = 64


@dataclass(frozen=True)
class PairLight:
    """Light of both cameras in one frame pair; every array is (camera, y, x).

    Attributes
    ----------
    light : Image
        Dark subtracted, divided by the flat, bad pixels filled, NaN where excluded. [DN]
    variance : Image
        New in every frame; of size 0 where it is not asked for. [DN2]
    variance_fixed : Image
        Of dark and flat, the same in every frame; of size 0 as well. [DN2]
    flags : FlagImage
        Bits of `erlif.core.flags.Flag`.
    half : Image
        Mean light of the usable pixels in squares of 2 px, 0 without weight. [DN]
    half_weight : Image
        1 where more than half of the square is usable, else 0.
    blocks : Image
        Mean light of squares of 8 px, NaN where a pixel is excluded; those at the lower and right
        edge may be smaller. [DN]
    peaks : Array
        Highest count of each camera, (camera). [DN]
    energy : Array
        Energy of the pulse over the mean of the run, (1). [1]
    """

    light: Image
    variance: Image
    variance_fixed: Image
    flags: FlagImage
    half: Image
    half_weight: Image
    blocks: Image
    peaks: Array
    energy: Array

    @classmethod
    def empty(
        cls, shape: tuple[int, int], *, with_noise: bool = True, binned_in: Image | None = None
    ) -> PairLight:
        """Arrays for frames of a shape (y, x), to be filled by `measure_light`.

        Parameters
        ----------
        shape : tuple of int
            Rows and columns.
        with_noise : bool
            Whether the variances are filled.
        binned_in : array, (y, x), optional
            Contiguous memory for half and half_weight, which only the drift reads.

        Returns
        -------
        PairLight
        """
        height, width = shape
        half = (2, height // 2, width // 2)
        blocks = (2, -(-height // BLOCK), -(-width // BLOCK))
        noise = (2, *shape) if with_noise else (2, 0, 0)

        size = math.prod(half)
        binned = np.empty(2 * size, np.float32) if binned_in is None else binned_in.reshape(-1)
        return cls(
            np.empty((2, *shape), np.float32),
            np.empty(noise, np.float32),
            np.empty(noise, np.float32),
            np.empty((2, *shape), np.uint16),
            binned[:size].reshape(half),
            binned[size : 2 * size].reshape(half),
            np.empty(blocks, np.float32),
            np.zeros(2),
            np.ones(1),
        )


class NoiseTables(NamedTuple):
    """Tables for the variances of one camera, beside its light; images are (y, x).

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


@dataclass(frozen=True)
class CameraTables:
    """Tables for the correction of one camera, the same in all frames; images are (y, x).

    Attributes
    ----------
    dark : Image
        NaN where a pixel is excluded, so that its light is none. [DN]
    least : AnyArray
        Smallest count that is not dim. [DN]
    bad : AnyArray
        True for bad pixels.
    rows : AnyArray
        Rows of the bad pixels. [px]
    columns : AnyArray
        Columns of the bad pixels. [px]
    full_scale : int
        Count at saturation. [DN]
    noise : NoiseTables
        What the variances of the light need; light and variances share the flat and the dry joint.
    least_above_dry : Image
        Light that is not dim once that of the dry joint is subtracted; empty where no dry joint was
        recorded. [DN]
    """

    dark: Image
    least: AnyArray
    bad: AnyArray
    rows: AnyArray
    columns: AnyArray
    full_scale: int
    noise: NoiseTables
    least_above_dry: Image


def tabulate(
    references: References, *, least_signal: float, excluded: Mask | None = None
) -> tuple[CameraTables, CameraTables]:
    """Prepare the correction of both cameras.

    Parameters
    ----------
    references : References
        As `erlif.correction.make_references` returns them.
    least_signal : float
        Pixels with less light are flagged dim. [electron]
    excluded : array of bool, (y, x), optional
        Pixels of camera 1 that count nowhere; default: none. Those of camera 2 follow from the map.

    Returns
    -------
    tuple of two CameraTables
    """
    one, two = (
        _tabulate_camera(References(references.isel(camera=n)), least_signal) for n in range(2)
    )
    if excluded is not None:
        one = replace(one, dark=np.where(excluded, np.float32(np.nan), one.dark))
    return one, two


def _tabulate_camera(reference: References, least_signal: float) -> CameraTables:
    dark, gain = reference.dark.values, float(reference.gain)
    bad = np.ascontiguousarray(reference.bad.values)
    rows, columns = map(np.ascontiguousarray, np.nonzero(bad))  # one layout, one compiled kernel
    per_flat = 1 / np.ascontiguousarray(reference.flat.values, float)

    # a camera usually has one number for all pixels, for which a row is enough
    dark_var = reference.dark_var.values
    if (dark_var == dark_var[:1]).all():
        dark_var = dark_var[:1]

    dry_light = dry_var = least_above_dry = np.zeros((0, 0), np.float32)
    recorded = 0.0
    if "background" in reference:
        dry_light = (reference.background.values * per_flat).astype(np.float32)
        dry_var = (reference.background_var.values * per_flat**2).astype(np.float32)
        least_above_dry = (least_signal / gain * per_flat).astype(np.float32)
        recorded = float(reference.background_recorded)

    read_var = reading_var(float(reference.read_noise), gain)
    noise = NoiseTables(
        per_flat.astype(np.float32),
        np.ascontiguousarray(dark_var, np.float32),
        (reference.flat_var.values * per_flat**2).astype(np.float32),
        dry_light,
        dry_var,
        np.array([1 / gain, read_var, recorded], np.float32),
    )

    # counts are whole numbers, so that the comparison with a rounded threshold is exact
    least = np.ceil(dark.astype(float) + least_signal / gain)
    return CameraTables(
        np.ascontiguousarray(dark, np.float32),
        np.clip(least, 0, np.iinfo(np.uint16).max).astype(np.uint16),
        bad,
        rows,
        columns,
        int(reference.full_scale),
        noise,
        least_above_dry,
    )


def measure_light(
    counts: Sequence[AnyArray],
    tables: tuple[CameraTables, CameraTables],
    *,
    out: PairLight | None = None,
    energy: float = 1.0,
) -> PairLight:
    """Light of a frame pair with variance and flags, and the same binned.

    Parameters
    ----------
    counts : two arrays, (y, x)
        Of camera 1 and camera 2. [DN]
    tables : tuple of two CameraTables
    out : PairLight, optional
        Filled and returned.
    energy : float
        Energy of the pulse over the mean of the run; it scales a background. [1]

    Returns
    -------
    PairLight
    """
    out = PairLight.empty(counts[0].shape) if out is None else out

    for n, table in enumerate(tables):
        light, flags, noise = out.light[n], out.flags[n], table.noise
        out.peaks[n] = _measure_bands(
            counts[n],
            (table.dark, noise.per_flat, table.least, table.bad, table.full_scale),
            (noise.dry_light, table.least_above_dry, np.float32(energy)),
            (table.rows, table.columns),
            (light, flags, out.half[n], out.half_weight[n], out.blocks[n]),
        )
        if out.variance.size:
            variances = out.variance[n], out.variance_fixed[n]
            fill_noise(light, tuple(noise), np.float32(energy), *variances, 0, light.shape[0])
    out.energy[0] = energy
    return out


@njit(nogil=True, cache=True, error_model="numpy")
def _measure_bands(counts, pixels, dry, gaps, images):  # type: ignore[no-untyped-def]
    """Fill the images of one camera while their rows are in the cache; return the highest count."""
    dark, per_flat, least, bad, full_scale = pixels
    dry_light, least_above_dry, energy = dry
    rows, columns = gaps
    light, flags, half, half_weight, blocks = images
    height = light.shape[0]
    highest = done = filled = 0
    for start in range(0, height, _BAND):
        stop = min(start + _BAND, height)
        part = slice(start, stop)
        most = _correct_counts(
            counts[part],
            dark[part],
            per_flat[part],
            least[part],
            bad[part],
            full_scale,
            light[part],
            flags[part],
        )
        highest = max(highest, most)
        if dry_light.size > 0:
            _subtract_background(
                light[part], flags[part], dry_light[part], least_above_dry[part], energy
            )

        # interpolation would ring about bad pixels; they are filled from rows below them, too
        ready = height if stop == height else (stop - _FARTHEST) // BLOCK * BLOCK
        first = filled
        while filled < rows.size and rows[filled] < ready:
            filled += 1
        fill_bad_pixels(light, bad, rows[first:filled], columns[first:filled], _FARTHEST)
        half_rows = slice(done // 2, ready // 2)
        block_rows = slice(done // BLOCK, -(-ready // BLOCK))
        _bin(
            light[done:ready],
            flags[done:ready],
            half[half_rows],
            half_weight[half_rows],
            blocks[block_rows],
        )
        done = ready
    return highest


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _correct_counts(  # type: ignore[no-untyped-def]
    counts, dark, per_flat, least, bad, full_scale, light, flags
):
    """Fill the last two arguments; return the highest count."""
    highest = 0
    height, width = counts.shape
    for i in range(height):
        for j in range(width):
            light[i, j] = (np.float32(counts[i, j]) - dark[i, j]) * per_flat[i, j]

        # bits by comparisons alone: without branches the loop runs in vector registers
        most = counts[i, 0]
        for j in range(width):
            count = counts[i, j]
            most = max(most, count)
            flag = _SATURATED if count >= full_scale else _NONE
            flag |= _DIM if count < least[i, j] else _NONE
            flag |= _MASKED if dark[i, j] != dark[i, j] else _NONE
            flags[i, j] = flag | (_BAD_PIXEL if bad[i, j] else _NONE)
        highest = max(highest, most)
    return highest


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _subtract_background(light, flags, background, least, energy):  # type: ignore[no-untyped-def]
    """Take the light of the dry joint away, (counts - dark - energy (page - dark))/flat.

    The bit of dim pixels is made anew; page is the mean of the dry joint.
    """
    keep = np.uint16(0xFFFF) ^ _DIM
    for i in range(light.shape[0]):
        for j in range(light.shape[1]):
            value = light[i, j] - energy * background[i, j]
            light[i, j] = value
            flags[i, j] = (flags[i, j] & keep) | (_DIM if value < least[i, j] else _NONE)


@njit(nogil=True, cache=True)
def fill_bad_pixels(signal, bad, rows, columns, farthest):  # type: ignore[no-untyped-def]
    """Replace each bad pixel by the mean of the good ones in the smallest square that has some.

    Parameters
    ----------
    signal : array, (y, x)
        Changed in place; a pixel without a good one near stays as it is.
    bad : array of bool, (y, x)
    rows, columns : array, (pixel,)
        Places of the bad pixels.
    farthest : int
        Largest distance of a good pixel along either axis. [px]
    """
    height, width = signal.shape
    for n in range(rows.size):
        i, j = rows[n], columns[n]
        for reach in range(1, farthest + 1):
            total = 0.0
            count = 0
            for k in range(max(i - reach, 0), min(i + reach + 1, height)):
                for m in range(max(j - reach, 0), min(j + reach + 1, width)):
                    if not bad[k, m]:
                        total += signal[k, m]
                        count += 1

            if count > 0:
                signal[i, j] = total / count
                break


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _bin(light, flags, half, half_weight, blocks):  # type: ignore[no-untyped-def]
    """Fill the last three arguments."""
    height, width = light.shape
    total = np.empty(width, np.float32)
    count = np.empty(width, np.float32)
    for i in range(half.shape[0]):
        # first the sum of two rows, then of two columns
        for j in range(width):
            upper = flags[2 * i, j] & UNUSABLE == 0
            lower = flags[2 * i + 1, j] & UNUSABLE == 0
            count[j] = (_ONE if upper else _ZERO) + (_ONE if lower else _ZERO)
            total[j] = light[2 * i, j] if upper else _ZERO
            total[j] += light[2 * i + 1, j] if lower else _ZERO
        for j in range(half.shape[1]):
            sound = count[2 * j] + count[2 * j + 1]
            level = total[2 * j] + total[2 * j + 1]
            usable = sound > np.float32(2)
            half[i, j] = level / sound if usable else _ZERO
            half_weight[i, j] = _ONE if usable else _ZERO

    for k in range(blocks.shape[0]):
        top, bottom = k * BLOCK, min((k + 1) * BLOCK, height)
        total[:] = _ZERO
        for i in range(top, bottom):
            for j in range(width):
                total[j] += light[i, j]
        for m in range(blocks.shape[1]):
            left, right = m * BLOCK, min((m + 1) * BLOCK, width)
            level = _ZERO
            for j in range(left, right):
                level += total[j]
            blocks[k, m] = level / np.float32((bottom - top) * (right - left))


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
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
