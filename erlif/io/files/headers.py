"""Checks of the size that the header of a film states, before any data are read.

A header may claim more than the memory holds, or maps that the file does not have. HDF5 and zarr
return the fill value for what is missing, and the fill value of `flags` marks a valid pixel.
"""

from __future__ import annotations

import math
import os
import stat
from collections.abc import Iterator, Sequence, Set
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.hdf5 import chunk_count, chunk_size, find_chunks, open_hdf5, refuse_elsewhere
from erlif.core.variables import FILM
from erlif.io.files.descriptions import read_description

# Largest size of what is read at once: a map, or a variable of the triggers. [byte]
LARGEST_READ = 2**30

# Variables of which the map of a trigger is one chunk.
MAPS = tuple(name for name, one in FILM.items() if one.dims == ("trigger", "y", "x"))

# What a text takes in memory beside its letters, and a chunk while it is read. [byte]
_TEXT, _CHUNK = 64, 2**13

# Codecs of zarr that erlif writes, and those that other programs use for arrays of numbers.
_COMPRESSIONS = frozenset({"blosc", "zstd", "gzip"})
_CODECS = _COMPRESSIONS | {"bytes", "crc32c", "vlen-utf8", "transpose"}

# Size of what a film has beside its maps, which is read when it is opened; a million pairs have
# 140 MB. [byte]
_LARGEST_BESIDE = 2**28


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

    at_once = 0
    with open_hdf5(path) as file:
        for name, entry in _netcdf_entries(file, h5py):
            if not isinstance(entry, h5py.Dataset):
                continue
            refuse_elsewhere(name, entry)

            # the maps of a film are read one after the other, all else at once
            per_read = entry.shape[1:] if name in MAPS else entry.shape
            size = max(math.prod(per_read or ()) * entry.dtype.itemsize, chunk_size(entry))
            _check_size(name, size)
            at_once += _size_at_once(name, entry.shape or (), size, entry.chunks)
            _check_size("its small variables", at_once, most=_LARGEST_BESIDE)
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


def check_zarr(path: Path) -> dict[str, tuple[str, int]]:
    """Refuse a zarr film by its descriptions.

    Argument and errors as in `check_netcdf`.

    Returns
    -------
    dict of str to (str, int)
        Compression of each array, and what one of its chunks may hold. [byte]
    """
    files, at_once, held = _regular_files(path), 0, {}
    for place in [path, *sorted(path.glob("*/")), *sorted(path.glob("*/*/"))]:
        if str(place / "zarr.json") not in files:
            if place == path:
                raise ValueError("it has no zarr.json")
            continue
        name = place.relative_to(path).as_posix()
        header = read_description(path, name)
        if header.get("node_type") == "array":
            beside, held[name] = _check_array(place, name, header, files)
            at_once += beside
            _check_size("its small variables", at_once, most=_LARGEST_BESIDE)
    return held


def _regular_files(path: Path) -> set[str]:
    """Names of the files of a zarr store; pipes, devices and links to folders are refused."""
    files = set()
    for folder, folders, names in os.walk(path):
        links = [name for name in folders if os.path.islink(os.path.join(folder, name))]
        for name in (os.path.join(folder, each) for each in [*links, *names]):
            state = os.stat(name)
            if not stat.S_ISREG(state.st_mode):
                raise ValueError(f"{os.path.relpath(name, path)} is not a regular file")
            _check_size(os.path.relpath(name, path), state.st_size)
            files.add(name)
    return files


def _check_array(
    place: Path, name: str, header: dict[str, Any], files: Set[str]
) -> tuple[int, tuple[str, int]]:
    """Refuse an array of a zarr store by its description.

    Returns its part of what is read at once, its compression and what a chunk may hold. [byte]
    """
    codecs = [codec.get("name") for codec in header["codecs"]]
    compressions = [codec for codec in codecs if codec in _COMPRESSIONS]
    if not _CODECS.issuperset(codecs) or len(compressions) > 1:
        raise ValueError(f"{name} has the codecs {codecs}")

    shape = [int(length) for length in header["shape"]]
    chunks = [int(length) for length in header["chunk_grid"]["configuration"]["chunk_shape"]]
    kind = header["data_type"]
    if isinstance(kind, str) and kind != "string":
        itemsize = np.dtype(kind).itemsize
    else:  # an object of python for each text
        text = kind["configuration"] if isinstance(kind, dict) else {}
        itemsize = max(_TEXT, text.get("length_bytes", 0))
    if len(chunks) != len(shape) or min([*shape, *chunks], default=1) < 1:
        raise ValueError(f"{name} has the shape {shape} in chunks of {chunks}")
    size = max(math.prod(shape[1:] if name in MAPS else shape), math.prod(chunks)) * itemsize
    _check_size(name, size)

    # a chunk that is missing would be read as the fill value; other programs leave out chunks of
    # zeros, and name chunks in another way
    separator = header["chunk_key_encoding"].get("configuration", {}).get("separator")
    if name in MAPS and separator == ".":
        for trigger in range(shape[0]):
            if f"{place}{os.sep}c.{trigger}.0.0" not in files:
                raise ValueError(f"the map {trigger} of {name} is missing")

    # letters take less than their objects in most texts, and never more than all that is read
    chunk = _LARGEST_BESIDE if "vlen-utf8" in codecs else math.prod(chunks) * itemsize
    held = "".join(compressions), chunk
    return _size_at_once(name, shape, size, chunks), held


def _size_at_once(name: str, shape: Sequence[int], size: int, chunks: Sequence[int] | None) -> int:
    """Part of a variable in what is read when the film is opened; none of arrays like maps."""
    if name in MAPS or len(shape) >= len(FILM["thickness"].dims):
        return 0
    counts = (-(-n // chunk) for n, chunk in zip(shape, chunks or shape, strict=True))
    one_by_one = name.startswith("registration/")  # images
    return (0 if one_by_one else size) + _CHUNK * math.prod(counts)


def _check_size(name: str, size: int, *, most: int = LARGEST_READ) -> None:
    if size > most:
        raise ValueError(f"it claims {size / 1e9:.1f} GB of {name}")
