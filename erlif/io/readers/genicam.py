"""Raw frames of industrial cameras, with their format in a small file beside them.

A file `frames.raw` holds frames as a GenICam camera sends them, one after the other. What they are
stands in `frames.toml` or `frames.json`:

    width = 1280
    height = 1024
    pixel_format = "Mono12p"
    frames = 500          # optional: else as many as the file holds
    frame_rate = 1000.0   # optional, in Hz
    header_bytes = 0      # optional: what to skip before the first frame

Pixel formats have the names of the GenICam pixel format naming convention (EMVA, PFNC 2.4).
"""

from __future__ import annotations

import difflib
import json
import tomllib
from pathlib import Path
from typing import Any

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile
from erlif.io.readers.raw import FrameLayout, RawFrames, count_frames, frame_interval
from erlif.io.readers.sidecar import find_beside, read_text

_FORMATS = {
    "Mono8": (8, ""),
    "Mono10": (10, ""),
    "Mono12": (12, ""),
    "Mono14": (14, ""),
    "Mono16": (16, ""),
    "Mono10p": (10, "LOW_10"),
    "Mono12p": (12, "LOW_12"),
    "Mono10Packed": (10, "SPLIT_10"),
    "Mono12Packed": (12, "SPLIT_12"),
    "Mono10pmsb": (10, "HIGH_10"),
    "Mono12pmsb": (12, "HIGH_12"),
}
"""Bits of a count and order of packed bits by the name of a pixel format."""

_KEYS = ("width", "height", "pixel_format", "frames", "frame_rate", "header_bytes")

_EXAMPLE = 'width = 1280, height = 1024, pixel_format = "Mono12p"'


def open_raw(path: Path) -> FrameFile:
    """Open raw frames by the description beside them.

    Parameters
    ----------
    path : Path
        The `.raw` file.

    Returns
    -------
    FrameFile

    Raises
    ------
    FrameError
        With the bare reason, if the description is missing or does not fit the file.
    """
    beside = find_beside(path, (".toml", ".json"))
    if beside is None:
        raise FrameError(
            f"the format of raw frames stands in no file. Put {path.stem}.toml beside them, with "
            f"{_EXAMPLE}."
        )
    entries = _read_entries(beside)
    shape = (_whole(entries, "height", beside), _whole(entries, "width", beside))
    bits, packing = _find_format(entries, beside)
    layout = FrameLayout(shape, "|u1" if bits == 8 else "<u2")
    if packing:
        from erlif.io.readers.unpack import Packing

        layout = FrameLayout(shape, "<u2", packing=Packing[packing])

    start = _whole(entries, "header_bytes", beside) if "header_bytes" in entries else 0
    size, step = path.stat().st_size, max(layout.size, 1)
    held = count_frames(size, start=start, step=step)
    count = _whole(entries, "frames", beside) if "frames" in entries else held
    file = RawFrames(
        path,
        layout,
        range(start, start + count * step, step),
        bits=bits,
        interval=_interval(entries, beside),
        companions=(beside,),
    )

    # a wrong width shifts each row a little, which nothing else reveals
    if size > start + count * step:
        file.close()
        raise FrameError(
            f"{beside.name} describes {count} frames of {step} bytes, and the file has {size} "
            f"bytes. Correct width, height, pixel_format, frames or header_bytes in {beside.name}."
        )
    return file


def _read_entries(path: Path) -> dict[str, Any]:
    """Keys and values of the description."""
    try:
        text = read_text(path).encode("latin-1").decode("utf-8")
        entries = json.loads(text) if path.suffix.lower() == ".json" else tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # both parsers, and bytes that are not UTF-8
        raise FrameError(f"{path.name} cannot be read: {error}") from error
    if not isinstance(entries, dict):
        raise FrameError(f"{path.name} holds no keys. Expected {_EXAMPLE}.")

    for key in entries:
        if key not in _KEYS:
            close = difflib.get_close_matches(key, _KEYS, 1)
            known = f"Did you mean {close[0]}?" if close else f"Known are {', '.join(_KEYS)}."
            raise FrameError(f"{path.name} has the unknown key {key!r}. {known}")
    return entries


def _find_format(entries: dict[str, Any], path: Path) -> tuple[int, str]:
    name = entries.get("pixel_format")
    if not isinstance(name, str) or name not in _FORMATS:
        came = f"the pixel_format {name!r}" if name is not None else "no pixel_format"
        raise FrameError(f"{path.name} has {came}. Read are {', '.join(_FORMATS)}.")
    return _FORMATS[name]


def _whole(entries: dict[str, Any], key: str, path: Path) -> int:
    """A whole number of the description."""
    value = entries.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 48:
        came = f"{key} = {str(value)[:40]}" if key in entries else f"no {key}"
        raise FrameError(f"{path.name} has {came}; expected a whole number, as in {_EXAMPLE}.")
    return value


def _interval(entries: dict[str, Any], path: Path) -> float | None:
    """Time between two frames. [s]"""
    rate = entries.get("frame_rate")
    if rate is None:
        return None
    numeric = isinstance(rate, (int, float)) and not isinstance(rate, bool)
    interval = frame_interval(rate) if numeric else None
    if interval is None:
        raise FrameError(
            f"{path.name} has frame_rate = {str(rate)[:40]}; expected a number of Hz above 0."
        )
    return interval


def _is_raw(path: Path, head: bytes) -> bool:
    return path.suffix.lower() == ".raw"


GENICAM = Format("GenICam raw", (".raw",), _is_raw, open_raw)
"""Raw frames of industrial cameras."""
