"""Images without illumination, so that two bands can be compared.

The local mean and the local rms are divided out; what is left is the texture.
"""

from typing import Final

import numpy as np
from numba import njit
from scipy import ndimage

from erlif.core.arrays import AnyArray, Image
from erlif.registration.bands import in_bands
from erlif.registration.interpolation import FAST

NO_WEIGHT: Final = np.zeros((0, 0), np.float32)
"""Stands for a weight of 1 on every pixel; the kernels take no None."""

CELL: Final = 4
"""Side of the cells from which the local mean and rms are averaged. [px]"""

REACH: Final = 12.0
"""Standard deviation of the Gaussian average of the local mean. [px]"""

REACH_OF_RMS: Final = 1.5
"""Standard deviation of the average of the local rms over that of the local mean."""

CUT: Final = 3.0
"""Standard deviations at which the Gaussian average ends."""

FINITE: Final = 1e30
"""Counts are far below this; infinity and NaN fail the comparison. [counts]"""

LARGEST: Final = 1e6
"""Textures are far below this; infinity and NaN fail the comparison. [1]"""

BRIGHTER_PARTS: Final = 98
"""Percentile of the local means that stands for the brighter parts of the frame."""

DARK: Final = 0.02
"""Light below this part of the brighter parts is too dark for a texture."""

LEAST_CONTRAST: Final = 0.02
"""The local rms is not taken below this part of the largest one, or flat parts would be noise."""

LEAST_RMS: Final = 1e-6
"""The same for a frame that is flat everywhere. [1]"""

NEAR: Final = 1e-6
"""Where the average of the weights is below this part of the largest weight, nothing is near."""


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def bin_image(
    image: AnyArray, weight: AnyArray, factor: int, out: AnyArray, out_weight: AnyArray
) -> None:
    """Weighted mean over blocks of ``factor`` by ``factor`` pixels, and the weight of each block.

    ``weight`` may be of size 0 for all ones. A block with half its weight or less gets weight 0.
    """
    h, w = out.shape
    weighted = weight.size > 0
    full = factor * factor

    for y in range(h):
        for x in range(w):
            total = np.float32(0)
            if weighted:
                sound = np.float32(0)
                for j in range(y * factor, (y + 1) * factor):
                    for i in range(x * factor, (x + 1) * factor):
                        if weight[j, i] > 0 and abs(np.float32(image[j, i])) < FINITE:
                            total += weight[j, i] * np.float32(image[j, i])
                            sound += weight[j, i]
            else:
                for j in range(y * factor, (y + 1) * factor):
                    for i in range(x * factor, (x + 1) * factor):
                        total += np.float32(image[j, i])
                sound = np.float32(full)

            ok = 2 * sound > full and abs(total) < FINITE
            out[y, x] = total / sound if ok else np.float32(0)
            out_weight[y, x] = np.float32(1) if ok else np.float32(0)


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
    h, w = image.shape
    out = np.empty((h // factor, w // factor), np.float32)
    out_weight = np.empty_like(out)
    bin_image(image, NO_WEIGHT if weight is None else weight, factor, out, out_weight)
    return out, out_weight


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _cell_statistics(
    image: AnyArray, weight: AnyArray, size: int, sums: AnyArray, start: int, stop: int
) -> None:
    """Weight, mean and variance of the cells in the rows ``start`` to ``stop``."""
    h, w = image.shape
    weighted = weight.size > 0

    for r in range(start, stop):
        for c in range(sums.shape[1]):
            s0 = np.float32(0)
            s1 = np.float32(0)
            s2 = np.float32(0)
            x0, x1 = c * size, min((c + 1) * size, w)
            y0, y1 = r * size, min((r + 1) * size, h)

            # deviations from one pixel of the cell, so that single precision holds their squares
            pivot = np.float32(image[(y0 + y1) // 2, (x0 + x1) // 2])
            if not abs(pivot) < FINITE:
                pivot = np.float32(0)

            for y in range(y0, y1):
                for x in range(x0, x1):
                    value = np.float32(image[y, x]) - pivot
                    g = np.float32(1)
                    if weighted:
                        g = np.float32(weight[y, x])
                    if not (g > 0 and abs(value) < FINITE):
                        g = np.float32(0)
                        value = np.float32(0)
                    s0 += g
                    s1 += g * value
                    s2 += g * value * value

            sums[r, c, 0] = s0
            if s0 > 0:
                mean = s1 / s0
                sums[r, c, 1] = pivot + mean
                sums[r, c, 2] = max(s2 / s0 - mean * mean, 0.0)
            else:
                sums[r, c, 1] = 0.0
                sums[r, c, 2] = 0.0


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FAST)
def _flatten(
    image: AnyArray,
    weight: AnyArray,
    size: int,
    mean: AnyArray,
    scale: AnyArray,
    floor: float,
    out: AnyArray,
    out_weight: AnyArray,
    start: int,
    stop: int,
) -> None:
    """(I / mean - 1) / rms, with mean and 1/rms bilinear between the cell centres.

    ``scale`` is 1/rms, ``floor`` the light below which a pixel gets weight and texture 0.
    """
    w = image.shape[1]
    rows, cols = mean.shape
    weighted = weight.size > 0

    # the cell to the left of each column, and the part of the way to the next; constant at the edge
    left = np.empty(w, np.int64)
    part = np.empty(w, np.float32)
    for x in range(w):
        t = (x + 0.5) / size - 0.5
        t = min(max(t, 0.0), cols - 1.0)
        left[x] = min(int(t), max(cols - 2, 0))
        part[x] = t - left[x]

    row_mean = np.empty(cols + 1, np.float32)
    row_scale = np.empty(cols + 1, np.float32)
    low = np.float32(floor)
    for y in range(start, stop):
        # first along y, once for all columns; one entry more stands for the next of the last cell
        t = (y + 0.5) / size - 0.5
        t = min(max(t, 0.0), rows - 1.0)
        j = min(int(t), max(rows - 2, 0))
        v = np.float32(t - j)
        k = min(j + 1, rows - 1)
        for c in range(cols):
            row_mean[c] = (1 - v) * mean[j, c] + v * mean[k, c]
            row_scale[c] = (1 - v) * scale[j, c] + v * scale[k, c]
        row_mean[cols] = row_mean[cols - 1]
        row_scale[cols] = row_scale[cols - 1]

        for x in range(w):
            i = left[x]
            u = part[x]
            m = row_mean[i] + u * (row_mean[i + 1] - row_mean[i])
            s = row_scale[i] + u * (row_scale[i + 1] - row_scale[i])
            value = (np.float32(image[y, x]) / m - np.float32(1)) * s

            g = np.float32(1)
            if weighted:
                g = np.float32(weight[y, x])
            ok = m > low and g > 0 and abs(value) < np.float32(LARGEST)
            out[y, x] = value if ok else np.float32(0)
            out_weight[y, x] = g if ok else np.float32(0)


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
    weight = NO_WEIGHT if weight is None else weight
    rows, cols = -(-h // CELL), -(-w // CELL)
    sums = np.empty((rows, cols, 3), np.float32)
    in_bands(lambda a, b: _cell_statistics(image, weight, CELL, sums, a, b), rows, threads)
    sound, level, square = sums[..., 0], sums[..., 1], sums[..., 2]

    # cells that are too dark keep no weight
    lit = sound > 0
    bright = float(np.percentile(level[lit], BRIGHTER_PARTS)) if lit.any() else 0.0
    if bright <= 0:
        return np.zeros((h, w), np.float32), np.zeros((h, w), np.float32)
    floor = DARK * bright
    sound = np.where(level > floor, sound, 0)

    # variance within the cells and between them, both over the mean
    mean = _average(level, sound, reach / CELL)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(sound > 0, (square + (level - mean) ** 2) / mean**2, 0)
    rms = np.sqrt(np.maximum(_average(relative, sound, REACH_OF_RMS * reach / CELL), 0))
    least = max(LEAST_CONTRAST * float(rms.max()), LEAST_RMS)
    scale = (1 / np.maximum(rms, least)).astype(np.float32)

    out = np.empty((h, w), np.float32)
    out_weight = np.empty((h, w), np.float32)
    in_bands(
        lambda a, b: _flatten(image, weight, CELL, mean, scale, floor, out, out_weight, a, b),
        h,
        threads,
    )
    return out, out_weight


def _average(cells: Image, weight: Image, sigma: float) -> Image:
    """Weighted Gaussian average, edges mirrored; the mean of all where no weight is near."""

    def blurred(values: AnyArray) -> AnyArray:
        return np.asarray(ndimage.gaussian_filter(values, sigma, mode="reflect", truncate=CUT))

    # without gaps the weights cancel
    if float(weight.min()) == float(weight.max()):
        return np.asarray(blurred(cells), np.float32)

    near = blurred(weight)
    total = blurred(cells * weight)
    overall = float((cells * weight).sum() / max(float(weight.sum()), 1e-30))
    safe = near > NEAR * float(weight.max())
    return np.asarray(np.where(safe, total / np.where(safe, near, 1), overall), np.float32)
