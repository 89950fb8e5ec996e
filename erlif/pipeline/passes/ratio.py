"""Light of one frame pair to the logarithm of its ratio, with variances and flags.

The reference is `erlif.ratio.compute_ratio`. Warp and ratio take turns over bands of rows, so that
few rows of the noise of camera 2 are kept at a time.
"""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np

from erlif.core.arrays import Image
from erlif.core.flags import Flag
from erlif.pipeline.passes.light import PairLight
from erlif.pipeline.passes.noise import CameraNoise, fill_noise
from erlif.pipeline.passes.pair import PairRatio
from erlif.pipeline.passes.warp import MapTables, PairWarp, Warp
from erlif.ratio import BlurDifference, find_bubbles
from erlif.registration.interpolation import FAST

BAND = 64
"""Rows of a band: the noise of camera 2 is kept for one band and the row before it."""

_NAN, _ZERO, _HALF, _ONE, _TWO = (np.float32(value) for value in (np.nan, 0, 0.5, 1, 2))
_DIM, _NO_FILM, _POOR = (
    np.uint8(flag) for flag in (Flag.DIM, Flag.NO_FILM, Flag.POOR_REGISTRATION)
)
_NONE = np.uint8(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# logarithm of 1 + f, f from sqrt(1/2) - 1 to sqrt(2) - 1, after f - f^2/2 (Cephes library, logf);
# the logarithm of 2 in two parts, so that whole multiples of the first are exact
_LOG = tuple(
    np.float32(c)
    for c in (
        7.0376836292e-2,
        -1.1514610310e-1,
        1.1676998740e-1,
        -1.2420140846e-1,
        1.4249322787e-1,
        -1.6668057665e-1,
        2.0000714765e-1,
        -2.4999993993e-1,
        3.3333331174e-1,
    )
)
_L0, _L1, _L2, _L3, _L4, _L5, _L6, _L7, _L8 = _LOG
_LN2_LOW, _LN2_HIGH = np.float32(-2.12194440e-4), np.float32(0.693359375)
_ROOT_HALF_BITS = np.int32(np.float32(np.sqrt(0.5)).view(np.int32))
_MANTISSA_BITS = np.int32(23)


def empty_ratio(
    shape: tuple[int, int],
    *,
    with_fixed: bool = True,
    replaces: tuple[Image, Image] | None = None,
) -> PairRatio:
    """Arrays for frames of a shape (y, x), to be filled by `measure_ratio`.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns.
    with_fixed : bool
        Whether `variance_fixed` is kept; otherwise all rows share one.
    replaces : tuple of two array, optional
        Memory for the ratio, and for its variance. The latter may be the light of camera 2 in the
        `PairLight` that `measure_ratio` reads: a row is replaced when it is not needed any more.

    Returns
    -------
    PairRatio
    """
    if replaces is None:
        replaces = np.empty(shape, np.float32), np.empty(shape, np.float32)
    log_ratio, variance = replaces
    shared = np.empty(shape, np.float32)
    fixed = np.empty((shape[0] if with_fixed else 1, shape[1]), np.float32)
    light_one = np.zeros((0, 0), np.float32)
    return PairRatio(log_ratio, variance, fixed, shared, np.empty(shape, np.uint8), light_one)


def measure_ratio(
    light: PairLight,
    tables: MapTables,
    noise: tuple[CameraNoise, CameraNoise],
    drift: tuple[float, float],
    *,
    blur: BlurDifference,
    no_film_below: float,
    warped: PairWarp,
    out: PairRatio,
) -> PairRatio:
    """Logarithm of camera 2 over camera 1 of one frame pair.

    Parameters
    ----------
    light : PairLight
    tables : MapTables
    noise : tuple of two CameraNoise
        Of camera 1, and of camera 2 turned as its image is.
    drift : tuple of float
        Translation (x, y) of camera 2; NaN where it is not known. [px]
    blur : BlurDifference
        Difference of sharpness, whose ghost is subtracted where it is significant.
    no_film_below : float
        Light relative to the surroundings below which both bands show a bubble. [1]
    warped : PairWarp
        Receives camera 2, its variances and flags in at least `BAND` + 1 rows.
    out : PairRatio
        Its images are filled.

    Returns
    -------
    PairRatio
        With the images of `out`.
    """
    along_x, along_y = (blur.x, blur.y) if blur.significant else (0.0, 0.0)
    warp = Warp(light, tables, noise[1], drift, warped, band=BAND)
    height = out.log_ratio.shape[0]
    total = of_two = 0.0
    done = last = 0
    noise_one, energy = tuple(noise[0]), np.float32(light.energy[0])

    # a row of the ratio needs the row of camera 2 below it, so that of each band one is left over
    for start in range(0, height, BAND):
        stop = min(start + BAND, height)
        for kept in (warped.variance, warped.variance_fixed, warped.flags):
            kept[0] = kept[max(start - 1, 0) - last]
        first = max(start - 1, 0)
        warp.fill(start, stop, first=first)
        last = first
        ready = stop if stop == height else stop - 1
        sums = _ratio_rows(
            light.light[0],
            warped.light,
            noise_one,
            energy,
            warped.variance,
            warped.variance_fixed,
            light.flags[0],
            warped.flags,
            tables.flags,
            tables.variance,
            np.float32(along_x),
            np.float32(along_y),
            out.log_ratio,
            out.variance,
            out.variance_fixed,
            out.variance_shared,
            out.flags,
            first,
            done,
            ready,
        )
        total, of_two, done = total + sums[0], of_two + sums[1], ready

    # NaN drift leaves no pixel valid, and the reason belongs in the flags
    if np.isnan(drift[0]):
        out.flags[:] |= _POOR
    dark = find_bubbles(light.light[0], warped.light, share=no_film_below)
    if dark.any():
        out.flags[:] |= dark.view(np.uint8) * _NO_FILM

    # interpolation lowers the variance of single pixels of camera 2, not that of their mean
    share = of_two / total if total > 0 else 0.0
    one, two = light.peaks
    return replace(
        out,
        light_one=light.light[0],
        noise_correlation=1 + share * (1 / warp.averaging - 1),
        drift=(float(drift[0]), float(drift[1])),
        peaks=(int(one), int(two)),
    )


@numba.njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
def _take_log(values, bits, exponents):  # type: ignore[no-untyped-def]
    """Replace values by their logarithms; `bits` is the same memory as whole numbers."""
    for t in range(values.size):
        x = _at(t)
        exponent = np.int32(np.int32(bits[x] - _ROOT_HALF_BITS) >> _MANTISSA_BITS)
        exponents[x] = np.float32(exponent)
        bits[x] = np.int32(bits[x] - np.int32(exponent << _MANTISSA_BITS))
    for t in range(values.size):
        x = _at(t)
        f = values[x] - _ONE
        square = f * f
        y = ((((_L0 * f + _L1) * f + _L2) * f + _L3) * f + _L4) * f + _L5
        y = (((y * f + _L6) * f + _L7) * f + _L8) * f * square
        y += exponents[x] * _LN2_LOW - _HALF * square
        values[x] = exponents[x] * _LN2_HIGH + (f + y)


@numba.njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _ratio_rows(  # type: ignore[no-untyped-def]
    one,
    two,
    noise_one,
    energy,
    var_two,
    fixed_two,
    flags_one,
    flags_two,
    map_flags,
    map_var,
    along_x,
    along_y,
    log_ratio,
    variance,
    fixed,
    shared,
    flags,
    first,
    start,
    stop,
):
    """Fill rows of the five images; sums of the variance of valid pixels, all and of camera 2."""
    height, width = one.shape
    ghost = along_x != _ZERO or along_y != _ZERO
    total, of_two = 0.0, 0.0
    values = np.empty((2, width), np.float32)
    bits = values.view(np.int32)
    spare = np.empty((4, width), np.float32)  # logarithms of products of three rows, and one more
    var_one = np.empty((1, width), np.float32)
    fixed_one = np.empty((1, width), np.float32)

    # the ratio of each row, and for the ghost the product of both cameras in the row below
    for below in range(max(start - 1, 0) if ghost else start + 1, stop + 1):
        row = below - 1
        y, z, kept = _at(row), _at(below), _at(row - first)
        if row >= start:
            for t in range(width):
                x = _at(t)
                a, b = one[y, x], two[y, x]
                values[0, x] = b / a if (a > _ZERO) & (b > _ZERO) else _ONE
        if ghost and below < height:
            for t in range(width):
                x = _at(t)
                product = one[z, x] * two[z, x]
                values[1, x] = product if product > _ZERO else _ONE
        for q in range(0 if row >= start else 1, 2 if ghost and below < height else 1):
            _take_log(values[q], bits[q], spare[3])
        if ghost and below < height:
            for t in range(width):
                x = _at(t)
                lit = one[z, x] * two[z, x] > _ZERO
                spare[_at(below % 3), x] = values[1, x] if lit else _NAN
        if row < start:
            continue

        # the mean of log(1 + e) is -var(e)/2 for a small relative error e
        fill_noise(one, noise_one, energy, var_one, fixed_one, row, row + 1)
        only, n = _at(0), _at(row % fixed.shape[0])
        for t in range(width):
            x = _at(t)
            a, b = one[y, x], two[y, x]
            light = (a > _ZERO) & (b > _ZERO)
            per_a, per_b = _ONE / (a * a), _ONE / (b * b)
            of_a = (var_one[only, x] + fixed_one[only, x]) * per_a
            of_b = (var_two[kept, x] + fixed_two[kept, x]) * per_b
            spare[3, x] = of_b
            variance[y, x] = of_a + of_b if light else _NAN
            repeats = fixed_one[only, x] * per_a + fixed_two[kept, x] * per_b
            fixed[n, x] = repeats if light else _NAN
            values[0, x] = values[0, x] + _HALF * (of_b - of_a) if light else _NAN
        for t in range(width):
            x = _at(t)
            log_ratio[y, x] = values[0, x]

        for t in range(width):
            x = _at(t)
            flag = flags_one[y, x] | flags_two[kept, x] | map_flags[y, x]
            lightless = (flag == _NONE) & (values[0, x] != values[0, x])
            flags[y, x] = _DIM if lightless else flag
        sum_all, sum_two = _ZERO, _ZERO
        for t in range(width):
            x = _at(t)
            valid = flags[y, x] == _NONE
            sum_all += variance[y, x] if valid else _ZERO
            sum_two += spare[3, x] if valid else _ZERO
        total += float(sum_all)
        of_two += float(sum_two)

        # half the logarithm of the product is the mean of both cameras' logarithms
        inside = row > 0 and row < height - 1
        if ghost and inside:
            up, mid, down = _at((row - 1) % 3), _at(row % 3), _at((row + 1) % 3)
            for t in range(1, width - 1):
                x = _at(t)
                here = spare[mid, x]
                bend_x = (spare[mid, _at(t - 1)] - here) + (spare[mid, _at(t + 1)] - here)
                bend_y = (spare[up, x] - here) + (spare[down, x] - here)
                left_over = _HALF * (along_x * bend_x + along_y * bend_y)
                log_ratio[y, x] -= left_over if left_over == left_over else _ZERO

        # Sobel's gradient of camera 2, over the light: the gradient of the logarithm
        for t in range(width):
            x = _at(t)
            shared[y, x] = map_var[y, x] * _ZERO
        if inside:
            up, down = _at(row - 1), _at(row + 1)
            for t in range(1, width - 1):
                x, left, right = _at(t), _at(t - 1), _at(t + 1)
                a, b, c = two[up, left], two[up, x], two[up, right]
                d, e, f = two[y, left], two[y, x], two[y, right]
                g, h, k = two[down, left], two[down, x], two[down, right]
                in_x = (c - a) + _TWO * (f - d) + (k - g)
                in_y = (g - a) + _TWO * (h - b) + (k - c)
                mean = (a + c + g + k + _TWO * (b + d + f + h) + _TWO * _TWO * e) * _HALF
                size = (in_x * in_x + in_y * in_y) / (mean * mean)
                shared[y, x] = map_var[y, x] * (size if mean > _ZERO else _ZERO)
    return total, of_two
