"""The stages in their order: a fixture to a calibration, a run to a film."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import xarray as xr

import erlif
from erlif.alignment import align_frames
from erlif.calibration import Calibration, check_bands, fit_calibration, read_profile, with_history
from erlif.config import FixtureSettings, RunSettings, to_toml
from erlif.core.errors import CalibrationError, ConfigError, ErlifError
from erlif.core.flags import FLAG_ATTRS, Flag
from erlif.core.products import RatioImages, References
from erlif.core.store import (
    MapVariable,
    PartialFilm,
    describe_hashes,
    open_film,
    open_netcdf,
    refuse_existing,
    write_dataset,
    write_film,
)
from erlif.correction import correct_frames, measure_references
from erlif.ingest import Recording, depth_warning, hash_inputs, open_fixture, open_run, read_frames
from erlif.kinematics import locate_frames
from erlif.models.fluorescence import band_signal
from erlif.ratio import RatioSum, compute_ratio, is_steep
from erlif.registration import CameraMap, RegistrationSettings, register_frames
from erlif.thickness import measure_thickness
from erlif.trend import fit_exponent, predict_film, region_mask, summarise_film

Array = npt.NDArray[np.float64]
Progress = Callable[[str, int, int], None]
"""Told what is being done, how many of it are done, and how many there are."""

MAPS = [
    MapVariable(
        "thickness",
        "float32",
        {
            "units": "um",
            "long_name": "oil-film thickness",
            "ancillary_variables": "thickness_std thickness_std_shared flags",
        },
        bits=11,
    ),
    MapVariable(
        "thickness_std",
        "float32",
        {"units": "um", "long_name": "standard deviation of thickness, random part of each pixel"},
        bits=6,
    ),
    MapVariable(
        "thickness_std_shared",
        "float32",
        {"units": "um", "long_name": "standard deviation of thickness, what all pixels share"},
        bits=6,
    ),
    MapVariable("flags", "uint8", FLAG_ATTRS),
]


def _silent(what: str, done: int, total: int) -> None:
    """Report nothing."""


def calibrate(fixture_dir: str | Path, *, skip_bad_frames: bool = False, progress: Progress = _silent) -> Calibration:
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
    camera_map, drift = _register(recording, references, progress)
    total = RatioSum(recording.shape)
    with _one_thread_per_frame():
        for done, (k, offset) in enumerate(zip(recording.frames, drift, strict=True), 1):
            total.add(_ratio_of(recording, references, camera_map, [k], offset[None]))
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
    return with_history(
        calibration,
        input_hashes=hash_inputs(recording),
        date=_date_of(recording),
        notes=(*_notes(references), *_skipped_notes(recording)),
    )


def save_calibration(calibration: Calibration, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write ``calibration.nc``, whole or not at all; raises OutputError if it exists and `overwrite` is not set."""
    output = Path(output)
    refuse_existing(output, overwrite=overwrite)
    dataset = calibration.to_dataset().assign_attrs(
        Conventions="CF-1.11", title="ERLIF calibration", erlif_version=erlif.__version__, **calibration.attributes
    )
    write_dataset(dataset, output)
    return output


def open_calibration(path: str | Path) -> Calibration:
    """Read ``calibration.nc``; raises CalibrationError if it is none."""
    path = Path(path)
    if not path.is_file():
        raise CalibrationError(
            f"Expected a calibration file; {path} does not exist. Make one with: erlif calibrate FIXTURE_DIR"
        )
    try:
        with warnings.catch_warnings():
            # the file format allows covariance (parameter, parameter), which xarray reads with a warning
            warnings.filterwarnings("ignore", "Duplicate dimension names", UserWarning)
            with open_netcdf(path) as dataset:
                return Calibration.from_dataset(dataset.load())
    except ErlifError:
        raise
    except Exception as error:  # HDF5 raises whatever the damaged bytes lead it to
        raise CalibrationError(
            f"Expected a calibration as erlif calibrate writes it; {path} cannot be read ({error})."
        ) from error


def process(
    run_dir: str | Path,
    *,
    calibration: Calibration | str | Path | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    skip_bad_frames: bool = False,
    workers: int | None = None,
    progress: Progress = _silent,
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
        camera_map, drift = _register(recording, references, progress)
        drift_of = dict(zip(recording.frames, drift, strict=True))
        _refuse_foreign_ratio(recording, references, camera_map, drift_of, calibration)
        task = _TriggerTask(recording, references, camera_map, drift_of, calibration, settings, partial)
        _run_tasks(task, frames_of, workers, progress)
        film = _assemble(recording, triggers, partial, calibration, settings, hashes, references)
        frames = _frames_group(recording, located, drift_of, partial, frames_of)
        write_film(output, film, {"frames": frames, "registration": _registration_group(camera_map)}, partial, MAPS)
        partial.discard()


def _run_tasks(task: _TriggerTask, frames_of: list[list[int]], workers: int | None, progress: Progress) -> None:
    """Compute the triggers that are not finished, several at a time."""
    todo = [trigger for trigger in range(len(frames_of)) if not task.partial.has(trigger)]
    done = len(frames_of) - len(todo)
    with _one_thread_per_frame(), ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
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
    recording: Recording, given: Calibration | str | Path | None, *, progress: Progress = _silent
) -> Calibration:
    """The calibration of a run: the one given, else the one run.toml names, else fitted to the fixture beside that.

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
        return calibrate(path.parent, progress=progress)
    return open_calibration(path)


def _register(recording: Recording, references: References, progress: Progress) -> tuple[CameraMap, Array]:
    """Fixed map of the cameras, and the drift of each usable frame."""
    options = recording.settings.registration
    large = recording.shape[0] * recording.shape[1] > 500_000
    settings = RegistrationSettings(
        window=options.window,
        step=options.step,
        model=options.model,
        orientation=options.orientation,
        frames_for_map=options.frames or (4 if large else 12),
        threads=2 if large else 1,
    )
    frames = _LazyPairs(recording, references, progress)
    camera_map, drift = register_frames(frames, settings=settings)
    for camera, (camera_settings, highest) in enumerate(zip(recording.cameras, frames.highest, strict=True), 1):
        warning = depth_warning(camera_settings, highest, camera=camera)
        if warning:
            references.attrs["notes"] = "\n".join(filter(None, [references.attrs.get("notes", ""), warning]))
    return camera_map, drift


class _LazyPairs(Sequence[tuple[Any, Any, Any, Any]]):
    """Corrected frame pairs with the weights of their pixels, read when they are asked for."""

    def __init__(self, recording: Recording, references: References, progress: Progress) -> None:
        self.recording, self.references, self.progress = recording, references, progress
        self.numbers = recording.frames
        self.highest = [0, 0]
        self.good = ~references.bad.values

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: Any) -> tuple[Any, Any, Any, Any]:
        frames = read_frames(self.recording, [self.numbers[index]])
        corrected = correct_frames(frames, self.references, least_signal=self.recording.settings.thickness.least_signal)
        peaks = frames.counts.max(("frame", "y", "x")).values
        self.highest = [max(a, int(b)) for a, b in zip(self.highest, peaks, strict=True)]
        lit = (corrected.flags.values[:, 0] & (Flag.SATURATED | Flag.BAD_PIXEL)) == 0
        self.progress("registration", index + 1, len(self))
        one, two = corrected.signal.values[:, 0]
        return one, two, *((lit[n] & ~is_steep(signal)).astype(np.float32) for n, signal in enumerate((one, two)))


def _ratio_of(
    recording: Recording, references: References, camera_map: CameraMap, frames: list[int], drift: Array
) -> RatioImages:
    """The stages from counts to ratio for some frames."""
    options = recording.settings.thickness
    corrected = correct_frames(read_frames(recording, frames), references, least_signal=options.least_signal)
    aligned = align_frames(corrected, camera_map, drift=drift)
    return compute_ratio(aligned, no_film_below=options.no_film_below)


@dataclass(frozen=True)
class _TriggerTask:
    """All frames of one trigger to its maps and numbers, independent of every other trigger."""

    recording: Recording
    references: References
    camera_map: CameraMap
    drift_of: dict[int, Array]
    calibration: Calibration
    settings: RunSettings
    partial: PartialFilm

    def run(self, trigger: int, frames: list[int]) -> None:
        total = RatioSum(self.recording.shape)
        signals = []
        for k in frames:
            ratios = _ratio_of(self.recording, self.references, self.camera_map, [k], self.drift_of[k][None])
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
        x, y = _pixel_positions(self.recording)
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
        self.partial.put(
            trigger,
            {variable.name: maps[variable.name].values for variable in MAPS},
            MAPS,
            {**vars(film), "pulse_energy": np.array(signals), "frames_used": len(frames)},
        )

    def _brightness(self, ratios: RatioImages) -> float:
        maps = measure_thickness(ratios, self.calibration)
        return self._brightness_of(ratios.signal_camera1.values[0], maps.thickness.values[0], maps.flags.values[0])

    def _brightness_of(self, signal: Any, thickness: Any, flags: Any) -> float:
        """Light of camera 1 over what this film would give at unit energy, in the middle of the image."""
        height, width = signal.shape
        middle = (slice(height // 4, 3 * height // 4, 2), slice(width // 4, 3 * width // 4, 2))
        good = flags[middle] == 0
        if good.sum() < 64:
            return float("nan")
        expected = band_signal(thickness[middle][good], attenuation=self.calibration.attenuation_camera1)
        return float(np.median(signal[middle][good] / expected))


def group_frames(located: xr.Dataset, recording: Recording) -> list[list[int]]:
    """Numbers of the usable frames of each trigger; `located` as `locate_frames` gives it."""
    triggers = int(located.trigger.max()) + 1
    frames: list[list[int]] = [[] for _ in range(triggers)]
    for k in recording.frames:
        frames[int(located.trigger[k])].append(k)
    return frames


def _refuse_foreign_ratio(
    recording: Recording,
    references: References,
    camera_map: CameraMap,
    drift_of: dict[int, Array],
    calibration: Calibration,
) -> None:
    """Recognise cameras swapped against the calibration: the inverse of the ratio is possible, the ratio itself is not.

    No film, however thick, has a ratio above K p/q.
    """
    low, high = calibration.predict_log(calibration.thickness_range)
    margin = 0.1 * (high - low)
    K, p, q = calibration.parameters
    gradient = np.array([1 / K, 1 / p, -1 / q])
    ceiling = np.log(K * p / q) + 2 * np.sqrt(gradient @ calibration.covariance @ gradient)
    chosen = [recording.frames[round(place)] for place in np.linspace(0, len(recording.frames) - 1, 3)]
    shares = []
    for k in chosen:
        ratios = _ratio_of(recording, references, camera_map, [k], drift_of[k][None])
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


def _pixel_positions(recording: Recording) -> tuple[Array, Array]:
    pitch = recording.settings.optics.pixel_pitch * 1e3
    height, width = recording.shape
    return np.arange(width, dtype=float) * pitch, np.arange(height, dtype=float) * pitch


def _assemble(
    recording: Recording,
    triggers: xr.Dataset,
    partial: PartialFilm,
    calibration: Calibration,
    settings: RunSettings,
    hashes: dict[str, str],
    references: References,
) -> xr.Dataset:
    """Everything of the film but its maps."""
    numbers = [partial.numbers(trigger) for trigger in range(triggers.sizes["trigger"])]
    stacked = {name: np.stack([record[name] for record in numbers]) for name in numbers[0] if name != "pulse_energy"}
    film = triggers.copy()
    film["frames_used"] = ("trigger", stacked["frames_used"], {"units": "1", "long_name": "frames of this trigger"})
    for name, meaning in (("mean", "mean film over the region of interest"), ("min", "least film of a smooth gap")):
        source = {"mean": "mean", "min": "minimum"}[name]
        attrs = {"units": "um", "long_name": meaning, "ancillary_variables": f"film_{name}_std"}
        film[f"film_{name}"] = ("trigger", stacked[source], attrs)
        film[f"film_{name}_std"] = (
            "trigger",
            stacked[f"{source}_std"],
            {"units": "um", "long_name": "its standard deviation, random and shared"},
        )
    film = film.merge(predict_film(film, settings), combine_attrs="drop_conflicts")
    for suffix, source in (("", "minimum"), ("_mean", "mean")):
        exponent = fit_exponent(
            stacked[source],
            stacked[f"{source}_random_std"],
            speed=film.rocker_speed.values,
            load=film["load"].values,
            parameter_gradient=stacked[f"{source}_gradient"],
            covariance=calibration.covariance,
        )
        what = "film_min" if suffix == "" else "film_mean"
        film[f"speed_exponent{suffix}"] = (
            (),
            exponent.value,
            {
                "units": "1",
                "long_name": f"power of |rocker_speed|/load that {what} follows",
                "log_scale": exponent.log_scale,
                "triggers_used": exponent.triggers,
            },
        )
        film[f"speed_exponent{suffix}_std"] = ((), exponent.std, {"units": "1", "long_name": "its standard deviation"})
    x, y = _pixel_positions(recording)
    film = film.assign_coords(
        x=("x", x, {"units": "mm", "long_name": f"position along x, {settings.optics.x_axis}"}),
        y=("y", y, {"units": "mm", "long_name": "position along y, downwards"}),
    )
    return film.assign_attrs(
        Conventions="CF-1.11",
        title=f"oil-film thickness, {settings.name}",
        history=f"erlif {erlif.__version__}: process {settings.name}",
        erlif_version=erlif.__version__,
        settings=to_toml(settings),
        input_hashes=describe_hashes(hashes),
        calibration=_describe_calibration(calibration),
        notes="\n".join(
            [*_notes(references), *(f"calibration: {note}" for note in calibration.notes), *_skipped_notes(recording)]
        ),
    )


def describe_triggers(recording: Recording, located: xr.Dataset, frames_of: list[list[int]]) -> xr.Dataset:
    """Means of what log and kinematics say of the frames of each trigger, checked to be enough for a film.

    Raises
    ------
    ConfigError
        If neither the log nor the settings tell the load, Vogel's law has no temperature, or the region of interest lies outside
        the image.
    """
    settings, log = recording.settings, recording.log
    assert isinstance(settings, RunSettings)
    assert log is not None
    columns = {name: located[name] for name in ("encoder_angle", "rocker_speed", "sliding_speed")}
    columns |= {str(name): log[name] for name in log if name not in ("number", "angle", "time")}
    if "load" not in columns:
        if settings.joint.load is None:
            raise ConfigError(
                'Expected the load: the encoder log has no load_N and [joint] no load. Add load = "50 lbf" to [joint] in run.toml.'
            )
        columns["load"] = xr.full_like(located.encoder_angle, settings.joint.load).assign_attrs(
            units="N", long_name="load on the joint"
        )
    film = xr.Dataset(coords={"trigger": np.arange(len(frames_of))})
    every = [frames or _all_frames(located, trigger) for trigger, frames in enumerate(frames_of)]
    for name, column in columns.items():
        if column.dtype.kind in "fiu":
            means = [float(column.values[frames].mean()) for frames in every]
            film[name] = ("trigger", np.array(means), column.attrs)
        else:
            film[name] = ("trigger", np.array([str(column.values[frames[0]]) for frames in every]), column.attrs)
    film["stroke"] = ("trigger", np.array([located.stroke.values[f[0]] for f in every]), located.stroke.attrs)
    angles = [np.exp(1j * np.radians(located.crank_angle.values[f])).mean() for f in every]
    film["crank_angle"] = ("trigger", np.degrees(np.angle(angles)) % 360, located.crank_angle.attrs)
    predict_film(film, settings)
    region_mask(settings, *_pixel_positions(recording))
    return film


def _all_frames(located: xr.Dataset, trigger: int) -> list[int]:
    return [int(k) for k in np.nonzero(located.trigger.values == trigger)[0]]


def _frames_group(
    recording: Recording,
    located: xr.Dataset,
    drift_of: dict[int, Array],
    partial: PartialFilm,
    frames_of: list[list[int]],
) -> xr.Dataset:
    """The frames group of the film: what belongs to single frames."""
    count = located.sizes["frame"]
    drift = np.full((count, 2), np.nan)
    energy = np.full(count, np.nan)
    for trigger, frames in enumerate(frames_of):
        values = partial.numbers(trigger)["pulse_energy"]
        for k, value in zip(frames, values, strict=True):
            drift[k] = drift_of[k]
            energy[k] = value
    log = recording.log
    assert log is not None
    names = [[page.name for page in pages] for pages in recording.pages]
    group = xr.Dataset(
        {
            "trigger": located.trigger,
            "cycle": located.cycle,
            "drift_x": ("frame", drift[:, 0], {"units": "px", "long_name": "drift of camera 2 along x"}),
            "drift_y": ("frame", drift[:, 1], {"units": "px", "long_name": "drift of camera 2 along y"}),
            "pulse_energy": (
                "frame",
                energy / np.nanmean(energy) if np.isfinite(energy).any() else energy,
                {"units": "1", "long_name": "pulse energy relative to the mean"},
            ),
            "file_camera1": ("frame", np.array(names[0])),
            "file_camera2": ("frame", np.array(names[1])),
        }
    )
    time = log["time"] if "time" in log else xr.full_like(located.encoder_angle, np.nan)
    group["time"] = ("frame", time.values, {"units": "s", "long_name": "time of the trigger"})
    if recording.skipped:
        group.attrs["skipped_frames"] = "\n".join(_skipped_notes(recording))
    return group.reset_coords(drop=True)


def _registration_group(camera_map: CameraMap) -> xr.Dataset:
    """The registration group of the film."""
    compress = {"zlib": True, "complevel": 1, "shuffle": True}
    dataset = camera_map.to_dataset()
    for name in dataset:
        dataset[name].encoding.update(compress)
    return dataset


def _job_key(settings: RunSettings, hashes: dict[str, str], calibration: Calibration, recording: Recording) -> str:
    """Identity of a piece of work: what goes in and what it is done with."""
    parts = [
        erlif.__version__,
        to_toml(settings),
        describe_hashes(hashes),
        json.dumps([calibration.parameters.tolist(), calibration.covariance.tolist(), calibration.thickness_range]),
        json.dumps(sorted(recording.skipped)),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _describe_calibration(calibration: Calibration) -> str:
    K, p, q = calibration.parameters
    low, high = calibration.thickness_range
    return json.dumps(
        {
            "fixture": calibration.fixture,
            "date": calibration.date,
            "ratio_at_zero": K,
            "attenuation_camera1": p,
            "attenuation_camera2": q,
            "covariance": calibration.covariance.tolist(),
            "thickness_range": [low, high],
            "input_hashes": calibration.input_hashes,
        },
        sort_keys=True,
    )


def _date_of(recording: Recording) -> str:
    """Day the first frame was written, so that the same files give the same date whenever they are read."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    stamp = float(epoch) if epoch else recording.pages[0][0].path.stat().st_mtime
    return datetime.fromtimestamp(stamp, UTC).date().isoformat()


def _notes(references: References) -> list[str]:
    return [note for note in str(references.attrs.get("notes", "")).split("\n") if note]


def _skipped_notes(recording: Recording) -> list[str]:
    return [f"frame pair {k} left out: {reason}" for k, reason in sorted(recording.skipped.items())]


@contextmanager
def _one_thread_per_frame() -> Iterator[None]:
    """Keep OpenCV to the thread that calls it: the threads work on different frames."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
