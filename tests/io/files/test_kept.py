"""Files whose parts are kept open: the same file as that of h5netcdf."""

import h5py
import pytest
import xarray as xr

from erlif.io.files.netcdf import _fix_text, write_netcdf


@pytest.mark.parametrize("group", [None, "frames"])
def test_a_file_is_written_as_h5netcdf_writes_it(film, tmp_path, group):
    """Also a coordinate of text, in whose place h5netcdf first puts a dimension without values."""
    with xr.open_dataset(film, engine="h5netcdf", group=group) as dataset:
        dataset = dataset.load().drop_encoding()
    expected, written = tmp_path / "expected.nc", tmp_path / "written.nc"
    fixed, attrs = _fix_text(dataset.coords, dataset.variables, dataset.attrs)
    alike = xr.Dataset(fixed, attrs=attrs).set_coords(list(dataset.coords))
    alike.to_netcdf(expected, engine="h5netcdf", group=group)
    write_netcdf(dataset, written, group=group)
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
