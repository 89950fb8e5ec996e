"""A film exported whole or not at all."""

import hashlib

import pytest

import erlif
from erlif.core.errors import OutputError
from erlif.io.conversion import EXPORTS, export, format_of
from erlif.io.files import open_film


def digest(path):
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return [hashlib.sha256(file.read_bytes()).hexdigest() for file in files]


@pytest.mark.parametrize("kind", EXPORTS)
def test_the_same_film_gives_the_same_bytes_and_is_replaced_on_request(kind, film_path, tmp_path):
    output = tmp_path / f"film{EXPORTS[kind].ending}"
    assert erlif.export(film_path, output, to=kind) == output
    first = digest(output)
    with pytest.raises(OutputError, match="use --overwrite"):
        export(film_path, output, to=kind)
    with open_film(film_path) as film:
        export(film, output, to=kind, overwrite=True)
    assert digest(output) == first
    assert list(tmp_path.iterdir()) == [output]


def test_a_folder_with_other_files_is_never_replaced(film_path, tmp_path):
    output = tmp_path / "film_vtk"
    export(film_path, output, to="vtk", trigger=1)
    (output / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="something else"):
        export(film_path, output, to="vtk", overwrite=True)
    assert (output / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("kind", ["mat", "tiff", "vtk"])
def test_nothing_is_written_where_the_work_is_interrupted(kind, film_path, tmp_path):
    def interrupt(what, done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(film_path, tmp_path / f"a{EXPORTS[kind].ending}", to=kind, progress=interrupt)
    assert not list(tmp_path.iterdir())


def test_a_suffix_chooses_the_format_and_a_wrong_one_is_refused(tmp_path):
    assert format_of(tmp_path / "a.tiff", None) == "tiff"
    assert format_of(tmp_path / "a", "vtk") == "vtk"
    for name, kind, expected in (
        ("a", None, "Give to"),
        ("a.png", None, "Give to"),
        ("a.csv", "mat", "a name in .mat"),
        ("a.vts", "vtk", "a folder's name"),
        ("a.csv", "xls", "one of csv, mat"),
    ):
        with pytest.raises(OutputError, match=expected):
            format_of(tmp_path / name, kind)


def test_memory_does_not_grow_with_the_run(film, monkeypatch, tmp_path):
    """Maps are asked for one at a time."""
    largest = []
    import xarray as xr

    real = xr.DataArray.values.fget

    def values(self):
        found = real(self)
        if self.dims[-2:] == ("y", "x"):
            largest.append(found.size)
        return found

    monkeypatch.setattr(xr.DataArray, "values", property(values))
    for kind in ("mat", "tiff", "vtk"):
        export(film, tmp_path / f"film{EXPORTS[kind].ending}", to=kind)
    assert max(largest) == 24 * 64
