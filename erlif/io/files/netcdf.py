"""netCDF files opened for reading, and text in the form that all readers of netCDF know."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import IO, Any, Literal

import numpy as np
import xarray as xr

from erlif.core.hdf5 import open_hdf5


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
    ValueError
        As `open_hdf5`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "load.nc")
    ...     xr.Dataset({"joint_load": ("trigger", [220.0])}).to_netcdf(path, engine="h5netcdf")
    ...     with open_netcdf(path) as dataset:
    ...         float(dataset["joint_load"][0])
    220.0
    """
    from erlif.io.files.kept import open_kept

    # A damaged file fails here. Within h5netcdf the failure would print a message of its own.
    with open_hdf5(path) as file:
        list(file.attrs.items())

    # Dimensions that a file does not name get names, and impossible fill values are dropped. Both
    # are found when the variables are checked, and stated there.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", xr.SerializationWarning)

        # as xr.open_dataset(path, engine="h5netcdf"), with the parts of the file kept open
        name = os.path.abspath(path)
        options = {"phony_dims": "access", "decode_vlen_strings": True}
        manager = xr.backends.CachingFileManager(open_kept, name, mode="r", kwargs=options)
        with manager.acquire_context():
            store = xr.backends.H5NetCDFStore(manager, group=group, mode="r")
            dataset = xr.open_dataset(store, engine="store")
    dataset.encoding["source"] = name
    return dataset


def write_netcdf(
    dataset: xr.Dataset,
    path: Path | IO[bytes],
    *,
    mode: Literal["w", "a"] = "w",
    groups: Mapping[str, xr.Dataset] | None = None,
) -> None:
    """Write a dataset and others as groups to a netCDF-4 file, or add them.

    `xarray.Dataset.to_netcdf` would look for a scheduler of dask first and load both where dask is
    installed, which takes 15 MB and 0.2 s.

    Parameters
    ----------
    dataset : Dataset
        Its text gets a fixed length; read back, it is text again.
    path : Path or IO
        The file, or a buffer in memory.
    mode : str
        "w" to begin a file, "a" to add to one.
    groups : mapping of str to Dataset, optional
        Datasets of new groups by name; default: none.

    Raises
    ------
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "load.nc")
    ...     write_netcdf(xr.Dataset({"joint_load": ("trigger", [220.0])}), path)
    ...     with open_netcdf(path) as dataset:
    ...         float(dataset["joint_load"][0])
    220.0
    """
    from erlif.io.files.kept import open_kept

    with open_kept(path, mode=mode) as file:
        for name, one in [(None, dataset), *(groups or {}).items()]:
            store = xr.backends.H5NetCDFStore(file if name is None else file.create_group(name))
            one.dump_to_store(store, encoder=partial(_fix_text, one.coords))


def _fix_text(
    coords: Iterable[Any], variables: Mapping[Any, xr.Variable], attrs: Mapping[Any, Any]
) -> tuple[dict[Any, xr.Variable], dict[Any, Any]]:
    """Turn text into characters of a fixed length, and leave coordinates without a fill value.

    xarray writes text of any length (NC_STRING), which Octave and older programs do not read; CF
    allows no missing values in a coordinate.
    """
    fixed = {}
    for name, variable in variables.items():
        one = variable.copy(deep=False)
        if variable.dtype.kind in "UO":
            text = np.char.encode(variable.values.astype(str), "utf-8")
            named = {key: one.attrs.pop(key) for key in ("coordinates",) if key in one.attrs}
            one = xr.Variable(variable.dims, text, {**one.attrs, "_Encoding": "utf-8", **named})
        one.attrs = fix_attributes(one.attrs)
        if name in coords:
            one.encoding["_FillValue"] = None
        fixed[name] = one
    return fixed, fix_attributes(attrs)


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

    with open_hdf5(path) as file:
        return isinstance(file.get(group), h5py.Group)


def fix_attributes(attrs: Mapping[Any, Any]) -> dict[Any, Any]:
    """Text of a fixed length in place of text of any length; other values as they are."""
    import h5py

    fixed = dict(attrs)
    for name, value in attrs.items():
        if isinstance(value, str):
            encoded = value.encode()
            kind = h5py.string_dtype("utf-8", max(len(encoded), 1))
            fixed[name] = np.array(encoded, kind)
    return fixed
