"""The light that lamp, lens and film shape, fitted and divided out before two bands are compared.

A film that thickens fast lights the two bands differently, and a registration that takes this for texture shifts one camera
against the other. A plain local mean leaves the curvature of such light behind, and at the border of the image its slope; a local
quadratic leaves neither (local polynomial regression: Fan and Gijbels, Local Polynomial Modelling, 1996).
"""

from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import correlate1d

from erlif.core.arrays import AnyArray

CELL: Final = 8
"""Side of the cells whose sums are fitted. [px]"""
REACH: Final = 12.0
"""Standard deviation of the Gaussian window of the fit. [px]"""
_TERMS: Final = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))  # powers of x and y
_RIDGE: Final = 1e-6  # keeps the fit solvable where hardly a pixel counts


def local_light(image: AnyArray, weight: AnyArray) -> AnyArray:
    """Fit a quadratic about every place and return it there.

    Parameters
    ----------
    image : array, (y, x)
        Counts above the dark level.
    weight : array, (y, x)
        0 for a pixel that must not count, otherwise 1.

    Returns
    -------
    array, (y, x), float32
        The smooth part of the light; 0 where nothing near counts.
    """
    h, w = image.shape
    count = _cell_sums((weight > 0).astype(np.float32))
    light = _cell_sums(np.where(weight > 0, image, np.float32(0)))
    sigma = REACH / CELL
    reach = int(np.ceil(3 * sigma))
    d = np.arange(-reach, reach + 1) / sigma
    taps = [np.exp(-0.5 * d**2) * d**n for n in range(5)]

    def moment(cells: AnyArray, along_x: int, along_y: int) -> AnyArray:
        rows = correlate1d(cells, taps[along_x], axis=1, mode="constant")
        return np.asarray(correlate1d(rows, taps[along_y], axis=0, mode="constant"))

    moments = {(a, b): moment(count, a, b) for a in range(5) for b in range(5 - a)}
    normal = np.stack(
        [np.stack([moments[a + c, b + d] for c, d in _TERMS], -1) for a, b in _TERMS], -2
    )
    normal += (_RIDGE * normal[..., :1, :1] + 1e-12) * np.eye(len(_TERMS))
    data = np.stack([moment(light, a, b) for a, b in _TERMS], -1)
    fitted = np.linalg.solve(normal, data[..., None])[..., 0, 0]
    along_y, along_x = (
        _from_cells(cells, pixels) for cells, pixels in zip(fitted.shape, (h, w), strict=True)
    )
    return np.asarray(along_y @ fitted @ along_x.T, np.float32)


def _from_cells(cells: int, pixels: int) -> AnyArray:
    """Cubic spline from the centres of the cells to the pixels of one axis, beyond the last centres too; (pixel, cell)."""
    centres = CELL * (np.arange(cells) + 0.5) - 0.5
    return np.asarray(CubicSpline(centres, np.eye(cells))(np.arange(pixels)))


def divide_by_light(image: AnyArray, weight: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Divide an image by its smooth light.

    Parameters
    ----------
    image, weight : array, (y, x)
        As for `local_light`.

    Returns
    -------
    texture, weight : array, (y, x), float32
        About 1 everywhere; the weight is 0 also where the light is below a fiftieth of the brighter parts.
    """
    light = local_light(image, weight)
    lit = (weight > 0) & (light > 0.02 * float(np.percentile(light, 98)))
    texture = np.divide(image, light, out=np.ones(image.shape, np.float32), where=lit)
    return texture, lit.astype(np.float32)


def _cell_sums(image: AnyArray) -> AnyArray:
    rows, cols = -(-image.shape[0] // CELL), -(-image.shape[1] // CELL)
    padded = np.zeros((rows * CELL, cols * CELL))
    padded[: image.shape[0], : image.shape[1]] = image
    return np.asarray(padded.reshape(rows, CELL, cols, CELL).sum(axis=(1, 3)))
