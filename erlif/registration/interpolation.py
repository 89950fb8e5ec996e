"""Camera 2 on the pixels of camera 1 by cubic B-spline interpolation, and the noise afterwards.

The cubic B-spline passes through the pixels (unlike a smoothing kernel) and reproduces polynomials
up to the third degree. Its coefficients come from a recursive filter along each axis (Unser,
Aldroubi and Eden 1993).
"""

from functools import cache
from typing import Any, Final

import cv2
import numpy as np
from numba import njit

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.errors import RegistrationError
from erlif.registration.bands import in_bands

FAST: Final = {"nsz", "arcp", "contract", "afn", "reassoc"}
"""Floating-point freedoms that keep NaN a NaN."""

Single = np.floating[Any]
"""A number in single precision."""

_POLE: Final = np.float32(np.sqrt(3.0) - 2.0)
"""Pole of the filter that turns samples into cubic B-spline coefficients."""
_START: Final = 16
"""Samples that start the causal filter: the power of the pole falls below 1e-9."""
_MARGIN: Final = 2
"""Mirrored coefficients on every side, so that the sixteen taps need no check of bounds."""
_FARTHEST: Final = 1e6
"""Displacements beyond this lie outside any image and beyond the precision of float32. [px]"""
_OUTSIDE: Final = np.float32(2.0**30)
"""Stands for the whole pixels of a point outside the image. [px]"""
_REACH: Final = 9
"""Distance over which a gap is filled from its neighbours; the spline's own reach. [px]"""


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _mix(one: AnyArray, two: AnyArray, u: Single, v: Single, out: AnyArray) -> None:
    for x in range(out.size):
        out[x] = u * one[x] + v * two[x]


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def filter_columns(image: AnyArray, out: AnyArray, start: int, stop: int) -> None:
    """Filter the columns ``start`` to ``stop`` along y, mirrored about the outer pixels."""
    n = image.shape[0]
    z = _POLE
    m = _MARGIN
    period = 2 * n - 2

    # the causal filter starts with the sum over the mirrored samples before the first
    for x in range(start, stop):
        out[m, x] = image[0, x]
    power = z
    for k in range(1, _START):
        j = k % period
        if j >= n:
            j = period - j
        for x in range(start, stop):
            out[m, x] += power * image[j, x]
        power *= z

    # the causal filter runs down, the anticausal filter up again; the gain of 6 makes the sum of
    # the weights 1
    six = np.float32(6)
    gain = six * z / (z * z - np.float32(1))
    last = m + n - 1
    for k in range(1, 2 * n):
        if k < n:
            y = m + k
            one, two, u, v = image[k], out[y - 1], np.float32(1), z
        elif k == n:
            y = last
            one, two, u, v = out[y], out[y - 1], gain, gain * z
        else:
            y = last + n - k
            one, two, u, v = out[y + 1], out[y], z, -six * z
        _mix(one[start:stop], two[start:stop], u, v, out[y, start:stop])


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
        Coefficients with a margin of two mirrored ones on every side, ready for `sample_spline`.

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
    # the same filter along both axes: transposing costs less than a second one
    columns = _filter(np.ascontiguousarray(image, np.float32), threads)
    return np.asarray(cv2.transpose(_filter(np.asarray(cv2.transpose(columns)), threads)))


def _filter(image: AnyArray, threads: int) -> AnyArray:
    """Filter along y, with two mirrored coefficients above the first and below the last row."""
    h, w = image.shape
    out = np.empty((h + 2 * _MARGIN, w), np.float32)
    in_bands(lambda a, b: filter_columns(image, out, a, b), w, threads)
    out[1], out[0] = out[3], out[4]
    out[_MARGIN + h], out[_MARGIN + h + 1] = out[_MARGIN + h - 2], out[_MARGIN + h - 3]
    return out


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _whole_pixels(
    displacement_x: AnyArray,
    displacement_y: AnyArray,
    drift_x: Single,
    drift_y: Single,
    y: int,
    w: int,
    h: int,
    left: AnyArray,
    top: AnyArray,
) -> None:
    """Whole pixels of the displacement along row ``y``; ``_OUTSIDE`` outside the image."""
    zero = np.float32(0)
    last_x = np.float32(w - 1)
    last_y = np.float32(h - 1)
    row = np.float32(y)

    # float32 holds whole pixels exactly; a NaN fails all comparisons
    for x in range(left.size):
        dx = displacement_x[x] + drift_x
        dy = displacement_y[x] + drift_y
        fx = np.floor(dx)
        fy = np.floor(dy)
        px = np.float32(x) + fx
        py = row + fy
        along_x = (px >= zero) & ((px < last_x) | ((px == last_x) & (dx == fx)))
        along_y = (py >= zero) & ((py < last_y) | ((py == last_y) & (dy == fy)))
        left[x] = fx if along_x & along_y else _OUTSIDE
        top[x] = fy if along_x & along_y else _OUTSIDE


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _along_row(
    row_0: AnyArray,
    row_1: AnyArray,
    row_2: AnyArray,
    row_3: AnyArray,
    displacement_x: AnyArray,
    displacement_y: AnyArray,
    offset_x: Single,
    offset_y: Single,
    out: AnyArray,
) -> None:
    """Evaluate the spline along a row where the taps of neighbouring points are neighbours.

    The offset makes the displacement a fraction of a pixel. Without a test or an index from
    memory, the loop runs on vectors.
    """
    sixth = np.float32(1.0 / 6.0)
    one = np.float32(1)
    four = np.float32(4)
    three = np.float32(3)
    six = np.float32(6)

    for k in range(out.size):
        # the fraction is taken from the displacement alone, which float32 holds to a millionth
        # of a pixel; the sum with x would lose three digits
        u = displacement_x[k] + offset_x
        v = displacement_y[k] + offset_y

        # the four B-splines that reach the point, along x and, with both sixths, along y
        u2 = u * u
        u3 = u2 * u
        v2 = v * v
        v3 = v2 * v
        a0 = one - three * u + three * u2 - u3
        a1 = four - six * u2 + three * u3
        a2 = one + three * u + three * u2 - three * u3
        b0 = (one - three * v + three * v2 - v3) * sixth * sixth
        b1 = (four - six * v2 + three * v3) * sixth * sixth
        b2 = (one + three * v + three * v2 - three * v3) * sixth * sixth
        b3 = v3 * sixth * sixth

        s0 = b0 * row_0[k] + b1 * row_1[k] + b2 * row_2[k] + b3 * row_3[k]
        s1 = b0 * row_0[k + 1] + b1 * row_1[k + 1] + b2 * row_2[k + 1] + b3 * row_3[k + 1]
        s2 = b0 * row_0[k + 2] + b1 * row_1[k + 2] + b2 * row_2[k + 2] + b3 * row_3[k + 2]
        s3 = b0 * row_0[k + 3] + b1 * row_1[k + 3] + b2 * row_2[k + 3] + b3 * row_3[k + 3]
        out[k] = a0 * s0 + a1 * s1 + a2 * s2 + u3 * s3


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def sample_spline(
    coefficients: AnyArray,
    displacement_x: AnyArray,
    displacement_y: AnyArray,
    drift_x: float,
    drift_y: float,
    bad: AnyArray,
    out: AnyArray,
    start: int,
    stop: int,
) -> None:
    """Evaluate the spline at x + displacement + drift in the rows ``start`` to ``stop``.

    Parameters
    ----------
    coefficients : array, (y2 + 4, x2 + 4), float32
        As `spline_coefficients` makes them from the image of camera 2.
    displacement_x, displacement_y : array, (y, x), float32
        Camera-2 pixel minus camera-1 pixel. [px]
    drift_x, drift_y : float
        Translation of this frame, added to the displacement. [px]
    bad : array, (y2, x2), bool
        Marked pixels of camera 2, or an array of size 0.
    out : array, (y, x), float32
        Receives the values; NaN where the point falls outside the image, or where one of the four
        pixels around it is marked in ``bad``.
    start, stop : int
        Rows to evaluate.

    Examples
    --------
    A ramp of 2 per column, half a pixel to the right:

    >>> ramp = spline_coefficients(np.tile(2.0 * np.arange(60), (40, 1)))
    >>> half = np.full((40, 60), 0.5, np.float32)
    >>> out = np.empty((40, 60), np.float32)
    >>> sample_spline(ramp, half, 0 * half, 0.0, 0.0, np.zeros((0, 0), np.bool_), out, 0, 40)
    >>> round(float(out[20, 30]), 4)
    61.0
    """
    h = coefficients.shape[0] - 2 * _MARGIN
    w = coefficients.shape[1] - 2 * _MARGIN
    width = out.shape[1]
    masked = bad.size > 0
    sx = np.float32(drift_x)
    sy = np.float32(drift_y)
    left = np.empty(width, np.float32)
    top = np.empty(width, np.float32)

    for y in range(start, stop):
        _whole_pixels(displacement_x[y], displacement_y[y], sx, sy, y, w, h, left, top)

        # the displacement is smooth: whole pixels are constant over long runs of a row
        x = 0
        while x < width:
            fx = left[x]
            fy = top[x]
            end = x + 1
            while end < width and left[end] == fx and top[end] == fy:
                end += 1
            if fx == _OUTSIDE:
                out[y, x:end] = np.nan
                x = end
                continue

            # pixel i has its coefficient at i + 2, so the first of the four taps is at i + 1
            i = x + int(fx)
            j = y + int(fy)
            last = i + end - x + 4
            _along_row(
                coefficients[j + 1, i + 1 : last],
                coefficients[j + 2, i + 1 : last],
                coefficients[j + 3, i + 1 : last],
                coefficients[j + 4, i + 1 : last],
                displacement_x[y, x:end],
                displacement_y[y, x:end],
                sx - fx,
                sy - fy,
                out[y, x:end],
            )
            if masked:
                below = min(j + 1, h - 1)
                for k in range(end - x):
                    a = i + k
                    b = min(a + 1, w - 1)
                    if bad[j, a] or bad[j, b] or bad[below, a] or bad[below, b]:
                        out[y, x + k] = np.nan
            x = end


@njit(nogil=True, cache=True, error_model="numpy")
def fill_gaps(image: AnyArray, bad: AnyArray, out: AnyArray) -> None:
    """Copy ``image`` and replace marked pixels by the mean of their nearest valid neighbours.

    The B-spline filter reaches beyond its taps, so an invalid value must not enter it, nor a hole
    with a sharp edge. A pixel without a valid neighbour within 9 px becomes 0.
    """
    h, w = image.shape
    for y in range(h):
        for x in range(w):
            if not bad[y, x]:
                out[y, x] = image[y, x]
                continue

            # the square around the pixel grows until it holds a valid one
            value = np.float32(0)
            for reach in range(1, _REACH + 1):
                total = 0.0
                count = 0
                for j in range(max(0, y - reach), min(h, y + reach + 1)):
                    for i in range(max(0, x - reach), min(w, x + reach + 1)):
                        if not bad[j, i]:
                            total += image[j, i]
                            count += 1
                if count > 0:
                    value = np.float32(total / count)
                    break
            out[y, x] = value


@njit(nogil=True, cache=True, error_model="numpy")
def spread(bad: AnyArray, out: AnyArray) -> None:
    """Mark every pixel that has a marked one among itself and its eight neighbours."""
    h, w = bad.shape
    for y in range(h):
        for x in range(w):
            if bad[y, x]:
                for j in range(max(0, y - 1), min(h, y + 2)):
                    for i in range(max(0, x - 1), min(w, x + 2)):
                        out[j, i] = True


NOTHING_BAD: Final = np.zeros((0, 0), np.bool_)
"""Mask for `sample_spline` if all pixels are valid."""


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
            "Warping needs two displacement maps (y, x) of one shape, got "
            f"{displacement_x.shape} and {displacement_y.shape}; take both from one CameraMap."
        )
    if image.ndim != 2 or min(image.shape) < 3:
        raise RegistrationError(
            f"Warping needs an image of at least 3 by 3 pixels, got {image.shape}."
        )

    bad = NOTHING_BAD
    if image.dtype.kind == "f" and not np.isfinite(image).all():
        holes = ~np.isfinite(image)
        filled = np.empty(image.shape, np.float32)
        fill_gaps(image, holes, filled)
        image = filled
        bad = np.zeros(image.shape, np.bool_)
        spread(holes, bad)  # with the four pixels around the point this covers all sixteen taps

    coefficients = spline_coefficients(image, threads=threads)
    dx = np.ascontiguousarray(displacement_x, np.float32)
    dy = np.ascontiguousarray(displacement_y, np.float32)
    out = np.empty(dx.shape, np.float32)
    x, y = float(drift[0]), float(drift[1])
    in_bands(
        lambda a, b: sample_spline(coefficients, dx, dy, x, y, bad, out, a, b), dx.shape[0], threads
    )
    return out


@cache
def _noise_table(size: int = 1024) -> Array:
    """Sum over k of the squared cardinal cubic spline at f - k, at f = 0, 1/size, ..., 1."""
    n = 64  # taps on either side; the pole to this power is 1e-37
    f = np.linspace(0.0, 1.0, size + 1)
    taps = (
        np.stack([(1 - f) ** 3, 4 - 6 * f**2 + 3 * f**3, 1 + 3 * f + 3 * f**2 - 3 * f**3, f**3]) / 6
    )

    # the cardinal spline is the B-spline after the prefilter, whose impulse response is
    # 6 z/(z^2 - 1) z^|k| = sqrt(3) z^|k|
    z = float(np.sqrt(3.0) - 2.0)
    k = np.arange(-n, n + 1)
    inverse = np.sqrt(3.0) * z ** np.abs(k)
    response = np.zeros((2 * n + 4, f.size))
    for i in range(4):
        response[i : i + 2 * n + 1] += inverse[:, None] * taps[i]

    table: Array = np.sum(response**2, axis=0)
    table.setflags(write=False)
    return table


def interpolation_variance_factor(
    displacement_x: AnyArray, displacement_y: AnyArray, drift: tuple[float, float] = (0.0, 0.0)
) -> Image:
    """Return the variance of a warped pixel over that of a pixel of camera 2.

    The noise is independent from pixel to pixel. The cardinal cubic spline eta weighs the pixels,
    so the factor is s(fx) s(fy) with s(f) = sum over k of eta(f - k)^2 and f the sub-pixel part of
    the position: 1 on a pixel, 0.57 half-way between four of them.

    Parameters
    ----------
    displacement_x, displacement_y : array, (y, x)
        Camera-2 pixel minus camera-1 pixel; NaN gives NaN. [px]
    drift : (float, float)
        Translation of this frame. [px]

    Returns
    -------
    array, (y, x), float32
        Factor for the variance. [1]

    Examples
    --------
    >>> half = np.full((1, 1), 0.5)
    >>> round(float(interpolation_variance_factor(half, half)[0, 0]), 2)
    0.57
    >>> float(interpolation_variance_factor(half, half, (0.5, -2.5))[0, 0])  # on a pixel
    1.0
    """
    table = _noise_table()
    out = np.empty(displacement_x.shape, np.float32)
    fx = np.ascontiguousarray(displacement_x, np.float32)
    fy = np.ascontiguousarray(displacement_y, np.float32)
    _look_up(fx, fy, float(drift[0]), float(drift[1]), table, out)
    return out


@njit(nogil=True, cache=True, error_model="numpy")
def _look_up(
    fx: AnyArray, fy: AnyArray, sx: float, sy: float, table: AnyArray, out: AnyArray
) -> None:
    """Product of the table at both sub-pixel parts, interpolated linearly; NaN stays NaN."""
    n = table.size - 1
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            u = fx[y, x] + sx
            v = fy[y, x] + sy
            if not (abs(u) < _FARTHEST and abs(v) < _FARTHEST):
                out[y, x] = np.nan
                continue
            u = (u - np.floor(u)) * n
            v = (v - np.floor(v)) * n
            i = min(int(u), n - 1)
            j = min(int(v), n - 1)
            a = table[i] + (u - i) * (table[i + 1] - table[i])
            b = table[j] + (v - j) * (table[j + 1] - table[j])
            out[y, x] = a * b
