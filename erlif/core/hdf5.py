"""HDF5 files, opened after a child process has survived them; which chunks they hold."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from erlif.core.arrays import Mask
from erlif.core.guarded import check_hdf5
from erlif.core.locking import note_unlocked

_File = TypeVar("_File")

# Registered number of deflate, the bytes that one of its bytes may hold, and what need not be
# looked at. [byte]
_DEFLATE, _DENSEST, _SMALL = 1, 1032, 2**27


def open_hdf5(path: Path) -> Any:
    """Open an HDF5 file for reading.

    Parameters
    ----------
    path : Path

    Returns
    -------
    h5py.File

    Raises
    ------
    ValueError
        With the bare reason, if the library of HDF5 does not survive the file.
    OSError
        If the file is missing, damaged or of another format.

    Examples
    --------
    >>> open_hdf5(Path("pyproject.toml"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    OSError: Unable to synchronously open file (file signature not found)
    """
    import h5py  # takes a tenth of a second to load

    check_hdf5(path)
    return with_locks(h5py.File, path, "r")


def with_locks(opening: Callable[..., _File], *args: Any, **options: Any) -> _File:
    """Open a file of HDF5; without locks where its drive has none.

    The locks are those of HDF5 where it can have them, since files that are open twice in one
    process must agree in them.

    Parameters
    ----------
    opening : callable
        ``h5py.File``, ``h5netcdf.File`` or one derived from them.
    args, options
        Its arguments.

    Returns
    -------
    File

    Raises
    ------
    OSError
        As that of `opening`.
    """
    try:
        return opening(*args, **options)
    except BlockingIOError:  # another program has locked it
        raise
    except OSError:
        file = opening(*args, **options, locking=False)
        note_unlocked()
        return file


# First bytes of a superblock.
SIGNATURE = b"\x89HDF\r\n\x1a\n"


def refuse_elsewhere(name: str, data: Any) -> None:
    """Refuse a dataset whose values are in another file.

    Raises
    ------
    ValueError
        With the bare reason.
    """
    if data.external or data.is_virtual:
        raise ValueError(f"the values of {name} are in another file")


def filters_of(data: Any) -> list[int]:
    """Registered numbers of the compressions of a dataset.

    Parameters
    ----------
    data : h5py.Dataset

    Returns
    -------
    list of int
    """
    settings = data.id.get_create_plist()
    return [settings.get_filter(n)[0] for n in range(settings.get_nfilters())]


def chunk_count(data: Any) -> int:
    """Number of chunks that a whole dataset has.

    Parameters
    ----------
    data : h5py.Dataset
        In chunks.

    Returns
    -------
    int
    """
    return math.prod(_chunk_grid(data))


def chunk_size(data: Any) -> int:
    """Size of a decoded chunk of a dataset; 0 where it has none. [byte]"""
    return math.prod(map(int, data.chunks or (0,))) * int(data.dtype.itemsize)


def refuse_inflated(data: Any, first: Any = slice(None)) -> None:
    """Refuse compressed chunks that hold more than their dataset states, before they are read.

    The library would decompress them to their end: 3 MB of a file may hold 3 GB.

    Parameters
    ----------
    data : h5py.Dataset
    first : int, slice or array
        What is read of the first axis.

    Raises
    ------
    OSError
        With the bare reason, as the library raises it for damaged chunks.
    """
    deflated = filters_of(data).count(_DEFLATE)
    if data.chunks is None or not deflated:
        return
    if deflated > 1:
        raise OSError(f"{data.name} is compressed twice")
    rows = np.unique(np.atleast_1d(np.arange(data.shape[0])[first]) // data.chunks[0])
    size = chunk_size(data)
    for place in np.ndindex(len(rows), *_chunk_grid(data)[1:]):
        corner = tuple(np.multiply((rows[place[0]], *place[1:]), data.chunks).tolist())
        if data.id.get_chunk_info_by_coord(corner).size * _DENSEST <= _SMALL:
            continue
        skipped, stored = data.id.read_direct_chunk(corner)
        if skipped:
            continue
        try:
            held = len(zlib.decompressobj().decompress(stored, size + 1))
        except zlib.error as error:
            raise OSError(f"a chunk of {data.name} is damaged") from error
        if held > size:
            raise OSError(f"a chunk of {data.name} holds more than the {size} bytes it states")


def find_chunks(data: Any) -> Mask:
    """Find the chunks of a dataset that its file holds.

    The library returns the fill value for a chunk that was never written, or whose place in the
    index of the file is damaged.

    Parameters
    ----------
    data : h5py.Dataset

    Returns
    -------
    array of bool
        Whether the file holds a chunk, once and in a possible size, at each place of the grid of
        chunks; a single value for a dataset without chunks.
    """
    if data.chunks is None:
        return np.array(data.id.get_storage_size() >= data.size * data.dtype.itemsize)

    stored = np.zeros(_chunk_grid(data), np.int64)
    plain = chunk_size(data)
    skipped = (1 << len(filters_of(data))) - 1

    # the callback is called for every map of a long run, so that it collects and computes nothing
    chunks: list[tuple[Any, ...]] = []

    def collect(chunk: Any) -> None:
        chunks.append((*chunk.chunk_offset, chunk.filter_mask, chunk.size))

    data.id.chunk_iter(collect)
    table = np.array(chunks, np.int64).reshape(len(chunks), data.ndim + 2)
    places, between = np.divmod(table[:, :-2], data.chunks)
    # a chunk that no filter has changed has its own size
    whole = (table[:, -2] & skipped != skipped) | (table[:, -1] == plain)
    whole &= ~between.any(axis=1)
    inside = ((places >= 0) & (places < stored.shape)).all(axis=1)

    # a place that is named twice belongs to no chunk for sure
    np.add.at(stored, tuple(places[inside].T), np.where(whole[inside], 1, 2))
    once: Mask = stored == 1
    return once


def _chunk_grid(data: Any) -> list[int]:
    return [-(-length // chunk) for length, chunk in zip(data.shape, data.chunks, strict=True)]
