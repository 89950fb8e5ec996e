"""The journal of an unfinished netCDF file: what a killed process leaves is used or dropped."""

import errno
import os
import shutil

import h5py
import numpy as np
import pytest
from scenes.stores import contents, finish, maps_of, open_store, put, whole_film

from erlif.io.files import netcdf_maps


@pytest.fixture
def whole(tmp_path):
    """A film made without an interruption."""
    return whole_film("netcdf", tmp_path / "whole")


@pytest.fixture
def left(tmp_path):
    """Directory as a process left it that was killed after three triggers."""
    store = open_store("netcdf", tmp_path / "work")
    put(store, 0, 1, 2)
    shutil.copytree(tmp_path / "work", tmp_path / "left")  # before anything is closed
    store.close()
    return tmp_path / "left"


def resume(directory, expected):
    """Resume, check which triggers are there, and complete the film."""
    store = open_store("netcdf", directory)
    assert [store.has(trigger) for trigger in range(4)] == expected
    put(store, *(trigger for trigger in range(4) if not expected[trigger]))
    return contents(finish(store))


def test_chunks_of_a_killed_process_are_copied_to_the_same_film(left, whole):
    assert resume(left, [True, True, True, False]) == whole
    assert sorted(path.name for path in left.iterdir()) == ["journal", "maps_1.nc"]


@pytest.mark.parametrize("size", [0, 5, 11, 300, -1, -200])
def test_a_journal_that_is_cut_off_keeps_the_triggers_before(left, whole, size):
    lines = (left / "journal").read_bytes()
    (left / "journal").write_bytes(lines[:size])
    kept = max(lines[:size].count(b"\n") - 1, 0)
    assert resume(left, [trigger < kept for trigger in range(4)]) == whole


def test_a_damaged_chunk_and_what_follows_is_computed_again(left, whole):
    """As after a loss of power, when the journal reached the disk and a chunk did not."""
    journal, records = netcdf_maps._read_journal(left / "journal")
    offset, size, _ = records[1].chunks["thickness"]
    with (left / journal).open("r+b") as file:
        file.seek(offset)
        file.write(bytes(size))
    assert resume(left, [True, False, False, False]) == whole


@pytest.mark.parametrize("name", ["journal", "maps_0.nc"])
@pytest.mark.parametrize("put_there", [None, os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_without_the_journal_or_the_file_the_work_begins_again(left, whole, name, put_there):
    """A pipe or an endless device in its place is not read."""
    (left / name).unlink()
    if put_there is not None:
        put_there(left / name)
    assert resume(left, [False] * 4) == whole


def test_a_process_killed_while_it_copied_leaves_the_earlier_file_in_force(
    left, whole, monkeypatch
):
    def die(*arguments):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(netcdf_maps.NetcdfMaps, "put", die)
        with pytest.raises(KeyboardInterrupt):
            open_store("netcdf", left)
    assert (left / "journal.unfinished").is_file()
    assert resume(left, [True, True, True, False]) == whole


def test_room_is_taken_before_a_chunk_is_written(tmp_path, monkeypatch):
    def no_room(*arguments):
        raise OSError(errno.EDQUOT, os.strerror(errno.EDQUOT))

    store = open_store("netcdf", tmp_path)
    put(store, 0)
    monkeypatch.setattr(os, "posix_fallocate", no_room)
    large = {**store.encode(maps_of(1)), "flags": bytes(2**21)}
    with pytest.raises(OSError, match=os.strerror(errno.EDQUOT)):
        store.put(1, large, {})
    assert not store.has(1)
    store.close()


def test_reserved_room_is_cut_off_at_the_end(whole, tmp_path):
    """Both names of the file have the size that its maps need, without a spare megabyte."""
    with h5py.File(tmp_path / "whole" / "maps_0.nc") as file:
        stored = sum(file[name].id.get_storage_size() for name in maps_of(0))
    assert stored < len(whole) < stored + 2**16
    assert np.frombuffer(whole[:8], np.uint8).tobytes() == b"\x89HDF\r\n\x1a\n"
