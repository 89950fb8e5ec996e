"""A run directory in which the cameras write trial frames: the newest pair is checked.

A pair of frames shows what to turn on the cameras before a run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from erlif.core.arrays import Counts, FlagImage, Image
from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.progress import silent
from erlif.correction.light import measure_light
from erlif.io.ingest import FramePairs, read_pair
from erlif.pipeline.chain import FrameCorrection
from erlif.pipeline.recording.cameras import characterise_cameras
from erlif.pipeline.recording.prepare import correct_recording
from erlif.pipeline.recording.register import register_cameras
from erlif.pipeline.watch.follow import Follower, as_plain
from erlif.pipeline.watch.live import run_of
from erlif.ratio import measure_sharpness
from erlif.registration import CameraMap

# Time between two registrations. [s]
_REST = 1.0


class SetupWatch(Follower):
    """A run directory in which the cameras write trial frames; the newest pair is looked at.

    Parameters and errors as for `Follower`.
    """

    def __init__(self, run_dir: Path, *, allow_outside: bool = False) -> None:
        super().__init__(run_dir, allow_outside=allow_outside)
        self._cameras: tuple[CameraCheck, ...] = ()
        self._images: tuple[Image, ...] = ()
        self._saturated: tuple[FlagImage, ...] = ()
        self._best = [math.nan, math.nan]
        self._map: MapCheck | None = None
        self._correct: FrameCorrection | None = None
        self._looked = -1
        self._registered = -1

    def jobs(self) -> Sequence[Callable[[], None]]:
        """As `Follower.jobs`: the counts of the newest pair, and its registration."""
        return self._look, self._register

    # the source of the page

    def news(self, version: int, pairs: int, angles: int, timeout: float) -> dict[str, Any]:
        """The state once it is newer than `version`."""
        self.wait(version, timeout)
        with self._changed:
            newest = self._arrived[self._looked] if self._looked >= 0 else None
            return {
                "version": self._version,
                "status": self.status,
                "failed": self.failed,
                "closed": self.closed,
                "frames": self._arrivals.counts(),
                "arrived": len(self._arrived),
                "pairs": [],
                "angles": [],
                "newest": None if newest is None else {"place": newest.place, "time": newest.time},
                "shape": self._shape if self._images else None,
                "cameras": [as_plain(camera) for camera in self._cameras],
                "best": [None if math.isnan(one) else one for one in self._best],
                "map": None if self._map is None else self._map._asdict(),
                "advice": advise(self._cameras, self._map, self._best[: len(self._cameras)]),
                "faults": list(self.faults().values()),
                "alarms": {},
            }

    def newest(self, layer: str) -> tuple[int, str, Image, FlagImage] | None:
        """Place, name, counts and flags of a camera of the newest pair, (y, x); None before one."""
        with self._changed:
            if not self._images or layer not in ("camera1", "camera2"):
                return None
            n = int(layer[-1]) - 1
            arrival = self._arrived[self._looked]
            return arrival.place, arrival.pages[n].name, self._images[n], self._saturated[n]

    # threads

    def _look(self) -> None:
        """Check the counts of the newest pair."""
        with self._changed:
            frame = len(self._arrived) - 1
            if frame == self._looked:
                self._changed.wait(0.2)
                return
            pairs = self._pairs_of(self._arrived[-1:])
        try:
            counts = read_pair(pairs, 0).counts
        except ErlifError as error:
            with self._changed:
                self._looked = frame
                self._note("frames", error)
                self._notify()
            return
        checks = [check_counts(*each) for each in zip(counts, pairs.full_scales, strict=True)]
        fault = self._find_references(pairs)
        if self._correct is not None:
            checks = _with_references(checks, counts, self._correct)
        with self._changed:
            self._looked, self._cameras = frame, tuple(checks)
            self._images = tuple(image.astype(np.float32) for image in counts)
            self._saturated = tuple(
                np.where(image >= full, np.uint16(Flag.SATURATED), np.uint16(0))
                for image, full in zip(counts, pairs.full_scales, strict=True)
            )
            self._best = [
                float(np.fmax(one.sharpness, best))
                for one, best in zip(checks, self._best, strict=True)
            ]
            self._note("frames", "")
            self._note("references", fault)
            self._notify()

    def _find_references(self, pairs: FramePairs) -> str:
        """Read darks and flats once they can be; why they cannot be used, else an empty text."""
        if self._correct is None:
            run = run_of(self.directory, self.settings, pairs)
            try:
                self._correct = correct_recording(run, characterise_cameras(run))
            except ErlifError as error:
                return str(error)
        return ""

    def _register(self) -> None:
        """Register the newest pair."""
        self._ended.wait(_REST)
        frame = self._looked
        if frame == self._registered or self._correct is None:
            return
        pairs = self._pairs_of([self._arrived[frame]])
        correct = replace(self._correct, pairs=pairs, energies=None)
        found: MapCheck | None = None
        fault = ""
        try:
            registered = register_cameras(
                correct, self.settings.registration, stored=None, progress=silent
            )
            found = MapCheck.of(registered)
        except ErlifError as error:
            fault = str(error)
        with self._changed:
            self._registered, self._map = frame, found
            self._note("registration", fault)
            self._notify()


def _with_references(
    checks: Sequence[CameraCheck], counts: Sequence[Counts], correct: FrameCorrection
) -> list[CameraCheck]:
    """Add dark level, sharpness and share of measurable pixels to the checks of a pair."""
    pair = measure_light(counts, correct.tables, energy=1.0)
    return [
        check._replace(
            dark=float(correct.references.dark.values[n].mean()),
            sharpness=measure_sharpness(pair.light[n], pair.flags[n], table.noise),
            measurable=float((pair.flags[n] == 0).mean()),
        )
        for n, (check, table) in enumerate(zip(checks, correct.tables, strict=True))
    ]


# Intervals of a histogram over the range of the counts.
_BINS = 64

# Share of the brightest pixels that is left out of the highest count, and the part of full scale
# at which it is to lie. [1]
_BRIGHTEST, _GOOD = 1e-3, 0.8

# Share of saturated pixels from which the light is too strong, and part of full scale below which
# the highest count makes it too weak. [1]
_SATURATED, _WEAK = 1e-3, 0.4

# Sharpness over the best one so far below which the focus is worth a look, and share of the image
# of camera 1 that camera 2 is to see. [1]
_BLURRED, _OVERLAP = 0.9, 0.95


class CameraCheck(NamedTuple):
    """Levels, saturation and sharpness of one frame of a camera.

    Attributes
    ----------
    histogram : tuple[int, ...]
        Pixels in 64 equal intervals from 0 to full scale.
    full_scale : int
        [DN]
    mean : float
        [DN]
    highest : float
        Count that one pixel in a thousand exceeds, over full scale. [1]
    saturated : float
        Share of pixels at full scale. [1]
    dark : float
        Mean of the darks; NaN where they are not there yet. [DN]
    sharpness : float
        As `measure_sharpness`; NaN without darks or texture. [1]
    measurable : float
        Share of pixels that are neither saturated, dim nor bad; NaN without darks. [1]
    """

    histogram: tuple[int, ...]
    full_scale: int
    mean: float
    highest: float
    saturated: float
    dark: float = math.nan
    sharpness: float = math.nan
    measurable: float = math.nan


class MapCheck(NamedTuple):
    """Position of camera 2 relative to camera 1, and quality of the registration.

    Attributes
    ----------
    shift : tuple[float, float]
        Median displacement x, y. [px]
    quality : float
        Correlation of the textures after alignment. [1]
    overlap : float
        Share of the image of camera 1 that camera 2 sees. [1]
    poor : float
        Share where the registration is not accurate enough. [1]
    """

    shift: tuple[float, float]
    quality: float
    overlap: float
    poor: float

    @classmethod
    def of(cls, camera_map: CameraMap) -> MapCheck:
        """Summarise a camera map."""
        x, y = (
            float(np.nanmedian(axis))
            for axis in (camera_map.displacement_x, camera_map.displacement_y)
        )
        overlap, poor = float(camera_map.overlap.mean()), float(camera_map.poor.mean())
        return cls((x, y), camera_map.quality, overlap, poor)


def check_counts(counts: Counts, full_scale: int) -> CameraCheck:
    """Check the counts of a frame without darks and flats.

    Parameters
    ----------
    counts : array, (y, x)
        [DN]
    full_scale : int
        [DN]

    Returns
    -------
    CameraCheck
        Without what darks and flats determine.

    Examples
    --------
    >>> check = check_counts(np.full((64, 64), 1024, np.uint16), 4095)
    >>> check.mean, round(check.highest, 2), check.saturated
    (1024.0, 0.25, 0.0)
    """
    levels = np.bincount(counts.ravel(), minlength=full_scale + 1)
    edges = np.linspace(0, levels.size, _BINS + 1).astype(int)[:-1]
    passed = np.cumsum(levels) / counts.size
    return CameraCheck(
        tuple(int(count) for count in np.add.reduceat(levels, edges)),
        full_scale,
        float(counts.mean()),
        float(np.searchsorted(passed, 1 - _BRIGHTEST)) / full_scale,
        float(levels[full_scale:].sum()) / counts.size,
    )


def advise(
    cameras: Sequence[CameraCheck], found: MapCheck | None, best: Sequence[float]
) -> list[str]:
    """Advise on the adjustment of the cameras, in sentences.

    Parameters
    ----------
    cameras : sequence of CameraCheck
    found : MapCheck or None
    best : sequence of float
        Best sharpness of each camera so far. [1]

    Returns
    -------
    list of str

    Examples
    --------
    >>> bright = check_counts(np.full((64, 64), 4095, np.uint16), 4095)
    >>> advise([bright], None, [float("nan")])
    ['camera 1 saturates in 100.0 % of its pixels: halve its gain or exposure']
    """
    texts = []
    for n, (camera, sharpest) in enumerate(zip(cameras, best, strict=True), 1):
        if camera.saturated > _SATURATED:
            texts.append(
                f"camera {n} saturates in {100 * camera.saturated:.1f} % of its pixels: halve its "
                "gain or exposure"
            )
        elif camera.highest < _WEAK:
            factor = _GOOD / max(camera.highest, 1e-3)
            texts.append(
                f"camera {n} uses {100 * camera.highest:.0f} % of its range: {factor:.1f} times "
                "the gain, exposure or light would use 80 %"
            )
        if camera.sharpness < _BLURRED * sharpest:
            share = 100 * camera.sharpness / sharpest
            texts.append(
                f"camera {n} has {share:.0f} % of the best sharpness so far: turn its focus back"
            )
    if found is not None and found.overlap < _OVERLAP:
        x, y = found.shift
        texts.append(
            f"camera 2 sees {100 * found.overlap:.0f} % of the image of camera 1: it is "
            f"displaced by {x:+.0f} px along x and {y:+.0f} px along y"
        )
    return texts
