"""Packed counts, against a decoder that goes bit by bit."""

import numpy as np
import numpy.testing as npt
import pytest
from scenes.camera_files import counts_of_bits, pack_counts

from erlif.io.readers.unpack import Packing, unpack


@pytest.mark.parametrize("packing", Packing)
def test_random_bytes_give_the_counts_of_a_bitwise_decoder(packing):
    packed = np.random.default_rng(1).integers(0, 256, 15_000, dtype=np.uint8)
    expected = counts_of_bits(packed, packing.name)
    npt.assert_array_equal(unpack(packed, expected.size, packing), expected)


@pytest.mark.parametrize("packing", Packing)
@pytest.mark.parametrize("pixels", [1, 2, 3, 4, 5, 6, 7, 8, 9, 63])
def test_incomplete_groups_at_the_end_are_decoded(packing, pixels):
    depth = int(packing.name[-2:])
    counts = np.random.default_rng(pixels).integers(0, 1 << depth, pixels).astype(np.uint16)
    packed = np.frombuffer(pack_counts(counts, packing.name), np.uint8)
    assert packing.size(pixels) <= packed.size
    npt.assert_array_equal(unpack(packed[: packing.size(pixels)], pixels, packing), counts)


@pytest.mark.parametrize(
    ("packing", "packed", "counts"),
    [
        # Basler racer GigE manual AW00118302000, 9.2.3
        (Packing.SPLIT_12, [0xAB, 0x3C, 0x12], [0xABC, 0x123]),
        # GenICam PFNC 2.4, Mono12p and Mono10p; all bits of the first pixel, none of the second
        (Packing.LOW_12, [0xBC, 0x3A, 0x12], [0xABC, 0x123]),
        (Packing.LOW_10, [0xFF, 0x03, 0xF0, 0x3F, 0], [1023, 0, 1023, 0]),
    ],
)
def test_tables_of_the_manuals(packing, packed, counts):
    assert unpack(np.array(packed, np.uint8), len(counts), packing).tolist() == counts
