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
from erlif.ratio.softening import BlurDifference, Softening, empty_rows, soften_row

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
        Difference of sharpness, by which the sharper camera is blurred before the ratio, and the
        excess of its mean, which is subtracted.

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
    softening = Softening.of(BlurDifference() if blur is None else blur)

    ratios = []
    for n in range(signal.shape[1]):
        ratio = empty_ratio(map_var.shape)
        one, two = signal[:, n]
        noise = variance[0, n], fixed[0, n], variance[1, n], fixed[1, n]
        flags = frames.flags.values[:, n]
        total, of_two = divide_rows(
            one, two, *noise, *flags, map_var, *softening.arrays, *ratio.images, 0, 0, len(one)
        )

        # bubbles are dark in both bands, which the ratio alone does not show
        flag_bubbles(one, two, ratio.flags, share=no_film_below)
        averaging = float(frames.interpolation[n]) if "interpolation" in frames else 1.0
        correlation = correlate_noise(total, of_two, averaging, softening=softening.factors)
        ratios.append(replace(ratio, light_one=one, noise_correlation=correlation))
    coords = {name: value for name, value in frames.coords.items() if "camera" not in value.dims}
    return RatioImages(gather_ratios(ratios).assign_coords(coords))


def correlate_noise(
    total: float, of_two: float, averaging: float, *, softening: tuple[float, float] = (1.0, 1.0)
) -> float:
    """Variance of a mean over many pixels, relative to that of independent pixels.

    Interpolation and blur keep the noise of a mean and lower that of a pixel.

    Parameters
    ----------
    total, of_two : float
        Variance of the log ratio, summed over the valid pixels, and its part by camera 2. [1]
    averaging : float
        Mean factor by which the interpolation lowers the variance of camera 2. [1]
    softening : tuple of two float
        Factors by which the blur of `Softening` lowers the variances of both cameras. [1]

    Returns
    -------
    float
        [1]

    Examples
    --------
    >>> correlate_noise(2.0, 1.0, 0.5)
    1.5
    >>> correlate_noise(2.0, 1.0, 0.5, softening=(0.5, 1.0))
    2.0
    """
    share = of_two / total if total > 0 else 0.0
    one, two = softening
    return 1 + (1 - share) * (1 / one - 1) + share * (1 / (two * averaging) - 1)


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
    map_var,
    taps_one,
    taps_two,
    numbers,
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
        Variances and flags of camera 2, those of the map included, from row `first` of the image
        on.
    flags_one : array, (y, x)
    map_var : array, (y, x)
        Variance of one component of the displacement. [px2]
    taps_one, taps_two, numbers : array
        `Softening.arrays`: the blur of each camera, whose rows above `start` and below `stop` are
        read as far as it reaches.
    log_ratio, variance, fixed, shared, flags : array, (y, x)
        Receive the rows; `fixed` may have a single row.
    first, start, stop : int

    Returns
    -------
    tuple of two float
        Sums of the variance over the valid pixels, of both cameras and of camera 2. [1]
    """
    height, width = one.shape
    total, of_two = 0.0, 0.0
    values = np.empty((1, width), np.float32)
    bits = values.view(np.int32)
    spare = np.empty((2, width), np.float32)
    blurred = np.empty((2, width), np.float32)
    rows_one, rows_two = empty_rows(taps_one, width), empty_rows(taps_two, width)
    soft_one, soft_two = taps_one.shape[1] > 1, taps_two.shape[1] > 1

    for row in range(start, stop):
        y, above = _at(row), row == start
        if soft_one:
            soften_row(one, flags_one, 0, row, above, taps_one, rows_one, blurred[0])
        if soft_two:
            soften_row(two, flags_two, first, row, above, taps_two, rows_two, blurred[1])
        a = blurred[0] if soft_one else one[y]
        b = blurred[1] if soft_two else two[y]

        for t in range(width):
            x = _at(t)
            values[0, x] = b[x] / a[x] if (a[x] > _ZERO) & (b[x] > _ZERO) else _ONE
        _take_log(values[0], bits[0], spare[0])
        variances = var_one, fixed_one, var_two, fixed_two
        bits_of = flags_one, flags_two
        images = log_ratio, variance, fixed, flags
        sums = _divide_row(a, b, variances, bits_of, row, first, numbers, values, spare, images)
        total += float(sums[0])
        of_two += float(sums[1])

        # a pixel at the edge has no gradient
        inside = row > 0 and row < height - 1
        for t in range(0, width, max(width - 1, 1) if inside else 1):
            x = _at(t)
            shared[y, x] = map_var[y, x] * _ZERO
        if inside:
            _shift_row(two, map_var, row, shared)
    return total, of_two


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _divide_row(  # type: ignore[no-untyped-def]
    one, two, variances, bits_of, row, first, numbers, values, spare, images
):
    """Log ratio, variances and flags of a row; sums of the variance, of both and of camera 2."""
    var_one, fixed_one, var_two, fixed_two = variances
    flags_one, flags_two = bits_of
    log_ratio, variance, fixed, flags = images
    excess, factor_one, factor_two = numbers[0], numbers[1], numbers[2]
    width = one.size
    y, kept = _at(row), _at(row - first)

    # the mean of log(1 + e) is -var(e)/2 for a small relative error e
    only, n = _at(row % var_one.shape[0]), _at(row % fixed.shape[0])
    for t in range(width):
        x = _at(t)
        a, b = one[x], two[x]
        light = (a > _ZERO) & (b > _ZERO)
        per_a, per_b = factor_one / (a * a), factor_two / (b * b)
        of_a = (var_one[only, x] + fixed_one[only, x]) * per_a
        of_b = (var_two[kept, x] + fixed_two[kept, x]) * per_b
        spare[1, x] = of_b
        variance[y, x] = of_a + of_b if light else _NAN
        repeats = fixed_one[only, x] * per_a + fixed_two[kept, x] * per_b
        fixed[n, x] = repeats if light else _NAN
        values[0, x] = values[0, x] + _HALF * (of_b - of_a) - excess if light else _NAN
    for t in range(width):
        x = _at(t)
        log_ratio[y, x] = values[0, x]

    for t in range(width):
        x = _at(t)
        flag = flags_one[y, x] | flags_two[kept, x]
        flag = _MASKED if flags_one[y, x] & _MASKED else flag
        lightless = (flag == _NONE) & (values[0, x] != values[0, x])
        flags[y, x] = _DIM if lightless else flag
    sum_all, sum_two = _ZERO, _ZERO
    for t in range(width):
        x = _at(t)
        valid = flags[y, x] == _NONE
        sum_all += variance[y, x] if valid else _ZERO
        sum_two += spare[1, x] if valid else _ZERO
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
