"""Both cameras together: overlap, registration, and agreement of the laser pulses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from erlif.core.arrays import AnyArray, Array, Image
from erlif.core.notes import Note, list_some, remark, retitle, warn
from erlif.core.progress import silent
from erlif.core.statistics import robust_std
from erlif.io.ingest import Fixture, FramePairs, Run
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.engines.results import FrameResult
from erlif.pipeline.recording.prepare import prepare_chain
from erlif.pipeline.recording.pulses import check_pulses
from erlif.pipeline.recording.sample import Bands
from erlif.ratio import PairRatio
from erlif.registration import orient

# Frame pairs up to which all of them are searched for exchanged pulses.
WHOLE = 60

# Consecutive pairs that are searched in a longer recording.
CONSECUTIVE = 16

# Pairs whose registration is listed.
SHOWN = 3

# Share of the image that both cameras see, below which they are not well adjusted.
_LITTLE_OVERLAP = 0.7

_WEAK = 0.3  # correlation of the textures below which a registration is doubtful

# Correlation of the structure of both flats from which it is that of the object; sensors have
# none in common, and 10 000 pixels give 0.01 by chance.
_SHARED = 0.1

_DUST = 5.0  # robust standard deviations beyond which the structure of a flat is dust

_PIXELS = 100_000  # pixels of a ratio that are kept for the comparison with the calibration

_WIDTH = 640  # largest width of a picture on the page [px]


@dataclass(frozen=True)
class PairPicture:
    """One frame pair on the pixels of camera 1, reduced in size.

    Attributes
    ----------
    light : tuple[Image, Image]
        Corrected light of camera 1 and camera 2, (y, x); NaN where flagged. [DN]
    difference : Image
        Logarithm of the ratio less its mean over the surroundings, (y, x); NaN where flagged. [1]
    frame : int
        Number of the frame pair, counted from 0.
    """

    frame: int
    light: tuple[Image, Image]
    difference: Image


@dataclass(frozen=True)
class RatioSurvey:
    """Registration, ratio and light of a few pairs, before the film is computed.

    Attributes
    ----------
    chain : FrameChain
        From counts to ratio.
    sample : tuple[Bands, ...]
        Parts of a few frame pairs.
    frames : tuple[FrameResult, ...]
        The consecutive pairs that were measured.
    light : Array
        Median light of their valid pixels, NaN without any, (frame, camera). [DN]
    log_ratios : Array
        Valid ratios of a few pairs. [1]
    picture : PairPicture
        The middle pair.
    """

    chain: FrameChain
    sample: tuple[Bands, ...]
    frames: tuple[FrameResult, ...]
    light: Array
    log_ratios: Array
    picture: PairPicture


def survey_cameras(recording: Run | Fixture) -> RatioSurvey:
    """Register the cameras, and measure the ratio of consecutive pairs.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    RatioSurvey

    Raises
    ------
    FrameError, RegistrationError
        As `erlif.pipeline.recording.prepare.prepare_chain`.
    """
    prepared = prepare_chain(recording, silent)
    chain = prepared.chain
    numbers = choose_consecutive(recording.pairs)
    # a few pairs represent the ratios of the run
    shown = set(numbers[:: max(len(numbers) // SHOWN, 1)])
    middle = numbers[len(numbers) // 2]

    frames, lights, kept = [], [], []
    with one_thread_per_frame():
        for frame in numbers:
            pair = chain.measure(frame)
            frames.append(FrameResult.of(frame, pair))
            lights.append(_median_light(pair.light_one, pair.log_ratio, pair.flags))
            if frame in shown:
                step = max(int(np.sqrt(pair.flags.size / _PIXELS)), 1)
                some = pair.flags[::step, ::step] == 0
                kept.append(np.asarray(pair.log_ratio[::step, ::step][some], float))
            if frame == middle:
                picture = _picture_of(frame, pair)
    return RatioSurvey(
        chain, prepared.sample, tuple(frames), np.array(lights), np.concatenate(kept), picture
    )


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


def _median_light(light: Image, log_ratio: Image, flags: AnyArray) -> tuple[float, float]:
    valid = flags == 0
    if not valid.any():
        return float("nan"), float("nan")
    one, ratio = light[valid], np.exp(log_ratio[valid])
    return float(np.median(one)), float(np.median(one * ratio))


def _picture_of(frame: int, pair: PairRatio) -> PairPicture:
    """The pair as it is shown on the page."""
    # flagged pixels hold numbers that mean nothing
    valid = pair.flags == 0
    one = np.where(valid, pair.light_one, np.nan).astype(np.float32)
    clean = np.where(valid, pair.log_ratio, 0).astype(np.float32)
    two = one * np.exp(clean)

    # the film is smooth over 9 pixels, what registration leaves is not
    weight, total = (cv2.blur(np.asarray(one, np.float32), (9, 9)) for one in (valid, clean))
    rest = np.where(valid, clean - total / np.maximum(weight, 1e-6), np.nan)
    step = -(-one.shape[1] // _WIDTH)
    return PairPicture(
        frame,
        (one[::step, ::step], two[::step, ::step]),
        rest[::step, ::step].astype(np.float32),
    )


def note_registration(survey: RatioSurvey) -> Iterator[Note]:
    """Displacement, correlation and overlap."""
    camera_map = survey.chain.camera_map
    overlap, quality = float(camera_map.overlap.mean()), camera_map.quality
    x, y = (
        float(np.nanmedian(one)) for one in (camera_map.displacement_x, camera_map.displacement_y)
    )
    yield remark(
        "registration",
        f"camera 2 displaced by ({x:+.2f}, {y:+.2f}) px, correlation of the textures "
        f"{quality:.2f}, {overlap:.0%} of the image seen by both cameras",
    )
    found_again = [one for one in survey.frames if np.isfinite(one.drift).all()]
    for one in found_again[:: max(len(found_again) // SHOWN, 1)][:SHOWN]:
        drift = ", ".join(f"{value:+.2f}" for value in one.drift)
        yield remark("registration", f"pair {one.frame}: camera 2 moved by ({drift}) px")

    if overlap < _LITTLE_OVERLAP:
        yield warn(
            "registration",
            f"the cameras have {overlap:.0%} of the image in common. Turn the cameras until both "
            "show the same part of the joint",
        )
    if quality < _WEAK:
        yield warn(
            "registration",
            f"the textures of the cameras have a correlation of {quality:.2f}: light, focus or "
            "texture are weak. Check focus and exposure of both cameras",
        )
    lost = [one.frame for one in survey.frames if not np.isfinite(one.drift).all()]
    if lost:
        yield warn(
            "registration",
            f"no common texture of the cameras in pairs {list_some(lost)}. Leave these pairs out",
        )


def note_textures(survey: RatioSurvey) -> Iterator[Note]:
    """Warn if the flats show a texture of the joint, common to both cameras."""
    references, camera_map = survey.chain.correct.references, survey.chain.camera_map
    if not bool(references.has_flat.values.all()):
        return
    correlation = correlate_flats(
        references.flat.values,
        references.bad.values,
        camera_map.displacement_x,
        camera_map.displacement_y,
        orientation=camera_map.settings.orientation,
    )
    if correlation > _SHARED:
        yield warn(
            "registration",
            f"the flats of both cameras show one texture, correlation {correlation:.2f}: they "
            "were recorded on the joint or with the laser, and take its texture for that of the "
            "sensors. Record flats of an evenly lit target without structure",
        )


def correlate_flats(
    flats: AnyArray,
    bad: AnyArray,
    displacement_x: Image,
    displacement_y: Image,
    *,
    orientation: str,
) -> float:
    """Correlation of the structure of two flats at the same points of the object.

    Parameters
    ----------
    flats : array, (camera, y, x)
        Response of the pixels. [1]
    bad : array of bool, (camera, y, x)
        Pixels that are left out.
    displacement_x, displacement_y : array, (y, x)
        Pixel of camera 2 less pixel of camera 1. [px]
    orientation : str
        How camera 2 is turned, one of `erlif.registration.settings.ORIENTATIONS`.

    Returns
    -------
    float
    """
    one, two = (_structure(flat, mask) for flat, mask in zip(flats, bad, strict=True))
    y, x = np.indices(one.shape, np.float32)
    outside = ~np.isfinite(displacement_x + displacement_y)
    moved = cv2.remap(
        np.ascontiguousarray(orient(two, orientation)),
        np.where(outside, -1, x + displacement_x).astype(np.float32),
        np.where(outside, -1, y + displacement_y).astype(np.float32),
        cv2.INTER_LINEAR,
    )
    size = float(np.sqrt((one**2).sum() * (moved**2).sum()))
    return float((one * moved).sum()) / size if size > 0 else 0.0


def _structure(flat: Image, bad: AnyArray) -> Image:
    """Flat over the mean of its surroundings less 1; 0 for bad pixels and dust."""
    values = np.asarray(flat / cv2.blur(flat, (9, 9)) - 1, np.float32)
    sound = ~bad & (np.abs(values) < _DUST * robust_std(values))
    return np.where(sound, values, np.float32(0))


def note_pulses(
    survey: RatioSurvey, pairs: FramePairs, *, counted: Iterable[int] = ()
) -> Iterator[Note]:
    """Pairs whose images belong to different laser pulses.

    Raises
    ------
    PulseError
        As `erlif.pipeline.recording.pulses.check_pulses`.
    """
    known = {one.frame for one in survey.frames} <= set(counted)
    yield from retitle("pulses", check_pulses(survey.frames, pairs, copies=not known))
    judged, count = len(survey.frames), len(pairs.usable)
    rest = "; erlif process searches all" if judged < count else ""
    yield remark("pulses", f"{judged} of {count} pairs searched for images of other pulses{rest}")
