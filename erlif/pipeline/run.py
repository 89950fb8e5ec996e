"""A run directory to a film: the stages in their order."""

from __future__ import annotations

import hashlib
import json
import tempfile
from pathlib import Path
from typing import Any

import xarray as xr

from erlif.calibration import Calibration, check_bands, record_calibration
from erlif.core.errors import CalibrationError
from erlif.core.products import References
from erlif.core.progress import Progress, silent
from erlif.core.version import __version__
from erlif.correction import measure_references
from erlif.files import PartialFilm, describe_hashes, open_film, refuse_existing, write_film
from erlif.ingest import Recording, hash_inputs, open_run
from erlif.kinematics import locate_frames
from erlif.pipeline.camera_noise import complete_noise
from erlif.pipeline.chain import Chain, prepare_chain
from erlif.pipeline.film import (
    MAPS,
    assemble_film,
    describe_frames,
    describe_registration,
    describe_triggers,
    group_frames,
    reference_notes,
)
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.swap import _refuse_foreign_ratio
from erlif.pipeline.triggers import _read_record, _run_tasks, _TriggerTask
from erlif.registration import CameraMap, move_map
from erlif.settings import RunSettings, to_toml


def process(
    run_dir: str | Path,
    *,
    calibration: Calibration | str | Path | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    skip_bad_frames: bool = False,
    workers: int | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Turn a run directory into film-thickness maps.

    Parameters
    ----------
    run_dir : path
        Directory with ``run.toml``, frames of both cameras and the encoder log.
    calibration : Calibration or path, optional
        Default: the one that run.toml names, fitted on the spot if its fixture lies beside it and it was not made yet.
    output : path, optional
        Where to write the film, netCDF or, by the suffix ``.zarr``, zarr. Default: nowhere, the film is only returned.
    overwrite : bool
        Replace an existing output.
    skip_bad_frames : bool
        Leave out unreadable frame pairs and say so in the film.
    workers : int, optional
        Threads; default: one per processor. The result does not depend on it.
    progress : callable, optional

    Returns
    -------
    xarray.Dataset
        The film, see the file format in the documentation; with `output`, maps are read from it when they are used.

    Raises
    ------
    ErlifError
        If an input cannot be used, or the output exists.
    """
    options: dict[str, Any] = {
        "calibration": calibration,
        "skip_bad_frames": skip_bad_frames,
        "workers": workers,
        "progress": progress,
    }
    if output is not None:
        _process_to(Path(run_dir), Path(output), overwrite=overwrite, **options)
        return open_film(output)
    with tempfile.TemporaryDirectory(prefix="erlif-") as scratch:
        _process_to(Path(run_dir), Path(scratch) / "film.nc", overwrite=True, **options)
        with open_film(Path(scratch) / "film.nc") as film:
            return film.load()


def _process_to(
    run_dir: Path,
    output: Path,
    *,
    calibration: Calibration | str | Path | None,
    overwrite: bool,
    skip_bad_frames: bool,
    workers: int | None,
    progress: Progress,
) -> None:
    refuse_existing(output, overwrite=overwrite)
    recording = open_run(run_dir, skip_bad_frames=skip_bad_frames)
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    assert recording.log is not None
    located = locate_frames(recording.log, settings)
    frames_of = group_frames(located, recording)
    triggers = describe_triggers(recording, located, frames_of)
    calibration = find_calibration(recording, calibration, progress=progress)
    check_bands(calibration, (settings.camera1.band, settings.camera2.band))
    references = measure_references(recording)
    hashes = hash_inputs(recording)
    with PartialFilm(output, _job_key(settings, hashes, calibration, recording)) as partial:
        chain = open_chain(recording, references, calibration, progress)
        _refuse_foreign_ratio(chain, calibration)
        _run_tasks(
            _TriggerTask(chain, calibration, settings, partial), frames_of, workers, progress
        )
        record = _read_record(partial, frames_of)
        notes = [*reference_notes(chain.references), *record.notes(recording)]
        film = assemble_film(recording, triggers, partial, calibration, settings, hashes, notes)
        camera_map = move_map(chain.camera_map, record.mean_drift())
        groups = {
            "frames": describe_frames(recording, located, record, partial, frames_of),
            "registration": describe_registration(camera_map, chain.blur),
        }
        write_film(output, film, groups, partial, MAPS)
        partial.discard()


def open_chain(
    recording: Recording, references: References, calibration: Calibration, progress: Progress
) -> Chain:
    """The stages from counts to ratio for a run that is read with this calibration."""
    settings = recording.settings
    assert isinstance(settings, RunSettings)
    return complete_noise(
        prepare_chain(recording, references, progress, stored=_stored_map(calibration, settings))
    )


def _stored_map(calibration: Calibration, settings: RunSettings) -> CameraMap | None:
    """The calibration's camera map where the settings ask for it."""
    if not settings.registration.reuse:
        return None
    if calibration.camera_map is None:
        raise CalibrationError(
            "Expected a camera map in the calibration, because [registration] says reuse = true; there is none. Calibrate again, or set "
            "reuse = false."
        )
    return calibration.camera_map


def _job_key(
    settings: RunSettings, hashes: dict[str, str], calibration: Calibration, recording: Recording
) -> str:
    """Identity of a piece of work: what goes in and what it is done with."""
    parts = [
        __version__,
        to_toml(settings),
        describe_hashes(hashes),
        record_calibration(calibration),
        json.dumps(sorted(recording.skipped)),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
