"""Gauss-Newton on cell sums: how far camera 2 still is from camera 1, cell by cell.

With A the texture of camera 1, B that of camera 2 laid over it, g the gradient of (A + B)/2 and e = A - B, the remaining
displacement delta of any region solves (sum g g') delta = sum g e. Sums over cells of a few pixels serve every region:
windows, surfaces, the whole frame, and sums over frames. B. D. Lucas, T. Kanade, Proc. IJCAI (1981) 674, with the
gradient of the mean image, which makes the noise of the two cameras cancel in its first-order bias.
"""

from typing import Final

import numpy as np
from numba import njit
from scipy import ndimage

from erlif.core.arrays import AnyArray
from erlif.registration.bands import in_bands
from erlif.registration.warp import FAST

GXX: Final = 0
GXY: Final = 1
GYY: Final = 2
BX: Final = 3
BY: Final = 4
EE: Final = 5
WEIGHT: Final = 6
AB: Final = 7
AA: Final = 8
BB: Final = 9
CROSS: Final = 10
SUMS: Final = 11
"""Layout of the cell sums: gradient products, gradient times difference, difference squared, weight, the products of
the textures themselves for the correlation coefficient, and the scalar product of the two cameras' gradients."""


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
    h, w = a.shape
    cols = sums.shape[1]
    c1 = np.float32(
        1.0 / 24.0
    )  # five-point derivative of the mean image: half of 1/12, half of 8/12
    c8 = np.float32(8.0 / 24.0)
    zero = np.float32(0)
    bounded = limit.size > 0
    line = np.empty((SUMS, w), np.float32)
    for r in range(start, stop):
        for k in range(SUMS):
            for x in range(w):
                line[k, x] = zero
        for y in range(max(r * step, 2), min((r + 1) * step, h - 2)):
            for x in range(2, w - 2):
                ax = c8 * (a[y, x + 1] - a[y, x - 1]) - c1 * (a[y, x + 2] - a[y, x - 2])
                ay = c8 * (a[y + 1, x] - a[y - 1, x]) - c1 * (a[y + 2, x] - a[y - 2, x])
                bx = c8 * (b[y, x + 1] - b[y, x - 1]) - c1 * (b[y, x + 2] - b[y, x - 2])
                by = c8 * (b[y + 1, x] - b[y - 1, x]) - c1 * (b[y + 2, x] - b[y - 2, x])
                gx = ax + bx
                gy = ay + by
                cross = np.float32(4) * (ax * bx + ay * by)
                e = a[y, x] - b[y, x]
                p = b[y, x]
                q = a[y, x]
                g = weight[y, x]
                # one NaN of the warped image among the neighbours takes the pixel out
                ok = abs(gx) + abs(gy) + abs(e) < np.float32(1e6)
                gx = gx if ok else zero
                gy = gy if ok else zero
                e = e if ok else zero
                p = p if ok else zero
                q = q if ok else zero
                cross = cross if ok else zero
                g = g if ok else zero
                slope = g
                if bounded:
                    t = e * e * limit[r, x]
                    share = np.float32(1) / (np.float32(1) + t)
                    # the score is g e share, so its slope is g (1 - t) share^2
                    slope = g * max(np.float32(1) - t, zero) * share * share
                    g = g * share
                line[0, x] += slope * gx * gx
                line[1, x] += slope * gx * gy
                line[2, x] += slope * gy * gy
                line[3, x] += g * gx * e
                line[4, x] += g * gy * e
                line[5, x] += g * e * e
                line[6, x] += g
                line[7, x] += g * p * q
                line[8, x] += g * q * q
                line[9, x] += g * p * p
                line[10, x] += slope * cross
        for c in range(cols):
            x1 = w if c == cols - 1 else (c + 1) * step
            for k in range(SUMS):
                total = zero
                for x in range(c * step, x1):
                    total += line[k, x]
                sums[r, c, k] = total


def cell_sums(
    a: AnyArray,
    weight: AnyArray,
    b: AnyArray,
    step: int,
    *,
    scale: AnyArray | None = None,
    threads: int = 1,
) -> AnyArray:
    """Sums of the Gauss-Newton equations over square cells.

    Parameters
    ----------
    a, weight : array, (y, x), float32
        Texture of camera 1 and its weight, 0 for pixels that must not count.
    b : array, (y, x), float32
        Texture of camera 2 at the pixels of camera 1; NaN where there is none.
    step : int
        Side of a cell; the last column takes the pixels that are left over, so do the last rows. [px]
    scale : array, (row, column), optional
        Expected rms of a - b in each cell. If given, a pixel whose difference is many times that (dust on one camera)
        loses its weight: w = 1/(1 + (e / 4 rms)^2).
    threads : int
        Threads to use.

    Returns
    -------
    array, (row, column, 11), float64
        See ``SUMS``.
    """
    h, w = a.shape
    rows, cols = max(h // step, 1), max(w // step, 1)
    sums = np.zeros((rows + 1, cols, SUMS))  # the extra row takes what is left over at the bottom
    if scale is None:
        limit = np.zeros((0, 0), np.float32)
    else:
        inverse = (1 / (4.0 * np.maximum(scale, 1e-6)) ** 2).astype(np.float32)
        limit = np.repeat(inverse, step, axis=1)
        limit = np.concatenate(
            [limit, np.repeat(limit[:, -1:], w - limit.shape[1], axis=1)], axis=1
        )
        limit = np.ascontiguousarray(np.concatenate([limit, limit[-1:]], axis=0))
    in_bands(lambda s, t: _cell_sums(a, weight, b, step, limit, sums, s, t), rows + 1, threads)
    sums[rows - 1] += sums[rows]
    return sums[:rows]


def cell_centres(size: int, step: int) -> AnyArray:
    """Coordinates of the cell centres along an axis of ``size`` pixels. [px]"""
    return np.arange(max(size // step, 1)) * step + (step - 1) / 2


def merge_cells(sums: AnyArray, factor: int) -> AnyArray:
    """Add up blocks of ``factor`` by ``factor`` cells; incomplete blocks at the far edges are kept."""
    rows, cols, n = sums.shape
    padded = np.zeros((-(-rows // factor) * factor, -(-cols // factor) * factor, n))
    padded[:rows, :cols] = sums
    merged: AnyArray = padded.reshape(
        padded.shape[0] // factor, factor, padded.shape[1] // factor, factor, n
    ).sum((1, 3))
    return merged


def without_noise(sums: AnyArray, slope: float = 1.0) -> AnyArray:
    """Sums whose gradient products hold the texture common to both cameras alone.

    The gradient of the mean image holds half the noise of each camera, which makes its products too large, the steps
    too short and the error too small. The product of the two cameras' gradients does not, but in a region without
    texture it need not be positive; so the former are scaled by the ratio of the two over 5 by 5 cells. ``slope`` is the
    factor by which the discrete derivative falls short (see `erlif.registration.whitening.slope_gain`).
    """
    total = ndimage.uniform_filter(sums[..., GXX] + sums[..., GYY], 5, mode="constant")
    cross = ndimage.uniform_filter(sums[..., CROSS], 5, mode="constant")
    ratio = np.clip(cross / np.maximum(total, 1e-30 + 1e-12 * float(total.max())), 0.05, 1.0)
    cleaned = sums.copy()
    cleaned[..., : GYY + 1] *= slope * ratio[..., None]
    return cleaned


def correlation(sums: AnyArray) -> float:
    """Correlation coefficient of the two textures over everything that was summed. [1]"""
    ab, aa, bb = (float(sums[..., k].sum()) for k in (AB, AA, BB))
    return ab / float(np.sqrt(aa * bb)) if aa > 0 and bb > 0 else 0.0


def solve_shift(sums: AnyArray) -> tuple[float, float]:
    """Displacement ``(dx, dy)`` [px] that one translation of everything summed still needs."""
    gxx, gxy, gyy, bx, by = (float(sums[..., k].sum()) for k in (GXX, GXY, GYY, BX, BY))
    det = gxx * gyy - gxy * gxy
    if not det > 1e-6 * (gxx + gyy) ** 2:
        return 0.0, 0.0
    return (gyy * bx - gxy * by) / det, (gxx * by - gxy * bx) / det


def move_sums(sums: AnyArray, delta_x: AnyArray | float, delta_y: AnyArray | float) -> AnyArray:
    """Sums as they would be after a further displacement (delta_x, delta_y) of every cell, to first order. [px]"""
    moved = sums.copy()
    gxx, gxy, gyy, bx, by = (sums[..., k] for k in (GXX, GXY, GYY, BX, BY))
    tx = gxx * delta_x + gxy * delta_y
    ty = gxy * delta_x + gyy * delta_y
    moved[..., BX] -= tx
    moved[..., BY] -= ty
    moved[..., EE] += tx * delta_x + ty * delta_y - 2 * (bx * delta_x + by * delta_y)
    return moved
