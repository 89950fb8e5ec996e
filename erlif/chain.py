"""From the counts of a recording to ratio images, one frame pair at a time.

What a recording as a whole has to say, its references, its camera map and drift, and how sharp its cameras are, is found first;
then every frame can be had by itself, in any order and from any thread.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from erlif.alignment import align_frames
from erlif.core.errors import RegistrationError
from erlif.core.flags import Flag
from erlif.core.products import AlignedFrames, RatioImages, References
from erlif.correction import correct_frames
from erlif.ingest import Recording, depth_warning, read_frames
from erlif.ratio import compute_ratio, is_steep
from erlif.registration import CameraMap, RegistrationSettings, check_map, estimate_drift, register_frames
from erlif.sharpness import BlurDifference, BlurMoments

Array = npt.NDArray[np.float64]
Progress = Callable[[str, int, int], None]
"""Told what is being done, how many of it are done, and how many there are."""


def silent(what: str, done: int, total: int) -> None:
    """Report nothing."""


@dataclass(frozen=True)
class Chain:
    """The stages from counts to ratio, with what the whole recording has to say to each of them."""

    recording: Recording
    references: References
    camera_map: CameraMap
    drift_of: dict[int, Array]
    blur: BlurDifference = field(default_factory=BlurDifference)

    def aligned(self, frame: int) -> AlignedFrames:
        """Both cameras of one frame, corrected and laid over each other."""
        frames = read_frames(self.recording, [frame])
        corrected = correct_frames(frames, self.references, least_signal=self.recording.settings.thickness.least_signal)
        return align_frames(corrected, self.camera_map, drift=self.drift_of[frame][None])

    def ratio(self, frame: int) -> RatioImages:
        """The ratio image of one frame."""
        share = self.recording.settings.thickness.no_film_below
        return compute_ratio(self.aligned(frame), no_film_below=share, blur=self.blur)


def prepare_chain(
    recording: Recording, references: References, progress: Progress, *, stored: CameraMap | None = None
) -> Chain:
    """Register the cameras, and compare their sharpness on a few frames.

    Parameters
    ----------
    recording, references
    progress : callable
    stored : CameraMap, optional
        A map found before, to be used in place of a new one.

    Raises
    ------
    RegistrationError
        If the cameras cannot be laid over each other, or the stored map fits no longer.
    """
    pairs = _LazyPairs(recording, references, progress)
    camera_map, drift = _register(pairs) if stored is None else _follow(pairs, stored)
    _note_what_was_seen(pairs, drift)
    chain = Chain(recording, references, camera_map, dict(zip(recording.frames, drift, strict=True)))
    moments = BlurMoments.empty()
    with one_thread_per_frame():
        for frame in some_frames(recording, 4):
            moments.add(chain.aligned(frame))
    return replace(chain, blur=moments.solve())


def some_frames(recording: Recording, count: int) -> list[int]:
    """Usable frames, evenly spaced over the recording."""
    places = np.unique(np.linspace(0, len(recording.frames) - 1, count).round().astype(int))
    return [recording.frames[place] for place in places]


def _register(pairs: _LazyPairs) -> tuple[CameraMap, Array]:
    """Fixed map of the cameras, and the drift of each usable frame."""
    options = pairs.recording.settings.registration
    large = pairs.recording.shape[0] * pairs.recording.shape[1] > 500_000
    settings = RegistrationSettings(
        window=options.window,
        step=options.step,
        model=options.model,
        orientation=options.orientation,
        frames_for_map=options.frames or (4 if large else 12),
        threads=2 if large else 1,
    )
    return register_frames(pairs, settings=settings)


def _follow(pairs: _LazyPairs, stored: CameraMap) -> tuple[CameraMap, Array]:
    """A stored map, checked on some frames, and the drift of each against it; the map takes up the mean drift."""
    if stored.shape != pairs.recording.shape:
        raise RegistrationError(
            f"Expected a stored camera map for frames of {pairs.recording.shape}; the calibration's is for {stored.shape}. Calibrate with "
            "the region of interest of the run, or set reuse = false in [registration]."
        )
    check_map(stored, pairs)
    drift = np.full((len(pairs), 2), np.nan)
    for index, (one, two, weight_one, weight_two) in enumerate(pairs):
        try:
            found = estimate_drift(stored, one, two, weight_reference=weight_one, weight_moving=weight_two)
        except RegistrationError:
            continue  # no common texture in this frame: it has no drift, and no film
        drift[index] = found.dx, found.dy
    mean = np.nanmean(drift, axis=0)
    moved = replace(
        stored,
        displacement_x=(stored.displacement_x + mean[0]).astype(np.float32),
        displacement_y=(stored.displacement_y + mean[1]).astype(np.float32),
        model=f"{stored.model}, stored with the calibration; the run's mean drift against it is ({mean[0]:.3f}, {mean[1]:.3f}) px",
    )
    return moved, drift - mean


def _note_what_was_seen(pairs: _LazyPairs, drift: Array) -> None:
    """Add to the notes what reading every frame has shown."""
    seen = [
        depth_warning(settings, highest, camera=camera)
        for camera, (settings, highest) in enumerate(zip(pairs.recording.cameras, pairs.highest, strict=True), 1)
    ]
    lost = [str(k) for k, (x, _) in zip(pairs.numbers, drift, strict=True) if np.isnan(x)]
    if lost:
        seen.append(
            f"frame pairs {', '.join(lost)}: no common texture, as of a misfired pulse; flagged poor_registration"
        )
    notes = [pairs.references.attrs.get("notes", ""), *seen]
    pairs.references.attrs["notes"] = "\n".join(note for note in notes if note)


class _LazyPairs(Sequence[tuple[Any, Any, Any, Any]]):
    """Corrected frame pairs with the weights of their pixels, read when they are asked for."""

    def __init__(self, recording: Recording, references: References, progress: Progress) -> None:
        self.recording, self.references, self.progress = recording, references, progress
        self.numbers = recording.frames
        self.highest = [0, 0]

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: Any) -> tuple[Any, Any, Any, Any]:
        frames = read_frames(self.recording, [self.numbers[index]])
        corrected = correct_frames(frames, self.references, least_signal=self.recording.settings.thickness.least_signal)
        peaks = frames.counts.max(("frame", "y", "x")).values
        self.highest = [max(a, int(b)) for a, b in zip(self.highest, peaks, strict=True)]
        lit = (corrected.flags.values[:, 0] & (Flag.SATURATED | Flag.BAD_PIXEL)) == 0
        self.progress("registration", index + 1, len(self))
        one, two = corrected.signal.values[:, 0]
        return one, two, *((lit[n] & ~is_steep(signal)).astype(np.float32) for n, signal in enumerate((one, two)))


@contextmanager
def one_thread_per_frame() -> Iterator[None]:
    """Keep OpenCV to the thread that calls it: the threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
