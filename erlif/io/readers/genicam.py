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

import json
import tomllib
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile
from erlif.io.readers.raw import FrameLayout, RawFrames, count_frames
from erlif.io.readers.sidecar import find_beside, read_text
from erlif.io.readers.unpack import Packing

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

_EXAMPLE = 'width = 1280, height = 1024, pixel_format = "Mono12p"'


class _Description(BaseModel):
    """What stands beside the frames."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    width: int = Field(ge=0, lt=1 << 48)
    height: int = Field(ge=0, lt=1 << 48)
    pixel_format: str = Field(pattern=f"^({'|'.join(_FORMATS)})$")
    frames: int | None = Field(None, ge=0, lt=1 << 48)
    frame_rate: float | None = Field(None, ge=1e-6, le=1e9)
    header_bytes: int = Field(0, ge=0, lt=1 << 48)


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
    given = _read_description(beside)
    shape = given.height, given.width
    bits, packing = _FORMATS[given.pixel_format]
    layout = FrameLayout(shape, "|u1" if bits == 8 else "<u2")
    if packing:
        layout = FrameLayout(shape, "<u2", packing=Packing[packing])

    start, size, step = given.header_bytes, path.stat().st_size, max(layout.size, 1)
    held = count_frames(size, start=start, step=step)
    count = held if given.frames is None else given.frames
    file = RawFrames(
        path,
        layout,
        range(start, start + count * step, step),
        bits=bits,
        interval=None if given.frame_rate is None else 1 / given.frame_rate,
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


def _read_description(path: Path) -> _Description:
    """Keys and values of the description."""
    try:
        text = read_text(path).encode("latin-1").decode("utf-8")
        entries = json.loads(text) if path.suffix.lower() == ".json" else tomllib.loads(text)
        return _Description.model_validate(entries)
    except ValidationError as error:
        fault = error.errors()[0]
        key = ".".join(map(str, fault["loc"])) or "the file"
        raise FrameError(
            f"{path.name} cannot be read: {key}, {str(fault['input'])[:40]}: {fault['msg']}. "
            f"Expected {', '.join(_Description.model_fields)}, as in {_EXAMPLE}."
        ) from error
    except (ValueError, RecursionError) as error:  # both parsers, and bytes that are not UTF-8
        raise FrameError(f"{path.name} cannot be read: {error}") from error


def _is_raw(path: Path, head: bytes) -> bool:
    return path.suffix.lower() == ".raw"


GENICAM = Format("GenICam raw", (".raw",), _is_raw, open_raw)
"""Raw frames of industrial cameras."""
