"""A fixture directory to a calibration."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from erlif.calibration import (
    Calibration,
    fit_calibration,
    open_calibration,
    read_profile,
    save_calibration,
)
from erlif.core.errors import CalibrationError, OutputError
from erlif.core.notes import Level, Note
from erlif.core.progress import Progress, silent
from erlif.correction import measure_references
from erlif.ingest import Recording, hash_inputs, open_fixture, skipped_notes
from erlif.pipeline.camera_noise import complete_noise
from erlif.pipeline.chain import FrameRecord, one_thread_per_frame, prepare_chain
from erlif.pipeline.film import reference_notes
from erlif.ratio import RatioSum
from erlif.registration import move_map
from erlif.settings import FixtureSettings, RunSettings


def calibrate(
    fixture_dir: str | Path, *, skip_bad_frames: bool = False, progress: Progress = silent
) -> Calibration:
    """Fit a calibration to a fixture directory.

    Parameters
    ----------
    fixture_dir : path
        Directory with ``fixture.toml``, frames of both cameras and the CMM profile.
    skip_bad_frames : bool
        Leave out unreadable frame pairs.
    progress : callable, optional

    Returns
    -------
    Calibration

    Raises
    ------
    ErlifError
        If something in the directory cannot be used; the message says what was expected, what came and what to do.
    """
    recording = open_fixture(Path(fixture_dir), skip_bad_frames=skip_bad_frames)
    settings = recording.settings
    assert isinstance(settings, FixtureSettings)
    profile = read_profile(recording.directory / settings.fixture.profile)
    references = measure_references(recording)
    chain = complete_noise(prepare_chain(recording, references, progress))
    total, record = RatioSum(recording.shape), FrameRecord()
    with one_thread_per_frame():
        for done, k in enumerate(recording.frames, 1):
            ratios = chain.ratio(k)
            total.add(ratios)
            record.add(k, ratios)
            progress("ratio", done, len(recording.frames))
    calibration = fit_calibration(
        total.mean(),
        profile,
        pixel_pitch=settings.optics.pixel_pitch * 1e3,
        bands=(settings.camera1.band, settings.camera2.band),
        origin=settings.fixture.origin,
        direction=settings.fixture.direction,
        align=settings.fixture.align,
        frames=total.frames,
        fixture=settings.name,
    )
    return replace(
        calibration,
        input_hashes=hash_inputs(recording),
        date=_date_of(recording),
        profile_file=os.path.relpath(
            recording.directory / settings.fixture.profile, recording.directory
        ),
        notes=(
            *calibration.notes,
            *(
                Note(Level.NOTE, "", text)
                for text in (
                    *reference_notes(chain.references),
                    *record.notes(recording),
                    *skipped_notes(recording),
                )
            ),
        ),
        camera_map=move_map(chain.camera_map, record.mean_drift()),
    )


def find_calibration(
    recording: Recording, given: Calibration | str | Path | None, *, progress: Progress = silent
) -> Calibration:
    """The calibration of a run: the one given, else the one run.toml names, else made, and kept, from the fixture beside that.

    Raises
    ------
    CalibrationError
        If there is none.
    """
    if isinstance(given, Calibration):
        return given
    if given is not None:
        return open_calibration(given)
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    if settings.calibration is None:
        raise CalibrationError(
            'Expected a calibration: run.toml names none. Add calibration = "path/to/calibration.nc" to it, or use --calibration.'
        )
    path = recording.directory / settings.calibration
    if not path.exists() and (path.parent / "fixture.toml").is_file():
        made = calibrate(path.parent, progress=progress)
        with suppress(
            OutputError
        ):  # kept for the next run where the fixture's directory can be written
            save_calibration(made, path)
        return made
    return open_calibration(path)


def _date_of(recording: Recording) -> str:
    """Day the first frame was written, so that the same files give the same date whenever they are read."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    stamp = float(epoch) if epoch else recording.pages[0][0].path.stat().st_mtime
    return datetime.fromtimestamp(stamp, UTC).date().isoformat()
