"""A file of frames behind one interface, whatever its format."""

from __future__ import annotations

import math
import struct
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array
from erlif.core.errors import ErlifError, FrameError
from erlif.core.tables import read_table
from erlif.io.readers.source import Source

# Frames of one file above which its header is damaged: a day at 46 frames a second.
MOST_FRAMES = 4_000_000

# Pixels of a frame above which its header is damaged: no camera of this kind has a third of it.
MOST_PIXELS = 2**28

# Decoded bytes per byte of a file that deflate can reach.
DEFLATED = 1100


# Layouts of the headers of camera files.
LAYOUTS = read_table("erlif.io.readers", "headers.toml")


class FrameKind(NamedTuple):
    """Shape and type of one frame, from the header of its file.

    Attributes
    ----------
    shape : tuple[int, ...]
        (rows, columns), and colours where there are several. [px]
    dtype : str
        Name of the numpy type, such as "uint16".
    """

    shape: tuple[int, ...]
    dtype: str

    def __str__(self) -> str:
        return f"{describe_shape(self.shape)} {self.dtype}"


# Stands for a frame whose data lie behind the end of the file.
TRUNCATED = FrameKind((0, 0), "truncated")


class FrameFile(ABC):
    """An open file that holds one or more frames; each is read by itself, in any order.

    `read` may be called from several threads at once. A reader keeps no decoded frame.

    Attributes
    ----------
    kinds : Sequence[FrameKind]
        Kind of each frame, as the header states it.
    bits : int | None
        Significant bits of a count; None where the file does not state them.
    times : Array | None
        Time of each frame from the first one, (frame,); None where the file has none. [s]
    channels : Sequence[int] | None
        Channel of each frame, counted from 1; None where the file has no channels.
    companions : Sequence[Path]
        Other files that hold a part of this recording, such as the header beside raw data.
    array_order : {"", "row", "column", "unknown"}
        Order of the numbers of an image; empty for a format that has one order.
    serial : str
        Serial number of the camera; empty where the file has none.
    """

    kinds: Sequence[FrameKind]
    bits: int | None = None
    times: Array | None = None
    channels: Sequence[int] | None = None
    companions: Sequence[Path] = ()
    array_order: str = ""
    serial: str = ""

    @abstractmethod
    def read(self, index: int) -> AnyArray:
        """Decode one frame.

        Parameters
        ----------
        index : int
            Position in the file, counted from 0.

        Returns
        -------
        array, (y, x), and colours where there are several
            Counts as they are stored, without scaling, rows from the top of the image. [DN]

        Raises
        ------
        FrameError
            With the bare reason, if the data of this frame are damaged.
        """

    def close(self) -> None:  # noqa: B027 - a reader without an open file needs none
        """Close the file; `read` is not called after it."""


@dataclass(frozen=True)
class Format:
    """A file format and its reader.

    Attributes
    ----------
    name : str
        Name of the format in messages and in the table of the documentation.
    suffixes : tuple[str, ...]
        Endings of file names in lower case, with the dot.
    recognise : Callable[[Path, bytes], bool] | None
        Whether a file is of this format, from its path and its first 512 bytes; None for one
        that has no mark but its suffix.
    open : Callable[[Path], FrameFile]
        Opens a file and reads its header; FrameError with the bare reason where it is damaged. A
        reason that ends with a full stop includes what to do.
    extra : str
        Extra of erlif that installs what the reader needs; empty where nothing more is needed.
    open_dataset : Callable[[Path, str], FrameFile] | None
        Opens one of several arrays in a file by its path; None for a format without such paths.
    movie : bool
        Whether a file is a whole recording. Files of another format may be parts of one, whose
        names differ in their numbers alone.
    beside : tuple[str, ...]
        Endings of what lies beside a file under its name and belongs to the same recording: a
        header, or the counts; empty for a folder.
    """

    name: str
    suffixes: tuple[str, ...]
    recognise: Callable[[Path, bytes], bool] | None
    open: Callable[[Path], FrameFile]
    extra: str = ""
    open_dataset: Callable[[Path, str], FrameFile] | None = None
    movie: bool = False
    beside: tuple[str, ...] = ()

    def fits(self, path: Path, head: bytes) -> bool:
        """Whether a file is of this format, from its path and its first bytes."""
        if self.recognise is None:
            return path.suffix.lower() in self.suffixes
        return self.recognise(path, head)


# Units of times, as cameras, xarray, OME and ImageJ write them. [s]
SECONDS: dict[str, float] = {name: size for size, names in LAYOUTS["seconds"] for name in names}


def describe_shape(shape: tuple[int, ...]) -> str:
    """Width x height, in the order of a camera's data sheet."""
    return " x ".join(str(n) for n in reversed(shape))


def colour_camera(what: str = "recording") -> ErlifError:
    """The refusal of a recording, or of another thing, of a colour camera."""
    return FrameError(
        f"the {what} is of a colour camera. Film thickness needs counts of one band in each pixel: "
        "record with a monochrome camera."
    )


def read_header(source: Source, name: str, start: int = 0, *, size: int | None = None) -> Any:
    """Read the numbers of a header that lie at fixed places.

    Parameters
    ----------
    source : Source
    name : str
        Name of the layout in headers.toml.
    start : int
        Where the header begins. [byte]
    size : int, optional
        Its size, where that differs between versions. [byte]

    Returns
    -------
    object
        With an attribute for each field, 0 for one beyond `size`.

    Raises
    ------
    FrameError
        With the bare reason, if the file ends before.
    """
    fields: dict[str, Any] = {}
    for field, (code, place) in LAYOUTS[name].items():
        length = struct.calcsize(code)
        there = size is None or place + length <= size
        fields[field] = struct.unpack(code, source.read(start + place, length))[0] if there else 0
    return SimpleNamespace(**fields)


def check_claim(frames: int, kind: FrameKind, size: int, *, packing: float = 1.0) -> None:
    """Refuse a header that claims more frames or pixels than its file can hold.

    Parameters
    ----------
    frames : int
        Number of frames in the header.
    kind : FrameKind
        Shape and type in the header.
    size : int
        Size of the file, or of the files, that hold the data. [byte]
    packing : float
        Highest ratio of the decoded to the stored size in this format.

    Raises
    ------
    FrameError
        With the bare reason.

    Examples
    --------
    >>> check_claim(2, FrameKind((64, 80), "uint16"), size=20_480)
    >>> check_claim(2, FrameKind((64, 80), "uint16"), size=20_479)
    Traceback (most recent call last):
    ...
    erlif.core.errors.FrameError: the file is damaged: 20479 bytes cannot hold 2 frames of ...
    """
    if frames < 1 or min(kind.shape, default=0) < 1:
        raise FrameError("the file holds no image")
    claimed = frames * math.prod(kind.shape) * np.dtype(kind.dtype).itemsize
    if frames > MOST_FRAMES or claimed > packing * size:
        raise FrameError(
            f"the file is damaged: {size} bytes cannot hold {frames} frame"
            f"{'s' if frames > 1 else ''} of {kind}"
        )
