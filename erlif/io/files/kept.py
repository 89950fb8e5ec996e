"""netCDF files open for reading whose parts are looked up once.

h5netcdf looks a variable up by its path whenever it is asked for a property. In a file of erlif
that is about 2000 times, and three quarters of the time in which it is opened.
"""

from __future__ import annotations

from typing import Any

import h5netcdf
import h5py

from erlif.core.hdf5 import refuse_inflated, with_locks


class _Dataset(h5py.Dataset):  # type: ignore[misc]
    """A dataset whose chunks are looked at before they are read."""

    __module__ = h5py.Dataset.__module__  # by which h5netcdf knows a dataset

    def __getitem__(self, args: Any, new_dtype: Any = None) -> Any:
        refuse_inflated(self, args[0] if isinstance(args, tuple) and args else slice(None))
        return super().__getitem__(args, new_dtype)


class _KeptFile(h5py.File):  # type: ignore[misc]
    """An HDF5 file that keeps its open parts by their paths; for reading only."""

    def __init__(self, path: str, **options: Any) -> None:
        super().__init__(path, "r", **options)
        self._parts: dict[str, Any] = {}

    def __getitem__(self, name: Any) -> Any:
        # a reference to an object has no path
        if not isinstance(name, str):
            return super().__getitem__(name)
        if name not in self._parts:
            part = super().__getitem__(name)
            self._parts[name] = _Dataset(part.id) if isinstance(part, h5py.Dataset) else part
        return self._parts[name]

    def close(self) -> None:
        self._parts.clear()
        super().close()


class _NetcdfFile(h5netcdf.File):  # type: ignore[misc]
    """A netCDF-4 file that closes the file of HDF5 below it."""

    def close(self) -> None:
        below = None if self._closed else self._h5file
        super().close()
        if below is not None:
            below.close()


def open_kept(path: str, *, mode: str, **options: Any) -> h5netcdf.File:
    """Open a netCDF-4 file for reading.

    Parameters
    ----------
    path : str
        File to open.
    mode : str
        "r", for xarray, which states it.
    options
        As those of ``h5netcdf.File``.

    Returns
    -------
    h5netcdf.File

    Raises
    ------
    OSError
        If the file is missing, damaged or of another format.
    """
    return _NetcdfFile(with_locks(_KeptFile, path), mode=mode, **options)
