"""Strips and tiles of a TIFF page to an image: compression, packed bits, differences.

`tifffile` finds the strips; it decodes other compressions itself, with `imagecodecs` where that is
installed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError
from erlif.io.readers.inflate import inflate
from erlif.io.readers.source import Source

NONE, LZW, PACKBITS, DEFLATE = 1, 5, 32773, (8, 32946)
"""Values of the tag Compression that are decoded here."""

_HORIZONTAL = 2
"""Value of the tag Predictor: each count is stored less the one to its left."""


@dataclass(frozen=True)
class Segments:
    """Where the strips or tiles of a page lie, and how they are stored.

    Attributes
    ----------
    shape : tuple[int, int]
        (rows, columns) of the page. [px]
    dtype : str
        Type of a decoded count, with its byte order: ">u2".
    bits : int
        Bits that a count takes in the file.
    compression : int
        Tag of TIFF.
    predictor : int
        Tag of TIFF: 1 for none, 2 for differences along the rows.
    part : tuple[int, int]
        (rows, columns) of a strip or tile; the last strip may have fewer rows. [px]
    padded : bool
        Whether the parts at the edges are stored in full, as tiles are.
    offsets : tuple[int, ...]
        Where the parts begin, row by row. [byte]
    lengths : tuple[int, ...]
        What they take in the file. [byte]
    """

    shape: tuple[int, int]
    dtype: str
    bits: int
    compression: int
    predictor: int
    part: tuple[int, int]
    padded: bool
    offsets: tuple[int, ...]
    lengths: tuple[int, ...]

    @property
    def decodable(self) -> bool:
        """Whether `read_segments` decodes this page."""
        kind, size = np.dtype(self.dtype).kind, 8 * np.dtype(self.dtype).itemsize
        packed = kind == "u" and 8 < self.bits < size == 16
        differences = self.predictor == _HORIZONTAL and kind in "iu" and self.bits == size
        return (
            self.compression in (NONE, LZW, PACKBITS, *DEFLATE)
            and (self.bits == size or packed)
            and (self.predictor == 1 or differences)
            and len(self.offsets) == len(self.lengths) == math.prod(self._grid)
        )

    @property
    def _grid(self) -> tuple[int, int]:
        """Strips or tiles along rows and columns."""
        (rows, columns), (height, width) = self.shape, self.part
        return -(-rows // height), -(-columns // width)


def read_segments(source: Source, page: Segments) -> AnyArray:
    """Decode a page.

    Parameters
    ----------
    source : Source
        File that holds the strips.
    page : Segments
        A page that is `decodable`.

    Returns
    -------
    array, (y, x)
        In the byte order of the machine. [DN]

    Raises
    ------
    FrameError
        With the bare reason, if a strip is damaged.
    """
    image = np.empty(page.shape, page.dtype)
    height, width = page.part
    corners = [
        (y, x) for y in range(0, page.shape[0], height) for x in range(0, page.shape[1], width)
    ]
    for (y, x), offset, length in zip(corners, page.offsets, page.lengths, strict=True):
        rows = height if page.padded else min(height, page.shape[0] - y)
        part = _decode(source.read(offset, length), page, (rows, width))
        part = part[: page.shape[0] - y, : page.shape[1] - x]
        image[y : y + part.shape[0], x : x + part.shape[1]] = part
    return image.astype(image.dtype.newbyteorder("="), copy=False)


def _decode(data: bytes, page: Segments, shape: tuple[int, int]) -> AnyArray:
    """One strip or tile; rows begin at a byte."""
    rows, columns = shape
    row = -(-columns * page.bits // 8)
    stored = _decompressor(page.compression)(data, rows * row).reshape(rows, row)

    dtype = np.dtype(page.dtype)
    if page.bits < 8 * dtype.itemsize:
        return _expand(stored, columns, page.bits)
    part = stored.view(dtype)
    if page.predictor == _HORIZONTAL:
        # whole numbers wrap round, as they did when the differences were taken
        part = np.add.accumulate(part, axis=1, dtype=dtype.newbyteorder("="))
    return part


def _expand(stored: AnyArray, columns: int, bits: int) -> AnyArray:
    """Rows of packed counts, the highest bit first."""
    if bits == 12 and columns % 2 == 0:
        # imported here because it loads numba, which plain counts do without
        from erlif.io.readers.unpack import Packing, unpack

        counts = unpack(stored.reshape(-1), stored.shape[0] * columns, Packing.HIGH_12)
        return counts.reshape(-1, columns)

    # other depths are rare: bit by bit
    single = np.unpackbits(stored, axis=1)[:, : columns * bits].reshape(-1, columns, bits)
    powers = (1 << np.arange(bits)[::-1]).astype(np.uint16)
    return np.asarray(single @ powers)


def _decompressor(compression: int) -> Callable[[bytes, int], AnyArray]:
    if compression == LZW:
        from erlif.io.readers.lzw import decode_lzw  # loads numba

        return decode_lzw
    if compression == PACKBITS:
        from erlif.io.readers.lzw import decode_packbits

        return decode_packbits
    return _as_it_is if compression == NONE else _inflate


def _as_it_is(data: bytes, size: int) -> AnyArray:
    if len(data) < size:
        raise FrameError("a strip of the image is too short")
    return np.frombuffer(data, np.uint8, size)


def _inflate(data: bytes, size: int) -> AnyArray:
    try:
        found = inflate(data, size + 1)  # one more, so that the end is found and its checksum
    except FrameError as error:
        raise FrameError(f"a strip of the image is damaged ({error})") from error
    if len(found) < size:
        raise FrameError("a strip of the image is damaged (deflate)")
    return np.frombuffer(found, np.uint8, size)
