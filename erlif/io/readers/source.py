"""Positioned reads of a file, from several threads at once, and small text files beside it."""

from __future__ import annotations

import os
import stat
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Self

import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.errors import FrameError

# Size of a text file above which it is no header of frames. [byte]
_LONGEST = 4 * 2**20


class Source:
    """An ordinary file, read at places that the caller names.

    No read depends on where another one ended, so that threads do not disturb each other.

    Parameters
    ----------
    path : Path
        A pipe or a device is refused: opening it could wait for ever.

    Raises
    ------
    FrameError
        With the bare reason, if the file cannot be opened.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "frames.raw")
    >>> _ = path.write_bytes(b"header and counts")
    >>> with Source(path) as source:
    ...     source.size, source.read(11, 6)
    (17, b'counts')
    """

    def __init__(self, path: Path) -> None:
        try:
            if not stat.S_ISREG(path.stat().st_mode):
                raise FrameError(
                    f"{path.name} is not an ordinary file. Put the recording itself in its place."
                )
            self._file = path.open("rb", buffering=0)
        except OSError as error:
            raise FrameError(f"{path.name} cannot be read: {error.strerror or error}") from error
        self.size = os.fstat(self._file.fileno()).st_size
        self._lock = threading.Lock()

    def read(self, offset: int, count: int) -> bytes:
        """Bytes of a part of the file.

        Parameters
        ----------
        offset : int
            Where the part begins. [byte]
        count : int
            Its length. [byte]

        Returns
        -------
        bytes

        Raises
        ------
        FrameError
            With the bare reason, if the file ends before.
        """
        self._check(offset, count)
        buffer = np.empty(count, np.uint8)
        self.fill(buffer, offset)
        return buffer.tobytes()

    def fill(self, buffer: AnyArray, offset: int) -> None:
        """Read a part of the file into an array.

        Parameters
        ----------
        buffer : array
            Contiguous; as many bytes as it has are read.
        offset : int
            Where the part begins. [byte]

        Raises
        ------
        FrameError
            With the bare reason, if the file ends before.
        """
        self._check(offset, buffer.nbytes)
        rest = memoryview(buffer.reshape(-1).view(np.uint8).data)
        try:
            while rest:
                got = self._read_some(rest, offset)
                if not got:  # the file was cut after it was opened
                    raise FrameError("the file ends within the frame")
                rest, offset = rest[got:], offset + got
        except OSError as error:
            raise FrameError(f"the file cannot be read: {error.strerror or error}") from error

    def close(self) -> None:
        """Close the file; nothing is read after it."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *fault: object) -> None:
        self.close()

    def _check(self, offset: int, count: int) -> None:
        """Refuse a part outside the file before memory is taken for it."""
        if offset < 0 or count < 0 or offset + count > self.size:
            raise FrameError("the file is truncated or damaged")

    def _read_some(self, buffer: memoryview, offset: int) -> int:
        """Read as many bytes as the system returns at once."""
        if hasattr(os, "preadv"):
            return os.preadv(self._file.fileno(), [buffer], offset)

        # Windows has no positioned read; there the threads wait for each other
        with self._lock:
            self._file.seek(offset)
            return self._file.readinto(buffer) or 0


def find_beside(path: Path, suffixes: Sequence[str]) -> Path | None:
    """A file of the same name and another ending in the same folder.

    Parameters
    ----------
    path : Path
    suffixes : sequence of str
        Endings in lower case, the preferred first; files in upper case are found too.

    Returns
    -------
    Path or None
        None where there is no such file.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> (folder / "run1.CIH").touch()
    >>> find_beside(folder / "run1.mraw", (".cihx", ".cih")).name
    'run1.CIH'
    """
    for suffix in suffixes:
        for ending in (suffix, suffix.upper(), suffix.capitalize()):
            # with_suffix would take "run 1.5" for a name with the ending ".5"
            beside = path.with_name(path.name.removesuffix(path.suffix) + ending)
            if beside.exists():
                return beside
    return None


def read_text(path: Path) -> str:
    """Text of a header, whose comments may be in any code page.

    Parameters
    ----------
    path : Path
        A file of at most 4 MiB.

    Returns
    -------
    str
        Bytes outside ASCII stand as single characters; keys and numbers are ASCII.

    Raises
    ------
    FrameError
        With the bare reason, if the file cannot be read or is too large for a header.
    """
    with Source(path) as source:
        if source.size > _LONGEST:
            raise FrameError(
                f"{path.name} has {source.size} bytes, too many for a header. Put the header that "
                "was saved with the frames in its place."
            )
        return source.read(0, source.size).decode("latin-1")
