"""An output takes its name in one step: it is either complete or still the previous one."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from erlif.core.errors import OutputError

OWN_FORMATS = (
    b"\x89HDF\r\n\x1a\n",
    b"\x89PNG\r\n\x1a\n",
    b"%PDF",
    b"<?xml ve",  # SVG
    b"<!DOCTYP",
    b"<!doctyp",
)
"""First bytes of the formats that erlif writes."""


def refuse_existing(output: Path, *, overwrite: bool) -> None:
    """Refuse an output that exists, or that erlif cannot have written.

    Parameters
    ----------
    output : Path
        File or directory to be written.
    overwrite : bool
        Allow to replace an earlier output. A file of another format is refused all the same: a
        wrong name must not destroy the user's own data.

    Raises
    ------
    OutputError
        If the output may not be replaced.

    Examples
    --------
    >>> refuse_existing(Path("no such film.nc"), overwrite=False)
    """
    if not output.exists():
        return
    if not overwrite:
        raise OutputError(
            f"{output} exists already; use --overwrite to replace it, or -o for another name."
        )
    if not _is_own(output):
        raise OutputError(
            f"Expected {output} to be an earlier output; it is something else, which --overwrite "
            "does not replace. Use -o for another name."
        )


def _is_own(output: Path) -> bool:
    """Whether an existing file or directory has a format that erlif writes, or is empty."""
    if output.is_dir():
        is_store = (output / "zarr.json").is_file() or not any(output.iterdir())
        return output.suffix == ".zarr" and is_store
    with output.open("rb") as file:
        start = file.read(8)
    return not start or start.startswith(OWN_FORMATS)


@contextmanager
def replacing(output: Path, *, scratch: Path | None = None) -> Iterator[Path]:
    """Write an output under another name and give it its own name when it is complete.

    Parameters
    ----------
    output : Path
        File or directory to be written.
    scratch : Path, optional
        Name to write to, on the same disk; default: a hidden name beside `output`.

    Returns
    -------
    context manager
        Gives the name to write to. It replaces `output` in one step when the block ends without an
        exception, and is removed otherwise.

    Raises
    ------
    OutputError
        If the output cannot be written; the previous one is then intact.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     output = Path(folder, "report.html")
    ...     with replacing(output) as scratch:
    ...         _ = scratch.write_text("complete")
    ...         output.exists()
    ...     output.read_text()
    False
    'complete'
    """
    scratch = scratch or output.with_name(f".{output.name}.unfinished")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        remove(scratch)
        yield scratch
        take_name(scratch, output)
    except OSError as error:
        raise write_error(output, error) from error
    finally:
        remove(scratch)


def take_name(scratch: Path, output: Path) -> None:
    """Give a complete file or directory its name, in place of the previous one."""
    if scratch.is_dir() and output.exists():
        _exchange(scratch, output)
    else:
        scratch.replace(output)


def _exchange(scratch: Path, output: Path) -> None:
    """Put a directory in the place of another one.

    Only files can be replaced in one step. The old directory keeps a name beside the new one until
    the exchange is complete.
    """
    old = output.with_name(f".{output.name}.old")
    remove(old)
    output.rename(old)
    try:
        scratch.rename(output)
    except BaseException:
        old.rename(output)
        raise
    remove(old)


def write_error(output: Path, error: OSError) -> OutputError:
    """Error for an output that could not be written."""
    reason = os.strerror(error.errno) if error.errno else str(error)
    return OutputError(
        f"{output} could not be written: {reason}. The previous output is intact. "
        "Make room or choose another place with -o, and start again."
    )


def remove(path: Path) -> None:
    """Remove a file or a directory with all it holds; what cannot be removed stays."""
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
