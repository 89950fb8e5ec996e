"""Sums over squares around each pixel of a row, by compiled steps on rows of an image.

Sums over squares are taken down the columns first and then along the row. Down the columns the sums
of 1, 2, 4 and 8 rows are kept in rings of rows, each made of two of the ring before, so that no
rounding error accumulates. All rows are rows of one array, and every sum is one of two of them, so
that one loop without branches makes them all: a compiler needs much longer for ten loops. Rows are
2 x 8 columns wider than the image: beyond its border nothing is added.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from erlif.core.arrays import AnyArray

PAD = 8
"""Columns of a row beyond each border of the image: half of the widest square. [px]"""

STATES = 18
"""Rows of flags that are kept: those of the widest square, and the one that has left it."""

_ZERO, _ONE = np.float32(0), np.float32(1)
_at = np.uint64  # an index that cannot count from the end, as in `erlif.registration.interpolation`


class Ring(NamedTuple):
    """Rows of the array that are filled in turn; one row alone is a ring of one.

    Attributes
    ----------
    first : int
        Number of its first row.
    size : int
        Number of rows.
    """

    first: int
    size: int = 1


class Place(NamedTuple):
    """A row of a ring from one of its columns on.

    Attributes
    ----------
    ring : Ring
    ahead : int
        Rows ahead of the one that is filled now; the last one is the row before.
    column : int
        The first column.
    """

    ring: Ring
    ahead: int = 0
    column: int = 0


Step = tuple[Ring, Place, Place]
"""A ring, and the two places whose sum enters it."""


class Part(NamedTuple):
    """Steps that are taken together.

    Attributes
    ----------
    steps : list of Step
    counts : int
        The row that counts sound pixels down the columns of a square: the steps are taken where it
        changes. Default: they are taken always.
    side : int
        Side of this square. [px]
    ahead : int
        Its newest row of flags, ahead of the one that is filled now.
    """

    steps: list[Step]
    counts: int = -1
    side: int = 0
    ahead: int = 0


def across(row: Ring, side: int, parts: list[Ring], out: Ring) -> list[Step]:
    """Steps that add up neighbours along a row, by sums of 2, 4, 8 and 16 of them.

    Parameters
    ----------
    row : Ring
        The row, with `PAD` columns on both sides.
    side : int
        5, 9 or 17 neighbours. [px]
    parts : list of Ring
        Receive the sums of 2, 4, 8 and 16.
    out : Ring
        Receives the result from its first column on.

    Returns
    -------
    list of Step
    """
    steps: list[Step] = []
    half, source = 1, row
    while 2 * half < side:
        part = parts[len(steps)]
        steps.append((part, Place(source), Place(source, column=half)))
        half, source = 2 * half, part
    left = PAD - side // 2
    last = Place(row, column=left + side - 1)
    return [*steps, (out, Place(source, column=left), last)]


def table_of(steps: list[Step]) -> AnyArray:
    """Steps as the numbers that `add_rows` reads.

    Parameters
    ----------
    steps : list of Step

    Returns
    -------
    array, (step, 10)

    Examples
    --------
    >>> ring, total = Ring(0, 3), Ring(3)
    >>> table_of([(total, Place(ring), Place(ring, ahead=2))]).tolist()
    [[3, 1, 0, 3, 0, 0, 0, 3, 2, 0]]
    """
    return np.array([(*out, *one.ring, *one[1:], *two.ring, *two[1:]) for out, one, two in steps])


def number_parts(parts: list[Part]) -> AnyArray:
    """Parts as the numbers that `add_squares` reads, for the table of all their steps.

    Parameters
    ----------
    parts : list of Part

    Returns
    -------
    array, (part, 5)
        First step, the one after the last, row of counts, rows of flags that enter and leave.

    Examples
    --------
    >>> step = Ring(2), Place(Ring(0)), Place(Ring(1))
    >>> number_parts([Part([step, step]), Part([step], counts=3, side=9)]).tolist()
    [[0, 2, -1, 0, 0], [2, 3, 3, 0, 9]]
    """
    ends = np.cumsum([0, *(len(part.steps) for part in parts)]).tolist()
    return np.array(
        [
            (ends[n], ends[n + 1], part.counts, part.ahead, (part.ahead - part.side) % STATES)
            for n, part in enumerate(parts)
        ]
    )


@numba.njit(nogil=True, cache=True, error_model="numpy")
def add_rows(rows, table, start, stop, u):  # type: ignore[no-untyped-def]
    """Take some steps of a table after row u of the image has entered."""
    for q in range(start, stop):
        out = _at(table[q, 0] + u % table[q, 1])
        one = _at(table[q, 2] + (u + table[q, 4]) % table[q, 3])
        two = _at(table[q, 6] + (u + table[q, 8]) % table[q, 7])
        left, right = table[q, 5], table[q, 9]
        for t in range(rows.shape[1] - max(left, right)):
            rows[out, _at(t)] = rows[one, _at(t + left)] + rows[two, _at(t + right)]


@numba.njit(nogil=True, cache=True, error_model="numpy")
def count(state, new, old, rows, k):  # type: ignore[no-untyped-def]
    """Count down the columns the pixels whose state is 0, as row new enters and row old leaves.

    Row k of rows has the counts. Returns whether any has changed. Most rows have their flags where
    the rows before had them, and the sums along the row then remain as they are.
    """
    entering, leaving, counts = _at(new), _at(old), _at(k)
    changed = np.uint8(0)
    for t in range(state.shape[1]):
        x = _at(t)
        enters = np.uint8(1) if state[entering, x] == 0 else np.uint8(0)
        leaves = np.uint8(1) if state[leaving, x] == 0 else np.uint8(0)
        changed |= enters ^ leaves
    if changed == 0:
        return False

    for t in range(state.shape[1]):
        x = _at(t)
        more = _ONE if state[entering, x] == 0 else _ZERO
        less = _ONE if state[leaving, x] == 0 else _ZERO
        rows[counts, _at(t + PAD)] += more - less
    return True


@numba.njit(nogil=True, cache=True, error_model="numpy")
def add_squares(state, rows, table, parts, u, complete):  # type: ignore[no-untyped-def]
    """Take the steps of all parts of a table after row u of the image has entered.

    The last part, the sums over squares, begins once a square is complete.
    """
    for n in range(parts.shape[0] if complete else parts.shape[0] - 1):
        start, stop, counts = parts[n, 0], parts[n, 1], parts[n, 2]
        changed = True
        if counts >= 0:
            new, old = (u + parts[n, 3]) % STATES, (u + parts[n, 4]) % STATES
            changed = count(state, new, old, rows, counts)
        if changed:
            add_rows(rows, table, start, stop, u)
