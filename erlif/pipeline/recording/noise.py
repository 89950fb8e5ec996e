"""Gain and read noise of cameras from their frames, where nothing else determines them.

Where gain and read noise are known, the noise of the ratio is compared with theirs.

Counts that were halved, averaged or smoothed after the recording have less noise than their cameras
leave; the gain that darks, flats and settings give is then not that of the frames.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from erlif.core.notes import Note, warn
from erlif.core.products import References
from erlif.core.statistics import robust_rms
from erlif.correction import make_references
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.recording.cameras import Characterised
from erlif.pipeline.recording.sample import (
    Bands,
    SampleRatios,
    compare_sharpness,
    sample_frames,
)
from erlif.ratio import NoiseEstimate, NoiseUnknowns, NoiseView, estimate_camera_noise
from erlif.ratio.camera_noise import cell_size

# Pixels from which fewer frames hold enough cells. [px]
_LARGE = 500_000

# Frames whose differences are compared.
_FRAMES_LARGE, _FRAMES_SMALL = 6, 24

_ROUNDS = 5
# Relative change of a gain, far below its standard deviation, at which the rounds end.
_SETTLED = 5e-3


@dataclass(frozen=True)
class NoiseCompletion:
    """A chain whose noise is known, and the notes on both cameras.

    Attributes
    ----------
    chain : FrameChain
        Counts to ratio, frame by frame.
    notes : tuple[Note, ...]
        What was measured, estimated and assumed.
    sample : tuple[Bands, ...]
        Parts of a few frame pairs, corrected and aligned by the chain.
    bits : tuple[Note, ...]
        Faults of the bits of the frames.
    """

    chain: FrameChain
    notes: tuple[Note, ...]
    sample: tuple[Bands, ...] = ()
    bits: tuple[Note, ...] = ()


def complete_noise(
    chain: FrameChain, known: Characterised, *, sample: tuple[Bands, ...] = ()
) -> NoiseCompletion:
    """Estimate gain and noise from the frames, where settings, darks and flats leave them open.

    The noise of a ratio image depends on the gain: the estimate starts from an assumption and is
    repeated until it settles. Without a flat the unequal response of the pixels remains in the
    ratio. The spread of the response of camera 2, taken for camera 1 as well, becomes part of the
    variance. It shows only where camera 2 drifts; between cameras at rest it is left out, with a
    note. Two unknown gains are taken as equal with a probability that follows from the data. Where
    both read noises are unknown, one dark variance is fitted to both cameras.

    Parameters
    ----------
    chain : FrameChain
    known : Characterised
        What darks and flats determined, and what the settings give, with the notes so far.
    sample : tuple of tuple of AlignedFrames
        Parts of a few frame pairs, corrected and aligned by the chain.

    Returns
    -------
    NoiseCompletion
        The chain itself where everything is known; otherwise with references and difference of
        sharpness that agree with the estimate. The notes state what was estimated and assumed.

    Raises
    ------
    FrameError
        If the frames do not determine gain or read noise either.
    """
    cameras, unknown = known.cameras, find_unknowns(chain.references)
    if not unknown.any:
        return NoiseCompletion(chain, cameras.notes, sample)

    before = np.zeros((2, 2))
    for _ in range(_ROUNDS):
        renewed = _estimate_noise(chain, unknown)
        if renewed is None:
            return NoiseCompletion(chain, cameras.notes, sample)
        estimate = renewed

        cameras = make_references(
            known.measured, declared=known.declared, estimated=estimate.cameras
        )
        chain = replace(chain, correct=chain.correct.with_references(cameras.references))
        sample = sample_frames(chain)
        chain = replace(chain, blur=compare_sharpness(chain, sample))
        now = np.nan_to_num([[noise.gain, noise.response_spread] for noise in estimate.cameras])
        if np.all(np.abs(now - before) <= _SETTLED * now):
            break
        before = now
    return NoiseCompletion(chain, (*cameras.notes, *_note_estimates(estimate, unknown)), sample)


def find_unknowns(references: References) -> NoiseUnknowns:
    """Find the noise parameters that settings, darks and flats do not determine."""
    return NoiseUnknowns(
        ~references.gain_known.values,
        ~references.read_noise_known.values,
        ~references.has_flat.values,
    )


def _estimate_noise(chain: FrameChain, unknown: NoiseUnknowns) -> NoiseEstimate | None:
    """Estimate the unknown noise; None if only the response is unknown and undetermined."""
    rows, columns = chain.pairs.shape
    frames = chain.pairs.spread(_FRAMES_LARGE if rows * columns > _LARGE else _FRAMES_SMALL)
    with one_thread_per_frame():
        return estimate_camera_noise(
            _views(chain, frames),
            unknown,
            references=chain.references,
            blur=chain.blur,
            frames=len(frames),
        )


def _views(chain: FrameChain, frames: Sequence[int]) -> Iterator[NoiseView]:
    """Yield the ratio of each frame with its variances for unit shot noise and dark variance."""
    size = cell_size(chain.pairs.shape)
    flat = chain.references.flat.values[:, None]
    for frame in frames:
        corrected, aligned = chain.align(frame)
        ratio = chain.divide(aligned)

        # variances of unit noise go through the alignment in place of the true ones
        signal = corrected.signal.values
        shot, dark = np.maximum(signal, 0) / flat, np.broadcast_to(flat**-2.0, signal.shape)
        unit = chain.align_variances(corrected, shot, dark)
        yield NoiseView.of(ratio, unit, chain.camera_map, size=size)


def _note_estimates(estimate: NoiseEstimate, unknown: NoiseUnknowns) -> list[Note]:
    """Make the notes on the estimated noise of each camera and on the assumptions."""
    notes = []
    for n, noise in enumerate(estimate.cameras):
        if not unknown.noise[n]:
            continue
        what = ["gain"] * int(unknown.gain[n]) + ["read noise"] * int(unknown.read_noise[n])
        relative = 100 * noise.gain_std / noise.gain
        precision = f", the gain to {relative:.0f} %" if unknown.gain[n] else ""

        assumed = ["shot noise"]
        if unknown.gain[n] and not np.isnan(estimate.alike):
            assumed.append(
                f"equal gains of both cameras with a probability of {estimate.alike:.2f}"
            )
        if unknown.read_noise.all():
            assumed.append("one read noise [DN] for both")
        text = (
            f"{' and '.join(what)} estimated from the noise that the two cameras do not share in "
            f"{estimate.frames} frames{precision}, assuming {' and '.join(assumed)}. Declare them, "
            "or record darks and flats, for a better estimate"
        )
        notes.append(warn(f"camera{n + 1}", text))
    if unknown.response[1]:
        notes.append(_describe_response(estimate, unknown))
    return notes


def _describe_response(estimate: NoiseEstimate, unknown: NoiseUnknowns) -> Note:
    """Make the note on the pixel response of cameras without a flat."""
    cameras = "both cameras" if unknown.response[0] else "camera 2"
    spread = estimate.cameras[1].response_spread
    text = (
        f"without a flat, the pixel response of {cameras} is neither corrected nor part of the "
        "uncertainty. Its spread is not known, because the cameras hardly moved against each other"
        if np.isnan(spread)
        else f"the pixel response of {cameras} varies by {100 * spread:.1f} %, as the drift of "
        "camera 2 shows; without a flat this counts as noise"
    )
    return warn("flats", text)


# Noise over that which is expected, below which counts were changed: sound frames have 1.02 to 1.1,
# counts that were halved 0.8.
_LEAST = 0.9

_FEWEST = 2000  # pixels from which on the noise is known to 2 %

# A pixel less the mean of the eight two pixels away: removes the film, and what the interpolation
# correlates.
_RING = np.zeros((5, 5), np.float32)
_RING[::2, ::2] = -1 / 8
_RING[2, 2] = 1


def note_noise(sample: SampleRatios) -> Iterator[Note]:
    """Warn of noise of the ratio that is too low for the cameras.

    Parameters
    ----------
    sample : list of list of RatioImages
        From `divide_sample`.

    Yields
    ------
    Note
    """
    found = measure_noise(sample)
    if found < _LEAST:
        yield warn(
            "counts",
            f"errors are wrong, and films may be: the counts have {found:.2f} of the noise that "
            "gain and read noise leave. Counts were halved, averaged or smoothed after the "
            "recording, or the gain is that of other settings. Export the raw counts",
        )


def measure_noise(sample: SampleRatios) -> float:
    """Noise of the ratio from pixel to pixel over that which gain and read noise give.

    Parameters
    ----------
    sample
        As for `note_noise`.

    Returns
    -------
    float
        NaN where too few pixels are valid. [1]
    """
    parts = []
    for ratios in (ratios for bands in sample for ratios in bands):
        flagged = ratios.flags.values[0] != 0
        values = np.where(flagged, 0, ratios.log_ratio.values[0]).astype(np.float32)
        rest = cv2.filter2D(values, -1, _RING)

        # the mean of eight has an eighth of the variance of one
        std = np.sqrt(float((_RING**2).sum()) * ratios.log_ratio_var.values[0])
        sound = cv2.dilate(flagged.astype(np.uint8), np.ones_like(_RING, np.uint8)) == 0
        parts.append((rest[sound] / std[sound]).astype(np.float32))
    found = np.concatenate(parts) if parts else np.array([])
    return robust_rms(found) if found.size >= _FEWEST else float("nan")
