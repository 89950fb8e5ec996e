"""netCDF files opened for reading, and text that Octave reads."""

import h5py
import numpy as np
import pytest
import xarray as xr

from erlif.io.files import has_group, open_netcdf
from erlif.io.files.netcdf import write_netcdf


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "film.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
    xr.Dataset({"b": ("x", [3.0])}).to_netcdf(path, engine="h5netcdf", mode="a", group="frames")
    return path


def test_a_variable_is_not_a_group(path):
    assert has_group(path, "frames")
    assert not has_group(path, "a")
    assert not has_group(path, "registration")


@pytest.mark.parametrize("size", [0, 100, 3000])
def test_a_damaged_file_fails_without_a_word_on_the_terminal(path, size, capfd):
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(OSError):  # noqa: PT011  each damage has a message of its own
        open_netcdf(path)
    assert capfd.readouterr().err == ""


def texts_of_any_length(path):
    """Places in a file with text of variable length, NC_STRING in netCDF."""
    found = []

    def look(name, item):
        for key in item.attrs:
            kind = item.attrs.get_id(key).dtype
            if h5py.check_string_dtype(kind) and h5py.check_string_dtype(kind).length is None:
                found.append(f"{name}@{key}")
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "O":
            found.append(name)

    with h5py.File(path) as file:
        look("/", file)
        file.visititems(look)
    return found


@pytest.mark.parametrize("name", ["film.nc", "calibration.nc"])
def test_all_text_has_a_fixed_length(small_rig, film, name):
    assert texts_of_any_length(film if name == "film.nc" else small_rig.fixture / name) == []


def test_coordinates_of_the_film_have_no_fill_value(film):
    with h5py.File(film) as file:
        assert [name for name in ("trigger", "y", "x") if "_FillValue" in file[name].attrs] == []
        assert np.isnan(file["film_mean"].attrs["_FillValue"])


TEXTS = ["", "1", "um", "µm", "ratio camera2/camera1 – 6.0 °C", "two\nlines"]


@pytest.mark.parametrize("text", TEXTS)
def test_text_comes_back(tmp_path, text):
    dataset = xr.Dataset(
        {"file": ("frame", np.array([text, "longer than the rest of them, all put together"]))},
        coords={"parameter": ("parameter", ["K", "p"])},
        attrs={"notes": text},
    )
    write_netcdf(dataset, tmp_path / "text.nc")
    with open_netcdf(tmp_path / "text.nc") as found:
        assert found.attrs["notes"] == text
        assert found.file.values.tolist() == dataset.file.values.tolist()
        assert found.parameter.values.tolist() == ["K", "p"]


def test_original_is_left_as_it_was(tmp_path):
    dataset = xr.Dataset({"a": ("x", ["b"], {"units": "1"})}, {"x": [1.0]}, {"title": "one"})
    copy = dataset.copy(deep=True)
    write_netcdf(dataset, tmp_path / "text.nc")
    xr.testing.assert_identical(dataset, copy)
    assert dataset.x.encoding == {}


def test_groups_are_added_to_a_file(tmp_path):
    path = tmp_path / "two.nc"
    write_netcdf(xr.Dataset({"joint_load": ("trigger", [220.0])}, attrs={"title": "a"}), path)
    groups = {"frames": xr.Dataset({"file": ("frame", ["ä"])})}
    write_netcdf(xr.Dataset({"speed": ("trigger", [0.5])}), path, mode="a", groups=groups)
    with open_netcdf(path) as root, open_netcdf(path, group="frames") as frames:
        assert (float(root["joint_load"][0]), float(root["speed"][0]), root.title) == (
            220.0,
            0.5,
            "a",
        )
        assert frames.file.values.tolist() == ["ä"]


@pytest.mark.filterwarnings("error")
def test_a_file_of_another_program_is_opened_without_a_warning(tmp_path):
    path = tmp_path / "film.nc"
    with h5py.File(path, "w") as file:
        file["joint_load"] = [220.0, 221.0]  # its dimension has no name
        file["joint_load"].attrs["_FillValue"] = "none"
    with open_netcdf(path) as dataset:
        assert dataset["joint_load"].values.tolist() == [220.0, 221.0]
