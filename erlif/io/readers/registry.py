"""The table of formats, and the one way into every file of frames."""

from __future__ import annotations

import math
import os
import re
import stat
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache, lru_cache
from importlib import metadata
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.core.guarded import file_stamp
from erlif.io.readers.base import MOST_FRAMES, MOST_PIXELS, Format, FrameFile
from erlif.io.readers.fits import FITS
from erlif.io.readers.genicam import GENICAM
from erlif.io.readers.hdf5 import HDF5
from erlif.io.readers.lavision import IM7, SET
from erlif.io.readers.norpix import NORPIX
from erlif.io.readers.npy import NPY
from erlif.io.readers.pco import PCO
from erlif.io.readers.phantom import PHANTOM
from erlif.io.readers.photron import PHOTRON
from erlif.io.readers.pictures import BMP, PGM, PNG
from erlif.io.readers.princeton import PRINCETON
from erlif.io.readers.tiff import TIFF

# The formats of erlif, in the order in which a file is compared with them.
FORMATS: tuple[Format, ...] = (
    *(TIFF, PHOTRON, PHANTOM, NORPIX, GENICAM, IM7, SET, PCO, PRINCETON),
    *(PNG, BMP, PGM, NPY, FITS, HDF5),
)

_NO_COUNTS = (
    "compressed with losses or with a palette: its values are no counts. Save the raw counts as "
    "TIFF."
)

# Formats that are known and not read: suffixes, first bytes, reason. A package may read them.
_UNREAD: tuple[tuple[tuple[str, ...], bytes, str], ...] = (
    ((".jpg", ".jpeg", ".jpe"), rb"\xff\xd8\xff", f"it is a JPEG image, {_NO_COUNTS}"),
    ((".jp2",), rb".{4}jP  ", f"it is a JPEG 2000 image, {_NO_COUNTS}"),
    ((".gif",), rb"GIF8", f"it is a GIF image, {_NO_COUNTS}"),
    ((".webp",), rb"RIFF.{4}WEBP", f"it is a WebP image, {_NO_COUNTS}"),
    (
        (".avi",),
        rb"RIFF.{4}AVI ",
        "it is an AVI film, which is not read: it has 8 bits, and most programs change the counts. "
        "Export the raw counts of the camera as TIFF.",
    ),
    (
        (".sif",),
        rb"Andor Technology Multi-Channel File",
        "it is an Andor SIF file, which is not read. Export the frames in Andor Solis as TIFF of "
        "16 bits or as FITS.",
    ),
    (
        (".dcimg",),
        rb"DCIMG",
        "it is a Hamamatsu DCIMG file, which is not read. Export the frames in HCImage as TIFF of "
        "16 bits.",
    ),
    (
        (),
        rb"MATLAB 5.0 MAT-file",
        "it is a MATLAB file of version 5 to 7, which is not read. Save the frames with "
        "save(..., '-v7.3').",
    ),
    (
        (".gz",),
        rb"\x1f\x8b",
        "it is compressed by gzip, which is not read. Expand the file with gunzip.",
    ),
)

# Group of entry points in which other packages name a `Format`.
ENTRY_POINTS = "erlif.readers"

# Bytes by which a format is recognised.
_HEAD = 512

# Files kept open between two frames.
_MOST_OPEN = 16


def open_frames(path: Path, *, dataset: str = "") -> FrameFile:
    """Open a file of frames with the reader of its format.

    A format is recognised by the content of the file, and by the suffix where no content fits.
    Formats of other packages are asked last, so that they cannot change how a known file is read.

    Parameters
    ----------
    path : Path
        An ordinary file.
    dataset : str
        Path of the array within the file, for formats that hold several.

    Returns
    -------
    FrameFile
        To be closed by the caller.

    Raises
    ------
    FrameError
        With the bare reason, if the file cannot be opened, is of no known format or is damaged.

    Examples
    --------
    >>> import tempfile, numpy as np, tifffile
    >>> path = Path(tempfile.mkdtemp(), "frames.dat")
    >>> tifffile.imwrite(path, np.zeros((5, 64, 80), np.uint16))
    >>> file = open_frames(path)
    >>> len(file.kinds), str(file.kinds[4]), file.read(4).shape
    (5, '80 x 64 uint16', (64, 80))
    >>> file.close()
    """
    try:
        head = _read_head(path)
        form = find_format(path, head)
        return _open(form, path, dataset)
    except OSError as error:
        raise FrameError(f"the file cannot be read: {error.strerror or error}") from error


def find_format(path: Path, head: bytes) -> Format:
    """The format of a file.

    Parameters
    ----------
    path : Path
    head : bytes
        The first 512 bytes of the file.

    Returns
    -------
    Format

    Raises
    ------
    FrameError
        With the bare reason, if no format fits.

    Examples
    --------
    >>> find_format(Path("frame.dat"), b"II*\\0").name
    'TIFF'
    """
    if found := _find_by_content(path, head):
        return found
    for _, start, reason in _UNREAD:
        if re.match(start, head, re.DOTALL):
            raise FrameError(reason)

    # a damaged start hides the format from all, the suffix still names it
    named = find_by_suffix(path.suffix)
    if named is not None:
        return named
    if unread := why_unread(path.suffix):
        raise FrameError(unread)
    foreign, faults = _foreign_formats()
    known = ", ".join(entry.name for entry in (*FORMATS, *foreign))
    raise FrameError(
        f"its format is none of those that are read: {known}. Convert it to TIFF, or install a "
        f"package that has a reader for it.{''.join(faults)}"
    )


def find_by_content(path: Path) -> Format | None:
    """The format of a file by its first bytes, whatever its suffix.

    Returns
    -------
    Format or None
        None where no reader takes the file, or it cannot be read.

    Examples
    --------
    >>> find_by_content(Path("calibration/wedge/camera1_dark.tif")).name
    'TIFF'
    """
    try:
        return _find_by_content(path, _read_head(path))
    except (OSError, FrameError):
        return None


def _find_by_content(path: Path, head: bytes) -> Format | None:
    for entry in FORMATS:
        if entry.fits(path, head):
            return entry
    for entry in _foreign_formats()[0]:
        with suppress(Exception, SystemExit):  # a fault of another package is none of the file
            if entry.fits(path, head):
                return entry
    return None


def find_by_suffix(suffix: str) -> Format | None:
    """The format that the suffix of a file names, in upper or lower case.

    Returns
    -------
    Format or None
        None where no reader, of erlif or of another package, has this suffix.

    Examples
    --------
    >>> find_by_suffix(".MRAW").name
    'Photron MRAW'
    """
    known = (*FORMATS, *_foreign_formats()[0])
    return next((entry for entry in known if suffix.lower() in entry.suffixes), None)


def why_unread(suffix: str) -> str:
    """Why files of this suffix are not read, and what to do; empty for any other suffix.

    Examples
    --------
    >>> why_unread(".gz")
    'it is compressed by gzip, which is not read. Expand the file with gunzip.'
    """
    return next((reason for suffixes, _, reason in _UNREAD if suffix.lower() in suffixes), "")


@contextmanager
def borrow_frames(path: Path, *, dataset: str = "") -> Iterator[FrameFile]:
    """A file that stays open for the next frame, shared by the threads of this process.

    Parameters
    ----------
    path : Path
        An ordinary file. One that has changed since it was opened is opened again.
    dataset : str
        As in `open_frames`.

    Yields
    ------
    FrameFile
        Not to be closed, and not to be used after the block.

    Raises
    ------
    FrameError
        As `open_frames`.

    Examples
    --------
    >>> import tempfile, numpy as np, tifffile
    >>> path = Path(tempfile.mkdtemp(), "frames.tif")
    >>> tifffile.imwrite(path, np.zeros((5, 64, 80), np.uint16))
    >>> with borrow_frames(path) as file:
    ...     file.read(3).shape
    (64, 80)
    """
    try:
        stamp = file_stamp(path)
    except OSError as error:
        raise FrameError(f"the file cannot be read: {error.strerror or error}") from error
    with _opening:  # of several threads the second waits and finds the file open
        kept = _keep(path, dataset, *stamp)
    yield kept.file


class _Kept:
    """An open file in one of its states, closed when the last block that uses it has dropped it."""

    def __init__(self, path: Path, dataset: str, *stamp: int) -> None:
        self.file = open_frames(path, dataset=dataset)
        weakref.finalize(self, self.file.close)


_opening = threading.Lock()

# The files of this process that stay open; the one unused for longest is dropped first.
_keep = lru_cache(maxsize=_MOST_OPEN)(_Kept)


def _begin_anew() -> None:
    """Forget the open files of another process, and its lock."""
    global _opening
    _opening = threading.Lock()
    _keep.cache_clear()


if hasattr(os, "register_at_fork"):  # not on Windows, where no process is forked
    # a forked process shares the places in the files of its parent, and a lock that may be taken
    os.register_at_fork(after_in_child=_begin_anew)


def _read_head(path: Path) -> bytes:
    """First bytes of an ordinary file; a pipe or a device is not opened."""
    state = path.stat()
    if not stat.S_ISREG(state.st_mode):
        raise FrameError("it is not an ordinary file. Put the recording itself in its place.")
    if not state.st_size:
        raise FrameError("the file is empty")
    with path.open("rb", buffering=0) as file:
        return file.read(_HEAD)


def _open(form: Format, path: Path, dataset: str) -> FrameFile:
    if dataset and form.open_dataset is None:
        raise FrameError(
            f"it is a {form.name} file, which has no datasets. Remove the key dataset for it."
        )
    try:
        if dataset and form.open_dataset is not None:
            file = form.open_dataset(path, dataset)
        else:
            file = form.open(path)
    except ModuleNotFoundError as error:
        raise FrameError(_missing(form, error.name or "")) from error
    except SystemExit as error:  # a reader of another package
        raise FrameError(f"the reader of {form.name} ended itself: {error}") from error
    if not 0 < len(file.kinds) <= MOST_FRAMES:
        count = len(file.kinds)
        file.close()
        raise FrameError(f"the file claims {count} frames" if count else "the file holds no image")
    large = next((kind for kind in set(file.kinds) if math.prod(kind.shape) > MOST_PIXELS), None)
    if large is not None:
        file.close()
        raise FrameError(f"it claims {large}, more than the {MOST_PIXELS / 1e6:.0f} MP of a frame")
    return file


def _missing(form: Format, package: str) -> str:
    """The package that a reader lacks, and the command that installs it."""
    advice = f"'erlif[{form.extra}]'" if form.extra else package
    return (
        f"the reader of {form.name} needs the Python package {package}, which is not installed. "
        f"Install it with: pip install {advice}."
    )


@cache
def _foreign_formats() -> tuple[list[Format], list[str]]:
    """Formats of other packages by the names of their entry points, and why some are not used."""
    formats, faults = [], []
    for point in sorted(metadata.entry_points(group=ENTRY_POINTS), key=lambda point: point.name):
        try:
            loaded = point.load()
        except (Exception, SystemExit) as error:  # another package may raise anything
            loaded = f"{type(error).__name__}: {error}"
        if isinstance(loaded, Format):
            formats.append(loaded)
        else:
            reason = loaded if isinstance(loaded, str) else "it is no erlif.readers.Format"
            faults.append(f" The reader {point.name} cannot be loaded ({reason}).")
    return formats, faults
