"""Time of the first frame on the clock of a log, from the light of the frames."""

from __future__ import annotations

import math

import numpy as np

from erlif.core.arrays import Array
from erlif.core.errors import ConfigError, EncoderError
from erlif.core.notes import Level, Note
from erlif.io.ingest import FoundStart, FramePairs
from erlif.io.ingest.frames import read_pair
from erlif.io.ingest.logs.resample import ContinuousLog, sample_log
from erlif.io.settings import RunSettings
from erlif.kinematics import find_clock_offset, locate_frames
from erlif.pipeline.physics.joint import build_linkage, describe_encoder_settings

# Frame pairs whose light is read.
MOST_FRAMES = 400

# Places in a turn of the crank at which the log is followed.
SAMPLES_IN_CYCLE = 250

# Places at which a log is followed; a longer one is refused.
MOST_SAMPLES = 100_000

# Standard deviations, and relative size, from which a stretch of the times is reported.
_CERTAIN, _SMALLEST_STRETCH = 5.0, 1e-3

# Rows and columns of a frame that its light is taken from: one in so many. [px]
EVERY = 4


def fit_start(
    settings: RunSettings, pairs: FramePairs, log: ContinuousLog, since: Array
) -> FoundStart:
    """Find the time of the first frame on the clock of a log.

    The film of a pin joint is thinnest where the joint stands still, on either stroke alike. The
    ratio of both cameras follows the film and not the energy of the pulse; its median in a frame is
    set against the speed of the joint by `erlif.kinematics.find_clock_offset`.

    Parameters
    ----------
    settings : RunSettings
        With a crank-rocker or a slider-crank.
    pairs : FramePairs
    log : ContinuousLog
    since : array, (frame,)
        Time of each frame pair after the first one. [s]

    Returns
    -------
    FoundStart

    Raises
    ------
    ConfigError
        If the run has no linkage.
    EncoderError
        If frames or log do not determine the start.
    """
    links = settings.linkage
    if links is None:
        raise ConfigError(
            "Expected a crank-rocker or a slider-crank in [mechanism], because start is to be "
            'fitted; got none. Give start = "0.25 s" in [encoder] of run.toml.'
        )

    # the log at a few hundred places in a turn; its own rows may be far denser or fewer
    first, last = log.span
    rows = log.samples.sizes["sample"]
    turns = (last - first) * links.crank_speed / (2 * math.pi)
    count = min(rows, math.ceil(turns * SAMPLES_IN_CYCLE) + 2)
    if count > MOST_SAMPLES:
        raise EncoderError(
            f"Expected a log of at most {MOST_SAMPLES // SAMPLES_IN_CYCLE} turns of the crank to "
            f"fit its start; {log.file} has {turns:.0f}. Export the part of the log that belongs "
            'to the run, or give start = "0.25 s" in [encoder] of run.toml.'
        )
    time = log.samples["time"].values[np.linspace(0, rows - 1, count).astype(int)]
    located = locate_frames(
        sample_log(log, time),
        mechanism=build_linkage(links),
        crank_speed=links.crank_speed,
        pin_radius=None,
        encoder=describe_encoder_settings(settings, folded=False),
    )

    frames = pairs.spread(MOST_FRAMES)
    offset = find_clock_offset(
        since[frames] - since[frames[0]],
        np.array([_log_ratio(pairs, k) for k in frames]),
        time=time,
        crank=np.unwrap(np.radians(located.crank_angle.values)),
        speed=located.rocker_speed.values,
    )
    start = offset.value - float(since[frames[0]])
    turn = math.degrees(offset.std * links.crank_speed)
    text = (
        f"first frame at {start:.6f} ± {offset.std:.6f} s, found from the light of {len(frames)} "
        f"frames, of whose variance the motion explains {offset.explained:.0%}; the film is taken "
        f"as the same at equal speed on either stroke. The crank turns by {turn:.2f} deg in the "
        "standard deviation"
    )
    if offset.cycles > 1:
        text += f"; {offset.cycles} starts, whole cycles apart, fit alike"
    if offset.half_cycle:
        text += (
            "; half a cycle later fits as well: outward and return stroke may be exchanged, give "
            "start in [encoder] to exclude it"
        )
    off = abs(offset.stretch) > max(_CERTAIN * offset.stretch_std, _SMALLEST_STRETCH)
    if off:
        text += (
            "; the light follows the motion better where the time between frames is "
            f"{offset.stretch:+.2%} (± {offset.stretch_std:.2%}) longer: correct frame_rate in "
            "[encoder], or crank_speed and links in [mechanism]"
        )
    level = Level.WARNING if offset.half_cycle or off else Level.NOTE
    return FoundStart(start, offset.std, Note(level, log.file, text))


def _log_ratio(pairs: FramePairs, frame: int) -> float:
    """Logarithm of the ratio of the median counts of both cameras."""
    one, two = (np.median(counts[::EVERY, ::EVERY]) for counts in read_pair(pairs, frame).counts)
    return math.log(max(float(two), 1.0) / max(float(one), 1.0))
