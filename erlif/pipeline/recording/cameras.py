"""Both cameras of a recording, characterised: darks and flats are read once."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import Counts
from erlif.core.notes import Note
from erlif.correction import (
    CameraMeasurement,
    Cameras,
    DeclaredNoise,
    count_pixels,
    find_reference_faults,
    find_unlit,
    make_references,
    measure_camera,
)
from erlif.correction.saturation import Histogram
from erlif.correction.view import FrameView, ViewSum
from erlif.io.ingest import (
    Fixture,
    FramePairs,
    Run,
    read_pair,
    read_reference_pages,
    select_counts,
)
from erlif.io.ingest.selection import Purpose
from erlif.pipeline.audit.bits import note_bits

# Frame pairs searched for saturation below full scale.
_FRAMES_SEARCHED = 8


class Characterised(NamedTuple):
    """Both cameras of a recording.

    Attributes
    ----------
    cameras : Cameras
        References and the notes on them. Gain and read noise that neither settings nor darks and
        flats determine are assumptions (gain_known, read_noise_known);
        `erlif.pipeline.recording.noise` estimates them from the frames.
    measured : tuple[CameraMeasurement, ...]
        What darks, flats and a few frames determined.
    declared : tuple[DeclaredNoise, ...]
        What the settings give.
    faults : tuple[Note, ...]
        Notes on darks and flats that do not fit the frames.
    bits : tuple[Note, ...]
        Faults of the bits of the frames.
    """

    cameras: Cameras
    measured: tuple[CameraMeasurement, ...]
    declared: tuple[DeclaredNoise, ...]
    faults: tuple[Note, ...]
    bits: tuple[Note, ...] = ()


def characterise_cameras(recording: Run | Fixture) -> Characterised:
    """References of both cameras from settings, darks and flats, which are read once.

    A few frames show the count at which they saturate.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    Characterised

    Raises
    ------
    FrameError
        If darks or flats are missing, unreadable, or do not fit the frames.
    """
    looks = look_at_frames(recording.pairs)
    flats = [np.zeros_like(look.histogram) for look in looks]
    with ThreadPoolExecutor(len(looks)) as pool:
        measured = tuple(pool.map(partial(_measure_camera, recording), (1, 2), looks, flats))
    declared = tuple(DeclaredNoise(one.gain, one.read_noise) for one in recording.cameras)
    cameras = make_references(measured, declared=declared)
    faults = tuple(find_reference_faults(measured, cameras.references))
    bits = tuple(note_bits([look.histogram for look in looks], flats))
    return Characterised(cameras, measured, declared, faults, bits)


class FrameLook(NamedTuple):
    """Histogram, mean and highest counts of a few uncorrected frames of a camera.

    Attributes
    ----------
    histogram : Histogram
        Pixels by count, (full scale + 1,).
    view : FrameView
        Their mean.
    highest : array of int, (y, x)
        Highest count of each pixel. [DN]
    """

    histogram: Histogram
    view: FrameView
    highest: Counts


def look_at_frames(pairs: FramePairs) -> list[FrameLook]:
    """Read a few frames of each camera, evenly spread over the recording."""
    counted = [np.zeros(full_scale + 1, np.int64) for full_scale in pairs.full_scales]
    totals = [ViewSum(pairs.shape) for _ in counted]
    highest = [np.zeros(pairs.shape, np.uint16) for _ in counted]
    for frame in pairs.spread(_FRAMES_SEARCHED):
        for camera, counts in enumerate(read_pair(pairs, frame).counts):
            counted[camera] += count_pixels(counts, counted[camera].size - 1)
            totals[camera].add(counts)
            np.maximum(highest[camera], counts, out=highest[camera])
    views = (total.mean() for total in totals)
    return [FrameLook(*all_of) for all_of in zip(counted, views, highest, strict=True)]


def _measure_camera(
    recording: Run | Fixture, number: int, look: FrameLook, flat_histogram: Histogram
) -> CameraMeasurement:
    """Darks and flats of a camera; the pixels of the flats are added to their histogram."""
    settings = recording.cameras[number - 1]
    camera, shape = f"camera{number}", recording.pairs.shape

    def read(pattern: str, kind: Purpose) -> Iterator[Counts]:
        return read_reference_pages(
            recording.directory,
            pattern,
            what=f"{camera} {kind}",
            bit_depth=settings.bit_depth,
            shape=shape,
            selection=select_counts(settings, kind),
        )

    def read_flats(pattern: str) -> Iterator[Counts]:
        for counts in read(pattern, "flat"):
            flat_histogram[:] += count_pixels(counts, flat_histogram.size - 1)
            yield counts

    # the settings hold either a file of darks or a level
    level = settings.offset if settings.offset is not None else 0.0
    measured = measure_camera(
        darks=level if settings.dark is None else read(settings.dark, "dark"),
        flats=() if settings.flat is None else read_flats(settings.flat),
        histogram=look.histogram,
        shape=shape,
        camera=camera,
        background=() if settings.background is None else read(settings.background, "background"),
    )
    unlit = find_unlit(look.highest, look.histogram, measured.darks, measured.flat_light)
    return replace(measured, view=look.view, unlit=unlit)
