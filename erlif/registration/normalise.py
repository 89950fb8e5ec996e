"""Images without illumination, so that two bands can be compared.

The local mean and the local rms are divided out; what is left is the texture.
"""

from functools import lru_cache
from typing import Final

import cv2
import numpy as np

from erlif.core.arrays import FAST, AnyArray, Image
from erlif.core.speed.kernels import njit
from erlif.registration.bands import in_bands

# Side of the cells from which the local mean and rms are averaged. [px]
CELL: Final = 4

# Standard deviation of the Gaussian average of the local mean. [px]
REACH: Final = 12.0

# Standard deviation of the average of the local rms over that of the local mean.
REACH_OF_RMS: Final = 1.5

# Degree of the local mean: one of 0 leaves slope and bend of the light, which both bands have
# elsewhere, as a texture.
DEGREE: Final = 2

# Standard deviations at which a Gaussian window ends.
CUT: Final = 3.0

# Counts are far below this; infinity and NaN fail the comparison. [counts]
FINITE: Final = 1e30

# Textures are far below this; infinity and NaN fail the comparison. [1]
LARGEST: Final = 1e6

# Percentile of the local light that stands for the brighter parts of the frame.
BRIGHTER_PARTS: Final = 98

# Of so many cells one is looked at for that percentile.
EVERY: Final = 5

# Light below this part of the brighter parts is too dark for a texture.
DARK: Final = 0.02

# The local rms is not taken below this part of the largest one, or flat parts would be noise.
LEAST_CONTRAST: Final = 0.02

# The same for a frame that is flat everywhere. [1]
LEAST_RMS: Final = 1e-6

# A binned pixel counts if more than this part of it does. [1]
MOST: Final = 0.5

# Where the average of the weights is below this part of the largest weight, nothing is near.
NEAR: Final = 1e-6


def binned(image: AnyArray, weight: AnyArray | None, factor: int) -> tuple[Image, Image]:
    """Average an image over blocks.

    Parameters
    ----------
    image : array, (y, x)
        Any real type.
    weight : array, (y, x), optional
        0 for pixels that must not count.
    factor : int
        Side of the blocks; pixels beyond the last whole block are dropped. [px]

    Returns
    -------
    image, weight : array, (y // factor, x // factor), float32
        Weighted means, and 1 where more than half of the block counts, otherwise both 0.
    """
    h, w = image.shape[0] // factor, image.shape[1] // factor
    image = image[: h * factor, : w * factor].astype(np.float32, copy=False)
    size = (w, h)
    if weight is None:
        out = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        ok = np.abs(out) < FINITE
        return np.where(ok, out, np.float32(0)), ok.astype(np.float32)

    # pixels that are not finite must not enter the sums; in them they would show as such
    weight = weight[: h * factor, : w * factor].astype(np.float32, copy=False)
    total = cv2.resize(image * weight, size, interpolation=cv2.INTER_AREA)
    if not (np.abs(total) < FINITE).all():
        good = (weight > 0) & (np.abs(image) < FINITE)
        weight = np.where(good, weight, np.float32(0))
        total = cv2.resize(np.where(good, image, 0) * weight, size, interpolation=cv2.INTER_AREA)
    sound = cv2.resize(weight, size, interpolation=cv2.INTER_AREA)
    ok = sound > MOST
    return np.where(ok, total / np.where(ok, sound, 1), np.float32(0)), ok.astype(np.float32)


_at = np.uint64  # an index that cannot count from the end


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST, inline="always")
def _add_moments(
    row: AnyArray,
    weight: AnyArray,
    pivot: AnyArray,
    s0: AnyArray,
    s1: AnyArray,
    s2: AnyArray,
) -> None:
    """Add the weight of a row, and the first two moments of its deviation from the pivot."""
    zero = np.float32(0)
    for x in range(row.size):
        value = np.float32(row[x]) - pivot[x]
        g = np.float32(weight[x])
        ok = (g > zero) & (abs(value) < np.float32(FINITE))
        g = g if ok else zero
        value = value if ok else zero
        s0[x] += g
        s1[x] += g * value
        s2[x] += g * value * value


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _cell_statistics(
    image: AnyArray, weight: AnyArray, size: int, sums: AnyArray, start: int, stop: int
) -> None:
    """Weight, mean and variance of the cells in the rows ``start`` to ``stop``."""
    h, w = image.shape
    pivot = np.empty(w, np.float32)
    s0, s1, s2 = np.empty(w, np.float32), np.empty(w, np.float32), np.empty(w, np.float32)

    for r in range(start, stop):
        # deviations from one pixel of the cell, so that single precision holds their squares
        y0, y1 = r * size, min((r + 1) * size, h)
        for c in range(sums.shape[2]):
            x0, x1 = c * size, min((c + 1) * size, w)
            one = np.float32(image[(y0 + y1) // 2, (x0 + x1) // 2])
            pivot[x0:x1] = one if abs(one) < np.float32(FINITE) else np.float32(0)

        # first along the columns, then across each cell
        s0[:] = np.float32(0)
        s1[:] = np.float32(0)
        s2[:] = np.float32(0)
        for y in range(y0, y1):
            _add_moments(image[y], weight[y], pivot, s0, s1, s2)
        for c in range(sums.shape[2]):
            x0, x1 = c * size, min((c + 1) * size, w)
            total, first, second = s0[x0], s1[x0], s2[x0]
            for x in range(x0 + 1, x1):
                total += s0[x]
                first += s1[x]
                second += s2[x]

            sums[0, r, c] = total
            mean = first / total if total > 0 else np.float32(0)
            sums[1, r, c] = pivot[x0] + mean if total > 0 else np.float32(0)
            sums[2, r, c] = max(second / total - mean * mean, 0.0) if total > 0 else 0.0


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _flatten(
    light: AnyArray,
    weight: AnyArray,
    mean: AnyArray,
    scale: AnyArray,
    floor: float,
    out: AnyArray,
    out_weight: AnyArray,
    start: int,
    stop: int,
) -> None:
    """(I / mean - 1) times ``scale``, which is 1/rms, in the rows ``start`` to ``stop``.

    ``mean`` and ``scale`` are (cell row, x), linear between the middles of the cells. ``floor`` is
    the light below which a pixel gets weight and texture 0.
    """
    zero, one = np.float32(0), np.float32(1)
    low = np.float32(floor)
    last = mean.shape[0] - 1
    for row in range(start, stop):
        above = (row - CELL // 2) // CELL
        part = np.float32((row - above * CELL + 0.5) / CELL - 0.5)
        y, y0, y1 = _at(row), _at(max(above, 0)), _at(min(above + 1, last))
        for t in range(out.shape[1]):
            x = _at(t)
            level = mean[y0, x] + part * (mean[y1, x] - mean[y0, x])
            per_rms = scale[y0, x] + part * (scale[y1, x] - scale[y0, x])
            value = (np.float32(light[y, x]) / level - one) * per_rms
            w = weight[y, x]
            if not ((level > low) & (w > zero) & (abs(value) < np.float32(LARGEST))):
                value = w = zero
            out[y, x] = value
            out_weight[y, x] = w


def normalise(
    image: AnyArray, weight: AnyArray | None = None, *, reach: float = REACH, threads: int = 1
) -> tuple[Image, Image]:
    """Divide out the local mean and the local rms, which leaves the texture.

    The local statistics are Gaussian averages of those of small cells: an average over cells of
    the size of the texture would tie what is left to the pixel grid of each camera, and pull the
    two grids towards each other.

    Parameters
    ----------
    image : array, (y, x)
        Counts above the dark level, any real type.
    weight : array, (y, x), optional
        0 for a pixel that must not count (bad, saturated, dust).
    reach : float
        Standard deviation of the Gaussian average of the local mean; one and a half times that
        for the rms. [px]
    threads : int
        Threads to use.

    Returns
    -------
    texture : array, (y, x), float32
        Mean 0 and rms near 1; 0 where the weight is 0. [1]
    weight : array, (y, x), float32
        0 where the pixel must not count or is not finite.

    Notes
    -----
    Cells darker than a fiftieth of the brighter parts of the frame do not enter the averages.

    Examples
    --------
    The texture of a chequerboard does not depend on the light that falls on it:

    >>> y, x = np.indices((64, 64))
    >>> board = 1 + 0.1 * (-1.0) ** (x + y)
    >>> texture, weight = normalise(2000 * board)
    >>> bool(np.allclose(texture, (-1.0) ** (x + y), atol=1e-3))
    True
    """
    h, w = image.shape
    image = np.ascontiguousarray(image)
    if weight is None:
        weight = np.ones((h, w), np.float32)
    weight = np.ascontiguousarray(weight)
    rows, cols = -(-h // CELL), -(-w // CELL)
    sums = np.empty((3, rows, cols), np.float32)
    in_bands(lambda a, b: _cell_statistics(image, weight, CELL, sums, a, b), rows, threads)
    sound, level, square = sums

    # cells that are too dark keep no weight
    lit = level.ravel() if sound.all() else level[sound > 0]
    bright = float(np.percentile(lit[::EVERY], BRIGHTER_PARTS)) if lit.size else 0.0
    if bright <= 0:
        return np.zeros((h, w), np.float32), np.zeros((h, w), np.float32)
    floor = DARK * bright
    sound = np.where(level > floor, sound, 0)

    # variance within the cells and between them, both over the mean
    mean = _local_parabola(level, sound, reach / CELL)
    relative = np.zeros_like(mean)
    np.divide(square + (level - mean) ** 2, mean * mean, out=relative, where=sound > 0)
    rms = np.sqrt(np.maximum(_gaussian_average(relative, sound, REACH_OF_RMS * reach / CELL), 0))
    least = max(LEAST_CONTRAST * float(rms.max()), LEAST_RMS)
    scale = (1 / np.maximum(rms, least)).astype(np.float32)

    # mean and scale are linear between the cell centres, and constant beyond the outer ones
    size = (cols * CELL, rows)
    wide_mean, wide_scale = (
        cv2.resize(cells, size, interpolation=cv2.INTER_LINEAR) for cells in (mean, scale)
    )
    out = np.empty((h, w), np.float32)
    out_weight = np.empty((h, w), np.float32)
    in_bands(
        lambda a, b: _flatten(image, weight, wide_mean, wide_scale, floor, out, out_weight, a, b),
        h,
        threads,
    )
    return out, out_weight


def _local_parabola(cells: Image, weight: Image, sigma: float) -> Image:
    """Value at each cell of a parabola along both axes, fitted with Gaussian weights."""
    filled = np.where(weight > 0, cells, _gaussian_average(cells, weight, sigma))
    pivot = filled.max()
    y, x = (_parabola_weights(side, sigma) for side in cells.shape)
    return np.asarray(pivot + y @ (filled - pivot) @ x.T, np.float32)


@lru_cache(maxsize=16)
def _parabola_weights(count: int, sigma: float) -> Image:
    """Row i: the weights with which the values along an axis enter the parabola at i.

    The first row of the inverse of the normal matrix gives its value in the middle, at the edges of
    the image as well, where a mean alone would leave the slope.
    """
    away = (np.arange(count) - np.arange(count)[:, None]) / sigma
    near = np.exp(-0.5 * away**2)
    terms = away[..., None] ** np.arange(DEGREE + 1)

    normal = np.einsum("ij,ija,ijb->iab", near, terms, terms)
    middle = np.linalg.inv(normal)[:, 0]
    return np.asarray(near * np.einsum("ija,ia->ij", terms, middle), np.float32)


def _gaussian_average(cells: Image, weight: Image, sigma: float) -> Image:
    """Weighted Gaussian average, edges mirrored; the mean of all where no weight is near."""

    reach = int(CUT * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()

    def blurred(values: Image) -> Image:
        border = cv2.BORDER_REFLECT
        return np.asarray(cv2.sepFilter2D(values, cv2.CV_32F, kernel, kernel, borderType=border))

    # of deviations: rounding must not give a texture to a frame that has none
    pivot = cells.max()
    deviation = cells - pivot

    # without gaps the weights cancel
    if float(weight.min()) == float(weight.max()):
        return np.asarray(pivot + blurred(deviation), np.float32)

    near = blurred(weight)
    total = blurred(deviation * weight)
    overall = float((cells * weight).sum() / max(float(weight.sum()), 1e-30))
    safe = near > NEAR * float(weight.max())
    return np.asarray(np.where(safe, pivot + total / np.where(safe, near, 1), overall), np.float32)
