"""An output takes its name in one step: it is either complete or still the previous one."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from erlif.core.errors import OutputError
from erlif.core.hdf5 import open_hdf5
from erlif.core.tables import read_table
from erlif.io.files.descriptions import read_description

# Name of the program, which figures and pages hold among their first or last bytes.
MARK = b"erlif"

# Suffixes of the files of an exported series of grids.
_SERIES = (".pvd", ".vts")

# Errors of a place that may not be written.
_NOT_ALLOWED = (errno.EACCES, errno.EPERM, errno.EROFS)

# Errors of a folder in the place of a file, or the other way round.
_IN_THE_WAY = (errno.EISDIR, errno.ENOTDIR, errno.EEXIST, errno.ENOTEMPTY, errno.ELOOP)

# Bytes at both ends of a file in which the mark is looked for.
_MARKED = 2**16


def refuse_existing(output: Path, *, overwrite: bool, holds: str = "") -> None:
    """Refuse an output that exists, or that erlif has not written.

    Parameters
    ----------
    output : Path
        File or directory to be written.
    overwrite : bool
        Allow to replace an earlier output. A file of another program is refused all the same: a
        wrong name must not destroy the user's own data.
    holds : str
        Variable of the netCDF file or zarr store to be written, which an earlier one then has too:
        a film does not replace a calibration.

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
            f"{output} exists already; use --overwrite to replace it, or give another name."
        )
    if not _is_own(output, holds):
        raise OutputError(
            f"Expected {output} to be an earlier output of the same command; it is something else, "
            "which --overwrite does not replace. Give another name, or move it away."
        )


def _is_own(output: Path, holds: str) -> bool:
    """Whether erlif has written an existing file or directory of this suffix, or it is empty."""
    if output.is_dir():
        store = output.suffix == ".zarr"
        return _is_own_store(output, holds) if store else _is_own_series(output)
    if not output.is_file():  # a pipe or a device
        return False
    if output.stat().st_size == 0:
        return True
    if output.suffix == ".nc":
        return _is_own_netcdf(output, holds)

    with output.open("rb") as file:
        first = file.read(_MARKED)
        file.seek(max(output.stat().st_size - _MARKED, 0))
        last = file.read()
    if first.startswith(_starts("unmarked", output.suffix)):
        return True
    marked = MARK in first or MARK in last
    return marked and first.startswith(_starts("marked", output.suffix))


def _starts(kind: str, suffix: str) -> tuple[bytes, ...]:
    """First bytes of the files of erlif with this suffix."""
    texts = read_table("erlif.io.files", "outputs.toml")[kind].get(suffix, ())
    return tuple(text.encode("latin-1") for text in texts)


def _is_own_netcdf(output: Path, holds: str) -> bool:
    try:
        with open_hdf5(output) as file:
            return "erlif_version" in file.attrs and (not holds or holds in file)
    except Exception:  # damaged bytes make HDF5 raise errors of any kind
        return False


def _is_own_store(output: Path, holds: str) -> bool:
    if not any(output.iterdir()):
        return True
    try:
        attributes = read_description(output, ".").get("attributes")
    except (OSError, ValueError):
        return False
    named = isinstance(attributes, dict) and "erlif_version" in attributes
    return named and (not holds or (output / holds).is_dir())


def _is_own_series(output: Path) -> bool:
    """Whether a folder holds an exported series of grids and nothing else."""
    files = list(output.iterdir())
    lists = [file for file in files if file.suffix == ".pvd"]
    if len(lists) != 1 or not all(file.suffix in _SERIES and file.is_file() for file in files):
        return False
    return _is_own(lists[0], "")


@contextmanager
def replacing(output: Path) -> Iterator[Path]:
    """Write an output under another name and give it its own name when it is complete.

    Parameters
    ----------
    output : Path
        File or directory to be written.

    Returns
    -------
    context manager
        Gives the name to write to, a hidden one beside `output`. It replaces `output` in one step
        when the block ends without an exception, and is removed otherwise.

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
    scratch = output.with_name(f".{output.name}.unfinished")
    expect_folder(output)
    try:
        remove(scratch)
        yield scratch
        take_name(scratch, output)
    except OSError as error:
        raise write_error(output, error) from error
    finally:
        remove(scratch)


def expect_folder(output: Path) -> None:
    """Refuse an output in a folder that does not exist: its name may be misspelt.

    Raises
    ------
    OutputError

    Examples
    --------
    >>> expect_folder(Path("film.nc"))
    """
    if not output.parent.is_dir():
        above = next((each for each in output.absolute().parents if each.is_dir()), output)
        raise OutputError(
            f"Expected an existing folder for the output {output}; {output.parent} is none, of "
            f"which {above} exists. Make it, or correct the name."
        )


def make_folder(folder: Path) -> None:
    """Make the folder of several outputs, where it is new; that above it exists.

    Raises
    ------
    OutputError

    Examples
    --------
    >>> make_folder(Path())
    """
    expect_folder(folder)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise write_error(folder, error) from error


def write_file(output: Path, content: str | bytes) -> Path:
    """Write a file, complete or not at all, as `replacing` does.

    Returns
    -------
    Path
        Its path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write_file(Path(folder, "table.csv"), "complete").read_text()
    'complete'
    """
    with replacing(output) as scratch:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)
    return output


@contextmanager
def replacing_set(folder: Path, names: Sequence[str]) -> Iterator[Path]:
    """Write files that belong together, and give them their names when all are complete.

    The first file is there only while all others belong to it: it is removed before them and takes
    its name after them. A process that is killed in between leaves a set without its first file.

    Errors as in `replacing`.

    Parameters
    ----------
    folder : Path
        Directory of the files; other files in it stay.
    names : sequence of str
        Names of the files of the set, the one by which it is read first. One that is not written is
        removed, as it belongs to an earlier set.

    Returns
    -------
    context manager
        Gives a directory to write to. Its files take their names when the block ends without an
        exception, and are removed otherwise.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with replacing_set(Path(folder), ["a.csv", "b.csv"]) as scratch:
    ...         _ = (scratch / "a.csv").write_text("complete")
    ...         any(Path(folder).glob("*.csv"))
    ...     [path.name for path in Path(folder).iterdir()]
    False
    ['a.csv']
    """
    scratch, previous = folder / ".unfinished", folder / ".previous"
    existed = folder.is_dir()
    expect_folder(folder)
    try:
        remove(scratch)
        folder.mkdir(exist_ok=True)
        scratch.mkdir()
        yield scratch
        written = [path.name for path in scratch.iterdir()]

        # the first file goes first and comes last: without it nobody reads the others
        order = [*names, *sorted(set(written) - set(names))]
        remove(previous)
        previous.mkdir()
        try:
            _move(folder, previous, order)
            _move(scratch, folder, order[::-1])
        except BaseException:
            # also where the user interrupts: the previous set comes back whole
            for name in written:
                if not (scratch / name).exists():  # it has taken its name
                    remove(folder / name)
            _move(previous, folder, order[::-1])
            raise
    except OSError as error:
        raise write_error(folder, error) from error
    finally:
        remove(scratch)
        remove(previous)
        if not existed:
            with suppress(OSError):  # it holds files where the work was completed
                folder.rmdir()


def _move(source: Path, target: Path, names: Sequence[str]) -> None:
    """Move files to another folder of the same disk, in their order; those that are there."""
    for name in names:
        if (source / name).is_file():
            (source / name).replace(target / name)


def take_name(scratch: Path, output: Path) -> None:
    """Rename a complete file or directory to its output name, replacing the previous one."""
    if scratch.is_dir():
        _exchange(scratch, output)
    else:
        scratch.replace(output)


def _exchange(scratch: Path, output: Path) -> None:
    """Put a directory in the place of another one.

    Only files can be replaced in one step. The old directory keeps a name beside the new one until
    the exchange is complete; one that a killed process has left goes with it.
    """
    old = output.with_name(f".{output.name}.old")
    replaced = output.exists()
    if replaced:
        remove(old)
        output.rename(old)
    try:
        scratch.rename(output)
    except BaseException:
        if replaced:
            old.rename(output)
        raise
    remove(old)


def write_error(output: Path, error: OSError) -> OutputError:
    """Error for an output that could not be written, with the advice that its cause needs."""
    reason = os.strerror(error.errno) if error.errno else str(error)
    advice = "Make room"
    if error.errno in _NOT_ALLOWED:
        advice = "Allow to write there"
    elif error.errno in _IN_THE_WAY:
        place = error.filename2 or error.filename or output
        advice = f"Move {place} away"
    return OutputError(
        f"{output} could not be written: {reason}. The previous output is intact. "
        f"{advice} or choose another place, and start again."
    )


def remove(path: Path) -> None:
    """Remove a file or a directory with all it holds; what cannot be removed stays."""
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
