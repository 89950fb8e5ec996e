"""Counts that programs have stored in other types."""

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.ingest.counts import STORED_TYPES, align_right, convert_counts

COUNTS = np.array([[0, 1, 127], [2, 3, 100]])


@pytest.mark.parametrize("name", sorted(STORED_TYPES))
@pytest.mark.parametrize("order", "<>")
def test_whole_numbers_are_counts_in_any_type(name, order):
    found = convert_counts(COUNTS.astype(np.dtype(name).newbyteorder(order)))
    assert found.dtype == (np.uint8 if name == "uint8" else np.uint16)
    assert found.dtype.isnative
    np.testing.assert_array_equal(found, COUNTS)


@pytest.mark.parametrize(
    ("value", "dtype"),
    [
        *((-1, np.int16), (65536, np.int32), (2**63, np.uint64), (0.5, np.float32)),
        *((np.nan, np.float32), (np.inf, np.float64), (-1e-9, np.float64), (65536.0, np.float64)),
    ],
)
def test_the_first_value_that_is_no_count_is_named(value, dtype):
    image = np.ones((4, 5), dtype)
    image[2, 3] = image[3, 0] = value
    expected = rf"{np.dtype(dtype).name} values are no counts: \S+ in row 2, column 3\. Save"
    with pytest.raises(FrameError, match=expected) as refused:
        convert_counts(image)
    assert f"{value:g} in" in str(refused.value)


@pytest.mark.parametrize("bits", [10, 12, 14, 16])
def test_left_aligned_counts_are_divided(bits):
    counts = np.arange(1 << bits, dtype=np.uint16).reshape(4, -1)
    stored = (counts.astype(np.uint32) * 2 ** (16 - bits)).astype(np.uint16)
    np.testing.assert_array_equal(align_right(stored, 16 - bits), counts)


def test_low_bits_in_use_are_refused():
    counts = np.array([[16, 32], [48, 65535]], np.uint16)
    with pytest.raises(FrameError, match=r"65535 in row 1, column 1 is no multiple of 16\."):
        align_right(counts, 4)
    with pytest.raises(FrameError, match="7 in row 0, column 0"):
        align_right(np.full((2, 2), 7, np.uint8), 8)
