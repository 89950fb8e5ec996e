"""A look at a run or fixture directory before anything is computed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from erlif.calibration import check_bands, open_calibration, read_profile
from erlif.core.errors import ConfigError, ErlifError
from erlif.correction import measure_references
from erlif.ingest import Recording, depth_warning, open_fixture, open_run, read_frames
from erlif.kinematics import locate_frames
from erlif.pipeline.film import describe_triggers, group_frames
from erlif.settings import FixtureSettings, RunSettings


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at, and what was seen."""

    level: Literal["ok", "warning", "error"]
    subject: str
    text: str

    def __str__(self) -> str:
        return f"{self.level:8s}{self.subject}: {self.text}"


def check(directory: str | Path) -> list[Finding]:
    """Check everything in a run or fixture directory that can be checked without computing a film.

    Parameters
    ----------
    directory : path
        With ``run.toml`` or ``fixture.toml``.

    Returns
    -------
    list of Finding
        What was seen, in the order it was looked at; it ends with the first error, since what follows depends on it.
    """
    directory = Path(directory)
    findings: list[Finding] = []
    subject = "settings"
    try:
        if not (directory / "run.toml").is_file() and not (directory / "fixture.toml").is_file():
            what = "it holds neither" if directory.is_dir() else "there is no such directory"
            raise ConfigError(
                f"Expected a run (run.toml) or a fixture (fixture.toml) in {directory}; {what}. Name a directory as the rig wrote it."
            )
        opens = open_run if (directory / "run.toml").is_file() else open_fixture
        recording = opens(directory)
        height, width = recording.shape
        findings.append(
            Finding(
                "ok",
                "frames",
                f"{len(recording.frames)} pairs of {width} x {height} pixels, {recording.settings.name!r}",
            )
        )
        subject = "counts"
        findings += _look_at_counts(recording)
        subject = "darks and flats"
        references = measure_references(recording)
        warnings = references.attrs["warnings"].split("\n")
        findings += [
            Finding("warning" if note in warnings else "ok", subject, note)
            for note in references.attrs["notes"].split("\n")
        ]
        settings = recording.settings
        if isinstance(settings, RunSettings):
            subject = "encoder log"
            findings.append(_look_at_log(recording, settings))
            subject = "calibration"
            findings.append(_look_at_calibration(recording, settings))
        elif isinstance(settings, FixtureSettings):
            subject = "profile"
            profile = read_profile(directory / settings.fixture.profile)
            low, high = profile.thickness.min(), profile.thickness.max()
            findings += [Finding("warning", subject, note) for note in profile.notes]
            findings.append(
                Finding(
                    "ok",
                    subject,
                    f"{profile.thickness.size} points from {low:.2f} to {high:.2f} um",
                )
            )
    except ErlifError as error:
        findings.append(Finding("error", subject, str(error)))
    return findings


def _look_at_counts(recording: Recording) -> list[Finding]:
    """Read every frame once: highest counts, and how much of the image is saturated."""
    highest = np.zeros(2, int)
    saturated = np.zeros(2)
    scale = np.array([camera.full_scale for camera in recording.cameras])
    for k in recording.frames:
        counts = read_frames(recording, [k]).counts.values[:, 0]
        highest = np.maximum(highest, counts.max(axis=(1, 2)))
        saturated = np.maximum(saturated, (counts >= scale[:, None, None]).mean(axis=(1, 2)))
    findings = []
    for camera, settings in enumerate(recording.cameras, 1):
        warning = depth_warning(settings, int(highest[camera - 1]), camera=camera)
        text = f"camera{camera}: highest count {highest[camera - 1]} of {settings.full_scale}, at most {saturated[camera - 1]:.2%} of a frame saturated"
        bright = saturated[camera - 1] > 0.01
        findings.append(
            Finding("warning" if warning or bright else "ok", "counts", warning or text)
        )
    return findings


def _look_at_log(recording: Recording, settings: RunSettings) -> Finding:
    assert recording.log is not None
    located = locate_frames(recording.log, settings)
    describe_triggers(recording, located, group_frames(located, recording))
    triggers, cycles = int(located.trigger.max()) + 1, int(located.cycle.max()) + 1
    top = float(np.abs(located.rocker_speed).max())
    return Finding(
        "ok",
        "encoder log",
        f"{triggers} triggers in {cycles} cycle(s), joint speed up to {top:.3f} rad/s",
    )


def _look_at_calibration(recording: Recording, settings: RunSettings) -> Finding:
    if settings.calibration is None:
        return Finding(
            "warning", "calibration", "run.toml names none; process will need --calibration"
        )
    path = recording.directory / settings.calibration
    if not path.exists():
        if (path.parent / "fixture.toml").is_file():
            return Finding(
                "ok",
                "calibration",
                f"{settings.calibration} is not made yet; process will make it from the fixture",
            )
        return Finding(
            "warning",
            "calibration",
            f"{settings.calibration} does not exist; process will need --calibration",
        )
    calibration = open_calibration(path)
    check_bands(calibration, (settings.camera1.band, settings.camera2.band))
    low, high = calibration.thickness_range
    return Finding(
        "ok", "calibration", f"{calibration.fixture!r}, answers from {low:.2f} to {high:.2f} um"
    )
