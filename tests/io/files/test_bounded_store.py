"""Sizes that compressed chunks of zarr stores state, against the encoders themselves."""

import numpy as np
import pytest
import zarr
from zarr.codecs import BloscCodec, GzipCodec, ZstdCodec

from erlif.io.files.bounded_store import BoundedStore


@pytest.mark.parametrize("length", [1, 200, 300, 20_000, 3_000_000])
@pytest.mark.parametrize("codec", [ZstdCodec(level=1), GzipCodec(), BloscCodec(typesize=1)])
def test_a_chunk_is_read_where_it_holds_as_much_as_stated_and_no_more(tmp_path, codec, length):
    values = np.random.default_rng(1).integers(0, 9, length, "u1")
    array = zarr.create_array(tmp_path / "a", data=values, chunks=(length,), compressors=codec)
    assert array.metadata.zarr_format == 3

    name = type(codec).__name__.removesuffix("Codec").lower()
    store = BoundedStore(tmp_path, held={"a": (name, length)})
    np.testing.assert_array_equal(zarr.open_array(store, path="a", mode="r")[:], values)
    if length > 100:
        store = BoundedStore(tmp_path, held={"a": (name, length - 20)})
        with pytest.raises(ValueError, match=f"a/c/0 holds more than the {length - 20} bytes"):
            zarr.open_array(store, path="a", mode="r")[:]


def test_a_chunk_of_zstd_that_states_no_size_is_refused(tmp_path):
    zarr.create_array(tmp_path / "a", data=np.ones(9), compressors=ZstdCodec(level=1))
    (tmp_path / "a/c/0").write_bytes(b"\x28\xb5\x2f\xfd\x00\x58" + bytes(9))  # RFC 8878: no size
    store = BoundedStore(tmp_path, held={"a": ("zstd", 72)})
    with pytest.raises(ValueError, match="a/c/0 holds more than"):
        zarr.open_array(store, path="a", mode="r")[:]
