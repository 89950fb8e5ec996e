"""Files of netCDF-4 read in one pass: the same dataset as that of xarray."""

import pickle

import h5py
import numpy as np
import pytest
import xarray as xr

from erlif.io.files import open_netcdf
from erlif.io.files.netcdf import write_netcdf


@pytest.mark.parametrize("group", [None, "frames", "registration"])
def test_a_film_is_opened_as_xarray_opens_it(film, group):
    """With the same values, attributes and encodings; also in a copy for another process."""
    with (
        xr.open_dataset(film, engine="h5netcdf", group=group) as expected,
        open_netcdf(film, group=group) as found,
        pickle.loads(pickle.dumps(found)) as copy,
    ):
        for one in (found, copy):
            assert one.identical(expected)
            assert one.encoding == expected.encoding
            for name, variable in expected.variables.items():
                np.testing.assert_equal(_used(one[name].encoding), _used(variable.encoding))


def _used(encoding):
    """Without the compressions that a variable does not have."""
    return {name: value for name, value in encoding.items() if value is not False}


@pytest.mark.parametrize(
    "attribute",
    [1.5, [1, 2], "", "µm", ["a", "b"], b"", np.array([b"one", b"two"]), h5py.Empty("S1")],
    ids=str,
)
def test_attributes_are_those_that_xarray_reads(tmp_path, attribute):
    """Also of other programs, which write text of any length."""
    path = tmp_path / "film.nc"
    write_netcdf(xr.Dataset({"a": ("x", [1.0, 2.0])}), path)
    with h5py.File(path, "a") as file:
        file["a"].attrs["more"] = file.attrs["more"] = attribute
        file["b"] = np.array(["one", "two"], h5py.string_dtype())
        file["b"].dims[0].attach_scale(file["x"])
    with xr.open_dataset(path, engine="h5netcdf") as expected, open_netcdf(path) as found:
        assert found.identical(expected)
        assert type(found.a.attrs["more"]) is type(expected.a.attrs["more"])


def test_dims_without_a_name_are_named(tmp_path):
    path = tmp_path / "film.nc"
    with h5py.File(path, "w") as file:
        file["a"], file["b"] = np.zeros((2, 2)), np.zeros(3)
    with open_netcdf(path) as found:
        assert {name: one.shape for name, one in found.items()} == {"a": (2, 2), "b": (3,)}


def test_a_missing_group_is_refused(tmp_path):
    write_netcdf(xr.Dataset({"a": ("x", [1.0, 2.0])}), tmp_path / "film.nc")
    for name in ("frames", "a"):
        with pytest.raises(OSError, match=f"it has no group {name}"):
            open_netcdf(tmp_path / "film.nc", group=name)


def test_a_closed_file_may_be_written_again(tmp_path):
    path = tmp_path / "film.nc"
    write_netcdf(xr.Dataset({"a": ("x", [1.0, 2.0])}), path)
    with open_netcdf(path) as dataset:
        assert dataset.a.values.tolist() == [1, 2]
    with h5py.File(path, "a") as file:
        file["a"][:] = [5, 6]
    with open_netcdf(path) as dataset:
        assert dataset.a.values.tolist() == [5, 6]
