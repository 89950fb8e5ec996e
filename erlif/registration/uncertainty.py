"""How far the surface may be off, from the scatter of the scores themselves.

The sandwich M^-1 (sum of s s') M^-1 takes the scores s of independent blocks as they are, so texture that one camera
alone sees, correlated noise and unequal light all count (P. J. Huber, Proc. 5th Berkeley Symp. 1 (1967) 221). Residual
scores are too small where the fit could follow them; dividing them by one less their leverage is the jackknife (J. G.
MacKinnon, H. White, J. Econom. 29 (1985) 305).
"""

import numpy as np
from numba import njit

from erlif.core.arrays import AnyArray
from erlif.registration.matching import BX, BY, GXX, GXY, GYY
from erlif.registration.selection import Model
from erlif.registration.surface import Box, Cells, equations, spline_weights


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
    """Add each cell to the scores (block, 2p) of its block and to its leverage, the trace of M_b M^-1."""
    p = scores.shape[1] // 2
    phi = np.empty(16)
    index = np.empty(16, np.int64)
    for r in range(weight.shape[0]):
        for c in range(weight.shape[1]):
            w = weight[r, c]
            if w <= 0:
                continue
            b = block[r, c]
            k = 0
            for j in range(4):
                for i in range(4):
                    phi[k] = weight_y[r, j] * weight_x[c, i]
                    index[k] = (first_y[r] + j) * nx + first_x[c] + i
                    scores[b, index[k]] += phi[k] * w * sums[r, c, BX]
                    scores[b, p + index[k]] += phi[k] * w * sums[r, c, BY]
                    k += 1
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


def surface_covariance(cells: Cells, model: Model, box: Box) -> AnyArray:
    """Covariance of the spline coefficients of a fitted surface.

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
    side = 32.0 if model.coefficients <= 49 else 16.0
    side = max(
        min(side, (box[1] - box[0]) / 8, (box[3] - box[2]) / 8), float(cells.x[1] - cells.x[0])
    )
    column = ((cells.x - cells.x[0] + 0.5) // side).astype(np.int64)
    row = ((cells.y - cells.y[0] + 0.5) // side).astype(np.int64)
    block = row[:, None] * (column[-1] + 1) + column[None, :]
    first_x, weight_x = spline_weights(cells.x, box[0], box[1], nx)
    first_y, weight_y = spline_weights(cells.y, box[2], box[3], ny)
    p = (nx + 3) * (ny + 3)
    basis = np.eye(2 * p) if model.basis is None else np.kron(np.eye(2), model.basis)
    matrix = basis.T @ system.matrix @ basis
    ridge = 1e-9 * np.trace(matrix) / len(matrix)
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
    # the fit has bent towards each block by its leverage on either component; without the block, it had not
    scores /= np.maximum(1 - leverage / 2, 0.1)[:, None]
    spread = scores @ inverse
    return np.asarray(spread.T @ spread)


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


def surface_std(covariance: AnyArray, model: Model, box: Box, x: AnyArray, y: AnyArray) -> AnyArray:
    """Standard deviation of one component of the displacement (rms of the two) at the grid of x and y. [px]"""
    nx, ny = model.elements
    first_x, weight_x = spline_weights(x, box[0], box[1], nx)
    first_y, weight_y = spline_weights(y, box[2], box[3], ny)
    out = np.empty((len(y), len(x)))
    _variance_at(first_x, weight_x, first_y, weight_y, covariance, nx + 3, out)
    return np.sqrt(np.maximum(out, 0))
