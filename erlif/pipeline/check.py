"""An audit of a run or fixture directory before anything is computed."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from erlif.calibration import check_bands, open_calibration, read_profile
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import Level, Note
from erlif.core.timing import stage
from erlif.ingest import (
    Fixture,
    FramePairs,
    Run,
    depth_warning,
    format_notes,
    open_fixture,
    open_run,
    read_frames,
)
from erlif.kinematics import encoder_notes
from erlif.pipeline.cameras import characterise_cameras
from erlif.pipeline.clock import fit_start
from erlif.pipeline.film import describe_cycle, describe_triggers
from erlif.pipeline.joint import locate_run
from erlif.pipeline.omissions import note_omissions

_logger = logging.getLogger(__name__)

BRIGHT = 0.01
"""Share of saturated pixels in one frame above which the exposure is called too long."""

Step = Callable[[], Iterator[Note]]
"""One part of the audit; it raises ErlifError where the input cannot be used."""


def check(directory: str | Path, *, allow_outside: bool = False) -> list[Note]:
    """Check everything in a run or fixture directory that can be checked without computing a film.

    Parameters
    ----------
    directory : path
        With ``run.toml`` or ``fixture.toml``.
    allow_outside : bool
        Follow links and names of files that leave the directory.

    Returns
    -------
    list of Note
        Findings in the order of the audit. It ends with the first error, because the later parts
        depend on the earlier ones.

    Examples
    --------
    >>> for note in check("an empty folder"):
    ...     print(note.level, note.subject)
    error settings and files
    """
    directory = Path(directory)
    notes: list[Note] = []
    subject = "settings and files"
    try:
        recording = _open(directory, allow_outside)
        height, width = recording.pairs.shape
        frames = f"{len(recording.pairs.usable)} pairs of {width} x {height} pixels"
        notes.append(Note(Level.NOTE, "frames", f"{frames}, {recording.settings.name!r}"))

        for name, step in _steps(recording):
            subject = name
            with stage(f"check of {name}", _logger):
                notes += step()
    except ErlifError as error:
        notes.append(Note(Level.ERROR, subject, str(error)))
    return notes


def _open(directory: Path, allow_outside: bool) -> Run | Fixture:
    """The run or the fixture in the directory."""
    if (directory / "run.toml").is_file():
        return open_run(directory, find_start=fit_start, allow_outside=allow_outside)
    if (directory / "fixture.toml").is_file():
        return open_fixture(directory, allow_outside=allow_outside)
    if not directory.is_dir():
        raise ConfigError(
            f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; "
            "there is no such directory. Correct the name."
        )
    raise ConfigError(
        f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; it holds neither. "
        f"Make one from the files in it with: erlif init {directory}"
    )


def _steps(recording: Run | Fixture) -> list[tuple[str, Step]]:
    """Subject and function of each part of the audit."""
    steps: list[tuple[str, Step]] = [
        ("counts", partial(_check_counts, recording.pairs)),
        ("darks and flats", partial(_check_references, recording)),
    ]
    if isinstance(recording, Run):
        log = partial(_check_log, recording)
        return [
            *steps,
            ("encoder log", log),
            ("calibration", partial(_check_calibration, recording)),
        ]
    return [*steps, ("profile", partial(_check_profile, recording))]


def _check_counts(pairs: FramePairs) -> Iterator[Note]:
    """Highest count of each camera, and how much of a frame is saturated."""
    yield from format_notes(pairs)
    highest = np.zeros(2, int)
    saturated = np.zeros(2)
    scale = np.array(pairs.full_scales)

    # one pair at a time: a run may be larger than the memory
    for k in pairs.usable:
        counts = read_frames(pairs, [k]).counts.values[:, 0]
        highest = np.maximum(highest, counts.max(axis=(1, 2)))
        saturated = np.maximum(saturated, (counts >= scale[:, None, None]).mean(axis=(1, 2)))

    for camera, (bit_depth, top, share) in enumerate(
        zip(pairs.bit_depths, highest, saturated, strict=True), 1
    ):
        warning = depth_warning(int(top), bit_depth=bit_depth, camera=camera)
        text = (
            f"camera{camera}: highest count {top} of {pairs.full_scales[camera - 1]}, "
            f"at most {share:.2%} of a frame saturated"
        )
        level = Level.WARNING if warning or share > BRIGHT else Level.NOTE
        yield Note(level, "counts", str(warning or text))


def _check_references(recording: Run | Fixture) -> Iterator[Note]:
    """Dark level, noise and gain of each camera, and where they disagree with the settings."""
    for note in characterise_cameras(recording).notes:
        yield Note(note.level, "darks and flats", str(note))


def _check_log(run: Run) -> Iterator[Note]:
    """Triggers, cycles, top speed, and what the film will lack for want of a table."""
    yield from run.log_notes
    located = locate_run(run)
    yield from encoder_notes(located)
    triggers = describe_triggers(run, located)
    yield Note(Level.NOTE, "encoder log", describe_cycle(located))
    yield from note_omissions(run.settings, triggers)


def _check_calibration(run: Run) -> Iterator[Note]:
    """Whether the calibration exists and fits the bands of the run."""
    settings = run.settings
    if settings.calibration is None:
        text = "run.toml names none; process will need --calibration"
        yield Note(Level.WARNING, "calibration", text)
        return

    path = run.directory / settings.calibration
    if path.exists():
        calibration = open_calibration(path)
        check_bands(calibration, (settings.camera1.band, settings.camera2.band))
        low, high = calibration.thickness_range
        text = f"{calibration.fixture!r}, calibrated range {low:.2f} to {high:.2f} um"
        yield Note(Level.NOTE, "calibration", text)
    elif (path.parent / "fixture.toml").is_file():
        text = f"{settings.calibration} is not made yet; process will make it from the fixture"
        yield Note(Level.NOTE, "calibration", text)
    else:
        text = f"{settings.calibration} does not exist; process will need --calibration"
        yield Note(Level.WARNING, "calibration", text)


def _check_profile(fixture: Fixture) -> Iterator[Note]:
    """Number of points and range of the measured profile."""
    profile = read_profile(fixture.directory / fixture.settings.fixture.profile)
    for note in profile.notes:
        yield Note(note.level, "profile", str(note))

    low, high = profile.thickness.min(), profile.thickness.max()
    text = f"{profile.thickness.size} points from {low:.2f} to {high:.2f} um"
    yield Note(Level.NOTE, "profile", text)
