"""Both cameras of a recording, characterised: darks and flats are read once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from erlif.core.arrays import Counts
from erlif.correction import (
    CameraMeasurement,
    Cameras,
    DeclaredNoise,
    count_pixels,
    make_references,
    measure_camera,
)
from erlif.correction.saturation import Histogram
from erlif.ingest import (
    Fixture,
    FramePairs,
    Run,
    read_pair,
    read_reference_pages,
    select_counts,
)
from erlif.ingest.selection import Purpose

_FRAMES_SEARCHED = 8
"""Frame pairs searched for saturation below full scale."""


def measure_cameras(recording: Run | Fixture) -> tuple[CameraMeasurement, CameraMeasurement]:
    """Read darks and flats of both cameras, and a few frames for the count at which they saturate.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    (CameraMeasurement, CameraMeasurement)

    Raises
    ------
    FrameError
        If darks or flats are missing, unreadable, or do not fit the frames.
    """
    one, two = count_frames(recording.pairs)
    return _measure(recording, 1, one), _measure(recording, 2, two)


def declared_noise(recording: Run | Fixture) -> tuple[DeclaredNoise, DeclaredNoise]:
    """Gain and read noise of both cameras as the settings give them."""
    one, two = recording.cameras
    return DeclaredNoise(one.gain, one.read_noise), DeclaredNoise(two.gain, two.read_noise)


def characterise_cameras(recording: Run | Fixture) -> Cameras:
    """References of both cameras from settings, darks and flats.

    Parameters
    ----------
    recording : Run or Fixture

    Returns
    -------
    Cameras
        Gain and read noise that neither settings nor darks and flats determine are assumptions
        (gain_known, read_noise_known); `erlif.pipeline.noise` estimates them from the frames.

    Raises
    ------
    FrameError
        As `measure_cameras`.
    """
    return make_references(measure_cameras(recording), declared=declared_noise(recording))


def count_frames(pairs: FramePairs) -> tuple[Histogram, Histogram]:
    """Pixels by count of each camera, over a few frames."""
    one, two = (np.zeros(full_scale + 1, np.int64) for full_scale in pairs.full_scales)
    for frame in pairs.spread(_FRAMES_SEARCHED):
        counts = read_pair(pairs, frame).counts
        one += count_pixels(counts[0], one.size - 1)
        two += count_pixels(counts[1], two.size - 1)
    return one, two


def _measure(recording: Run | Fixture, number: int, histogram: Histogram) -> CameraMeasurement:
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

    # the settings hold either a file of darks or a level
    level = settings.offset if settings.offset is not None else 0.0
    return measure_camera(
        darks=level if settings.dark is None else read(settings.dark, "dark"),
        flats=() if settings.flat is None else read(settings.flat, "flat"),
        histogram=histogram,
        shape=shape,
        camera=camera,
        background=() if settings.background is None else read(settings.background, "background"),
    )
