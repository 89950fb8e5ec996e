"""Small text files beside a file of counts, which hold its header."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.io.readers.source import Source

_LONGEST = 4 * 2**20
"""Size of a text file above which it is no header of frames. [byte]"""


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
