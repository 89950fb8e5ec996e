"""Unfinished work beside its output, one file for each trigger, so that a run can be resumed."""

from __future__ import annotations

import logging
import shutil
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Self

import numpy as np
import numpy.typing as npt

from erlif.core.arrays import AnyArray
from erlif.core.errors import OutputError
from erlif.files.compression import MapVariable, compress, round_bits
from erlif.files.replacing import remove, write_error

_logger = logging.getLogger(__name__)


class _Lock:
    """Keeps a second process from writing the same output; it ends with its process in any case.

    On a system without advisory locks a second process is not noticed.
    """

    def __init__(self, output: Path) -> None:
        self.path = output.with_name(f".{output.name}.lock")
        self.file: IO[str] | None = None
        try:
            import fcntl
        except ImportError:
            return

        try:
            with suppress(FileExistsError):  # a file in place of the folder fails in the next line
                self.path.parent.mkdir(parents=True, exist_ok=True)
            file = self.path.open("w")
        except OSError as error:
            raise write_error(output, error) from error

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.close()
            raise OutputError(
                f"Expected {output} to be free; another erlif process is writing it. "
                "Wait for it, or use -o for another name."
            ) from error
        self.file = file

    def release(self) -> None:
        """Allow other processes to write the output."""
        if self.file is not None:
            self.path.unlink(missing_ok=True)
            self.file.close()
            self.file = None


class PartialFilm:
    """The finished triggers of a film in the making, each in a file beside the output.

    Parameters
    ----------
    output : Path
        File or directory that the film is written to.
    key : str
        Identifies inputs and settings. Unfinished work of the same key is resumed, work of another
        key is removed.

    Raises
    ------
    OutputError
        If another process is writing the output, or if the place cannot be used.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> variables = [MapVariable("flags", "uint8", {"units": "1"})]
    >>> with TemporaryDirectory() as folder:
    ...     with PartialFilm(Path(folder, "film.nc"), "inputs of May") as work:
    ...         work.put(0, {"flags": np.zeros((2, 3), np.uint8)}, variables, {"frames_used": 1})
    ...     with PartialFilm(Path(folder, "film.nc"), "inputs of May") as again:
    ...         again.has(0), again.has(1)
    (True, False)
    """

    def __init__(self, output: Path, key: str) -> None:
        self.output = output
        """File or directory that the film is written to."""
        self.directory = output.with_name(output.name + ".partial")
        """Where the finished triggers are kept."""
        self.lock = _Lock(output)
        """Held until the work is left."""
        try:
            self._open(key)
        except OSError as error:
            self.lock.release()
            raise write_error(output, error) from error
        except OutputError:
            self.lock.release()
            raise

    def _open(self, key: str) -> None:
        """Resume the work of this key, or begin it in an empty directory."""
        marker = self.directory / "key"
        if not marker.is_file() and self._is_occupied():
            raise OutputError(
                f"Expected {self.directory} to be free for the work in progress; something else "
                "is there. Move it away, or use -o for another name."
            )
        if marker.is_file() and marker.read_bytes() != key.encode():
            _logger.info("unfinished work of other inputs or settings is removed")
            shutil.rmtree(self.directory)
        self.directory.mkdir(parents=True, exist_ok=True)
        marker.write_bytes(key.encode())

        # files that were being written when an earlier process ended
        for stray in self.directory.glob("*.unfinished"):
            remove(stray)
        finished = len(list(self.directory.glob("trigger_*.npz")))
        if finished:
            _logger.info("unfinished work is resumed: %d triggers are finished", finished)

    def _is_occupied(self) -> bool:
        """Whether something that is not ours has the name of the directory."""
        if not self.directory.exists():
            return False
        return self.directory.is_file() or any(self.directory.iterdir())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the output; remove the directory where no trigger is finished."""
        if not any(self.directory.glob("trigger_*.npz")):
            self.discard()
        self.lock.release()

    def has(self, trigger: int) -> bool:
        """Check whether a trigger is finished; a file cut off by a loss of power is not."""
        return zipfile.is_zipfile(self._path(trigger))

    def put(
        self,
        trigger: int,
        maps: Mapping[str, AnyArray],
        variables: list[MapVariable],
        numbers: Mapping[str, npt.ArrayLike],
    ) -> None:
        """Keep the maps and the small arrays of one trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, from 0.
        maps : mapping of str to array, (y, x)
            Map of each variable by its name.
        variables : list of MapVariable
            Type and precision of the maps.
        numbers : mapping of str to array
            Small arrays by name; `numbers` gives them back.

        Raises
        ------
        OutputError
            If they cannot be written; the triggers put before are intact.
        """
        record: dict[str, npt.ArrayLike] = {
            f"number_{name}": np.asarray(value) for name, value in numbers.items()
        }
        for variable in variables:
            values = maps[variable.name]
            if variable.dtype == "float32":
                values = round_bits(values, variable.bits)
            record[f"map_{variable.name}"] = np.frombuffer(
                compress(values.astype(variable.dtype)), np.uint8
            )

        # a trigger is finished when its file has its name, and not before
        scratch = self._path(trigger).with_suffix(".unfinished")
        try:
            with scratch.open("wb") as file:
                np.savez(file, **record)  # type: ignore[arg-type]
            scratch.replace(self._path(trigger))
        except OSError as error:
            scratch.unlink(missing_ok=True)
            raise write_error(self.output, error) from error

    def chunk(self, trigger: int, variable: MapVariable) -> bytes:
        """Compressed map of one trigger, as `compress` gives it."""
        with np.load(self._path(trigger)) as record:
            return bytes(record[f"map_{variable.name}"])

    def size(self) -> int:
        """Size of the finished triggers. [byte]"""
        return sum(path.stat().st_size for path in self.directory.glob("trigger_*.npz"))

    def numbers(self, trigger: int) -> dict[str, AnyArray]:
        """Small arrays of one trigger, by the names given to `put`."""
        with np.load(self._path(trigger)) as record:
            return {
                name.removeprefix("number_"): record[name]
                for name in record
                if name.startswith("number_")
            }

    def discard(self) -> None:
        """Remove the finished triggers, once the output is complete."""
        shutil.rmtree(self.directory, ignore_errors=True)

    def _path(self, trigger: int) -> Path:
        return self.directory / f"trigger_{trigger:05d}.npz"
