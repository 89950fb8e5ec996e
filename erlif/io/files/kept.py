"""netCDF files whose parts are looked up once.

h5netcdf looks a variable up by its path whenever it is asked for a property. In a file of erlif
that is about 3000 times: three quarters of the time in which it is opened, and two fifths of that
in which it is written.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import IO, Any

import h5netcdf
import h5py

from erlif.core.hdf5 import refuse_inflated, with_locks


class _Dataset(h5py.Dataset):  # type: ignore[misc]
    """A dataset whose chunks are looked at before they are read."""

    __module__ = h5py.Dataset.__module__  # by which h5netcdf knows a dataset

    def __getitem__(self, args: Any, new_dtype: Any = None) -> Any:
        refuse_inflated(self, args[0] if isinstance(args, tuple) and args else slice(None))
        return super().__getitem__(args, new_dtype)


class _UnchangedDataset(_Dataset):
    """A dataset that is read alone: its name and its attributes are read once."""

    __module__ = h5py.Dataset.__module__
    name = cached_property(h5py.Dataset.name.fget)

    @cached_property
    def attrs(self) -> _UnchangedAttributes:
        """Attributes by their names."""
        return _UnchangedAttributes(self)


class _UnchangedAttributes(h5py.AttributeManager):  # type: ignore[misc]
    """Attributes that are read once."""

    def __init__(self, parent: h5py.Dataset) -> None:
        super().__init__(parent)
        self._values: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._values:
            self._values[name] = super().__getitem__(name)
        return self._values[name]


class _KeptFile(h5py.File):  # type: ignore[misc]
    """An HDF5 file that keeps its open parts by their paths."""

    def __init__(self, path: str | Path | IO[bytes], mode: str, **options: Any) -> None:
        super().__init__(path, mode, **options)
        self._parts: dict[str, Any] = {}
        self._unchanged: dict[h5py.h5g.GroupID | h5py.h5d.DatasetID, Any] = {}
        self._changes = mode != "r"

    def __getitem__(self, name: Any) -> Any:
        # a reference to an object has no path
        if not isinstance(name, str):
            return self._keep(super().__getitem__(name))

        kept = self._parts.get(name)
        # a dimension without values gives way to its coordinate
        if kept is None or (self._changes and h5py.h5o.get_info(kept.id).rc == 0):
            kept = self._parts[name] = self._keep(super().__getitem__(name))
        return kept

    def _keep(self, part: Any) -> Any:
        """Return a part that looks at its chunks; in a file that is read alone, always the same."""
        is_dataset = isinstance(part, h5py.Dataset)
        if self._changes:
            return _Dataset(part.id) if is_dataset else part

        # identifiers of one object are equal, whether it was found by a path or by a reference
        if part.id not in self._unchanged:
            self._unchanged[part.id] = _UnchangedDataset(part.id) if is_dataset else part
        return self._unchanged[part.id]

    def close(self) -> None:
        self._parts.clear()
        self._unchanged.clear()
        super().close()


class _NetcdfFile(h5netcdf.File):  # type: ignore[misc]
    """A netCDF-4 file that closes the file of HDF5 below it."""

    def close(self) -> None:
        below = None if self._closed else self._h5file
        super().close()
        if below is not None:
            below.close()


def open_kept(path: str | Path | IO[bytes], *, mode: str, **options: Any) -> h5netcdf.File:
    """Open a netCDF-4 file.

    Parameters
    ----------
    path : str, Path or IO
        The file, or a buffer in memory.
    mode : str
        "r" to read, "w" to begin a file, "a" to add to one.
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
    order = {} if mode == "r" else {"track_order": True}  # as netCDF-C needs it to add to a file
    return _NetcdfFile(with_locks(_KeptFile, path, mode, **order), mode=mode, **options)
