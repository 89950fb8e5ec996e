"""From the counts of a recording to ratio images, one frame pair at a time.

What a recording as a whole has to say, its references, its camera map and drift, and how sharp its cameras are, is found first;
then every frame can be had by itself, in any order and from any thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import cv2
import numpy as np

from erlif.core.arrays import Array, Image
from erlif.core.errors import RegistrationError
from erlif.core.flags import Flag
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages, References
from erlif.core.progress import Progress
from erlif.correction import correct_frames
from erlif.ingest import Recording, depth_warning, read_frames
from erlif.ratio import BlurDifference, BlurMoments, compute_ratio
from erlif.registration import (
    CameraMap,
    RegistrationSettings,
    align_frames,
    check_map,
    divide_by_light,
    estimate_drift,
    is_steep,
    register_frames,
)


@dataclass(frozen=True)
class Chain:
    """The stages from counts to ratio, with what the whole recording has to say to each of them.

    Every frame finds its own drift, so that frames depend on nothing but the map.
    """

    recording: Recording
    references: References
    camera_map: CameraMap
    blur: BlurDifference = field(default_factory=BlurDifference)

    def aligned(self, frame: int) -> AlignedFrames:
        """Both cameras of one frame, corrected and laid over each other.

        The coordinates drift_x, drift_y [px] and peak_camera1, peak_camera2 [DN] on dim frame tell the frame's drift, NaN where the
        cameras have no texture in common, and its highest counts.
        """
        frames = read_frames(self.recording, [frame])
        corrected = correct_frames(
            frames, self.references, least_signal=self.recording.settings.thickness.least_signal
        )
        one, two, *weights = registration_input(corrected)
        try:
            found = estimate_drift(
                self.camera_map,
                one,
                two,
                weight_reference=weights[0],
                weight_moving=weights[1],
                threads=1,
            )
            drift = np.array([[found.dx, found.dy]])
        except RegistrationError:
            drift = np.full((1, 2), np.nan)  # a misfired pulse: no drift, and no film
        peaks = frames.counts.values.max(axis=(2, 3))
        return AlignedFrames(
            align_frames(corrected, self.camera_map, drift=drift).assign_coords(
                drift_x=("frame", drift[:, 0]),
                drift_y=("frame", drift[:, 1]),
                peak_camera1=("frame", peaks[0]),
                peak_camera2=("frame", peaks[1]),
            )
        )

    def ratio(self, frame: int) -> RatioImages:
        """The ratio image of one frame, with the coordinates of `aligned`."""
        share = self.recording.settings.thickness.no_film_below
        return compute_ratio(self.aligned(frame), no_film_below=share, blur=self.blur)


@dataclass
class FrameRecord:
    """What single frames have shown: drift [px] and highest counts [DN], by frame number."""

    drift: dict[int, tuple[float, float]] = field(default_factory=dict)
    peaks: dict[int, tuple[int, int]] = field(default_factory=dict)

    def add(self, frame: int, ratios: RatioImages) -> None:
        """Keep what the ratio image of a frame says of it."""
        self.drift[frame] = (float(ratios.drift_x[0]), float(ratios.drift_y[0]))
        self.peaks[frame] = (int(ratios.peak_camera1[0]), int(ratios.peak_camera2[0]))

    def mean_drift(self) -> Array:
        """Mean over the frames whose drift is known; zero where none is."""
        known = np.array([value for value in self.drift.values() if not np.isnan(value[0])])
        return known.mean(axis=0) if known.size else np.zeros(2)

    def notes(self, recording: Recording) -> list[str]:
        """What of it deserves a word."""
        highest = np.max(list(self.peaks.values()), axis=0) if self.peaks else [4095, 4095]
        seen = [
            depth_warning(settings, int(top), camera=camera)
            for camera, (settings, top) in enumerate(
                zip(recording.cameras, highest, strict=True), 1
            )
        ]
        lost = [str(frame) for frame, (x, _) in sorted(self.drift.items()) if np.isnan(x)]
        if lost:
            seen.append(
                f"frame pairs {', '.join(lost)}: no common texture, as of a misfired pulse; flagged poor_registration"
            )
        return [note for note in seen if note]


def prepare_chain(
    recording: Recording,
    references: References,
    progress: Progress,
    *,
    stored: CameraMap | None = None,
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
    large = recording.shape[0] * recording.shape[1] > 500_000
    wanted = recording.settings.registration.frames or (4 if large else 12)
    pairs = _LazyPairs(recording, references, some_frames(recording, wanted), progress)
    camera_map = (
        _register(pairs, threads=2 if large else 1) if stored is None else _check(pairs, stored)
    )
    chain = Chain(recording, references, camera_map)
    return replace(chain, blur=measure_blur(chain))


def measure_blur(chain: Chain) -> BlurDifference:
    """By how much camera 2 is less sharp, from a few frames."""
    moments = BlurMoments.empty()
    with one_thread_per_frame():
        for frame in some_frames(chain.recording, 4):
            moments.add(chain.aligned(frame))
    return moments.solve()


def some_frames(recording: Recording, count: int) -> list[int]:
    """Usable frames, evenly spaced over the recording."""
    places = np.unique(np.linspace(0, len(recording.frames) - 1, count).round().astype(int))
    return [recording.frames[place] for place in places]


def _register(pairs: _LazyPairs, *, threads: int) -> CameraMap:
    """Fixed map of the cameras from some frames together."""
    options = pairs.recording.settings.registration
    settings = RegistrationSettings(
        window=options.window,
        step=options.step,
        model=options.model,
        orientation=options.orientation,
        frames_for_map=len(pairs),
        threads=threads,
    )
    camera_map, _ = register_frames(pairs, settings=settings)
    return camera_map


def _check(pairs: _LazyPairs, stored: CameraMap) -> CameraMap:
    """A stored map, if it fits the run."""
    if stored.shape != pairs.recording.shape:
        raise RegistrationError(
            f"Expected a stored camera map for frames of {pairs.recording.shape}; the calibration's is for {stored.shape}. Calibrate with "
            "the region of interest of the run, or set reuse = false in [registration]."
        )
    check_map(stored, pairs)
    return replace(stored, stored=True)


def registration_input(corrected: CorrectedFrames) -> tuple[Image, Image, Image, Image]:
    """Light of both cameras in one frame, and the weights (0 or 1) of their pixels for a registration."""
    lit = (corrected.flags.values[:, 0] & (Flag.SATURATED | Flag.BAD_PIXEL)) == 0
    one, two = corrected.signal.values[:, 0]
    weight_one, weight_two = (
        (use & ~is_steep(signal)).astype(np.float32)
        for use, signal in zip(lit, (one, two), strict=True)
    )
    return one, two, weight_one, weight_two


class _LazyPairs(Sequence[tuple[Image, Image, Image, Image]]):
    """Corrected frame pairs, freed of the light the film shapes, with the weights of their pixels, read when they are asked for."""

    def __init__(
        self, recording: Recording, references: References, numbers: list[int], progress: Progress
    ) -> None:
        self.recording, self.references, self.progress = recording, references, progress
        self.numbers = numbers

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: Any) -> Any:
        frames = read_frames(self.recording, [self.numbers[index]])
        corrected = correct_frames(
            frames, self.references, least_signal=self.recording.settings.thickness.least_signal
        )
        self.progress("registration", index + 1, len(self))
        one, two, weight_one, weight_two = registration_input(corrected)
        (one, weight_one), (two, weight_two) = (
            divide_by_light(one, weight_one),
            divide_by_light(two, weight_two),
        )
        return one, two, weight_one, weight_two


@contextmanager
def one_thread_per_frame() -> Iterator[None]:
    """Keep OpenCV to the thread that calls it: the threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
