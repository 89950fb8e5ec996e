"""A run directory to a film: the method, stage by stage."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import xarray as xr

from erlif.calibration import Calibration, check_bands
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.speed.memory import release_memory
from erlif.core.timing import stage
from erlif.io.files import PartialFilm, open_film, refuse_existing, remove_remains, takes
from erlif.io.ingest import Run, open_run
from erlif.kinematics import encoder_notes
from erlif.pipeline.chain import FrameChain
from erlif.pipeline.engines.engine import Engine, open_engine
from erlif.pipeline.engines.results import (
    FrameResult,
    TriggerResult,
    describe_frame_notes,
    frames_in,
    mean_drift,
)
from erlif.pipeline.engines.triggers import TriggerTask, run_triggers
from erlif.pipeline.film import (
    choose_region,
    describe_cycle,
    describe_film,
    describe_frames,
    describe_registration,
    describe_statistics,
    describe_triggers,
    group_frames,
    pixel_positions,
)
from erlif.pipeline.fixture import find_calibration
from erlif.pipeline.physics.clock import fit_start
from erlif.pipeline.physics.fit import state_physics
from erlif.pipeline.physics.joint import locate_run
from erlif.pipeline.physics.light import (
    choose_frames,
    describe_light,
    find_light,
    kept_lights,
    run_patch,
    widen_errors,
)
from erlif.pipeline.physics.position import choose_view, describe_positions
from erlif.pipeline.physics.prediction import (
    Prediction,
    frames_of_run,
    places_along_sliding,
    try_prediction,
)
from erlif.pipeline.recording.prepare import PreparedRun, prepare_run
from erlif.pipeline.recording.pulse_order import check_first_pulses, check_pulses
from erlif.pipeline.recording.register import FixtureMap
from erlif.pipeline.work import FilmWork
from erlif.registration import move_map

_logger = logging.getLogger(__name__)


@takes(run_dir="run", calibration="calibration path", output="path")
def process(
    run_dir: str | Path,
    *,
    calibration: Calibration | str | Path | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    skip_bad_frames: bool = False,
    allow_outside: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: ShowProgress = None,
) -> xr.Dataset:
    """Turn a run directory into film-thickness maps.

    Parameters
    ----------
    run_dir : path
        Directory with ``run.toml``, frames of both cameras and the encoder log.
    calibration : Calibration or path, optional
        Default: the one that run.toml names; it is fitted where its fixture lies beside it and it
        does not exist yet.
    output : path, optional
        Where to write the film, netCDF or, by the suffix ``.zarr``, zarr. Default: nowhere, the
        film is only returned.
    overwrite : bool
        Replace an existing output.
    skip_bad_frames : bool
        Leave out unreadable frame pairs; the film lists them.
    allow_outside : bool
        Follow links and names of files that leave the directory.
    workers : int, optional
        Threads; default: one per processor. The result does not depend on it.
    scheduler : str, optional
        Workers of dask in place of threads: ``local:N`` starts N of them on this machine, the
        address or the file of a scheduler uses those that it has. The result is the same.
    progress : "bar", bool or callable, optional
        "bar" or True shows a bar for each step; a function receives the name of the step, the
        number of items that are finished, and their total.

    Returns
    -------
    xarray.Dataset
        The film, as docs/files.md describes it; with `output`, maps are read from it when used.

    Raises
    ------
    ErlifError
        If an input cannot be used, or the output exists.

    Examples
    --------
    >>> film = process("data_samples/straight_bushing")  # doctest: +SKIP
    >>> film.thickness.dims  # doctest: +SKIP
    ('trigger', 'y', 'x')
    """
    progress = choose_progress(progress)
    with open_engine(workers=workers, scheduler=scheduler) as engine:
        options: dict[str, Any] = {
            "calibration": calibration,
            "skip_bad_frames": skip_bad_frames,
            "allow_outside": allow_outside,
            "engine": engine,
            "progress": progress,
        }
        if output is not None:
            process_run(Path(run_dir), Path(output), overwrite=overwrite, **options)
            return open_film(output)
        with tempfile.TemporaryDirectory(prefix="erlif-") as scratch:
            process_run(Path(run_dir), Path(scratch) / "film.nc", overwrite=True, **options)
            path = Path(scratch) / "film.nc"
            with open_film(path) as film:
                film.load()
            groups = {}
            for name in ("frames", "registration"):
                with open_film(path, group=name) as group:
                    groups[name] = group.load()

            # the file goes; `film.erlif` finds its groups here
            film.encoding = {"groups": groups}
            return film


def process_run(
    run_dir: Path,
    output: Path,
    *,
    calibration: Calibration | str | Path | None,
    overwrite: bool,
    skip_bad_frames: bool,
    allow_outside: bool,
    engine: Engine,
    progress: Progress,
    resume: bool = False,
) -> bool:
    """Process a run into a file; parameters as for `process` and `batch`.

    Returns False where the film is kept that the same work has made before.
    """
    # workers elsewhere have another working directory
    if engine.elsewhere:
        run_dir, output = run_dir.absolute(), output.absolute()
    remove_remains(output)
    if not resume:
        refuse_existing(output, overwrite=overwrite, holds="thickness")

    # the run, its kinematics (which frames belong to which trigger) and its calibration
    run = open_run(
        run_dir, skip_bad_frames=skip_bad_frames, find_start=fit_start, allow_outside=allow_outside
    )
    cycle = locate_run(run)
    frames_of, triggers = group_frames(cycle, run.pairs), describe_triggers(run, cycle)
    calibration = find_calibration(run, calibration, allow_outside=allow_outside, progress=progress)
    check_bands(calibration, (run.settings.camera1.band, run.settings.camera2.band))
    _log_inputs(run, cycle, calibration)

    # the map of the fixture is large, and it is used only where the settings ask for it
    known = FixtureMap.of(calibration, run.settings)
    calibration = replace(calibration, camera_map=None)
    work = FilmWork.of(run, calibration, output)
    if resume and work.is_done(overwrite=overwrite):
        return False

    with work.unfinished(len(frames_of)) as unfinished:
        ready = prepare_run(run, cycle, calibration, known, progress)
        del known
        release_memory()

        # frames: counts -> light -> ratio -> thickness, trigger by trigger
        results = measure_run(run, ready, frames_of, unfinished, engine=engine, progress=progress)
        release_memory()

        # the whole: statistics, theory, exponent, and the record of how it was made
        hashes = work.hash_inputs(results)
        film, groups = complete_film(run, cycle, triggers, ready, results, calibration, hashes)
        work.write(unfinished, film, groups, hashes)
    return True


def measure_run(
    run: Run,
    ready: PreparedRun,
    frames_of: Sequence[Sequence[int]],
    unfinished: PartialFilm,
    *,
    engine: Engine,
    progress: Progress,
) -> list[TriggerResult]:
    """Measure the triggers of a run that are not finished yet.

    Parameters
    ----------
    run : Run
    ready : PreparedRun
    frames_of : sequence of sequence of int
        Frame pairs of each trigger.
    unfinished : PartialFilm
        Receives the maps.
    engine : Engine
    progress : callable

    Returns
    -------
    list of TriggerResult
        Of all triggers, in their order.

    Raises
    ------
    PulseError
        If the cameras show different pulses among the first triggers.
    """

    def inspect(first: Sequence[TriggerResult]) -> None:
        """Refuse a long run early whose cameras show different pulses."""
        check_first_pulses(
            frames_in(first),
            run.pairs,
            lambda frame: FrameResult.of(frame, ready.chain.measure(frame)).pulse,
        )

    with stage("film", _logger):
        return run_triggers(
            trigger_task(run, ready.chain, ready.measuring),
            frames_of,
            unfinished,
            engine=engine,
            progress=progress,
            places=[run.pairs.pages[0][0].path, run.pairs.pages[1][0].path],
            inspect=inspect,
        )


def trigger_task(run: Run, chain: FrameChain, calibration: Calibration) -> TriggerTask:
    """How the frames of one trigger of a run become its maps."""
    settings = run.settings
    return TriggerTask(
        chain,
        replace(calibration, camera_map=None),  # the chain has the map of the run
        choose_region(settings, run.pairs.shape),
        sliding_along_x=settings.optics.x_axis == "sliding",
        smoothing=settings.thickness.smoothing,
        sampled=choose_frames(run.pairs),
        patch=run_patch(run),
        view=choose_view(settings, run.pairs.shape),
    )


def complete_film(
    run: Run,
    cycle: xr.Dataset,
    triggers: xr.Dataset,
    ready: PreparedRun,
    results: Sequence[TriggerResult],
    calibration: Calibration,
    hashes: Mapping[str, str],
) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Everything of a film but its maps.

    Parameters
    ----------
    run : Run
    cycle : xarray.Dataset
        As `locate_run` returns it.
    triggers : xarray.Dataset
        As `describe_triggers` returns it, before any frame is measured: it refuses a run that lacks
        a load or a temperature.
    ready : PreparedRun
    results : sequence of TriggerResult
        Of all triggers.
    calibration : Calibration
        Of the fixture.
    hashes : mapping of str to str
        Of the inputs.

    Returns
    -------
    film : xarray.Dataset
        The root group.
    groups : dict of str to xarray.Dataset
        The groups frames and registration.

    Raises
    ------
    PulseError
        If the cameras show different pulses in a pair.
    """
    frames, options = frames_in(results), run.settings.light
    drift = mean_drift(frames)
    notes = [
        *run.log_notes,
        *encoder_notes(cycle),
        *ready.notes,
        *check_pulses(frames, run.pairs),
        *describe_frame_notes(frames, run.pairs),
    ]

    # light that is not film, as the finished frames show it
    remaining = find_light(
        kept_lights(frames, run.pairs), calibration, cycle.trigger.values, ready.energies
    )
    found = ready.light.complete(remaining, options)
    light, notes_on_light = describe_light(found, results, run, ready.measuring)

    with stage("prediction", _logger):
        view, positions = (
            choose_view(run.settings, run.pairs.shape),
            [one.position for one in results],
        )
        measured = describe_statistics(results) | describe_positions(
            positions, ready.measuring, view
        )
        prediction = _predict(run, cycle, triggers.assign(measured))
    film = describe_film(
        run,
        triggers,
        results,
        ready.measuring,
        prediction=prediction,
        hashes=hashes,
        notes=[*notes, *notes_on_light],
    )
    film = widen_errors(film.assign(light), found, results, options, calibration)
    with stage("physics", _logger):
        physics = state_physics(film, run.settings, frames_of_run(run, cycle))
    if physics:
        film = film.assign_attrs(physics=physics)

    # the stored map is that of the mean over the run; drifts are stored about it
    camera_map = move_map(ready.chain.camera_map, drift)
    return film, {
        "frames": describe_frames(run, cycle, results, drift).assign(prediction.frames),
        "registration": describe_registration(camera_map, ready.chain.blur),
    }


def _predict(run: Run, cycle: xr.Dataset, measured: xr.Dataset) -> Prediction:
    """The transient film of a run whose film_min (trigger) is measured."""
    settings, shape = run.settings, run.pairs.shape
    region = choose_region(settings, shape)
    place = places_along_sliding(settings, *pixel_positions(settings, shape), region)
    return try_prediction(settings, measured, frames_of_run(run, cycle), place)


def _log_inputs(run: Run, cycle: xr.Dataset, calibration: Calibration) -> None:
    """Log what was found in the directory, and which calibration is used."""
    rows, columns = run.pairs.shape
    _logger.info(
        "%d frame pairs of %d x %d pixels, %d left out",
        len(run.pairs.usable),
        columns,
        rows,
        len(run.pairs.skipped),
    )
    _logger.info("%s", describe_cycle(cycle))
    _logger.info(
        "calibration %r of %s, calibrated range %.2f to %.2f um",
        calibration.fixture,
        calibration.date or "unknown date",
        *calibration.thickness_range,
    )
