"""A run directory that is being filled: pairs found, measured and kept for who looks at them."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array, FlagImage, Image
from erlif.core.errors import ErlifError
from erlif.io.ingest import FramePairs, Run
from erlif.io.ingest.arrivals import Arrival, Arrivals
from erlif.io.ingest.containment import named_files, refuse_outside
from erlif.io.ingest.encoder_log import read_log
from erlif.io.ingest.images import read_headers
from erlif.io.ingest.recording import choose_columns
from erlif.io.settings import read_run_settings
from erlif.pipeline.chain import one_thread_per_frame
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.refusals import refusal
from erlif.pipeline.watch.alarms import Alarms
from erlif.pipeline.watch.live import LiveFilm, LiveMap, LivePair, run_of

_logger = logging.getLogger(__name__)

# Pairs from which references and camera map are found again: four times as many each time, up to
# what the registration of a whole run uses.
_REFINED = (2, 8, 32)

# Time between two looks at the whole directory, for changes that nothing reported, and between two
# readings of the log. [s]
_RESCAN, _LOG = 1.0, 0.5

# A rescan may take this share of the time at most. [1]
_SHARE = 0.1

# Time for which reports of changes are gathered. [ms]
_GATHER = 10

# A file of this name in the run directory ends the watch.
STOP = "stop"


@dataclass(frozen=True)
class WatchState:
    """What is known of a run that is watched, at one moment.

    Attributes
    ----------
    version : int
        Rises with every change.
    frames : tuple[int, int]
        Complete frames of each camera.
    arrived : int
        Pairs that are complete.
    measured : tuple[LivePair, ...]
        In the order in which they were measured.
    latest : LivePair | None
        The last of them in the order of the recording.
    newest : LiveMap | None
        Map of the latest pair that was measured.
    angles : Array
        Encoder angle by place in the recording, (frame,), as far as the log has it. [degree]
    registered_on : int
        Pairs from which references and camera map were found; 0 before.
    missing : dict[int, int]
        Frames of one camera alone: number to the camera that lacks it.
    faults : tuple[str, ...]
        Files that cannot be read, and what keeps the film from being measured.
    alarms : dict[str, str]
        Alarms that are raised now.
    since : float
        Time of the latest pair. [s since 1970]
    """

    version: int = 0
    frames: tuple[int, int] = (0, 0)
    arrived: int = 0
    measured: tuple[LivePair, ...] = ()
    latest: LivePair | None = None
    newest: LiveMap | None = None
    angles: Array = field(default_factory=lambda: np.empty(0))
    registered_on: int = 0
    missing: dict[int, int] = field(default_factory=dict)
    faults: tuple[str, ...] = ()
    alarms: dict[str, str] = field(default_factory=dict)
    since: float = 0.0


class Watch:
    """A run directory that is watched: threads find pairs and measure the newest first.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``; frames and log may come later.
    calibration : Calibration or path, optional
        As for `erlif.process`.
    alarms : Alarms
    workers : int, optional
        Threads that measure; default: one per processor.
    allow_outside : bool
        As for `erlif.process`.

    Raises
    ------
    ErlifError
        If settings or calibration cannot be used.
    """

    def __init__(
        self,
        run_dir: Path,
        *,
        calibration: Calibration | str | Path | None = None,
        alarms: Alarms | None = None,
        workers: int | None = None,
        allow_outside: bool = False,
    ) -> None:
        if find_spec("watchfiles") is None:
            raise refusal("no_watchfiles")
        self.directory, self.settings = run_dir, read_run_settings(run_dir)
        if not allow_outside:
            refuse_outside(run_dir, named_files(self.settings))
        one, two = self.settings.camera1, self.settings.camera2
        depths = one.bit_depth, two.bit_depth
        nothing = FramePairs(run_dir, ((), ()), (0, 0), depths)
        self.calibration = find_calibration(
            run_of(run_dir, self.settings, nothing), calibration, allow_outside=allow_outside
        )
        self.alarms = alarms or Alarms()
        self.alarmed: dict[str, str] = {}
        """Every alarm that was raised, with its first sentence."""
        self._workers = workers or os.cpu_count() or 1
        self._arrivals = Arrivals(run_dir, self.settings)
        self._pairs = nothing
        self._arrived: list[Arrival] = []
        self._waiting: list[int] = []
        self._measured: list[LivePair] = []
        self._latest: LivePair | None = None
        self._newest: LiveMap | None = None
        self._film: LiveFilm | None = None
        self._preparing = False
        self._faults: dict[str, str] = {}
        self._missing: dict[int, int] = {}
        self._angles: Array = np.empty(0)
        self._version = 0
        self._opened = time.time()
        self._changed = threading.Condition()
        self._ended = threading.Event()

    @contextmanager
    def running(self) -> Iterator[Watch]:
        """Watch in threads while the block runs."""
        threads = [threading.Thread(target=self._find, name="arrivals", daemon=True)]
        threads += [
            threading.Thread(target=self._work, name=f"measure {n}", daemon=True)
            for n in range(self._workers)
        ]
        with one_thread_per_frame():
            for thread in threads:
                thread.start()
            try:
                yield self
            finally:
                self._ended.set()
                with self._changed:
                    self._changed.notify_all()
                for thread in threads:
                    thread.join()

    # what is seen

    def state(self) -> WatchState:
        """What is known now."""
        with self._changed:
            measured = tuple(self._measured)
            since = self._arrived[-1].time if self._arrived else self._opened
            return WatchState(
                self._version,
                self._arrivals.counts(),
                len(self._arrived),
                measured,
                self._latest,
                self._newest,
                self._angles,
                0 if self._film is None else self._film.pairs,
                self._missing,
                tuple(self._faults.values()),
                self.alarms.raised([self._latest] * (self._latest is not None), silence=time.time() - since),
                since,
            )

    def wait(self, version: int, timeout: float) -> WatchState:
        """The state, as soon as it is newer than `version`, or after `timeout` seconds."""
        with self._changed:
            self._changed.wait_for(lambda: self._version > version, timeout)
        return self.state()

    # the source of the page

    def describe(self) -> dict[str, Any]:
        """As `erlif.show.view.live.LiveSource`."""
        return {
            "name": self.settings.name,
            "pitch": self.settings.optics.pixel_pitch * 1e3,
        }

    def news(self, version: int, pairs: int, angles: int, timeout: float) -> dict[str, Any]:
        """As `erlif.show.view.live.LiveSource`."""
        state = self.wait(version, timeout)
        latest = state.latest
        return {
            "version": state.version,
            "frames": state.frames,
            "arrived": state.arrived,
            "measured": len(state.measured),
            "pairs": [as_row(one) for one in state.measured[pairs:]],
            "newest": None if latest is None else as_row(latest),
            "shape": None if state.newest is None else state.newest.flags.shape,
            "angles": [round(float(angle), 3) for angle in state.angles[angles:]],
            "faults": [*state.faults, *_describe_missing(state.missing)],
            "alarms": state.alarms,
        }

    def newest(self) -> tuple[str, Image, FlagImage] | None:
        """As `erlif.show.view.live.LiveSource`."""
        shown = self.state().newest
        return None if shown is None else (f"pair {shown.number}", shown.thickness, shown.flags)

    def is_quiet(self, limit: float | None) -> bool:
        """Whether the run has ended: a file ``stop``, or no new pair for `limit` seconds.

        Before the first pair only the file ends it.
        """
        if (self.directory / STOP).exists():
            return True
        with self._changed:
            done = self._arrived and not self._waiting
            return bool(
                limit is not None and done and time.time() - self._arrived[-1].time > limit
            )

    # threads

    def _find(self) -> None:
        """Look for new files when a change is reported, and from time to time."""
        from watchfiles import watch

        looked = read = 0.0
        pause = 0.0
        changes = watch(
            self.directory,
            debounce=_GATHER,
            step=1,
            stop_event=self._ended,
            rust_timeout=100,
            yield_on_timeout=True,
            watch_filter=None,
            raise_interrupt=False,
        )
        for found in changes:
            now = time.monotonic()
            whole = now - looked > max(_RESCAN, pause)
            if whole:
                self._take(self._arrivals.look())
                looked = time.monotonic()
                pause = (looked - now) / _SHARE
                self._audit()
            elif found:
                self._take(self._arrivals.look([Path(path) for _, path in found]))
            if now - read > _LOG:
                self._read_angles()
                read = now

    def _take(self, fresh: list[Arrival]) -> None:
        """Queue pairs that have arrived."""
        if not fresh:
            return
        with self._changed:
            first = len(self._arrived)
            self._arrived += fresh
            self._waiting += range(first, len(self._arrived))
            if not first:
                self._open(fresh[0])
            one, two = self._pairs.pages
            pages = ((*one, *(a.pages[0] for a in fresh)), (*two, *(a.pages[1] for a in fresh)))
            self._pairs = FramePairs(
                self.directory, pages, self._pairs.shape, self._pairs.bit_depths
            )
            self._notify()

    def _open(self, first: Arrival) -> None:
        """Learn the shape of the frames from the first pair."""
        kind = read_headers([first.pages[0].path], first.pages[0].selection).kinds[0]
        self._pairs = FramePairs(self.directory, ((), ()), kind.shape[:2], self._pairs.bit_depths)

    def _audit(self) -> None:
        """Frames that are missing, and files that cannot be read."""
        missing, broken = self._arrivals.missing(), self._arrivals.unreadable()
        with self._changed:
            if (missing, broken) != (self._missing, self._faults.get("files", [])):
                self._missing = missing
                self._faults.pop("files", None)
                if broken:
                    self._faults["files"] = "; ".join(broken[:3])
                self._notify()

    def _read_angles(self) -> None:
        """Angles of the log, as far as it has come; a log that cannot be read yet has none."""
        encoder = self.settings.encoder
        if encoder is None or encoder.file is None or not (self.directory / encoder.file).exists():
            return
        try:
            log, _ = read_log(
                self.directory / encoder.file,
                choose_columns(encoder),
                frames=len(self._arrived),
                needs_angle=False,
            )
            angles = log.angle.values
        except (ErlifError, AttributeError):
            return
        with self._changed:
            if len(angles) != len(self._angles):
                self._angles = angles
                self._notify()

    def _work(self) -> None:
        """Measure pairs, the newest first, until the watch ends."""
        while not self._ended.is_set():
            task = self._next()
            if task is not None:
                task()

    def _next(self) -> Callable[[], None] | None:
        with self._changed:
            if self._due():
                self._preparing = True
                run = run_of(self.directory, self.settings, self._pairs)
                return lambda: self._prepare(run)
            if self._film is None or not self._waiting:
                self._changed.wait(0.2)
                return None
            film, frame, pairs = self._film, self._waiting.pop(), self._pairs
            arrival = self._arrived[frame]
        return lambda: self._measure(film, pairs, frame, arrival)

    def _due(self) -> bool:
        """Whether references and camera map are to be found, or found again."""
        if self._preparing:
            return False
        known = 0 if self._film is None else self._film.pairs
        return any(known < count <= len(self._arrived) for count in _REFINED)

    def _prepare(self, run: Run) -> None:
        try:
            film: LiveFilm | None = LiveFilm.prepare(run, self.calibration)
            fault = ""
        except ErlifError as error:
            film, fault = None, str(error)
        with self._changed:
            self._preparing = False
            self._faults.pop("film", None)
            if film is not None:
                self._film = film
            elif self._film is None:
                self._faults["film"] = fault
                self._changed.wait(1.0)  # the next pairs may show what these do not
            self._notify()

    def _measure(self, film: LiveFilm, pairs: FramePairs, frame: int, arrival: Arrival) -> None:
        try:
            pair, shown = film.measure(pairs, frame, arrival)
        except ErlifError as error:
            with self._changed:
                self._faults[f"pair {arrival.number}"] = str(error)
                self._notify()
            return
        with self._changed:
            self._measured.append(pair)
            if self._latest is None or pair.place > self._latest.place:
                self._latest, self._newest = pair, shown
            for name, text in self.alarms.raised([pair], silence=0.0).items():
                self.alarmed.setdefault(name, text)
            self._notify()

    def _notify(self) -> None:
        """Wake who waits for a change; the lock is held."""
        self._version += 1
        self._changed.notify_all()


def _describe_missing(missing: dict[int, int]) -> list[str]:
    """Frames of one camera alone in words."""
    texts = []
    for camera in (1, 2):
        numbers = sorted(number for number, lacking in missing.items() if lacking == camera)
        if numbers:
            listed = ", ".join(str(number) for number in numbers[:5])
            more = f" and {len(numbers) - 5} more" if len(numbers) > 5 else ""
            texts.append(f"camera {camera} lacks frame {listed}{more}")
    return texts


def as_row(pair: LivePair) -> dict[str, Any]:
    """A pair as names and plain numbers, None for what is not known.

    Examples
    --------
    >>> pair = LivePair(7, 0, 0.0, 2.0, 0.1, float("nan"), 0.1, 1.0, (9.0, 9.0), (0.0, 0.0), (0.0, 0.0))
    >>> as_row(pair)["film_min"], as_row(pair)["film_mean"]
    (2.0, None)
    """
    return {name: _plain(value) for name, value in pair._asdict().items()}


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
