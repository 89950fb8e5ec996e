"""Princeton Instruments SPE, of WinView (2.x) and of LightField (3.x).

Both have a header of 4100 bytes with the type of the counts. WinView stores the size and number of
the frames there as well, LightField in an XML text behind the frames. Frames of several regions of
the sensor are not read.
"""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

from erlif.core.arrays import Array
from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile, read_header
from erlif.io.readers.raw import FrameLayout, RawFrames
from erlif.io.readers.source import Source

_HEADER_SIZE = 4100

# Type of a count by its number in the header.
_TYPES = {0: "<f4", 1: "<i4", 2: "<i2", 3: "<u2", 5: "<f8", 6: "|u1", 8: "<u4"}

# Type of a count by its name in the XML text.
_NAMES = {
    "MonochromeUnsigned16": "<u2",
    "MonochromeUnsigned32": "<u4",
    "MonochromeFloating32": "<f4",
}

# Size of the XML text above which the header is damaged; a region has a few kB. [byte]
_LONGEST_TEXT = 64 * 2**20

# Events of a time stamp, the preferred first.
_EVENTS = ("ExposureStarted", "ExposureEnded")


def open_princeton(path: Path) -> FrameFile:
    """Open an SPE file.

    Without times for WinView, which stores none, and for LightField where they were not asked
    for. As `Format.open`: FrameError if the file is damaged or holds several regions.
    """
    with Source(path) as source:
        header = read_header(source, "princeton")
        if header.version >= 3 and header.text:
            return _open_lightfield(path, source, header.text)

    if header.type not in _TYPES:
        raise FrameError(f"the header is damaged: it names the type {header.type} of counts")
    if header.regions > 1:
        raise FrameError(_one_region(header.regions))
    layout = FrameLayout((header.rows, header.columns), _TYPES[header.type])
    places = layout.in_a_row(_HEADER_SIZE, max(header.frames, 0))
    known = 8 <= header.resolution <= 16 and _TYPES[header.type] in ("<u2", "<i2")
    return RawFrames(path, layout, places, bits=header.resolution if known else None)


def _open_lightfield(path: Path, source: Source, start: int) -> FrameFile:
    """Frames after the XML text at the end of the file."""
    length = source.size - start
    if not 0 < length <= _LONGEST_TEXT:
        raise FrameError("the file is truncated or damaged: its description is missing")
    text = source.read(start, length).decode("utf-8", errors="replace")

    # the blocks are found by their tags: a parser of XML would follow entities
    blocks = [_attributes(tag) for tag in re.findall(r"<DataBlock\b([^<>]*)>", text)]
    frames = [block for block in blocks if block.get("type") == "Frame"]
    regions = [block for block in blocks if block.get("type") == "Region"]
    if len(frames) != 1 or not regions:
        raise FrameError("the file is damaged: its description has no block of frames")
    if len(regions) > 1:
        raise FrameError(_one_region(len(regions)))

    name = frames[0].get("pixelFormat", "")
    if name not in _NAMES:
        raise FrameError(f"its pixel format {name[:40]!r} is not read. Export the frames as TIFF.")
    layout = FrameLayout(
        (_number(regions[0], "height"), _number(regions[0], "width")), _NAMES[name]
    )
    count, step = _number(frames[0], "count"), _number(frames[0], "stride")
    return RawFrames(
        path,
        layout,
        layout.in_a_row(_HEADER_SIZE, count, step),
        find_times=partial(_read_times, stamp=_find_stamp(text, layout.size, step)),
    )


def _read_times(file: RawFrames, stamp: tuple[int, float] | None) -> Array | None:
    """Times by the stamps behind the frames; None without stamps or where frames were cut."""
    if stamp is None:
        return None
    place, unit = stamp
    ticks, held = file.read_stamps(place, "<i8")
    return (ticks - ticks[0]) * unit if held.all() else None


def _find_stamp(text: str, start: int, end: int) -> tuple[int, float] | None:
    """Place of the time stamp within a frame and its unit, by the order of the data behind it.

    Princeton Instruments, SPE 3.0 File Format Specification, issue 4 (2019), chapters 2 and 3.
    """
    blocks = re.findall(r"<MetaBlock\b[^<>]*>(.*?)</MetaBlock>", text, re.DOTALL)
    if len(blocks) != 1:
        return None
    columns: dict[str, tuple[int, float]] = {}
    place = start
    for name, tag in re.findall(r"<([A-Za-z]+)\b([^<>]*)>", blocks[0]):
        entries = _attributes(tag)
        bits, rate = (entries.get(key, "") for key in ("bitDepth", "resolution"))
        if not re.fullmatch(r"[0-9]{1,3}", bits) or "count" in entries:
            return None
        whole = entries.get("type") == "Int64" and re.fullmatch(r"[1-9][0-9]{0,11}", rate)
        if name == "TimeStamp" and whole:
            columns[entries.get("event", "")] = place, 1 / int(rate)
        place += int(bits) // 8

    # padding may follow
    stamps = [columns[event] for event in _EVENTS if event in columns]
    return stamps[0] if stamps and place <= end else None


def _attributes(tag: str) -> dict[str, str]:
    return dict(re.findall(r'([A-Za-z]+)="([^"]*)"', tag))


def _number(block: dict[str, str], key: str) -> int:
    """A whole number of a block, within what a file can hold."""
    text = block.get(key, "")
    if not re.fullmatch(r"[0-9]{1,12}", text):
        raise FrameError(f"the file is damaged: its description has {key} = {text[:40]!r}")
    return int(text)


def _one_region(regions: int) -> str:
    return (
        f"each of its frames holds {regions} regions of the sensor. Record one region, or export "
        "each of them as TIFF."
    )


# the header has no letters at its start: only the suffix marks it
# Recordings of WinView and LightField.
PRINCETON = Format("Princeton SPE", (".spe",), None, open_princeton, movie=True)
