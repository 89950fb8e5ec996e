"""NorPix SEQ: sequences that StreamPix records.

A header of 1024 bytes (8192 from version 5 on) is followed by frames at equal steps. The step
exceeds the counts: a time stamp and padding to a sector follow them. Source: NorPix, Sequence File
Format; the versions 3 to 5 are read.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, Format, FrameFile, colour_camera, read_header
from erlif.io.readers.raw import FrameLayout, RawFrames, count_frames, frame_interval
from erlif.io.readers.source import Source

_MAGIC = b"\xed\xfe\0\0"

# What follows the first four bytes.
_NAME = "Norpix seq".encode("utf-16-le")

# Version from which on the frames begin at 8192 and time stamps have microseconds.
_LARGER_HEADER = 5

# Byte order by the number of a format with one grey count for each pixel.
_TYPES = {
    100: "<",  # low bits
    112: "<",  # high bits
    114: ">",  # high bits, bytes exchanged
}

# Formats whose counts are at the high end of 16 bits.
_HIGH_BITS = (112, 114)

# Formats of colour sensors.
_BAYER = (101, 113, 115, 132, 134)

# Time stamp behind the counts of a frame.
_STAMP = [("second", "<u4"), ("thousandth", "<u2"), ("millionth", "<u2")]


def open_norpix(path: Path) -> FrameFile:
    """Open a SEQ file.

    As `Format.open`: FrameError if the file is damaged, compressed or of a colour
    camera.
    """
    with Source(path) as source:
        if source.read(0, 4) != _MAGIC:
            raise FrameError("it does not begin as a SEQ file does")
        header, size = read_header(source, "norpix"), source.size
    layout = _find_layout(header)

    is_large = header.version >= _LARGER_HEADER
    start = 8192 if is_large else max(header.header_size, 1024)

    # a recording that was not closed has no number of frames
    count = header.frames or count_frames(size, start=start, step=header.step)
    places = layout.in_a_row(start, count, header.step)
    in_time: Sequence[int] | AnyArray = places
    if is_large and 0 < header.oldest < count <= min(size // layout.size, MOST_FRAMES):
        # a loop goes on at its first place after the last; a lying number takes no memory
        in_time = np.roll(np.asarray(places), -header.oldest)
    bits = header.significant_bits if 1 <= header.significant_bits <= header.bits else header.bits
    return RawFrames(
        path,
        layout,
        in_time,
        bits=None if header.format in _HIGH_BITS and bits < header.bits else bits,
        interval=frame_interval(header.rate),
        find_times=partial(_read_times, has_microseconds=is_large),
    )


def _read_times(file: RawFrames, *, has_microseconds: bool) -> Array | None:
    """Times by the stamps behind the frames; None where these are not set."""
    stamps, held = file.read_stamps(file.layout.size, _STAMP)
    # before version 5 the last number is padding; seconds are counted from the first frame on,
    # because 64 bits resolve a time since 1970 to a quarter of a microsecond only
    seconds = stamps["second"].astype(np.float64) - stamps["second"][0]
    times = seconds + stamps["thousandth"] * 1e-3
    if has_microseconds:
        times += stamps["millionth"] * 1e-6
    if held[0] and (len(times) == 1 or np.ptp(times[held]) > 0):
        return np.asarray(np.where(held, times - times[0], np.nan))
    return None


def _find_layout(header: Any) -> FrameLayout:
    """Layout of the counts."""
    if header.compression:
        raise FrameError(
            f"its frames are compressed (method {header.compression}). Export the sequence without "
            "compression in StreamPix."
        )
    if header.format in _BAYER or header.format >= 200:
        raise colour_camera()
    if header.format not in _TYPES or header.bits not in (8, 16):
        raise FrameError(
            f"its frames have the format {header.format} of NorPix with {header.bits} bits for "
            "each pixel; unpacked grey counts are read. Export the sequence as 16-bit TIFF in "
            "StreamPix."
        )

    shape = (header.height, header.width)
    layout = FrameLayout(shape, f"{_TYPES[header.format]}u{header.bits // 8}")
    if header.image_bytes == layout.size or not header.height:
        return layout

    # rows that are padded make an image larger, by the same in each row
    row_bytes, rest = divmod(header.image_bytes, header.height)
    if rest or row_bytes < header.width * header.bits // 8:
        raise FrameError(
            f"the header is damaged: {header.image_bytes} bytes are no image of {layout.kind}"
        )
    return FrameLayout(shape, layout.dtype, row_bytes=row_bytes)


def _is_norpix(path: Path, head: bytes) -> bool:
    return head[:4] == _MAGIC and head[4 : 4 + len(_NAME)] == _NAME


# Sequences of StreamPix.
NORPIX = Format("NorPix SEQ", (".seq",), _is_norpix, open_norpix, movie=True)
