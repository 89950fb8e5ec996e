"""netCDF files opened for reading."""

from __future__ import annotations

from pathlib import Path

import xarray as xr


def open_netcdf(path: Path, *, group: str | None = None) -> xr.Dataset:
    """Open a netCDF-4 file or one of its groups with xarray.

    Parameters
    ----------
    path : Path
        File to open.
    group : str, optional
        Name of the group; default: the root.

    Returns
    -------
    Dataset
        Values are read when they are used.

    Raises
    ------
    OSError
        If the file is missing, damaged or of another format.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "load.nc")
    ...     xr.Dataset({"load": ("trigger", [220.0])}).to_netcdf(path, engine="h5netcdf")
    ...     with open_netcdf(path) as dataset:
    ...         float(dataset["load"][0])
    220.0
    """
    import h5py

    # A damaged file fails here. Within h5netcdf the failure would print a message of its own.
    with h5py.File(path, "r") as file:
        list(file.attrs.items())
        file.visititems(lambda name, item: None)
    return xr.open_dataset(path, engine="h5netcdf", group=group)


def has_group(path: Path, group: str) -> bool:
    """Check whether a netCDF-4 file has a group of this name.

    Parameters
    ----------
    path : Path
        File to look into.
    group : str
        Name of the group.

    Returns
    -------
    bool

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "film.nc")
    ...     xr.Dataset().to_netcdf(path, engine="h5netcdf", group="frames")
    ...     has_group(path, "frames"), has_group(path, "registration")
    (True, False)
    """
    import h5py

    with h5py.File(path, "r") as file:
        return isinstance(file.get(group), h5py.Group)
