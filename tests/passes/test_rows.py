"""Sums over squares from sums over rows, against sums written out."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.passes.rows import PAD, across_5, across_9, across_17, add, count, pile, take

WIDTH = 21


@pytest.fixture
def rng():
    return np.random.default_rng(4)


@pytest.mark.parametrize(("across", "size"), [(across_5, 5), (across_9, 9), (across_17, 17)])
def test_sums_along_a_row_are_those_of_the_neighbours(rng, across, size):
    row = np.zeros(WIDTH + 2 * PAD, np.float32)
    row[PAD:-PAD] = rng.normal(size=WIDTH)
    found = np.empty(WIDTH, np.float32)
    across(row, found)
    expected = np.convolve(row.astype(float), np.ones(size), "same")[PAD:-PAD]
    npt.assert_allclose(found, expected, atol=2e-6)


def test_a_row_is_taken_without_its_flagged_pixels(rng):
    image = rng.normal(size=(3, WIDTH)).astype(np.float32)
    image[1, 4] = np.nan
    state = np.zeros((2, WIDTH), np.uint8)
    state[1, 4] = 8
    ring = np.zeros((5, WIDTH + 2 * PAD), np.float32)
    take(image, 1, np.float32(0.5), state, 1, ring, 3)
    expected = np.where(state[1] == 0, image[1] - np.float32(0.5), 0)
    npt.assert_array_equal(ring[3, PAD:-PAD], expected)
    assert np.count_nonzero(ring) == WIDTH - 1


def test_rows_are_added_and_piled(rng):
    ring = rng.normal(size=(4, WIDTH)).astype(np.float32)
    pairs = np.zeros((2, WIDTH), np.float32)
    add(ring, 0, 1, pairs, 0)
    add(ring, 2, 3, pairs, 1)
    npt.assert_array_equal(pairs, ring[::2] + ring[1::2])
    total = np.empty(WIDTH, np.float32)
    pile(pairs, 0, 1, ring, 2, total)
    npt.assert_allclose(total, ring.sum(axis=0) + ring[2], atol=1e-6)


def test_counts_follow_the_rows_that_enter_and_leave(rng):
    state = (rng.random((40, WIDTH)) < 0.2).astype(np.uint8)
    state[20:] = state[19]
    down = np.zeros(WIDTH + 2 * PAD, np.float32)
    down[PAD:-PAD] = (state[:5] == 0).sum(axis=0)
    for new in range(5, 40):
        before = down.copy()
        changed = count(state, new, new - 5, down)
        npt.assert_array_equal(down[PAD:-PAD], (state[new - 4 : new + 1] == 0).sum(axis=0))
        assert changed == (state[new] != state[new - 5]).any()
        assert changed == (before != down).any()
