"""Standard deviation of a fitted surface, from the scatter of the scores themselves.

The sandwich M^-1 (sum of s s') M^-1 takes the scores s of independent blocks as they are, so
texture that one camera alone sees, correlated noise and unequal light all count (Huber 1967).
Residual scores are too small where the fit could follow them; dividing them by one minus their
leverage is the jackknife (MacKinnon and White 1985).
"""

from itertools import pairwise
from typing import Final

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.registration.matching import system_of
from erlif.registration.selection import Model
from erlif.registration.surface import (
    RIDGE,
    Box,
    Cells,
    Pairs,
    equations,
    on_both_sides,
    pair_up,
    spline_weights,
)

# Side of the blocks whose scores are taken as independent: several correlation lengths. [px]
BLOCK: Final = 32.0
# The same for surfaces of many coefficients, which need more blocks. [px]
FINE_BLOCK: Final = 16.0
# Coefficients up to which the larger blocks are used: four by four elements.
COARSE: Final = 49
# Blocks along each axis, so that the scatter of the scores is known.
FEWEST_BLOCKS: Final = 8
# Part of its true score that a block keeps after the fit, at least.
SMALLEST_REST: Final = 0.1


def _block_scores(cells: Cells, block: AnyArray, across: Array, down: Array) -> Array:
    """Scores (block, component, y, x) of the splines: sums over the cells of each block."""
    on = cells.weight > 0
    rows = np.flatnonzero(np.diff(block[:, 0], prepend=-1))
    columns = np.flatnonzero(np.diff(block[0], prepend=-1))
    shape = len(rows), len(columns), 2, down.shape[1], across.shape[1]
    scores = np.empty(shape)

    for component, score in enumerate(system_of(cells.sums)[3:]):
        score = np.where(on, cells.weight * score, 0)
        lines = np.add.reduceat(score[:, :, None] * across, columns, axis=1)
        for row, (start, stop) in enumerate(pairwise([*rows, len(block)])):
            scores[row, :, component] = np.einsum(
                "rj,rbi->bji", down[start:stop], lines[start:stop]
            )
    return scores.reshape(-1, *shape[2:])


def _between(matrix: Array, x: Pairs, y: Pairs) -> Array:
    """Quadratic form of a matrix over the coefficients with the tensor splines at a grid."""
    n, m = int(y.first[-1]) + 1, int(x.first[-1]) + 1
    terms = matrix.reshape(n, m, n, m)[y.first[:, None], x.first, y.second[:, None], x.second]
    return on_both_sides(y.products, terms, x.products.T)


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
    across, down = spline_weights(cells.x, *box[:2], nx), spline_weights(cells.y, *box[2:], ny)

    # a polynomial is a restriction of the spline: its matrix is inverted in its own space
    p = (nx + 3) * (ny + 3)
    basis = np.eye(2 * p) if model.basis is None else np.kron(np.eye(2), model.basis)
    matrix = basis.T @ system.matrix @ basis
    ridge = RIDGE * np.trace(matrix) / len(matrix)
    inverse = np.linalg.inv(matrix + ridge * np.eye(len(matrix)))
    inverse = basis @ inverse @ basis.T

    # leverage of block b: the trace of M_b M^-1, M_b its part of the normal matrix M
    x, y = pair_up(across), pair_up(down)
    gxx, gxy, gyy, _, _ = system_of(cells.sums)
    share = gxx * _between(inverse[:p, :p], x, y) + 2 * gxy * _between(inverse[:p, p:], x, y)
    share = share + gyy * _between(inverse[p:, p:], x, y)
    share = np.where(cells.weight > 0, cells.weight * share, 0)
    leverage = np.bincount(block.ravel(), share.ravel())
    scores = _block_scores(cells, block, across, down).reshape(len(leverage), 2 * p)

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
    x_pairs, y_pairs = (
        pair_up(spline_weights(x, *box[:2], nx)),
        pair_up(spline_weights(y, *box[2:], ny)),
    )
    p = (nx + 3) * (ny + 3)
    out = 0.5 * _between(covariance[:p, :p] + covariance[p:, p:], x_pairs, y_pairs)
    return np.sqrt(np.maximum(out, 0))
