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
import re
import tomllib
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from erlif.core.errors import FrameError
from erlif.io.readers.base import Format, FrameFile, colour_camera
from erlif.io.readers.raw import FrameLayout, Packing, RawFrames, count_frames
from erlif.io.readers.source import find_beside, read_text

# Pixel formats that are read.
_FORMAT = re.compile(r"Mono(8|10|12|14|16)|Mono(10|12)(p|Packed|pmsb)")

# Beginnings of the names of pixel formats with colours.
_COLOURS = ("Bayer", "RGB", "BGR", "YUV", "YCbCr")

# Order of packed bits by the end of the name of a pixel format.
_PACKINGS = {"p": "LOW", "Packed": "SPLIT", "pmsb": "HIGH"}

# Endings of the file that describes the frames.
_DESCRIPTIONS = (".toml", ".json")

_EXAMPLE = 'width = 1280, height = 1024, pixel_format = "Mono12p"'


class _Description(BaseModel):
    """Description of the frames in the file beside them."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    width: int = Field(ge=0, lt=1 << 48)
    height: int = Field(ge=0, lt=1 << 48)
    pixel_format: str
    frames: int | None = Field(None, ge=0, lt=1 << 48)
    frame_rate: float | None = Field(None, ge=1e-6, le=1e9)
    header_bytes: int = Field(0, ge=0, lt=1 << 48)


def open_raw(path: Path) -> FrameFile:
    """Open raw frames by the description beside them.

    `path` is the `.raw` file. As `Format.open`: FrameError if the description is missing
    or does not fit the file.
    """
    beside = find_beside(path, _DESCRIPTIONS)
    if beside is None:
        raise FrameError(
            f"the format of raw frames stands in no file. Put {path.stem}.toml beside them, with "
            f"{_EXAMPLE}."
        )
    given = _read_description(beside)
    shape = given.height, given.width
    name = _FORMAT.fullmatch(given.pixel_format)
    if given.pixel_format.startswith(_COLOURS):
        raise colour_camera()
    if name is None:
        raise FrameError(
            f"{beside.name} cannot be read: pixel_format is {given.pixel_format[:40]!r}. Expected "
            "Mono8 to Mono16, or Mono10 and Mono12 with p, Packed or pmsb behind it."
        )
    plain, packed, order = name.groups()
    packing = Packing[f"{_PACKINGS[order]}_{packed}"] if packed else None
    layout = FrameLayout(shape, "|u1" if plain == "8" else "<u2", packing=packing)

    start, size = given.header_bytes, path.stat().st_size
    held = count_frames(size, start=start, step=layout.size)
    return RawFrames(
        path,
        layout,
        layout.in_a_row(start, held if given.frames is None else given.frames),
        bits=int(plain or packed),
        interval=None if given.frame_rate is None else 1 / given.frame_rate,
        companions=(beside,),
        described_by=beside.name,
    )


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


# Raw frames of industrial cameras.
GENICAM = Format("GenICam raw", (".raw",), None, open_raw, beside=_DESCRIPTIONS)
