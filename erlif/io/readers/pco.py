"""PCO B16: one frame of 16-bit counts behind a small header."""

from __future__ import annotations

import struct
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile, colour_camera
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source

_HEADER = struct.Struct("<4s5i")
"""Letters, size of the file, size of the header, columns, rows, whether a second part follows."""

_COLOUR = struct.Struct("<i")
"""First number of the second part: 1 for a colour camera."""


def open_pco(path: Path) -> FrameFile:
    """Open a B16 file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    FrameFile
        Its depth is not known: cameras of 12, 14 and 16 bits write the same header.

    Raises
    ------
    FrameError
        With the bare reason, if the file is damaged or of a colour camera.
    """
    with Source(path) as source:
        letters, _, start, columns, rows, extended = _HEADER.unpack(source.read(0, _HEADER.size))
        if letters != b"PCO-":
            raise FrameError("it does not begin as a B16 file does")
        if start < _HEADER.size:
            raise FrameError(f"the header is damaged: it ends at byte {start}")
        if extended and start >= _HEADER.size + _COLOUR.size:
            (colour,) = _COLOUR.unpack(source.read(_HEADER.size, _COLOUR.size))
            if colour == 1:
                raise colour_camera("frame")
    return RawFrames(path, FrameLayout((rows, columns), "<u2"), [start])


def _is_pco(path: Path, head: bytes) -> bool:
    return head[:4] == b"PCO-"


PCO = Format("PCO B16", (".b16",), _is_pco, open_pco)
"""Frames of PCO cameras."""
