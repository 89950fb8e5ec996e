"""AVI films of 8 grey bits, uncompressed; read with a warning."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES, Format, FrameFile, check_claim
from erlif.io.readers.pictures import bitmap_layout
from erlif.io.readers.raw import RawFrames
from erlif.io.readers.source import Source

_LISTS = (b"RIFF", b"LIST")

_DEEPEST = 8
"""Levels of lists in each other; a film has four."""

_MOST_CHUNKS, _CHUNKS_PER_FRAME = 50_000, 8
"""Chunks beyond which a file is damaged, and those for each frame: sound, lists and indices."""

_WARNING = (
    "AVI stores 8 bits, and programs that write it often change contrast or compress first; export "
    "the raw counts as TIFF where the camera has more."
)


def open_avi(path: Path) -> FrameFile:
    """Open an AVI film.

    The file has a warning. As `Format.open`: FrameError if it is damaged, compressed or in
    colours.
    """
    with Source(path) as source:
        film = _Film(source)
        film.walk(0, source.size, 0)
        if film.format is None:
            raise FrameError("the file is damaged: no stream of images is described")
        layout = bitmap_layout(film.format)
        check_claim(1, layout.kind, source.size)

    # an empty chunk repeats the frame before it
    places = [place for place, size in film.frames if size >= layout.size]
    if len(places) < len(film.frames):
        lost = len(film.frames) - len(places)
        raise FrameError(f"{lost} of its {len(film.frames)} frames are empty: the camera lost them")
    interval = film.interval if film.interval > 0 else None
    file = RawFrames(path, layout, np.array(places, np.int64), bits=8, interval=interval)
    file.warning = _WARNING
    return file


class _Film:
    """What the chunks of a film state.

    Attributes
    ----------
    format : bytes | None
        The header of the images with its palette.
    frames : list[tuple[int, int]]
        Place and size of each frame. [byte]
    interval : float
        Time from frame to frame; 0 where it is not known. [s]
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.format: bytes | None = None
        self.frames: list[tuple[int, int]] = []
        self.interval = 0.0
        self._in_video = False
        self._chunks = 0

    def walk(self, place: int, end: int, depth: int) -> None:
        """Go through the chunks between two places. [byte]"""
        while place + 8 <= end and len(self.frames) <= MOST_FRAMES:
            name, size = struct.unpack("<4sI", self.source.read(place, 8))
            inside = place + 8
            if name in _LISTS and depth < _DEEPEST:
                self.walk(inside + 4, min(inside + size, end), depth + 1)
            elif name == b"strh":
                self._read_stream(inside, size)
            elif name == b"strf" and self._in_video and self.format is None:
                self.format = self.source.read(inside, min(size, 4096, end - inside))
            elif name[2:] in (b"db", b"dc") and name[:2].isdigit():
                self.frames.append((inside, size))
            self._count_chunk()
            place = inside + size + size % 2  # chunks begin at even places

    def _count_chunk(self) -> None:
        """Refuse a file of empty chunks, such as one of zeros: each takes eight bytes."""
        self._chunks += 1
        if self._chunks > _MOST_CHUNKS + _CHUNKS_PER_FRAME * len(self.frames):
            raise FrameError("the file is damaged: hardly any of its chunks is a frame")

    def _read_stream(self, place: int, size: int) -> None:
        if size < 32:
            raise FrameError("the file is damaged: the header of a stream is too short")
        kind, scale, rate = struct.unpack("<4s16xII", self.source.read(place, 28))
        self._in_video = kind == b"vids"
        if self._in_video and rate:
            self.interval = scale / rate


AVI = Format(
    "AVI",
    (".avi",),
    lambda path, head: head[:4] == b"RIFF" and head[8:12] == b"AVI ",
    open_avi,
)
