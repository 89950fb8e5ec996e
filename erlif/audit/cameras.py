"""Both cameras together: overlap, registration, and whether they show the same laser pulses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.notes import Level, Note
from erlif.core.products import RatioImages
from erlif.core.progress import silent
from erlif.ingest import Fixture, FramePairs, Run
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.prepare import prepare_chain
from erlif.pipeline.pulse_order import check_pulses
from erlif.pipeline.results import FrameResult
from erlif.pipeline.sample import FrameSample
from erlif.ratio import sample_pulse

WHOLE = 60
"""Frame pairs up to which all of them are searched for exchanged pulses."""

CONSECUTIVE = 16
"""Consecutive pairs that are searched in a longer recording."""

SHOWN = 3
"""Pairs whose registration is listed."""

_LITTLE_OVERLAP = 0.7
"""Share of the image that both cameras see, below which they are not well adjusted."""

_WEAK = 0.3
"""Correlation of the textures below which a registration is doubtful."""

_PIXELS = 100_000
"""Pixels of a ratio that are kept for the comparison with the calibration."""

_WIDTH = 640
"""Largest width of a picture on the page. [px]"""


@dataclass(frozen=True)
class Picture:
    """One frame pair on the pixels of camera 1, reduced in size.

    Attributes
    ----------
    frame : int
        Number of the frame pair, counted from 0.
    light : tuple[Image, Image]
        Corrected light of camera 1 and camera 2, (y, x); NaN where flagged. [DN]
    difference : Image
        Logarithm of the ratio less its mean over the surroundings, (y, x); NaN where flagged. [1]
    """

    frame: int
    light: tuple[Image, Image]
    difference: Image


@dataclass(frozen=True)
class CameraSurvey:
    """What registration and ratio show before the film is computed.

    Attributes
    ----------
    chain : FrameChain
        From counts to ratio.
    sample : tuple[FrameSample, ...]
        Parts of a few frame pairs.
    frames : tuple[FrameResult, ...]
        The consecutive pairs that were measured.
    log_ratios : Array
        Valid ratios of a few pairs. [1]
    picture : Picture
        The middle pair.
    """

    chain: FrameChain
    sample: tuple[FrameSample, ...]
    frames: tuple[FrameResult, ...]
    log_ratios: Array
    picture: Picture


def survey_cameras(recording: Run | Fixture) -> CameraSurvey:
    """Register the cameras, and measure the ratio of consecutive pairs.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    CameraSurvey

    Raises
    ------
    FrameError, RegistrationError
        As `erlif.pipeline.prepare.prepare_chain`.
    """
    prepared = prepare_chain(recording, silent)
    chain = prepared.chain
    numbers = choose_consecutive(recording.pairs)
    shown = set(numbers[:: max(len(numbers) // SHOWN, 1)])
    middle = numbers[len(numbers) // 2]

    frames, kept = [], []
    with one_thread_per_frame():
        for frame in numbers:
            ratios = chain.ratio(frame)
            light, log_ratio, flags = (
                ratios[name].values[0] for name in ("signal_camera1", "log_ratio", "flags")
            )
            pulse = sample_pulse(light, log_ratio, flags)
            frames.append(FrameResult.of(frame, ratios, pulse=pulse))
            if frame in shown:
                kept.append(_valid(log_ratio, flags))
            if frame == middle:
                picture = _draw(frame, ratios)
    return CameraSurvey(chain, prepared.sample, tuple(frames), np.concatenate(kept), picture)


def choose_consecutive(pairs: FramePairs) -> list[int]:
    """All usable pairs of a short recording, the middle ones of a long one.

    Parameters
    ----------
    pairs : FramePairs

    Returns
    -------
    list of int
    """
    usable = pairs.usable
    if len(usable) <= WHOLE:
        return usable
    first = (len(usable) - CONSECUTIVE) // 2
    return usable[first : first + CONSECUTIVE]


def _valid(log_ratio: Image, flags: AnyArray) -> Array:
    step = max(int(np.sqrt(log_ratio.size / _PIXELS)), 1)
    return np.asarray(log_ratio[::step, ::step][flags[::step, ::step] == 0], float)


def _draw(frame: int, ratios: RatioImages) -> Picture:
    """The pair as it is shown on the page."""
    light, log_ratio, flags = (
        ratios[name].values[0] for name in ("signal_camera1", "log_ratio", "flags")
    )
    # flagged pixels hold numbers that mean nothing
    valid = flags == 0
    one = np.where(valid, light, np.nan).astype(np.float32)
    clean = np.where(valid, log_ratio, 0).astype(np.float32)
    two = one * np.exp(clean)

    # the film is smooth over 9 pixels, what registration leaves is not
    rest = np.where(valid, clean - _mean_of_surroundings(clean, valid), np.nan)
    step = -(-one.shape[1] // _WIDTH)
    return Picture(
        frame,
        (one[::step, ::step], two[::step, ::step]),
        rest[::step, ::step].astype(np.float32),
    )


def _mean_of_surroundings(values: Image, valid: AnyArray) -> Image:
    weight = cv2.blur(valid.astype(np.float32), (9, 9))
    total = cv2.blur(values, (9, 9))  # 0 where not valid
    return np.asarray(total / np.maximum(weight, 1e-6))


def note_registration(survey: CameraSurvey) -> Iterator[Note]:
    """Displacement, correlation and overlap.

    Parameters
    ----------
    survey : CameraSurvey

    Yields
    ------
    Note
    """
    found = survey.chain.camera_map
    overlap, quality = float(found.overlap.mean()), found.quality
    x, y = (float(np.nanmedian(one)) for one in (found.displacement_x, found.displacement_y))
    yield Note(
        Level.NOTE,
        "registration",
        f"camera 2 displaced by ({x:+.2f}, {y:+.2f}) px, correlation of the textures "
        f"{quality:.2f}, {overlap:.0%} of the image seen by both cameras",
    )
    for one in survey.frames[:: max(len(survey.frames) // SHOWN, 1)][:SHOWN]:
        drift = ", ".join(f"{value:+.2f}" for value in one.drift)
        yield Note(Level.NOTE, "registration", f"pair {one.frame}: camera 2 moved by ({drift}) px")

    if overlap < _LITTLE_OVERLAP:
        yield Note(
            Level.WARNING,
            "registration",
            f"the cameras have {overlap:.0%} of the image in common. Turn the cameras until both "
            "show the same part of the joint",
        )
    if quality < _WEAK:
        yield Note(
            Level.WARNING,
            "registration",
            f"the textures of the cameras have a correlation of {quality:.2f}: light, focus or "
            "texture are weak. Check focus and exposure of both cameras",
        )
    lost = [one.frame for one in survey.frames if not np.isfinite(one.drift).all()]
    if lost:
        shown = ", ".join(str(k) for k in lost[:10])
        yield Note(
            Level.WARNING,
            "registration",
            f"no common texture of the cameras in pairs {shown}. Leave these pairs out",
        )


def note_pulses(survey: CameraSurvey, pairs: FramePairs) -> Iterator[Note]:
    """Pairs whose images belong to different laser pulses.

    Parameters
    ----------
    survey : CameraSurvey
    pairs : FramePairs

    Yields
    ------
    Note

    Raises
    ------
    PulseError
        As `erlif.pipeline.pulse_order.check_pulses`.
    """
    notes = check_pulses(survey.frames, pairs)
    for note in notes:
        if "same image" not in note.text:  # named with the counts
            yield Note(note.level, "pulses", str(note))
    judged = f"{len(survey.frames)} of {len(pairs.usable)} pairs"
    yield Note(
        Level.NOTE,
        "pulses",
        f"{judged} searched for images of other pulses"
        + ("; erlif process searches all" if len(survey.frames) < len(pairs.usable) else ""),
    )
