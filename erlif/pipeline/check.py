"""An audit of a run or fixture directory before anything is computed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from erlif.calibration import check_bands, open_calibration, read_profile
from erlif.core.errors import ConfigError, ErlifError
from erlif.core.notes import Level, Note
from erlif.correction import measure_references
from erlif.ingest import Recording, depth_warning, open_fixture, open_run, read_frames
from erlif.kinematics import locate_frames
from erlif.pipeline.film import describe_triggers, group_frames
from erlif.settings import FixtureSettings, RunSettings

BRIGHT = 0.01
"""Share of saturated pixels in one frame above which the exposure is called too long."""

Step = Callable[[Recording], Iterator[Note]]
"""One part of the audit; it raises ErlifError where the input cannot be used."""


def check(directory: str | Path) -> list[Note]:
    """Check everything in a run or fixture directory that can be checked without computing a film.

    Parameters
    ----------
    directory : path
        With ``run.toml`` or ``fixture.toml``.

    Returns
    -------
    list of Note
        Findings in the order of the audit. It ends with the first error, because the later parts
        depend on the earlier ones.

    Examples
    --------
    >>> for note in check("an empty folder"):
    ...     print(note.level, note.subject)
    error settings
    """
    directory = Path(directory)
    notes: list[Note] = []
    subject = "settings"
    try:
        recording = _open(directory)
        height, width = recording.shape
        frames = f"{len(recording.frames)} pairs of {width} x {height} pixels"
        notes.append(Note(Level.NOTE, "frames", f"{frames}, {recording.settings.name!r}"))

        for name, step in _steps(recording):
            subject = name
            notes += step(recording)
    except ErlifError as error:
        notes.append(Note(Level.ERROR, subject, str(error)))
    return notes


def _open(directory: Path) -> Recording:
    """The run or the fixture in the directory."""
    if (directory / "run.toml").is_file():
        return open_run(directory)
    if (directory / "fixture.toml").is_file():
        return open_fixture(directory)
    if not directory.is_dir():
        raise ConfigError(
            f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; "
            "there is no such directory. Correct the name."
        )
    raise ConfigError(
        f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; it holds neither. "
        f"Make one from the files in it with: erlif init {directory}"
    )


def _steps(recording: Recording) -> list[tuple[str, Step]]:
    """Subject and function of each part of the audit."""
    steps: list[tuple[str, Step]] = [
        ("counts", _check_counts),
        ("darks and flats", _check_references),
    ]
    if isinstance(recording.settings, RunSettings):
        return [*steps, ("encoder log", _check_log), ("calibration", _check_calibration)]
    return [*steps, ("profile", _check_profile)]


def _check_counts(recording: Recording) -> Iterator[Note]:
    """Highest count of each camera, and how much of a frame is saturated."""
    highest = np.zeros(2, int)
    saturated = np.zeros(2)
    scale = np.array([camera.full_scale for camera in recording.cameras])

    # one pair at a time: a run may be larger than the memory
    for k in recording.frames:
        counts = read_frames(recording, [k]).counts.values[:, 0]
        highest = np.maximum(highest, counts.max(axis=(1, 2)))
        saturated = np.maximum(saturated, (counts >= scale[:, None, None]).mean(axis=(1, 2)))

    for camera, (settings, top, share) in enumerate(
        zip(recording.cameras, highest, saturated, strict=True), 1
    ):
        warning = depth_warning(settings, int(top), camera=camera)
        text = (
            f"camera{camera}: highest count {top} of {settings.full_scale}, "
            f"at most {share:.2%} of a frame saturated"
        )
        level = Level.WARNING if warning or share > BRIGHT else Level.NOTE
        yield Note(level, "counts", warning or text)


def _check_references(recording: Recording) -> Iterator[Note]:
    """Dark level, noise and gain of each camera, and where they disagree with the settings."""
    references = measure_references(recording)
    warnings = references.attrs["warnings"].split("\n")
    for text in references.attrs["notes"].split("\n"):
        yield Note(Level.WARNING if text in warnings else Level.NOTE, "darks and flats", text)


def _check_log(recording: Recording) -> Iterator[Note]:
    """Triggers, cycles and top speed as log and mechanism give them."""
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    assert recording.log is not None
    located = locate_frames(recording.log, settings)
    describe_triggers(recording, located, group_frames(located, recording))

    triggers, cycles = int(located.trigger.max()) + 1, int(located.cycle.max()) + 1
    top = float(np.abs(located.rocker_speed).max())
    text = f"{triggers} triggers in {cycles} cycle(s), joint speed up to {top:.3f} rad/s"
    yield Note(Level.NOTE, "encoder log", text)


def _check_calibration(recording: Recording) -> Iterator[Note]:
    """Whether the calibration exists and fits the bands of the run."""
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    if settings.calibration is None:
        text = "run.toml names none; process will need --calibration"
        yield Note(Level.WARNING, "calibration", text)
        return

    path = recording.directory / settings.calibration
    if path.exists():
        calibration = open_calibration(path)
        check_bands(calibration, (settings.camera1.band, settings.camera2.band))
        low, high = calibration.thickness_range
        text = f"{calibration.fixture!r}, measurable from {low:.2f} to {high:.2f} um"
        yield Note(Level.NOTE, "calibration", text)
    elif (path.parent / "fixture.toml").is_file():
        text = f"{settings.calibration} is not made yet; process will make it from the fixture"
        yield Note(Level.NOTE, "calibration", text)
    else:
        text = f"{settings.calibration} does not exist; process will need --calibration"
        yield Note(Level.WARNING, "calibration", text)


def _check_profile(recording: Recording) -> Iterator[Note]:
    """Number of points and range of the measured profile."""
    settings = recording.settings
    assert isinstance(settings, FixtureSettings)
    profile = read_profile(recording.directory / settings.fixture.profile)
    for note in profile.notes:
        yield Note(Level.WARNING, "profile", str(note))

    low, high = profile.thickness.min(), profile.thickness.max()
    text = f"{profile.thickness.size} points from {low:.2f} to {high:.2f} um"
    yield Note(Level.NOTE, "profile", text)
