"""A fixture directory to a calibration, and the calibration of a run."""

from __future__ import annotations

import logging
import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from erlif.calibration import (
    Calibration,
    RunCurve,
    change_wall,
    check_bands,
    fit_calibration,
    open_calibration,
    read_profile,
    save_calibration,
)
from erlif.core.errors import CalibrationError, OutputError
from erlif.core.products import RatioImages
from erlif.core.progress import Progress, ShowProgress, choose_progress, silent
from erlif.core.timing import stage
from erlif.io.files import takes
from erlif.io.ingest import (
    Run,
    format_notes,
    hash_inputs,
    open_fixture,
    refuse_changed,
    skipped_notes,
    stamp_inputs,
)
from erlif.pipeline.chain import FrameChain, one_thread_per_frame
from erlif.pipeline.engines.results import (
    FrameResult,
    describe_frame_notes,
    known_digests,
    mean_drift,
)
from erlif.pipeline.physics.profile_offset import note_profile_offset
from erlif.pipeline.recording.prepare import prepare_chain
from erlif.pipeline.recording.pulses import check_pulses, refuse_stuck_cameras
from erlif.pipeline.recording.register import FixtureMap
from erlif.ratio import RatioSum
from erlif.registration import move_map

_logger = logging.getLogger(__name__)


@takes(fixture_dir="fixture")
def calibrate(
    fixture_dir: str | Path,
    *,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> Calibration:
    """Fit a calibration to a fixture directory.

    Parameters
    ----------
    fixture_dir : path
        Directory with ``fixture.toml``, frames of both cameras and the CMM profile.
    skip_bad_frames : bool
        Leave out frame pairs of which a file is missing or unreadable.
    allow_outside : bool
        Follow links and names of files that leave the directory.
    progress : "bar", bool or callable, optional
        "bar" or True shows a bar for each step; a function receives the name of the step, the
        number of items that are finished, and their total.

    Returns
    -------
    Calibration

    Raises
    ------
    ErlifError
        If something in the directory cannot be used; the message states what was expected, what
        was found and what to do.

    Examples
    --------
    >>> calibration = calibrate("calibration/wedge")
    >>> low, high = calibration.thickness_range
    >>> low < 1 < 10 < high
    True
    """
    progress = choose_progress(progress)
    fixture = open_fixture(
        Path(fixture_dir), skip_bad_frames=skip_bad_frames, allow_outside=allow_outside
    )
    settings, stamps = fixture.settings, stamp_inputs(fixture)
    profile = read_profile(fixture.directory / settings.fixture.profile)
    refuse_stuck_cameras(fixture.pairs)
    prepared = prepare_chain(fixture, progress, tables_only=True)

    with stage("ratio", _logger):
        ratio, frames = combine_all(prepared.chain, progress)
        notes_on_pulses = check_pulses(frames, fixture.pairs)
    pitch, position = 1e3 * settings.optics.pixel_pitch, settings.systematics.position
    with stage("fit", _logger):
        calibration = fit_calibration(
            ratio,
            profile,
            pixel_pitch=pitch,
            bands=(settings.camera1.band, settings.camera2.band),
            origin=settings.fixture.origin,
            direction=settings.fixture.direction,
            align=settings.fixture.align,
            frames=len(frames),
            fixture=settings.name,
            position_std=(pitch if position is None else 1e3 * position),
            size_std=settings.systematics.size / 100,
            reflectance=settings.optics.reflectance,
        )

    _logger.info(
        "calibrated range %.2f to %.2f um, reduced chi-square %.2f, %d frame pairs",
        *calibration.thickness_range,
        calibration.reduced_chi_square,
        len(frames),
    )
    hashes = hash_inputs(fixture, known_digests(frames, fixture.pairs))
    refuse_changed(fixture, stamps)
    return replace(
        calibration,
        input_hashes=hashes,
        date=fixture.pairs.date,
        temperature=settings.fixture.temperature,
        profile_file=os.path.relpath(
            fixture.directory / settings.fixture.profile, fixture.directory
        ),
        notes=(
            *note_profile_offset(frames, calibration, settings.fixture.profile),
            *calibration.notes,
            *prepared.notes,
            *notes_on_pulses,
            *describe_frame_notes(frames, fixture.pairs),
            *format_notes(fixture.pairs),
            *skipped_notes(fixture.pairs),
        ),
        camera_map=move_map(prepared.chain.camera_map, mean_drift(frames)),
    )


def combine_all(chain: FrameChain, progress: Progress) -> tuple[RatioImages, list[FrameResult]]:
    """The ratio of a film at rest from all frame pairs, and what is kept of each pair."""
    total = RatioSum(chain.pairs.shape)
    frames = []
    usable = chain.pairs.usable
    with one_thread_per_frame():
        for done, frame in enumerate(usable, 1):
            # the next pair fills the same arrays: the sum and the sample of the pulse copy
            pair = chain.measure(frame)
            total.add(pair)
            frames.append(FrameResult.of(frame, pair, with_cells=True))
            progress("ratio", done, len(usable))
    return RatioImages(total.mean().to_images().isel(frame=0)), frames


def find_calibration(
    run: Run,
    given: Calibration | RunCurve | str | Path | None,
    *,
    allow_outside: bool = False,
    progress: Progress = silent,
    fitted: dict[Path, Calibration] | None = None,
) -> tuple[RunCurve, FixtureMap]:
    """Find the calibration of a run, and the curve that begins with it.

    Parameters
    ----------
    run : Run
    given : Calibration, RunCurve or path, optional
        Takes precedence. Default: the calibration that run.toml names; where its file does not
        exist and a fixture lies in its directory, that fixture is calibrated.
    allow_outside : bool
        As for `calibrate`; a calibration made of a fixture outside the run directory is then kept
        in its directory too.
    progress : "bar", bool or callable, optional
    fitted : dict, optional
        Calibrations by their paths that were fitted for earlier runs and not kept; those of this
        run are added.

    Returns
    -------
    curve : RunCurve
        With the errors of the fixture alone.
    known : FixtureMap
        What a run needs of its camera map.

    Raises
    ------
    CalibrationError
        If there is none, it is of other bands, or lacks a map that the settings ask for.
    """
    if isinstance(given, RunCurve):
        found = [given.calibration, *filter(None, [given.later])]
    elif isinstance(given, Calibration):
        found = [given]
    elif given is not None:
        found = [open_calibration(given)]
    else:
        fitted = {} if fitted is None else fitted
        found = _named_calibrations(run, fitted, allow_outside=allow_outside, progress=progress)
    first, *others = (before_wall_of(run, one) for one in found)
    check_bands(first, (run.settings.camera1.band, run.settings.camera2.band))
    return RunCurve.of(first, *others), FixtureMap.of(first, run.settings)


def _named_calibrations(
    run: Run, fitted: dict[Path, Calibration], *, allow_outside: bool, progress: Progress
) -> list[Calibration]:
    """The calibrations that run.toml names: before the run, and after it."""
    if not run.settings.calibrations:
        raise CalibrationError(
            "Expected a calibration: run.toml names none. Add calibration = "
            '"path/to/calibration.nc" to it, or use --calibration.'
        )

    found = []
    for path in (run.directory / name for name in run.settings.calibrations):
        # a run from somebody else names any folder of this machine
        place = path.resolve()
        inside = place.is_relative_to(run.directory.resolve())
        if path.exists() or not (path.parent / "fixture.toml").is_file():
            found.append(open_calibration(path))
            continue
        if place not in fitted:
            with stage("calibration", _logger):
                made = calibrate(path.parent, allow_outside=allow_outside, progress=progress)
            fitted[place] = made
            if inside or allow_outside:
                with suppress(OutputError):  # a directory that cannot be written is no obstacle
                    save_calibration(made, path)
            else:
                _logger.info(
                    "the calibration is fitted and not kept, as %s lies outside the run directory; "
                    "it is kept by: erlif calibrate %s",
                    *2 * (os.path.normpath(path.parent),),
                )
        found.append(fitted[place])
    return found


def before_wall_of(run: Run, calibration: Calibration) -> Calibration:
    """Adapt the calibration to the reflectance of the wall, if the settings state one."""
    reflectance = run.settings.optics.reflectance
    return calibration if reflectance is None else change_wall(calibration, reflectance)
