"""An output takes its name in one step: it is complete, or it is the previous one."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from erlif.core.errors import OutputError

_OUR_FORMATS = (b"\x89HDF\r\n\x1a\n", b"\x89PNG\r\n\x1a\n", b"%PDF", b"<!DOCTYP", b"<!doctyp")


def refuse_existing(output: Path, *, overwrite: bool) -> None:
    """Raise OutputError if `output` exists and may not be replaced, or is something that erlif has not written."""
    if not output.exists():
        return
    if not overwrite:
        raise OutputError(
            f"{output} exists already; use --overwrite to replace it, or -o for another name."
        )
    if output.is_dir():
        ours = output.suffix == ".zarr" and (
            (output / "zarr.json").is_file() or not any(output.iterdir())
        )
    else:
        with output.open("rb") as file:
            start = file.read(8)
        ours = not start or start.startswith(_OUR_FORMATS)
    if not ours:
        raise OutputError(
            f"Expected {output} to be an output of before; it is something else, which --overwrite does not replace. Use -o for "
            "another name."
        )


@contextmanager
def replacing(output: Path, *, scratch: Path | None = None) -> Iterator[Path]:
    """Give a name to write to; it takes the place of `output` in one step when the block ends without error.

    `scratch` is that name, on the same disk; by default a hidden one beside `output`.
    """
    scratch = scratch or output.with_name(f".{output.name}.unfinished")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        _remove(scratch)
        yield scratch
        if scratch.is_dir() and output.exists():
            _exchange(scratch, output)
        else:
            scratch.replace(output)
    except OSError as error:
        raise _not_written(output, error) from error
    finally:
        _remove(scratch)


def _exchange(scratch: Path, output: Path) -> None:
    """Put a directory in the place of another; only files can be replaced in one step."""
    old = output.with_name(f".{output.name}.old")
    _remove(old)
    output.rename(old)
    try:
        scratch.rename(output)
    except BaseException:
        old.rename(output)
        raise
    _remove(old)


def _not_written(output: Path, error: OSError) -> OutputError:
    return OutputError(
        f"{output} could not be written: {os.strerror(error.errno) if error.errno else error}. What stood there before is as it was. Make room or choose another place "
        "with -o, and start again."
    )


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
