"""Unfinished work beside its output, one file per trigger, so that an interrupted run resumes."""

from __future__ import annotations

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
from erlif.files.replacing import _not_written, _remove


class _Lock:
    """Keeps a second process off an output that is being made; it ends with its process, however that ends.

    Where the system has no advisory locks, processes are not told apart.
    """

    def __init__(self, output: Path) -> None:
        self.path = output.with_name(f".{output.name}.lock")
        self.file: IO[str] | None = None
        try:
            import fcntl
        except ImportError:
            return
        try:
            with suppress(FileExistsError):  # where a file stands in the way, the next line says so
                self.path.parent.mkdir(parents=True, exist_ok=True)
            file = self.path.open("w")
        except OSError as error:
            raise _not_written(output, error) from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.close()
            raise OutputError(
                f"Expected {output} to be free; another erlif process is making it. Wait for it, or use -o for another name."
            ) from error
        self.file = file

    def release(self) -> None:
        """Let others come."""
        if self.file is not None:
            self.path.unlink(missing_ok=True)
            self.file.close()
            self.file = None


class PartialFilm:
    """The triggers of a film that is being made, each in a file beside the output.

    Parameters
    ----------
    output : Path
        File or directory to be.
    key : str
        Identifies inputs and settings; a partial film of another key is thrown away, one of the same key is resumed.
    """

    def __init__(self, output: Path, key: str) -> None:
        self.output = output
        self.directory = output.with_name(output.name + ".partial")
        self.lock = _Lock(output)
        marker = self.directory / "key"
        try:
            if (
                self.directory.exists()
                and not marker.is_file()
                and (self.directory.is_file() or any(self.directory.iterdir()))
            ):
                raise OutputError(
                    f"Expected {self.directory} to be free for the work in progress; something else stands there. Move it away, or use -o for "
                    "another name."
                )
            if marker.is_file() and marker.read_bytes() != key.encode():
                shutil.rmtree(self.directory)
            self.directory.mkdir(parents=True, exist_ok=True)
            marker.write_bytes(key.encode())
            for stray in self.directory.glob("*.unfinished"):
                _remove(stray)
        except OSError as error:
            self.lock.release()
            raise _not_written(output, error) from error
        except OutputError:
            self.lock.release()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nothing behind where no trigger was finished."""
        if not any(self.directory.glob("trigger_*.npz")):
            self.discard()
        self.lock.release()

    def has(self, trigger: int) -> bool:
        """Whether this trigger is finished."""
        return zipfile.is_zipfile(self._path(trigger))

    def put(
        self,
        trigger: int,
        maps: Mapping[str, AnyArray],
        variables: list[MapVariable],
        numbers: Mapping[str, npt.ArrayLike],
    ) -> None:
        """Keep the maps (y, x) and small numbers of one trigger; raises OutputError, and keeps what was put before."""
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
        scratch = self._path(trigger).with_suffix(".unfinished")
        try:
            with scratch.open("wb") as file:
                np.savez(file, **record)  # type: ignore[arg-type]
            scratch.replace(self._path(trigger))
        except OSError as error:
            scratch.unlink(missing_ok=True)
            raise _not_written(self.output, error) from error

    def chunk(self, trigger: int, variable: MapVariable) -> bytes:
        """Compressed map of one trigger."""
        with np.load(self._path(trigger)) as record:
            return bytes(record[f"map_{variable.name}"])

    def size(self) -> int:
        """Bytes of what was kept."""
        return sum(path.stat().st_size for path in self.directory.glob("trigger_*.npz"))

    def numbers(self, trigger: int) -> dict[str, AnyArray]:
        """Small numbers of one trigger."""
        with np.load(self._path(trigger)) as record:
            return {
                name.removeprefix("number_"): record[name]
                for name in record
                if name.startswith("number_")
            }

    def discard(self) -> None:
        """Remove what was kept, once the output stands."""
        shutil.rmtree(self.directory, ignore_errors=True)

    def _path(self, trigger: int) -> Path:
        return self.directory / f"trigger_{trigger:05d}.npz"
