"""A film exported whole or not at all."""

import csv
import hashlib
import sys

import numpy as np
import pytest
import tifffile
from PIL import Image

import erlif
from erlif.core.errors import OutputError
from erlif.core.progress import silent
from erlif.io.conversion import EXPORTS, export, format_of
from erlif.io.conversion.export import write_map_table, write_stack, write_trigger_table
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


def read(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_table_of_triggers_gives_every_number_back(film, tmp_path):
    write_trigger_table(film, tmp_path / "film.csv")
    rows = read(tmp_path / "film.csv")
    assert len(rows) == 6
    for name, unit in (("film_min", "um"), ("rocker_speed", "rad s-1"), ("joint_load", "N")):
        found = [float(row[f"{name} [{unit}]"]) for row in rows]
        assert found == film[name].values.tolist()  # to the last bit
    assert [row["trigger"] for row in rows] == ["0", "1", "2", "3", "4", "5"]


def test_words_of_triggers_stand_in_the_table(film, tmp_path):
    words = np.array(["rigid", 'a "b", c', "", "d", "e", "f"], object)
    write_trigger_table(film.assign(regime=("trigger", words)), tmp_path / "film.csv")
    assert [row["regime"] for row in read(tmp_path / "film.csv")] == words.tolist()


def test_a_map_has_a_row_for_each_pixel(film, tmp_path):
    seen = []
    write_map_table(
        film, tmp_path / "map.csv", trigger=2, progress=lambda what, n, total: seen.append(n)
    )
    rows = read(tmp_path / "map.csv")
    assert len(rows) == 24 * 64
    assert seen[-1] == 24

    last = rows[-1]
    assert (last["x [mm]"], last["y [mm]"]) == ("15.75", "5.75")
    assert np.float32(last["thickness [um]"]) == film.thickness.values[2, -1, -1]
    flags = np.array([int(row["flags"]) for row in rows]).reshape(24, 64)
    np.testing.assert_array_equal(flags, film.flags.values[2])
    assert all((row["thickness [um]"] == "NaN") == (row["flags"] != "0") for row in rows)


def test_positions_have_no_rounding_error(film, tmp_path):
    tenths = film.assign_coords(x=("x", 0.1 * np.arange(64), {"units": "mm"}))
    write_map_table(tenths, tmp_path / "map.csv", trigger=0, progress=silent)
    assert read(tmp_path / "map.csv")[3]["x [mm]"] == "0.3"


def test_a_film_in_zarr_has_the_table_of_that_in_netcdf(film, film_path, tmp_path):
    """Names of regimes are texts of another type in zarr; its variables have no order."""
    store = tmp_path / "film.zarr"
    shuffled = film[sorted(film.data_vars, reverse=True)].drop_encoding()
    shuffled.to_zarr(store, zarr_format=3, consolidated=False)
    for path in (film_path, store):
        with open_film(path) as opened:
            write_trigger_table(opened, tmp_path / f"{path.suffix}.csv")
    found = (tmp_path / ".zarr.csv").read_bytes()
    assert found == (tmp_path / ".nc.csv").read_bytes()
    regimes = [row["film_regime"] for row in read(tmp_path / ".zarr.csv")]
    assert regimes == film.film_regime.values.tolist()


@pytest.fixture(scope="module")
def stack(film, tmp_path_factory):
    path = tmp_path_factory.mktemp("stack") / "film.tif"
    write_stack(film, path, triggers=[0, 1, 2, 3, 4, 5], progress=silent)
    return path


def test_pages_follow_each_other_channel_by_channel(film, stack):
    with Image.open(stack) as image:
        assert image.n_frames == 6 * 4
        for page, name in ((4, "thickness"), (5, "thickness_std"), (7, "flags")):
            image.seek(page)
            assert image.mode == "F"
            np.testing.assert_array_equal(np.asarray(image), film[name].values[1])


def test_imagej_knows_pixel_size_unit_and_order(stack):
    with tifffile.TiffFile(stack) as file:
        text = file.pages[0].description
        tags = file.pages[0].tags
        across, each = tags["XResolution"].value
        labels = file.imagej_metadata["Labels"]
    assert "unit=mm" in text
    assert "channels=4" in text
    assert "frames=6" in text
    assert across / each == pytest.approx(1 / 0.25)  # pixels in a millimetre
    assert labels[4].startswith("thickness um, trigger 1, ")
    assert labels[7].startswith("flags, trigger 1, ")


def test_pixel_size_is_that_of_an_image_whichever_way_it_runs(film, tmp_path):
    path = tmp_path / "film.tif"
    for part, expected in (
        (film.isel(x=slice(None, None, -1)), 1 / 0.25),
        (film.isel(x=[3]), 1.0),  # a single column has none
    ):
        write_stack(part, path, triggers=[0], progress=silent)
        with tifffile.TiffFile(path) as file:
            across, each = file.pages[0].tags["XResolution"].value
        assert across / each == pytest.approx(expected)


def test_a_stack_above_four_gigabytes_has_its_images_in_one_piece(film, tmp_path, monkeypatch):
    path = tmp_path / "film.tif"
    monkeypatch.setattr(sys.modules[write_stack.__module__], "LARGEST", 1000)
    write_stack(film, path, triggers=[1, 2], progress=silent)
    with tifffile.TiffFile(path) as file:
        assert len(file.pages) == 1  # ImageJ finds the others by their number
        start = file.pages[0].dataoffsets[0]
        assert "images=8" in file.pages[0].description
    images = np.fromfile(path, "<f4", count=8 * 24 * 64, offset=start).reshape(8, 24, 64)
    np.testing.assert_array_equal(images[4], film.thickness.values[2])
