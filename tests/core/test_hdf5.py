"""HDF5 files with the damages that the library of HDF5 does not survive.

The bytes are edited by the specification of the format; the damaged places were found at random.
"""

import struct

import h5py
import numpy as np
import pytest

from erlif.core.hdf5 import check_variable_lengths, chunk_count, find_chunks, open_hdf5

HEAD = 16
"""Length of the head of a heap, and of each object in it, for lengths of eight bytes."""


def write(path, **options):
    """A file with text of variable length, and a chunked dataset that holds the mark of a heap."""
    with h5py.File(path, "w", **options) as file:
        file.attrs["unit"] = "degree"
        file["vector"] = np.arange(5.0)
        mark = np.frombuffer(b"GCOL\x01" + bytes(27), "u1")
        file.create_dataset("counts", data=mark.reshape(4, 8), chunks=(4, 8))
    return path


def heap_of(content):
    """Place of the collection that h5py wrote: the only one of 4096 bytes."""
    place = content.find(b"GCOL")
    while struct.unpack_from("<Q", content, place + 8)[0] != 4096:
        place = content.find(b"GCOL", place + 1)
    return place


def damage(path, change):
    content = bytearray(path.read_bytes())
    change(content)
    path.write_bytes(content)


@pytest.mark.parametrize("options", [{}, {"libver": "latest"}, {"userblock_size": 512}])
def test_a_whole_file_is_opened(tmp_path, options):
    path = write(tmp_path / "a.h5", **options)
    with open_hdf5(path) as file:
        check_variable_lengths(file)
        assert file.attrs["unit"] == "degree"


@pytest.mark.parametrize("options", [{}, {"libver": "latest"}, {"userblock_size": 1024}])
@pytest.mark.parametrize("size", [0, 2**64 - HEAD])
def test_a_heap_in_which_the_library_searches_without_end_is_refused(tmp_path, options, size):
    path = write(tmp_path / "a.h5", **options)

    def change(content):
        first = heap_of(content) + HEAD
        index = 0 if size == 0 else 1
        struct.pack_into("<HHIQ", content, first, index, 0, 0, size)

    damage(path, change)
    with open_hdf5(path) as file, pytest.raises(ValueError, match="free space of no size"):
        check_variable_lengths(file)


TEXT, SEQUENCE = b"\x19\x01", b"\x19\x00"
"""Class and kind of types of variable length in version 1 (section IV.A.2.d)."""


@pytest.mark.parametrize(
    ("dtype", "written"),
    [
        (h5py.string_dtype(), TEXT),
        (h5py.vlen_dtype("i4"), SEQUENCE),
        (np.dtype([("number", "i4"), ("list", h5py.vlen_dtype("i4"))]), SEQUENCE),
        (np.dtype((h5py.vlen_dtype("i4"), (2,))), SEQUENCE),
    ],
    ids=["text", "sequence", "compound", "array"],
)
@pytest.mark.parametrize("place", ["dataset", "attribute"])
def test_an_unknown_variable_length_is_refused(tmp_path, dtype, written, place):
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        if place == "dataset":
            file.create_dataset("a", (1,), dtype)
        else:
            space = h5py.h5s.create_simple((1,))
            h5py.h5a.create(file.id, b"a", h5py.h5t.py_create(dtype, logical=True), space)
    with open_hdf5(path) as file:
        check_variable_lengths(file)

    def change(content):
        content[content.index(written + b"\0\0\x10" if written == SEQUENCE else written) + 1] |= 8

    damage(path, change)
    with open_hdf5(path) as file, pytest.raises(ValueError, match="unknown variable length"):
        check_variable_lengths(file)


def test_the_rest_of_a_heap_that_was_given_back_is_not_refused(tmp_path):
    path = write(tmp_path / "a.h5")
    stale = b"GCOL\x01\0\0\0" + struct.pack("<Q", 4096) + b"\x07" * 200
    with h5py.File(path, "r+") as file:
        file["stale"] = np.frombuffer(stale, "u1")
    with open_hdf5(path) as file:
        check_variable_lengths(file)


def test_a_block_of_a_driver_that_claims_a_gigabyte_is_refused(tmp_path):
    path = write(tmp_path / "a.h5")

    def change(content):
        struct.pack_into("<Q", content, 48, len(content))  # section II.A, version 0
        content += b"\0\0\0\0" + struct.pack("<I", 2**30) + bytes(8)

    damage(path, change)
    with pytest.raises(ValueError, match="block of a driver"):
        open_hdf5(path)


@pytest.mark.parametrize("length", [0, 8, 20, 90])
def test_a_file_that_ends_early_is_refused(tmp_path, length):
    path = tmp_path / "a.h5"
    path.write_bytes(write(path).read_bytes()[:length])
    with pytest.raises(OSError, match="Unable to synchronously open file"):
        open_hdf5(path)


@pytest.mark.parametrize("options", [{}, {"libver": "latest"}, {"userblock_size": 512}])
def test_chunks_that_were_never_written_are_found(tmp_path, options):
    with h5py.File(tmp_path / "a.h5", "w", **options) as file:
        data = file.create_dataset("a", (5, 7), "f4", chunks=(2, 3), compression="gzip")
        data[:3, :2] = 1.0
        whole = file.create_dataset("b", data=np.ones((5, 7)))
        never = file.create_dataset("c", (5, 7), "f4")
        assert chunk_count(data) == 9
        assert find_chunks(data).tolist() == [[True, False, False]] * 2 + [[False] * 3]
        assert find_chunks(whole).all()
        assert not find_chunks(never).any()
