"""A run or fixture directory, opened: settings, frame pairs and encoder log."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from os import SEEK_END
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from erlif.core.arrays import Array
from erlif.core.errors import EncoderError, FrameError
from erlif.core.notes import Note, list_some
from erlif.core.products import EncoderLog
from erlif.io.ingest.containment import named_files, refuse_outside
from erlif.io.ingest.encoder_log import check_rows, leave_out_late_rows, read_log
from erlif.io.ingest.exclusions import exclude_pixels
from erlif.io.ingest.frames import FramePairs
from erlif.io.ingest.images import match_files
from erlif.io.ingest.logs.checks import is_nearly_by_frame
from erlif.io.ingest.logs.columns import MEANINGS, ColumnChoice
from erlif.io.ingest.logs.resample import ContinuousLog, find_pulses, find_rises, sample_log
from erlif.io.ingest.numbering import add_lost_pairs
from erlif.io.ingest.pairing import pair_cameras
from erlif.io.ingest.selection import select_counts
from erlif.io.settings import (
    CameraSettings,
    EncoderSettings,
    FixtureSettings,
    RunSettings,
    read_fixture_settings,
    read_run_settings,
)

_PAUSE = 1.5  # step of the time over the median one at which a row is missing

# Quantities of a log that are shown while it is written.
_SHOWN = ("angle", "joint_load", "temperature")


@dataclass(frozen=True)
class Recording:
    """Frame pairs in a directory with settings.

    Attributes
    ----------
    directory : Path
        Directory with ``run.toml`` or ``fixture.toml``.
    settings : RunSettings | FixtureSettings
        What that file holds.
    pairs : FramePairs
        Frames of camera 1 and camera 2.
    """

    directory: Path
    settings: RunSettings | FixtureSettings
    pairs: FramePairs

    @property
    def cameras(self) -> tuple[CameraSettings, CameraSettings]:
        """Settings of camera 1 and camera 2."""
        return self.settings.camera1, self.settings.camera2


@dataclass(frozen=True)
class Run(Recording):
    """A run: frame pairs of the joint, one for each row of the encoder log.

    Attributes
    ----------
    settings : RunSettings
        What ``run.toml`` holds.
    log : EncoderLog
        Row k belongs to frame pair k.
    log_notes : list[Note]
        What was taken for what in the log.
    """

    settings: RunSettings
    log: EncoderLog
    log_notes: list[Note] = field(default_factory=list)


@dataclass(frozen=True)
class Fixture(Recording):
    """A calibration fixture: frame pairs of a film of known thickness.

    Attributes
    ----------
    settings : FixtureSettings
        What ``fixture.toml`` holds.
    """

    settings: FixtureSettings


class FoundStart(NamedTuple):
    """Time of the first frame on the clock of a log in time.

    Attributes
    ----------
    value : float
        [s]
    std : float
        Standard deviation. [s]
    note : Note
        How it was found.
    """

    value: float
    std: float
    note: Note


# Finds the start from a log in time and the times of the frames after the first one [s].
FindStart = Callable[[RunSettings, FramePairs, ContinuousLog, Array], FoundStart]


def open_run(
    run_dir: Path,
    *,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    find_start: FindStart | None = None,
) -> Run:
    """Open a run directory: settings, files of both cameras and encoder log, checked together.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``.
    skip_bad_frames : bool
        Leave out frame pairs with a missing or unreadable file instead of refusing the run.
    allow_outside : bool
        Follow links and names that leave the directory.
    find_start : callable, optional
        Finds the time of the first frame in a continuous log where the settings ask for it.

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
    settings = read_run_settings(run_dir, allow_outside=allow_outside)
    if not allow_outside:
        refuse_outside(run_dir, named_files(settings))
    pairs = _open_pairs(run_dir, settings, skip_bad_frames=skip_bad_frames)

    # the log may have rows of pulses that neither camera has; it fits with them or without
    whole = add_lost_pairs(pairs) if skip_bad_frames else pairs
    if whole is not pairs and settings.encoder is not None and settings.encoder.file is not None:
        with suppress(EncoderError):
            log, notes = _open_log(run_dir, settings, whole, find_start, skip=True)
            return Run(run_dir, settings, whole, log, notes)
    log, notes = _open_log(run_dir, settings, pairs, find_start, skip=skip_bad_frames)
    return Run(run_dir, settings, pairs, log, notes)


def choose_columns(encoder: EncoderSettings) -> ColumnChoice:
    """Columns and units of the log, as the settings choose them.

    Returns
    -------
    ColumnChoice

    Examples
    --------
    >>> from erlif.io.settings import EncoderSettings
    >>> choose_columns(EncoderSettings(file="log.csv", angle="Winkel")).names
    {'angle': 'Winkel'}
    """
    names = {quantity: getattr(encoder, quantity) for quantity in MEANINGS}
    return ColumnChoice(
        {quantity: name for quantity, name in names.items() if name is not None},
        encoder.units.model_dump(exclude_none=True),
        encoder.ticks_per_turn,
    )


def _open_log(
    run_dir: Path,
    settings: RunSettings,
    pairs: FramePairs,
    find_start: FindStart | None,
    *,
    skip: bool,
) -> tuple[EncoderLog, list[Note]]:
    """The log with one row for each frame pair, and what was taken for what in it."""
    encoder = settings.encoder
    if encoder is None or encoder.file is None:
        return number_frames(pairs), []

    # the position of a linkage follows from the angle alone; other motions do without it
    log, notes = read_log(
        run_dir / encoder.file,
        choose_columns(encoder),
        frames=len(pairs.pages[0]),
        in_time=encoder.start is not None,
        needs_angle=settings.linkage is not None,
    )
    if not isinstance(log, ContinuousLog):
        if skip:
            log, late = leave_out_late_rows(log, pairs.pages[0], encoder.file)
            notes = [*notes, *late]
        check_rows(log, pairs.pages[0], encoder.file)
        return log, notes

    if "pulse" in log.samples:
        times = find_pulses(log, log.samples["pulse"].values, len(pairs.pages[0]))
        bare = ContinuousLog(log.file, log.samples.drop_vars("pulse"))
        return sample_log(bare, times), notes

    since = _times_after_first(encoder, pairs, log)
    if encoder.start == "fit":
        if find_start is None:
            raise EncoderError(
                'Expected the time of the first frame as start = "0.25 s" in [encoder]; "fit" is '
                "found by the commands alone. Give the time itself."
            )
        started = find_start(settings, pairs, log, since)
        sampled = sample_log(log, since + started.value)
        sampled["time"].attrs |= {"start": started.value, "start_std": started.std}
        return sampled, [*notes, started.note]
    if encoder.start is None:
        first, last = log.span
        _refuse_missing_row(log, len(pairs.pages[0]))
        raise EncoderError(
            f"Expected the time of the first frame on the clock of {log.file}, which runs from "
            f'{first:.6g} to {last:.6g} s; got none. Add start = "{first:.6g} s" to [encoder] of '
            'run.toml, or start = "fit" to find it from the motion.'
        )
    return sample_log(log, since + encoder.start), notes


def read_so_far(run_dir: Path, encoder: EncoderSettings, pulses: int) -> dict[str, Array]:
    """Encoder angle, load and temperature of each pulse, as far as a growing log has them.

    Parameters
    ----------
    run_dir : Path
    encoder : EncoderSettings
    pulses : int
        Number of pulses that the cameras have recorded.

    Returns
    -------
    dict of str to array, (frame,)
        "angle" [degree], "joint_load" [N] and "temperature" [degC], as far as the log has them;
        empty arrays where the times of the frames are those of the camera files or are fitted.

    Raises
    ------
    EncoderError
        If the log cannot be read, as where its last row lacks columns.
    OSError
        If there is no log yet.

    Examples
    --------
    >>> from erlif.io.settings import EncoderSettings
    >>> run_dir = Path("data_samples/straight_bushing")
    >>> found = read_so_far(run_dir, EncoderSettings(file="encoder.csv"), pulses=20)
    >>> {name: values.size for name, values in found.items()}
    {'angle': 20, 'joint_load': 20, 'temperature': 20}
    """
    if encoder.file is None:
        return {}
    path = run_dir / encoder.file
    with path.open("rb") as file:
        file.seek(-1, SEEK_END)
        begun = file.read() != b"\n"  # the last number may not be whole
    log, _ = read_log(
        path,
        choose_columns(encoder),
        frames=None,
        in_time=encoder.start is not None,
        needs_angle=False,
    )
    if not isinstance(log, ContinuousLog):
        whole = log.isel(frame=slice(min(log.sizes["frame"] - begun, pulses)))
        return {name: np.asarray(whole[name].values) for name in _SHOWN if name in whole}

    samples = log.samples.isel(sample=slice(-1 if begun else None))
    times, last = np.empty(0), float(samples["time"][-1])
    if "pulse" in samples:
        times = find_rises(log, samples["pulse"].values)
    elif encoder.frame_rate is not None and not isinstance(encoder.start, str | None):
        times = encoder.start + np.arange(pulses) / encoder.frame_rate
    known = times[times <= last][:pulses]
    return {
        name: np.asarray(np.interp(known, samples["time"], samples[name]))
        for name in _SHOWN
        if name in samples
    }


def number_frames(pairs: FramePairs) -> EncoderLog:
    """Make what stands in place of a log: numbers of the frames, and times of the camera files.

    Returns
    -------
    EncoderLog
        number (frame); time (frame) where the headers of the files have it [s].

    Examples
    --------
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> number_frames(run.pairs).number.values[:3]
    array([0, 1, 2])
    """
    log = xr.Dataset({"number": ("frame", np.arange(len(pairs.pages[0])))})
    if pairs.times is not None and np.isfinite(pairs.times).all():
        attrs = {"units": "s", "long_name": "time after the first frame"}
        log["time"] = ("frame", pairs.times, attrs)
    return EncoderLog(log)


def _times_after_first(encoder: EncoderSettings, pairs: FramePairs, log: ContinuousLog) -> Array:
    """Time of each frame pair after the first one. [s]"""
    if encoder.frame_rate is not None:
        return np.asarray(np.arange(len(pairs.pages[0])) / encoder.frame_rate)
    if pairs.times is None:
        rows, frames = log.samples.sizes["sample"], len(pairs.pages[0])
        _refuse_missing_row(log, frames)
        raise EncoderError(
            f"Expected the times of the frames, because {log.file} is a log in time, {rows} rows "
            f"for {frames} frames; the camera files have none. Add to [encoder] of run.toml pulse "
            '= "column of the trigger", or frame_rate = "500 Hz" and start = "0.25 s" (start = '
            '"fit" finds it).'
        )
    if not (np.isfinite(pairs.times).all() and (np.diff(pairs.times) > 0).all()):
        k = int(np.argmin(np.append(np.diff(pairs.times), np.inf) > 0))
        later = pairs.times[min(k + 1, pairs.times.size - 1)]
        raise EncoderError(
            f"Expected the times in the headers of the camera files to rise; frame {k + 1} has "
            f"{later:.9g} s after {pairs.times[k]:.9g} s. Give the rate of the frames: frame_rate "
            '= "500 Hz" in [encoder] of run.toml.'
        )
    return pairs.times


def _refuse_missing_row(log: ContinuousLog, frames: int) -> None:
    """Refuse a log whose rows are nearly as many as the frames: one for each was meant."""
    time = np.asarray(log.samples["time"].values)
    if not is_nearly_by_frame(time.size, frames):
        return
    step = np.diff(time)
    longest = int(np.argmax(step)) if step.size else 0
    paused = step.size and time.size < frames and step[longest] > _PAUSE * np.median(step)
    fault = "missing" if time.size < frames else "too many"
    where = f", perhaps after the one at {time[longest]:.6g} s" if paused else ""
    raise EncoderError(
        f"Expected one row of {log.file} for each frame; it has {time.size} rows for {frames} "
        f"frames: a row is {fault}{where}. Correct the log, or take the frame out of both cameras. "
        f'Only where it is a log in time, add start = "{time[0]:.6g} s" to [encoder] of run.toml, '
        'or start = "fit".'
    )


def open_fixture(
    fixture_dir: Path, *, skip_bad_frames: bool = False, allow_outside: bool = False
) -> Fixture:
    """Open a fixture directory: settings and files of both cameras, checked together.

    Arguments as in `open_run`, of a directory with ``fixture.toml``.

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
    if not allow_outside:
        refuse_outside(fixture_dir, named_files(settings))
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
    for number, camera in enumerate((one, two), 1):
        _refuse_references(directory, number, camera)
    encoder = settings.encoder if isinstance(settings, RunSettings) else None
    pairs = pair_cameras(
        directory,
        (one.files, two.files),
        bit_depths=(one.bit_depth, two.bit_depth),
        selections=(select_counts(one), select_counts(two)),
        skip_bad_frames=skip_bad_frames,
        has_log=encoder is not None and encoder.file is not None,
    )
    return replace(pairs, excluded=exclude_pixels(directory, settings, pairs.shape))


def _refuse_references(directory: Path, number: int, camera: CameraSettings) -> None:
    """Refuse a pattern of the frames that matches the darks or flats of the camera as well."""
    frames = match_files(directory, camera.files)
    among = {
        path: key
        for key in ("dark", "flat", "background")
        if (pattern := getattr(camera, key)) not in (None, camera.files)
        and getattr(camera, f"{key}_dataset") is None
        for path in match_files(directory, pattern)
        if path in frames
    }
    if among and len(among) < len(frames):
        named = list_some((f"{path.name} ({key})" for path, key in among.items()), most=3)
        rest = list_some((path.name for path in frames if path not in among), most=3)
        raise FrameError(
            f'Expected frames alone in files = "{camera.files}" of [camera{number}]; it matches '
            f"{len(frames)} files, among them {named} of the settings. Name the files of the "
            f"frames alone, for example {rest}."
        )
