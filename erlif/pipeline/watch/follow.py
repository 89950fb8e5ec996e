"""The threads that look into a run directory while it is filled."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Self

from erlif.core.errors import ErlifError
from erlif.core.units import count_of
from erlif.io.ingest import FramePairs
from erlif.io.ingest.arrivals import Arrival, Arrivals
from erlif.io.ingest.containment import named_files, refuse_outside
from erlif.io.ingest.images import read_headers
from erlif.io.settings import read_run_settings
from erlif.pipeline.chain import one_thread_per_frame
from erlif.pipeline.watch.faults import describe_missing

# Time between two looks at the whole directory, for changes that nothing reported. [s]
_RESCAN = 1.0

# A rescan may take this share of the time at most. [1]
_SHARE = 0.1

# Time for which reports of changes are gathered. [ms]
_GATHER = 10


class Follower:
    """A run directory and the pairs that have arrived in it; threads do the rest.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``; frames and log may come later.
    allow_outside : bool
        As for `erlif.process`.

    Raises
    ------
    ErlifError
        If the settings cannot be used, or watchfiles is not installed.
    """

    def __init__(self, run_dir: Path, *, allow_outside: bool = False) -> None:
        if find_spec("watchfiles") is None:
            raise ErlifError(
                "erlif watch needs watchfiles, which is not installed. Install it with: pip "
                'install "erlif[watch]".'
            )
        self.directory = run_dir
        self.settings = read_run_settings(run_dir, allow_outside=allow_outside)
        if not allow_outside:
            refuse_outside(run_dir, named_files(self.settings))
        self._arrivals = Arrivals(run_dir, self.settings)
        self._arrived: list[Arrival] = []
        self._shape = (0, 0)
        self._next_look = 0.0
        self._missing: dict[str, int] = {}
        self._faults: dict[str, str] = {}
        self._version = 0
        self._opened = time.time()
        self._changed = threading.Condition()
        self._ended = threading.Event()
        self.status = ""
        """Text of the page about the end of the run; empty while the run is recorded."""
        self.closed = False
        """Whether nothing more follows."""
        self.failed = False
        """Whether the end is one without a film."""

    def jobs(self) -> Sequence[Callable[[], None]]:
        """Functions that further threads call repeatedly until the end."""
        return ()

    @contextmanager
    def running(self) -> Iterator[Self]:
        """Follow the directory in threads while the block runs."""
        threads = [threading.Thread(target=self._find, name="arrivals", daemon=True)]
        threads += [
            threading.Thread(target=self._repeat, args=(job,), name=f"watch {n}", daemon=True)
            for n, job in enumerate(self.jobs())
        ]
        with one_thread_per_frame():
            for thread in threads:
                thread.start()
            try:
                yield self
            finally:
                self._ended.set()
                with self._changed:
                    self._notify()
                for thread in threads:
                    thread.join()

    def announce(self, status: str, *, closed: bool = False, failed: bool = False) -> None:
        """State something of the end on the page; with `closed`, the last thing."""
        with self._changed:
            self.status, self.closed, self.failed = status, closed, failed
            self._notify()

    def wait(self, version: int, timeout: float) -> int:
        """Wait up to `timeout` seconds for a version newer than `version`; return the version."""
        with self._changed:
            self._changed.wait_for(lambda: self._version > version, timeout)
            return self._version

    def wait_for_map(self, after: int, timeout: float) -> None:
        """Wait until the newest map is of a later pair than `after`, at most `timeout` seconds."""
        with self._changed:
            self._changed.wait_for(lambda: self.closed or self.place() > after, timeout)

    def place(self) -> int:
        """Place in the recording of the newest pair that can be shown; -1 before the first."""
        return self._arrived[-1].place if self._arrived else -1

    def describe(self) -> dict[str, Any]:
        """Name of the run, and size of a pixel. [mm]"""
        return {"name": self.settings.name, "pitch": self.settings.optics.pixel_pitch * 1e3}

    @property
    def silence(self) -> float:
        """Time since the last pair arrived; 0 before the first. [s]"""
        return time.time() - self._arrived[-1].time if self._arrived else 0.0

    def is_there(self) -> bool:
        """Whether the directory can be seen; a share that has gone may come back."""
        return (self.directory / "run.toml").exists()

    def faults(self) -> dict[str, str]:
        """Faults that keep pairs from use or need attention: subject to sentence."""
        return self._faults | describe_missing(self._missing)

    def _repeat(self, job: Callable[[], None]) -> None:
        while not self._ended.is_set():
            job()

    def _find(self) -> None:
        """Find new files when a change is reported, and at intervals."""
        while not self._ended.is_set():
            try:
                self._follow_changes()
            except OSError:  # no directory, or no more of them can be followed
                self._ended.wait(_RESCAN)
                self._look_at_all()

    def _follow_changes(self) -> None:
        """Take what is new until the directory is another one, as after a share was away."""
        from watchfiles import watch

        here, state = self.directory.absolute(), self.directory.stat()
        for found in watch(
            here,
            debounce=_GATHER,
            step=1,
            stop_event=self._ended,
            rust_timeout=100,
            yield_on_timeout=True,
            watch_filter=None,
            raise_interrupt=False,
        ):
            if time.monotonic() > self._next_look:
                self._look_at_all()
                if not os.path.samestat(self.directory.stat(), state):
                    return
            elif found:
                names = (os.path.relpath(path, here) for _, path in found)
                self._take(self._arrivals.look([self.directory / name for name in names]))

    def _look_at_all(self) -> None:
        """Search the directory for unreported changes and for missing frames."""
        begun = time.monotonic()
        self._take(self._arrivals.look())
        ended = time.monotonic()
        self._next_look = ended + max(_RESCAN, (ended - begun) / _SHARE)
        self._audit()

    def _take(self, fresh: list[Arrival]) -> None:
        """Add pairs that have arrived to those that are known."""
        if not fresh:
            return
        with self._changed:
            if self._shape == (0, 0):
                # the first pair shows the shape of the frames
                first = fresh[0].pages[0]
                rows, columns = read_headers([first.path], first.selection).kinds[0].shape[:2]
                self._shape = (rows, columns)
            self._arrived += fresh
            self._notify()

    def _pairs_of(self, arrivals: Sequence[Arrival]) -> FramePairs:
        """Frame pairs of some of the arrivals."""
        pages = tuple(one.pages[0] for one in arrivals), tuple(one.pages[1] for one in arrivals)
        depths = self.settings.camera1.bit_depth, self.settings.camera2.bit_depth
        return FramePairs(self.directory, pages, self._shape, depths)

    def _audit(self) -> None:
        """Frames that are missing, and files that cannot be read."""
        missing, broken = self._arrivals.missing(), "; ".join(self._arrivals.doubtful()[:3])
        behind = self._arrivals.stopped()
        found = {"files": broken, "stopped": "", "directory": ""}
        if behind is not None:
            camera, frames = behind[0], count_of(behind[1], "frame")
            found["stopped"] = (
                f"camera {camera} has stopped: the other one has written {frames} since"
            )
        if not self.is_there():
            found["directory"] = f"{self.directory} is away: no frame can be seen until it is back"
        with self._changed:
            known = {name: self._faults.get(name, "") for name in found}
            if (missing, found) != (self._missing, known):
                self._missing = missing
                for name, text in found.items():
                    self._note(name, text)
                self._notify()

    def _note(self, subject: str, fault: ErlifError | str) -> None:
        """Keep a fault in words, or forget it where the text is empty; the lock is held."""
        if text := str(fault):
            self._faults[subject] = text
        else:
            self._faults.pop(subject, None)

    def _notify(self) -> None:
        """Wake who waits for a change; the lock is held."""
        self._version += 1
        self._changed.notify_all()


def as_plain(record: Any) -> dict[str, Any]:
    """A named tuple as names and values for JSON, None for what is not known.

    Examples
    --------
    >>> from collections import namedtuple
    >>> as_plain(namedtuple("Pair", "film drift")(2.0, (math.nan, 0.5)))
    {'film': 2.0, 'drift': [None, 0.5]}
    """
    return {name: _as_json(value) for name, value in record._asdict().items()}


def _as_json(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_as_json(one) for one in value]
    return None if isinstance(value, float) and math.isnan(value) else value
