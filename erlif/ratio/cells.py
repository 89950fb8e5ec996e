"""Light and ratio of a frame pair in coarse cells, by which light that is not film shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array, FlagImage, Image
from erlif.core.speed.kernels import njit
from erlif.correction.light import BLOCK

# Rows and columns of cells over the image.
CELLS = (10, 12)

# Valid pixels of a block of 8 x 8 whose light is used: single defects leave it, bubbles do not.
_FULL = 60

# Those for its ratio, which saturated grains of the speckle leave as it is.
_ENOUGH = 32

# Pixels of an image from which on every second block along each axis is used: those of a cell are
# still some forty, and the noise of its means stays far below the speckle. [px]
_LARGE = 2**19

# Share of the blocks of a cell that may be missing: the illumination varies within a cell.
_MISSING = 0.03


class LightCells(NamedTuple):
    """Light and ratio of the cells of a frame pair, (cell,), or of a run, (frame, cell).

    NaN where pixels are missing, or where nothing is measured.

    Attributes
    ----------
    light : AnyArray
        Mean logarithm of the light of camera 1. [ln DN]
    log_ratio : AnyArray
        Mean logarithm of the ratio. [1]
    spread : AnyArray
        Variance of the logarithm of the ratio within a cell, without noise. [1]
    variance : AnyArray
        Variance of log_ratio by the noise of the pixels. [1]
    """

    light: AnyArray
    log_ratio: AnyArray
    spread: AnyArray
    variance: AnyArray


# Stands for a frame pair without light.
NO_CELLS = LightCells(*(np.full(CELLS[0] * CELLS[1], np.nan, np.float32) for _ in range(4)))


def sample_cells(
    light: Image,
    log_ratio: Image,
    variance: Image,
    flags: FlagImage,
    *,
    cells: tuple[int, int] = CELLS,
) -> LightCells:
    """Average light and ratio of a frame pair over the cells.

    Parameters
    ----------
    light : array, (y, x)
        Light of camera 1. [DN]
    log_ratio : array, (y, x)
        Logarithm of camera 2 over camera 1. [1]
    variance : array, (y, x)
        Variance of log_ratio. [1]
    flags : array, (y, x)
        0 for valid pixels.
    cells : tuple of int
        Their rows and columns.

    Returns
    -------
    LightCells
        Cells in the order of `cell_places`; all NaN for images with fewer blocks of 8 x 8 pixels.

    Examples
    --------
    >>> flat = np.full((80, 96), 1000, np.float32)
    >>> found = sample_cells(flat, 0 * flat, 0 * flat + 0.01, np.zeros(flat.shape, np.uint16))
    >>> round(float(np.exp(found.light[0]))), round(float(found.variance[0] * 64), 4)
    (1000, 0.01)
    """
    blocks = light.shape[0] // BLOCK, light.shape[1] // BLOCK
    sums = np.zeros((7, cells[0] * cells[1]))
    if blocks[0] < cells[0] or blocks[1] < cells[1]:
        return LightCells(*np.full((4, sums.shape[1]), np.nan, np.float32))
    step = 2 if light.size >= _LARGE else 1
    _sum_logarithms(light, log_ratio, variance, flags, step, *cells, sums)
    number, lit, of_light, used, of_ratio, squares, noise = sums

    # a cell with missing blocks would show another part of the beam, or of the film
    lit, count = (np.where(each >= (1 - _MISSING) * number, each, np.nan) for each in (lit, used))
    mean = of_ratio / count
    found = of_light / lit, mean, squares / count - mean**2 - noise / count, noise / count**2
    return LightCells(*(each.astype(np.float32) for each in found))


def cell_places() -> tuple[Array, Array]:
    """Positions (x, y) of the cells, each from -1 to 1 over the image, (cell,).

    Returns
    -------
    tuple of two arrays

    Examples
    --------
    >>> x, y = cell_places()
    >>> x.size, round(float(x[-1]), 2), round(float(y[-1]), 2)
    (120, 0.92, 0.9)
    """
    y, x = np.indices(CELLS).reshape(2, -1)
    return (2 * x + 1) / CELLS[1] - 1, (2 * y + 1) / CELLS[0] - 1


def cell_centres(shape: tuple[int, int], *, cells: tuple[int, int] = CELLS) -> tuple[Array, Array]:
    """Means of column and row over the pixels of each cell, (cell,).

    They differ from `cell_places`, which takes all cells for equal: a cell has whole blocks.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns of the image, with a block of 8 x 8 pixels for each cell.
    cells : tuple of int
        Rows and columns of the cells.

    Returns
    -------
    tuple of two arrays
        Columns and rows. [px]

    Examples
    --------
    >>> x, y = cell_centres((80, 120))
    >>> x[:4].tolist(), y[::12][:2].tolist()
    ([7.5, 19.5, 27.5, 35.5], [3.5, 11.5])
    """
    centres = []
    for size, count in zip(shape, cells, strict=True):
        block = np.arange(size // BLOCK)
        cell = block * count // block.size
        mean = np.bincount(cell, block) / np.bincount(cell)
        centres.append(BLOCK * mean + (BLOCK - 1) / 2)
    y, x = np.meshgrid(*centres, indexing="ij")
    return x.ravel(), y.ravel()


@njit(nogil=True, cache=True)
def _sum_logarithms(  # type: ignore[no-untyped-def]
    light, log_ratio, variance, flags, step, rows, columns, sums
):
    """Blocks of each cell, those whose light and ratio are used, and sums; one in step counts."""
    down, along = light.shape[0] // BLOCK, light.shape[1] // BLOCK
    of_blocks = np.empty((4, along))
    for i in range(0, down, step):
        # row by row through all blocks, as the memory lies
        of_blocks[:] = 0
        for y in range(i * BLOCK, (i + 1) * BLOCK):
            for j in range(0, along, step):
                count, total = of_blocks[0, j], of_blocks[1, j]
                ratio, noise = of_blocks[2, j], of_blocks[3, j]
                for x in range(j * BLOCK, (j + 1) * BLOCK):
                    good = flags[y, x] == 0
                    count += 1 if good else 0
                    total += light[y, x] if good else 0.0
                    ratio += log_ratio[y, x] if good else 0.0
                    noise += variance[y, x] if good else 0.0
                of_blocks[0, j], of_blocks[1, j] = count, total
                of_blocks[2, j], of_blocks[3, j] = ratio, noise

        for j in range(0, along, step):
            cell = (i * rows // down) * columns + j * columns // along
            sums[0, cell] += 1
            count, total = of_blocks[0, j], of_blocks[1, j]
            ratio, noise = of_blocks[2, j], of_blocks[3, j]
            if count >= _FULL and total > 0:
                sums[1, cell] += 1
                sums[2, cell] += np.log(total / count)
            if count >= _ENOUGH and total > 0:
                mean = ratio / count
                sums[3, cell] += 1
                sums[4, cell] += mean
                sums[5, cell] += mean * mean
                sums[6, cell] += noise / count**2
