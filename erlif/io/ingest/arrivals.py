"""Frame pairs of a recording that is still being written."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from erlif.core.errors import FrameError
from erlif.core.guarded import file_stamp
from erlif.io.ingest.images import Page, match_files, natural_key, read_headers
from erlif.io.ingest.selection import Selection, select_counts
from erlif.io.settings import RunSettings

# Time after which a frame of one camera alone, or a file that cannot be read, is reported. [s]
PATIENCE = 1.0

# Frames of each camera from which on different numbers are taken for different first numbers.
_FEW = 3

# Characters of a pattern that may match more than one file.
_WILD = re.compile(r"[*?[]")


class Arrival(NamedTuple):
    """A frame pair whose files are complete.

    Attributes
    ----------
    place : int
        Place in the recording, counted from 0 at the first frame of camera 1.
    pages : tuple[Page, Page]
        Camera 1 and camera 2.
    time : float
        When its second image was found complete, on the clock of the arrivals. [s]
    """

    place: int
    pages: tuple[Page, Page]
    time: float


@dataclass
class _Camera:
    """What one camera has written so far.

    Attributes
    ----------
    pattern : str
        File name or glob of its frames.
    selection : Selection
        Part of the files that belongs to it.
    pages : dict[int, Page]
        Complete images by their number.
    times : dict[int, float]
        When each was found complete. [s]
    """

    pattern: str
    selection: Selection
    pages: dict[int, Page] = field(default_factory=dict)
    times: dict[int, float] = field(default_factory=dict)
    _files: dict[Path, list[Page]] = field(default_factory=dict)
    _stamps: dict[Path, tuple[int, int, int]] = field(default_factory=dict)
    _broken: dict[Path, tuple[float, str]] = field(default_factory=dict)
    _several: bool = False

    def look(self, paths: Iterable[Path], now: float) -> None:
        """Read the headers of those files that are new or have changed."""
        for path in paths:
            found = self._read(path, now)
            if not found:
                continue
            self._several |= len(found) > 1 or not _WILD.search(self.pattern)
            self._files[path] = found
            if not self._several:
                self._add(_number_in(path), found[0], now)
        if self._several:  # files of many images: each goes on counting where the last one ended
            number = 0
            for path in sorted(self._files, key=natural_key):
                for page in self._files[path]:
                    self._add(number, page, now)
                    number += 1

    def _add(self, number: int, page: Page, now: float) -> None:
        if number not in self.pages:
            self.pages[number], self.times[number] = page, now

    def _read(self, path: Path, now: float) -> list[Page]:
        """Complete images of a file that has changed; none where it has not, or is not whole."""
        try:
            stamp = file_stamp(path)
            if self._stamps.get(path) == stamp:
                return []
            found = read_headers([path], self.selection)
            if file_stamp(path) != stamp:
                return []  # it is being written; the next look finds it
        except (OSError, FrameError):
            return []  # it was renamed or removed meanwhile

        self._stamps[path] = stamp
        if found.faults:
            self._broken.setdefault(path, (now, next(iter(found.faults.values()))))
        else:
            self._broken.pop(path, None)
        return [page for n, page in enumerate(found.pages) if n not in found.faults]

    def broken(self, now: float) -> list[str]:
        """Files that have been unreadable for long, with the reason."""
        return [
            f"{path.name}: {reason}"
            for path, (since, reason) in self._broken.items()
            if now - since > PATIENCE
        ]


class Arrivals:
    """The frames of both cameras as they come, paired by their numbers.

    Parameters
    ----------
    directory : Path
        The run directory.
    settings : RunSettings
    clock : callable
        Time of an arrival. [s]
    """

    def __init__(
        self, directory: Path, settings: RunSettings, clock: Callable[[], float] = time.time
    ) -> None:
        self.directory, self._clock = directory, clock
        self._cameras = tuple(
            _Camera(camera.files, select_counts(camera))
            for camera in (settings.camera1, settings.camera2)
        )
        self._shift: int | None = None
        self._paired: set[int] = set()

    def look(self, changed: Collection[Path] | None = None) -> list[Arrival]:
        """Find the pairs that have become complete since the last look.

        A file that cannot be read yet is read again when it has changed.

        Parameters
        ----------
        changed : collection of Path, optional
            Files that may be new or changed; default: all.

        Returns
        -------
        list of Arrival
            In the order of their numbers.
        """
        now = self._clock()
        for camera in self._cameras:
            if changed is None or "**" in camera.pattern:
                paths = match_files(self.directory, camera.pattern)
            else:
                wanted = str(self.directory / camera.pattern)
                paths = sorted((p for p in changed if p.match(wanted)), key=natural_key)
            camera.look(paths, now)
        return self._pair()

    def _pair(self) -> list[Arrival]:
        one, two = self._cameras
        shift = self._find_shift()
        if shift is None:
            return []
        fresh = sorted(n for n in one.pages.keys() - self._paired if n + shift in two.pages)
        self._paired.update(fresh)
        first = min(one.pages)
        return [
            Arrival(
                number - first,
                (one.pages[number], two.pages[number + shift]),
                max(one.times[number], two.times[number + shift]),
            )
            for number in fresh
        ]

    def _find_shift(self) -> int | None:
        """Number of camera 2 less that of camera 1 for one pulse; None where it is not known yet.

        As for a finished recording, the cameras may count from different first numbers.
        """
        one, two = (camera.pages for camera in self._cameras)
        if self._shift is None and one.keys() & two.keys():
            self._shift = 0
        if self._shift is None and min(len(one), len(two)) >= _FEW:
            self._shift = min(two) - min(one)
        return self._shift

    def counts(self) -> tuple[int, int]:
        """Complete frames of camera 1 and camera 2."""
        one, two = self._cameras
        return len(one.pages), len(two.pages)

    def missing(self) -> dict[str, int]:
        """Names of frames without a partner, with the camera that lacks it, 1 or 2.

        A frame is missed when its camera has a later one and `PATIENCE` has passed.
        """
        if self._shift is None:
            return {}
        lost: dict[str, int] = {}
        one, two = self._cameras
        for lacking, own, other, shift in (1, one, two, -self._shift), (2, two, one, self._shift):
            latest, until = max(own.pages), self._clock() - PATIENCE
            for number in sorted(other.pages.keys() - {n - shift for n in own.pages}):
                if number + shift < latest and other.times[number] < until:
                    lost[other.pages[number].name] = lacking
        return lost

    def stopped(self) -> tuple[int, int] | None:
        """The camera that writes no more, and how many frames the other has written since.

        None where both go on, and before `PATIENCE` has passed.
        """
        if self._shift is None:
            return None
        one, two = self._cameras
        until = self._clock() - PATIENCE
        for lacking, own, other, shift in (1, one, two, -self._shift), (2, two, one, self._shift):
            latest = max(own.pages)
            later = [n for n in other.pages if n + shift > latest]
            if later and other.times[min(later)] < until:
                return lacking, len(later)
        return None

    def unreadable(self) -> list[str]:
        """Files that have been unreadable for longer than `PATIENCE`, with the reason."""
        now = self._clock()
        return [text for camera in self._cameras for text in camera.broken(now)]


def _number_in(path: Path) -> int:
    """The last number in the name of a file; 0 where there is none."""
    digits = re.findall(r"\d+", path.stem)
    return int(digits[-1]) if digits else 0
