"""The stages from counts to ratio, one frame pair at a time.

What belongs to a recording as a whole (references, camera map, difference of sharpness) is found
first. Every frame can then be processed by itself, in any order and from any thread.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import cv2
import numpy as np

from erlif.core.arrays import Array, Image
from erlif.core.errors import RegistrationError
from erlif.core.flags import Flag
from erlif.core.products import AlignedFrames, CorrectedFrames, RatioImages, References
from erlif.correction import correct_frames
from erlif.ingest import FramePairs, read_frames
from erlif.passes import PairRatio
from erlif.ratio import BlurDifference, BlurMoments, compute_ratio
from erlif.registration import CameraMap, align_frames, estimate_drift, is_steep

_FRAMES_FOR_BLUR = 4
"""Frames whose sharpness is compared: megapixels enough for 1 % of the blur variance."""


@dataclass(frozen=True)
class FrameCorrection:
    """Counts to light, frame by frame.

    Attributes
    ----------
    pairs : FramePairs
        Frame pairs of the recording.
    references : References
        Dark, flat, gain and read noise of both cameras.
    least_signal : float
        Pixels with less light are flagged dim. [electron]
    """

    pairs: FramePairs
    references: References
    least_signal: float = 100.0

    def __call__(self, frame: int, *, digests: bool = False) -> CorrectedFrames:
        """One corrected frame pair.

        The coordinates peak_camera1 and peak_camera2 on dim frame are its highest counts [DN].
        With `digests`, digest_camera1 and digest_camera2 are those of `erlif.ingest.read_frames`.
        """
        frames = read_frames(self.pairs, [frame], digests=digests)
        peaks = frames.counts.values.max(axis=(2, 3))
        corrected = correct_frames(frames, self.references, least_signal=self.least_signal)
        return CorrectedFrames(
            corrected.assign_coords(
                peak_camera1=("frame", peaks[0]), peak_camera2=("frame", peaks[1])
            )
        )


@dataclass(frozen=True)
class FrameChain:
    """Counts to ratio, frame by frame.

    Each frame finds its own drift, so that frames depend on nothing but the map.

    Attributes
    ----------
    correct : FrameCorrection
        Counts to light.
    camera_map : CameraMap
        Displacement of camera 2.
    blur : BlurDifference
        Difference of sharpness that is removed from the ratio.
    no_film_below : float
        Light relative to the surroundings below which both bands show a bubble. [1]
    """

    correct: FrameCorrection
    camera_map: CameraMap
    blur: BlurDifference = field(default_factory=BlurDifference)
    no_film_below: float = 0.25

    @property
    def pairs(self) -> FramePairs:
        """The frame pairs of the recording."""
        return self.correct.pairs

    @property
    def references(self) -> References:
        """Dark, flat, gain and read noise of both cameras."""
        return self.correct.references

    def align(self, corrected: CorrectedFrames, *, drift: Array | None = None) -> AlignedFrames:
        """Camera 2 of one corrected frame pair on the pixel grid of camera 1.

        The drift (x, y) [px] is estimated where it is not given. The coordinates drift_x and
        drift_y on dim frame hold it, NaN where the cameras show no common texture.
        """
        shift = (self._estimate_drift(corrected) if drift is None else drift)[None]
        aligned = align_frames(corrected, self.camera_map, drift=shift)
        return AlignedFrames(
            aligned.assign_coords(drift_x=("frame", shift[:, 0]), drift_y=("frame", shift[:, 1]))
        )

    def align_like(self, frames: CorrectedFrames, aligned: AlignedFrames) -> AlignedFrames:
        """Apply the alignment of a frame to other light or variances of the same frame."""
        drift = np.column_stack([aligned.drift_x.values, aligned.drift_y.values])
        moved = align_frames(frames, self.camera_map, drift=drift)
        return AlignedFrames(moved.assign_coords(drift_x=aligned.drift_x, drift_y=aligned.drift_y))

    def _estimate_drift(self, corrected: CorrectedFrames) -> Array:
        light = registration_light(corrected)
        try:
            drift = estimate_drift(
                self.camera_map,
                light.one,
                light.two,
                weight_reference=light.weight_one,
                weight_moving=light.weight_two,
                threads=1,
            )
        except RegistrationError:  # a misfired pulse: no drift, and no film
            return np.full(2, np.nan)
        return np.array([drift.dx, drift.dy])

    def compute_ratio(self, aligned: AlignedFrames) -> RatioImages:
        """The ratio image of an aligned frame pair."""
        return compute_ratio(aligned, no_film_below=self.no_film_below, blur=self.blur)

    def ratio(self, frame: int) -> RatioImages:
        """The ratio image of one frame pair, its files hashed as they are read.

        Coordinates are those of `FrameCorrection` and `align`.
        """
        return self.compute_ratio(self.align(self.correct(frame, digests=True)))

    def measure(self, frame: int) -> PairRatio:
        """The ratio of one frame pair as plain arrays.

        They may be those of the thread, filled again by the next call: copy what is kept.
        """
        return PairRatio.of(self.ratio(frame))


@dataclass(frozen=True)
class RegistrationLight:
    """Light of one frame pair, as a registration needs it.

    Attributes
    ----------
    one : Image
        Light of camera 1. [DN]
    two : Image
        Light of camera 2. [DN]
    weight_one : Image
        1 where a pixel of camera 1 can be used, else 0.
    weight_two : Image
        The same for camera 2.
    """

    one: Image
    two: Image
    weight_one: Image
    weight_two: Image


def registration_light(corrected: CorrectedFrames) -> RegistrationLight:
    """Light of both cameras in one frame pair, and the pixels that a registration can use.

    Saturated and bad pixels are left out, and places where the light is too steep.
    """
    lit = (corrected.flags.values[:, 0] & (Flag.SATURATED | Flag.BAD_PIXEL)) == 0
    one, two = corrected.signal.values[:, 0]
    weight_one = (lit[0] & ~is_steep(one)).astype(np.float32)
    weight_two = (lit[1] & ~is_steep(two)).astype(np.float32)
    return RegistrationLight(one, two, weight_one, weight_two)


def compare_sharpness(chain: FrameChain) -> BlurDifference:
    """Difference of sharpness between the cameras, from a few frames."""
    moments = BlurMoments.empty()
    with one_thread_per_frame():
        for frame in chain.pairs.spread(_FRAMES_FOR_BLUR):
            moments.add(chain.align(chain.correct(frame)))
    return moments.solve()


@contextmanager
def one_thread_per_frame() -> Iterator[None]:
    """Limit OpenCV to the calling thread: erlif's threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
