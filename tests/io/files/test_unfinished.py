"""A film in the making: resumed, refused, removed, complete."""

import errno
import logging
import os
import re

import numpy.testing as npt
import pytest
from scenes.stores import FILM, GRID, GROUPS, VARIABLES, contents, maps_of, read_store

from erlif.core.errors import OutputError
from erlif.io.files import PartialFilm, remove_remains, write_film
from erlif.io.files.replacement import remove


@pytest.fixture(params=["film.nc", "film.zarr"])
def output(request, tmp_path):
    return tmp_path / request.param


def begin(output, key="key"):
    return PartialFilm(output, key, GRID, VARIABLES)


def put(work, *triggers):
    for trigger in triggers:
        work.put(trigger, work.maps.encode(maps_of(trigger)), {"frames_used": 2})


def test_an_unfinished_film_forgets_what_was_half_written(output):
    work = begin(output)
    put(work, 0)
    (work.directory / "half.unfinished").write_bytes(b"half")
    work.lock.release()  # as the end of its process does
    with begin(output) as again:
        assert again.has(0)
        assert not list(again.directory.glob("*.unfinished"))
    work.maps.close()


def test_work_of_the_same_key_is_resumed_and_of_another_key_removed(output, caplog):
    with begin(output) as work:
        put(work, 0)
    with caplog.at_level(logging.INFO, logger="erlif"), begin(output) as work:
        assert work.has(0)
        assert "1 triggers are finished" in caplog.text
    with begin(output, "another key") as work:
        assert not work.has(0)


def test_nothing_is_left_where_no_trigger_was_finished(output, tmp_path):
    folder = tmp_path / "films" / "may"
    folder.mkdir(parents=True)
    with pytest.raises(OutputError, match="refused"), begin(folder / output.name):
        raise OutputError("refused")
    assert list(folder.iterdir()) == []


def test_a_second_process_is_refused_while_the_first_works(output):
    with begin(output), pytest.raises(OutputError, match="another erlif process"):
        begin(output)


def test_a_link_in_place_of_the_lock_is_refused_and_its_target_kept(output):
    own = output.with_name("notes.txt")
    own.write_text("of the user")
    link = output.with_name(f".{output.name}.lock")
    link.symlink_to(own)
    with pytest.raises(OutputError, match=f"Move {re.escape(str(link))} away"):
        begin(output)
    assert own.read_text() == "of the user"
    assert link.is_symlink()


def test_a_folder_of_the_user_is_not_touched(output):
    own = output.with_name(output.name + ".partial")
    own.mkdir()
    (own / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="something else is there"):
        begin(output)
    assert (own / "notes.txt").read_text() == "mine"
    own.rename(output.with_name("elsewhere"))
    with begin(output):  # the lock was given back
        pass


def test_a_full_disk_keeps_the_triggers_put_before(output, monkeypatch):
    def fail(*arguments, **options):
        raise OSError(28, "No space left on device")

    with begin(output) as work:
        put(work, 0)
        monkeypatch.setattr("erlif.io.files.netcdf_maps.NetcdfMaps._reserve", fail)
        monkeypatch.setattr("erlif.io.files.zarr_maps.ZarrMaps._write", fail)
        with pytest.raises(OutputError, match=f"{output.name} could not be written: No space left"):
            put(work, 1)
        assert work.has(0)
        assert not work.has(1)


def test_a_film_that_cannot_be_completed_keeps_its_triggers(output, monkeypatch):
    def fail(*arguments, **options):
        raise OSError(28, "No space left on device")

    with begin(output) as work:
        put(work, 0, 1, 2, 3)
        with monkeypatch.context() as patch:
            patch.setattr(type(work.maps), "finish", fail)
            with pytest.raises(OutputError, match="No space left"):
                write_film(work, FILM, GROUPS)
    assert not output.exists()
    with begin(output) as work:
        assert all(map(work.has, range(4)))
        write_film(work, FILM, GROUPS)
    with read_store(output) as film:
        assert film.attrs["title"] == FILM.attrs["title"]


def test_a_complete_film_takes_its_name_and_leaves_nothing_beside_it(output, tmp_path):
    for _ in range(2):  # the second replaces the first
        with begin(output) as work:
            put(work, 0, 1, 2, 3)
            write_film(work, FILM, GROUPS)
    assert list(tmp_path.iterdir()) == [output]


# what a process leaves that is killed after the film has its name


@pytest.fixture
def complete(output, monkeypatch):
    """A film whose process was killed before it removed its directory and its lock."""
    with monkeypatch.context() as patch:
        patch.setattr(PartialFilm, "discard", lambda work: None)
        work = begin(output)
        put(work, 0, 1, 2, 3)
        write_film(work, FILM, GROUPS)
        work.lock.file.close()
    assert len(list(output.parent.iterdir())) == 3
    return output


def test_remains_beside_a_complete_film_are_removed(complete):
    before = contents(complete)
    remove_remains(complete)
    assert list(complete.parent.iterdir()) == [complete]
    assert contents(complete) == before


def test_a_killed_removal_is_completed(complete, monkeypatch):
    """The key is removed last, so what remains is known as ours."""
    removed = []

    def remove_one(path):
        if removed:
            raise KeyboardInterrupt
        removed.append(path)
        remove(path)

    directory = complete.with_name(complete.name + ".partial")
    (directory / "another").write_text("one more file")
    with monkeypatch.context() as patch:
        patch.setattr("erlif.io.files.unfinished.remove", remove_one)
        with pytest.raises(KeyboardInterrupt):
            remove_remains(complete)
    remove_remains(complete)
    assert list(complete.parent.iterdir()) == [complete]


@pytest.mark.parametrize("entries", [0, 1])
def test_a_directory_of_the_user_beside_a_complete_film_is_kept(complete, entries):
    """An empty one may be ours, begun by a process that was killed at once."""
    remove_remains(complete)
    own = complete.with_name(complete.name + ".partial")
    own.mkdir()
    for _ in range(entries):
        (own / "thesis.txt").write_text("years of work")
    remove_remains(complete)
    assert own.exists() == bool(entries)


def test_unfinished_work_beside_an_earlier_film_is_kept(complete):
    remove_remains(complete)
    with begin(complete) as work:
        put(work, 0)
    remove_remains(complete)
    with begin(complete) as work:
        assert work.has(0)


def test_remains_of_a_process_at_work_are_refused(complete):
    remove_remains(complete)
    with begin(complete), pytest.raises(OutputError, match="another erlif process"):
        remove_remains(complete)


def test_a_map_of_a_finished_trigger_is_read_and_replaced(output):
    name = "thickness_std"
    with begin(output) as work:
        put(work, 0, 1)
        before = [work.maps.read(trigger, name) for trigger in (0, 1)]
        work.maps.revise(1, work.maps.encode({name: 2 * before[1]}))
        npt.assert_array_equal(work.maps.read(0, name), before[0])
        npt.assert_allclose(work.maps.read(1, name), 2 * before[1], rtol=0.05)
        put(work, *range(2, GRID.sizes["trigger"]))
        write_film(work, FILM, GROUPS)
    with read_store(output) as film:
        npt.assert_allclose(film[name][1], 2 * before[1], rtol=0.05)


def test_a_drive_without_locks_is_noted_and_written(output, caplog, monkeypatch):
    def refuse(file, operation):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", refuse)
    with begin(output) as work:
        put(work, 0)
    assert f"{output.name} lies on a drive without locks (No locks available)" in caplog.text
