"""netCDF files opened for reading."""

import pytest
import xarray as xr

from erlif.files import has_group, open_netcdf


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "film.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
    xr.Dataset({"b": ("x", [3.0])}).to_netcdf(path, engine="h5netcdf", mode="a", group="frames")
    return path


def test_root_and_groups_are_opened(path):
    with open_netcdf(path) as root, open_netcdf(path, group="frames") as frames:
        assert root.a.values.tolist() == [1, 2]
        assert frames.b.values.tolist() == [3]


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
