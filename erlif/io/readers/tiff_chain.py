"""The chain of directories of a TIFF file, checked before a general reader goes along it.

A damaged file may chain thousands of directories through its own pixels, each with thousands of
entries; a reader that takes them one by one needs minutes and gigabytes.
"""

from __future__ import annotations

import struct
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.readers.base import MOST_FRAMES
from erlif.io.readers.source import Source

_TYPE_SIZES = {
    1: 1,
    2: 1,
    3: 2,
    4: 4,
    5: 8,
    6: 1,
    7: 1,
    8: 2,
    9: 4,
    10: 8,
    11: 4,
    12: 8,
    13: 4,
    16: 8,
    17: 8,
    18: 8,
}
"""Sizes of the values of an entry by its type; TIFF 6.0, section 2, and BigTIFF. [byte]"""

_MOST_UNKNOWN = 16
"""Entries of unknown type in a directory; later versions of the format may add some."""


def count_directories(path: Path) -> int:
    """Count the whole directories of a file, and refuse those that overlap or form a ring.

    Parameters
    ----------
    path : Path

    Returns
    -------
    int
        Directories before the first that is cut off.

    Raises
    ------
    FrameError
        With the bare reason.
    """
    with Source(path) as source:
        head = source.read(0, min(16, source.size))
        order = {b"II": "<", b"MM": ">"}.get(head[:2], "")
        if not order or len(head) < 8:
            raise FrameError("the file is damaged or not a TIFF")
        big = struct.unpack_from(f"{order}H", head, 2)[0] == 43
        if big and len(head) < 16:
            raise FrameError("the file is truncated")
        place = struct.unpack_from(f"{order}Q" if big else f"{order}I", head, 8 if big else 4)[0]

        # directories that do not overlap take no more than the file
        taken = directories = 0
        while place:
            size, place = _check_directory(source, place, order, big)
            taken, directories = taken + size, directories + (size > 0)
            if taken > source.size or directories > MOST_FRAMES:
                raise FrameError("the file is damaged: its directories form a ring or overlap")
        return directories


def _check_directory(source: Source, place: int, order: str, big: bool) -> tuple[int, int]:
    """Size of a directory with its values, and the place of the next one; 0 after the last."""
    number, entry, following = ("Q", "HHQ8s", "Q") if big else ("H", "HHI4s", "I")
    width, step = struct.calcsize(f"={number}"), struct.calcsize(f"={entry}")

    # a chain that leads out of the file was cut off: the images before are whole
    if place + width > source.size:
        return 0, 0
    (entries,) = struct.unpack(f"{order}{number}", source.read(place, width))
    size = width + entries * step + struct.calcsize(f"={following}")
    if place + size > source.size:
        return 0, 0
    table = source.read(place, size)
    end = width + entries * step

    unknown = 0
    for _, kind, count, _ in struct.iter_unpack(f"{order}{entry}", table[width:end]):
        unknown += kind not in _TYPE_SIZES
        if count * _TYPE_SIZES.get(kind, 0) > source.size or unknown > _MOST_UNKNOWN:
            raise FrameError("the file is damaged: a directory is no list of entries")
    return size, struct.unpack_from(f"{order}{following}", table, end)[0]
