"""Finished triggers that survive the end of their process."""

import logging

import numpy as np
import pytest

from erlif.core.errors import OutputError
from erlif.files import MapVariable, PartialFilm, decompress

THICKNESS = [MapVariable("thickness", "float32", {"units": "um"}, bits=11)]
MAP = {"thickness": np.linspace(1, 9, 12, dtype=np.float32).reshape(3, 4)}


def put(work, trigger, **numbers):
    work.put(trigger, MAP, THICKNESS, numbers)


def test_an_unfinished_film_forgets_what_was_half_written(tmp_path):
    work = PartialFilm(tmp_path / "film.nc", "key")
    (work.directory / "trigger_00001.npz").write_bytes(b"")  # as after a loss of power
    (work.directory / "trigger_00002.unfinished").write_bytes(b"half")
    work.lock.release()  # as the end of its process does
    again = PartialFilm(tmp_path / "film.nc", "key")
    assert not again.has(1)
    assert not again.has(2)
    assert not list(again.directory.glob("*.unfinished"))
    again.lock.release()


def test_maps_and_numbers_come_back_by_their_names(tmp_path):
    with PartialFilm(tmp_path / "film.nc", "key") as work:
        put(work, 3, frames_used=2, drift=[[0.1, 0.2], [0.3, 0.4]])
        numbers = work.numbers(3)
        assert set(numbers) == {"frames_used", "drift"}
        assert numbers["drift"].tolist() == [[0.1, 0.2], [0.3, 0.4]]
        found = decompress(work.chunk(3, THICKNESS[0]), "float32", (3, 4))
        np.testing.assert_allclose(found, MAP["thickness"], rtol=2**-12)


def test_work_of_the_same_key_is_resumed_and_of_another_key_removed(tmp_path, caplog):
    with PartialFilm(tmp_path / "film.nc", "key") as work:
        put(work, 0)
    with caplog.at_level(logging.INFO), PartialFilm(tmp_path / "film.nc", "key") as work:
        assert work.has(0)
        assert "1 triggers are finished" in caplog.text
    with PartialFilm(tmp_path / "film.nc", "another key") as work:
        assert not work.has(0)


def test_nothing_is_left_where_no_trigger_was_finished(tmp_path):
    with PartialFilm(tmp_path / "film.nc", "key"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_second_process_is_refused_while_the_first_works(tmp_path):
    output = tmp_path / "film.nc"
    with PartialFilm(output, "key"), pytest.raises(OutputError, match="another erlif process"):
        PartialFilm(output, "key")


def test_a_folder_of_the_user_is_not_touched(tmp_path):
    own = tmp_path / "film.nc.partial"
    own.mkdir()
    (own / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="something else is there"):
        PartialFilm(tmp_path / "film.nc", "key")
    assert (own / "notes.txt").read_text() == "mine"
    own.rename(tmp_path / "film2.nc.partial")
    PartialFilm(tmp_path / "film.nc", "key").lock.release()  # the lock was given back


def test_a_full_disk_keeps_the_triggers_put_before(tmp_path, monkeypatch):
    def fail(*arguments, **options):
        raise OSError(28, "No space left on device")

    with PartialFilm(tmp_path / "film.nc", "key") as work:
        put(work, 0)
        monkeypatch.setattr(np, "savez", fail)
        with pytest.raises(OutputError, match="No space left"):
            put(work, 1)
        assert work.has(0)
        assert not work.has(1)
