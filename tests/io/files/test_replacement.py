"""Outputs that are either complete or still the previous ones."""

import errno
import json
import os

import pytest
import xarray as xr
from matplotlib.figure import Figure

from erlif.core.errors import OutputError
from erlif.io.files import refuse_existing, replacing, replacing_set
from erlif.show.plots import save_figure


def test_a_failure_while_writing_leaves_the_old_file(tmp_path):
    path = tmp_path / "film.nc"
    path.write_text("old")

    def write_half():
        with replacing(path) as scratch:
            scratch.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device"):
        write_half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_directory_is_exchanged_as_a_whole(tmp_path):
    path = tmp_path / "film.zarr"
    for content in ("first", "second"):
        with replacing(path) as scratch:
            scratch.mkdir()
            (scratch / "value").write_text(content)
    assert (path / "value").read_text() == "second"
    assert list(tmp_path.iterdir()) == [path]


def netcdf(path, variable="thickness", **attrs):
    """A small netCDF file; that of erlif has its version among the attributes."""
    xr.Dataset({variable: 1.0}, attrs=attrs).to_netcdf(path, engine="h5netcdf")
    return path


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_a_figure_of_erlif_may_be_replaced_and_that_of_another_program_not(tmp_path, suffix):
    path = tmp_path / f"figure.{suffix}"
    save_figure(Figure(), path)
    refuse_existing(path, overwrite=True)
    Figure().savefig(path)
    with pytest.raises(OutputError, match="something else"):
        refuse_existing(path, overwrite=True)


def test_an_empty_file_may_be_replaced(tmp_path):
    (tmp_path / "film.nc").touch()
    refuse_existing(tmp_path / "film.nc", overwrite=True)


def store(path, **attributes):
    (path / "thickness").mkdir(parents=True)
    describe(path, json.dumps({"attributes": attributes}))


def describe(path, text):
    path.mkdir(parents=True, exist_ok=True)
    (path / "zarr.json").write_text(text)


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("data.csv", lambda path: path.write_text("frame,angle_deg")),
        ("film.nc", lambda path: netcdf(path, title="sea surface temperature")),
        ("film.nc", lambda path: netcdf(path, "ratio_at_zero", erlif_version="0.1.0")),
        ("film.nc", lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\nrest")),
        ("film.zarr", lambda path: store(path, title="sea surface temperature")),
        ("film.zarr", lambda path: (path / "letters").mkdir(parents=True)),
        ("film.zarr", lambda path: describe(path, "[" * 100_000)),
        ("film.zarr", lambda path: describe(path, '{"attributes": 5}')),
        ("report.html", lambda path: path.write_text("<!DOCTYPE html><title>my page</title>")),
        ("report.html", lambda path: netcdf(path, erlif_version="0.1.0")),
        ("map.png", lambda path: path.write_text("erlif")),
        ("film.mat", lambda path: path.write_bytes(b"MATLAB 5.0 MAT-file, Platform: GLNXA64")),
        ("film.tif", lambda path: path.write_bytes(b"II*\0 somebody's image")),
        ("folder", lambda path: (path / "inner").mkdir(parents=True)),
        ("film.nc", os.mkfifo),
    ],
)
def test_what_the_command_has_not_written_is_never_replaced(tmp_path, name, write):
    path = tmp_path / name
    write(path)
    with pytest.raises(OutputError, match="something else"):
        refuse_existing(path, overwrite=True, holds="thickness")


def test_an_earlier_store_may_be_replaced(tmp_path):
    store(tmp_path / "film.zarr", erlif_version="0.1.0")
    refuse_existing(tmp_path / "film.zarr", overwrite=True, holds="thickness")


def test_an_old_directory_that_a_killed_process_has_left_goes_with_the_next(tmp_path):
    """Killed between the two renames, so that nothing has the name of the output."""
    output, old = tmp_path / "film.zarr", tmp_path / ".film.zarr.old"
    (old / "thickness").mkdir(parents=True)
    with replacing(output) as scratch:
        scratch.mkdir()
        (scratch / "zarr.json").touch()
    assert [path.name for path in tmp_path.iterdir()] == ["film.zarr"]


def test_the_old_directory_comes_back_where_the_exchange_fails(tmp_path, monkeypatch):
    path = tmp_path / "film.zarr"
    path.mkdir()
    (path / "value").write_text("old")
    rename = type(path).rename

    def fail(self, target):
        if self.name.endswith(".unfinished"):
            raise OSError(5, "Input/output error")
        return rename(self, target)

    monkeypatch.setattr(type(path), "rename", fail)

    def write():
        with replacing(path) as scratch:
            scratch.mkdir()

    with pytest.raises(OutputError, match="Input/output error"):
        write()
    assert (path / "value").read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.zarr"]


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.ENOSPC, "Make room"),
        (errno.EACCES, "Allow to write there"),
        (errno.EISDIR, "Move .*journal away"),
    ],
)
def test_the_advice_follows_the_cause(tmp_path, number, words):
    error = OSError(number, os.strerror(number), "journal.new", None, "journal")
    with pytest.raises(OutputError, match=words), replacing(tmp_path / "film.nc"):
        raise error


SET = ("compare.nc", "compare.csv", "films.png")


def write_set(folder, content, names=SET):
    with replacing_set(folder, SET) as scratch:
        for name in names:
            (scratch / name).write_text(content)


def content_of(folder):
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file()}


def test_the_first_file_of_a_set_is_there_only_with_the_others(tmp_path, monkeypatch):
    """Whatever the step after which the process is killed."""
    write_set(tmp_path, "old")
    seen = []
    replace = type(tmp_path).replace

    def recording(self, target):
        seen.append(content_of(tmp_path))
        return replace(self, target)

    monkeypatch.setattr(type(tmp_path), "replace", recording)
    write_set(tmp_path, "new", SET[:2])
    assert content_of(tmp_path) == {"compare.nc": "new", "compare.csv": "new"}
    assert len(seen) == 5
    for found in seen:
        assert "compare.nc" not in found or found == dict.fromkeys(SET, "old")
    assert {path.name for path in tmp_path.iterdir()} == set(SET[:2])


@pytest.mark.parametrize("step", range(6))
def test_a_set_that_cannot_be_exchanged_leaves_the_previous_one(tmp_path, monkeypatch, step):
    write_set(tmp_path, "old", SET[:2])
    (tmp_path / "other.csv").write_text("mine")
    replace, calls = type(tmp_path).replace, iter(range(100))

    def failing(self, target):
        if next(calls) == step:
            raise OSError(errno.ENOSPC, "No space left on device")
        return replace(self, target)

    monkeypatch.setattr(type(tmp_path), "replace", failing)
    before = content_of(tmp_path)
    if step < 5:
        with pytest.raises(OutputError, match="No space left on device"):
            write_set(tmp_path, "new")
        assert content_of(tmp_path) == before
    else:  # two files moved away and three in
        write_set(tmp_path, "new")
        assert content_of(tmp_path) == {**dict.fromkeys(SET, "new"), "other.csv": "mine"}
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]
