"""HDF5 files, checked for damages at which the library of HDF5 does not end or takes the memory.

Layouts are those of the HDF5 File Format Specification, version 3 (The HDF Group), sections II.A
(superblock) and III.E (global heap).
"""

from __future__ import annotations

import math
import mmap
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import Mask

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""First bytes of a superblock."""

_LAST_PLACE = 2**20
"""Largest place of a superblock that is looked at; it stands at 0, 512, 1024, 2048, ... [byte]"""

_OLD_VERSIONS = {0: 24, 1: 28}
"""Place of the addresses in the superblock, for versions that have a driver block. [byte]"""

_LENGTHS = {0: 14, 1: 14, 2: 10, 3: 10}
"""Place of the size of a length in the superblock by its version. [byte]"""

_VARIABLE_KIND, _SEQUENCE = 3, 0
"""Place and value of the kind of a type of variable length, in its encoded form."""

_HEAP = re.compile(b"GCOL\x01\0\0\0")
"""Start of a collection of a global heap."""


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
        With the bare reason, if the superblock names a block of a driver: the library takes as
        much memory as this block claims, and a file in one piece has none.
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

    with path.open("rb") as file:
        place = _find_superblock(file)
        file.seek(place)
        block = file.read(96)
    start = _OLD_VERSIONS.get(block[8]) if len(block) == 96 else None
    if start is not None:
        size = block[13]  # of an address
        driver = block[start + 3 * size : start + 4 * size]
        if driver.strip(b"\xff"):
            raise ValueError("its superblock names a block of a driver, as parts of a file do")
    return h5py.File(path, "r")


def check_variable_lengths(file: Any) -> None:
    """Refuse a file whose values of variable length the library does not survive.

    They lie in global heaps; the library searches without end in one whose free space has no size.
    A type of variable length that is neither text nor a sequence ends the process. Attributes and
    datasets of variable length are read after this check alone.

    Parameters
    ----------
    file : h5py.File
        Opened for reading; chunks of its datasets are not searched for heaps.

    Raises
    ------
    ValueError
        With the bare reason.
    """
    for kind in _types(file):
        _check_type(kind)
    with Path(file.filename).open("rb") as raw:
        place = _find_superblock(raw)
        raw.seek(place)
        block = raw.read(16)
        length = block[_LENGTHS.get(block[8], 14)]
        with mmap.mmap(raw.fileno(), 0, access=mmap.ACCESS_READ) as content:
            for start, end in _between_chunks(file, len(content)):
                for found in _HEAP.finditer(content, start, end):
                    _check_collection(content, found.start(), length)


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

    found = np.zeros(_chunk_grid(data), np.int64)
    plain = math.prod(data.chunks) * data.dtype.itemsize
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
    inside = ((places >= 0) & (places < found.shape)).all(axis=1)

    # a place that is named twice belongs to no chunk for sure
    np.add.at(found, tuple(places[inside].T), np.where(whole[inside], 1, 2))
    once: Mask = found == 1
    return once


def _chunk_grid(data: Any) -> list[int]:
    return [-(-length // chunk) for length, chunk in zip(data.shape, data.chunks, strict=True)]


def _types(file: Any) -> Iterator[Any]:
    """Types of all datasets and attributes of a file."""
    import h5py

    items: list[Any] = [file]
    file.visititems(lambda name, item: items.append(item))
    for item in items:
        if isinstance(item, h5py.Dataset):
            yield item.id.get_type()
        for number in range(h5py.h5a.get_num_attrs(item.id)):
            yield h5py.h5a.open(item.id, index=number).get_type()


def _check_type(kind: Any) -> None:
    """Refuse a type of variable length that is neither text nor a sequence, also within others."""
    import h5py

    if isinstance(kind, h5py.h5t.TypeCompoundID):
        for number in range(kind.get_nmembers()):
            _check_type(kind.get_member_type(number))
    elif isinstance(kind, h5py.h5t.TypeArrayID):
        _check_type(kind.get_super())
    elif isinstance(kind, h5py.h5t.TypeVlenID):
        if kind.encode()[_VARIABLE_KIND] & 0x0F != _SEQUENCE:  # text has a class of its own
            raise ValueError("it has values of an unknown variable length")
        _check_type(kind.get_super())


def _find_superblock(raw: Any) -> int:
    """Place of the superblock; 0 where there is none."""
    place = 0
    while place <= _LAST_PLACE:
        raw.seek(place)
        if raw.read(len(SIGNATURE)) == SIGNATURE:
            return place
        place = max(2 * place, 512)
    return 0


def _between_chunks(file: Any, size: int) -> list[tuple[int, int]]:
    """Parts of a file without the values of its datasets, which may be gigabytes."""
    import h5py

    if file.userblock_size:  # versions of the library disagree on what places then count from
        return [(0, size)]

    chunks: list[tuple[int, int]] = []

    def collect(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.chunks is not None:
            item.id.chunk_iter(
                lambda chunk: chunks.append((chunk.byte_offset, chunk.byte_offset + chunk.size))
            )
        elif isinstance(item, h5py.Dataset) and item.id.get_offset() is not None:
            start = item.id.get_offset()
            chunks.append((start, start + item.id.get_storage_size()))

    file.visititems(collect)
    parts, last = [], 0
    for start, end in sorted(chunks):
        if last < start <= end <= size:
            parts.append((last, start))
        if start <= end <= size:
            last = max(last, end)
    return [*parts, (last, size)]


def _check_collection(content: mmap.mmap, start: int, length: int) -> None:
    """Follow the objects of one collection, as the library does, where that has an end.

    All else that is wrong with a collection the library finds itself; space that was given back
    may begin like one and hold other values behind.
    """
    end = start + _number(content, start + 8, length)
    place = start + _aligned(8 + length)
    head = _aligned(8 + length)  # of an object: index, references, 4 reserved bytes, size
    while place + head <= min(end, len(content)):
        index, size = _number(content, place, 2), _number(content, place + 8, length)
        # the size of free space counts its head, that of an object does not; sums are of 64 bits
        step = (head + _aligned(size) if index else size) % 2**64
        if step == 0:
            raise ValueError("a heap of it has free space of no size")
        place += step


def _aligned(size: int) -> int:
    return -(-size // 8) * 8


def _number(content: mmap.mmap, place: int, size: int) -> int:
    return int.from_bytes(content[place : place + size], "little")
