"""Unfinished work beside its output, kept trigger by trigger so that a run can be resumed."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Self, TypeAlias

import numpy.typing as npt
import xarray as xr

from erlif.core.errors import OutputError
from erlif.io.files.compression import MapVariable
from erlif.io.files.netcdf_maps import NetcdfMaps
from erlif.io.files.replacement import expect_folder, remove, write_error
from erlif.io.files.zarr_maps import ZarrMaps

_logger = logging.getLogger(__name__)

# Maps of a film in the making, with what is known of each trigger: `encode` them in any thread,
# `put` a trigger, ask whether the store `has` it, take its `numbers` and `finish` the film.
# `NetcdfMaps` takes triggers in their order, in one thread; `ZarrMaps` in any order, from several
# threads and processes.
MapStore: TypeAlias = NetcdfMaps | ZarrMaps


class _Lock:
    """Keeps a second process from writing the same output; it ends with its process in any case.

    On a system or drive without advisory locks a second process is not noticed.
    """

    def __init__(self, output: Path) -> None:
        self.path = self.path_of(output)
        self.file: IO[str] | None = None
        expect_folder(output)
        try:
            import fcntl
        except ImportError:
            return

        try:
            # a link of this name is not ours: what it leads to must not be touched
            flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
            file = os.fdopen(os.open(self.path, flags, 0o666), "w")
        except OSError as error:
            raise write_error(output, error) from error

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError) as error:
            file.close()
            raise OutputError(
                f"Expected {output} to be free; another erlif process is writing it. Wait for it, "
                "or use -o for another name."
            ) from error
        except OSError as error:
            _logger.warning(
                "%s lies on a drive without locks (%s); write it from one process at a time",
                output.name,
                error.strerror,
            )
        self.file = file

    @staticmethod
    def path_of(output: Path) -> Path:
        """File that is locked while the output is written."""
        return output.with_name(f".{output.name}.lock")

    def release(self) -> None:
        """Allow other processes to write the output."""
        if self.file is not None:
            self.path.unlink(missing_ok=True)
            self.file.close()
            self.file = None


class PartialFilm:
    """A film in the making, in a directory beside the output.

    Parameters
    ----------
    output : Path
        ``film.nc``, or ``film.zarr`` for zarr.
    key : str
        Identifies inputs and settings. Unfinished work of the same key is resumed, work of another
        key is removed.
    grid : Dataset
        Coordinates trigger, y and x of the maps.
    variables : sequence of MapVariable
        The maps.

    Raises
    ------
    OutputError
        If another process is writing the output, or if the place cannot be used.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> grid = xr.Dataset(coords={"trigger": [0, 1], "y": [0.0, 0.1], "x": [0.0, 0.1, 0.2]})
    >>> variables = [MapVariable("flags", "uint8", {"units": "1"})]
    >>> with TemporaryDirectory() as folder:
    ...     output = Path(folder, "film.nc")
    ...     with PartialFilm(output, "inputs of May", grid, variables) as work:
    ...         chunks = work.maps.encode({"flags": np.zeros((2, 3), np.uint8)})
    ...         work.put(0, chunks, {"frames_used": 1})
    ...     with PartialFilm(output, "inputs of May", grid, variables) as again:
    ...         again.has(0), again.has(1)
    (True, False)
    """

    def __init__(
        self, output: Path, key: str, grid: xr.Dataset, variables: Sequence[MapVariable]
    ) -> None:
        self.output = output
        """File or directory that the film is written to."""
        self.directory = _directory(output)
        """Directory of the unfinished film and the numbers of its triggers."""
        self.lock = _Lock(output)
        """Held until the work is left."""
        self.maps: MapStore
        """The maps; for zarr it can be sent to other processes, which put triggers themselves."""
        try:
            self._open(key)
            if output.suffix == ".zarr":
                shape = (grid.sizes["trigger"], grid.sizes["y"], grid.sizes["x"])
                store = ZarrMaps(self.directory, tuple(variables), shape, key)
                store.create()
                self.maps = store
            else:
                self.maps = NetcdfMaps(self.directory, grid, variables)
        except BaseException as error:
            self.lock.release()
            if isinstance(error, OSError):
                raise write_error(output, error) from error
            raise

        self._triggers = grid.sizes["trigger"]
        finished = sum(map(self.has, range(self._triggers)))
        if finished:
            _logger.info("unfinished work is resumed: %d triggers are finished", finished)

    def _open(self, key: str) -> None:
        """Resume the work of this key, or begin it in an empty directory."""
        marker = self.directory / "key"
        if not marker.is_file() and self._is_occupied():
            raise OutputError(
                f"Expected {self.directory} to be free for the work in progress; something else is "
                "there. Move it away, or use -o for another name."
            )
        if marker.is_file() and marker.read_bytes() != key.encode():
            _logger.info("unfinished work of other inputs or settings is removed")
            _clear(self.directory)
        self.directory.mkdir(exist_ok=True)
        marker.write_bytes(key.encode())

        # files that were being written when an earlier process ended
        for stray in self.directory.glob("*.unfinished"):
            remove(stray)

    def _is_occupied(self) -> bool:
        """Whether something that is not ours has the name of the directory."""
        if not self.directory.exists():
            return False
        return self.directory.is_file() or any(self.directory.iterdir())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *fault: object) -> None:
        """Release the output; remove the directory where no trigger is finished."""
        self.maps.close()
        if not any(map(self.has, range(self._triggers))):
            self.discard()
        self.lock.release()

    def has(self, trigger: int) -> bool:
        """Check whether a trigger is finished; one cut off by a loss of power is not."""
        return self.maps.has(trigger)

    def put(
        self, trigger: int, chunks: Mapping[str, bytes], numbers: Mapping[str, npt.ArrayLike]
    ) -> None:
        """Keep the chunks and the small arrays of one trigger.

        Arguments as in `NetcdfMaps.put`; `maps.numbers` gives the small arrays back.

        Raises
        ------
        OutputError
            If they cannot be written; the triggers put before are intact.
        """
        try:
            self.maps.put(trigger, chunks, numbers)
        except OSError as error:
            raise write_error(self.output, error) from error

    def discard(self) -> None:
        """Remove what is kept beside the output, once that is complete."""
        _clear(self.directory)


def remove_remains(output: Path) -> None:
    """Remove the leftovers of a process that was killed after its output was complete.

    Parameters
    ----------
    output : Path
        ``film.nc`` or ``film.zarr``.

    Raises
    ------
    OutputError
        If another process is writing the output.

    Examples
    --------
    >>> remove_remains(Path("no such film.nc"))
    """
    directory, lock = _directory(output), _Lock.path_of(output)
    if not output.exists() or not (directory.is_dir() or lock.exists()):
        return
    held = _Lock(output)
    try:
        key = directory / "key"
        is_ours = key.is_file() or (directory.is_dir() and not any(directory.iterdir()))
        if is_ours and not any(directory.glob("maps*")):
            _clear(directory)
    finally:
        held.release()


def _clear(directory: Path) -> None:
    """Remove an unfinished directory, its key last so that a later process recognises it."""
    key = directory / "key"
    if key.is_file():
        key.write_bytes(b"")  # what is half removed is the work of no inputs
    for entry in directory.glob("*"):
        if entry != key:
            remove(entry)
    key.unlink(missing_ok=True)
    with suppress(OSError):
        directory.rmdir()


def _directory(output: Path) -> Path:
    return output.with_name(output.name + ".partial")
