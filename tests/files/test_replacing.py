"""Outputs that are either complete or still the previous ones."""

import pytest
from matplotlib.figure import Figure

from erlif.core.errors import OutputError
from erlif.files import refuse_existing, replacing


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


def test_an_output_that_does_not_exist_is_not_refused(tmp_path):
    refuse_existing(tmp_path / "film.nc", overwrite=False)


def test_an_existing_output_is_refused_unless_it_may_be_replaced(tmp_path):
    path = tmp_path / "film.nc"
    path.write_bytes(b"\x89HDF\r\n\x1a\nrest")
    with pytest.raises(OutputError, match="--overwrite"):
        refuse_existing(path, overwrite=False)
    refuse_existing(path, overwrite=True)


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_a_figure_of_every_format_may_be_replaced(tmp_path, suffix):
    path = tmp_path / f"figure.{suffix}"
    Figure().savefig(path)
    refuse_existing(path, overwrite=True)


@pytest.mark.parametrize("name", ["data.csv", "folder"])
def test_a_file_of_another_format_is_never_replaced(tmp_path, name):
    path = tmp_path / name
    if name == "folder":
        (path / "inner").mkdir(parents=True)
    else:
        path.write_text("frame,angle_deg")
    with pytest.raises(OutputError, match="something else"):
        refuse_existing(path, overwrite=True)


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
