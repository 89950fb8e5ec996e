"""Rows that are fetched into the cache."""

import numpy as np
from numba import njit

from erlif.registration.ahead import fetch_row


@njit
def _add(image: np.ndarray, row: int) -> float:
    fetch_row(image, row)
    return image.sum()


def test_processor_is_asked_for_each_line_of_a_row():
    assert _add(np.ones((3, 40), np.float32), 2) == 120
    (code,) = _add.inspect_llvm().values()
    assert "llvm.prefetch" in code


def test_rows_beyond_the_array_are_passed_over():
    image = np.ones((3, 40), np.float32)
    assert [_add(image, row) for row in (-1, 0, 3, 10**6)] == [120] * 4
    assert _add(np.zeros((0, 0), np.float32), 0) == 0
