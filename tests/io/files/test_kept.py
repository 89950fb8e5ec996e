"""Files whose parts are kept open: the same dataset as that of xarray, and a file that closes."""

import pickle
import zlib

import h5py
import numpy as np
import pytest
import xarray as xr

from erlif.io.files import open_netcdf
from erlif.io.files.kept import _KeptFile
from erlif.io.files.netcdf import _fix_text, write_netcdf


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
                np.testing.assert_equal(one[name].encoding, variable.encoding)


def test_a_file_is_written_as_h5netcdf_writes_it(film, tmp_path):
    """Also a coordinate of text, in whose place h5netcdf first puts a dimension without values."""
    expected, written = tmp_path / "expected.nc", tmp_path / "written.nc"
    datasets = {}
    for group in (None, "frames", "registration"):
        with xr.open_dataset(film, engine="h5netcdf", group=group) as dataset:
            dataset = datasets[group] = dataset.load().drop_encoding()
        fixed, attrs = _fix_text(dataset.coords, dataset.variables, dataset.attrs)
        alike = xr.Dataset(fixed, attrs=attrs).set_coords(list(dataset.coords))
        mode = "w" if group is None else "a"
        alike.to_netcdf(expected, engine="h5netcdf", group=group, mode=mode)
    write_netcdf(datasets.pop(None), written, groups=datasets)
    assert _describe(written) == _describe(expected)


def _describe(path):
    """Every part of a file of HDF5 with its type, shape, bytes and the names of its attributes."""
    parts = []

    def describe(name, item):
        values = (item.dtype, item.shape, item[()].tobytes()) if hasattr(item, "shape") else ()
        parts.append((name, sorted(item.attrs), *values))

    with h5py.File(path) as file:
        file.visititems(describe)
    return parts


def test_a_closed_file_may_be_written_again(tmp_path):
    path = tmp_path / "film.nc"
    write_netcdf(xr.Dataset({"a": ("x", [1.0, 2.0])}), path)
    with open_netcdf(path) as dataset:
        assert dataset.a.values.tolist() == [1, 2]
    with h5py.File(path, "a") as file:
        file["a"][:] = [5, 6]
    with open_netcdf(path) as dataset:
        assert dataset.a.values.tolist() == [5, 6]


@pytest.mark.parametrize("mode", ["r", "a"])
def test_chunks_of_a_coordinate_are_looked_at_however_it_was_found(mode, tmp_path):
    """A coordinate is found by the references of its variables too, and these may come first.

    Its chunk of 1000 bytes would become 256 MiB.
    """
    path = tmp_path / "swollen.nc"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("x", (1000,), "u1", chunks=(1000,), compression="gzip")
        data.id.write_direct_chunk((0,), zlib.compress(bytes(2**28)))
        file.attrs["scale"] = data.ref
    with _KeptFile(path, mode) as file:
        for part in (file[file.attrs["scale"]], file["x"], file["/x"]):
            with pytest.raises(OSError, match="holds more than the 1000 bytes it states"):
                part[:]
