"""A file of frames behind one interface, whatever its format."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from erlif.core.arrays import AnyArray, Array


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
    """

    kinds: Sequence[FrameKind]
    bits: int | None = None
    times: Array | None = None

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
    recognise : Callable[[Path, bytes], bool]
        Whether a file is of this format, from its path and its first 512 bytes.
    open : Callable[[Path], FrameFile]
        Opens a file and reads its header; FrameError with the bare reason where it is damaged.
    extra : str
        Extra of erlif that installs what the reader needs; empty where nothing more is needed.
    """

    name: str
    suffixes: tuple[str, ...]
    recognise: Callable[[Path, bytes], bool]
    open: Callable[[Path], FrameFile]
    extra: str = ""
