"""Variables of a netCDF-4 file, found in one pass over its parts.

h5netcdf, by which xarray opens such a file, looks each part up many times: a film takes three times
as long.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from xarray.core import indexing

from erlif.core.hdf5 import refuse_inflated, with_locks

# Class of a dim in HDF5, and the begin of the name of one without values in netCDF.
_SCALE, _NO_VALUES = b"DIMENSION_SCALE", b"This is a netCDF dimension but not a netCDF variable"

# Number of a dim, and those of a variable.
_NUMBER, _NUMBERS = "_Netcdf4Dimid", "_Netcdf4Coordinates"

# References of a variable to its dims, and of a dim to its variables.
_SCALES, _USES = "DIMENSION_LIST", "REFERENCE_LIST"

# Attributes by which HDF5 and netCDF know dims, and themselves.
_HIDDEN = ("CLASS", "NAME", _NUMBER, _NUMBERS, "_NCProperties", "_nc3_strict")

# Attributes of the type of the values.
_FILLS = ("_FillValue", "missing_value")


class StoredGroup(xr.backends.AbstractDataStore):
    """A group of a netCDF-4 file.

    Parameters
    ----------
    path : Path
    group : str, optional
        Its name; default: the root.

    Raises
    ------
    OSError
        If the file or the group is missing or damaged.
    """

    def __init__(self, path: Path, group: str | None = None) -> None:
        self._manager = xr.backends.CachingFileManager(_open_file, str(path), mode="r")
        with self._manager.acquire_context() as file:
            place = file.get(group or "/")
            if not isinstance(place, h5py.Group):
                raise OSError(f"it has no group {group}")
            self._attrs = _public(_read_attributes(place))
            parts = {
                name: (one, _read_attributes(one))
                for name, one in place.items()
                if isinstance(one, h5py.Dataset)
            }
            scales = {
                int(attrs.get(_NUMBER, -1)): name
                for name, (_, attrs) in parts.items()
                if attrs.get("CLASS") == _SCALE
            }
            self._variables = {
                name: self._describe(one, attrs, _name_dims(one, attrs, scales), str(path))
                for name, (one, attrs) in parts.items()
                if not attrs.get("NAME", b"").startswith(_NO_VALUES)
            }

    def load(self) -> tuple[dict[str, xr.Variable], dict[str, Any]]:
        """Variables as they are stored, with lazy values, and attributes of the group."""
        return self._variables, self._attrs

    def get_encoding(self) -> dict[str, Any]:
        """No dim of a file of erlif grows."""
        return {"unlimited_dims": set()}

    def close(self) -> None:
        """Close the file."""
        self._manager.close()

    def _describe(
        self, data: h5py.Dataset, attrs: dict[str, Any], dims: tuple[str, ...], source: str
    ) -> xr.Variable:
        """A variable as it is stored."""
        values = _Values(self._manager, data)
        encoding = {"dtype": str if values.text else data.dtype, "contiguous": data.chunks is None}
        encoding |= {"chunksizes": data.chunks, "source": source, "original_shape": data.shape}
        if data.chunks is not None:
            encoding["preferred_chunks"] = dict(zip(dims, data.chunks, strict=True))
            encoding |= {"shuffle": data.shuffle, "fletcher32": data.fletcher32}
        if data.compression == "gzip":
            encoding |= {"zlib": True, "complevel": data.compression_opts}
        return xr.Variable(dims, indexing.LazilyIndexedArray(values), _public(attrs), encoding)


class _Values(xr.backends.BackendArray):
    """Values of a variable, read when they are used."""

    def __init__(self, manager: xr.backends.CachingFileManager[Any], data: h5py.Dataset) -> None:
        self._manager, self._path = manager, data.name
        self.shape, self.dtype = data.shape, data.dtype
        self.text = data.dtype.hasobject and h5py.check_string_dtype(data.dtype) is not None

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER_1VECTOR
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        with self._manager.acquire_context() as file:
            data = file[self._path]
            refuse_inflated(data, key[0] if key else slice(None))
            return (data.asstr() if self.text else data)[key]


def _open_file(path: str, mode: str) -> h5py.File:
    return with_locks(h5py.File, path, mode)


def _read_attributes(part: h5py.Dataset | h5py.Group) -> dict[str, Any]:
    """Attributes as HDF5 has them, without references."""
    return {name: part.attrs[name] for name in part.attrs if name not in (_SCALES, _USES)}


def _name_dims(
    data: h5py.Dataset, attrs: dict[str, Any], scales: dict[int, str]
) -> tuple[str, ...]:
    """Names of the dims of a variable; those that a file does not name get names."""
    numbers = [int(number) for number in attrs.get(_NUMBERS, ())]
    if len(numbers) == data.ndim and scales.keys() >= set(numbers):
        return tuple(scales[number] for number in numbers)
    name = data.name.rpartition("/")[2]
    if attrs.get("CLASS") == _SCALE:
        return (name,)
    return tuple(
        h5py.h5r.get_name(of_axis[-1], data.id).decode().rpartition("/")[2]
        if len(of_axis)
        else f"axis {axis} of {name}"
        for axis, of_axis in enumerate(data.attrs.get(_SCALES, [()] * data.ndim))
    )


def _public(attrs: dict[str, Any]) -> dict[str, Any]:
    """Attributes for readers: numbers, text, and lists of them; single ones without a list."""
    found = {}
    for name, value in attrs.items():
        if name in _HIDDEN:
            continue
        if isinstance(value, h5py.Empty):
            value = b"" if value.dtype.kind == "S" else np.array([], value.dtype)
        if isinstance(value, np.ndarray):
            value = [_decode(one) for one in value.flat] if value.dtype.kind in "OS" else value
            value = value[0] if len(value) == 1 else value
        found[name] = value if name in _FILLS else _decode(value)
    return found


def _decode(value: Any) -> Any:
    """Text of bytes; what is no text in UTF-8 is refused where it is checked."""
    return value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value
