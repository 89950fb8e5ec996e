"""Maps rounded to their significant bits, and compressed as HDF5 and zarr read them."""

import zlib

import h5py
import numpy as np
import numpy.testing as npt
import pytest
import zarr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as drawn

from erlif.io.files import MapVariable, round_map
from erlif.io.files import compression as module
from erlif.io.files.compression import deflate, encode_netcdf, encode_zarr

anything = drawn.arrays(np.float32, 30, elements=st.floats(width=32))
VARIABLES = [
    MapVariable("thickness", "float32", {}, std="thickness_std"),
    MapVariable("thickness_std", "float32", {}, bits=5),
    MapVariable("flags", "uint16", {}),
]


@pytest.fixture(scope="module")
def maps():
    """A film of 2 to 9 um with noise that grows with it, a corner of it not valid."""
    rng = np.random.default_rng(7)
    std = np.geomspace(0.01, 0.8, 60 * 70).astype(np.float32).reshape(60, 70)
    thickness = (np.linspace(2, 9, 70) + std * rng.normal(size=(60, 70))).astype(np.float32)
    flags = np.zeros((60, 70), np.uint16)
    flags[:9, :20] = 32
    for image in (thickness, std):
        image[flags != 0] = np.nan
    return {"thickness": thickness, "thickness_std": std, "flags": flags}


def unpack(chunk, dtype, shape):
    """Inflate and reverse the shuffle filter, by their definitions."""
    planes = np.frombuffer(zlib.decompress(chunk), np.uint8).reshape(np.dtype(dtype).itemsize, -1)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape)


@given(anything, anything)
def test_rounding_error_is_at_most_a_tenth_of_the_standard_deviation(values, std):
    std = np.abs(std)
    rounded = round_map(values, std, 0.2)
    known = np.isfinite(values)
    npt.assert_array_equal(np.isnan(rounded), ~known)
    with np.errstate(over="ignore"):
        error = np.abs(rounded[known].astype(float) - values[known])
    limit = 0.1 * np.where(np.isfinite(std), std, 0.0)[known].astype(float)
    assert (error <= limit).all()


@given(anything, st.integers(1, 22))
def test_rounded_values_are_as_near_as_their_bits_allow(values, bits):
    rounded = round_map(values, values, 2.0**-bits)
    known = np.isfinite(values)
    error = np.abs(rounded[known].astype(float) - values[known])
    assert (error <= np.abs(values[known].astype(float)) * 2.0 ** -(bits + 1)).all()
    npt.assert_array_equal(np.isnan(rounded), ~known)


def test_rounding_is_to_the_nearest_and_ties_go_to_the_even_value():
    """With two bits of mantissa the steps between 1 and 2 are a quarter."""
    values = np.array([1.0, 1.12, 1.125, 1.13, 1.375, 1.99], np.float32)
    assert round_map(values, values, 0.25).tolist() == [1.0, 1.0, 1.0, 1.25, 1.5, 2.0]


def test_rounding_shifts_no_mean():
    """Mean error of a million pixels, against that of errors spread evenly over a step."""
    rng = np.random.default_rng(3)
    values = (5 + 0.4 * rng.normal(size=10**6)).astype(np.float32)
    error = round_map(values, np.full_like(values, 0.4), 0.2) - values.astype(float)
    npt.assert_allclose(error.std(), (1 / 16) / np.sqrt(12), rtol=0.01)
    assert abs(error.mean()) < 4 * error.std() / 1000


def test_hdf5_reads_a_chunk_by_its_own_filters(tmp_path, maps):
    chunks = encode_netcdf(maps, VARIABLES)
    with h5py.File(tmp_path / "map.h5", "w") as file:
        for variable in VARIABLES:
            stored = file.create_dataset(
                variable.name,
                (60, 70),
                variable.dtype,
                chunks=(60, 70),
                compression="gzip",
                shuffle=True,
            )
            stored.id.write_direct_chunk((0, 0), chunks[variable.name])
    with h5py.File(tmp_path / "map.h5") as file:
        npt.assert_array_equal(
            file["thickness"][:], round_map(maps["thickness"], maps["thickness_std"], 0.2)
        )
        npt.assert_array_equal(
            file["thickness_std"][:],
            round_map(maps["thickness_std"], maps["thickness_std"], 2.0**-5),
        )
        npt.assert_array_equal(file["flags"][:], maps["flags"])


def test_both_formats_hold_the_same_values(maps):
    netcdf, zarr_chunks = encode_netcdf(maps, VARIABLES), encode_zarr(maps, VARIABLES)
    for variable in VARIABLES:
        codec = zarr.codecs.BloscCodec(cname="lz4", clevel=5, shuffle="bitshuffle")
        array = zarr.create_array(
            store={}, shape=(60, 70), chunks=(60, 70), dtype=variable.dtype, compressors=codec
        )
        array.store._store_dict["c/0/0"] = zarr.core.buffer.cpu.Buffer.from_bytes(
            zarr_chunks[variable.name]
        )
        npt.assert_array_equal(
            array[:], unpack(netcdf[variable.name], variable.dtype, (60, 70)), variable.name
        )


@given(drawn.arrays(np.uint8, st.integers(1, 2000)))
def test_deflated_bytes_come_back_with_and_without_isal(values):
    with pytest.MonkeyPatch.context() as patch:
        assert zlib.decompress(deflate(values)) == values.tobytes()
        patch.setattr(module, "isal_zlib", None)
        assert zlib.decompress(deflate(values)) == values.tobytes()
