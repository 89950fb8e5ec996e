"""netCDF files whose parts are looked up once while they are written.

h5netcdf looks a variable up by its path whenever it is asked for a property, in a film of erlif
about 3000 times: two fifths of the time in which it is written.
"""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import h5netcdf
import h5py

from erlif.core.hdf5 import with_locks


class _KeptFile(h5py.File):  # type: ignore[misc]
    """An HDF5 file that keeps its open parts by their paths."""

    def __init__(self, path: Path | IO[bytes], mode: str) -> None:
        super().__init__(path, mode, track_order=True)  # as netCDF-C needs it to add to a file
        self._parts: dict[str, Any] = {}

    def __getitem__(self, name: Any) -> Any:
        # a reference to an object has no path
        if not isinstance(name, str):
            return super().__getitem__(name)
        kept = self._parts.get(name)
        # a dimension without values gives way to its coordinate
        if kept is None or h5py.h5o.get_info(kept.id).rc == 0:
            kept = self._parts[name] = super().__getitem__(name)
        return kept

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


def open_kept(path: Path | IO[bytes], *, mode: str) -> h5netcdf.File:
    """Open a netCDF-4 file for writing.

    Parameters
    ----------
    path : Path or IO
        The file, or a buffer in memory.
    mode : str
        "w" to begin a file, "a" to add to one.

    Returns
    -------
    h5netcdf.File

    Raises
    ------
    OSError
        If the file is missing, damaged or of another format.
    """
    return _NetcdfFile(with_locks(_KeptFile, path, mode), mode=mode)
