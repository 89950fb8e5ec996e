"""A run that is watched: its pairs measured as they arrive, the newest first."""

from __future__ import annotations

import errno
import math
import os
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from erlif.calibration import Calibration
from erlif.core.arrays import Array, FlagImage, Image
from erlif.core.errors import EncoderError, ErlifError
from erlif.core.guarded import file_stamp
from erlif.io.ingest import FramePairs, Run
from erlif.io.ingest.arrivals import Arrival
from erlif.io.ingest.recording import read_so_far
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.watch.alarms import Alarms
from erlif.pipeline.watch.faults import describe_fall, describe_pulses
from erlif.pipeline.watch.follow import Follower, as_plain
from erlif.pipeline.watch.live import LiveFilm, LiveGaps, LiveMap, LivePair, run_of
from erlif.ratio import PulseSample
from erlif.trend import ContactChoice, GapShape

# Pairs from which references and camera map are found, and found again: up to what the
# registration of a whole run uses.
_REFINED = (2, 12)

# Time between two readings of the log, and between two attempts to register. [s]
_LOG, _AGAIN = 0.5, 1.0

# Reading a long log may take this share of the time at most. [1]
_SHARE = 0.1

# Time for which the alarm of a single pair is shown. [s]
_HELD = 3.0

# Pairs in which the pulses of both cameras are compared.
_PULSES = 12

# Errors of opening or reading that pass: no handle or memory is free, a share has a fault.
_PASSING = errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EIO, errno.ESTALE

# Faults that keep pairs from being measured.
_HOLDING = {"film", "share"}

# A file of this name in the run directory ends the watch.
STOP = "stop"


@dataclass(frozen=True)
class WatchState:
    """State of a watched run at one moment.

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
        Its map.
    logged : dict[str, Array]
        Angle [degree], load [N] and temperature [degC] by place in the recording, (frame,), as far
        as the log has them.
    registered_on : int
        Pairs from which references and camera map were found; 0 before.
    faults : dict[str, str]
        Frames that are missing, files that cannot be read, light that falls, what keeps films from
        being found: subject to a sentence.
    alarms : dict[str, str]
        Alarms that are raised now, or were raised by a pair of the last seconds.
    """

    version: int
    frames: tuple[int, int]
    arrived: int
    measured: tuple[LivePair, ...]
    latest: LivePair | None
    newest: LiveMap | None
    logged: dict[str, Array]
    registered_on: int
    faults: dict[str, str]
    alarms: dict[str, str]


class Watch(Follower):
    """A run directory that is watched: threads find pairs and measure the newest first.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``; frames and log may come later.
    calibration : Calibration or path, optional
        As for `erlif.process`.
    alarms : Alarms, optional
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
        super().__init__(run_dir, allow_outside=allow_outside)
        run = run_of(run_dir, self.settings, self._pairs_of([]))
        self.calibration = find_calibration(run, calibration, allow_outside=allow_outside)
        """Ratio to film, and what is kept of the camera map of the fixture."""
        self.alarms = alarms or Alarms()
        self.alarmed: dict[str, str] = {}
        """Every alarm that was raised, with its first sentence."""
        self._raised: dict[str, tuple[float, str]] = {}
        self._workers = workers or os.cpu_count() or 1
        self._waiting: list[int] = []
        self._failed: set[int] = set()
        self._given_up = 0
        self._measured: list[LivePair] = []
        self._latest: LivePair | None = None
        self._newest: LiveMap | None = None
        self._film: LiveFilm | None = None
        self._preparing = False
        self._gaps: list[LiveGaps] = []
        self._choice = ContactChoice()
        self._contact: GapShape | None = None
        self._renewed = 0
        """Version with which the pairs so far got the minimum of another contact."""
        self._pulses: deque[tuple[int, PulseSample]] = deque(maxlen=_PULSES)
        self._logged: dict[str, Array] = {}
        self._log: tuple[tuple[int, int, int], int] | None = None
        self._pause = _LOG
        self._away = 0.0

    def jobs(self) -> Sequence[Callable[[], None]]:
        """As `Follower.jobs`: pairs are measured, and the log is read."""
        return [self._read_log, *[self._work] * self._workers]

    # what is seen

    def state(self) -> WatchState:
        """Present state of the run."""
        with self._changed:
            since = time.monotonic() - _HELD
            alarms = {name: text for name, (when, text) in self._raised.items() if when > since}
            alarms |= self.alarms.raised([], silence=self.silence)
            return WatchState(
                self._version,
                self._arrivals.counts(),
                len(self._arrived),
                tuple(self._measured),
                self._latest,
                self._newest,
                self._logged,
                0 if self._film is None else self._film.pairs,
                self.faults(),
                alarms,
            )

    def is_quiet(self, limit: float | None) -> bool:
        """Whether the run has ended: a file ``stop``, or no new pair for `limit` seconds.

        Before the first pair, while the directory is away, and while pairs that have come are
        measured, only the file ends it.
        """
        if (self.directory / STOP).exists():
            return True
        if not self.is_there():
            self._away = time.time()
        if limit is None or min(self.silence, time.time() - self._away) <= limit:
            return False
        with self._changed:
            left = len(self._arrived) - len(self._measured) - self._given_up
            held = len(self._arrived) < _REFINED[0] or not self._faults.keys().isdisjoint(_HOLDING)
        return held or not left

    # the source of the page

    def news(self, version: int, pairs: int, angles: int, timeout: float) -> dict[str, Any]:
        """The state once it is newer than `version`, with the pairs and angles after so many.

        All pairs come again where the minimum of another contact is theirs; `after` is the number
        of pairs that precede those that come.
        """
        self.wait(version, timeout)
        state = self.state()
        logged = state.logged.get("angle", np.empty(0))
        pairs = pairs if version >= self._renewed else 0
        return {
            "after": pairs,
            "version": state.version,
            "status": self.status,
            "closed": self.closed,
            "failed": self.failed,
            "frames": state.frames,
            "arrived": state.arrived,
            "measured": len(state.measured),
            "pairs": [as_plain(one) for one in state.measured[pairs:]],
            "newest": None if state.latest is None else as_plain(state.latest),
            "angles": [round(float(angle), 3) for angle in logged[angles:]],
            "logged": {
                name: float(values[-1])
                for name, values in state.logged.items()
                if values.size and math.isfinite(values[-1])
            },
            "registered_on": state.registered_on,
            "faults": list(state.faults.values()),
            "alarms": state.alarms,
        }

    def newest(self, layer: str) -> tuple[int, str, Image, FlagImage] | None:
        """Place, title, film thickness and flags of the newest pair, (y, x); None before one."""
        with self._changed:
            place, shown = self.place(), self._newest
        return None if shown is None else (place, shown.title, shown.thickness, shown.flags)

    def place(self) -> int:
        """As `Follower.place`, of the pairs that are measured."""
        return -1 if self._latest is None else self._latest.place

    # threads

    def _take(self, fresh: list[Arrival]) -> None:
        if not fresh:
            return
        first = len(self._arrived)
        with self._changed:
            self._keep_alarms([])  # a silence that ends now was none at the end of the recording
            super()._take(fresh)
            self._waiting += range(first, len(self._arrived))

    def _read_log(self) -> None:
        """Take what the log has so far; a log that cannot be read yet has none."""
        self._ended.wait(self._pause)
        encoder = self.settings.encoder
        if encoder is None or encoder.file is None or not self._arrived:
            return
        begun, pulses = time.monotonic(), self._arrived[-1].place + 1
        try:
            state = file_stamp(self.directory / encoder.file), pulses
            if state == self._log:
                return
            logged = read_so_far(self.directory, encoder, pulses)
        except (OSError, EncoderError):
            return
        self._log, self._pause = state, max(_LOG, (time.monotonic() - begun) / _SHARE)
        with self._changed:
            same = logged.keys() == self._logged.keys()
            if not (same and all(np.array_equal(logged[k], self._logged[k]) for k in logged)):
                self._logged = logged
                self._notify()

    def _work(self) -> None:
        """Prepare, or measure the newest pair that waits, or wait for one."""
        with self._changed:
            # references and camera map are to be found, or found again
            known = 0 if self._film is None else self._film.pairs
            due = any(known < n <= len(self._arrived) for n in _REFINED)
            prepare = due and not self._preparing
            if prepare:
                self._preparing = True
            elif self._film is None or not self._waiting:
                self._changed.wait(0.2)
                return
            else:
                film, frame = self._film, self._waiting.pop()
            pairs = self._pairs_of(self._arrived if prepare else [self._arrived[frame]])
        if prepare:
            self._prepare(run_of(self.directory, self.settings, pairs))
        else:
            self._measure(film, pairs, frame)

    def _prepare(self, run: Run) -> None:
        try:
            film: LiveFilm | None = LiveFilm.prepare(run, *self.calibration)
            fault = ""
        except ErlifError as error:
            film, fault = self._film, str(error)
            self._ended.wait(_AGAIN)  # the next pairs may show what these do not
            with self._changed:  # files may have got other names
                self._arrived = [self._arrivals.renew(one) for one in self._arrived]
        with self._changed:
            self._preparing = False
            self._film = film
            self._note("film", "" if film is not None else fault)
            self._notify()

    def _measure(self, film: LiveFilm, pairs: FramePairs, frame: int) -> None:
        arrival = self._arrived[frame]
        try:
            pair, shown, gaps = film.measure(pairs, 0, arrival)
        except ErlifError as error:
            named = self._arrivals.renew(arrival)
            away = _passes(error) or not all(page.path.exists() for page in named.pages)
            if away:
                self._ended.wait(_AGAIN)  # a share that has gone may come back, a handle be free
            with self._changed:
                # the share may have come back since: a pair is given up at the second attempt
                again = away or frame not in self._failed
                if not away:
                    self._failed.add(frame)
                if again:
                    self._arrived[frame] = named
                    self._waiting.insert(0, frame)
                else:
                    self._given_up += 1
                if away or not again:
                    self._note("share" if away else f"pair {arrival.place}", error)
                self._notify()
            return
        with self._changed:
            pair = self._keep(pair, gaps)
            if pair.place > self.place():
                self._latest, self._newest = pair, shown
            self._keep_alarms([pair])
            self._note("share", "")
            self._note("limit", self.alarms.describe_unjudged(pair))
            self._note("light", describe_fall(self._measured))
            self._pulses.append((pair.place, shown.pulse))
            if len(self._measured) % _PULSES == 0:
                self._note("pulses", describe_pulses(self._pulses))
            self._notify()

    def _keep(self, pair: LivePair, gaps: LiveGaps | None) -> LivePair:
        """Add a measured pair, whose minimum is that of the contact of all pairs so far."""
        self._measured.append(pair)
        if gaps is None:
            return pair
        self._gaps.append(gaps)
        self._choice.add(*gaps.bent, level=gaps.level)
        first = len(self._gaps) - 1
        if self._choice.contact is not self._contact:
            self._contact, self._renewed, first = self._choice.contact, self._version + 1, 0
        for n in range(first, len(self._gaps)):
            minimum, std = self._gaps[n].films[self._contact]
            self._measured[n] = self._measured[n]._replace(film_min=minimum, film_min_std=std)
        latest = self._latest
        if first == 0 and latest is not None:
            self._latest = next(one for one in self._measured if one.place == latest.place)
        return self._measured[-1]

    def _audit(self) -> None:
        super()._audit()
        with self._changed:
            if self.alarms.raised([], silence=self.silence):
                self._notify()  # nothing else does while no pair comes

    def _keep_alarms(self, pairs: list[LivePair]) -> None:
        raised = self.alarms.raised(pairs, silence=0.0 if pairs else self.silence)
        self.alarmed = raised | self.alarmed
        self._raised |= {name: (time.monotonic(), text) for name, text in raised.items()}


def _passes(error: BaseException | None) -> bool:
    """Whether an error comes from one of the system that passes."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in _PASSING:
            return True
        error = error.__cause__
    return False
