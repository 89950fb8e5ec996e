"""Plain TIFF pages, read straight from their bytes.

Cameras store grey counts in strips, as they are or deflated. Such pages are read here, in a tenth
of the time that a general reader takes. Everything else (tiles, colours, other compression, big
endian, damage) is left to tifffile, which reads the same counts from plain pages.
"""

from __future__ import annotations

import struct
from io import FileIO
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError
from erlif.io.readers.inflate import inflate

_BLOCK = 4096
"""Bytes read at once from a file: a directory with its arrays fits in."""

_BEGINNING = 1024
"""Bytes of a description in which the name of its program occurs."""

_MOST_STRIPS = 1_000_000
"""A directory that claims more is damaged."""

_NONE, _DEFLATE = 1, (8, 32946)
"""Values of the tag Compression."""

_HORIZONTAL = 2
"""Value of the tag Predictor: each count is stored less the one to its left."""

# numbers of the tags after the TIFF 6.0 specification
_WIDTH, _HEIGHT, _BITS, _COMPRESSION = 256, 257, 258, 259
_OFFSETS, _ROWS, _LENGTHS, _PREDICTOR, _DESCRIPTION = 273, 278, 279, 317, 270

_ONLY = {262: (0, 1), 266: (1,), 277: (1,), 284: (1,), 339: (1,)}
"""Tags with the values of plain grey counts: photometric interpretation, fill order, samples per
pixel, planar configuration, sample format."""

_WITHOUT_EFFECT = frozenset(
    (254, 269, 270, 271, 272, 274, 280, 281, 282, 283, 285, 296, 297, 305, 306, 315, 316, 33432)
)
"""Tags that describe the image and do not change how its counts are stored."""

_FORMATS = {3: "H", 4: "I", 16: "Q"}
"""Unsigned whole numbers by the type of a tag: SHORT, LONG, LONG8."""


class PlainPage(NamedTuple):
    """Where the counts of a page lie in its file.

    Attributes
    ----------
    shape : tuple[int, int]
        (rows, columns). [px]
    dtype : str
        "uint8" or "uint16".
    compression : int
        Tag of TIFF: 1 for none, 8 or 32946 for deflate.
    predictor : int
        Tag of TIFF: 1 for none, 2 for differences along the rows.
    rows : int
        Rows of a strip; the last strip may have fewer.
    offsets : tuple[int, ...]
        Where the strips begin. [byte]
    lengths : tuple[int, ...]
        What they take in the file. [byte]
    header : int
        Where the directory of the page begins. [byte]
    description : tuple[int, int]
        Where the text of the tag ImageDescription begins and its length; 0 where there is none, or
        one that lies within the directory. [byte]
    """

    shape: tuple[int, int]
    dtype: str
    compression: int
    predictor: int
    rows: int
    offsets: tuple[int, ...]
    lengths: tuple[int, ...]
    header: int
    description: tuple[int, int] = (0, 0)


class _Layout(NamedTuple):
    """Sizes in the directories of TIFF or of BigTIFF."""

    number: str
    entry: str
    following: str


_CLASSIC, _BIG = _Layout("<H", "<HHI4s", "<I"), _Layout("<Q", "<HHQ8s", "<Q")


def find_plain_pages(path: Path) -> list[PlainPage] | None:
    """Read the directories of a file whose pages are all plain and whole.

    Parameters
    ----------
    path : Path

    Returns
    -------
    list of PlainPage or None
        None where another reader is needed to judge the file.

    Raises
    ------
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> import tempfile, tifffile
    >>> path = Path(tempfile.mkdtemp(), "frame.tif")
    >>> tifffile.imwrite(path, np.zeros((64, 80), np.uint16))
    >>> [page.shape for page in find_plain_pages(path)]
    [(64, 80)]
    >>> tifffile.imwrite(path, np.zeros((64, 80), np.float32))
    >>> find_plain_pages(path) is None
    True
    """
    return read_plain_directories(path)[0]


def read_plain_directories(path: Path) -> tuple[list[PlainPage] | None, bytes]:
    """As `find_plain_pages`, with the description of the first page where OME or ImageJ wrote it.

    Parameters
    ----------
    path : Path

    Returns
    -------
    (list of PlainPage or None, bytes)

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    with path.open("rb", buffering=0) as file:
        source = _File(file)
        start = _first_directory(source)
        if start is None:
            return None, b""

        # directories are a chain; one that bites its tail is damaged
        layout, offset = start
        pages: list[PlainPage] = []
        seen: set[int] = set()
        while offset:
            if offset in seen:
                return None, b""
            seen.add(offset)
            found = _read_directory(source, offset, layout)
            if found is None:
                return None, b""
            page, offset = found
            if max(a + n for a, n in zip(page.offsets, page.lengths, strict=True)) > source.size:
                return None, b""
            pages.append(page)
        if not pages:
            return None, b""
        place, length = pages[0].description
        beginning = bytes(source.read(place, min(length, _BEGINNING)))
        known = beginning.startswith(b"ImageJ=") or b"<OME" in beginning
        return pages, bytes(source.read(place, length)) if known else b""


def read_plain_page(path: Path, header: int) -> AnyArray | None:
    """Read the counts of one page of a file.

    Parameters
    ----------
    path : Path
    header : int
        Where its directory begins. [byte]

    Returns
    -------
    array of uint8 or uint16, (y, x), or None
        None where the page is not plain or not whole.

    Raises
    ------
    OSError
        If the file cannot be opened.
    """
    with path.open("rb", buffering=0) as file:
        return _read_counts(_File(file), header)


def decode_plain_page(data: bytes, header: int) -> AnyArray | None:
    """Read the counts of one page from the bytes of a file.

    Parameters
    ----------
    data : bytes
        The whole file.
    header : int
        Where the directory of the page begins. [byte]

    Returns
    -------
    array of uint8 or uint16, (y, x), or None
        None where the page is not plain or not whole.

    Examples
    --------
    >>> import tempfile, tifffile
    >>> path = Path(tempfile.mkdtemp(), "frame.tif")
    >>> tifffile.imwrite(path, np.full((64, 80), 7, np.uint16), compression="deflate")
    >>> (page,) = find_plain_pages(path)
    >>> int(decode_plain_page(path.read_bytes(), page.header)[63, 79])
    7
    """
    return _read_counts(_Memory(data), header)


class _Source(Protocol):
    """Bytes of a file, from the disk or from memory."""

    def read(self, offset: int, length: int) -> bytes | memoryview:
        """Bytes from an offset on; fewer where the file ends before."""
        ...

    def read_into(self, offset: int, target: npt.NDArray[np.uint8]) -> bool:
        """Fill an array of bytes; False where the file ends before."""
        ...


class _File:
    """An unbuffered file; short reads that lie close together need one system call."""

    def __init__(self, file: FileIO) -> None:
        self.file = file
        self.size = file.seek(0, 2)
        self.start, self.block = 0, b""

    def read(self, offset: int, length: int) -> bytes:
        """As `_Source.read`."""
        length = min(length, self.size - offset)  # a damaged directory may point anywhere
        if length <= 0:
            return b""
        if not self.start <= offset <= offset + length <= self.start + len(self.block):
            self.file.seek(offset)
            block = self.file.read(max(length, _BLOCK))
            while len(block) < length and (more := self.file.read(length - len(block))):
                block += more
            self.start, self.block = offset, block
        return self.block[offset - self.start : offset - self.start + length]

    def read_into(self, offset: int, target: npt.NDArray[np.uint8]) -> bool:
        """As `_Source.read_into`."""
        if offset + target.size > self.size:
            return False
        self.file.seek(offset)
        view = target.data
        while len(view) and (count := self.file.readinto(view)):
            view = view[count:]
        return not len(view)


class _Memory:
    """The bytes of a whole file."""

    def __init__(self, data: bytes) -> None:
        self.view = memoryview(data)

    def read(self, offset: int, length: int) -> memoryview:
        """As `_Source.read`."""
        return self.view[offset : offset + length]

    def read_into(self, offset: int, target: npt.NDArray[np.uint8]) -> bool:
        """As `_Source.read_into`."""
        found = np.frombuffer(self.view[offset : offset + target.size], np.uint8)
        if found.size == target.size:
            target[:] = found
        return found.size == target.size


def _first_directory(source: _Source) -> tuple[_Layout, int] | None:
    """Layout and place of the first directory; None for a file that is not little-endian TIFF."""
    head = source.read(0, 16)
    if head[:4] == b"II*\0" and len(head) >= 8:
        return _CLASSIC, struct.unpack_from("<I", head, 4)[0]
    if head[:8] == b"II+\0\x08\0\0\0" and len(head) == 16:
        return _BIG, struct.unpack_from("<Q", head, 8)[0]
    return None


def _read_counts(source: _Source, header: int) -> AnyArray | None:
    start = _first_directory(source)
    found = None if start is None else _read_directory(source, header, start[0])
    return None if found is None else _decode(source, found[0])


def _read_directory(source: _Source, offset: int, layout: _Layout) -> tuple[PlainPage, int] | None:
    """A page and the place of the next directory, 0 after the last; None where it is not plain."""
    width = struct.calcsize(layout.number)
    head = source.read(offset, width)
    if len(head) < width:
        return None
    entries = struct.unpack(layout.number, head)[0] * struct.calcsize(layout.entry)
    table = source.read(offset + width, entries + struct.calcsize(layout.following))
    if len(table) < entries + struct.calcsize(layout.following):
        return None

    tags: dict[int, tuple[int, ...]] = {}
    description = (0, 0)
    for tag, kind, count, field in struct.iter_unpack(layout.entry, table[:entries]):
        if tag == _DESCRIPTION and count > len(field) and not description[1]:
            description = int.from_bytes(field, "little"), count
        if tag in _WITHOUT_EFFECT:
            continue
        values = _read_values(source, kind, count, field)
        if values is None or tag in tags:
            return None
        tags[tag] = values
    page = _describe(tags, offset)
    if page is None:
        return None
    following = struct.unpack_from(layout.following, table, entries)[0]
    return page._replace(description=description), following


def _read_values(source: _Source, kind: int, count: int, field: bytes) -> tuple[int, ...] | None:
    """Whole numbers of a tag; None for other types and for damage."""
    if kind not in _FORMATS or not 0 < count <= _MOST_STRIPS:
        return None
    form = f"<{count}{_FORMATS[kind]}"
    size = struct.calcsize(form)
    data = (
        field[:size] if size <= len(field) else source.read(int.from_bytes(field, "little"), size)
    )
    return struct.unpack(form, data) if len(data) == size else None


def _describe(tags: dict[int, tuple[int, ...]], header: int) -> PlainPage | None:
    """A page from its tags; None where they are not those of plain grey counts."""
    single = {tag: values[0] for tag, values in tags.items() if len(values) == 1}
    width, height, bits = (single.get(tag, 0) for tag in (_WIDTH, _HEIGHT, _BITS))
    compression, predictor = single.get(_COMPRESSION, _NONE), single.get(_PREDICTOR, 1)
    offsets, lengths = tags.pop(_OFFSETS, ()), tags.pop(_LENGTHS, ())
    rows = min(single.get(_ROWS, height), height)
    if min(width, height) < 2 or rows < 1 or bits not in (8, 16):
        return None

    # every other tag must have a value that leaves the counts plain
    for tag in tags:
        known = tag in (_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _ROWS, _PREDICTOR)
        if tag not in single or not (known or single[tag] in _ONLY.get(tag, ())):
            return None
    if len(offsets) != -(-height // rows) or len(lengths) != len(offsets):
        return None

    page = PlainPage(
        (height, width), f"uint{bits}", compression, predictor, rows, offsets, lengths, header
    )
    if compression == _NONE:
        return page if predictor == 1 and lengths == tuple(_sizes(page)) else None
    return page if compression in _DEFLATE and predictor in (1, _HORIZONTAL) else None


def _sizes(page: PlainPage) -> list[int]:
    """Size of the counts of each strip. [byte]"""
    height, width = page.shape
    row = width * np.dtype(page.dtype).itemsize
    return [min(page.rows, height - first) * row for first in range(0, height, page.rows)]


def _decode(source: _Source, page: PlainPage) -> AnyArray | None:
    """Counts of a page; None where a strip is damaged."""
    counts = np.empty(page.shape, np.dtype(page.dtype).newbyteorder("<"))
    target = counts.reshape(-1).view(np.uint8)
    ends = list(accumulate(page.lengths, initial=page.offsets[0]))
    if page.compression == _NONE and ends[:-1] == list(page.offsets):
        whole = source.read_into(page.offsets[0], target)
        return counts.astype(page.dtype, copy=False) if whole else None

    place = 0
    for offset, length, size in zip(page.offsets, page.lengths, _sizes(page), strict=True):
        part = target[place : place + size]
        place += size
        if page.compression == _NONE:
            if not source.read_into(offset, part):
                return None
            continue
        try:
            strip = inflate(source.read(offset, length), size + 1)
        except FrameError:
            return None
        if len(strip) != size:
            return None
        part[:] = np.frombuffer(strip, np.uint8)

    if page.predictor == _HORIZONTAL:
        np.add.accumulate(counts, axis=1, dtype=counts.dtype, out=counts)
    return counts.astype(page.dtype, copy=False)
