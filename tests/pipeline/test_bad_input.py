"""Bad input on the command line: one message, status 2, and no half-written file."""

import shutil

import numpy as np
import pytest
from scenes.processes import end_command, limit_the_size_of_files

from conftest import read_film
from erlif.core.flags import Flag
from erlif.io.files import PartialFilm

pytestmark = pytest.mark.slow


def truncate(path):
    path.write_bytes(path.read_bytes()[:6000])


def scramble(path):
    data = bytearray(path.read_bytes())
    data[9000:9100] = bytes(100)
    path.write_bytes(data)


def dangle(path):
    path.unlink()
    path.symlink_to("nowhere.tif")


DAMAGE = {
    "truncated": truncate,
    "empty": lambda path: path.write_bytes(b""),
    "damaged": lambda path: path.write_text("these are no pixels"),
    "cannot be read": dangle,
    "cannot be decoded": scramble,
}


def test_damaged_frames_are_left_out_on_request_and_have_notes(lab, command):
    for k, damage in enumerate(DAMAGE.values()):
        damage(lab.frames(1 + k % 2)[k])
    command("process", lab.run, "--skip-bad-frames")
    film, frames = read_film(lab.film), read_film(lab.film, "frames")
    assert film.frames_used.values.tolist() == [0, 0, 0, 0, 0, 1]
    for k, reason in enumerate(DAMAGE):
        assert (
            f"frame pair {k} left out: camera{1 + k % 2}/frame_{k:04d}.tif" in film.attrs["notes"]
        )
        assert reason in frames.attrs["skipped_frames"]
    assert (film.flags[:5] == Flag.OUTSIDE_OVERLAP).all()
    assert (np.isnan(film.thickness) == (film.flags != 0)).all()
    assert np.isfinite(film.film_mean.values).tolist() == [False] * 5 + [True]


@pytest.fixture
def computed(monkeypatch):
    """Numbers of the triggers in the order in which they are computed."""
    triggers = []
    put = PartialFilm.put

    def note(partial, trigger, *rest):
        put(partial, trigger, *rest)
        triggers.append(trigger)

    monkeypatch.setattr(PartialFilm, "put", note)
    return triggers


def kept_triggers(lab):
    """Numbers of the triggers in the journal of the unfinished film, below its first line."""
    journal = lab.run / "film.nc.partial" / "journal"
    return list(range(len(journal.read_text().splitlines()) - 1))


def test_a_disk_too_full_for_the_film_leaves_the_previous_one_and_what_is_done(
    lab, film, command, computed, tmp_path
):
    """Files of the process are limited to a size that the film exceeds and two triggers do not."""
    shutil.copy(film, lab.film)
    options = ("--workers", 1, "--overwrite")
    status, message = end_command(
        tmp_path / "log", "process", lab.run, *options, before=limit_the_size_of_files
    )
    assert status == 2, message
    assert "Traceback" not in message
    assert message.count("erlif: ") == 1
    assert "could not be written: File too large" in message
    assert 0 < len(kept_triggers(lab)) < 6
    assert lab.film.read_bytes() == film.read_bytes()
    assert not list(lab.run.glob("**/*.unfinished*"))

    left = [trigger for trigger in range(6) if trigger not in kept_triggers(lab)]
    command("process", lab.run, *options)
    assert computed == left
    assert lab.film.read_bytes() == film.read_bytes()
