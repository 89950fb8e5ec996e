"""Maps rounded to their significant bits, and compressed as HDF5 reads them."""

import h5py
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as drawn

from erlif.files import compress, decompress, round_bits


@settings(deadline=None, database=None)
@given(
    drawn.arrays(np.float32, 30, elements=st.floats(width=32, allow_nan=True)), st.integers(4, 23)
)
def test_rounded_values_are_as_near_as_their_bits_allow(values, bits):
    rounded = round_bits(values, bits)
    finite = np.isfinite(values) & (np.abs(values) < 1e38) & (np.abs(values) > 1e-37)
    error = np.abs(rounded[finite].astype(float) - values[finite])
    assert (error <= np.abs(values[finite].astype(float)) * 2.0 ** -(bits + 1) * (1 + 1e-6)).all()
    np.testing.assert_array_equal(
        np.isnan(rounded), ~np.isfinite(values) if bits < 23 else np.isnan(values)
    )


@settings(deadline=None, database=None)
@given(drawn.arrays(st.sampled_from([np.float32, np.uint8]), (5, 7)))
def test_compressed_maps_come_back(values):
    np.testing.assert_array_equal(decompress(compress(values), values.dtype.name, (5, 7)), values)


def test_rounding_is_to_the_nearest_and_ties_go_to_the_even_value():
    """With two bits of mantissa the steps between 1 and 2 are a quarter."""
    values = np.array([1.0, 1.12, 1.125, 1.13, 1.375, 1.99], np.float32)
    assert round_bits(values, 2).tolist() == [1.0, 1.0, 1.0, 1.25, 1.5, 2.0]


def test_hdf5_reads_a_compressed_chunk_by_its_own_filters(tmp_path):
    values = np.random.default_rng(1).normal(5, 1, (6, 7)).astype(np.float32)
    with h5py.File(tmp_path / "map.h5", "w") as file:
        stored = file.create_dataset(
            "map", (6, 7), "f4", chunks=(6, 7), compression="gzip", shuffle=True
        )
        stored.id.write_direct_chunk((0, 0), compress(values))
    with h5py.File(tmp_path / "map.h5") as file:
        np.testing.assert_array_equal(file["map"][:], values)
