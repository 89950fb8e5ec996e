"""netCDF files opened for reading."""

from __future__ import annotations

from pathlib import Path

import xarray as xr


def open_netcdf(path: Path, *, group: str | None = None) -> xr.Dataset:
    """Open a netCDF-4 file or one of its groups with xarray."""
    import h5py

    with h5py.File(
        path, "r"
    ) as file:  # where this fails, h5netcdf would leave a complaint of its own on the terminal
        list(file.attrs.items())
        file.visititems(lambda name, item: None)
    return xr.open_dataset(path, engine="h5netcdf", group=group)


def has_group(path: Path, group: str) -> bool:
    """Whether a netCDF-4 file has a group of this name."""
    import h5py

    with h5py.File(path, "r") as file:
        return isinstance(file.get(group), h5py.Group)


def _free_text(dataset: xr.Dataset) -> xr.Dataset:
    """Text as strings of any length: zarr's format 3 does not know text of a fixed length."""
    return dataset.assign(
        {name: dataset[name].astype(object) for name in dataset if dataset[name].dtype.kind == "U"}
    )
