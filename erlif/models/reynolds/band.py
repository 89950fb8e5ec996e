"""Linear systems of a film that closes round the joint: five neighbours, solved as a band."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import ModelError


@dataclass(frozen=True)
class Stencil:
    """Coefficients of each cell's own value and of its neighbours' values, all (cell, axial).

    Attributes
    ----------
    centre : Array
        Coefficient of the cell itself.
    previous : Array
        Coefficient of the neighbour before, along the circumference. The first cell and the last
        one are neighbours; in a film that does not close, these links are zero.
    following : Array
        Coefficient of the neighbour behind.
    lower : Array
        Coefficient of the neighbour before, along the axis; ignored in the first row.
    upper : Array
        Coefficient of the neighbour behind; ignored in the last row.
    """

    centre: Array
    previous: Array
    following: Array
    lower: Array
    upper: Array


def solve_ring(stencil: Stencil, right: Array) -> Array:
    """Solve the equations of all cells for several right-hand sides.

    Where two columns are not linked, the ring is cut there and the band is as wide as a column has
    cells. A ring without such a place is folded, so that the cells on both of its arms alternate,
    and the band is twice as wide (LAPACK gbsv).

    Parameters
    ----------
    stencil : Stencil
        Coefficients. The number of columns must be even.
    right : array, (side, cell, axial)
        Right-hand sides.

    Returns
    -------
    array, (side, cell, axial)
        Solutions.

    Raises
    ------
    ModelError
        A singular system.

    Examples
    --------
    Four cells in a row, p'' = -2 between two ends of pressure zero:

    >>> links = np.array([[0.0], [1.0], [1.0], [1.0]])
    >>> none = np.zeros((4, 1))
    >>> row = Stencil(np.full((4, 1), -2.0), links, links[::-1], none, none)
    >>> solve_ring(row, np.full((1, 4, 1), -2.0)).ravel()
    array([4., 6., 6., 4.])
    """
    columns, axial = stencil.centre.shape
    linked = (stencil.previous != 0).any(axis=1)
    linked |= np.roll((stencil.following != 0).any(axis=1), 1)
    if linked.all():
        return _solve_folded(stencil, right)
    cut = int(np.argmin(linked))
    order = (np.arange(columns) + cut) % columns
    band, middle = _columns(stencil, order, axial)
    band[1:, :, middle - axial] += stencil.following[order][:-1]
    band[:-1, :, middle + axial] += stencil.previous[order][1:]
    return _solve_band(band, right, order, axial)


def _solve_folded(stencil: Stencil, right: Array) -> Array:
    """The closed ring, its columns in the order 0, n-1, 1, n-2, and so on."""
    columns, axial = stencil.centre.shape
    half = columns // 2
    order = np.empty(columns, dtype=np.intp)
    order[0::2], order[1::2] = np.arange(half), np.arange(columns - 1, half - 1, -1)
    previous, following = stencil.previous[order], stencil.following[order]
    width = 2 * axial
    band, middle = _columns(stencil, order, width)

    # along one arm the next column is two places on, along the other two places back
    outer, inner = slice(0, columns - 2), slice(2, columns)
    outward, inward = previous.copy(), following.copy()
    outward[1::2], inward[1::2] = following[1::2], previous[1::2]
    band[inner, :, middle - width] = inward[outer]
    band[outer, :, middle + width] = outward[inner]

    # both arms meet at their two ends
    band[1, :, middle - axial] = previous[0]
    band[0, :, middle + axial] = following[1]
    band[-1, :, middle - axial] = following[-2]
    band[-2, :, middle + axial] = previous[-1]
    return _solve_band(band, right, order, width)


def _columns(stencil: Stencil, order: AnyArray, width: int) -> tuple[Array, int]:
    """Band with the links within each column, the columns in an order, and the place of centres.

    LAPACK stores A[i, j] at row middle + i - j of column j; here the columns lie in rows.
    """
    columns, axial = stencil.centre.shape
    middle = 2 * width
    band = np.zeros((columns, axial, 3 * width + 1))
    band[:, :, middle] = stencil.centre[order]
    if axial > 1:
        band[:, 1:, middle - 1] = stencil.upper[order][:, :-1]
        band[:, :-1, middle + 1] = stencil.lower[order][:, 1:]
    return band, middle


def _solve_band(band: Array, right: Array, order: AnyArray, width: int) -> Array:
    """Solve with a band stored by columns, which lie in an order that the sides do not have."""
    columns, axial, rows = band.shape
    sides = right[:, order].reshape(right.shape[0], -1).T
    _, _, found, info = lapack.dgbsv(
        width,
        width,
        band.reshape(columns * axial, rows).T,
        sides,
        overwrite_ab=True,
        overwrite_b=False,
    )
    if info != 0:
        raise ModelError(
            "The equations of the film are singular: no part of it is open to a known pressure. "
            "Give it ends of finite length or a supply."
        )
    result = np.empty(right.shape)
    result[:, order] = found.T.reshape(right.shape)
    return result
