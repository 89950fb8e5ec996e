"""A zarr store that several processes write."""

import pickle

import pytest
from scenes.stores import contents, finish, maps_of, open_store, put, whole_film

from erlif.core.errors import OutputError


@pytest.fixture
def whole(tmp_path):
    """A film made by one process, in order."""
    return whole_film("zarr", tmp_path / "whole")


def test_triggers_put_in_any_order_by_copies_give_the_same_bytes(tmp_path, whole):
    """A copy as another process gets it."""
    store = open_store("zarr", tmp_path / "other")
    for triggers in ((3, 1), (0, 2)):
        put(pickle.loads(pickle.dumps(store)), *triggers)
    assert contents(finish(store)) == whole


def test_nothing_but_the_film_is_in_the_store(tmp_path):
    store = open_store("zarr", tmp_path)
    put(store, 0, 1, 2, 3)
    names = set(contents(finish(store)))
    assert {f"{name}/c.{k}.0.0" for name in maps_of(0) for k in range(4)} < names
    assert all(name.endswith("zarr.json") or "/c" in name for name in names)


def test_a_failed_write_is_reported_with_the_output_and_leaves_no_scratch(tmp_path):
    store = open_store("zarr", tmp_path / "film.zarr.partial")
    (store.path / "flags").rename(tmp_path / "elsewhere")
    with pytest.raises(OutputError, match=r"film\.zarr could not be written: No such file"):
        put(store, 0)
    assert not list(store.directory.glob("*.unfinished"))
    assert not store.has(0)


def flip_a_byte(path, place=-1):
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)


def exchange(one, other):
    first, second = one.read_bytes(), other.read_bytes()
    one.write_bytes(second)
    other.write_bytes(first)


def replace_by_a_directory(path):
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize(
    "damage",
    [
        lambda chunk, record: flip_a_byte(chunk(1)),
        lambda chunk, record: exchange(chunk(1), chunk(2)),
        lambda chunk, record: exchange(record(1), record(2)),
        lambda chunk, record: record(1).write_bytes(record(2).read_bytes()),
        lambda chunk, record: flip_a_byte(record(1), 20),
        lambda chunk, record: record(1).write_bytes(b"PK\x03\x04"),
        lambda chunk, record: replace_by_a_directory(chunk(1)),
        lambda chunk, record: flip_a_byte(chunk(1).with_name("zarr.json"), 30),
        lambda chunk, record: chunk(1).with_name("zarr.json").unlink(),
    ],
)
def test_damaged_triggers_are_put_again_to_the_same_bytes(tmp_path, whole, damage):
    store = open_store("zarr", tmp_path / "left")
    put(store, 0, 1, 2)
    damage(
        lambda trigger: store.path / "thickness" / f"c.{trigger}.0.0",
        lambda trigger: store.directory / f"trigger_{trigger:05d}.json",
    )
    again = open_store("zarr", tmp_path / "left")
    assert again.has(0)
    put(again, *(trigger for trigger in range(4) if not again.has(trigger)))
    assert contents(finish(again)) == whole
