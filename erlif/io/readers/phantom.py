"""Phantom CINE: the recordings of Vision Research cameras.

A file has a header, a table of the places of its frames, and before each frame a note of its size.
Places are 64-bit numbers, so that files may exceed 4 GB. Source: Vision Research, Cine File Format,
2011.

Which row comes first: uncompressed frames are bitmaps in the sense of Windows, with the lowest row
first where biHeight is positive and the highest first where it is negative. Packed frames have
the highest row first whatever the sign: a packed recording of a test chart (public sample of
pycine, biHeight = 1080) is upright only then.
"""

from __future__ import annotations

import struct
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import Array, Counts
from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, Format, FrameFile, read_header
from erlif.io.readers.raw import FrameLayout, Packing, RawFrames, frame_interval
from erlif.io.readers.source import Source

# Values of the compression that are not read.
_COMPRESSIONS = {1: "JPEG-compressed", 2: "from a colour sensor"}

# Values of biCompression for packed counts.
_PACKED_10, _PACKED_12 = 256, 1024

# Type of the tagged block with a time for each image.
_TIMES = 1002

# Unit of a TIME64: its upper half counts seconds, its lower half fractions. [s]
_FRACTION = 2.0**-32

# Tagged blocks after which the search for the times ends; cameras write fewer than ten.
_MOST_BLOCKS = 1000

# Size of the note before a frame, which stands at its start, and of the frame, at its end.
_NUMBER = struct.Struct("<I")

# Size of a note above which it is damaged. [byte]
_LONGEST_NOTE = 2**20

# Count of the value 0, the last value below full scale, and the count of all values after it.
_FIRST_10, _LAST_10, _FULL_SCALE = 2, 1014, 4095


@cache
def phantom_table() -> Counts:
    """Table of the 12-bit counts for the 10-bit values that the camera stores.

    Returns
    -------
    array of uint16, (1024,)
        After the table in Vision Research, Cine File Format, 2011: steps of about one count up to
        the value 141, of up to nine above, where the noise of the light is larger. [DN]

    Examples
    --------
    >>> table = phantom_table()
    >>> [int(table[value]) for value in (0, 64, 1014, 1023)]
    [2, 64, 4064, 4095]
    """
    # differences of neighbouring counts, a digit each
    file = resources.files("erlif.io.readers").joinpath("phantom_steps.txt")
    digits = "".join(file.read_text(encoding="ascii").split())

    table = np.full(1024, _FULL_SCALE, np.uint16)
    steps = np.array([_FIRST_10, *map(int, digits)])
    table[: _LAST_10 + 1] = np.cumsum(steps)
    return table


class PhantomFrames(RawFrames):
    """The frames of a CINE file."""

    def find_counts(self, index: int) -> int:
        """As `RawFrames.find_counts`, behind the note before each frame."""
        place = int(self.offsets[index])
        (note,) = _NUMBER.unpack(self._source.read(place, _NUMBER.size))
        if not 2 * _NUMBER.size <= note <= _LONGEST_NOTE:
            raise FrameError("the header of the frame is damaged")
        (size,) = _NUMBER.unpack(self._source.read(place + note - _NUMBER.size, _NUMBER.size))
        if size != self.layout.size:
            raise FrameError(f"the frame has {size} bytes, expected {self.layout.size}")
        return place + int(note)


def open_phantom(path: Path) -> FrameFile:
    """Open a CINE file.

    As `Format.open`: FrameError if the file is damaged, compressed or of a colour
    camera.
    """
    with Source(path) as source:
        header = read_header(source, "phantom")
        if header.kind != b"CI":
            raise FrameError("it does not begin as a CINE file does")
        if header.compression in _COMPRESSIONS:
            raise FrameError(
                f"the frames are {_COMPRESSIONS[header.compression]}. Film thickness needs raw "
                "counts of a monochrome camera: save the recording as raw CINE."
            )
        if not 0 < header.images <= MOST_FRAMES:
            raise FrameError(f"the file is damaged: its header names {header.images} frames")

        bitmap = read_header(source, "bitmap", header.bitmap)
        layout = _find_layout(bitmap)
        setup = read_header(source, "setup", header.setup)
        if setup.mark != b"ST":
            raise FrameError("the header is damaged: it has no block of settings")
        later = read_header(source, "setup_later", header.setup, size=setup.length)
        times = _read_times(source, header.setup + setup.length, header)
        places = np.frombuffer(source.read(header.offsets, 8 * header.images), "<i8")

    # counts of 8 bits may come from a camera of more
    bits = 12 if layout.packing is not None else min(later.depth, bitmap.bits) or None
    interval = frame_interval(later.rate or setup.rate, step=max(later.decimation, 1))
    file = PhantomFrames(
        path,
        layout,
        places,
        before=2 * _NUMBER.size,
        bits=bits,
        interval=interval,
        find_times=lambda file: times,
    )
    file.serial = str(later.serial or "")
    return file


def _read_times(source: Source, start: int, header: Any) -> Array | None:
    """Time of each image from the first; None where the camera stored none."""
    place = start
    for _ in range(_MOST_BLOCKS):
        # the blocks fill the space between the settings and the table of places
        if not 0 <= place <= header.offsets - 8:
            return None
        size, kind, more = struct.unpack("<IHH", source.read(place, 8))
        if kind == _TIMES and size >= 8 + 8 * header.images:
            stamps = np.frombuffer(source.read(place + 8, 8 * header.images), "<u8")
            elapsed = (stamps - stamps[0]).astype(np.int64) * _FRACTION
            return elapsed if header.images == 1 or elapsed.any() else None
        if size < 8 or not more:
            return None
        place += size
    return None


def _find_layout(bitmap: Any) -> FrameLayout:
    """Layout of the counts after the bitmap header."""
    shape = (abs(bitmap.height), bitmap.width)
    if bitmap.compression in (_PACKED_10, _PACKED_12):
        if bitmap.compression == _PACKED_12:
            return FrameLayout(shape, "<u2", packing=Packing.HIGH_12)
        return FrameLayout(shape, "<u2", packing=Packing.HIGH_10, table=phantom_table())

    if bitmap.compression != 0:
        raise FrameError(f"the frames are compressed in an unknown way ({bitmap.compression})")
    if bitmap.bits not in (8, 16):
        colours = "colour frames" if bitmap.bits in (24, 48) else "frames"
        raise FrameError(
            f"the file holds {colours} of {bitmap.bits} bits for each pixel; 8 and 16 bits of one "
            "band are read. Record with a monochrome camera."
        )

    # rows of a bitmap end at multiples of four bytes, those of some versions do not
    width = bitmap.width * bitmap.bits // 8
    padded = -(-width // 4) * 4
    row_bytes = padded if padded != width and bitmap.image_size == shape[0] * padded else 0
    return FrameLayout(
        shape,
        "|u1" if bitmap.bits == 8 else "<u2",
        row_bytes=row_bytes,
        bottom_up=bitmap.height > 0,
    )


def _is_phantom(path: Path, head: bytes) -> bool:
    # two letters are few: the sizes of the two headers come with them
    return head[:4] == b"CI\x2c\0" and head[6:8] == b"\1\0"


# Recordings of Phantom cameras.
PHANTOM = Format("Phantom CINE", (".cine", ".cin"), _is_phantom, open_phantom, movie=True)
