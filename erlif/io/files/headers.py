"""Checks of the size that the header of a film states, before any data are read.

A header may claim more than the memory holds, or maps that the file does not have. HDF5 and zarr
return the fill value for what is missing, and the fill value of `flags` marks a valid pixel.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.bounded import read_bounded
from erlif.core.hdf5 import chunk_count, find_chunks, open_hdf5, refuse_elsewhere
from erlif.core.variables import FILM

# Largest size of what is read at once: a map, or a variable of the triggers. [byte]
LARGEST_READ = 2**30

# Variables of which the map of a trigger is one chunk.
MAPS = tuple(name for name, one in FILM.items() if one.dims == ("trigger", "y", "x"))

# Size of a description in a zarr store that is read. [byte]
_LARGEST_DESCRIPTION = 2**24

# Codecs of zarr that erlif writes, and those that other programs use for arrays of numbers.
_CODECS = frozenset({"bytes", "blosc", "zstd", "gzip", "crc32c", "vlen-utf8", "transpose"})


def check_netcdf(path: Path) -> None:
    """Refuse a netCDF film by its header.

    Raises
    ------
    ValueError
        With the bare reason.
    OSError
        If HDF5 cannot read the header.
    """
    import h5py

    with open_hdf5(path) as file:
        for name, entry in _netcdf_entries(file, h5py):
            if not isinstance(entry, h5py.Dataset):
                continue
            refuse_elsewhere(name, entry)

            # the maps of a film are read one after the other, all else at once
            per_read = entry.shape[1:] if name in MAPS else entry.shape
            _check_size(name, math.prod(per_read or ()) * entry.dtype.itemsize)
            if name not in MAPS:
                continue
            if entry.ndim != len(("trigger", "y", "x")):
                raise ValueError(f"{name} has the shape {entry.shape}")
            fewer = entry.chunks is not None and entry.id.get_num_chunks() != chunk_count(entry)
            if fewer or not find_chunks(entry).all():
                raise ValueError(f"maps of {name} are missing")


def _netcdf_entries(group: Any, h5py: Any) -> Iterator[tuple[str, Any]]:
    """Entries of a file by their names; links to other files are refused."""
    for name in group:
        link = group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            raise ValueError(f"{name} is a link")
        entry = group[name]
        yield entry.name.lstrip("/"), entry

        # groups of a film hold no groups, so that circles of hard links are not followed
        if isinstance(entry, h5py.Group) and group.name == "/":
            yield from _netcdf_entries(entry, h5py)


def check_zarr(path: Path) -> None:
    """Refuse a zarr film by its descriptions.

    Argument and errors as in `check_netcdf`.
    """
    for place in [path, *sorted(path.glob("*/")), *sorted(path.glob("*/*/"))]:
        description = place / "zarr.json"
        if not description.is_file():
            if place == path:
                raise ValueError("it has no zarr.json")
            continue
        name = place.relative_to(path).as_posix()
        text = read_bounded(description, largest=_LARGEST_DESCRIPTION)
        try:
            header = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{name}/zarr.json is no JSON") from error
        if not isinstance(header, dict):
            raise ValueError(f"{name}/zarr.json describes no array")
        if header.get("node_type") == "array":
            _check_array(place, name, header)


def _check_array(place: Path, name: str, header: dict[str, Any]) -> None:
    """Refuse an array of a zarr store by its description."""
    codecs = [codec.get("name") for codec in header["codecs"]]
    if not _CODECS.issuperset(codecs):
        raise ValueError(f"{name} has the codecs {codecs}")

    shape = [int(length) for length in header["shape"]]
    chunks = [int(length) for length in header["chunk_grid"]["configuration"]["chunk_shape"]]
    kind = header["data_type"]
    itemsize = np.dtype(kind).itemsize if isinstance(kind, str) and kind != "string" else 1
    if len(chunks) != len(shape) or min([*shape, *chunks], default=1) < 1:
        raise ValueError(f"{name} has the shape {shape} in chunks of {chunks}")
    _check_size(name, math.prod(shape[1:] if name in MAPS else shape) * itemsize)
    _check_size(name, math.prod(chunks) * itemsize)

    # a chunk that is missing would be read as the fill value; other programs leave out chunks of
    # zeros, and name chunks in another way
    separator = header["chunk_key_encoding"].get("configuration", {}).get("separator")
    if name in MAPS and separator == ".":
        for trigger in range(shape[0]):
            if not (place / f"c.{trigger}.0.0").is_file():
                raise ValueError(f"the map {trigger} of {name} is missing")


def _check_size(name: str, size: int) -> None:
    if size > LARGEST_READ:
        raise ValueError(f"its header claims {size / 1e9:.1f} GB of {name}")
