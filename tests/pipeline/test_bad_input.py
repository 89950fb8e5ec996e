"""Bad input on the command line: one message, status 2, and no half-written file."""

import errno
import os
import shutil

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from scenes.processes import end_command, kill_at_the_end, limit_the_size_of_files

import erlif
from erlif.commands.main import main
from erlif.core.flags import Flag
from erlif.io.files import PartialFilm

pytestmark = pytest.mark.slow


def read_film(path, group=None):
    with erlif.open_film(path, group=group) as film:
        return film.load()


# what is refused: the change, the command, and what the message must contain


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


def test_counts_far_below_the_depth_bring_a_warning_into_the_film(lab, command):
    for table in ("run/run.toml", "fixture/fixture.toml"):
        lab.edit(table, ("bit_depth = 12", "bit_depth = 16"))
    assert "warning counts: camera1: no count is above" in command("check", lab.run).stdout
    assert "bit_depth = 12 would fit" in command("-v", "process", lab.run).stdout
    assert "bit_depth = 12 would fit" in read_film(lab.film).attrs["notes"]


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


# output


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


def test_a_process_killed_while_writing_leaves_the_previous_film_and_resumes(
    lab, film, command, computed, tmp_path
):
    shutil.copy(film, lab.film)
    status, message = end_command(
        tmp_path / "log", "process", lab.run, "--overwrite", before=kill_at_the_end
    )
    assert status == -9, message
    assert lab.film.read_bytes() == film.read_bytes()
    command("process", lab.run, "--overwrite")
    assert computed == []
    assert lab.film.read_bytes() == film.read_bytes()
    assert [path.name for path in lab.run.iterdir() if "film" in path.name] == ["film.nc"]


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


def test_a_disk_too_full_for_a_zarr_leaves_the_previous_one(lab, monkeypatch):
    output = lab.run / "film.zarr"
    (output / "thickness").mkdir(parents=True)
    (output / "zarr.json").write_text('{"attributes": {"erlif_version": "0.1.0"}}')

    def fill_up(*arguments, **options):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(xr.Dataset, "to_zarr", fill_up)
    result = CliRunner().invoke(main, ["process", str(lab.run), "-o", str(output), "--overwrite"])
    assert result.exit_code == 2
    assert "could not be written: No space left on device" in result.stderr
    assert {path.name for path in output.iterdir()} == {"zarr.json", "thickness"}
    assert not list(lab.run.glob("**/*.unfinished*"))
