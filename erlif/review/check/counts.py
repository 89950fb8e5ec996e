"""The counts of a recording as the cameras wrote them: bits, saturation, light and sharpness."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import AnyArray
from erlif.core.notes import Level, Note, list_some, remark, warn
from erlif.core.products import References
from erlif.correction import count_pixels
from erlif.correction.saturation import Histogram
from erlif.io.ingest import FramePairs, depth_warning, read_pair

# Frame pairs that are read of a long recording, evenly spread over it.
MOST_SPREAD = 24

# Share of saturated pixels in one frame above which the exposure is called too long.
BRIGHT = 0.01

# Share of hot, noisy and dead pixels above which darks and flats are doubtful; sensors have some
# 0.1 %.
MANY_BAD = 0.01

# Fine structure over that of the median frame, below which a frame counts as blurred.
_BLURRED = 0.6

_UNLIT = 0.1  # light over that of the median frame, below which a pulse counts as missed


@dataclass(frozen=True)
class FrameCounts:
    """Levels, saturation and sharpness of one frame pair, each of camera 1 and camera 2.

    Attributes
    ----------
    frame : int
        Number of the frame pair, counted from 0.
    level : tuple[float, float]
        Median count, dark included. [DN]
    saturated : tuple[float, float]
        Share of saturated pixels.
    sharpness : tuple[float, float]
        Fine structure over the mean count. [1]
    digest : tuple[str, str]
        SHA-256 of the counts, hexadecimal.
    """

    frame: int
    level: tuple[float, float]
    saturated: tuple[float, float]
    sharpness: tuple[float, float]
    digest: tuple[str, str]


@dataclass(frozen=True)
class CountSurvey:
    """The counts of a recording.

    Attributes
    ----------
    frames : tuple[FrameCounts, ...]
        The frame pairs that were read.
    histograms : tuple[Histogram, Histogram]
        Pixels by count, (full scale + 1,), of camera 1 and camera 2.
    """

    frames: tuple[FrameCounts, ...]
    histograms: tuple[Histogram, Histogram]


def survey_counts(pairs: FramePairs, frames: Sequence[int]) -> CountSurvey:
    """Read frame pairs one at a time: a recording may be larger than the memory.

    Parameters
    ----------
    pairs : FramePairs
    frames : sequence of int
        Numbers of the frame pairs that are read.

    Returns
    -------
    CountSurvey
    """
    one, two = (np.zeros(full_scale + 1, np.int64) for full_scale in pairs.full_scales)
    surveys = []
    for frame in frames:
        measured = []
        for image, histogram in zip(read_pair(pairs, frame).counts, (one, two), strict=True):
            # the histogram has a place for every count that the camera can write
            full_scale = histogram.size - 1
            histogram += count_pixels(image, full_scale)
            saturated = float((image >= full_scale).mean())
            digest = hashlib.sha256(image.tobytes()).hexdigest()
            measured.append((float(np.median(image)), saturated, _sharpness(image), digest))
        surveys.append(FrameCounts(frame, *zip(*measured, strict=True)))
    return CountSurvey(tuple(surveys), (one, two))


def _sharpness(counts: AnyArray) -> float:
    """Standard deviation from the mean over 3 x 3 pixels, over the mean count. [1]"""
    image = counts.astype(np.float32)
    rest = np.abs(image - cv2.blur(image, (3, 3)))
    # a median, so that hot pixels and the edges of bubbles do not count
    return float(1.4826 * np.median(rest) / max(float(image.mean()), 1.0))


def note_counts(survey: CountSurvey, pairs: FramePairs) -> Iterator[Note]:
    """Highest count of each camera, and how much of a frame is saturated."""
    saturated = np.array([one.saturated for one in survey.frames]).max(axis=0)
    for camera, (histogram, bit_depth) in enumerate(
        zip(survey.histograms, pairs.bit_depths, strict=True), 1
    ):
        top, share = int(np.flatnonzero(histogram)[-1]), float(saturated[camera - 1])
        warning = depth_warning(top, bit_depth=bit_depth, camera=camera)
        if warning:
            yield warn("counts", str(warning))
            continue
        most = histogram.size - 1
        yield remark(
            "counts",
            f"camera{camera}: highest count {top} of {most}, at most {share:.2%} of a frame "
            "saturated",
            "Shorten the exposure, or lower the energy of the laser" if share > BRIGHT else "",
        )


def note_bad_pixels(references: References) -> Iterator[Note]:
    """Share of the hot, noisy and dead pixels of each camera, by its darks and flats."""
    for camera, bad in enumerate(references.bad.values, 1):
        share = float(bad.mean())
        # the share is stated in any case; only a large one asks for an action
        yield remark(
            "darks and flats",
            f"camera{camera}: {share:.2%} of the pixels are hot, noisy or dead and are flagged",
            "Look at darks and flats for dust, light and clipping, and record them again"
            if share > MANY_BAD
            else "",
        )


def note_light(survey: CountSurvey, darks: Sequence[float]) -> Iterator[Note]:
    """Light above the dark levels [DN] and sharpness of the run, and frames that depart from it."""
    levels = np.array([one.level for one in survey.frames])
    light = levels - np.asarray(darks)
    sharpness = np.array([one.sharpness for one in survey.frames])
    numbers = np.array([one.frame for one in survey.frames])
    usual, usual_sharpness = np.median(light, axis=0), np.median(sharpness, axis=0)
    dim = light < _UNLIT * usual

    cameras = "; ".join(
        f"camera{n + 1}: median light of a frame {light[:, n].min():.0f} to "
        f"{light[:, n].max():.0f} DN, fine structure {100 * sharpness[:, n].min():.1f} to "
        f"{100 * sharpness[:, n].max():.1f} % of the light"
        for n in range(2)
    )
    yield remark("light", cameras)
    blurred = (sharpness < _BLURRED * usual_sharpness) & ~dim
    for odd, fault in (
        (
            dim,
            f"{_UNLIT:.0%} of the light of the others: the laser or a shutter missed the pulse. "
            "Leave these pairs out",
        ),
        (
            blurred,
            f"{_BLURRED:.0%} of the fine structure of the others: they are out of focus, or were "
            "smoothed. Check the focus, and export the frames without filters",
        ),
    ):
        if odd.any():
            pairs = list_some(numbers[odd.any(axis=1)])
            yield warn("light", f"frame pairs {pairs} have less than {fault}")


def find_copies(survey: CountSurvey) -> list[tuple[int, ...]]:
    """Find groups of frame pairs in which a camera has the same counts.

    Parameters
    ----------
    survey : CountSurvey

    Returns
    -------
    list of tuple of int
        Numbers of the frame pairs of each group.
    """
    groups: dict[tuple[int, str], list[int]] = {}
    for one in survey.frames:
        for camera, digest in enumerate(one.digest):
            groups.setdefault((camera, digest), []).append(one.frame)
    return sorted({tuple(frames) for frames in groups.values() if len(frames) > 1})


def note_copies(survey: CountSurvey) -> Iterator[Note]:
    """Frames that are copies of others."""
    # images of both cameras that agree to the last count are one image
    same = [one.frame for one in survey.frames if one.digest[0] == one.digest[1]]
    if same:
        yield Note(
            Level.ERROR,
            "pairs",
            f"both cameras show the same image in frame pairs {list_some(same)}. Correct files in "
            "[camera1] or [camera2], or export the cameras again",
        )

    # a camera whose frames all have one digest has delivered one frame throughout
    stuck = [
        f"camera{n + 1}" for n in range(2) if len({one.digest[n] for one in survey.frames}) == 1
    ]
    for frames in find_copies(survey):
        if len(frames) == len(survey.frames):
            which = "frame pairs" if len(stuck) == 2 else f"frames of {stuck[0]}"
            yield Note(
                Level.ERROR,
                "pairs",
                f"all {len(frames)} {which} that were read show the same image: the camera or its "
                "export was stuck. Export the recording again, one frame for each pulse",
            )
        else:
            yield warn(
                "pairs",
                f"frame pairs {list_some(frames)} show the same image: a camera or its export was "
                "stuck, or a file was copied. Export them again, or leave out all but one",
            )
