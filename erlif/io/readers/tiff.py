"""TIFF files: images, stacks, BigTIFF, OME and ImageJ, whatever their suffix."""

from __future__ import annotations

import importlib.util
import logging
import math
import threading
from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path

import numpy as np
import tifffile

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError, reason_of
from erlif.io.readers.base import (
    TRUNCATED,
    Format,
    FrameFile,
    FrameKind,
    describe_shape,
)
from erlif.io.readers.plain_tiff import PlainPage, read_plain_directories, read_plain_page
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source
from erlif.io.readers.strips import NONE, PACKBITS, Segments, read_segments
from erlif.io.readers.tiff_chain import count_directories
from erlif.io.readers.tiff_metadata import read_description

# faults of a file are raised; without a handler Python would print what tifffile logs about them
logging.getLogger("tifffile").addHandler(logging.NullHandler())

_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
"""First bytes of TIFF and of BigTIFF in both byte orders."""

_DENSEST = 1500
"""Pixels per byte of a file that LZW can reach; a header that claims more is damaged."""

_PALETTE = 3
"""Value of the tag PhotometricInterpretation."""

_SEPARATE = 2
"""Value of the tag PlanarConfiguration: each colour by itself."""

_LOSSY = {
    6: "JPEG",
    7: "JPEG",
    33003: "JPEG 2000",
    33005: "JPEG 2000",
    33007: "JPEG",
    34712: "JPEG 2000",
    34887: "LERC",
    34892: "JPEG",
    50001: "WebP",
    50002: "JPEG XL",
    52546: "JPEG XL",
}
"""Values of the tag Compression that need not preserve counts."""

_LONGEST = 64 * 2**20
"""Description that is interpreted; an OME file of 200,000 frames has about 40 MB. [byte]"""


class TiffFrames(FrameFile):
    """The pages of a TIFF file.

    Attributes
    ----------
    headers : list[int]
        Where the directory of each page begins where all pages are plain; else empty. [byte]
    images : int
        Number of images by the description; 0 where it has none.
    stack : tuple[FrameLayout, int] | None
        Layout and place of the first image; None where it is compressed or scattered.
    description : Description
        What OME or ImageJ wrote.
    """

    headers: list[int]
    stack: tuple[FrameLayout, int] | None = None

    def __init__(self, path: Path) -> None:
        self.path, self.headers = path, []
        self._file: tifffile.TiffFile | None = None
        self._source: Source | None = None
        self._pages: list[Segments | tifffile.TiffPage] = []
        self._lock = threading.Lock()
        try:
            text = self._open_plain()
            if not self.headers:
                text = self._open_other()
            self._check_sizes()
            self._describe(text)
        except BaseException:
            self.close()
            raise

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        if self.kinds[index] == TRUNCATED:
            raise FrameError("the file is truncated")
        if self._source is None:
            image = read_plain_page(self.path, self.headers[index])
            if image is None:
                raise FrameError("a strip of the image is damaged")
            return image
        page = self._pages[index]
        if isinstance(page, Segments):
            return read_segments(self._source, page)

        try:
            with self._lock:
                image = np.asarray(page.asarray())
        except Exception as error:  # decoders of damaged bytes raise exceptions of many types
            raise FrameError(_reason(error, page)) from error
        if len(self.kinds[index].shape) == 3 and page.planarconfig == _SEPARATE:
            image = np.moveaxis(image, 0, 2)
        if image.shape != self.kinds[index].shape:
            raise FrameError("the image has another shape than its header")
        return image.astype(image.dtype.newbyteorder("="), copy=False)

    def close(self) -> None:
        """As `FrameFile.close`."""
        for file in (self._file, self._source):
            if file is not None:
                file.close()

    def _open_plain(self) -> bytes:
        """Take the pages as plain ones if all are; the description of the first one."""
        pages, text = read_plain_directories(self.path)
        if pages is not None:
            self.headers = [page.header for page in pages]
            self.kinds = [FrameKind(page.shape, page.dtype) for page in pages]
            self.stack = _contiguous(pages[0])
        return text

    def _open_other(self) -> bytes:
        """Find the pages by tifffile; the description of the first one."""
        # a general reader might follow the chain out of the file, and in circles
        count = count_directories(self.path)
        try:
            self._file = tifffile.TiffFile(self.path)
            self._source = Source(self.path)
            pages = [_full(self._file.pages[k]) for k in range(count)]
            if not pages:
                raise FrameError("the file holds no image")
            self.kinds = [_kind_of(page, self._source.size) for page in pages]
            order = self._file.byteorder
            self._pages = [_segments_of(page, order) or page for page in pages]
            self.bits = _packed_bits(self._pages)
            text = pages[0].description
        except (OSError, FrameError):
            raise
        except Exception as error:  # tifffile raises exceptions of many types on damaged bytes
            raise FrameError(f"the file is damaged or not a TIFF ({reason_of(error)})") from error
        self.stack = _contiguous(self._pages[0])
        return text.encode("utf-8", "replace")

    def _check_sizes(self) -> None:
        """Refuse pages and tiles that claim sizes that no memory holds."""
        size = self.path.stat().st_size
        tiles = {page.part for page in self._pages if isinstance(page, Segments)}
        for shape in {kind.shape for kind in self.kinds} | tiles:
            if math.prod(shape) > _DENSEST * size:
                raise FrameError(
                    f"the file is damaged: {size} bytes cannot hold {describe_shape(shape)} pixels"
                )

    def _describe(self, text: bytes) -> None:
        """Take channels and times from the description."""
        text = text if len(text) <= _LONGEST else b""
        self.description = read_description(text, name=self.path.name, pages=len(self.kinds))
        self.images = self.description.frames
        if self.images in (0, len(self.kinds)):
            self.channels, self.times = self.description.channels, self.description.times


def open_tiff(path: Path) -> FrameFile:
    """Open a TIFF file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    FrameFile

    Raises
    ------
    FrameError
        With the bare reason, if the file is damaged, or its images are no counts.
    """
    file = TiffFrames(path)
    if file.images > 1 == len(file.kinds) and file.stack is not None:
        file.close()
        return _ImageJStack(path, file)
    return file


class _ImageJStack(RawFrames):
    """Images that follow the first one without directories, as ImageJ writes above 4 GB."""

    def __init__(self, path: Path, first: TiffFrames) -> None:
        assert first.stack is not None
        layout, start = first.stack
        step, count = layout.size, first.images
        super().__init__(path, layout, range(start, start + count * step, step))
        self.channels, self.times = first.description.channels, first.description.times


TIFF = Format(
    "TIFF",
    (".tif", ".tiff", ".btf", ".tf8", ".tf2"),
    lambda path, head: head[:4] in _STARTS,
    open_tiff,
)


def _full(page: tifffile.TiffPage | tifffile.TiffFrame) -> tifffile.TiffPage:
    return page if isinstance(page, tifffile.TiffPage) else page.aspage()


def _kind_of(page: tifffile.TiffPage, size: int) -> FrameKind:
    """Kind of a page; refuses pages whose values are no counts."""
    if page.photometric == _PALETTE:
        raise FrameError(
            "it is a palette image, whose values are no counts. Save the raw counts as grey TIFF."
        )
    lossy = _LOSSY.get(int(page.compression))
    if lossy is not None:
        raise FrameError(
            f"its images are compressed with {lossy}, which may change the counts. Save them "
            "uncompressed, or with LZW or deflate."
        )
    if page.dtype is None or page.imagedepth != 1:
        raise FrameError("its images have a type that is not read. Save them as 16-bit grey TIFF.")

    # data behind the end of the file were cut off; a page without data has none at all
    ends = [a + b for a, b in zip(page.dataoffsets, page.databytecounts, strict=False) if a and b]
    if not ends or len(ends) != len(page.dataoffsets) or max(ends) > size:
        return TRUNCATED
    colours = (int(page.samplesperpixel),) if page.samplesperpixel > 1 else ()
    shape = (int(page.imagelength), int(page.imagewidth), *colours)
    return FrameKind(shape, np.dtype(page.dtype).name)


def _segments_of(page: tifffile.TiffPage, order: str) -> Segments | None:
    """The strips or tiles of a page; None where tifffile has to decode it."""
    if page.samplesperpixel != 1 or page.fillorder != 1 or np.dtype(page.dtype).kind not in "iuf":
        return None
    rows, columns = int(page.imagelength), int(page.imagewidth)
    part = (min(int(page.rowsperstrip), rows), columns) if not page.is_tiled else None
    # without LZW or deflate the predictor has no meaning; libtiff writes and reads it so
    predictor = 1 if page.compression in (NONE, PACKBITS) else int(page.predictor)
    found = Segments(
        (rows, columns),
        np.dtype(page.dtype).newbyteorder(order).str,  # type: ignore[arg-type]
        int(page.bitspersample),
        int(page.compression),
        predictor,
        part or (int(page.tilelength), int(page.tilewidth)),
        bool(page.is_tiled),
        tuple(int(n) for n in page.dataoffsets),
        tuple(int(n) for n in page.databytecounts),
    )
    return found if min(found.part) > 0 and found.decodable else None


def _packed_bits(pages: Sequence[Segments | tifffile.TiffPage]) -> int | None:
    """Bits of packed counts; None where counts take whole bytes, which may hold fewer bits."""
    depths = {page.bits if isinstance(page, Segments) else 0 for page in pages}
    return depths.pop() if len(depths) == 1 and not depths & {0, 8, 16, 32, 64} else None


def _contiguous(page: object) -> tuple[FrameLayout, int] | None:
    """Layout and place of an uncompressed page; None where its strips do not follow each other."""
    if isinstance(page, PlainPage):
        dtype, plain = "<" + np.dtype(page.dtype).str[1:], page.compression == NONE
    elif isinstance(page, Segments):
        dtype, plain = page.dtype, page.compression == NONE and not page.padded
        plain = plain and page.bits == 8 * np.dtype(dtype).itemsize
    else:
        return None
    ends = list(accumulate(page.lengths, initial=page.offsets[0]))
    if not plain or ends[:-1] != list(page.offsets):
        return None
    return FrameLayout(page.shape, dtype), page.offsets[0]


def _reason(error: Exception, page: tifffile.TiffPage) -> str:
    """Why a page cannot be decoded, with the package that is missing where one is."""
    text = reason_of(error)
    if "imagecodecs" not in text and not isinstance(error, ModuleNotFoundError):
        return text
    name = getattr(page.compression, "name", page.compression)
    if importlib.util.find_spec("imagecodecs") is None:
        return (
            f"its compression, {name}, needs the Python package imagecodecs, which is not "
            "installed. Install it with: pip install 'erlif[formats]'."
        )
    return (
        f"the installed Python package imagecodecs does not decode its compression, {name}. Save "
        "the images uncompressed, or with LZW or deflate."
    )
