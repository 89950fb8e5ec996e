"""Files whose libraries may crash, hang or take the memory, read first in a process of its own.

A damaged HDF5 file may send the library of HDF5 round without end, end the process, or make it take
gigabytes; so may a damaged MATLAB file the reader of scipy. Here they do so to a child process with
bounds on memory and time, and the caller gets an error. The child stays for the next file: asking
it takes a millisecond, starting it two tenths of a second.

This file is also the program of the child and imports nothing of erlif.
"""

from __future__ import annotations

import atexit
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

# Processor time for one file after which the child is ended. A busy machine gives it little of its
# time, so that the time on the clock is bounded for a child that waits without end alone. [s]
LONGEST = 10.0
PATIENCE = 300.0

# What the child may take for an HDF5 file, of which it keeps little, and for a MATLAB file, which
# it reads. [byte]
MEMORY = 2**29, 3 * 2**29

# Numbers of a MATLAB file above which it is not loaded; they take 256 MB.
MOST_NUMBERS = 32_000_000


def file_stamp(path: Path) -> tuple[int, int, int]:
    """Size, time of change and place on the disk, by which a state of a file is known.

    A copy that takes the name of a file may have its size and time, but has another place.
    """
    state = path.stat()
    return state.st_size, state.st_mtime_ns, state.st_ino


def check_hdf5(path: Path) -> None:
    """Refuse an HDF5 file whose attributes, types or texts the library does not survive.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        With the bare reason.
    OSError
        If the file is missing, damaged or of another format.
    """
    known = str(path.absolute()), *file_stamp(path)
    if known not in _written:
        _check_once(*known)


def mark_written(path: Path) -> None:
    """Mark an HDF5 file that this process has just written: `check_hdf5` passes it unread."""
    _written.add((str(path.absolute()), *file_stamp(path)))


_written: set[tuple[str | int, ...]] = set()


@lru_cache(maxsize=256)
def _check_once(path: str, *stamp: int) -> None:
    """Ask for a file once for each of its states."""
    _child.ask("hdf5", path)


def read_matlab(path: Path) -> list[tuple[str, Any]]:
    """Arrays of real numbers in a MATLAB 5 file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    list of (str, array)
        Name and numbers; a field of a structure as "log/angle".

    Raises
    ------
    ValueError, OSError
        With the bare reason, if the file is damaged or its variables too large.

    Examples
    --------
    >>> import tempfile
    >>> from scipy.io import savemat
    >>> path = Path(tempfile.mkdtemp(), "log.mat")
    >>> savemat(path, {"angle": [1.0, 2.0]})
    >>> [(name, values.tolist()) for name, values in read_matlab(path)]
    [('angle', [[1.0, 2.0]])]
    """
    variables: list[tuple[str, Any]] = _child.ask("matlab", str(path.absolute()))
    return variables


class _Child:
    """The child process; a new one where the last has ended."""

    process: subprocess.Popen[bytes] | None = None
    of_parent: subprocess.Popen[bytes] | None = None

    def __init__(self) -> None:
        self.lock = threading.Lock()

    def forget(self) -> None:
        """Drop the child and its pipes in a forked process; they belong to the parent."""
        self.lock = threading.Lock()
        self.of_parent, self.process = self.process, None

    def ask(self, task: str, path: str) -> Any:
        """Run one of `_TASKS` on a file in the child process and return its result."""
        with self.lock:
            process = self._start()
            assert process.stdin is not None
            assert process.stdout is not None
            began = time.monotonic()
            timer = threading.Timer(PATIENCE, process.kill)
            timer.start()
            try:
                pickle.dump((task, path, LONGEST), process.stdin)
                process.stdin.flush()
                done, answer = pickle.load(process.stdout)
            except (EOFError, OSError, pickle.UnpicklingError):
                late = time.monotonic() - began >= PATIENCE
                self.end()
                raise ValueError(_end_of(process.returncode, late=late)) from None
            finally:
                timer.cancel()
        if not done:
            raise answer
        return answer

    def end(self) -> None:
        """End the process."""
        process, self.process = self.process, None
        if process is not None:
            process.kill()
            process.communicate()

    def _start(self) -> subprocess.Popen[bytes]:
        if self.process is not None and self.process.poll() is not None:
            self.end()  # something else has ended it between two files
        if self.process is None:
            # "-P": the folder of this file is no place for imports; in a session of its own, as
            # Ctrl-C ends a recording that is watched, and not the reading of its files
            self.process = subprocess.Popen(
                [sys.executable, "-P", __file__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            )
        return self.process


def _end_of(status: int, *, late: bool) -> str:
    """Describe how the child ended on a file."""
    if late:
        return f"the library that reads it did not end within {PATIENCE:g} s"
    if -status == getattr(signal, "SIGXCPU", None):
        return f"the library that reads it took more than {LONGEST:g} s of processor time"
    name = signal.Signals(-status).name if status < 0 else f"exit status {status}"
    return f"the library that reads it crashed or took too much memory ({name})"


_child = _Child()
atexit.register(_child.end)
if hasattr(os, "register_at_fork"):  # not on Windows, where no process is forked
    os.register_at_fork(after_in_child=_child.forget)


# the child


def _walk_hdf5(path: str) -> None:
    """Read all attributes, and all values that lie in heaps; errors of the library are allowed."""
    import h5py

    _limit_memory(MEMORY[0])

    def visit(name: str, item: Any) -> None:
        for key in item.attrs:
            with suppress(OSError, TypeError, ValueError):
                item.attrs[key]
        with suppress(OSError, TypeError, ValueError):
            if isinstance(item, h5py.Dataset) and item.dtype.hasobject:
                if item.size > MOST_NUMBERS:
                    raise MemoryError("it holds too many texts")
                item[()]

    with h5py.File(path, "r", locking=False) as file:
        visit("/", file)
        file.visititems(visit)


def _load_matlab(path: str) -> list[tuple[str, Any]]:
    """Sizes first, from the headers, then the numbers."""
    from scipy.io import loadmat, whosmat

    _limit_memory(MEMORY[1])
    count = sum(math.prod(shape) for _, shape, _ in whosmat(path))
    if count > MOST_NUMBERS:
        raise ValueError(f"its header states {count} numbers, more than {MOST_NUMBERS}")
    variables = loadmat(path)
    return [
        found
        for name, value in variables.items()
        if not name.startswith("__")
        for found in _numbers(name, value)
    ]


def _numbers(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """An array of real numbers, or those in the fields of a single structure."""
    if value.dtype.names and value.shape == (1, 1):
        for field in value.dtype.names:
            yield from _numbers(f"{name}/{field}", value[field][0, 0])
    elif value.dtype.kind in "fiub" and value.size:
        yield name, value


def _limit_memory(most: int) -> None:
    """Bound what is taken from now on; systems other than Linux bound the time alone."""
    with suppress(ImportError, OSError):
        import resource

        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        _limit(resource.RLIMIT_AS, taken + most)


def _limit_time(most: float) -> None:
    """Bound the processor time from now on; Windows has no such bound."""
    with suppress(ImportError):
        import resource

        _limit(resource.RLIMIT_CPU, math.ceil(time.process_time() + most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def _limit(what: int, most: int) -> None:
    import resource

    hard = resource.getrlimit(what)[1]
    soft = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(what, (soft, hard))


_TASKS: dict[str, Callable[[str], Any]] = {"hdf5": _walk_hdf5, "matlab": _load_matlab}


def _serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Run tasks from `requests` one by one until the parent process ends."""
    while True:
        try:
            task, path, longest = pickle.load(requests)
        except EOFError:
            return
        try:
            _limit_time(longest)
            answer = True, _TASKS[task](path)
        except OSError as error:
            answer = False, OSError(*error.args)
        except Exception as error:  # scipy raises errors of many classes for a damaged file
            answer = False, ValueError(str(error) or type(error).__name__)
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    _serve(sys.stdin.buffer, sys.stdout.buffer)
