"""PCO B16: one frame of 16-bit counts behind a small header."""

from __future__ import annotations

from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile, colour_camera, read_header
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source

_HEADER_SIZE = 24

# First number of the second part of the header, for a colour camera.
_COLOUR = b"\1\0\0\0"


def open_pco(path: Path) -> FrameFile:
    """Open a B16 file.

    Its depth is not known: cameras of 12, 14 and 16 bits write the same header. As
    `Format.open`: FrameError if the file is damaged or of a colour camera.
    """
    with Source(path) as source:
        header = read_header(source, "pco")
        if header.letters != b"PCO-":
            raise FrameError("it does not begin as a B16 file does")
        if header.size < _HEADER_SIZE:
            raise FrameError(f"the header is damaged: it ends at byte {header.size}")
        has_second = header.extended and header.size >= _HEADER_SIZE + len(_COLOUR)
        if has_second and source.read(_HEADER_SIZE, len(_COLOUR)) == _COLOUR:
            raise colour_camera("frame")
    return RawFrames(path, FrameLayout((header.rows, header.columns), "<u2"), [header.size])


# Frames of PCO cameras.
PCO = Format("PCO B16", (".b16",), lambda path, head: head[:4] == b"PCO-", open_pco)
