"""AVI films of 8 grey bits, uncompressed; read with a warning."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, Format, FrameFile, check_claim
from erlif.io.readers.pictures import bitmap_layout
from erlif.io.readers.raw import RawFrames
from erlif.io.readers.source import Source

_LISTS = (b"RIFF", b"LIST")

# Levels of lists in each other; a film has four.
_DEEPEST = 8

# Chunks beyond which a file is damaged, and those for each frame: sound, lists and indices.
_MOST_CHUNKS, _CHUNKS_PER_FRAME = 50_000, 8

_WARNING = (
    "AVI stores 8 bits, and programs that write it often change contrast or compress first; export "
    "the raw counts as TIFF where the camera has more."
)


def open_avi(path: Path) -> FrameFile:
    """Open an AVI film.

    The file has a warning. As `Format.open`: FrameError if it is damaged, compressed or in
    colours.
    """
    form, frames, interval, in_video = b"", list[tuple[int, int]](), 0.0, False
    with Source(path) as source:
        for count, (name, place, size, end) in enumerate(_chunks(source, 0, source.size)):
            if name == b"strh":
                if size < 32:
                    raise FrameError("the file is damaged: the header of a stream is too short")
                kind, scale, rate = struct.unpack("<4s16xII", source.read(place, 28))
                in_video = kind == b"vids"
                interval = scale / rate if in_video and rate else interval
            elif name == b"strf" and in_video and not form:
                form = source.read(place, min(size, 4096, end - place))
            elif name[2:] in (b"db", b"dc") and name[:2].isdigit():
                frames.append((place, size))

            # a file of empty chunks, such as one of zeros, takes eight bytes for each
            if count >= _MOST_CHUNKS + _CHUNKS_PER_FRAME * len(frames):
                raise FrameError("the file is damaged: hardly any of its chunks is a frame")
            if len(frames) > MOST_FRAMES:
                break
        if not form:
            raise FrameError("the file is damaged: no stream of images is described")
        layout = bitmap_layout(form)
        check_claim(1, layout.kind, source.size)

    # an empty chunk repeats the frame before it
    places = [place for place, size in frames if size >= layout.size]
    if len(places) < len(frames):
        lost = len(frames) - len(places)
        raise FrameError(f"{lost} of its {len(frames)} frames are empty: the camera lost them")
    file = RawFrames(path, layout, np.array(places, np.int64), bits=8, interval=interval or None)
    file.warning = _WARNING
    return file


def _chunks(
    source: Source, place: int, end: int, depth: int = 0
) -> Iterator[tuple[bytes, int, int, int]]:
    """Name, place, size and limit of the chunks between two places, and of those in lists."""
    while place + 8 <= end:
        name, size = struct.unpack("<4sI", source.read(place, 8))
        inside = place + 8
        yield name, inside, size, end
        if name in _LISTS and depth < _DEEPEST:
            yield from _chunks(source, inside + 4, min(inside + size, end), depth + 1)
        place = inside + size + size % 2  # chunks begin at even places


AVI = Format(
    "AVI",
    (".avi",),
    lambda path, head: head[:4] == b"RIFF" and head[8:12] == b"AVI ",
    open_avi,
)
