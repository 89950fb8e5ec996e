"""Frame pairs of a recording that is still being written."""

from __future__ import annotations

import os
import re
import time
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from erlif.core.errors import FrameError
from erlif.core.guarded import file_stamp
from erlif.io.ingest.images import Page, match_files, read_headers
from erlif.io.ingest.numbering import find_missing, name_lost
from erlif.io.ingest.order import number_files, sort_files
from erlif.io.ingest.selection import Selection, select_counts
from erlif.io.settings import RunSettings

# Time after which a frame of one camera alone, or a file that cannot be read, is reported. [s]
PATIENCE = 1.0

# Frames of each camera from which on different numbers are taken for different first numbers.
_FEW = 3

# Pairs among whose numbers those are sought that neither camera has.
_RECENT = 200

# Characters of a pattern that may match more than one file.
_WILD = re.compile(r"[*?[]")


class Arrival(NamedTuple):
    """A frame pair whose files are complete.

    Attributes
    ----------
    place : int
        Place in the recording, counted from 0 at the first frame of either camera.
    pages : tuple[Page, Page]
        Camera 1 and camera 2.
    time : float
        When its second image was found complete, on the clock of the arrivals. [s]
    """

    place: int
    pages: tuple[Page, Page]
    time: float


def _number(path: Path) -> int:
    """Number of a frame by the name of its file; 0 without one."""
    return number_files([path])[0] or 0


@dataclass
class _Camera:
    """Files and images that one camera has written so far.

    Attributes
    ----------
    directory : Path
        The run directory.
    pattern : str
        File name or glob of its frames.
    selection : Selection
        Part of the files that belongs to it.
    pages : dict[int, Page]
        Complete images by their number.
    alone : dict[int, float]
        Those without a partner, and when each was found complete. [s]
    fresh : list[int]
        Those of them for which no partner was sought yet.
    first, latest : int
        Least and greatest number.
    """

    directory: Path
    pattern: str
    selection: Selection
    pages: dict[int, Page] = field(default_factory=dict)
    alone: dict[int, float] = field(default_factory=dict)
    fresh: list[int] = field(default_factory=list)
    first: int = 0
    latest: int = -1
    _several: bool = False
    _files: dict[Path, list[Page]] = field(default_factory=dict)
    _stamps: dict[Path, tuple[int, int, int]] = field(default_factory=dict)
    _broken: dict[Path, tuple[float, str]] = field(default_factory=dict)
    _rewritten: dict[Path, str] = field(default_factory=dict)
    _whole: set[str] = field(default_factory=set)
    _last: str = ""

    def look(self, changed: Collection[Path] | None, now: float) -> bool:
        """Read the headers of files that are new or have changed.

        Whether the frames are numbered anew: the files turn out to hold several images.
        """
        several, grown = self._several, False
        for path in self._choose(changed):
            found = self._read(path, now)
            if not found or len(found) < len(self._files.get(path, ())):
                continue
            self._several |= len(found) > 1 or not _WILD.search(self.pattern)
            self._files[path], grown = found, True
            if not self._several:
                self._whole.add(self._last)
                self._last = self._name(path)
                self._add(_number(path), found[0], now)

        paired = len(self.pages) - len(self.alone)
        if anew := self._several and not several:
            self.pages, self.alone, self.fresh, self._whole = {}, {}, [], set()
        if self._several and grown:
            self._count_on(now)
        if anew:
            for number in range(paired):
                self.alone.pop(number, None)
        return anew

    def _choose(self, changed: Collection[Path] | None) -> list[Path]:
        """List the files that may have changed, in natural order."""
        if changed is None or "**" in self.pattern:
            return match_files(self.directory, self.pattern, known=self._whole)
        wanted = str(self.directory / self.pattern)
        matched = (path for path in changed if path.match(wanted))
        return sort_files(p for p in matched if not p.name.startswith("."))

    def _count_on(self, now: float) -> None:
        """Number the images of files with many images, continuously from file to file."""
        known, number = len(self.pages), 0
        for path in sort_files(self._files):
            pages = self._files[path]
            for n in range(max(0, known - number), len(pages)):
                self._add(number + n, pages[n], now)
            number += len(pages)

    def _add(self, number: int, page: Page, now: float) -> None:
        if number in self.pages:
            if not self.pages[number].path.exists():  # it had another name at first
                self.pages[number] = page
            return
        self.first = min(self.first, number) if self.pages else number
        self.latest = max(self.latest, number)
        self.pages[number], self.alone[number] = page, now
        self.fresh.append(number)

    def named_now(self, page: Page) -> Page:
        """Return the page of the same number under the present name of its file."""
        return page if self._several else self.pages.get(_number(page.path), page)

    def _name(self, path: Path) -> str:
        """Name of a file as its pattern has it."""
        return str(path).removeprefix(f"{self.directory}{os.sep}")

    def _read(self, path: Path, now: float) -> list[Page]:
        """Complete images of a file that has changed; none where it has not, or is not whole."""
        try:
            stamp = file_stamp(path)
            before = self._stamps.get(path)
            # a file of which nothing was read may be sound: its opening may have failed
            again = before == stamp and path in self._broken and not self._files.get(path)
            if before == stamp and not again:
                return []
            found = read_headers([path], self.selection)
            after = file_stamp(path)
            if after != stamp:  # it is being written; the headers of a long stack take long
                grown = after[2] == stamp[2] and after[0] > stamp[0]
                last = min(found.faults, default=len(found.pages)) - 1
                return found.pages[: max(0, last)] if grown else []
        except (OSError, FrameError):
            return []  # it was renamed or removed meanwhile

        self._stamps[path] = stamp
        single = path in self._files and len(self._files[path]) == 1 and len(found.pages) == 1
        if single and before is not None and stamp[1] - before[1] > 1e9 * PATIENCE:
            self._rewritten[path] = "it was written again after its pair was taken"
        if found.faults:
            since = self._broken[path][0] if again else now
            self._broken[path] = (since, next(iter(found.faults.values())))
        else:
            self._broken.pop(path, None)
        return [page for n, page in enumerate(found.pages) if n not in found.faults]

    def doubtful(self, now: float) -> list[str]:
        """Files that are unreadable and have not changed for long, or were written twice."""
        broken = {
            path: reason for path, (since, reason) in self._broken.items() if now - since > PATIENCE
        }
        return [
            f"{self._name(path)}: {reason}" for path, reason in (self._rewritten | broken).items()
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
            _Camera(directory, camera.files, select_counts(camera))
            for camera in (settings.camera1, settings.camera2)
        )
        self._shift: int | None = None
        self._recent: deque[tuple[int, float]] = deque(maxlen=_RECENT)
        self._gaps: set[int] = set()

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
            if camera.look(changed, now):
                self._shift = None
        return self._pair(now)

    def _pair(self, now: float) -> list[Arrival]:
        one, two = self._cameras
        shift = self._find_shift()
        if shift is None:
            return []
        first = self._first()
        fresh = {*one.fresh, *(number - shift for number in two.fresh)}
        one.fresh, two.fresh = [], []
        pairs = []
        for number in sorted(fresh):
            if number in one.alone and number + shift in two.alone:
                pages = one.pages[number], two.pages[number + shift]
                times = one.alone.pop(number), two.alone.pop(number + shift)
                pairs.append(Arrival(number - first, pages, max(times)))
                self._recent.append((number, now))
        return pairs

    def renew(self, arrival: Arrival) -> Arrival:
        """Return the pair with the present names of its files."""
        one, two = (
            camera.named_now(page)
            for camera, page in zip(self._cameras, arrival.pages, strict=True)
        )
        return arrival._replace(pages=(one, two))

    def _first(self) -> int:
        """Number of the first pulse that a camera has recorded, as camera 1 counts."""
        one, two = self._cameras
        return min(one.first, two.first - (self._shift or 0))

    def _find_shift(self) -> int | None:
        """Number of camera 2 less that of camera 1 for one pulse; None where it is not known yet.

        As for a finished recording, the cameras may count from different first numbers. Where they
        have common ones and not as many frames, the first frame of one was lost.
        """
        one, two = self._cameras
        if self._shift is None and one.pages and two.pages:
            shift, fewest = two.first - one.first, min(len(one.pages), len(two.pages))
            if shift == 0 or fewest >= _FEW:
                common = len(one.pages) != len(two.pages) and one.pages.keys() & two.pages.keys()
                self._shift = 0 if common else shift
        return self._shift

    def counts(self) -> tuple[int, int]:
        """Complete frames of camera 1 and camera 2."""
        one, two = self._cameras
        return len(one.pages), len(two.pages)

    def missing(self) -> dict[str, int]:
        """Names of frames without a partner, with the camera that lacks it, 1 or 2; 0 for both.

        A frame is missed when its camera has a later one and `PATIENCE` has passed.
        """
        if self._shift is None:
            return {}
        lost: dict[str, int] = {}
        one, two = self._cameras
        until = self._clock() - PATIENCE
        for lacking, own, other, shift in (1, one, two, -self._shift), (2, two, one, self._shift):
            for number in sorted(n for n in other.alone if n + shift < own.latest):
                if other.alone[number] < until:
                    lost[other.pages[number].name] = lacking

        numbers = sorted(number for number, found in self._recent if found < until)
        self._gaps = {
            number
            for number in self._gaps.union(find_missing(numbers))
            if number not in one.pages and number + self._shift not in two.pages
        }
        known = next(iter(one.pages.values()))
        return lost | {name_lost(known, number).name: 0 for number in sorted(self._gaps)}

    def stopped(self) -> tuple[int, int] | None:
        """The camera that writes no more, and how many frames the other has written since.

        None where both go on, and before `PATIENCE` has passed.
        """
        if self._shift is None:
            return None
        one, two = self._cameras
        until = self._clock() - PATIENCE
        for lacking, own, other, shift in (1, one, two, -self._shift), (2, two, one, self._shift):
            later = [n for n in other.alone if n + shift > own.latest]
            if later and other.alone[min(later)] < until:
                return lacking, len(later)
        return None

    def doubtful(self) -> list[str]:
        """Files that are unreadable for longer than `PATIENCE`, or written twice; the reasons."""
        now = self._clock()
        return [text for camera in self._cameras for text in camera.doubtful(now)]
