"""Logarithm of camera 2 over camera 1, which depends on the film and not on the laser.

The noise of the logarithm is nearly Gaussian, its standard deviation is the relative error of the
ratio, and exchanged cameras change its sign alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.core.arrays import FAST, Image
from erlif.core.flags import Flag
from erlif.core.products import AlignedFrames, RatioImages, require
from erlif.core.speed.kernels import njit
from erlif.ratio.bubbles import flag_bubbles
from erlif.ratio.pair import PairRatio, gather_ratios
from erlif.ratio.sharpness import BlurDifference

_NAN, _ZERO, _HALF, _ONE, _TWO = (np.float32(value) for value in (np.nan, 0, 0.5, 1, 2))
_DIM, _MASKED, _NONE = np.uint16(Flag.DIM), np.uint16(Flag.MASKED), np.uint16(0)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`

# logarithm of 1 + f, f from sqrt(1/2) - 1 to sqrt(2) - 1, after f - f^2/2 (Cephes library, logf);
# the logarithm of 2 in two parts, so that whole multiples of the first are exact
_L0, _L1, _L2, _L3, _L4, _L5, _L6, _L7, _L8 = (
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
_LN2_LOW, _LN2_HIGH = np.float32(-2.12194440e-4), np.float32(0.693359375)
_ROOT_HALF_BITS = np.int32(np.float32(np.sqrt(0.5)).view(np.int32))
_MANTISSA_BITS = np.int32(23)


def compute_ratio(
    frames: AlignedFrames, *, no_film_below: float = 0.25, blur: BlurDifference | None = None
) -> RatioImages:
    """Logarithm of camera 2 over camera 1 with its variance and flags.

    The logarithm of a noisy signal is too small by half its relative variance. This is corrected
    for each camera, so that the result is unbiased to second order.

    Parameters
    ----------
    frames : AlignedFrames
        signal, signal_var, signal_var_fixed and flags (camera, frame, y, x), displacement_std
        (y, x), and interpolation (frame) where camera 2 was interpolated.
    no_film_below : float
        Share of the light of its surroundings below which a pixel is flagged no_film with its
        neighbours: a bubble, or bare wall. [1]
    blur : BlurDifference, optional
        Difference of sharpness, whose ghost of the speckle is subtracted from the ratio, and the
        excess of its mean.

    Returns
    -------
    RatioImages
        log_ratio (frame, y, x), its variances and flags; noise_correlation (frame), above 1 where
        the interpolation of camera 2 correlates the noise of neighbours [1]; signal_camera1, light
        of camera 1 for the energy of the pulse [DN].

    Raises
    ------
    ErlifError
        If a variable is missing.

    Examples
    --------
    Light of 4000 and 2000 DN with 1 % noise each:

    >>> import xarray as xr
    >>> dims = ("camera", "frame", "y", "x")
    >>> light = np.ones((2, 1, 16, 16), np.float32) * np.reshape([4000, 2000], (2, 1, 1, 1))
    >>> frames = AlignedFrames(xr.Dataset({
    ...     "signal": (dims, light),
    ...     "signal_var": (dims, 1e-4 * light**2),
    ...     "signal_var_fixed": (dims, np.zeros_like(light)),
    ...     "flags": (dims, np.zeros(light.shape, np.uint16)),
    ...     "displacement_std": (("y", "x"), np.zeros((16, 16))),
    ... }))
    >>> ratios = compute_ratio(frames)
    >>> round(float(np.exp(ratios.log_ratio[0, 8, 8])), 4)
    0.5
    >>> round(float(np.sqrt(ratios.log_ratio_var[0, 8, 8])), 5)
    0.01414
    """
    require(frames, "signal", "signal_var", "signal_var_fixed", "flags", "displacement_std")
    signal, variance, fixed = (
        np.ascontiguousarray(frames[name].values, np.float32)
        for name in ("signal", "signal_var", "signal_var_fixed")
    )
    map_var = np.square(frames.displacement_std.values, dtype=float).astype(np.float32)
    no_flags = np.zeros(map_var.shape, np.uint16)  # those of the map are among those of camera 2
    # without a difference of sharpness there is no ghost
    blur = BlurDifference() if blur is None else blur
    along = np.array([*blur.corrected, blur.corrected_excess], np.float32)

    ratios = []
    for n in range(signal.shape[1]):
        ratio = empty_ratio(map_var.shape)
        one, two = signal[:, n]
        noise = variance[0, n], fixed[0, n], variance[1, n], fixed[1, n]
        flags = *frames.flags.values[:, n], no_flags
        total, of_two = divide_rows(
            one, two, *noise, *flags, map_var, *along, *ratio.images, 0, 0, len(one)
        )

        # bubbles are dark in both bands, which the ratio alone does not show
        flag_bubbles(one, two, ratio.flags, share=no_film_below)
        correlation = 1.0
        if "interpolation" in frames:
            correlation = correlate_noise(total, of_two, float(frames.interpolation[n]))
        ratios.append(replace(ratio, light_one=one, noise_correlation=correlation))
    coords = {name: value for name, value in frames.coords.items() if "camera" not in value.dims}
    return RatioImages(gather_ratios(ratios).assign_coords(coords))


def correlate_noise(total: float, of_two: float, averaging: float) -> float:
    """Variance of a mean over many pixels, relative to that of independent pixels.

    Interpolation lowers the variance of single pixels of camera 2, not that of their mean.

    Parameters
    ----------
    total, of_two : float
        Variance of the log ratio, summed over the valid pixels, and its part by camera 2. [1]
    averaging : float
        Mean factor by which the interpolation lowers the variance of camera 2. [1]

    Returns
    -------
    float
        [1]

    Examples
    --------
    >>> correlate_noise(2.0, 1.0, 0.5)
    1.5
    """
    share = of_two / total if total > 0 else 0.0
    return 1 + share * (1 / averaging - 1)


def empty_ratio(
    shape: tuple[int, int],
    *,
    with_fixed: bool = True,
    replaces: tuple[Image, Image] | None = None,
) -> PairRatio:
    """Arrays for frames of a shape (y, x), to be filled by `divide_rows`.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns.
    with_fixed : bool
        Whether `variance_fixed` is kept; otherwise all rows share one.
    replaces : tuple of two array, optional
        Memory for the ratio, and for its variance. The latter may be the light of camera 2 in the
        `PairLight` that `divide_rows` reads: a row is replaced when it is not needed any more.

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
    return PairRatio(log_ratio, variance, fixed, shared, np.empty(shape, np.uint16), light_one)


@njit(nogil=True, cache=True, error_model="numpy", fastmath={"contract"})
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


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def divide_rows(  # type: ignore[no-untyped-def]
    one,
    two,
    var_one,
    fixed_one,
    var_two,
    fixed_two,
    flags_one,
    flags_two,
    map_flags,
    map_var,
    along_x,
    along_y,
    excess,
    log_ratio,
    variance,
    fixed,
    shared,
    flags,
    first,
    start,
    stop,
):
    """Fill rows of a log ratio, its three variances and its flags.

    Parameters
    ----------
    one, two : array, (y, x)
        Light of both cameras on one grid. [DN]
    var_one, fixed_one : array, (row, x)
        Variances of camera 1; row j is stored as row j modulo their number of rows. [DN2]
    var_two, fixed_two, flags_two : array, (row, x)
        Variances and flags of camera 2, from row `first` of the image on.
    flags_one, map_flags : array, (y, x)
        Flags of camera 1 and of the map.
    map_var : array, (y, x)
        Variance of one component of the displacement. [px2]
    along_x, along_y : float32
        Difference of sharpness, whose ghost is subtracted. [px2]
    excess : float32
        Excess of the mean log ratio, which is subtracted. [1]
    log_ratio, variance, fixed, shared, flags : array, (y, x)
        Receive the rows; `fixed` may have a single row.
    first, start, stop : int

    Returns
    -------
    tuple of two float
        Sums of the variance over the valid pixels, of both cameras and of camera 2. [1]
    """
    height, width = one.shape
    ghost = along_x != _ZERO or along_y != _ZERO
    total, of_two = 0.0, 0.0
    values = np.empty((2, width), np.float32)
    bits = values.view(np.int32)
    spare = np.empty((4, width), np.float32)  # logarithms of products of three rows, and one more

    # the ratio of each row, and for the ghost the product of both cameras in the row below
    for below in range(max(start - 1, 0) if ghost else start + 1, stop + 1):
        row = below - 1
        _take_logs(one, two, row, start, ghost, values, bits, spare)
        if row < start:
            continue

        variances = var_one, fixed_one, var_two, fixed_two
        bits_of = flags_one, flags_two, map_flags
        images = log_ratio, variance, fixed, flags
        sums = _divide_row(one, two, variances, bits_of, row, first, excess, values, spare, images)
        total += float(sums[0])
        of_two += float(sums[1])

        # half the logarithm of the product is the mean of both cameras' logarithms
        y, inside = _at(row), row > 0 and row < height - 1
        if ghost and inside:
            up, mid, down = _at((row - 1) % 3), _at(row % 3), _at((row + 1) % 3)
            for t in range(1, width - 1):
                x = _at(t)
                here = spare[mid, x]
                bend_x = (spare[mid, _at(t - 1)] - here) + (spare[mid, _at(t + 1)] - here)
                bend_y = (spare[up, x] - here) + (spare[down, x] - here)
                left_over = _HALF * (along_x * bend_x + along_y * bend_y)
                log_ratio[y, x] -= left_over if left_over == left_over else _ZERO

        # a pixel at the edge has no gradient
        for t in range(0, width, max(width - 1, 1) if inside else 1):
            x = _at(t)
            shared[y, x] = map_var[y, x] * _ZERO
        if inside:
            _shift_row(two, map_var, row, shared)
    return total, of_two


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _take_logs(one, two, row, start, ghost, values, bits, spare):  # type: ignore[no-untyped-def]
    """Logarithm of the ratio of a row, and for the ghost of the product in the row below."""
    height, width = one.shape
    y, z = _at(row), _at(row + 1)
    product_below = ghost and row + 1 < height
    if row >= start:
        for t in range(width):
            x = _at(t)
            a, b = one[y, x], two[y, x]
            values[0, x] = b / a if (a > _ZERO) & (b > _ZERO) else _ONE
    if product_below:
        for t in range(width):
            x = _at(t)
            product = one[z, x] * two[z, x]
            values[1, x] = product if product > _ZERO else _ONE

    for q in range(0 if row >= start else 1, 2 if product_below else 1):
        _take_log(values[q], bits[q], spare[3])
    if product_below:
        for t in range(width):
            x = _at(t)
            lit = one[z, x] * two[z, x] > _ZERO
            spare[_at((row + 1) % 3), x] = values[1, x] if lit else _NAN


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _divide_row(  # type: ignore[no-untyped-def]
    one, two, variances, bits_of, row, first, excess, values, spare, images
):
    """Log ratio, variances and flags of a row; sums of the variance, of both and of camera 2."""
    var_one, fixed_one, var_two, fixed_two = variances
    flags_one, flags_two, map_flags = bits_of
    log_ratio, variance, fixed, flags = images
    width = one.shape[1]
    y, kept = _at(row), _at(row - first)

    # the mean of log(1 + e) is -var(e)/2 for a small relative error e
    only, n = _at(row % var_one.shape[0]), _at(row % fixed.shape[0])
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
        values[0, x] = values[0, x] + _HALF * (of_b - of_a) - excess if light else _NAN
    for t in range(width):
        x = _at(t)
        log_ratio[y, x] = values[0, x]

    for t in range(width):
        x = _at(t)
        flag = flags_one[y, x] | flags_two[kept, x] | map_flags[y, x]
        flag = _MASKED if flags_one[y, x] & _MASKED else flag
        lightless = (flag == _NONE) & (values[0, x] != values[0, x])
        flags[y, x] = _DIM if lightless else flag
    sum_all, sum_two = _ZERO, _ZERO
    for t in range(width):
        x = _at(t)
        valid = flags[y, x] == _NONE
        sum_all += variance[y, x] if valid else _ZERO
        sum_two += spare[3, x] if valid else _ZERO
    return sum_all, sum_two


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _shift_row(two, map_var, row, shared):  # type: ignore[no-untyped-def]
    """Variance by the registration, from Sobel's gradient of camera 2 over its light."""
    y, up, down = _at(row), _at(row - 1), _at(row + 1)
    for t in range(1, two.shape[1] - 1):
        x, left, right = _at(t), _at(t - 1), _at(t + 1)
        a, b, c = two[up, left], two[up, x], two[up, right]
        d, e, f = two[y, left], two[y, x], two[y, right]
        g, h, k = two[down, left], two[down, x], two[down, right]
        in_x = (c - a) + _TWO * (f - d) + (k - g)
        in_y = (g - a) + _TWO * (h - b) + (k - c)
        mean = (a + c + g + k + _TWO * (b + d + f + h) + _TWO * _TWO * e) * _HALF
        size = (in_x * in_x + in_y * in_y) / (mean * mean)
        shared[y, x] = map_var[y, x] * (size if mean > _ZERO else _ZERO)
