"""Sums over squares from sums over rows, against sums written out."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.pipeline.passes.rows import PAD, Place, Ring, across, add_rows, count, table_of

WIDTH = 21


@pytest.fixture
def rng():
    return np.random.default_rng(4)


@pytest.mark.parametrize("side", [5, 9, 17])
def test_sums_along_a_row_are_those_of_the_neighbours(rng, side):
    rows = np.zeros((6, WIDTH + 2 * PAD), np.float32)
    rows[0, PAD:-PAD] = rng.normal(size=WIDTH)
    table = table_of(across(Ring(0), side, [Ring(k) for k in range(1, 5)], Ring(5)))
    add_rows(rows, table, 0, len(table), 0)
    expected = np.convolve(rows[0].astype(float), np.ones(side), "same")[PAD:-PAD]
    npt.assert_allclose(rows[5, :WIDTH], expected, atol=2e-6)


def test_rows_of_a_ring_are_added_as_they_enter(rng):
    image = rng.normal(size=(23, WIDTH)).astype(np.float32)
    rows = np.zeros((9, WIDTH + 2 * PAD), np.float32)
    ring, pairs, total = Ring(0, 5), Ring(5, 3), Ring(8)
    table = table_of(
        [
            (pairs, Place(ring), Place(ring, ahead=4)),
            (total, Place(pairs), Place(pairs, ahead=1)),
        ]
    )
    for u, row in enumerate(image):
        rows[u % 5, :WIDTH] = row
        add_rows(rows, table, 0, 2, u)
        if u > 2:
            expected = image[u - 3 : u + 1].astype(float).sum(axis=0)
            npt.assert_allclose(rows[8, :WIDTH], expected, atol=2e-6)


def test_only_the_steps_that_are_asked_for_are_taken(rng):
    rows = rng.normal(size=(4, WIDTH + 2 * PAD)).astype(np.float32)
    before = rows.copy()
    steps = [(Ring(k), Place(Ring(0)), Place(Ring(0))) for k in (1, 2, 3)]
    add_rows(rows, table_of(steps), 1, 2, 0)
    npt.assert_array_equal(rows[2], 2 * before[0])
    npt.assert_array_equal(rows[[0, 1, 3]], before[[0, 1, 3]])


def test_counts_follow_the_rows_that_enter_and_leave(rng):
    state = (rng.random((40, WIDTH)) < 0.2).astype(np.uint8)
    state[20:] = state[19]
    rows = np.zeros((2, WIDTH + 2 * PAD), np.float32)
    rows[1, PAD:-PAD] = (state[:5] == 0).sum(axis=0)
    for new in range(5, 40):
        before = rows.copy()
        changed = count(state, new, new - 5, rows, 1)
        npt.assert_array_equal(rows[1, PAD:-PAD], (state[new - 4 : new + 1] == 0).sum(axis=0))
        assert changed == (state[new] != state[new - 5]).any()
        assert changed == (before != rows).any()
