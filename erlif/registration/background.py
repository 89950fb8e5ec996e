"""Light that lamp, lens and film shape, fitted and divided out before two bands are compared.

Where a film thickens fast, the light of the two bands differs in shape, and a registration that
takes this for texture shifts one camera against the other. A plain local mean leaves the curvature
of such light behind, and at the border of the image its slope; a local quadratic leaves neither
(local polynomial regression: Fan and Gijbels, 1996).
"""

from typing import Final

import numpy as np
import scipy

from erlif.core.arrays import AnyArray, Array, Image

CELL: Final = 8
"""Side of the cells whose sums are fitted. [px]"""

REACH: Final = 12.0
"""Standard deviation of the Gaussian window of the fit. [px]"""

CUT: Final = 3.0
"""Standard deviations at which the Gaussian window ends."""

BRIGHTER_PARTS: Final = 98
"""Percentile of the light that stands for the brighter parts of the frame."""

DARK: Final = 0.02
"""Light below this part of the brighter parts is too dark for a texture."""

_TERMS: Final = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))  # powers of x and y
_ORDERS: Final = 5  # the products of two quadratic terms have powers 0 to 4
_RIDGE: Final = 1e-6  # relative; keeps the fit solvable where hardly a pixel counts
_NOTHING: Final = 1e-12  # absolute; the same where no pixel counts


def local_light(image: AnyArray, weight: AnyArray) -> Image:
    """Fit a quadratic about every place and return its value there.

    Parameters
    ----------
    image : array, (y, x)
        Counts above the dark level.
    weight : array, (y, x)
        0 for a pixel that must not count, otherwise 1.

    Returns
    -------
    array, (y, x), float32
        The smooth part of the light, in the unit of the image; 0 where nothing near counts.

    Examples
    --------
    Light that is quadratic in x is found as it is:

    >>> x = np.broadcast_to(np.arange(96.0), (64, 96))
    >>> light = 2000 - 0.1 * (x - 40) ** 2
    >>> bool(np.allclose(local_light(light, np.ones_like(light)), light, rtol=2e-3))
    True
    """
    count = _cell_sums((weight > 0).astype(np.float32))
    light = _cell_sums(np.where(weight > 0, image, np.float32(0)))
    sigma = REACH / CELL
    reach = int(np.ceil(CUT * sigma))
    d = np.arange(-reach, reach + 1) / sigma
    taps = [np.exp(-0.5 * d**2) * d**n for n in range(_ORDERS)]

    def moment(cells: Array, along_x: int, along_y: int) -> Array:
        rows = scipy.ndimage.correlate1d(cells, taps[along_x], axis=1, mode="constant")
        return np.asarray(scipy.ndimage.correlate1d(rows, taps[along_y], axis=0, mode="constant"))

    # normal equations of the weighted quadratic about each cell
    moments = {(a, b): moment(count, a, b) for a in range(_ORDERS) for b in range(_ORDERS - a)}
    normal = np.stack(
        [np.stack([moments[a + c, b + d] for c, d in _TERMS], -1) for a, b in _TERMS], -2
    )
    normal += (_RIDGE * normal[..., :1, :1] + _NOTHING) * np.eye(len(_TERMS))
    data = np.stack([moment(light, a, b) for a, b in _TERMS], -1)

    # the constant term is the value at the cell itself
    fitted = np.linalg.solve(normal, data[..., None])[..., 0, 0]
    along_y, along_x = (
        _from_cells(cells, pixels) for cells, pixels in zip(fitted.shape, image.shape, strict=True)
    )
    return np.asarray(along_y @ fitted @ along_x.T, np.float32)


def divide_by_light(image: AnyArray, weight: AnyArray) -> tuple[Image, Image]:
    """Divide an image by its smooth light.

    Parameters
    ----------
    image : array, (y, x)
        Counts above the dark level.
    weight : array, (y, x)
        0 for a pixel that must not count, otherwise 1.

    Returns
    -------
    texture : array, (y, x), float32
        About 1 everywhere; 1 where the weight is 0. [1]
    weight : array, (y, x), float32
        0 also where the light is below a fiftieth of the brighter parts, otherwise 1.

    Examples
    --------
    A ramp of light leaves no texture:

    >>> ramp = np.broadcast_to(500 + 4 * np.arange(96.0, dtype=np.float32), (64, 96))
    >>> texture, weight = divide_by_light(ramp, np.ones_like(ramp))
    >>> bool(np.allclose(texture, 1, atol=2e-3)), bool(weight.all())
    (True, True)
    """
    light = local_light(image, weight)
    lit = (weight > 0) & (light > DARK * float(np.percentile(light, BRIGHTER_PARTS)))
    texture = np.divide(image, light, out=np.ones(image.shape, np.float32), where=lit)
    return texture, lit.astype(np.float32)


def _from_cells(cells: int, pixels: int) -> Array:
    """Matrix (pixel, cell) of the cubic spline from the cell centres to the pixels of one axis.

    Pixels beyond the last centres are extrapolated.
    """
    centres = CELL * (np.arange(cells) + 0.5) - 0.5
    return np.asarray(scipy.interpolate.CubicSpline(centres, np.eye(cells))(np.arange(pixels)))


def _cell_sums(image: AnyArray) -> Array:
    """Sums over the cells; a cell that the border cuts is filled up with zeros."""
    rows, cols = -(-image.shape[0] // CELL), -(-image.shape[1] // CELL)
    padded = np.zeros((rows * CELL, cols * CELL))
    padded[: image.shape[0], : image.shape[1]] = image
    return np.asarray(padded.reshape(rows, CELL, cols, CELL).sum(axis=(1, 3)))
