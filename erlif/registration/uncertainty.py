"""Standard deviation of a fitted surface, from the scatter of the scores themselves.

The sandwich M^-1 (sum of s s') M^-1 takes the scores s of independent blocks as they are, so
texture that one camera alone sees, correlated noise and unequal light all count (Huber 1967).
Residual scores are too small where the fit could follow them; dividing them by one minus their
leverage is the jackknife (MacKinnon and White 1985).
"""

from typing import Final

import numpy as np
from numba import njit

from erlif.core.arrays import AnyArray, Array
from erlif.registration.matching import BX, BY, GXX, GXY, GYY
from erlif.registration.selection import Model
from erlif.registration.surface import RIDGE, Box, Cells, equations, spline_weights

BLOCK: Final = 32.0
"""Side of the blocks whose scores are taken as independent: several correlation lengths. [px]"""
FINE_BLOCK: Final = 16.0
"""The same for surfaces of many coefficients, which need more blocks. [px]"""
COARSE: Final = 49
"""Coefficients up to which the larger blocks are used: four by four elements."""
FEWEST_BLOCKS: Final = 8
"""Blocks along each axis, so that the scatter of the scores is known."""
SMALLEST_REST: Final = 0.1
"""Part of its true score that a block keeps after the fit, at least."""


@njit(nogil=True, cache=True, error_model="numpy")
def _block_scores(
    sums: AnyArray,
    weight: AnyArray,
    first_x: AnyArray,
    weight_x: AnyArray,
    first_y: AnyArray,
    weight_y: AnyArray,
    block: AnyArray,
    nx: int,
    inverse: AnyArray,
    scores: AnyArray,
    leverage: AnyArray,
) -> None:
    """Add each cell to the scores (block, 2p) and the leverage of its block.

    The leverage of block b is the trace of M_b M^-1, M_b its part of the normal matrix M.
    """
    p = scores.shape[1] // 2
    phi = np.empty(16)
    index = np.empty(16, np.int64)

    for r in range(weight.shape[0]):
        for c in range(weight.shape[1]):
            w = weight[r, c]
            if w <= 0:
                continue

            # the sixteen splines that reach the cell, and their share in its score
            b = block[r, c]
            k = 0
            for j in range(4):
                for i in range(4):
                    phi[k] = weight_y[r, j] * weight_x[c, i]
                    index[k] = (first_y[r] + j) * nx + first_x[c] + i
                    scores[b, index[k]] += phi[k] * w * sums[r, c, BX]
                    scores[b, p + index[k]] += phi[k] * w * sums[r, c, BY]
                    k += 1

            # variance of the surface at the cell, for a fit of unit residual variance
            xx, xy, yy = 0.0, 0.0, 0.0
            for m in range(16):
                for n in range(16):
                    both = phi[m] * phi[n]
                    xx += both * inverse[index[m], index[n]]
                    xy += both * inverse[index[m], p + index[n]]
                    yy += both * inverse[p + index[m], p + index[n]]
            leverage[b] += w * (
                sums[r, c, GXX] * xx + 2 * sums[r, c, GXY] * xy + sums[r, c, GYY] * yy
            )


def surface_covariance(cells: Cells, model: Model, box: Box) -> Array:
    """Return the covariance of the spline coefficients of a fitted surface.

    In the corners of frames below some 500 px, where single blocks determine a spline, it is too
    large: up to four times in standard deviation for 2 by 2 elements on 256 by 256 px.

    Parameters
    ----------
    cells : Cells
        Sums moved to the fitted surface, so that their scores are residuals.
    model : Model
        The fitted model.
    box : Box
        Region of its spline.

    Returns
    -------
    array, (2p, 2p)
        x coefficients first. [px^2]
    """
    nx, ny = model.elements
    system = equations(cells, model.elements, box=box)
    block = blocks_of(cells, model, box)
    first_x, weight_x = spline_weights(cells.x, box[0], box[1], nx)
    first_y, weight_y = spline_weights(cells.y, box[2], box[3], ny)

    # a polynomial is a restriction of the spline: its matrix is inverted in its own space
    p = (nx + 3) * (ny + 3)
    basis = np.eye(2 * p) if model.basis is None else np.kron(np.eye(2), model.basis)
    matrix = basis.T @ system.matrix @ basis
    ridge = RIDGE * np.trace(matrix) / len(matrix)
    inverse = np.linalg.inv(matrix + ridge * np.eye(len(matrix)))
    inverse = basis @ inverse @ basis.T

    blocks = int(block.max()) + 1
    scores, leverage = np.zeros((blocks, 2 * p)), np.zeros(blocks)
    _block_scores(
        cells.sums,
        cells.weight,
        first_x,
        weight_x,
        first_y,
        weight_y,
        block,
        nx + 3,
        inverse,
        scores,
        leverage,
    )

    # the fit has bent towards each block by its leverage, half of it on either component
    scores /= np.maximum(1 - leverage / 2, SMALLEST_REST)[:, None]
    spread = scores @ inverse
    return np.asarray(spread.T @ spread)


def blocks_of(cells: Cells, model: Model, box: Box) -> AnyArray:
    """Number (row, column) of the square block to which each cell belongs."""
    side = BLOCK if model.coefficients <= COARSE else FINE_BLOCK
    side = min(side, (box[1] - box[0]) / FEWEST_BLOCKS, (box[3] - box[2]) / FEWEST_BLOCKS)
    side = max(side, float(cells.x[1] - cells.x[0]))  # no block is smaller than a cell

    # half a pixel keeps the cells that begin a block clear of rounding
    column = ((cells.x - cells.x[0] + 0.5) // side).astype(np.int64)
    row = ((cells.y - cells.y[0] + 0.5) // side).astype(np.int64)
    return np.asarray(row[:, None] * (column[-1] + 1) + column[None, :])


@njit(nogil=True, cache=True, error_model="numpy")
def _variance_at(
    first_x: AnyArray,
    weight_x: AnyArray,
    first_y: AnyArray,
    weight_y: AnyArray,
    covariance: AnyArray,
    nx: int,
    out: AnyArray,
) -> None:
    """Mean variance of the two components at the grid of positions."""
    p = covariance.shape[0] // 2
    index = np.empty(16, np.int64)
    phi = np.empty(16)

    for r in range(out.shape[0]):
        for c in range(out.shape[1]):
            k = 0
            for j in range(4):
                for i in range(4):
                    index[k] = (first_y[r] + j) * nx + first_x[c] + i
                    phi[k] = weight_y[r, j] * weight_x[c, i]
                    k += 1

            total = 0.0
            for a in range(16):
                for b in range(16):
                    ia, ib = index[a], index[b]
                    total += phi[a] * phi[b] * (covariance[ia, ib] + covariance[p + ia, p + ib])
            out[r, c] = 0.5 * total


def surface_std(covariance: Array, model: Model, box: Box, x: Array, y: Array) -> Array:
    """Return the standard deviation of the displacement of a surface.

    Parameters
    ----------
    covariance : array, (2p, 2p)
        Of the spline coefficients, x coefficients first. [px^2]
    model : Model
        The fitted model.
    box : Box
        Region of its spline.
    x, y : array, (m,) and (n,)
        Coordinates. [px]

    Returns
    -------
    array, (n, m)
        Standard deviation of one component, the rms of the two. [px]
    """
    nx, ny = model.elements
    first_x, weight_x = spline_weights(x, box[0], box[1], nx)
    first_y, weight_y = spline_weights(y, box[2], box[3], ny)
    out = np.empty((len(y), len(x)))
    _variance_at(first_x, weight_x, first_y, weight_y, covariance, nx + 3, out)
    return np.sqrt(np.maximum(out, 0))
