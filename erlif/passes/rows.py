"""Compiled steps on single rows of an image, from which the passes are built.

Sums over squares are taken down the columns first and then along the row. Down the columns the sums
of 1, 2, 4 and 8 rows are kept in rings of rows, each made of two of the ring before, so that no
rounding error accumulates. Every step is one loop without branches over rows that stay in cache.
Buffers are 2 x 8 columns wider than the image: beyond its border nothing is added.
"""

from __future__ import annotations

import numba
import numpy as np

PAD = 8
"""Columns of a buffer beyond each border of the image: half of the widest square. [px]"""

_ZERO, _ONE = np.float32(0), np.float32(1)


@numba.njit(nogil=True, cache=True, error_model="numpy")
def take(image, i, offset, state, s, ring, k):  # type: ignore[no-untyped-def]
    """Row i of an image less an offset into row k of a ring, 0 where row s of state is not 0."""
    for j in range(image.shape[1]):
        ring[k, j + PAD] = image[i, j] - offset if state[s, j] == 0 else _ZERO


@numba.njit(nogil=True, cache=True, error_model="numpy")
def add(ring, a, b, out, k):  # type: ignore[no-untyped-def]
    """Sum of rows a and b of a ring into row k of another."""
    for j in range(ring.shape[1]):
        out[k, j] = ring[a, j] + ring[b, j]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def pile(ring, a, b, single, c, out):  # type: ignore[no-untyped-def]
    """Sum of rows a and b of a ring and row c of the ring of single rows."""
    for j in range(out.size):
        out[j] = (ring[a, j] + ring[b, j]) + single[c, j]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def across_5(row, out):  # type: ignore[no-untyped-def]
    """Sums of 5 neighbours along a padded row."""
    for j in range(out.size):
        out[j] = ((row[j + 6] + row[j + 7]) + (row[j + 8] + row[j + 9])) + row[j + 10]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def across_9(row, out):  # type: ignore[no-untyped-def]
    """Sums of 9 neighbours along a padded row."""
    for j in range(out.size):
        out[j] = (
            ((row[j + 4] + row[j + 5]) + (row[j + 6] + row[j + 7]))
            + ((row[j + 8] + row[j + 9]) + (row[j + 10] + row[j + 11]))
        ) + row[j + 12]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def across_17(row, out):  # type: ignore[no-untyped-def]
    """Sums of 17 neighbours along a padded row."""
    for j in range(out.size):
        out[j] = (
            (
                ((row[j] + row[j + 1]) + (row[j + 2] + row[j + 3]))
                + ((row[j + 4] + row[j + 5]) + (row[j + 6] + row[j + 7]))
            )
            + (
                ((row[j + 8] + row[j + 9]) + (row[j + 10] + row[j + 11]))
                + ((row[j + 12] + row[j + 13]) + (row[j + 14] + row[j + 15]))
            )
        ) + row[j + 16]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def count(state, new, old, down):  # type: ignore[no-untyped-def]
    """Count down the columns the pixels whose state is 0, as row new enters and row old leaves.

    Returns whether any count has changed. Most rows have their flags where the rows before had
    them, and the sums along the row then remain as they are.
    """
    changed = np.uint8(0)
    for j in range(state.shape[1]):
        enters = np.uint8(1) if state[new, j] == 0 else np.uint8(0)
        leaves = np.uint8(1) if state[old, j] == 0 else np.uint8(0)
        changed |= enters ^ leaves
    if changed == 0:
        return False

    for j in range(state.shape[1]):
        more = _ONE if state[new, j] == 0 else _ZERO
        less = _ONE if state[old, j] == 0 else _ZERO
        down[j + PAD] += more - less
    return True
