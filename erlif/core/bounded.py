"""Files that are read whole: regular ones only, and up to a size."""

from __future__ import annotations

import csv
import errno
import io
import os
import re
import stat
from pathlib import Path

# A number with a decimal comma, in two parts.
_DECIMAL_COMMA = re.compile(r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)$")

_KINDS = {
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def read_bounded(path: Path, *, largest: int) -> bytes:
    """Read a whole file, if it is a regular one of limited size.

    A pipe or a device has no end and would block the program or fill its memory.

    Parameters
    ----------
    path : Path
    largest : int
        Size above which the file is not read. [byte]

    Returns
    -------
    bytes

    Raises
    ------
    OSError
        If the file cannot be read, is not a regular file or is too large; ``strerror`` holds the
        reason.

    Examples
    --------
    >>> read_bounded(Path("/dev/zero"), largest=100)
    Traceback (most recent call last):
    OSError: [Errno 22] it is a device, not a regular file: '/dev/zero'
    """
    # opening a pipe without this would wait for its other end
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    state = os.fstat(handle)
    if not stat.S_ISREG(state.st_mode):
        os.close(handle)
        kind = _KINDS.get(stat.S_IFMT(state.st_mode), "something else")
        raise OSError(errno.EINVAL, f"it is {kind}, not a regular file", str(path))

    with os.fdopen(handle, "rb") as file:
        # a file may grow while it is read, and some of no size have contents without end
        content = file.read(min(state.st_size, largest) + 1)
        if len(content) > state.st_size:
            content += file.read(largest + 1 - len(content))
        if len(content) > largest:
            size = max(state.st_size, len(content)) / 1e6
            raise OSError(
                errno.EFBIG,
                f"it holds {size:.1f} MB or more; at most {largest / 1e6:.0f} MB are read",
                str(path),
            )
    return content


def read_rows(path: Path, *, largest: int) -> list[tuple[int, list[str]]]:
    """Read the rows of a CSV file in UTF-8.

    Semicolons or tabs separate the columns where the first row has no comma; numbers may then have
    decimal commas, which become points.

    Parameters
    ----------
    path : Path
    largest : int
        Size above which the file is not read. [byte]

    Returns
    -------
    list of (int, list of str)
        Number of each row that is not empty, counted from 1, and its cells without blanks around
        them.

    Raises
    ------
    OSError
        As `read_bounded`.
    ValueError
        If the file is no text, or no CSV.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "profile.csv")
    >>> _ = path.write_text("x_mm, thickness_um\\n\\n0,1.5\\n")
    >>> read_rows(path, largest=100)
    [(1, ['x_mm', 'thickness_um']), (3, ['0', '1.5'])]
    """
    # "utf-8-sig" also reads the byte order mark that spreadsheets write
    text = read_bounded(path, largest=largest).decode("utf-8-sig")
    if "\0" in text:
        raise ValueError("it holds a null byte")
    first = text.lstrip().partition("\n")[0]
    separator = next((one for one in ",;\t" if one in first), ",")
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        rows = [[cell.strip() for cell in row] for row in lines]
    except csv.Error as error:
        raise ValueError(str(error)) from error
    if separator != ",":
        rows = [[_DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in row] for row in rows]
    return [(number, row) for number, row in enumerate(rows, 1) if any(row)]
