"""A run or fixture directory, opened: frame pairs, settings and encoder log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.products import EncoderLog, Frames
from erlif.ingest.encoder_log import _check_rows, read_encoder_log
from erlif.ingest.images import Page, _check_depth, _read_page
from erlif.ingest.pairing import _pair_cameras
from erlif.settings import (
    CameraSettings,
    FixtureSettings,
    RunSettings,
    read_fixture_settings,
    read_run_settings,
)


@dataclass(frozen=True)
class Recording:
    """Two cameras' frames, paired, with the settings they were taken under.

    Attributes
    ----------
    directory : Path
    settings : RunSettings or FixtureSettings
    pages : tuple of two tuples of Page
        Frame k of camera 1 and frame k of camera 2 saw the same laser pulse.
    shape : (rows, columns)
    log : EncoderLog or None
        Row k belongs to frame k; None for a fixture.
    skipped : dict of int to str
        Frame pairs left out, with the reason.
    """

    directory: Path
    settings: RunSettings | FixtureSettings
    pages: tuple[tuple[Page, ...], tuple[Page, ...]]
    shape: tuple[int, int]
    log: EncoderLog | None = None
    skipped: dict[int, str] = field(default_factory=dict)

    @property
    def cameras(self) -> tuple[CameraSettings, CameraSettings]:
        """Settings of camera 1 and camera 2."""
        return self.settings.camera1, self.settings.camera2

    @property
    def frames(self) -> list[int]:
        """Numbers of the frame pairs that can be used."""
        return [k for k in range(len(self.pages[0])) if k not in self.skipped]


def open_run(run_dir: Path, *, skip_bad_frames: bool = False) -> Recording:
    """Open a run directory: settings, both cameras' files and the encoder log, checked against one another.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``.
    skip_bad_frames : bool
        Leave out frame pairs with an unreadable file instead of refusing the run.

    Raises
    ------
    ConfigError, FrameError, EncoderError
        If settings, frames or log cannot be used or do not belong together.
    """
    settings = read_run_settings(run_dir)
    pages, shape, skipped = _pair_cameras(run_dir, settings, skip_bad_frames=skip_bad_frames)
    log = read_encoder_log(run_dir / settings.encoder.file)
    _check_rows(log, pages[0], settings.encoder.file)
    return Recording(run_dir, settings, pages, shape, log, skipped)


def open_fixture(fixture_dir: Path, *, skip_bad_frames: bool = False) -> Recording:
    """Open a fixture directory; parameters and errors as for `open_run`, without a log."""
    settings = read_fixture_settings(fixture_dir)
    pages, shape, skipped = _pair_cameras(fixture_dir, settings, skip_bad_frames=skip_bad_frames)
    return Recording(fixture_dir, settings, pages, shape, None, skipped)


def read_frames(recording: Recording, frames: Sequence[int]) -> Frames:
    """Read frame pairs.

    Parameters
    ----------
    recording : Recording
    frames : sequence of int
        Frame numbers, counted from 0.

    Returns
    -------
    Frames
        counts (camera, frame, y, x) [DN].

    Raises
    ------
    FrameError
        If a file cannot be decoded, or counts do not fit the camera's bit depth.
    """
    counts = np.empty((2, len(frames), *recording.shape), np.uint16)
    for camera, (pages, settings) in enumerate(
        zip(recording.pages, recording.cameras, strict=True)
    ):
        for n, k in enumerate(frames):
            counts[camera, n] = _read_page(pages[k], recording.directory, recording.shape)
            _check_depth(counts[camera, n], settings, pages[k])
    return Frames(
        xr.Dataset(
            {
                "counts": (
                    ("camera", "frame", "y", "x"),
                    counts,
                    {"units": "DN", "long_name": "raw counts"},
                )
            },
            {"camera": [1, 2], "frame": np.asarray(frames, np.int64)},
        )
    )


def skipped_notes(recording: Recording) -> list[str]:
    """Which frame pairs were left out, and why."""
    return [f"frame pair {k} left out: {reason}" for k, reason in sorted(recording.skipped.items())]
