"""LaVision IM7 images and SET folders, of DaVis 7 and later.

An IM7 file holds the frames of one trigger, those of all cameras: frame k of the file is camera k,
or exposure k of a double frame. A SET file stands beside a folder of the same name with an IM7
file for each trigger. Counts are stored plain, in 12 bits, or compressed without loss in two ways.
The structure is that of the ReadIMX library, which LaVision distributes with DaVis.
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import FrameError
from erlif.io.readers.base import DEFLATED, Format, FrameFile, FrameKind, check_claim, read_header
from erlif.io.readers.raw import FrameLayout, Packing, RawFrames, unpack
from erlif.io.readers.source import Source

_HEADER_SIZE = 256

# Values of the packing.
_PLAIN, _IMX, _ZLIB, _BITS_12 = 0, 1, 2, 3

# Type of a plain count by the format of the buffer; compressed bytes are stored as words.
_TYPES = {-2: "|u1", -3: "<f4", -4: "<u2", 0: "<u2"}

# Decoded over stored size that the compressions can reach.
_DENSEST = {_IMX: 4.0, _ZLIB: DEFLATED}

# Attributes with the time of a frame from the start of the recording, and from its trigger.
_TIME = re.compile(
    rb"AcqTime(Series)?([0-9]{1,2})=(-?[0-9]{1,15}(?:\.[0-9]{1,9})?) ?([^\0-\x20;]{0,3})"
)

# The same time from the trigger, as a number of 64 bits behind a name that is filled to four bytes.
# [us]
_DELAY = re.compile(rb"Acq\.Time(?:([0-9])\0{3}|([0-9]{2})\0\0)(.{8})", re.DOTALL)

# Spellings of the only unit that DaVis writes; older versions leave it out.
_MICROSECONDS = (b"", b"us", "µs".encode("latin-1"), "µs".encode(), "μs".encode())

# End of a file in which the attributes are looked for. [byte]
_LONGEST_END = 2**18

# Files of a SET folder above which it is refused.
_MOST_FILES = 200_000


class CompressedImage(FrameFile):
    """The frames of an IM7 file that are decoded from its start.

    Parameters
    ----------
    path : Path
    header : object
        The fields of lavision in headers.toml.
    """

    def __init__(self, path: Path, header: Any) -> None:
        self.packing = header.packing
        dtype = "float32" if header.format == -3 else "uint16"
        kind = FrameKind((header.rows, header.columns), dtype)
        packing = _DENSEST.get(header.packing, 16 / 12)
        check_claim(header.frames, kind, path.stat().st_size, packing=packing)
        self.kinds = [kind] * header.frames
        self._source = Source(path)

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        kind = self.kinds[index]
        if self.packing == _BITS_12:
            return self._read_12_bits(kind, index)

        # both compressions go through the frames before; the checksum of zlib is behind all frames
        pixels = kind.shape[0] * kind.shape[1]
        if self.packing == _ZLIB:
            counts = self._read_zlib(np.dtype(kind.dtype), len(self.kinds) * pixels)
        else:
            counts = self._read_imx((index + 1) * pixels)
        return np.array(counts.reshape(-1, *kind.shape)[index])

    def close(self) -> None:
        """As `FrameFile.close`."""
        self._source.close()

    def _read_12_bits(self, kind: FrameKind, index: int) -> AnyArray:
        """Four pixels in six bytes; those left over at the end of a row in two bytes each."""
        rows, columns = kind.shape
        packed, rest = columns // 4, columns % 4
        data = np.empty((rows, 6 * packed + 2 * rest), np.uint8)
        self._source.fill(data, _HEADER_SIZE + index * data.size)

        counts = np.empty((rows, columns), np.uint16)
        head = np.ascontiguousarray(data[:, : 6 * packed]).reshape(-1)
        counts[:, : 4 * packed] = unpack(head, 4 * rows * packed, Packing.LOW_12).reshape(rows, -1)
        counts[:, 4 * packed :] = np.ascontiguousarray(data[:, 6 * packed :]).view("<u2")
        return counts

    def _read_zlib(self, dtype: np.dtype[np.generic], count: int) -> AnyArray:
        (length,) = struct.unpack("<i", self._source.read(_HEADER_SIZE, 4))
        stream = self._source.read(_HEADER_SIZE + 4, length)
        expander = zlib.decompressobj()
        try:
            # one more byte, so that the end is found and its checksum verified
            data = expander.decompress(stream, count * dtype.itemsize + 1)
        except zlib.error as error:
            raise FrameError(f"the compressed counts are damaged ({error})") from error
        if len(data) < count * dtype.itemsize:
            raise FrameError("the compressed counts end within the frame")
        return np.frombuffer(data, dtype.newbyteorder("<"), count)

    def _read_imx(self, count: int) -> AnyArray:
        from erlif.io.readers.imx import decode_imx

        # a small preview with its own size comes first
        columns, rows = self._source.read(_HEADER_SIZE, 2)
        start = _HEADER_SIZE + 2 + columns * rows
        stream = np.empty(max(self._source.size - start, 0), np.uint8)
        self._source.fill(stream, start)
        counts = np.empty(count, np.uint16)
        if decode_imx(stream, counts) < count:
            raise FrameError("the compressed counts end within the frame")
        return counts


class SetFrames(FrameFile):
    """The IM7 files of a SET folder, one after the other; each is open while it is read.

    Parameters
    ----------
    paths : sequence of Path
        In the order of the triggers.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self.paths = self.companions = tuple(paths)
        kinds: list[FrameKind] = []
        stamps: list[Array | None] = []
        self.places: list[tuple[int, int]] = []
        for number, path in enumerate(self.paths):
            try:
                file = open_im7(path)
            except FrameError as error:
                raise FrameError(f"{path.name} in its folder: {error}") from error
            file.close()
            kinds += file.kinds
            stamps.append(_read_stamps(path, len(file.kinds)))
            self.places += [(number, index) for index in range(len(file.kinds))]

        self.kinds = kinds
        known = [times for times in stamps if times is not None]
        if len(known) == len(stamps):
            elapsed = np.concatenate(known)
            self.times = elapsed - elapsed[0]
        if len(kinds) > len(self.paths):
            self.channels = [index + 1 for _, index in self.places]

    def read(self, index: int) -> AnyArray:
        """As `FrameFile.read`."""
        number, inner = self.places[index]
        with closing(open_im7(self.paths[number])) as file:
            return file.read(inner)


def open_im7(path: Path) -> FrameFile:
    """Open an IM7 image.

    Its channels are the cameras where the file holds several frames. As `Format.open`:
    FrameError if the file is damaged or holds no counts.
    """
    with Source(path) as source:
        header = read_header(source, "lavision")
    if header.version != 0 or header.sparse:
        raise FrameError(
            "it is an image of DaVis 6 or earlier, or damaged. Open it in DaVis and save it as IM7."
        )
    if header.format not in _TYPES:
        what = "a vector field" if header.format > 0 else f"an image of format {header.format}"
        raise FrameError(f"it holds {what} and no counts. Name the camera images of the recording.")
    if header.planes != 1:
        raise FrameError(f"it holds a volume of {header.planes} planes; images of one are read.")
    if header.packing not in (_PLAIN, _IMX, _ZLIB, _BITS_12):
        raise FrameError(
            f"its compression {header.packing} is not read. Save the images without compression in "
            "DaVis."
        )
    file: FrameFile
    if header.packing == _PLAIN:
        layout = FrameLayout((header.rows, header.columns), _TYPES[header.format])
        file = RawFrames(path, layout, layout.in_a_row(_HEADER_SIZE, header.frames))
    elif header.format == -3 and header.packing != _ZLIB:
        raise FrameError("the file is damaged: numbers of 32 bits are not stored in 12 or 16")
    else:
        file = CompressedImage(path, header)
    if header.packing == _BITS_12:
        file.bits = 12
    if header.frames > 1:
        file.channels = range(1, header.frames + 1)
    stamps = _read_stamps(path, len(file.kinds))
    file.times = None if stamps is None else stamps - stamps[0]
    return file


def _read_stamps(path: Path, frames: int) -> Array | None:
    """Time of each frame from the start of the recording; None where one is missing. [s]"""
    # attributes follow the counts; where compressed counts end is not in the header
    with Source(path) as source:
        start = min(max(source.size - _LONGEST_END, _HEADER_SIZE), source.size)
        end = source.read(start, source.size - start)
    stamps, delays = (
        {
            int(number): float(value) * 1e-6
            for series, number, value, unit in _TIME.findall(end)
            if series == name and unit in _MICROSECONDS
        }
        for name in (b"Series", b"")
    )
    for one, two, value in _DELAY.findall(end):
        (delay,) = struct.unpack("<d", value)
        if abs(delay) < 1e15:
            delays[int(one or two)] = delay * 1e-6
    if not all(frame in stamps for frame in range(frames)):
        return None

    # DaVis gives the exposures of a double frame the stamp of their trigger
    times = np.array([stamps[frame] for frame in range(frames)])
    if (times == times[0]).all() and all(frame in delays for frame in range(frames)):
        times += [delays[frame] - delays[0] for frame in range(frames)]
    return times


def open_set(path: Path) -> FrameFile:
    """Open the images of a SET folder.

    `path` is the `.set` file, which stands beside the folder. As `Format.open`: FrameError if the
    folder is missing or holds no images.
    """
    folder = path.with_name(path.name.removesuffix(path.suffix))
    if not folder.is_dir():
        raise FrameError(f"its folder is missing. Copy the folder {folder.name} beside it.")
    images = [found for found in folder.iterdir() if found.suffix.lower() == ".im7"]
    if not images:
        raise FrameError(
            f"the folder {folder.name} holds no IM7 images. Export the recording as IM7 in DaVis."
        )
    if len(images) > _MOST_FILES:
        raise FrameError(f"the folder {folder.name} holds more than {_MOST_FILES} images")

    # B00001 to B99999, then B100000
    return SetFrames(sorted(images, key=lambda found: (len(found.name), found.name)))


# Images of DaVis. Their header begins with zeros, as do many files: only the suffix marks it. That
# of vector fields is the same, and refuses them; their suffix is not one of frames.
IM7 = Format(
    "LaVision IM7", (".im7",), lambda path, _: path.suffix.lower() in (".im7", ".vc7"), open_im7
)

# Folders of images of DaVis.
SET = Format("LaVision SET", (".set",), None, open_set, movie=True, beside=("",))
