"""Counts that programs have stored in other types."""

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.ingest.counts import STORED_TYPES, align_right, convert_counts, find_stamp

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


# first pixels of Cam0A.tiff of pco_image, in which its test has 2023-02-14 23:05:20.7549
PCO = [0, 0, 0, 1, 32, 35, 2, 20, 35, 5, 32, 117, 73, 70]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_the_time_of_a_pco_camera_is_found(dtype):
    assert find_stamp(np.array([[*PCO, 207], [206] * 15], dtype)) == "2023-02-14 23:05:20"


@pytest.mark.parametrize(
    ("place", "value"),
    # no digit, above two digits, no month, no day, no hour, no minute, no year of a camera
    [(3, 10), (13, 256 + 0x10), (6, 0x13), (7, 0x30), (8, 0x24), (9, 0x60), (4, 0x19), (4, 0x21)],
)
def test_other_pixels_hold_light(place, value):
    counts = np.array([PCO], np.uint16)
    counts[0, place] = value
    assert not find_stamp(counts)


def test_an_image_narrower_than_the_stamp_holds_light():
    assert not find_stamp(np.array([PCO[:13]], np.uint16))
    assert not find_stamp(np.zeros((3, 20), np.uint16))
