"""Camera 2 on the pixels of camera 1 by cubic B-spline interpolation, and what that does to the noise.

The cubic B-spline interpolates exactly (unlike a smoothing kernel) and moves a linear ramp by nothing at all. See
M. Unser, A. Aldroubi, M. Eden, IEEE Trans. Signal Process. 41 (1993) 821 and 834.
"""

from functools import cache
from typing import Final

import numpy as np
from numba import njit

from erlif.core.arrays import AnyArray
from erlif.core.errors import RegistrationError
from erlif.registration.bands import in_bands

FAST: Final = {"nsz", "arcp", "contract", "afn", "reassoc"}
"""Floating-point freedoms that keep NaN a NaN."""

_POLE: Final = np.float32(np.sqrt(3.0) - 2.0)
_MARGIN: Final = 2  # mirrored coefficients on every side, so that no tap needs a bounds check
_LANES: Final = 16


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def filter_columns(image: AnyArray, out: AnyArray, start: int, stop: int) -> None:
    """B-spline coefficients along y for the columns ``start`` to ``stop``, mirrored about the outer pixels."""
    n = image.shape[0]
    z = _POLE
    m = _MARGIN
    period = 2 * n - 2
    for x in range(start, stop):
        out[m, x] = image[0, x]
    power = z
    for k in range(1, 16):  # |z|^16 < 1e-9
        j = k % period
        if j >= n:
            j = period - j
        for x in range(start, stop):
            out[m, x] += power * image[j, x]
        power *= z
    for y in range(1, n):
        for x in range(start, stop):
            out[m + y, x] = image[y, x] + z * out[m + y - 1, x]
    gain = z / (z * z - np.float32(1))
    for x in range(start, stop):
        out[m + n - 1, x] = np.float32(6) * gain * (out[m + n - 1, x] + z * out[m + n - 2, x])
    for y in range(n - 2, -1, -1):
        for x in range(start, stop):
            out[m + y, x] = z * (out[m + y + 1, x] - np.float32(6) * out[m + y, x])


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def filter_rows(columns: AnyArray, out: AnyArray, start: int, stop: int) -> None:
    """B-spline coefficients along x for the rows ``start`` to ``stop``; sixteen rows at a time, for the vector unit."""
    n = columns.shape[1]
    z = _POLE
    m = _MARGIN
    period = 2 * n - 2
    lanes = np.empty((n, _LANES), np.float32)
    gain = z / (z * z - np.float32(1))
    first = np.empty(_LANES, np.float32)
    for top in range(start, stop, _LANES):
        rows = min(_LANES, stop - top)
        for r in range(_LANES):
            row = m + top + min(r, rows - 1)
            for x in range(n):
                lanes[x, r] = columns[row, x]
        for r in range(_LANES):
            first[r] = lanes[0, r]
        power = z
        for k in range(1, 16):
            j = k % period
            if j >= n:
                j = period - j
            for r in range(_LANES):
                first[r] += power * lanes[j, r]
            power *= z
        for r in range(_LANES):
            lanes[0, r] = first[r]
        for x in range(1, n):
            for r in range(_LANES):
                lanes[x, r] += z * lanes[x - 1, r]
        for r in range(_LANES):
            lanes[n - 1, r] = np.float32(6) * gain * (lanes[n - 1, r] + z * lanes[n - 2, r])
        for x in range(n - 2, -1, -1):
            for r in range(_LANES):
                lanes[x, r] = z * (lanes[x + 1, r] - np.float32(6) * lanes[x, r])
        for r in range(rows):
            row = m + top + r
            for x in range(n):
                out[row, m + x] = lanes[x, r]
            out[row, 1] = lanes[1, r]
            out[row, 0] = lanes[min(2, period - 2), r]
            out[row, m + n] = lanes[n - 2, r]
            out[row, m + n + 1] = lanes[max(n - 3, 0), r]


def spline_coefficients(image: AnyArray, *, threads: int = 1) -> AnyArray:
    """Cubic B-spline coefficients of an image, mirrored about its outer pixels.

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
    """
    h, w = image.shape
    image = np.ascontiguousarray(image, np.float32)
    columns = np.empty((h + 2 * _MARGIN, w), np.float32)
    in_bands(lambda a, b: filter_columns(image, columns, a, b), w, threads)
    out = np.empty((h + 2 * _MARGIN, w + 2 * _MARGIN), np.float32)
    in_bands(lambda a, b: filter_rows(columns, out, a, b), h, threads)
    out[1], out[0] = out[3], out[4]
    out[_MARGIN + h], out[_MARGIN + h + 1] = out[_MARGIN + h - 2], out[_MARGIN + h - 3]
    return out


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
    """Evaluate the spline at x + displacement + drift for the rows ``start`` to ``stop`` of ``out``.

    NaN where the point falls outside the image or, unless ``bad`` is of size 0, where one of the four pixels around
    the point is marked in it.
    """
    h = coefficients.shape[0] - 2 * _MARGIN
    w = coefficients.shape[1] - 2 * _MARGIN
    masked = bad.size > 0
    sx = np.float32(drift_x)
    sy = np.float32(drift_y)
    sixth = np.float32(1.0 / 6.0)
    one = np.float32(1)
    four = np.float32(4)
    three = np.float32(3)
    six = np.float32(6)
    for y in range(start, stop):
        for x in range(out.shape[1]):
            dx = displacement_x[y, x] + sx
            dy = displacement_y[y, x] + sy
            if not (abs(dx) < 1e6 and abs(dy) < 1e6):
                out[y, x] = np.nan
                continue
            # the fraction is taken from the displacement alone, which float32 holds to a millionth of a pixel
            fx = np.floor(dx)
            fy = np.floor(dy)
            u = dx - fx
            v = dy - fy
            i = x + int(fx)
            j = y + int(fy)
            if (
                i < 0
                or j < 0
                or i > w - 1
                or j > h - 1
                or (i == w - 1 and u > 0)
                or (j == h - 1 and v > 0)
            ):
                out[y, x] = np.nan
                continue
            if masked:
                i1 = min(i + 1, w - 1)
                j1 = min(j + 1, h - 1)
                if bad[j, i] or bad[j, i1] or bad[j1, i] or bad[j1, i1]:
                    out[y, x] = np.nan
                    continue
            u2 = u * u
            u3 = u2 * u
            v2 = v * v
            v3 = v2 * v
            a0 = one - three * u + three * u2 - u3
            a1 = four - six * u2 + three * u3
            a2 = one + three * u + three * u2 - three * u3
            a3 = u3
            b0 = (one - three * v + three * v2 - v3) * sixth * sixth
            b1 = (four - six * v2 + three * v3) * sixth * sixth
            b2 = (one + three * v + three * v2 - three * v3) * sixth * sixth
            b3 = v3 * sixth * sixth
            i += 1
            j += 1
            s0 = b0 * coefficients[j, i] + b1 * coefficients[j + 1, i]
            s0 += b2 * coefficients[j + 2, i] + b3 * coefficients[j + 3, i]
            s1 = b0 * coefficients[j, i + 1] + b1 * coefficients[j + 1, i + 1]
            s1 += b2 * coefficients[j + 2, i + 1] + b3 * coefficients[j + 3, i + 1]
            s2 = b0 * coefficients[j, i + 2] + b1 * coefficients[j + 1, i + 2]
            s2 += b2 * coefficients[j + 2, i + 2] + b3 * coefficients[j + 3, i + 2]
            s3 = b0 * coefficients[j, i + 3] + b1 * coefficients[j + 1, i + 3]
            s3 += b2 * coefficients[j + 2, i + 3] + b3 * coefficients[j + 3, i + 3]
            out[y, x] = a0 * s0 + a1 * s1 + a2 * s2 + a3 * s3


@njit(nogil=True, cache=True, error_model="numpy")
def fill_gaps(image: AnyArray, bad: AnyArray, out: AnyArray) -> None:
    """Copy ``image`` and replace marked pixels by the mean of their nearest sound neighbours (up to 9 px away).

    The B-spline filter reaches beyond its taps, so an unsound value must not enter it, nor a hole with a sharp edge.
    """
    h, w = image.shape
    for y in range(h):
        for x in range(w):
            if not bad[y, x]:
                out[y, x] = image[y, x]
                continue
            value = np.float32(0)
            for reach in range(1, 10):
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


def warp(
    image: AnyArray,
    displacement_x: AnyArray,
    displacement_y: AnyArray,
    drift: tuple[float, float] = (0.0, 0.0),
    *,
    threads: int = 1,
) -> AnyArray:
    """Sample camera 2 at the pixels of camera 1.

    Parameters
    ----------
    image : array, (y2, x2)
        Camera 2, oriented like camera 1. A pixel that is not finite is left out, together with every result that
        one of its sixteen taps would reach.
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
    """
    if displacement_x.shape != displacement_y.shape or displacement_x.ndim != 2:
        raise RegistrationError(
            f"Warping needs two displacement maps (y, x) of one shape, got {displacement_x.shape} and "
            f"{displacement_y.shape}; take both from one CameraMap."
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
def _noise_table(size: int = 1024) -> AnyArray:
    """s(f), the sum of the squared values of the cardinal cubic spline at f - k, at f = 0, 1/size, ..., 1."""
    n = 64
    f = np.linspace(0.0, 1.0, size + 1)
    taps = (
        np.stack([(1 - f) ** 3, 4 - 6 * f**2 + 3 * f**3, 1 + 3 * f + 3 * f**2 - 3 * f**3, f**3]) / 6
    )
    z = float(np.sqrt(3.0) - 2.0)
    k = np.arange(-n, n + 1)
    inverse = np.sqrt(3.0) * z ** np.abs(
        k
    )  # impulse response of the prefilter, 6 z/(1 - z^2) z^|k| with sign
    response = np.zeros((2 * n + 4, f.size))
    for i in range(4):
        response[i : i + 2 * n + 1] += inverse[:, None] * taps[i]
    table: AnyArray = np.sum(response**2, axis=0)
    table.setflags(write=False)
    return table


def interpolation_variance_factor(
    displacement_x: AnyArray, displacement_y: AnyArray, drift: tuple[float, float] = (0.0, 0.0)
) -> AnyArray:
    """Variance of a warped pixel over that of the camera's own, for noise that is independent from pixel to pixel.

    The cardinal cubic spline eta weighs the pixels, so the factor is s(fx) s(fy) with s(f) = sum over k of
    eta(f - k)^2 and f the sub-pixel part of the position: 1 on a pixel, 0.57 half-way between four of them.

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
    n = table.size - 1
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            u = fx[y, x] + sx
            v = fy[y, x] + sy
            if not (abs(u) < 1e6 and abs(v) < 1e6):
                out[y, x] = np.nan
                continue
            u = (u - np.floor(u)) * n
            v = (v - np.floor(v)) * n
            i = min(int(u), n - 1)
            j = min(int(v), n - 1)
            a = table[i] + (u - i) * (table[i + 1] - table[i])
            b = table[j] + (v - j) * (table[j + 1] - table[j])
            out[y, x] = a * b
