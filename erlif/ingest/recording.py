"""A run or fixture directory, opened: settings, frame pairs and encoder log."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.core.products import EncoderLog
from erlif.ingest.encoder_log import check_rows, read_encoder_log
from erlif.ingest.frames import FramePairs
from erlif.ingest.pairing import pair_cameras
from erlif.ingest.selection import select_counts
from erlif.settings import (
    CameraSettings,
    FixtureSettings,
    RunSettings,
    read_fixture_settings,
    read_run_settings,
)


@dataclass(frozen=True)
class Run:
    """A run: frame pairs of the joint, one for each row of the encoder log.

    Attributes
    ----------
    directory : Path
        Directory with ``run.toml``.
    settings : RunSettings
        What ``run.toml`` holds.
    pairs : FramePairs
        Frames of camera 1 and camera 2.
    log : EncoderLog
        Row k belongs to frame pair k.
    """

    directory: Path
    settings: RunSettings
    pairs: FramePairs
    log: EncoderLog

    @property
    def cameras(self) -> tuple[CameraSettings, CameraSettings]:
        """Settings of camera 1 and camera 2."""
        return self.settings.camera1, self.settings.camera2


@dataclass(frozen=True)
class Fixture:
    """A calibration fixture: frame pairs of a film of known thickness.

    Attributes
    ----------
    directory : Path
        Directory with ``fixture.toml``.
    settings : FixtureSettings
        What ``fixture.toml`` holds.
    pairs : FramePairs
        Frames of camera 1 and camera 2.
    """

    directory: Path
    settings: FixtureSettings
    pairs: FramePairs

    @property
    def cameras(self) -> tuple[CameraSettings, CameraSettings]:
        """Settings of camera 1 and camera 2."""
        return self.settings.camera1, self.settings.camera2


def open_run(run_dir: Path, *, skip_bad_frames: bool = False) -> Run:
    """Open a run directory: settings, files of both cameras and encoder log, checked together.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``.
    skip_bad_frames : bool
        Leave out frame pairs with an unreadable file instead of refusing the run.

    Returns
    -------
    Run

    Raises
    ------
    ConfigError, FrameError, EncoderError
        If settings, frames or log cannot be used or do not belong together.

    Examples
    --------
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> len(run.pairs.usable), run.log.sizes["frame"]
    (50, 50)
    """
    settings = read_run_settings(run_dir)
    pairs = _open_pairs(run_dir, settings, skip_bad_frames=skip_bad_frames)

    log = read_encoder_log(run_dir / settings.encoder.file)
    check_rows(log, pairs.pages[0], settings.encoder.file)
    return Run(run_dir, settings, pairs, log)


def open_fixture(fixture_dir: Path, *, skip_bad_frames: bool = False) -> Fixture:
    """Open a fixture directory: settings and files of both cameras, checked together.

    Parameters
    ----------
    fixture_dir : Path
        Directory with ``fixture.toml``.
    skip_bad_frames : bool
        Leave out frame pairs with an unreadable file instead of refusing the fixture.

    Returns
    -------
    Fixture

    Raises
    ------
    ConfigError, FrameError
        If settings or frames cannot be used or do not belong together.

    Examples
    --------
    >>> fixture = open_fixture(Path("calibration/wedge"))
    >>> fixture.pairs.bit_depths
    (12, 12)
    """
    settings = read_fixture_settings(fixture_dir)
    pairs = _open_pairs(fixture_dir, settings, skip_bad_frames=skip_bad_frames)
    return Fixture(fixture_dir, settings, pairs)


def _open_pairs(
    directory: Path, settings: RunSettings | FixtureSettings, *, skip_bad_frames: bool
) -> FramePairs:
    # the ratio is camera 2 over camera 1: exchanged bands would turn its sign
    one, two = settings.camera1, settings.camera2
    if one.band >= two.band:
        raise FrameError(
            "Expected the band that dye 2 reabsorbs, the shorter wavelength, on camera 1; got "
            f"{one.band:g} nm on camera 1 and {two.band:g} nm on camera 2. The cameras look "
            "swapped: exchange the two tables."
        )
    return pair_cameras(
        directory,
        (one.files, two.files),
        bit_depths=(one.bit_depth, two.bit_depth),
        selections=(select_counts(one), select_counts(two)),
        skip_bad_frames=skip_bad_frames,
    )
