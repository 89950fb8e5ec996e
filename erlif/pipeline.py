"""The stages in their order: a fixture to a calibration, a run to a film."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import warnings
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import erlif
from erlif.assembly import (
    MAPS,
    assemble_film,
    describe_frames,
    describe_map,
    describe_registration,
    describe_triggers,
    group_frames,
    pixel_positions,
    record_calibration,
    reference_notes,
    skipped_notes,
)
from erlif.calibration import Calibration, check_bands, fit_calibration, read_profile
from erlif.chain import (
    Chain,
    FrameRecord,
    Progress,
    move_map,
    one_thread_per_frame,
    prepare_chain,
    silent,
    some_frames,
)
from erlif.config import FixtureSettings, RunSettings, to_toml
from erlif.core.errors import CalibrationError, ErlifError, OutputError
from erlif.core.flags import Flag
from erlif.core.products import RatioImages, References
from erlif.core.store import (
    PartialFilm,
    describe_hashes,
    has_group,
    open_film,
    open_netcdf,
    refuse_existing,
    write_dataset,
    write_film,
)
from erlif.correction import measure_references
from erlif.ingest import Recording, hash_inputs, open_fixture, open_run
from erlif.kinematics import locate_frames
from erlif.models.fluorescence import band_signal
from erlif.noise import complete_noise
from erlif.ratio import RatioSum
from erlif.registration import CameraMap
from erlif.smoothing import smooth_ratio
from erlif.thickness import measure_thickness
from erlif.trend import region_mask, summarise_film


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
        notes=(
            *calibration.notes,
            *reference_notes(chain.references),
            *record.notes(recording),
            *skipped_notes(recording),
        ),
        camera_map=move_map(chain.camera_map, record.mean_drift()),
    )


def save_calibration(
    calibration: Calibration, output: str | Path, *, overwrite: bool = False
) -> Path:
    """Write ``calibration.nc``, whole or not at all; raises OutputError if it exists and `overwrite` is not set."""
    output = Path(output)
    refuse_existing(output, overwrite=overwrite)
    dataset = calibration.to_dataset().assign_attrs(
        Conventions="CF-1.11",
        title="ERLIF calibration",
        erlif_version=erlif.__version__,
        **calibration.attributes,
    )
    groups = (
        {}
        if calibration.camera_map is None
        else {"registration": describe_map(calibration.camera_map)}
    )
    write_dataset(dataset, output, groups=groups)
    return output


def open_calibration(path: str | Path) -> Calibration:
    """Read ``calibration.nc``; raises CalibrationError if it is none."""
    path = Path(path)
    if path.is_dir():
        raise CalibrationError(
            f"Expected a calibration file; {path} is a directory. Name its file: {path / 'calibration.nc'}"
        )
    if not path.is_file():
        raise CalibrationError(
            f"Expected a calibration file; {path} does not exist. Make one with: erlif calibrate FIXTURE_DIR"
        )
    try:
        with warnings.catch_warnings():
            # the file format allows covariance (parameter, parameter), which xarray reads with a warning
            warnings.filterwarnings("ignore", "Duplicate dimension names", UserWarning)
            with open_netcdf(path) as dataset:
                calibration = Calibration.from_dataset(dataset.load())
        if not has_group(path, "registration"):
            return calibration
        with open_netcdf(path, group="registration") as dataset:
            return replace(calibration, camera_map=CameraMap.from_dataset(dataset.load()))
    except ErlifError:
        raise
    except Exception as error:  # HDF5 raises whatever the damaged bytes lead it to
        raise CalibrationError(
            f"Expected a calibration as erlif calibrate writes it; {path} is damaged or something else ({error}). Make one with: erlif "
            "calibrate FIXTURE_DIR"
        ) from error


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


def _read_record(partial: PartialFilm, frames_of: list[list[int]]) -> FrameRecord:
    """What the frames of all triggers have shown."""
    record = FrameRecord()
    for trigger, frames in enumerate(frames_of):
        numbers = partial.numbers(trigger)
        for k, (x, y), (one, two) in zip(frames, numbers["drift"], numbers["peaks"], strict=True):
            record.drift[k] = (float(x), float(y))
            record.peaks[k] = (int(one), int(two))
    return record


def _run_tasks(
    task: _TriggerTask, frames_of: list[list[int]], workers: int | None, progress: Progress
) -> None:
    """Compute the triggers that are not finished, several at a time."""
    todo = [trigger for trigger in range(len(frames_of)) if not task.partial.has(trigger)]
    done = len(frames_of) - len(todo)
    with one_thread_per_frame(), ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        jobs = [pool.submit(task.run, trigger, frames_of[trigger]) for trigger in todo]
        try:
            for job in jobs:
                job.result()
                done += 1
                progress("film", done, len(frames_of))
        except BaseException:
            for job in jobs:
                job.cancel()
            raise


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


@dataclass(frozen=True)
class _TriggerTask:
    """All frames of one trigger to its maps and numbers, independent of every other trigger."""

    chain: Chain
    calibration: Calibration
    settings: RunSettings
    partial: PartialFilm

    def run(self, trigger: int, frames: list[int]) -> None:
        total, record = RatioSum(self.chain.recording.shape), FrameRecord()
        signals = []
        for k in frames:
            ratios = self.chain.ratio(k)
            record.add(k, ratios)
            signals.append(ratios.signal_camera1.values[0])
            total.add(ratios)
            if len(frames) > 1:
                signals[-1] = self._brightness(ratios)
        ratio = total.mean()
        if not frames:  # all were left out
            ratio.flags[:] = Flag.OUTSIDE_OVERLAP
        maps = measure_thickness(ratio, self.calibration)
        if len(frames) == 1:
            signals = [self._brightness_of(signals[0], maps.thickness.values, maps.flags.values)]
        x, y = pixel_positions(self.chain.recording)
        rows, columns = region_mask(self.settings, x, y)
        film = summarise_film(
            ratio,
            maps,
            self.calibration,
            x=x,
            y=y,
            rows=rows,
            columns=columns,
            sliding_along_x=self.settings.optics.x_axis == "sliding",
        )
        resolution = self.settings.thickness.smoothing
        if (
            resolution is not None
        ):  # the statistics above count on pixels whose noise is independent
            maps = measure_thickness(smooth_ratio(ratio, resolution=resolution), self.calibration)
        self.partial.put(
            trigger,
            {variable.name: maps[variable.name].values for variable in MAPS},
            MAPS,
            {
                **vars(film),
                "pulse_energy": np.array(signals),
                "frames_used": len(frames),
                "drift": np.array(list(record.drift.values())).reshape(-1, 2),
                "peaks": np.array(list(record.peaks.values())).reshape(-1, 2),
            },
        )

    def _brightness(self, ratios: RatioImages) -> float:
        maps = measure_thickness(ratios, self.calibration)
        return self._brightness_of(
            ratios.signal_camera1.values[0], maps.thickness.values[0], maps.flags.values[0]
        )

    def _brightness_of(self, signal: Any, thickness: Any, flags: Any) -> float:
        """Light of camera 1 over what this film would give at unit energy, in the middle of the image."""
        height, width = signal.shape
        middle = (slice(height // 4, 3 * height // 4, 2), slice(width // 4, 3 * width // 4, 2))
        good = flags[middle] == 0
        if good.sum() < 64:
            return float("nan")
        expected = band_signal(
            thickness[middle][good], attenuation=self.calibration.attenuation_camera1
        )
        return float(np.median(signal[middle][good] / expected))


def _refuse_foreign_ratio(chain: Chain, calibration: Calibration) -> None:
    """Recognise cameras swapped against the calibration: the inverse of the ratio is possible, the ratio itself is not.

    No film, however thick, has a ratio above K p/q.
    """
    low, high = calibration.predict_log(calibration.thickness_range)
    margin = 0.1 * (high - low)
    K, p, q = calibration.parameters
    gradient = np.array([1 / K, 1 / p, -1 / q])
    ceiling = np.log(K * p / q) + 2 * np.sqrt(gradient @ calibration.covariance @ gradient)
    shares = []
    for k in some_frames(chain.recording, 3):
        ratios = chain.ratio(k)
        good = ratios.flags.values == 0
        ratio, std = ratios.log_ratio.values[good], np.sqrt(ratios.log_ratio_var.values[good])
        if ratio.size:
            within = [(value > low - margin) & (value < high + margin) for value in (ratio, -ratio)]
            shares.append([within[0].mean(), within[1].mean(), (ratio - 2 * std > ceiling).mean()])
    if not shares:
        return
    inside, inverted, impossible = np.median(shares, axis=0)
    if inverted > 0.6 and (inside < 0.2 or impossible > 0.15):
        raise CalibrationError(
            f"Expected ratios camera2/camera1 between {np.exp(low):.3f} and {np.exp(high):.3f} as calibrated; {inverted:.0%} of the pixels "
            f"have the inverse of such a ratio, and {impossible:.0%} one that no film has. The cameras look swapped: exchange the files of "
            "[camera1] and [camera2] in run.toml."
        )


def _job_key(
    settings: RunSettings, hashes: dict[str, str], calibration: Calibration, recording: Recording
) -> str:
    """Identity of a piece of work: what goes in and what it is done with."""
    parts = [
        erlif.__version__,
        to_toml(settings),
        describe_hashes(hashes),
        record_calibration(calibration),
        json.dumps(sorted(recording.skipped)),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _date_of(recording: Recording) -> str:
    """Day the first frame was written, so that the same files give the same date whenever they are read."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    stamp = float(epoch) if epoch else recording.pages[0][0].path.stat().st_mtime
    return datetime.fromtimestamp(stamp, UTC).date().isoformat()
