"""Camera 2 on the pixels of camera 1 by cubic B-spline interpolation, and the noise afterwards.

The cubic B-spline passes through the pixels (unlike a smoothing kernel) and reproduces polynomials
up to the third degree. Its coefficients come from a recursive filter along each axis (Unser,
Aldroubi and Eden 1993).
"""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np

from erlif.core.arrays import FAST, AnyArray, Image, Mask
from erlif.core.errors import RegistrationError
from erlif.core.flags import Flag
from erlif.core.speed.kernels import njit
from erlif.correction.light import fill_bad_pixels
from erlif.registration.bands import in_bands

# Pole of the filter that turns samples into cubic B-spline coefficients.
_POLE: Final = np.float32(np.sqrt(3.0) - 2.0)
# Samples that start the causal filter: the power of the pole falls below 1e-9.
_START: Final = 16
# Mirrored coefficients on every side, so that the sixteen taps need no check of bounds.
_MARGIN: Final = 2
# Mirrored samples on both sides of a row, from which the filters start.
_BESIDE: Final = _START
# Displacements beyond this lie outside any image and beyond the precision of float32. [px]
FARTHEST: Final = np.float32(1e6)
# Distance over which a gap is filled from its neighbours; the spline's own reach. [px]
_REACH: Final = 9

# Lines of `sample_rows`.
_U, _V, _COLUMN, _ROW, _FACTOR, _LINES = range(6)

# single precision throughout: a loop with one double is half as fast
_ZERO, _ONE, _THREE, _FOUR, _SIX = (np.float32(value) for value in (0, 1, 3, 4, 6))
_PER_36: Final = np.float32(1 / 36)
# Factor of the cubic term of the noise, see `interpolation_variance_factor`.
_CUBIC: Final = np.float32(14 - 6 * np.sqrt(3))
_NAN: Final = np.float32(np.nan)

# an unsigned index cannot count from the end; without this case the loops run in vector registers
_at = np.uint64
_NEXT, _SAME = np.uint8(1), np.uint8(0)
_OUTSIDE: Final = np.uint16(Flag.OUTSIDE_OVERLAP)


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def filter_columns(image: AnyArray, out: AnyArray, start: int, stop: int) -> None:
    """Filter the columns ``start`` to ``stop`` along y, mirrored about the outer pixels.

    ``out`` has a margin of two on every side; those above and below are not filled.
    """
    n = image.shape[0]
    z = _POLE
    m = _MARGIN
    period = 2 * n - 2

    # the causal filter starts with the sum over the mirrored samples before the first
    for x in range(start, stop):
        out[m, x + m] = image[0, x]
    power = z
    for k in range(1, _START):
        j = k % period
        if j >= n:
            j = period - j
        for x in range(start, stop):
            out[m, x + m] += power * image[j, x]
        power *= z
    for row in range(1, n):
        y, at, before = _at(row), _at(m + row), _at(m + row - 1)
        for t in range(start, stop):
            column = _at(t + m)
            out[at, column] = image[y, _at(t)] + z * out[before, column]

    # the anticausal filter runs back; the gain of 6 makes the sum of the weights 1
    gain = z / (z * z - np.float32(1))
    for x in range(start + m, stop + m):
        out[m + n - 1, x] = np.float32(6) * gain * (out[m + n - 1, x] + z * out[m + n - 2, x])
    for row in range(n - 2, -1, -1):
        at, after = _at(m + row), _at(m + row + 1)
        for t in range(start, stop):
            column = _at(t + m)
            out[at, column] = z * (out[after, column] - np.float32(6) * out[at, column])


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def filter_rows(out: AnyArray, start: int, stop: int) -> None:
    """Filter the rows ``start`` to ``stop`` along x in place, and mirror the margins.

    The recursive filter 1 + z + z^2 + ... is the product of 1 + z, 1 + z^2, 1 + z^4 and 1 + z^8,
    each of which takes all pixels of a row at once.
    """
    n = out.shape[1] - 2 * _MARGIN
    size = n + 2 * _BESIDE
    period = 2 * n - 2
    z = _POLE
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    gain = np.float32(-6) * z
    a = np.empty(size, np.float32)
    b = np.empty(size, np.float32)

    for y in range(start + _MARGIN, stop + _MARGIN):
        for x in range(n):
            a[x + _BESIDE] = out[y, x + _MARGIN]
        for k in range(1, _BESIDE + 1):
            left = k % period
            right = (n - 1 + k) % period
            a[_BESIDE - k] = a[_BESIDE + (left if left < n else period - left)]
            a[_BESIDE + n - 1 + k] = a[_BESIDE + (right if right < n else period - right)]

        # the causal factors
        for x in range(1, size):
            b[x] = a[x] + z * a[x - 1]
        for x in range(3, size):
            a[x] = b[x] + z2 * b[x - 2]
        for x in range(7, size):
            b[x] = a[x] + z4 * a[x - 4]
        for x in range(15, size):
            a[x] = b[x] + z8 * b[x - 8]

        # the anticausal ones, and the gain that makes the sum of the weights 1
        for x in range(15, size - 1):
            b[x] = a[x] + z * a[x + 1]
        for x in range(15, size - 3):
            a[x] = b[x] + z2 * b[x + 2]
        for x in range(15, size - 7):
            b[x] = a[x] + z4 * a[x + 4]
        for x in range(n):
            out[y, x + _MARGIN] = gain * (b[x + _BESIDE] + z8 * b[x + _BESIDE + 8])
        out[y, 1], out[y, 0] = out[y, 3], out[y, 4]
        out[y, n + 2], out[y, n + 3] = out[y, n], out[y, n - 1]


def spline_coefficients(image: AnyArray, *, threads: int = 1) -> Image:
    """Return the cubic B-spline coefficients of an image, mirrored about its outer pixels.

    Parameters
    ----------
    image : array, (y, x)
        Finite values, at least 3 by 3 pixels.
    threads : int
        Threads to use; the result does not depend on it.

    Returns
    -------
    array, (y + 4, x + 4), float32
        Coefficients with a margin of two mirrored ones on every side, ready for `sample_rows`.

    Examples
    --------
    The B-spline has the values 4/6 at its centre and 1/6 at its neighbours, so an even image is its
    own spline, and a single coefficient of 36 is an image of 16, 4 and 1.

    >>> bool(np.allclose(spline_coefficients(np.full((5, 6), 7.0)), 7.0))
    True
    >>> image = np.zeros((9, 9))
    >>> image[3:6, 3:6] = np.outer([1, 4, 1], [1, 4, 1])
    >>> np.round(spline_coefficients(image)[5:8, 5:8], 3) + 0.0
    array([[ 0.,  0.,  0.],
           [ 0., 36.,  0.],
           [ 0.,  0.,  0.]], dtype=float32)
    """
    found = filtered_columns(image, threads=threads)
    in_bands(lambda a, b: filter_rows(found, a, b), image.shape[0], threads)
    mirror_rows(found)
    return found


def filtered_columns(image: AnyArray, *, threads: int = 1, out: Image | None = None) -> Image:
    """The first half of `spline_coefficients`: `filter_rows` and `mirror_rows` are left.

    Parameters
    ----------
    image, threads, out
        As of `spline_coefficients`.

    Returns
    -------
    array, (y + 4, x + 4), float32
    """
    h, w = image.shape
    image = np.ascontiguousarray(image, np.float32)
    found = np.empty((h + 2 * _MARGIN, w + 2 * _MARGIN), np.float32) if out is None else out
    in_bands(lambda a, b: filter_columns(image, found, a, b), w, threads)
    return found


def mirror_rows(out: Image) -> None:
    """Fill the margins above and below coefficients."""
    h = out.shape[0] - 2 * _MARGIN
    out[1], out[0] = out[3], out[4]
    out[_MARGIN + h], out[_MARGIN + h + 1] = out[_MARGIN + h - 2], out[_MARGIN + h - 3]


# Stands for a variance that is not asked for.
NOTHING: Final = np.zeros((0, 0), np.float32)
# Stands for flags that are not asked for.
NO_FLAGS: Final = np.zeros((0, 0), np.uint16)
# Mask for `sample_rows` if all pixels are valid.
NOTHING_BAD: Final = np.zeros((0, 0), np.bool_)


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _place_row(  # type: ignore[no-untyped-def]
    displacement_x, displacement_y, drift_x, drift_y, y, last_column, rows_left, line
):
    """Fractions and whole parts of the displacement in a row."""
    for t in range(line.shape[1]):
        x = _at(t)
        u = displacement_x[y, x] + drift_x
        v = displacement_y[y, x] + drift_y
        known = (abs(u) < FARTHEST) & (abs(v) < FARTHEST)
        u = u if known else -FARTHEST
        v = v if known else -FARTHEST

        # the fraction is taken from the displacement alone, which float32 holds to a
        # millionth of a pixel; the sum with x would lose three digits
        whole_u = np.floor(u)
        whole_v = np.floor(v)
        u -= whole_u
        v -= whole_v

        # the last column and row are reached from the pixel before them
        at_right = (np.float32(t) + whole_u == last_column) & (u == _ZERO)
        at_bottom = (whole_v == rows_left) & (v == _ZERO)
        line[_U, x] = _ONE if at_right else u
        line[_V, x] = _ONE if at_bottom else v
        line[_COLUMN, x] = whole_u - _ONE if at_right else whole_u
        line[_ROW, x] = whole_v - _ONE if at_bottom else whole_v


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _find_changes(line, changes):  # type: ignore[no-untyped-def]
    """Mark the points of a row at which the whole part of the position changes."""
    for t in range(1, line.shape[1]):
        x, before = _at(t), _at(t - 1)
        other = (line[_COLUMN, x] != line[_COLUMN, before]) | (line[_ROW, x] != line[_ROW, before])
        changes[x] = _NEXT if other else _SAME


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _find_factors(line):  # type: ignore[no-untyped-def]
    """Factors of the variance in a row, see `interpolation_variance_factor`."""
    for t in range(line.shape[1]):
        x = _at(t)
        p = line[_U, x] * (_ONE - line[_U, x])
        q = line[_V, x] * (_ONE - line[_V, x])
        along_x = _ONE - p * p * (_THREE + _CUBIC * p)
        line[_FACTOR, x] = along_x * (_ONE - q * q * (_THREE + _CUBIC * q))


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _end_of_run(begin, changes, eights):  # type: ignore[no-untyped-def]
    """The end of a run of one whole part, eight pixels at a time."""
    end = begin + 1
    while end & 7 and not changes[end]:
        end += 1
    if not end & 7:
        k = end >> 3
        while not eights[k]:
            k += 1
        end = k << 3
        while not changes[end]:
            end += 1
    return end


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _sample_run(coefficients, line, j, shift, low, full, out):  # type: ignore[no-untyped-def]
    """Values of a run: the four B-splines that reach each point, along x and along y.

    Pixel i has its coefficient at i + 2, so the first of the four taps is at i + 1.
    """
    j1, j2, j3, j4 = _at(j + 1), _at(j + 2), _at(j + 3), _at(j + 4)
    for t in range(low, full):
        x = _at(t)
        i1, i2 = _at(shift + t + 1), _at(shift + t + 2)
        i3, i4 = _at(shift + t + 3), _at(shift + t + 4)
        u = line[_U, x]
        v = line[_V, x]
        a0 = (_ONE - u) * (_ONE - u) * (_ONE - u)
        a1 = _FOUR + u * u * (_THREE * u - _SIX)
        a3 = u * u * u
        a2 = _SIX - a0 - a1 - a3
        b0 = (_ONE - v) * (_ONE - v) * (_ONE - v)
        b1 = _FOUR + v * v * (_THREE * v - _SIX)
        b3 = v * v * v
        b2 = _SIX - b0 - b1 - b3

        s1 = b0 * coefficients[j1, i1] + b1 * coefficients[j2, i1]
        s1 += b2 * coefficients[j3, i1] + b3 * coefficients[j4, i1]
        s2 = b0 * coefficients[j1, i2] + b1 * coefficients[j2, i2]
        s2 += b2 * coefficients[j3, i2] + b3 * coefficients[j4, i2]
        s3 = b0 * coefficients[j1, i3] + b1 * coefficients[j2, i3]
        s3 += b2 * coefficients[j3, i3] + b3 * coefficients[j4, i3]
        s4 = b0 * coefficients[j1, i4] + b1 * coefficients[j2, i4]
        s4 += b2 * coefficients[j3, i4] + b3 * coefficients[j4, i4]
        out[x] = (a0 * s1 + a1 * s2 + a2 * s3 + a3 * s4) * _PER_36


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _mask_run(bad, line, j, shift, low, high, out):  # type: ignore[no-untyped-def]
    """NaN where one of the pixels of a point is marked."""
    j0, j1 = _at(j), _at(j + 1)
    for t in range(low, high):
        x, i0, i1 = _at(t), _at(shift + t), _at(shift + t + 1)
        left, above = line[_U, x] < _ONE, line[_V, x] < _ONE
        hit = (bad[j0, i0] & left & above) | (bad[j0, i1] & above)
        hit |= (bad[j1, i0] & left) | bad[j1, i1]
        out[x] = _NAN if hit else out[x]


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _interpolate_run(  # type: ignore[no-untyped-def]
    given, line, j, shift, low, full, out
):
    """A variance of a run, bilinear between the pixels of camera 2, times its factor."""
    k0, k1 = _at(j % given.shape[0]), _at((j + 1) % given.shape[0])
    for t in range(low, full):
        x, i0, i1 = _at(t), _at(shift + t), _at(shift + t + 1)
        u = line[_U, x]
        v = line[_V, x]
        upper = given[k0, i0] + u * (given[k0, i1] - given[k0, i0])
        lower = given[k1, i0] + u * (given[k1, i1] - given[k1, i0])
        out[x] = (upper + v * (lower - upper)) * line[_FACTOR, x]


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def sample_rows(  # type: ignore[no-untyped-def]
    coefficients,
    displacement_x,
    displacement_y,
    drift_x,
    drift_y,
    bad,
    variance,
    fixed,
    flags,
    out,
    out_variance,
    out_fixed,
    out_flags,
    first,
    start,
    stop,
):
    """Evaluate the spline in some rows, with the noise and the flags of camera 2 where given.

    The whole part of the displacement is constant over long runs of a row. Within a run the pixels
    of camera 2 follow each other as those of camera 1 do, and the loops run in vector registers.

    Parameters
    ----------
    coefficients : array, (y2 + 4, x2 + 4), float32
        As `spline_coefficients` makes them from the image of camera 2.
    displacement_x, displacement_y : array, (y, x), float32
        Camera-2 pixel minus camera-1 pixel. [px]
    drift_x, drift_y : float32
        Translation of this frame, added to the displacement. [px]
    bad : array, (y2, x2), bool
        Marked pixels of camera 2, or an array of size 0.
    variance, fixed : array, (y2, x2), float32
        Two variances of camera 2, or arrays of size 0. They are interpolated bilinearly and
        multiplied by the factor of `interpolation_variance_factor`. With fewer rows than camera 2,
        they have those that are needed; row j is row j modulo their number.
    flags : array, (y2, x2), uint16
        Flags of all pixels from which a point between this pixel and the next is interpolated, or
        an array of size 0.
    out : array, (y, x), float32
        Receives the values; NaN where the point falls outside the image, or where one of the four
        pixels around it is marked in ``bad``.
    out_variance, out_fixed : array, (y, x), float32
        Receive the variances; NaN outside the image.
    out_flags : array, (y, x), uint16
        Receives the flags; OUTSIDE_OVERLAP outside the image.
    first : int
        The row that is stored as row 0 of `out_variance`, `out_fixed` and `out_flags`.
    start, stop : int
        Rows to evaluate.

    Returns
    -------
    float
        Sum of the factors of the variance over all points inside the image.
    int
        Number of these points, both 0 without variances.
    """
    h = coefficients.shape[0] - 2 * _MARGIN
    w = coefficients.shape[1] - 2 * _MARGIN
    width = out.shape[1]
    noisy = variance.size > 0
    total = 0.0
    count = 0

    # of one row: fractions of the displacement, its whole parts, the factors of the variance, and
    # where the whole parts change
    line = np.empty((_LINES, width), np.float32)
    changes = np.zeros((width // 8 + 1) * 8, np.uint8)
    changes[width] = _NEXT
    eights = changes.view(np.uint64)

    for row in range(start, stop):
        y, kept = _at(row), _at(row - first)
        last_column, rows_left = np.float32(w - 1), np.float32(h - 1 - row)
        _place_row(
            displacement_x, displacement_y, drift_x, drift_y, y, last_column, rows_left, line
        )
        _find_changes(line, changes)
        if noisy:
            _find_factors(line)

        begin = 0
        while begin < width:
            end = _end_of_run(begin, changes, eights)

            # the part of the run that camera 2 sees
            shift = int(line[_COLUMN, _at(begin)])
            j = row + int(line[_ROW, _at(begin)])
            last = min(width, w - 1 - shift)
            low = min(max(begin, -shift), end)
            high = max(min(end, last), low)
            if j < 0 or j > h - 2:
                low = high = end
            for part in range(2):
                lost, until = (begin, low) if part == 0 else (high, end)
                for t in range(lost, until):
                    out[y, _at(t)] = _NAN
                if noisy:
                    for t in range(lost, until):
                        x = _at(t)
                        out_variance[kept, x] = _NAN
                        out_fixed[kept, x] = _NAN
                        out_flags[kept, x] = _OUTSIDE
                        line[_FACTOR, x] = _ZERO

            # whole registers: what they fill beyond the run, the next run fills again
            full = min(low + (high - low + 15) // 16 * 16, last) if high > low else low
            flagged = min(low + (high - low + 63) // 64 * 64, last) if high > low else low
            _sample_run(coefficients, line, j, shift, low, full, out[y])
            if bad.size > 0:
                _mask_run(bad, line, j, shift, low, high, out[y])
            if noisy:
                _interpolate_run(variance, line, j, shift, low, full, out_variance[kept])
                _interpolate_run(fixed, line, j, shift, low, full, out_fixed[kept])
                for t in range(low, flagged):
                    out_flags[kept, _at(t)] = flags[_at(j), _at(shift + t)]
                count += high - low
            begin = end

        if noisy:
            some = _ZERO
            for t in range(width):
                some += line[_FACTOR, _at(t)]
            total += float(some)
    return total, count


def laid_over(
    spline: tuple[Image, Mask],
    dx: Image,
    dy: Image,
    drift: tuple[float, float],
    threads: int,
    *,
    only: Sequence[tuple[int, int]] | None = None,
) -> Image:
    """Read an image of camera 2 at the pixels of camera 1.

    Parameters
    ----------
    spline : (array, array)
        Coefficients of camera 2 and its marked pixels, as for `sample_rows`.
    dx, dy : array, (y, x), float32
        Displacement at each pixel of camera 1. [px]
    drift : (float, float)
        Translation (x, y) that is added to the displacement. [px]
    threads : int
        Threads to use.
    only : sequence of (int, int), optional
        Bands of rows, first and behind the last, that are read; the others are not set.

    Returns
    -------
    array, (y, x), float32
        NaN as for `sample_rows`.

    Examples
    --------
    A ramp of 2 per column, half a pixel to the right:

    >>> ramp = spline_coefficients(np.tile(2.0 * np.arange(60), (40, 1))), NOTHING_BAD
    >>> half = np.full((40, 60), 0.5, np.float32)
    >>> round(float(laid_over(ramp, half, 0 * half, (0.0, 0.0), 1)[20, 30]), 4)
    61.0
    """
    out = np.empty(dx.shape, np.float32)
    coefficients, bad = spline
    field = dx, dy, np.float32(drift[0]), np.float32(drift[1])
    noise = NOTHING, NOTHING, NO_FLAGS

    def read(start: int, stop: int) -> None:
        sample_rows(coefficients, *field, bad, *noise, out, *noise, 0, start, stop)

    if only is None:
        in_bands(read, dx.shape[0], threads)
    for start, stop in only or ():
        read(start, stop)
    return out


def warp(
    image: AnyArray,
    displacement_x: AnyArray,
    displacement_y: AnyArray,
    drift: tuple[float, float] = (0.0, 0.0),
    *,
    threads: int = 1,
) -> Image:
    """Sample camera 2 at the pixels of camera 1.

    Parameters
    ----------
    image : array, (y2, x2)
        Camera 2, oriented like camera 1. A pixel that is not finite is left out, and so are all
        results that have it among their sixteen taps.
    displacement_x, displacement_y : array, (y, x)
        Camera-2 pixel minus camera-1 pixel. [px]
    drift : (float, float)
        Translation of this frame added to the displacement, ``(dx, dy)``. [px]
    threads : int
        Threads to use; the result does not depend on it.

    Returns
    -------
    array, (y, x), float32
        NaN where the point lies outside camera 2.

    Raises
    ------
    RegistrationError
        If the displacements do not have one shape, or the image is smaller than 3 by 3.

    Examples
    --------
    Camera 2 sees a point three columns to the right of camera 1 and one row higher.

    >>> camera_2 = np.zeros((8, 8))
    >>> camera_2[3, 6] = 100.0
    >>> flat = np.zeros((8, 8))
    >>> found = warp(camera_2, flat + 3, flat - 1)
    >>> np.argwhere(found > 50).tolist()
    [[4, 3]]
    """
    if displacement_x.shape != displacement_y.shape or displacement_x.ndim != 2:
        raise RegistrationError(
            f"Warping needs two displacement maps (y, x) of one shape, got {displacement_x.shape} "
            f"and {displacement_y.shape}; take both from one CameraMap."
        )
    if image.ndim != 2 or min(image.shape) < 3:
        raise RegistrationError(
            f"Warping needs an image of at least 3 by 3 pixels, got {image.shape}. Pass a whole "
            "frame."
        )

    bad = NOTHING_BAD
    if image.dtype.kind == "f" and not np.isfinite(image).all():
        # the filter of the spline reaches beyond its taps: no invalid value and no hole with a
        # sharp edge must enter it
        holes = ~np.isfinite(image)
        image = np.where(holes, 0, image).astype(np.float32)
        rows, columns = np.nonzero(holes)
        fill_bad_pixels(image, holes, rows, columns, _REACH)

        # with the four pixels around the point this covers all sixteen taps
        bad = cv2.dilate(holes.view(np.uint8), np.ones((3, 3), np.uint8)).view(np.bool_)

    coefficients = spline_coefficients(image, threads=threads)
    dx = np.ascontiguousarray(displacement_x, np.float32)
    dy = np.ascontiguousarray(displacement_y, np.float32)
    return laid_over((coefficients, bad), dx, dy, drift, threads)


def interpolation_variance_factor(displacement_x: AnyArray, displacement_y: AnyArray) -> Image:
    """Return the variance of a warped pixel over that of a pixel of camera 2.

    The noise is independent from pixel to pixel. The cardinal cubic spline eta weighs the pixels,
    so the factor is s(fx) s(fy) with s(f) = sum over k of eta(f - k)^2 and f the sub-pixel part of
    the position: 1 on a pixel, 0.57 half-way between four of them. With q = f (1 - f) the sum is
    s = 1 - 3 q^2 - (14 - 6 sqrt(3)) q^3.

    Parameters
    ----------
    displacement_x, displacement_y : array, (y, x)
        Camera-2 pixel minus camera-1 pixel in this frame; NaN gives NaN. [px]

    Returns
    -------
    array, (y, x), float32
        Factor for the variance. [1]

    Examples
    --------
    >>> half = np.full((1, 1), 0.5)
    >>> round(float(interpolation_variance_factor(half, half)[0, 0]), 2)
    0.57
    >>> float(interpolation_variance_factor(half + 0.5, half - 2.5)[0, 0])  # on a pixel
    1.0
    """
    factor = np.ones(displacement_x.shape, np.float32)
    for displacement in (displacement_x, displacement_y):
        place = np.asarray(displacement, np.float32)
        place = np.where(np.abs(place) < FARTHEST, place, _NAN)
        fraction = place - np.floor(place)
        q = fraction * (1 - fraction)
        factor *= 1 - q * q * (_THREE + _CUBIC * q)
    return factor
