"""Gauss-Newton on cell sums: how far camera 2 still is from camera 1, cell by cell.

With A the texture of camera 1, B that of camera 2 laid over it, g the gradient of (A + B)/2 and
e = A - B, the remaining displacement delta of any region solves (sum g g') delta = sum g e. Sums
over cells of a few pixels serve every region: windows, surfaces, the whole frame, and sums over
frames (Lucas and Kanade, 1981; with the gradient of the mean image, in which the noise of the two
cameras cancels in the first-order bias).
"""

from collections.abc import Sequence
from typing import Final

import cv2
import numpy as np

from erlif.core.arrays import FAST, AnyArray, Array, Image
from erlif.core.speed.kernels import njit
from erlif.registration.bands import in_bands

# Layout of the cell sums, the last axis of an array (row, column, SUMS).

# Product of the gradients along x, as GXY and GYY for xy and y. [1/px^2]
GXX: Final = 0
GXY: Final = 1
GYY: Final = 2
# Gradient along x times the difference, as BY along y. [1/px]
BX: Final = 3
BY: Final = 4
# Square of the difference. [1]
EE: Final = 5
# Weight, that is the number of pixels where all are good. [1]
WEIGHT: Final = 6
# Product of the two textures, as AA and BB of each with itself. [1]
AB: Final = 7
AA: Final = 8
BB: Final = 9
# Scalar product of the gradients of camera 1 and camera 2. [1/px^2]
CROSS: Final = 10
# Number of the sums.
SUMS: Final = 11

# GXX, GXY and GYY: the normal matrix.
GRADIENT_PRODUCTS: Final = slice(GXX, GYY + 1)
# BX and BY: the right side.
SCORES: Final = slice(BX, BY + 1)
# The normal matrix and the right side.
SYSTEM: Final = slice(GXX, BY + 1)

# Pixels at the border that the five-point derivative cannot reach. [px]
EDGE: Final = 2
# Textures and gradients are far below this; a NaN fails the comparison. [1]
KNOWN: Final = 1e6
# Differences beyond this many times the expected rms lose more than half their weight.
ROBUST: Final = 4.0
# Smallest expected rms, for textures that agree exactly. [1]
LEAST_RMS: Final = 1e-6

# Cells with light in both cameras below which the chance of a correlation cannot be judged.
FEWEST_CELLS: Final = 16

# Side of the neighbourhood over which the noise of the gradients is estimated. [cells]
NOISE_CELLS: Final = 5
# Smallest part of the gradient products that counts as common to both cameras.
LEAST_COMMON: Final = 0.05
# Below this part of the squared trace the determinant leaves one direction open. [1]
SINGULAR: Final = 1e-6


# Pixels of a row that are summed together: their lines stay in the fast memory of a core. [px]
_STRIP: Final = 256
# First places of the lines of a strip: half the gradients of both cameras, then the sums.
_AX, _AY, _BX, _BY, _LINES = (n * _STRIP for n in range(5))


# an unsigned index cannot count from the end; each step stands in `_cell_sums` once, without a call
_at = np.uint64


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _gradient(image: AnyArray, row: int, left: int, width: int, strip: AnyArray, k: int) -> None:
    """Half the five-point derivative of a part of a row, along x from place k and then along y."""
    c1 = np.float32(1.0 / 24.0)
    c8 = np.float32(8.0 / 24.0)
    y0, y1, y2, y3, y4 = _at(row - 2), _at(row - 1), _at(row), _at(row + 1), _at(row + 2)
    for i in range(width):
        x, m, n = _at(left + i - 2), _at(left + i - 1), _at(left + i)
        p, q = _at(left + i + 1), _at(left + i + 2)
        along_x, along_y = _at(k + i), _at(k + _STRIP + i)
        strip[along_x] = c8 * (image[y2, p] - image[y2, m]) - c1 * (image[y2, q] - image[y2, x])
        strip[along_y] = c8 * (image[y3, n] - image[y1, n]) - c1 * (image[y4, n] - image[y0, n])


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _add_products(
    a: AnyArray,
    b: AnyArray,
    weight: AnyArray,
    row: int,
    left: int,
    width: int,
    limit: AnyArray,
    cell: int,
    strip: AnyArray,
) -> None:
    """Add the products of a part of a row to the lines, pixel by pixel."""
    zero, one, four = np.float32(0), np.float32(1), np.float32(4)
    y, z = _at(row), _at(cell)
    for i in range(width):
        x = _at(left + i)
        ax, ay = strip[_at(_AX + i)], strip[_at(_AY + i)]
        bx, by = strip[_at(_BX + i)], strip[_at(_BY + i)]
        gx, gy = ax + bx, ay + by
        one_a, one_b = a[y, x], b[y, x]
        e = one_a - one_b

        # each is half a gradient
        cross = four * (ax * bx + ay * by)
        w = weight[y, x]

        # one NaN of the warped image among the neighbours takes the pixel out
        if not abs(gx) + abs(gy) + abs(e) < np.float32(KNOWN):
            gx = gy = e = one_a = one_b = cross = w = zero

        # large differences lose weight; the score is w e share, so its slope is w (1 - t) share^2
        t = e * e * limit[z, x]
        share = one / (one + t)
        slope = w * max(one - t, zero) * share * share
        w = w * share

        # the lines lie in one array at known distances, so that the loop runs on vectors
        strip[_at(_LINES + GXX * _STRIP + i)] += slope * gx * gx
        strip[_at(_LINES + GXY * _STRIP + i)] += slope * gx * gy
        strip[_at(_LINES + GYY * _STRIP + i)] += slope * gy * gy
        strip[_at(_LINES + BX * _STRIP + i)] += w * e * gx
        strip[_at(_LINES + BY * _STRIP + i)] += w * e * gy
        strip[_at(_LINES + EE * _STRIP + i)] += w * e * e
        strip[_at(_LINES + WEIGHT * _STRIP + i)] += w
        strip[_at(_LINES + AB * _STRIP + i)] += w * one_a * one_b
        strip[_at(_LINES + AA * _STRIP + i)] += w * one_a * one_a
        strip[_at(_LINES + BB * _STRIP + i)] += w * one_b * one_b
        strip[_at(_LINES + CROSS * _STRIP + i)] += slope * cross


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _cell_sums(
    a: AnyArray,
    weight: AnyArray,
    b: AnyArray,
    step: int,
    limit: AnyArray,
    sums: AnyArray,
    start: int,
    stop: int,
) -> None:
    """Add to the sums of the cell rows ``start`` to ``stop``; ``limit`` is (cell row or 1, x)."""
    h, w = a.shape
    cols = sums.shape[1]
    strip = np.empty(_LINES + SUMS * _STRIP, np.float32)

    for r in range(start, stop):
        for left in range(EDGE, w - EDGE, _STRIP):
            width = min(_STRIP, w - EDGE - left)

            # first along the columns of one row of cells
            for i in range(_LINES, strip.size):
                strip[i] = np.float32(0)
            for y in range(max(r * step, EDGE), min((r + 1) * step, h - EDGE)):
                for k in range(2):
                    _gradient(b if k == 1 else a, y, left, width, strip, _BX if k == 1 else _AX)
                cell = min(r, limit.shape[0] - 1)
                _add_products(a, b, weight, y, left, width, limit, cell, strip)

            # then across each cell; the last one takes the columns that are left over
            first, last = min(left // step, cols - 1), min((left + width - 1) // step, cols - 1)
            for c in range(first, last + 1):
                x0 = max(c * step - left, 0)
                x1 = width if c == cols - 1 else min((c + 1) * step - left, width)
                for k in range(SUMS):
                    total = np.float32(0)
                    for x in range(x0, x1):
                        total += strip[_LINES + k * _STRIP + x]
                    sums[r, c, k] += total


def cell_sums(
    a: Image,
    weight: Image,
    b: Image,
    step: int,
    *,
    scale: Array | None = None,
    only: Sequence[int] | None = None,
    threads: int = 1,
) -> Array:
    """Sums of the Gauss-Newton equations over square cells.

    Parameters
    ----------
    a, weight : array, (y, x), float32
        Texture of camera 1 and its weight, 0 for pixels that must not count. [1]
    b : array, (y, x), float32
        Texture of camera 2 at the pixels of camera 1; NaN where there is none. [1]
    step : int
        Side of a cell; the last column takes the pixels that are left over, so does the last
        row. [px]
    scale : array, (row, column), optional
        Expected rms of a - b in each cell. If given, a pixel whose difference is many times that
        (dust on one camera) loses its weight: w = 1/(1 + (e / 4 rms)^2). [1]
    only : sequence of int, optional
        Rows of cells that are summed; the others stay 0, and so do the pixels left over.
    threads : int
        Threads to use.

    Returns
    -------
    array, (row, column, 11), float64
        The sums in the order of ``GXX`` to ``CROSS``.

    Examples
    --------
    A ramp moved by a quarter of a pixel asks for that displacement everywhere:

    >>> ramp = np.broadcast_to(np.arange(64, dtype=np.float32), (48, 64))
    >>> sums = cell_sums(ramp, np.ones_like(ramp), ramp - np.float32(0.25), 8)
    >>> bool(np.allclose(sums[..., BX] / sums[..., GXX], 0.25))
    True
    """
    h, w = a.shape
    rows, cols = max(h // step, 1), max(w // step, 1)
    sums = np.zeros((rows + 1, cols, SUMS))  # the extra row takes what is left over at the bottom

    # the limit of each cell, spread to columns and repeated for the pixels that are left over
    if scale is None:
        limit = np.zeros((1, w), np.float32)
    else:
        inverse = (1 / (ROBUST * np.maximum(scale, LEAST_RMS)) ** 2).astype(np.float32)
        limit = np.repeat(inverse, step, axis=1)
        limit = np.pad(limit, ((0, 1), (0, w - limit.shape[1])), mode="edge")

    if only is not None:
        for r in only:
            _cell_sums(a, weight, b, step, limit, sums, r, r + 1)
        return sums[:rows]

    in_bands(lambda s, t: _cell_sums(a, weight, b, step, limit, sums, s, t), rows + 1, threads)
    sums[rows - 1] += sums[rows]
    return sums[:rows]


def centres_along_axis(size: int, step: int) -> Array:
    """Coordinates of the cell centres along an axis of ``size`` pixels. [px]"""
    return np.asarray(np.arange(max(size // step, 1)) * step + (step - 1) / 2, np.float64)


def merge_cells(sums: Array, factor: int) -> Array:
    """Add up blocks of ``factor`` by ``factor`` cells; cut blocks at the far edges are kept."""
    rows, cols, n = sums.shape
    padded = np.zeros((-(-rows // factor) * factor, -(-cols // factor) * factor, n))
    padded[:rows, :cols] = sums
    merged: Array = padded.reshape(
        padded.shape[0] // factor, factor, padded.shape[1] // factor, factor, n
    ).sum((1, 3))
    return merged


def without_noise(sums: Array, slope: float = 1.0) -> Array:
    """Reduce the gradient products to the texture that both cameras share.

    The gradient of the mean image holds half the noise of each camera, which makes its products
    too large, the steps too short and the standard deviation too small. The product of the two
    cameras' gradients does not, but in a region without texture it need not be positive. So the
    former are scaled by the ratio of the two over 5 by 5 cells.

    Parameters
    ----------
    sums : array, (row, column, 11)
        From `cell_sums`.
    slope : float
        Factor by which the discrete derivative falls short of the true slope
        (see `erlif.registration.whitening.slope_gain`).

    Returns
    -------
    array, (row, column, 11)
        The sums with their gradient products scaled.
    """
    total, cross = (
        cv2.blur(cells, (NOISE_CELLS, NOISE_CELLS), borderType=cv2.BORDER_CONSTANT)
        for cells in (sums[..., GXX] + sums[..., GYY], np.ascontiguousarray(sums[..., CROSS]))
    )

    # the small terms only keep empty regions from dividing by zero
    ratio = np.clip(
        cross / np.maximum(total, 1e-30 + 1e-12 * float(total.max())), LEAST_COMMON, 1.0
    )
    cleaned = sums.copy()
    cleaned[..., GRADIENT_PRODUCTS] *= slope * ratio[..., None]
    return cleaned


def system_of(sums: Array) -> Array:
    """GXX, GXY, GYY, BX and BY, (5, row, column): the equations of each cell."""
    return np.moveaxis(sums[..., SYSTEM], -1, 0)


def coefficients_of(sums: Array) -> Array:
    """Correlation coefficient of the textures in each cell with weight, (cell,). [1]"""
    ab, aa, bb = (sums[..., k][sums[..., WEIGHT] > 0] for k in (AB, AA, BB))
    return ab / np.sqrt(np.maximum(aa * bb, np.finfo(float).tiny))


def beyond_chance(coefficients: Array, limit: float) -> bool:
    """Whether textures have more in common than chance gives.

    Coefficients count alike in all cells: of the products, a few cells outshine the others, such as
    the rim of a bubble or the marks of a thin film, and their scatter hides a common texture.

    Parameters
    ----------
    coefficients : array, (cell,)
        As `coefficients_of` gives them. [1]
    limit : float
        Standard errors by which their mean must exceed 0.

    Returns
    -------
    bool
        No for fewer than `FEWEST_CELLS` cells.
    """
    if coefficients.size < FEWEST_CELLS:
        return False
    return bool(coefficients.mean() > limit * coefficients.std() / np.sqrt(coefficients.size))


def correlation(sums: Array) -> float:
    """Correlation coefficient of the two textures over everything that was summed. [1]"""
    ab, aa, bb = (float(sums[..., k].sum()) for k in (AB, AA, BB))
    return ab / float(np.sqrt(aa * bb)) if aa > 0 and bb > 0 else 0.0


def solve_shift(sums: Array) -> tuple[float, float]:
    """Displacement ``(dx, dy)`` that one translation of everything summed still needs. [px]

    (0, 0) where the texture does not determine both components.
    """
    gxx, gxy, gyy, bx, by = (float(each.sum()) for each in system_of(sums))
    det = gxx * gyy - gxy * gxy
    if not det > SINGULAR * (gxx + gyy) ** 2:
        return 0.0, 0.0
    return (gyy * bx - gxy * by) / det, (gxx * by - gxy * bx) / det


def move_sums(sums: Array, delta_x: Array | float, delta_y: Array | float) -> Array:
    """Sums as they would be after a further displacement of every cell, to first order.

    Parameters
    ----------
    sums : array, (row, column, 11)
        From `cell_sums`.
    delta_x, delta_y : float or array, (row, column)
        The further displacement. [px]

    Returns
    -------
    array, (row, column, 11)
        Scores and squared differences at the new displacement; the other sums as they were.
    """
    moved = sums.copy()
    gxx, gxy, gyy, bx, by = system_of(sums)
    tx = gxx * delta_x + gxy * delta_y
    ty = gxy * delta_x + gyy * delta_y

    # e becomes e - g delta
    moved[..., BX] -= tx
    moved[..., BY] -= ty
    moved[..., EE] += tx * delta_x + ty * delta_y - 2 * (bx * delta_x + by * delta_y)
    return moved
