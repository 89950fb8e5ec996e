"""TIFF files: images, stacks, BigTIFF, OME and ImageJ, whatever their suffix.

tifffile reads the pages and deflate, libtiff decompresses LZW, and imagecodecs all else; tifffile
needs it for LZW as well. Before them go the checks without which a damaged or hostile file would
take minutes or gigabytes: of the chain of directories, and of the sizes that each of them claims.
"""

from __future__ import annotations

import io
import logging
import math
import struct
import threading
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tifffile

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError, reason_of
from erlif.io.readers import base
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source
from erlif.io.readers.tiff_metadata import Description, read_description

# faults of a file are raised; without a handler Python would print what tifffile logs about them
logging.getLogger("tifffile").addHandler(logging.NullHandler())

# First bytes of TIFF and of BigTIFF in both byte orders.
_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

# Sizes of the values of an entry by its type; TIFF 6.0, section 2, and BigTIFF. [byte]
_TYPE_SIZES = dict(enumerate((0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8)))

# Entries of unknown type in a directory; later versions of the format may add some.
_MOST_UNKNOWN = 16

# Decoded bytes per byte of a file that LZW can reach; a header that claims more is damaged.
_DENSEST = 3000

# Tag PhotometricInterpretation; its values for inverted grey, a palette, and a colour for each
# pixel (Bayer).
_PHOTOMETRIC, _INVERTED, _PALETTE, _MOSAIC = 262, 0, 3, 32803

# Tag that describes the colours of the pixels of a mosaic.
_MOSAIC_COLOURS = 33421

_DAY = 86400.0  # [s]

# Tag of MetaMorph with six numbers for each plane of a stack that has one directory.
_PLANES = 33629

# Value of the tag PlanarConfiguration: each colour by itself.
_SEPARATE = 2

# Values of the tag Compression with which the tag Predictor has no meaning.
_NONE, _PACKBITS = 1, 32773

# Compressions that need no other package: none, deflate by both of its numbers, and PackBits.
_OF_TIFFFILE = (_NONE, 8, 32946, _PACKBITS)

# Value of the tag Compression for LZW.
_LZW = 5

# Tags of place and size of the strips, and formats of whole numbers by their type.
_OFFSET, _SIZE = 273, 279
_WHOLE = {3: "H", 4: "I", 16: "Q"}

# Tags that describe an image in words and its resolution.
_WORDS = {270, 271, 272, 282, 283, 285, 305, 306, 315, 316}

# Values of the tag Compression that need not preserve counts.
_LOSSY = {
    **dict.fromkeys((6, 7, 33007, 34892), "JPEG"),
    **dict.fromkeys((33003, 33005, 34712), "JPEG 2000"),
    **dict.fromkeys((50002, 52546), "JPEG XL"),
    34887: "LERC",
    50001: "WebP",
}

# Description that is interpreted; an OME file of 200,000 frames has about 40 MB. [byte]
_LONGEST = 64 * 2**20


class TiffFrames(base.FrameFile):
    """The pages of a TIFF file.

    Attributes
    ----------
    description : Description
        Images, channels and times that OME or ImageJ wrote.
    stack : tuple[FrameLayout, int] | None
        Layout and place of the first image; None where it is compressed or scattered.
    """

    _file: tifffile.TiffFile | None = None

    def __init__(self, path: Path) -> None:
        with Source(path) as source:
            directories, size = _find_directories(source), source.size
        if not directories:
            raise FrameError("the file holds no image")
        self._places = [one.place for one in directories]
        self._lock = threading.RLock()
        try:
            with np.errstate(all="ignore"):  # of numbers in damaged tags
                self._file = tifffile.TiffFile(path)
            self.kinds = self._read_kinds(directories, size)
            first = self._page(0)
            if not _is_plain(first):
                import imagecodecs  # noqa: F401 -- its absence is named when the file is opened

            self.stack = _contiguous(first, self._file.byteorder)
            bits = int(first.bitspersample)
            self.bits = bits if 8 < bits < 16 else None
            text = first.description.encode("utf-8", "replace")
            self.description = read_description(
                text if len(text) <= _LONGEST else b"", name=path.name, pages=len(self.kinds)
            )
            if _PLANES in first.tags:
                self.description = _read_planes(path, first.tags[_PLANES], self._file.byteorder)
            whole = len(self.kinds) == len(directories)  # without previews
            if whole and self.description.frames in (0, len(self.kinds)):
                self.channels, self.times = self.description.channels, self.description.times
                self.serial = self.description.serial
        except (OSError, FrameError, ModuleNotFoundError):
            self.close()
            raise
        except Exception as error:  # tifffile raises exceptions of many types on damaged bytes
            self.close()
            raise FrameError(f"the file is damaged or not a TIFF ({reason_of(error)})") from error

    def _read_kinds(self, directories: Sequence[_Directory], size: int) -> list[base.FrameKind]:
        """Kinds of all pages but previews; those whose directories are alike are read once."""
        known: dict[bytes, tuple[base.FrameKind, bool]] = {}
        found = []
        for k, one in enumerate(directories):
            entry = known.get(one.alike) if one.end <= size else None
            if entry is None:
                page = self._page(k)
                entry = _kind_of(page, size), bool(page.is_reduced)
                if one.alike and entry[0] != base.TRUNCATED:
                    known[one.alike] = entry
            found.append(entry)
        kept = [k for k, (_, is_preview) in enumerate(found) if not is_preview]
        kept = _without_previews([kind for kind, _ in found], kept or list(range(len(found))))
        self._places = [self._places[k] for k in kept]
        return [found[k][0] for k in kept]

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        kind = self.kinds[index]
        if kind == base.TRUNCATED:
            raise FrameError("the file is truncated")
        try:
            # threads share one place in the file: each holds it while it reads, not to decode
            with self._lock:
                page = self._page(index)
            if _is_plain_lzw(page):
                image = self._read_lzw(page)
            else:
                image = np.asarray(page.asarray(lock=self._lock, maxworkers=1))
        except Exception as error:  # as above
            raise FrameError(f"a strip of the image is damaged ({reason_of(error)})") from error
        if len(kind.shape) == 3 and page.planarconfig == _SEPARATE:
            image = np.moveaxis(image, 0, 2)
        if image.shape != kind.shape:
            raise FrameError("the image has another shape than its header")
        return image.astype(kind.dtype, copy=False)

    def _read_lzw(self, page: tifffile.TiffPage) -> AnyArray:
        """Counts of a page by libtiff; damaged LZW data may end the process in imagecodecs."""
        import cv2  # loads slowly, and few files need it

        # faults are raised; OpenCV would print them as well
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
        assert self._file is not None
        segments = []
        with self._lock:
            for offset, size in zip(page.dataoffsets, page.databytecounts, strict=True):
                self._file.filehandle.seek(offset)
                segments.append(self._file.filehandle.read(size))

        # the data of the page, as they are, in a file of this page alone
        tiled = {"tile": (page.tilelength, page.tilewidth)}
        whole = io.BytesIO()
        tifffile.imwrite(
            whole,
            iter(segments),
            shape=page.shape,
            dtype=page.dtype,
            byteorder=self._file.byteorder,
            compression=page.compression,
            predictor=page.predictor,
            photometric="minisblack",
            metadata=None,
            **(tiled if page.is_tiled else {"rowsperstrip": page.rowsperstrip}),
        )
        image = cv2.imdecode(np.frombuffer(whole.getbuffer(), np.uint8), cv2.IMREAD_UNCHANGED)
        if image is None:
            raise FrameError("its LZW data are damaged")
        return np.asarray(image)

    def close(self) -> None:
        """As `FrameFile.close`."""
        if self._file is not None:
            self._file.close()

    def _page(self, index: int) -> tifffile.TiffPage:
        """Read a directory; a list of all pages would take gigabytes for a long recording."""
        assert self._file is not None
        first = self._file.pages.first  # read when the file was opened
        if self._places[index] == first.offset:
            page = first
        else:
            self._file.filehandle.seek(self._places[index])
            page = tifffile.TiffPage(self._file, index=index)
        if page.compression in (_NONE, _PACKBITS):
            page.predictor = 1  # libtiff writes and reads it so
        return page


def _is_plain(page: tifffile.TiffPage) -> bool:
    """Whether tifffile reads a page by itself."""
    return page.compression in _OF_TIFFFILE and page.bitspersample in (8, 16, 32, 64)


def _is_plain_lzw(page: tifffile.TiffPage) -> bool:
    """Whether the counts of a page are compressed by LZW, in whole bytes of the usual order."""
    return (
        page.compression == _LZW
        and page.dtype in (np.dtype(np.uint8), np.dtype(np.uint16))
        and page.bitspersample == 8 * page.dtype.itemsize
        and len(page.shape) == 2
        and page.fillorder == 1
        and page.predictor in (1, 2)
    )


def open_tiff(path: Path) -> base.FrameFile:
    """Open a TIFF file.

    As `Format.open`: FrameError if the file is damaged, or its images are no counts.
    """
    file = TiffFrames(path)
    described = file.description
    several = len(file.kinds) > 1
    if described.frames in (0, 1, len(file.kinds)) or (several and not described.whole):
        return file

    # images follow the first one without directories, as MetaMorph and ImageJ (4 GB) write them
    file.close()
    if several or file.stack is None:
        raise FrameError(
            f"it holds {described.frames} images, and directories for {len(file.kinds)}. Save it "
            "as an uncompressed TIFF with a directory for each image."
        )
    layout, start = file.stack
    places = layout.in_a_row(start, described.frames)
    stack = RawFrames(path, layout, places, find_times=lambda raw: described.times)
    stack.channels = described.channels
    return stack


TIFF = base.Format(
    "TIFF",
    (".tif", ".tiff", ".btf", ".tf8", ".tf2"),
    lambda path, head: head[:4] in _STARTS,
    open_tiff,
    extra="formats",
)


class _Directory(NamedTuple):
    """A directory of a file.

    Attributes
    ----------
    place : int
    alike : bytes
        The same in directories whose pages are of one kind; empty where the directory alone does
        not show it.
    end : int
        End of the only strip.
    """

    place: int
    alike: bytes
    end: int


def _find_directories(source: Source) -> list[_Directory]:
    """The whole directories of a file, before the first that is cut off.

    A damaged file may chain thousands of directories through its own pixels, each with thousands
    of entries. Directories that do not overlap take no more than the file; those that do, or that
    form a ring, are refused.
    """
    head = source.read(0, min(16, source.size))
    order = {b"II": "<", b"MM": ">"}.get(head[:2], "")
    if not order or len(head) < 8:
        raise FrameError("the file is damaged or not a TIFF")
    big = struct.unpack_from(f"{order}H", head, 2)[0] == 43
    if big and len(head) < 16:
        raise FrameError("the file is truncated")
    number, entry, following = (
        struct.Struct(order + form)
        for form in (("Q", "HHQ8s", "Q") if big else ("H", "HHI4s", "I"))
    )
    alike: dict[bytes, bytes] = {}
    (place,) = following.unpack_from(head, 8 if big else 4)

    found: list[_Directory] = []
    taken = 0
    while place and place + number.size <= source.size:
        (entries,) = number.unpack(source.read(place, number.size))
        size = entries * entry.size
        start = place + number.size
        if start + size + following.size > source.size:
            break
        table = source.read(start, size + following.size)
        unknown = 0
        for _, kind, count, _ in entry.iter_unpack(table[:size]):
            unknown += not _TYPE_SIZES.get(kind)
            if count * _TYPE_SIZES.get(kind, 0) > source.size or unknown > _MOST_UNKNOWN:
                raise FrameError("the file is damaged: a directory is no list of entries")

        (after,) = following.unpack_from(table, size)
        text, end = _sign(table[:size], order, entry) if found or after else (b"", 0)
        found.append(_Directory(place, alike.setdefault(text, text), end))
        place = after
        taken += number.size + len(table)
        if taken > source.size or len(found) > base.MOST_FRAMES:
            raise FrameError("the file is damaged: its directories form a ring or overlap")
    return found


def _sign(table: bytes, order: str, entry: struct.Struct) -> tuple[bytes, int]:
    """`_Directory.alike` and `_Directory.end` of the entries of a directory."""
    step, strip = entry.size, {_OFFSET: 0, _SIZE: 0}
    left = bytearray(table)
    for n, (tag, kind, count, value) in enumerate(entry.iter_unpack(table)):
        inside = count * _TYPE_SIZES.get(kind, 0) <= len(value)
        if tag in strip and count == 1 and inside and kind in _WHOLE:
            strip[tag] = struct.unpack_from(order + _WHOLE[kind], value)[0]
        if tag == _OFFSET or (tag in _WORDS and not inside):
            left[(n + 1) * step - len(value) : (n + 1) * step] = bytes(len(value))
        elif not inside:
            return b"", 0
    start, size = strip.values()
    return (bytes(left), start + size) if start and size else (b"", 0)


def _kind_of(page: tifffile.TiffPage, size: int) -> base.FrameKind:
    """Kind of a page; refuses values that are no counts, and sizes that no memory holds."""
    if page.photometric == _PALETTE:
        raise FrameError(
            "it is a palette image, whose values are no counts. Save the raw counts as grey TIFF."
        )
    if page.photometric == _INVERTED and _PHOTOMETRIC in page.tags:
        raise FrameError(
            "it is marked as inverted (MINISWHITE): its counts are, or its look-up table is. Save "
            "the raw counts as grey TIFF in which black is zero; in ImageJ, Image > Lookup Tables "
            "> Grays removes an inverted table."
        )
    if page.photometric == _MOSAIC or _MOSAIC_COLOURS in page.tags:
        raise base.colour_camera("image")
    lossy = _LOSSY.get(int(page.compression))
    if lossy is not None:
        raise FrameError(
            f"its images are compressed with {lossy}, which may change the counts. Save them "
            "uncompressed, or with LZW or deflate."
        )
    if page.dtype is None or page.imagedepth != 1:
        raise FrameError("its images have a type that is not read. Save them as 16-bit grey TIFF.")

    colours = (int(page.samplesperpixel),) if page.samplesperpixel > 1 else ()
    shape = (int(page.imagelength), int(page.imagewidth), *colours)
    tile = (int(page.tilelength), int(page.tilewidth)) if page.is_tiled else ()
    kind = base.FrameKind(shape, np.dtype(page.dtype).name)
    for claimed in (kind, base.FrameKind(tile or shape, kind.dtype)):
        base.check_claim(1, claimed, size, packing=_DENSEST)

    # data behind the end of the file were cut off; a page without data has none at all
    counts = page.databytecounts
    ends = [a + b for a, b in zip(page.dataoffsets, counts, strict=False) if a and b]
    if not ends or len(ends) != len(page.dataoffsets) or max(ends) > size:
        return base.TRUNCATED
    if page.is_contiguous and sum(counts) < page.nbytes:
        return base.TRUNCATED
    return kind


def _without_previews(kinds: Sequence[base.FrameKind], pages: list[int]) -> list[int]:
    """Pages but those that are smaller by a whole number than most: previews without a mark."""
    shapes = Counter(kinds[k].shape for k in pages)
    full = max(shapes, key=lambda shape: (math.prod(shape), shape))
    others = set(shapes) - {full, base.TRUNCATED.shape}
    reduced = all(
        len(shape) == len(full) and all(a % b == 0 for a, b in zip(full, shape, strict=True))
        for shape in others
    )
    if not reduced or shapes[full] < sum(shapes[shape] for shape in others):
        return pages
    return [k for k in pages if kinds[k].shape not in others]


def _read_planes(path: Path, tag: tifffile.TiffTag, order: str) -> Description:
    """Number and times of the planes that MetaMorph writes behind one directory."""
    planes = int(tag.count)
    with Source(path) as source:
        numbers = np.frombuffer(source.read(tag.valueoffset, 24 * planes), f"{order}u4")
    _, _, day, millisecond, _, _ = numbers.reshape(-1, 6).T.astype(np.int64)
    times = _DAY * (day - day[0]) + 1e-3 * (millisecond - millisecond[0])
    return Description(planes, None, times if (np.diff(times) > 0).all() else None, whole=True)


def _contiguous(page: tifffile.TiffPage, order: str) -> tuple[FrameLayout, int] | None:
    """Layout and place of an uncompressed page; None where its strips do not follow each other."""
    if not page.is_contiguous or page.samplesperpixel != 1 or page.fillorder != 1:
        return None
    dtype = np.dtype(page.dtype).newbyteorder(order)  # type: ignore[arg-type]
    shape = (int(page.imagelength), int(page.imagewidth))
    return FrameLayout(shape, dtype.str), int(page.dataoffsets[0])
